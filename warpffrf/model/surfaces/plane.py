"""A plane: theta and z are lengths along e_1 and e_a, the normal is e_0."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.base import Shape
from warpffrf.model.surfaces.fit import reference_direction
from warpffrf.model.surfaces.profile import SurfaceProfile

ACROSS = 1e-6  # length of `direction` within the plane below which it is undefined: it is the normal
IN_LINE = 1e-9  # second singular value of the nodes over the first, below which they lie on one line


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class Plane(Shape):
    """A plane; parameters that are None are fitted to the nodes of the facet set.

    origin (3,) [m]: a point of it, the middle of the nodes where None. outward (3,): its normal, away from the
    material; where None it is found from the nodes and from the facets' side. direction (3,): that of z, projected
    onto the plane; where None it is such that theta runs along +x, or +y where the normal is near x. User frame of the
    body.
    fit_tolerance [m]: 1e-5 of the extent of the nodes where None. theta [m] is a length along e_1 = e_a x outward.
    """

    origin: Any = None
    outward: Any = None
    direction: Any = None

    kind = "plane"
    required = ("origin", "outward")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.origin is not None:
            self._keep_point("origin")
        for name in ("outward", "direction"):
            if getattr(self, name) is not None:
                self._keep_direction(name)
        if self.outward is not None and self.direction is not None:
            self._axes()

    @property
    def size(self) -> float:
        return 0.0

    @property
    def radius(self) -> float:
        """1.0 m: arc length is radius times theta here too."""
        return 1.0

    def profile(self) -> SurfaceProfile:
        return SurfaceProfile(planar=True, side=1.0, radius=1.0)

    # --- frame

    @property
    def axis_point(self) -> np.ndarray:
        """The origin (3,) [m, user frame] of the chart."""
        return self._known()[0]

    @property
    def e_a(self) -> np.ndarray:
        return self._axes()

    @property
    def e_0(self) -> np.ndarray:
        return self._known()[1]

    # --- chart

    def chart(self, points: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        local = (np.asarray(points, float) - self.axis_point) @ self.frame.T
        return local[..., 1], local[..., 2], local[..., 0]

    def point(self, theta: Any, z: Any) -> np.ndarray:
        theta, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        return self.axis_point + theta[..., None] * self.e_1 + z[..., None] * self.e_a

    def normal(self, theta: Any, z: Any) -> np.ndarray:
        theta, _ = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        return np.broadcast_to(self.e_0, (*theta.shape, 3)).copy()

    def radial(self, theta: Any) -> np.ndarray:
        """The normal (..., 3), the same at all theta [m]: what e_r is on a surface of revolution."""
        return self.normal(theta, 0.0)

    def around(self, theta: Any, z: Any = 0.0) -> np.ndarray:
        return np.broadcast_to(self.e_1, (*np.shape(theta), 3)).copy()

    def curvatures(self, theta: Any, z: Any) -> tuple[np.ndarray, np.ndarray]:
        theta, _ = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        return np.zeros(theta.shape), np.zeros(theta.shape)

    # --- fit

    def _completed(self, points: np.ndarray, normals: np.ndarray | None) -> Any:
        center = points.mean(axis=0)
        outward = self.outward
        if outward is None:
            about = center if self.origin is None else self.origin
            _, spread, directions = np.linalg.svd(points - about, full_matrices=False)
            if len(points) < 3 or not spread[1] > IN_LINE * spread[0]:
                raise InputError(
                    f"surface {self.kind}: the points lie on one line and determine no plane; give outward"
                )
            if normals is None:
                raise InputError(
                    f"surface {self.kind}: nodes alone do not determine the side of the material; give outward, the "
                    "normal away from the material"
                )
            outward = directions[2] if np.mean(normals @ directions[2]) > 0.0 else -directions[2]
        origin = self.origin
        if origin is None:
            local = replace(self, origin=center, outward=outward)
            theta, z, distance = local.chart(points)
            off = float(np.mean(distance))
            middle = local.point(0.5 * (theta.min() + theta.max()), 0.5 * (z.min() + z.max()))
            origin = middle + off * local.e_0
        return replace(self, origin=origin, outward=outward)

    def _axes(self) -> np.ndarray:
        """e_a: `direction` within the plane, or such that e_1 is the reference direction of the normal."""
        normal = self.outward if self.outward is not None else self._known()[1]
        if self.direction is None:
            return np.cross(normal, reference_direction(normal))
        inside = self.direction - (self.direction @ normal) * normal
        length = float(np.linalg.norm(inside))
        if length < ACROSS:
            raise InputError(f"surface {self.kind}: direction must not be parallel to outward; leave it out")
        return inside / length

    def _known(self) -> tuple[np.ndarray, np.ndarray]:
        if self.origin is None or self.outward is None:
            raise InputError(
                f"surface {self.kind}: origin and outward are not determined yet; call fitted(points) first"
            )
        return self.origin, self.outward
