r"""The meridian of a contact surface: its parameters, radius, slope and distance.

A surface of revolution is x = c + z e_a + R(z) e_r(theta) with

    R(z) = R_0 + t z - arc(z; Rc) - table(z),      arc(z; Rc) = Rc - sign(Rc) sqrt(Rc^2 - z^2).

Rc > 0 is a crown, highest at z = 0 (a sphere is Rc = R_0), Rc < 0 a groove, lowest there; t is the tangent of a cone;
the table is a drop in cubic pieces. The material lies within R(z) on side +1 and beyond it on side -1. A plane is
`planar`: theta is then a length and the metric radius is 1.

Foot. The nearest point of the meridian to (rho, z) has the axial position z_f. Without a table it has a closed form: of
a cone of half angle alpha the distance is d = (rho - R(z)) cos(alpha) and z_f = z + d sin(alpha); of an arc with kappa
= 1/Rc, e = rho - R_0 and h = sqrt((1 + kappa e)^2 + (kappa z)^2)

    d = (h - 1)/kappa = (e (kappa e + 2) + kappa z^2)/(h + 1),      z_f = z/h,

free of cancellation for a flat arc, kappa -> 0. Where a point lies beyond the centre of a *hollow* arc (1 + kappa e <
0) the nearest point is the end of the half circle, z_f = +-|Rc|. With a table F(s) = s - z + (R(s) - rho) R'(s) = 0 is
solved by Newton from the best of the table's nodes.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpffrf.model.surfaces.curve import Curve
from warpffrf.model.surfaces.fit import crown_drop
from warpffrf.model.surfaces.height import Height

SMALLEST_COSINE = 1e-150  # slope of an arc at its very end: large, and its square is still a number
NEAR_POLE = 0.5  # cosine of the arc's slope below which R/cosine loses digits faster than the other form
FOOT_STEPS = 25  # Newton from a node of the table takes about five; more where curvature jumps near by
FOOT_STALLED = 1e-15  # of the scale of the table: smaller steps end the iteration
FLATTEST = 0.1  # of 1 + R'^2, least derivative of F: beyond a centre of curvature F decreases; smaller steps are taken


@dataclass(frozen=True, eq=False)
class SurfaceProfile:
    """A meridian by its numbers (module docstring), as the device holds them; `planar`: theta is a length, as of a
    plane, with a `curve` of an extruded surface, and with a `height` of one over a plane.
    twist tau [rad/m]: of a helical one, whose curve is rotated by tau z about the axis.

    side +1 or -1; radius R_0 [m] (1.0 of a plane); tangent t [-]; crown Rc [m], signed, 0.0 for none; table: `breaks`
    (n+1,) [m] and `coefficients` (n, 4) of the drop [m] in ascending powers of z - break; empty without one.
    The first and the last piece are extrapolated beyond the table.
    """

    planar: bool
    side: float
    radius: float
    tangent: float = 0.0
    crown: float = 0.0
    breaks: np.ndarray = field(default_factory=lambda: np.zeros(0))
    coefficients: np.ndarray = field(default_factory=lambda: np.zeros((0, 4)))
    curve: Curve | None = None
    height: Height | None = None
    twist: float = 0.0

    @property
    def flat(self) -> bool:
        """True of a plane."""
        return self.planar and not self.free

    @property
    def free(self) -> bool:
        """True of an extruded surface and of one over a plane, whose curvature varies in any way."""
        return self.curve is not None or self.height is not None

    @property
    def turn(self) -> float:
        """Period of theta: 2 pi [rad], of a closed curve its length [m], infinite of a plane and an open curve."""
        if not self.planar:
            return 2.0 * np.pi
        return self.curve.length if self.curve is not None and self.curve.closed else np.inf

    @property
    def curvature(self) -> float:
        """kappa = 1/Rc [1/m], signed; 0 without an arc."""
        return 1.0 / self.crown if self.crown else 0.0

    @property
    def spherical(self) -> bool:
        """True of a ball and a cup: an arc about the origin."""
        return not self.planar and self.crown == self.radius and not self.tangent and not len(self.coefficients)

    @property
    def closed(self) -> bool:
        """True where the foot of a point has a closed formula: a line or an arc."""
        return not len(self.breaks) and not (self.tangent and self.crown)

    def radius_at(self, z: Any) -> np.ndarray:
        """R(z) [m] at z [m], any shape (...); beyond the ends of an arc that of the end."""
        z = np.asarray(z, float)
        if self.planar:
            return np.full(z.shape, self.radius)
        return self.radius + self.tangent * z - crown_drop(self._on_arc(z), self.curvature) - self._table(z, 0)

    def slope_at(self, z: Any) -> np.ndarray:
        """dR/dz [-] at z [m], any shape (...)."""
        z = np.asarray(z, float)
        kappa = self.curvature
        return self.tangent - kappa * self._on_arc(z) / self._cosine(z) - self._table(z, 1)

    def bend_at(self, z: Any) -> np.ndarray:
        """d2R/dz2 [1/m] at z [m], any shape (...)."""
        z = np.asarray(z, float)
        return -self.curvature / self._cosine(z) ** 3 - self._table(z, 2)

    def normal_at(self, z: Any) -> tuple[np.ndarray, np.ndarray]:
        """Radial and axial component [-] at z [m], any shape (...), of the unit normal that points to greater radii;
        finite at the end of an arc."""
        z = np.asarray(z, float)
        if self.crown and self.closed:
            along = self.curvature * self._on_arc(z)
            return np.sqrt(np.maximum(1.0 - along**2, 0.0)), along
        slope = self.slope_at(z)
        length = np.sqrt(1.0 + slope**2)
        return 1.0 / length, -slope / length

    def measure_at(self, z: Any) -> np.ndarray:
        """R sqrt(1 + R'^2) [m] at z [m], any shape (...), the area per dtheta dz; finite at the poles of a sphere."""
        z = np.asarray(z, float)
        if self.crown and self.closed:
            c = self._cosine(z)
            pole = (self.radius - self.crown) / c + self.crown  # finite where R -> 0, but a difference of large numbers
            return np.where(c < NEAR_POLE, pole, self.radius_at(z) / c)  # for a flat arc
        return self.radius_at(z) * np.sqrt(1.0 + self.slope_at(z) ** 2)

    def foot(self, rho: Any, z: Any) -> tuple[np.ndarray, np.ndarray]:
        """Axial position [m] of the nearest point of the meridian to radius `rho`, axial position `z` [m], and the
        distance [m] (any shape), positive at greater radii."""
        rho, z = np.broadcast_arrays(np.asarray(rho, float), np.asarray(z, float))
        if not self.closed:
            return self._searched_foot(rho, z)
        if self.tangent:
            cosine = 1.0 / np.sqrt(1.0 + self.tangent**2)
            d = (rho - self.radius_at(z)) * cosine
            return z + d * self.tangent * cosine, d
        kappa, e = self.curvature, rho - self.radius
        h = np.sqrt((kappa * e + 1.0) ** 2 + (kappa * z) ** 2)
        d = (e * (kappa * e + 2.0) + kappa * z**2) / (h + 1.0)
        z_foot = z / np.where(h > 0.0, h, 1.0)
        if self.side * kappa < 0.0:
            beyond = kappa * e + 1.0 < 0.0
            end = np.where(z < 0.0, -1.0, 1.0) * abs(self.crown)
            away = np.hypot(e + self.crown, z - end) * self.side
            z_foot, d = np.where(beyond, end, z_foot), np.where(beyond, away, d)
        return z_foot, d

    # --- inside

    def _on_arc(self, z: np.ndarray) -> np.ndarray:
        return np.clip(z, -abs(self.crown), abs(self.crown)) if self.crown else z

    def _cosine(self, z: np.ndarray) -> np.ndarray:
        """sqrt(1 - (kappa z)^2), kept from zero."""
        return np.maximum(np.sqrt(1.0 - (self.curvature * self._on_arc(z)) ** 2), SMALLEST_COSINE)

    def _table(self, z: np.ndarray, order: int) -> np.ndarray:
        """The drop of the table, or its derivative of `order`."""
        if not len(self.breaks):
            return np.zeros(z.shape)
        piece = np.clip(np.searchsorted(self.breaks, z, side="right") - 1, 0, len(self.coefficients) - 1)
        s, c = z - self.breaks[piece], np.moveaxis(self.coefficients[piece], -1, 0)
        if order == 0:
            return c[0] + s * (c[1] + s * (c[2] + s * c[3]))
        return c[1] + s * (2.0 * c[2] + s * 3.0 * c[3]) if order == 1 else 2.0 * c[2] + 6.0 * s * c[3]

    def _searched_foot(self, rho: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        nodes = self.breaks if len(self.breaks) else np.linspace(-1.0, 1.0, 33) * abs(self.crown)
        scale = float(nodes[-1] - nodes[0])
        start = np.concatenate([nodes, 0.5 * (nodes[1:] + nodes[:-1])])
        R = self.radius_at(start)
        best, s = np.hypot(rho - self.radius_at(z), 0.0), z.copy()
        for place, radius in zip(start, R, strict=True):  # one node at a time: the points may be many
            distance = np.hypot(rho - radius, z - place)
            s, best = np.where(distance < best, place, s), np.minimum(best, distance)
        for _ in range(FOOT_STEPS):
            off, slope = self.radius_at(s) - rho, self.slope_at(s)
            steep = 1.0 + slope**2
            step = (s - z + off * slope) / np.maximum(steep + off * self.bend_at(s), FLATTEST * steep)
            s = s - step
            if not np.any(np.abs(step) > FOOT_STALLED * scale):
                break
        n_r, n_a = self.normal_at(s)
        return s, (rho - self.radius_at(s)) * n_r + (z - s) * n_a
