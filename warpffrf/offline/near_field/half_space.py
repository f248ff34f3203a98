r"""Displacement of an elastic half-space under loads on its surface (Boussinesq and Cerruti; K. L. Johnson, "Contact
Mechanics", 1985, sections 3.2 and 3.6).

Coordinates (s, t) along the surface, y >= 0 the depth below it. A unit force pushed into the material at (0, 0) moves
the point (s, t, y), with r^2 = s^2 + t^2 + y^2 and the shear modulus G = E/(2 (1 + nu)), by

    u_s = s q,  u_t = t q,  q = (y/r^3 - (1 - 2 nu)/(r (r + y)))/(4 pi G),
    u_y = (y^2/r^3 + 2 (1 - nu)/r)/(4 pi G);           on the surface u_y = (1 - nu^2)/(pi E r).

A unit force along s moves it by

    u_s = (1/r + s^2/r^3 + (1 - 2 nu)(1/(r + y) - s^2/(r (r + y)^2)))/(4 pi G),
    u_t = s t (1/r^3 - (1 - 2 nu)/(r (r + y)^2))/(4 pi G),
    u_y = s (y/r^3 + (1 - 2 nu)/(r (r + y)))/(4 pi G);     on the surface u_s = ((1 - nu)/r + nu s^2/r^3)/(2 pi G),

and one along t likewise, with s and t interchanged.

The mean interaction of two loads distributed over supports that are small compared with their distance d is that of
points with second moments: with the sum Sigma of their covariances,

    <1/r> = 1/d + (3 d^T Sigma d/d^5 - tr Sigma/d^3)/2 + O((support/d)^4)/d.

Any kernel has that mean, to the same order, over the four points offset by the roots of Sigma from d (`four_places`).

Exact. Distributed loads on the exact half-space, or on a quarter space with one free end.

Loads are unit loads, given as forces at points. An end at t = t_end mirrors them: with the distances zeta of a point
and d of a load from it, the mirror image of the load lies zeta + d away, and the quarter space adds w(s, zeta, y; d) to
normal loads.

Tangential loads have no such table. Their image has the same sign in either direction: along s it leaves twice the
normal stress of the load on the end face, along t twice its shear. Those two images solve different problems
(the one does not move the end face along t, the other moves it along t only), so that between the directions they
violate Maxwell and Betti, and contribute nothing to the means. The remaining error of half-space and images at a free
end is of the order of the image itself and varies over the distance of the load from the end: for loads farther away
than about a spacing of the grid it is in the far field, which represents only a smooth part of that of nearer ones.

On a curved surface a displacement along the tangent at a point is that of the flat one by components there only to
first order: of the vector in the frame of the *load*, with outward component v_n, the tangent at a distance x takes

    v_d - k_d x_d v_n,

k_d the principal curvature, positive if the material is convex. The second term is of order 1/R relative to the first
and does not decrease with the distance; as v_n varies like 1/r, its derivative, a strain, would differ between meshes
by the logarithm of the facet size.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray


def normal_load(s: Array, t: Array, depth: Array, poisson_ratio: float) -> tuple[Array, Array, Array]:
    """(u_s, u_t, u_y) times E [1/m], of a unit force into the material, at distances (s, t) [m] along the surface and
    `depth` [m]; arrays that broadcast, nowhere all zero."""
    nu = poisson_ratio
    r2 = s * s + t * t + depth * depth
    r = np.sqrt(r2)
    c = (1.0 + nu) / (2.0 * np.pi)
    q = c * (depth / (r2 * r) - (1.0 - 2.0 * nu) / (r * (r + depth)))
    return q * s, q * t, c * (depth * depth / r2 + 2.0 * (1.0 - nu)) / r


def tangential_load(
    direction: int, s: Array, t: Array, depth: Array, poisson_ratio: float
) -> tuple[Array, Array, Array]:
    """As `normal_load`, of a unit force along s (`direction` 0) or t (1)."""
    if direction == 1:
        u_t, u_s, u_y = tangential_load(0, t, s, depth, poisson_ratio)
        return u_s, u_t, u_y
    k = 1.0 - 2.0 * poisson_ratio
    r2 = s * s + t * t + depth * depth
    r = np.sqrt(r2)
    c = (1.0 + poisson_ratio) / (2.0 * np.pi)
    below = 1.0 / (r + depth)
    q = c * (1.0 / r2 - k * below * below) / r
    return q * s * s + c * (1.0 / r + k * below), q * s * t, c * s * (depth / r2 + k * below) / r


def four_places(s: Array, t: Array, moments: tuple[Array, Array]) -> tuple[Array, Array]:
    """(s, t), each (4, ...) [m], of the points around a distance whose mean is that between two supports; `moments` as
    in `mean_between`."""
    along, across = (np.sqrt(v) for v in moments)
    return np.stack([s - along, s + along, s - along, s + along]), np.stack(
        [t - across, t - across, t + across, t + across]
    )


def mean_between(s: Array, t: Array, moments: tuple[Array, Array], poisson_ratio: float) -> Array:
    """Mean of u_y times E [1/m] over one load's support under the other, of unit forces whose centres lie (s, t) [m]
    apart; `moments`: the sums of both loads' variances along s and t [m^2], without a mixed part."""
    d2 = s * s + t * t
    d = np.sqrt(d2)
    along, across = moments
    second = 1.5 * (along * s * s + across * t * t) / d2 - 0.5 * (along + across)
    return (1.0 - poisson_ratio**2) / np.pi * (1.0 + second / d2) / d


CHUNK = 1_000_000  # pairs of a node and a point of a load processed together: some 100 MB
OUTWARD = 2  # direction of a load; 0 and 1: along s and t
DISC = 0.28  # of the side of a square: half the radius of the disc of its area


@dataclass(frozen=True)
class PointLoads:
    """Unit loads on a flat surface as forces at points: `s`, `t` [m] and `force` [-] (loads, points), which sum to 1
    for each load."""

    s: Array
    t: Array
    force: Array

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Smallest and largest s, smallest and largest t [m]."""
        return float(self.s.min()), float(self.s.max()), float(self.t.min()), float(self.t.max())

    def part(self, loads: Array) -> PointLoads:
        """The `loads` (k,) among them."""
        return PointLoads(self.s[loads], self.t[loads], self.force[loads])

    def moments(self) -> tuple[Array, Array, Array, Array]:
        """Mean s, t [m] and variances along s, t [m^2] (loads,)."""
        s, t = (self.s * self.force).sum(axis=1), (self.t * self.force).sum(axis=1)
        along, across = ((self.force * (v - mean[:, None]) ** 2).sum(axis=1) for v, mean in ((self.s, s), (self.t, t)))
        return s, t, along, across


@dataclass(frozen=True, eq=False)
class EndField:
    """A free end at `t` [m] of a flat chart, `side` +1 where it is the upper one; `quarter` is a `QuarterSpace`."""

    t: float
    side: int
    quarter: Any

    def inward(self, t: Array) -> Array:
        """zeta [m]: distance of points t [m] from the end into the material; beyond it, by round-off, 0."""
        return np.maximum(self.side * (self.t - t), 0.0)

    def added(self, s: Array, t: Array, depth: Array, at: Array, poisson_ratio: float) -> tuple[Array, Array, Array]:
        """(u_s, u_t, u_y) times E [1/m] that the end adds to the half-space, `s` [m] from a unit force at `at` [m],
        at points `t`, `depth` [m]."""
        zeta, d = self.inward(t), self.inward(at)
        u_s, u_z, u_y = normal_load(s, zeta + d, depth, poisson_ratio)
        w_s, w_z, w_y = self.quarter.displacement(s, zeta, depth, d)
        return u_s + w_s, -self.side * (u_z + w_z), u_y + w_y

    def mean(self, s: Array, t: Array, at: Array, moments: tuple[Array, Array], poisson_ratio: float) -> Array:
        """Mean contribution of the end to u_y times E [1/m] between supports, as `mean_between`: centres at t and `at`
        [m], s [m] apart."""
        zeta, d = self.inward(t), self.inward(at)
        return mean_between(s, zeta + d, moments, poisson_ratio) + self.quarter.surface(s, zeta, d)

    def added_tangential(
        self, direction: int, s: Array, t: Array, depth: Array, at: Array, poisson_ratio: float
    ) -> tuple[Array, Array, Array]:
        """As `added`, of the mirror image of a unit force along s (`direction` 0) or t (1)."""
        away = -self.side * (self.inward(t) + self.inward(at))
        return tangential_load(direction, s, away, depth, poisson_ratio)

    def tangential_mean(
        self, s: Array, t: Array, at: Array, moments: tuple[Array, Array], poisson_ratio: float
    ) -> Array:
        """As `tangential_mean`, the contribution of the end, centres at t and `at` [m]: zero between the directions."""
        found = tangential_mean(s, self.inward(t) + self.inward(at), moments, poisson_ratio)
        found[0, 1] = found[1, 0] = 0.0
        return found

    def coupled_mean(
        self,
        s: Array,
        t: Array,
        at: Array,
        moments: tuple[Array, Array],
        curvatures: tuple[float, float],
        poisson_ratio: float,
    ) -> Array:
        """As `coupled_mean`, the contribution of the end, centres at t and `at` [m]; w, the offset along t are smooth
        and evaluated between centres."""
        zeta, d = self.inward(t), self.inward(at)
        x, z = four_places(s, zeta + d, moments)
        image = np.stack(normal_load(x, z, np.zeros_like(x), poisson_ratio))
        lean = (image[2] * x).mean(axis=0)
        u_s, u_z, u_y = image.mean(axis=1) + self.quarter.displacement(s, zeta, 0.0, d)
        w_y = u_y - image[2].mean(axis=0)
        k_s, k_t = curvatures
        return np.stack([-u_s - k_s * (lean + w_y * s), self.side * u_z - k_t * u_y * (t - at)])


def tangential_mean(s: Array, t: Array, moments: tuple[Array, Array], poisson_ratio: float) -> Array:
    """Mean displacement (2, 2, ...) times E [1/m] along s and t under unit forces along s and t, arguments as
    `mean_between`."""
    x, z = four_places(s, t, moments)
    depth = np.zeros_like(x)
    by_direction = [tangential_load(d, x, z, depth, poisson_ratio)[:2] for d in (0, 1)]
    return np.stack([[by_direction[load][d].mean(axis=0) for load in (0, 1)] for d in (0, 1)])


def coupled_mean(
    s: Array, t: Array, moments: tuple[Array, Array], curvatures: tuple[float, float], poisson_ratio: float
) -> Array:
    """Mean displacement (2, ...) times E [1/m] along the tangents of a surface of principal `curvatures` [1/m] under a
    unit force along its outward normal, arguments as `mean_between`."""
    x, z = four_places(s, t, moments)
    u_s, u_t, u_y = normal_load(x, z, np.zeros_like(x), poisson_ratio)
    k_s, k_t = curvatures
    return np.stack([(-u_s - k_s * x * u_y).mean(axis=0), (-u_t - k_t * z * u_y).mean(axis=0)])


def half_space_at(
    points: Array,
    loads: PointLoads,
    poisson_ratio: float,
    end: EndField | None = None,
    direction: int = OUTWARD,
    forces: Array | None = None,
) -> Array:
    """Displacement (3, n, m) in (s, t, outward) times E [1/m] of flat `points` (n, 3) [m] in (s, t, -y), under unit
    loads along s, t or outwards (`direction` 0, 1, 2); with a free `end`, of the quarter space. `forces`: other forces
    (sets, m, points) at the points of the loads; then (3, n, sets m).

    A force represents its share of the load's area. Points nearer to it than half that share's radius, which lie on
    faces cut right next to a load, are moved that far below it: there 1/r is the mean over the share.
    """
    n, m = len(points), len(loads.s)
    sets = loads.force[None] if forces is None else forces
    found = np.empty((3, n, len(sets) * m))
    signs = (-1.0, -1.0, 1.0) if direction == OUTWARD else (1.0, 1.0, -1.0)
    step = max(1, CHUNK // loads.s.size)
    least = DISC**2 * (np.ptp(loads.s, axis=1) * np.ptp(loads.t, axis=1)).max() / loads.s.shape[1]
    for start in range(0, n, step):
        s, t, minus_y = points[start : start + step].T[:, :, None, None]
        s, depth = s - loads.s, np.maximum(-minus_y, 0.0)
        above = np.sqrt(np.maximum(least - s**2 - (t - loads.t) ** 2, 0.0))
        below = np.maximum(depth, above)
        more = None
        if direction == OUTWARD:
            u = normal_load(s, t - loads.t, below, poisson_ratio)
            if end is not None:
                more = end.added(s, t, depth, loads.t, poisson_ratio)
        else:
            u = tangential_load(direction, s, t - loads.t, below, poisson_ratio)
            if end is not None:
                more = end.added_tangential(direction, s, t, depth, loads.t, poisson_ratio)
        if more is not None:
            u = tuple(a + b for a, b in zip(u, more, strict=True))
        for i, (sign, part) in enumerate(zip(signs, u, strict=True)):
            for k, force in enumerate(sets):
                here = found[i, start : start + step, k * m : (k + 1) * m]
                here[:] = sign * np.einsum("nmp,mp->nm", part, force)
    return found
