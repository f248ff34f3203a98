r"""Surfaces of revolution: the chart that cylinder, crown, groove, sphere, cone and their inside forms share.

    x(theta, z) = c + z e_a + R(z) (cos(theta) e_0 + sin(theta) e_1),      n = side (e_r - R' e_a) / sqrt(1 + R'^2),

with R(z) of the kind's profile. The distance of a point is that in its meridian half plane; `chart` gives theta of the
point and z of the nearest place. Principal curvatures, positive where the material is convex:

    around   side / (R sqrt(1 + R'^2)),      along   -side R'' / (1 + R'^2)^(3/2).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.surfaces.base import Shape
from warpffrf.model.surfaces.fit import Revolution, fit_revolution, reference_direction, rms_distance
from warpffrf.model.surfaces.profile import SurfaceProfile

# A fitted arc must be seen: nodes that a straight profile fits as well, or to their round-off, show none.
BETTER = 0.9  # rms distance over that of the straight profile: one unknown more explains noise of n nodes by 1 - 1/n
ROUND_OFF = 1e-9  # of the radius


@dataclass(frozen=True, eq=False, kw_only=True)
class RevolutionShape(Shape):
    """A surface of revolution; what is None is fitted to the nodes of the facet set.

    radius [m] at `axis_point` (3,) [m], where z = 0; axis_direction (3,); user frame of the body. theta = 0 is +x made
    perpendicular to the axis, or +y where the axis is near x. fit_tolerance [m]: 1e-5 of the radius where None.
    """

    radius: float | None = None
    axis_point: Any = None
    axis_direction: Any = None

    required = ("radius", "axis_point", "axis_direction")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.radius is not None:
            self._keep_number("radius", positive=True)
        if self.axis_point is not None:
            self._keep_point("axis_point")
        if self.axis_direction is not None:
            self._keep_direction("axis_direction")

    @property
    def size(self) -> float:
        return self._known()[0]

    def profile(self) -> SurfaceProfile:
        return SurfaceProfile(planar=False, side=self.side, radius=self._known()[0])

    # --- frame

    @property
    def e_a(self) -> np.ndarray:
        return self._known()[2]

    @property
    def e_0(self) -> np.ndarray:
        return reference_direction(self.e_a)

    # --- chart

    def chart(self, points: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        _, c, _ = self._known()
        local = (np.asarray(points, float) - c) @ self.frame.T
        z, distance = self.profile().foot(np.hypot(local[..., 0], local[..., 1]), local[..., 2])
        return np.arctan2(local[..., 1], local[..., 0]), z, self.side * distance

    def point(self, theta: Any, z: Any) -> np.ndarray:
        _, c, e_a = self._known()
        theta, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        return c + z[..., None] * e_a + self.radius_at(z)[..., None] * self.radial(theta)

    def normal(self, theta: Any, z: Any) -> np.ndarray:
        theta, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        radial, axial = self.profile().normal_at(z)
        return self.side * (radial[..., None] * self.radial(theta) + axial[..., None] * self.e_a)

    def radial(self, theta: Any) -> np.ndarray:
        """Radial unit vectors e_r (..., 3) at theta [rad], away from the axis."""
        theta = np.asarray(theta, float)[..., None]
        return np.cos(theta) * self.e_0 + np.sin(theta) * self.e_1

    def around(self, theta: Any) -> np.ndarray:
        theta = np.asarray(theta, float)[..., None]
        return self.side * (np.cos(theta) * self.e_1 - np.sin(theta) * self.e_0)

    def curvatures(self, theta: Any, z: Any) -> tuple[np.ndarray, np.ndarray]:
        profile = self.profile()
        _, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        if profile.crown and profile.closed:  # finite at the poles of a sphere too
            return self.side / profile.measure_at(z), np.full(z.shape, self.side * profile.curvature)
        steep = np.sqrt(1.0 + profile.slope_at(z) ** 2)
        return self.side / (profile.radius_at(z) * steep), -self.side * profile.bend_at(z) / steep**3

    # --- fit

    def _completed(self, points: np.ndarray, normals: np.ndarray | None) -> Any:
        fit = self._fit(points, curvature=0.0)
        return replace(self, radius=fit.radius, axis_point=fit.axis_point, axis_direction=fit.axis_direction)

    def _fit(self, points: np.ndarray, **profile: Any) -> Revolution:
        return fit_revolution(points, self.kind, self.radius, self.axis_point, self.axis_direction, **profile)

    def _known(self) -> tuple[float, np.ndarray, np.ndarray]:
        if self.radius is None or self.axis_point is None or self.axis_direction is None:
            raise InputError(f"surface {self.kind}: radius and axis are not known yet; call fitted(points) first")
        return self.radius, self.axis_point, self.axis_direction

    def _completed_arc(self, points: np.ndarray, name: str, sign: float, flat: str) -> Any:
        """The shape with its arc fitted: the field `name` is its radius, `sign` +1 of a crown and -1 of a hollow."""
        given = getattr(self, name)
        fit = self._fit(points, curvature=None if given is None else sign / given)
        if given is None:
            straight = rms_distance(points, self._fit(points, curvature=0.0))
            better = rms_distance(points, fit) < BETTER * straight and straight > ROUND_OFF * fit.radius
            if not (better and sign * fit.curvature > 0.0):
                raise InputError(
                    f"surface {self.kind}: the points show no {flat} (a straight profile is off them by "
                    f"{straight:.2g} m, curvature {sign * fit.curvature:.3g} 1/m)"
                )
        found = {"radius": fit.radius, "axis_point": fit.axis_point, "axis_direction": fit.axis_direction}
        return replace(self, **found, **{name: sign / fit.curvature if given is None else given})

    def _arc(self, name: str, sign: float) -> float:
        """Rc [m], signed, of the field `name`."""
        if getattr(self, name) is None:
            raise InputError(f"surface {self.kind}: {name} is not known yet; call fitted(points) first")
        return sign * getattr(self, name)
