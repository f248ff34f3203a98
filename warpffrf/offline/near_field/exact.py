r"""Distributed normal loads on the exact half-space, or on a quarter space with one free end.

Loads are unit ones, given as forces at points. An end at t = t_end mirrors them: with the distances zeta of a place and
d of a load from it, the mirror image of the load lies zeta + d away, and the quarter space adds w(s, zeta, y; d).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.offline.near_field.half_space import mean_between, normal_load

Array = np.ndarray
CHUNK = 1_000_000  # pairs of a node and a point of a load worked on together: some 100 MB
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
        """zeta [m]: distance of places t [m] from the end into the material; beyond it, by round-off, 0."""
        return np.maximum(self.side * (self.t - t), 0.0)

    def added(self, s: Array, t: Array, depth: Array, at: Array, poisson_ratio: float) -> tuple[Array, Array, Array]:
        """(u_s, u_t, u_y) times E [1/m] that the end adds to the half-space, `s` [m] from a unit force at `at` [m],
        at places `t`, `depth` [m]."""
        zeta, d = self.inward(t), self.inward(at)
        u_s, u_z, u_y = normal_load(s, zeta + d, depth, poisson_ratio)
        w_s, w_z, w_y = self.quarter.displacement(s, zeta, depth, d)
        return u_s + w_s, -self.side * (u_z + w_z), u_y + w_y

    def mean(self, s: Array, t: Array, at: Array, moments: tuple[Array, Array], poisson_ratio: float) -> Array:
        """Mean of what the end adds to u_y times E [1/m] between supports, as `mean_between`: centres at t and `at`
        [m], s [m] apart."""
        zeta, d = self.inward(t), self.inward(at)
        return mean_between(s, zeta + d, moments, poisson_ratio) + self.quarter.surface(s, zeta, d)


def half_space_at(points: Array, loads: PointLoads, poisson_ratio: float, end: EndField | None = None) -> Array:
    """Displacement (3, n, m) in (s, t, outward) times E [1/m] of flat `points` (n, 3) [m] in (s, t, -y), under outward
    unit loads; with a free `end`, of the quarter space.

    A force stands for its share of the load's area. Points nearer to it than half that share's radius, which lie on
    faces cut right beside a load, count as that far below it: there 1/r is the mean over the share.
    """
    n, m = len(points), len(loads.s)
    found = np.empty((3, n, m))
    step = max(1, CHUNK // loads.s.size)
    least = DISC**2 * (np.ptp(loads.s, axis=1) * np.ptp(loads.t, axis=1)).max() / loads.s.shape[1]
    for start in range(0, n, step):
        s, t, minus_y = points[start : start + step].T[:, :, None, None]
        s, depth = s - loads.s, np.maximum(-minus_y, 0.0)
        above = np.sqrt(np.maximum(least - s**2 - (t - loads.t) ** 2, 0.0))
        u = normal_load(s, t - loads.t, np.maximum(depth, above), poisson_ratio)
        if end is not None:
            more = end.added(s, t, depth, loads.t, poisson_ratio)
            u = tuple(a + b for a, b in zip(u, more, strict=True))
        for i, (sign, part) in enumerate(zip((-1.0, -1.0, 1.0), u, strict=True)):
            found[i, start : start + step] = sign * np.einsum("nmp,mp->nm", part, loads.force)
    return found
