"""True shapes of contact surfaces: cylinder and crowned cylinder, given or fitted to nodes.

Chart of a surface of revolution with axis point c, unit axis e_a, reference direction e_0 and e_1 = e_a x e_0:

    x(theta, z) = c + z e_a + R(z) (cos(theta) e_0 + sin(theta) e_1).

The crown is a circular arc of radius Rc in every plane through the axis, highest at z = 0:
R(z) = R - (Rc - sqrt(Rc^2 - z^2)), dR/dz = -z / sqrt(Rc^2 - z^2). The arc's centre lies at radius R - Rc, so the signed
normal distance of a point (rho, z) is sqrt((rho - R + Rc)^2 + z^2) - Rc; with d = rho - R it is evaluated as
(d (d + 2 Rc) + z^2) / (sqrt((d + Rc)^2 + z^2) + Rc), free of cancellation for a flat crown.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_direction, require_number
from warpffrf.model.surface_fit import crown_drop, fit_revolution, reference_direction

# of the radius: far below the elastic approach (1e-4 to 1e-3 R) that the gap is compared with
DEFAULT_FIT_FRACTION = 1e-5


@dataclass(frozen=True, eq=False, kw_only=True)
class Cylinder:
    """Outside of a circular cylinder; what is None is fitted to the nodes of the facet set.

    radius [m], axis_point (3,) [m], axis_direction (3,), user frame of the body; fit_tolerance [m] is the largest
    distance of a node that is accepted, 1e-5 of the radius where None. `deviation` [m] is set by `fitted`.
    """

    radius: float | None = None
    axis_point: Any = None
    axis_direction: Any = None
    fit_tolerance: float | None = None
    deviation: float | None = field(default=None, init=False)

    kind = "cylinder"

    def __post_init__(self) -> None:
        label = f"surface {self.kind}"
        if self.radius is not None:
            object.__setattr__(self, "radius", require_number(self.radius, f"{label}: radius", positive=True))
        if self.axis_point is not None:
            point = require_array(self.axis_point, f"{label}: axis_point", (3,))
            object.__setattr__(self, "axis_point", point)
        if self.axis_direction is not None:
            direction = require_direction(self.axis_direction, f"{label}: axis_direction")
            object.__setattr__(self, "axis_direction", direction)
        if self.fit_tolerance is not None:
            tolerance = require_number(self.fit_tolerance, f"{label}: fit_tolerance", positive=True)
            object.__setattr__(self, "fit_tolerance", tolerance)

    # --- profile: what a crowned shape overrides ---

    @property
    def curvature(self) -> float:
        """Curvature 1/Rc of the profile [1/m]; 0 for a cylinder."""
        return 0.0

    @property
    def resolved(self) -> bool:
        """True when nothing is left to fit."""
        return self.radius is not None and self.axis_point is not None and self.axis_direction is not None

    # --- frame ---

    @property
    def e_a(self) -> np.ndarray:
        """Unit axis direction (3,)."""
        return self._known()[2]

    @property
    def e_0(self) -> np.ndarray:
        """Reference direction theta = 0 (3,): +x made perpendicular to the axis, or +y where the axis is near x."""
        return reference_direction(self.e_a)

    @property
    def e_1(self) -> np.ndarray:
        """Direction theta = 90 degrees (3,): e_a x e_0."""
        return np.cross(self.e_a, self.e_0)

    @property
    def frame(self) -> np.ndarray:
        """Rows e_0, e_1, e_a (3, 3)."""
        return np.stack([self.e_0, self.e_1, self.e_a])

    # --- chart ---

    def radius_at(self, z: Any) -> np.ndarray:
        """R(z) [m] at axial positions z [m]."""
        R = self._known()[0]
        return R - crown_drop(np.asarray(z, float), self.curvature)

    def slope_at(self, z: Any) -> np.ndarray:
        """dR/dz [-] at axial positions z [m]."""
        z = np.asarray(z, float)
        return -self.curvature * z / np.sqrt(1.0 - (self.curvature * z) ** 2)

    def chart(self, points: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """theta (n,) rad in (-pi, pi], z (n,) m and signed normal distance (n,) m (positive outside) of points (n, 3).

        theta and z are those of the points themselves; a point on the surface is `point(theta, z)`.
        """
        _, c, _ = self._known()
        local = (np.asarray(points, float) - c) @ self.frame.T
        rho, z = np.hypot(local[..., 0], local[..., 1]), local[..., 2]
        return np.arctan2(local[..., 1], local[..., 0]), z, self.profile_distance(rho, z)

    def profile_distance(self, rho: Any, z: Any) -> np.ndarray:
        """Signed normal distance [m] of points at radius rho, axial position z [m]; positive outside."""
        R = self._known()[0]
        d, z, kappa = np.asarray(rho, float) - R, np.asarray(z, float), self.curvature
        # the module's formula, numerator and denominator times kappa = 1/Rc
        return (d * (kappa * d + 2.0) + kappa * z**2) / (np.sqrt((kappa * d + 1.0) ** 2 + (kappa * z) ** 2) + 1.0)

    def point(self, theta: Any, z: Any) -> np.ndarray:
        """Points (..., 3) [m] of the surface at theta [rad], z [m]."""
        _, c, e_a = self._known()
        theta, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        return c + z[..., None] * e_a + self.radius_at(z)[..., None] * self.radial(theta)

    def normal(self, theta: Any, z: Any) -> np.ndarray:
        """Outward unit normals (..., 3): (e_r - R'(z) e_a) / sqrt(1 + R'^2)."""
        theta, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        slope = self.slope_at(z)[..., None]
        return (self.radial(theta) - slope * self.e_a) / np.sqrt(1.0 + slope**2)

    def radial(self, theta: Any) -> np.ndarray:
        """Radial unit vectors e_r (..., 3) at theta [rad]."""
        theta = np.asarray(theta, float)[..., None]
        return np.cos(theta) * self.e_0 + np.sin(theta) * self.e_1

    # --- fit ---

    def fitted(self, points: Any) -> Any:
        """The shape with every None fitted to `points` (n, 3) [m] and `deviation` set.

        Raises `InputError` when the largest distance of a point exceeds the tolerance, or the points do not determine
        what is left open.
        """
        points = require_array(points, f"surface {self.kind}: points", (None, 3))
        shape = self if self.resolved else self._completed(points)
        deviation = float(np.max(np.abs(shape.chart(points)[2])))
        tolerance = shape.fit_tolerance or DEFAULT_FIT_FRACTION * shape._known()[0]
        if not deviation <= tolerance:
            raise InputError(
                f"surface {self.kind}: the facets do not fit the shape, largest distance of a node {deviation:.3g} m "
                f"exceeds fit_tolerance {tolerance:.3g} m; choose another shape, other facets, or a larger "
                "fit_tolerance"
            )
        shape = replace(shape)
        object.__setattr__(shape, "deviation", deviation)
        return shape

    def describe(self) -> dict[str, Any]:
        """Plain numbers and lists for hashing and files: the arguments, and `kind`."""
        listed = {n: None if getattr(self, n) is None else getattr(self, n).tolist() for n in _VECTORS}
        return {"kind": self.kind, "radius": self.radius, **listed, "fit_tolerance": self.fit_tolerance}

    def _completed(self, points: np.ndarray) -> Any:
        fit = fit_revolution(points, self.kind, self.radius, self.axis_point, self.axis_direction, curvature=0.0)
        return replace(self, radius=fit.radius, axis_point=fit.axis_point, axis_direction=fit.axis_direction)

    def _known(self) -> tuple[float, np.ndarray, np.ndarray]:
        if self.radius is None or self.axis_point is None or self.axis_direction is None:
            raise InputError(f"surface {self.kind}: radius and axis are not known yet; call fitted(points) first")
        return self.radius, self.axis_point, self.axis_direction


@dataclass(frozen=True, eq=False, kw_only=True)
class CrownedCylinder(Cylinder):
    """Outside of a cylinder with a circular crown; `crown_radius` [m] too is fitted where None.

    `axis_point` is the centre of the crown: R(z) is largest there. Other arguments as for `Cylinder`.
    """

    crown_radius: float | None = None

    kind = "crowned_cylinder"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.crown_radius is not None:
            Rc = require_number(self.crown_radius, f"surface {self.kind}: crown_radius", positive=True)
            object.__setattr__(self, "crown_radius", Rc)

    @property
    def curvature(self) -> float:
        if self.crown_radius is None:
            raise InputError(f"surface {self.kind}: crown_radius is not known yet; call fitted(points) first")
        return 1.0 / self.crown_radius

    @property
    def resolved(self) -> bool:
        return super().resolved and self.crown_radius is not None

    def describe(self) -> dict[str, Any]:
        return {**super().describe(), "crown_radius": self.crown_radius}

    def _completed(self, points: np.ndarray) -> Any:
        kappa = None if self.crown_radius is None else self.curvature
        fit = fit_revolution(points, self.kind, self.radius, self.axis_point, self.axis_direction, curvature=kappa)
        if not fit.curvature > 0.0:
            raise InputError(
                f"surface {self.kind}: the points show no crown (curvature {fit.curvature:.3g} 1/m); use Cylinder()"
            )
        return replace(
            self,
            radius=fit.radius,
            axis_point=fit.axis_point,
            axis_direction=fit.axis_direction,
            crown_radius=1.0 / fit.curvature,
        )


SHAPES = {shape.kind: shape for shape in (Cylinder, CrownedCylinder)}
_VECTORS = ("axis_point", "axis_direction")


def from_description(description: dict[str, Any]) -> Any:
    """The shape that `describe()` wrote."""
    arguments = {key: value for key, value in description.items() if key != "kind"}
    return SHAPES[description["kind"]](**arguments)
