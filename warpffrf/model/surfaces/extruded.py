r"""A plane curve, extruded along an axis, straight or with a twist: cams, rails, flanks of gears.

x = c + x(u) e_0 + y(u) e_1 + z e_a, with u the arc length along the curve and z along the axis: theta of the chart is u
[m], as on a plane, of which this is the general form. e_theta is the tangent of the curve, and e_theta x e_a its normal
away from the material, which lies to the left of the curve seen against e_a.

**Helical surfaces.** With a twist tau [rad/m] e_0 and e_1 are rotated by tau z about the axis. With t and n tangent and
normal of the curve in the section, q = (e_a x p).n the lever of n about the axis, y the point rotated back and d_t its
distance from the curve,

    N = (n - tau q e_a)/sqrt(1 + (tau q)^2),        d = d_t/sqrt(1 + (tau q)^2),

d exactly on an involute, where q is the base radius and tau q = tan beta_b, on other curves to first order (derived in
the kernels, `surfaces.helical`). Curvatures are those of d, with kappa that of the curve and a = tau (1 - kappa p.n)

    P (kappa t t + a (t e_a + e_a t) - tau a (p.n) e_a e_a) P/sqrt(1 + (tau q)^2),        P = 1 - N N.
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
    """A plane curve extruded along an axis, straight or with a twist.

    curve: a `surfaces.Curve` in a plane across the axis, the material to its left seen against `axis_direction`;
    axis_point (3,) [m]: the origin of the curve's coordinates; axis_direction (3,); x_direction (3,): that of the
    curve's x, projected across the axis, by default +x, or +y where the axis is near x. User frame of the body. twist
    [rad/m]: rotation of the section about the axis per length along it, from the axis_point on, 2 pi over the lead;
    positive on right-handed helices, 0 on a straight surface.
    Nothing is fitted: `fit_tolerance` [m], 1e-5 of the curve's extent where None, is how far nodes of a mesh may lie
    off it, and none may lie beyond its ends. Raises `InputError` for a `curve` that is none, and an x_direction along
    the axis.
    """

    curve: Any = None
    axis_point: Any = (0.0, 0.0, 0.0)
    axis_direction: Any = (0.0, 1.0, 0.0)
    x_direction: Any = None
    twist: float = 0.0

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
        self._keep_number("twist")
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
        return SurfaceProfile(planar=True, side=1.0, radius=1.0, curve=self._known(), twist=self.twist)

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
        y, z = self._section(points)
        u, distance = self._known().foot(y)
        lean = self._lean(u, y)
        return u, z + distance * lean / (1.0 + lean**2), distance / np.hypot(1.0, lean)

    def gap(self, points: Any) -> np.ndarray:
        y, _ = self._section(points)
        gap = self._known().gap(y)
        return gap / np.hypot(1.0, self._lean(self._known().foot(y)[0], y)) if self.twist else gap

    def point(self, theta: Any, z: Any) -> np.ndarray:
        theta, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        return self.axis_point + self._in_space(self._known().at(theta), z) + z[..., None] * self.e_a

    def normal(self, theta: Any, z: Any) -> np.ndarray:
        theta, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        lean = self._lean(theta)[..., None]
        return (self._in_space(self._known().normal(theta), z) - lean * self.e_a) / np.hypot(1.0, lean)

    def radial(self, theta: Any) -> np.ndarray:
        """The normal (..., 3) at theta [m], z = 0: what e_r is on a surface of revolution."""
        return self.normal(theta, 0.0)

    def around(self, theta: Any, z: Any = 0.0) -> np.ndarray:
        t = self._known().at(theta, 1)
        return self._in_space(t / np.linalg.norm(t, axis=-1, keepdims=True), z)

    def curvatures(self, theta: Any, z: Any) -> tuple[np.ndarray, np.ndarray]:
        """Curvatures [1/m] (any shape) along e_theta and t_z at theta, z [m], positive where the material is convex; of
        a helical surface they are the principal ones on involutes."""
        theta, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        if not self.twist:
            return self._known().curvature(theta), np.zeros(theta.shape)
        tensor = self.curvature_tensor(theta, z)
        around, along = (
            np.einsum("...i,...ij,...j->...", t, tensor, t) for t in (self.around(theta, z), self.along(theta, z))
        )
        return around, along

    def curvature_tensor(self, theta: Any, z: Any) -> np.ndarray:
        if not self.twist:
            return super().curvature_tensor(theta, z)
        theta, z = np.broadcast_arrays(np.asarray(theta, float), np.asarray(z, float))
        curve = self._known()
        kappa = curve.curvature(theta)[..., None, None]
        lever = np.sum(curve.at(theta) * curve.normal(theta), axis=-1)[..., None, None]
        t, N, e = self.around(theta, z), self.normal(theta, z), self.e_a
        across, a = np.eye(3) - _product(N, N), self.twist * (1.0 - kappa * lever)
        bend = kappa * _product(t, t) + a * (_product(t, e) + _product(e, t)) - self.twist * a * lever * np.outer(e, e)
        return across @ bend @ across / np.hypot(1.0, self._lean(theta))[..., None, None]

    def measure_at(self, z: Any) -> np.ndarray:
        """Area per dtheta dz [-] at z [m], any shape (...): 1 of a straight surface; of a helical one in the middle of
        its curve, 1/cos beta_b on an involute."""
        middle = 0.5 * (self._known().knots[0] + self._known().knots[-1])
        return np.full(np.shape(z), np.hypot(1.0, self._lean(np.asarray(middle))))

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

    def _section(self, points: Any) -> tuple[np.ndarray, np.ndarray]:
        """Points in the axes of their sections (..., 2), and z [m]."""
        local = (np.asarray(points, float) - self.axis_point) @ self.frame.T
        return _rotated(local[..., :2], -self.twist * local[..., 2]), local[..., 2]

    def _in_space(self, section: np.ndarray, z: Any) -> np.ndarray:
        """Vectors (..., 3) from those of the sections (..., 2) at z [m]."""
        return _rotated(section, self.twist * np.asarray(z, float)) @ self.frame[:2]

    def _lean(self, theta: np.ndarray, y: np.ndarray | None = None) -> np.ndarray:
        """tau q (...) at theta [m]; y: the points of the section whose feet these are."""
        if not self.twist:
            return np.zeros(np.shape(theta))
        n, p = self._known().normal(theta), self._known().at(theta) if y is None else y
        return self.twist * (p[..., 0] * n[..., 1] - p[..., 1] * n[..., 0])


def _rotated(section: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Vectors (..., 2) rotated by angles (...) [rad]."""
    if not np.any(angle):
        return section
    c, s = np.cos(angle), np.sin(angle)
    x, y = section[..., 0], section[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)


def _product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The tensors (..., 3, 3) a b."""
    return a[..., :, None] * b[..., None, :]
