"""A plane curve, extruded along an axis: cams, rails, flanks of spur gears.

x = c + x(u) e_0 + y(u) e_1 + z e_a, with u the arc length along the curve and z along the axis: theta of the chart is u
[m], as on a plane, of which this is the general form. e_theta is the tangent of the curve, and e_theta x e_a its normal
away from the material, which lies to the left of the curve seen against e_a.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.surfaces.base import Shape
from warpffrf.model.surfaces.curve import Curve
from warpffrf.model.surfaces.fit import reference_direction
from warpffrf.model.surfaces.profile import SurfaceProfile

ENDS = 1e-6  # of the curve's length: nodes may lie beyond its ends by this
ACROSS = 1e-6  # length of `x_direction` across the axis below which it is undefined


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class Extruded(Shape):
    """A plane curve extruded along an axis.

    curve: a `surfaces.Curve` in a plane across the axis, the material to its left seen against `axis_direction`;
    axis_point (3,) [m]: the origin of the curve's coordinates; axis_direction (3,); x_direction (3,): that of the
    curve's x, projected across the axis, by default +x, or +y where the axis is near x. User frame of the body.
    Nothing is fitted: `fit_tolerance` [m], 1e-5 of the curve's extent where None, is how far nodes of a mesh may lie
    off it, and none may lie beyond its ends. Raises `InputError` for a `curve` that is none, and an x_direction along
    the axis.
    """

    curve: Any = None
    axis_point: Any = (0.0, 0.0, 0.0)
    axis_direction: Any = (0.0, 1.0, 0.0)
    x_direction: Any = None

    kind = "extruded"
    required = ("curve",)

    def __post_init__(self) -> None:
        super().__post_init__()
        if isinstance(self.curve, dict):  # of a file
            object.__setattr__(self, "curve", Curve(**self.curve))
        if self.curve is not None and not isinstance(self.curve, Curve):
            raise InputError(f"surface {self.kind}: curve must be a surfaces.Curve, got {self.curve!r}")
        self._keep_point("axis_point")
        self._keep_direction("axis_direction")
        if self.x_direction is not None:
            self._keep_direction("x_direction")
            if np.linalg.norm(np.cross(self.x_direction, self.axis_direction)) < ACROSS:
                raise InputError(f"surface {self.kind}: x_direction must not be parallel to axis_direction")

    @property
    def size(self) -> float:
        return self._known().extent

    @property
    def radius(self) -> float:
        """1.0 m: arc length is radius times theta here too, as on a plane."""
        return 1.0

    def profile(self) -> SurfaceProfile:
        return SurfaceProfile(planar=True, side=1.0, radius=1.0, curve=self._known())

    @property
    def e_a(self) -> np.ndarray:
        return np.asarray(self.axis_direction)

    @property
    def e_0(self) -> np.ndarray:
        if self.x_direction is None:
            return reference_direction(self.e_a)
        across = self.x_direction - (self.x_direction @ self.e_a) * self.e_a
        return across / np.linalg.norm(across)

    def chart(self, points: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        local = (np.asarray(points, float) - self.axis_point) @ self.frame.T
        u, distance = self._known().foot(local[..., :2])
        return u, local[..., 2], distance

    def gap(self, points: Any) -> np.ndarray:
        local = (np.asarray(points, float) - self.axis_point) @ self.frame.T
        return self._known().gap(local[..., :2])

    def point(self, theta: Any, z: Any) -> np.ndarray:
        theta, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        return self.axis_point + self._known().at(theta) @ self.frame[:2] + z[..., None] * self.e_a

    def normal(self, theta: Any, z: Any) -> np.ndarray:
        theta, _ = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        return self._known().normal(theta) @ self.frame[:2]

    def radial(self, theta: Any) -> np.ndarray:
        """The normal (..., 3) at theta [m]: what e_r is on a surface of revolution."""
        return self.normal(theta, 0.0)

    def around(self, theta: Any, z: Any = 0.0) -> np.ndarray:
        t = self._known().at(theta, 1)
        return (t / np.linalg.norm(t, axis=-1, keepdims=True)) @ self.frame[:2]

    def curvatures(self, theta: Any, z: Any) -> tuple[np.ndarray, np.ndarray]:
        theta, _ = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        return self._known().curvature(theta), np.zeros(theta.shape)

    def fitted(self, points: Any, normals: Any = None) -> Any:
        """As `Shape.fitted`, with `points` (n, 3) [m] and `normals` (n, 3) of facets; raises `InputError` for points
        beyond the ends of an open curve too."""
        curve, u = self._known(), self.chart(points)[0]
        beyond = float(max(curve.knots[0] - np.min(u), np.max(u) - curve.knots[-1]))
        if not curve.closed and beyond > ENDS * curve.length:
            raise InputError(
                f"surface {self.kind}: nodes lie up to {beyond:.3g} m beyond the ends of the curve, which is "
                f"{curve.length:.4g} m long; make it longer, or choose other facets"
            )
        return super().fitted(points, normals)

    def describe(self) -> dict[str, Any]:
        return super().describe() | {"curve": None if self.curve is None else self.curve.describe()}

    def _completed(self, points: np.ndarray, normals: np.ndarray | None) -> Any:
        raise InputError(f"surface {self.kind}: curve must be given; it is not fitted to nodes")

    def _wrong_side(self) -> str:
        return (
            "the normals of the facets point to the wrong side of this surface: the material must lie to the left of "
            "the curve, seen against axis_direction; reverse the order of its points, or the axis"
        )

    def _known(self) -> Curve:
        if self.curve is None:
            raise InputError(f"surface {self.kind}: curve must be given; it is not fitted to nodes")
        return self.curve
