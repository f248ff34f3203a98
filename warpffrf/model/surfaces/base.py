"""Base of contact surfaces: a frame, a chart (theta, z), a normal away from the material, and a fit to nodes.

The chart measures theta about e_a from e_0 towards e_1 = e_a x e_0 and z along e_a from the point c. With the unit
normal n away from the material e_theta x t_z = n: `around` returns e_theta, `along` returns t_z, which points to
greater z. On a surface with the material outside (side -1) e_theta points against increasing theta.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, fields, replace
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_direction, require_number
from warpffrf.model.surfaces.profile import SurfaceProfile

# of the size: far below the elastic approach (1e-4 to 1e-3 R) that the gap is compared with
DEFAULT_FIT_FRACTION = 1e-5
UNIT = 4.0 * np.finfo(float).eps  # round-off of a vector that was made a unit vector before


@dataclass(frozen=True, eq=False, kw_only=True)
class Shape(ABC):
    """A contact surface in the user frame of its body; parameters that are None are fitted to the nodes of the facet
    set.

    fit_tolerance [m] is the largest distance of a node that is accepted, 1e-5 of the size where None. `deviation` [m],
    the largest distance found, is set by `fitted`.
    """

    fit_tolerance: float | None = None
    deviation: float | None = field(default=None, init=False)

    kind = "shape"
    required: ClassVar[tuple[str, ...]] = ()  # arguments that are fitted where they are None
    side = 1.0  # +1: the material lies on the inner side, -1: on the outer side (bores, rings, cups)

    def __post_init__(self) -> None:
        if self.fit_tolerance is not None:
            self._keep_number("fit_tolerance", positive=True)

    # --- definition of a kind of surface

    @property
    def resolved(self) -> bool:
        """True when no parameter remains to be fitted."""
        return not self.missing

    @property
    def missing(self) -> tuple[str, ...]:
        """The arguments that remain to be fitted."""
        return tuple(name for name in self.required if getattr(self, name) is None)

    def without_nodes(self) -> Any:
        """The shape for a rigid surface, which has no nodes to fit: with defaults for dispensable parameters."""
        return self

    @property
    @abstractmethod
    def size(self) -> float:
        """Length [m] that the default fit_tolerance is a fraction of; 0 where only the nodes have one."""

    @property
    @abstractmethod
    def e_a(self) -> np.ndarray:
        """Unit direction (3,) of the axis, that of z; user frame."""

    @property
    @abstractmethod
    def e_0(self) -> np.ndarray:
        """Unit direction (3,) of theta = 0, perpendicular to the axis; user frame."""

    @abstractmethod
    def profile(self) -> SurfaceProfile:
        """The surface's numbers. Raises `InputError` while parameters remain to be fitted."""

    @abstractmethod
    def chart(self, points: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """theta, z of the nearest points of the surface, and the signed distance [m] of `points` (..., 3) [m]:
        positive in the free space, outside the material."""

    @abstractmethod
    def point(self, theta: Any, z: Any) -> np.ndarray:
        """Points (..., 3) [m] of the surface at theta [rad, of a plane m], z [m]."""

    @abstractmethod
    def normal(self, theta: Any, z: Any) -> np.ndarray:
        """Unit normals (..., 3) away from the material at theta [rad, of a plane m], z [m]; user frame."""

    @abstractmethod
    def around(self, theta: Any, z: Any = 0.0) -> np.ndarray:
        """Unit tangents e_theta (..., 3) at theta [rad, of a plane m], so that e_theta x t_z is the normal; user
        frame. They depend on z [m] on a `MeshSurface` only."""

    @abstractmethod
    def curvatures(self, theta: Any, z: Any) -> tuple[np.ndarray, np.ndarray]:
        """Principal curvatures [1/m] (any shape) around and along the meridian at theta [rad, of a plane m], z [m],
        positive where the material is convex."""

    @abstractmethod
    def _completed(self, points: np.ndarray, normals: np.ndarray | None) -> Shape:
        """The shape with its open parameters fitted to the points."""

    def curvature_tensor(self, theta: Any, z: Any) -> np.ndarray:
        """Curvatures [1/m] as tensors (..., 3, 3) in the user frame, at theta [rad, of a plane m], z [m]."""
        along = self.along(theta, z)
        tangents = np.stack([np.broadcast_to(self.around(np.asarray(theta, float)), along.shape), along])
        return np.einsum("d...,d...i,d...j->...ij", np.stack(self.curvatures(theta, z)), tangents, tangents)

    # --- frame and directions

    @property
    def e_1(self) -> np.ndarray:
        """Unit direction (3,) e_a x e_0, user frame."""
        (a, b, c), (d, e, f) = self.e_a, self.e_0  # np.cross takes ten times as long, and charts ask for it each time
        return np.array([b * f - c * e, c * d - a * f, a * e - b * d])

    @property
    def frame(self) -> np.ndarray:
        """Unit directions e_0, e_1, e_a as rows (3, 3), user frame."""
        return np.stack([self.e_0, self.e_1, self.e_a])

    def gap(self, points: Any) -> np.ndarray:
        """Distance (...) [m] of `points` (..., 3) [m] from the material: that of the chart, except where it ends."""
        return self.chart(points)[2]

    def along(self, theta: Any, z: Any) -> np.ndarray:
        """Unit directions t_z (..., 3) of the tangents of the meridian at theta [rad, of a plane m], z [m]: n x
        e_theta, towards greater z; user frame."""
        n = self.normal(theta, z)
        return np.cross(n, np.broadcast_to(self.around(np.asarray(theta, float), z), n.shape))

    def radius_at(self, z: Any) -> np.ndarray:
        """R(z) [m] at z [m], any shape (...): the arc length per theta; 1 of a plane."""
        return self.profile().radius_at(z)

    def slope_at(self, z: Any) -> np.ndarray:
        """dR/dz [-] at z [m], any shape (...)."""
        return self.profile().slope_at(z)

    def measure_at(self, z: Any) -> np.ndarray:
        """R sqrt(1 + R'^2) [m] at z [m], any shape (...): the area per dtheta dz."""
        return self.profile().measure_at(z)

    @property
    def curvature(self) -> float:
        """1/Rc [1/m] of the meridian's arc, signed (a groove's is negative); 0 without one."""
        return self.profile().curvature

    # --- fit and description

    def fitted(self, points: Any, normals: Any = None) -> Any:
        """The shape with every None fitted to `points` (n, 3) [m] and `deviation` set.

        normals (n, 3), where given, are the outward normals of the facets at the points: they define the side of a
        plane, and detect a surface with the material inside that was requested on a bore. Raises `InputError` when the
        largest distance of a point exceeds the tolerance, the points do not determine all parameters that are None, or
        the normals show that the material lies on the other side.
        """
        points = require_array(points, f"surface {self.kind}: points", (None, 3))
        if normals is not None:
            normals = require_array(normals, f"surface {self.kind}: normals", (len(points), 3))
        shape = self if self.resolved else self._completed(points, normals)
        theta, z, distance = shape.chart(points)
        deviation = float(np.max(np.abs(distance)))
        tolerance = shape.fit_tolerance or DEFAULT_FIT_FRACTION * (shape.size or _extent(points))
        if not deviation <= tolerance:
            raise InputError(
                f"surface {self.kind}: the facets do not fit the shape, largest distance of a node {deviation:.3g} m "
                f"exceeds fit_tolerance {tolerance:.3g} m; choose another shape, other facets, or a larger "
                "fit_tolerance"
            )
        if normals is not None and np.mean(np.einsum("ij,ij->i", normals, shape.normal(theta, z))) < 0.0:
            raise InputError(f"surface {self.kind}: {shape._wrong_side()}")
        shape = replace(shape)
        object.__setattr__(shape, "deviation", deviation)
        return shape

    def describe(self) -> dict[str, Any]:
        """Plain numbers and lists for hashing and files: the arguments, and `kind`."""
        return {"kind": self.kind, **{f.name: _plain(getattr(self, f.name)) for f in fields(self) if f.init}}

    def _wrong_side(self) -> str:
        return (
            "the normals of the facets point to the wrong side of this surface: use an inner form (Bore, Ring, Cup, "
            "ConicalBore) for a surface with the material outside, the others for one with the material inside"
        )

    # --- checking

    def _keep_number(self, name: str, *, positive: bool = False) -> None:
        value = require_number(getattr(self, name), f"surface {self.kind}: {name}", positive=positive)
        object.__setattr__(self, name, value)

    def _keep_point(self, name: str) -> None:
        object.__setattr__(self, name, require_array(getattr(self, name), f"surface {self.kind}: {name}", (3,)))

    def _keep_direction(self, name: str) -> None:
        given = getattr(self, name)
        unit = require_direction(given, f"surface {self.kind}: {name}")
        same = np.array(given, dtype=np.float64)  # a unit vector is not changed: a file returns it exactly
        object.__setattr__(self, name, same if np.max(np.abs(same - unit)) <= UNIT else unit)

    def _unknown(self, what: str) -> InputError:
        return InputError(f"surface {self.kind}: {what} not determined yet; call fitted(points) first")


def _extent(points: np.ndarray) -> float:
    return float(np.max(np.ptp(points, axis=0)))


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) else value
