r"""Plane curves in cubic pieces: the sections of extruded surfaces.

c(u) = (x, y)(u) is given by its points and unit tangents at knots u_i, in metres; between two knots it is the cubic of
Hermite with the derivatives c' = t_i. With u the arc length, |c'| = 1 to h^4 kappa^4 and c is exact to h^4/384 of the
fourth derivative; of an arc of angle phi a piece, to R phi^4/384 (4e-10 R at 0.02 rad), its curvature to phi^2/12. The
material lies to the left of the direction of u, counter-clockwise about a solid, so that

    n = (y', -x')/|c'|,        kappa = (x' y'' - y' x'')/|c'|^3,        n' = kappa t,

n away from the material and kappa > 0 where it is convex. Beyond its ends an open curve continues along its tangents; a
closed one has the period `length`.

Foot. The nearest point to p is a root of f(u) = (p - c).c', with f' = (p - c).c'' - c'.c' by Newton's method, from the
nearest of the samples of all pieces. Near the evolute, kappa d -> -1, f' vanishes; steps are then bounded. The device
starts from `seeds`: the piece nearest to the centre of each cell of a lattice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_number
from warpffrf.model.messages.named_arguments import named_arguments

Array = np.ndarray

SAMPLES = 4  # per piece: starts of Newton's method for a foot
FOOT_STEPS = 20  # from a sample five suffice; more where the curvature jumps between pieces
FOOT_STALLED = 1e-14  # of the length: smaller steps end the iteration
FLATTEST = 0.25  # of c'.c', lower bound of Newton's slope, also past the evolute
SEEDS = 96  # cells of the lattice along the longer side
MARGIN = 0.1  # of the extent: the lattice reaches beyond the curve
ANGLE = 0.02  # rad: largest angle of an arc per piece
UNIT = 1e-6  # deviation of a tangent's length from one that is accepted, and corrected
SAME = 1e-9  # of the extent: points nearer than that are one
ROUNDS = 4  # of the parameter of a spline towards its arc length: each gains two orders
FINER = 8  # of the pieces, for the arc length


@named_arguments
@dataclass(frozen=True, eq=False, kw_only=True)
class Curve:
    """A plane curve by points and tangents at knots, the material to its left.

    knots (n,) [m], increasing, the arc length; points (n, 2) [m]; tangents (n, 2), of unit length. `closed`: the last
    point is the first one. depth [m]: of the material behind an open curve, such as a part of the thickness of a tooth;
    deeper points are in free space; None: unlimited. `Curve.through` and `Curve.arcs` make the usual ones. Raises
    `InputError` for knots that do not increase, tangents without direction, a closed curve whose ends differ, and a
    curve that intersects itself.
    """

    knots: Any
    points: Any
    tangents: Any
    closed: bool = False
    depth: float | None = None

    def __post_init__(self) -> None:
        knots = require_array(self.knots, "curve: knots", (None,))
        points = require_array(self.points, "curve: points", (len(knots), 2))
        tangents = require_array(self.tangents, "curve: tangents", (len(knots), 2))
        if self.depth is not None:
            object.__setattr__(self, "depth", require_number(self.depth, "curve: depth", positive=True))
            if self.closed:
                raise InputError("curve: a closed curve has no depth; its material is all that it encloses")
        if len(knots) < 2 or np.any(np.diff(knots) <= 0.0):
            raise InputError("curve: knots must increase and be two or more")
        lengths = np.linalg.norm(tangents, axis=1)
        if not np.allclose(lengths, 1.0, rtol=0.0, atol=UNIT):
            worst = int(np.argmax(np.abs(lengths - 1.0)))
            raise InputError(
                f"curve: tangents must have the length 1, number {worst} has {lengths[worst]:.6g}: divide by the length"
            )
        for name, value in {"knots": knots, "points": points, "tangents": tangents}.items():
            value.flags.writeable = False
            object.__setattr__(self, name, value)
        if self.closed and np.linalg.norm(points[-1] - points[0]) > SAME * self.extent:
            raise InputError("curve: a closed curve must end where it starts; repeat the first point as the last")
        self._refuse_crossings()

    # --- common curves

    @classmethod
    def through(cls, points: Any, *, closed: bool = False) -> Curve:
        """The smooth curve (a spline, C2) through points (n, 2) [m] in the order of the material to the left.

        closed: it returns to the first point, which is not repeated. Raises `InputError` for fewer than three points,
        two that are the same, and a curve that intersects itself.
        """
        from scipy.interpolate import CubicSpline

        points = require_array(points, "curve: points", (None, 2))
        if len(points) < 3:
            raise InputError(f"curve: three points or more determine a smooth curve, got {len(points)}")
        if closed:
            points = np.concatenate([points, points[:1]])
        gaps = np.linalg.norm(np.diff(points, axis=0), axis=1)
        if gaps.min() <= SAME * np.ptp(points, axis=0).max():
            raise InputError(f"curve: points {int(np.argmin(gaps))} and the next are the same; leave one out")
        u = np.concatenate([[0.0], np.cumsum(gaps)])
        x, weight = np.polynomial.legendre.leggauss(FINER)
        for _ in range(ROUNDS):
            spline = CubicSpline(u, points, bc_type="periodic" if closed else "not-a-knot")
            h = np.diff(u)
            at = u[:-1, None] + 0.5 * (x + 1.0) * h[:, None]
            lengths = 0.5 * h * (np.linalg.norm(spline(at, 1), axis=-1) @ weight)
            u = np.concatenate([[0.0], np.cumsum(lengths)])
        spline = CubicSpline(u, points, bc_type="periodic" if closed else "not-a-knot")
        slope = spline(u, 1)
        return cls(knots=u, points=points, tangents=slope / np.linalg.norm(slope, axis=1, keepdims=True), closed=closed)

    @classmethod
    def arcs(cls, start: Any, heading: float, pieces: Sequence[tuple[float, float]], *, closed: bool = False) -> Curve:
        """Arcs and straight lines that continue one another without a kink.

        start (2,) [m]; heading [rad], direction of the first tangent from +x; pieces: (length [m], radius [m]) of each,
        the radius positive where the curve turns to the left (convex), infinite for a line. closed: they end where
        they start. Raises `InputError` for lengths that are not positive, a radius of 0, and a curve that intersects
        itself, or does not close.
        """
        at, angle = require_array(start, "curve: start", (2,)).copy(), require_number(heading, "curve: heading")
        u, points, headings = [0.0], [at.copy()], [angle]
        for number, (length, radius) in enumerate(pieces):
            name = f"curve: piece {number}"
            length = require_number(length, f"{name}: length", positive=True)
            if not abs(radius) > 0.0:
                raise InputError(
                    f"{name}: radius must be a number other than 0, or infinite for a line, got {radius!r}"
                )
            kappa = 1.0 / radius
            count = max(int(np.ceil(abs(kappa) * length / ANGLE)), 1)
            for s in length * np.arange(1, count + 1) / count:
                half = 0.5 * kappa * s
                chord = s * np.sinc(half / np.pi)
                points.append(at + chord * np.array([np.cos(angle + half), np.sin(angle + half)]))
                headings.append(angle + kappa * s)
                u.append(u[0] + s + sum(float(piece[0]) for piece in pieces[:number]))
            at, angle = points[-1].copy(), headings[-1]
        tangents = np.stack([np.cos(headings), np.sin(headings)], axis=1)
        return cls(knots=u, points=points, tangents=tangents, closed=closed)

    # --- the curve

    @property
    def length(self) -> float:
        """Arc length [m]."""
        return float(self.knots[-1] - self.knots[0])

    @property
    def extent(self) -> float:
        """The larger side [m] of the rectangle about its points."""
        return float(np.ptp(self.points, axis=0).max())

    @cached_property
    def coefficients(self) -> Array:
        """(n - 1, 2, 4): x and y of each piece in ascending powers of u less its first knot."""
        h = np.diff(self.knots)[:, None]
        first, chord = self.points[:-1], np.diff(self.points, axis=0) / h
        t0, t1 = self.tangents[:-1], self.tangents[1:]
        return np.stack([first, t0, (3.0 * chord - 2.0 * t0 - t1) / h, (t0 + t1 - 2.0 * chord) / h**2], axis=-1)

    def at(self, u: Any, order: int = 0) -> Array:
        """c (..., 2) [m] at u [m], or its derivative of `order` 1 or 2."""
        u = np.asarray(u, float)
        if self.closed:
            u = self.knots[0] + np.remainder(u - self.knots[0], self.length)
        inside = np.clip(u, self.knots[0], self.knots[-1])
        piece = np.clip(np.searchsorted(self.knots, inside, side="right") - 1, 0, len(self.knots) - 2)
        s, c = (inside - self.knots[piece])[..., None], self.coefficients[piece]
        slope = c[..., 1] + s * (2.0 * c[..., 2] + s * 3.0 * c[..., 3])
        if order == 0:
            return c[..., 0] + s * (c[..., 1] + s * (c[..., 2] + s * c[..., 3])) + (u - inside)[..., None] * slope
        bend = np.where((u == inside)[..., None], 2.0 * c[..., 2] + 6.0 * s * c[..., 3], 0.0)
        return slope if order == 1 else bend

    def normal(self, u: Any) -> Array:
        """Unit normals (..., 2) away from the material at u [m]."""
        t = self.at(u, 1)
        return np.stack([t[..., 1], -t[..., 0]], axis=-1) / np.linalg.norm(t, axis=-1, keepdims=True)

    def curvature(self, u: Any) -> Array:
        """kappa (...) [1/m] at u [m], positive where the material is convex."""
        t, b = self.at(u, 1), self.at(u, 2)
        return (t[..., 0] * b[..., 1] - t[..., 1] * b[..., 0]) / np.linalg.norm(t, axis=-1) ** 3

    def foot(self, points: Any) -> tuple[Array, Array]:
        """u [m] of the nearest points to `points` (..., 2) [m], and the distances [m], positive outside the
        material; beyond an end those of the tangent there."""
        p = np.asarray(points, float)
        places, tree = self._samples
        off = p.reshape(-1, 2)
        found = places[tree.query(off)[1]]
        limit, moving = 2.0 * np.diff(self.knots).max(), np.arange(len(found))
        for _ in range(FOOT_STEPS):
            u = found[moving]
            away, slope = off[moving] - self.at(u), self.at(u, 1)
            square = np.sum(slope**2, axis=-1)
            steep = np.maximum(square - np.sum(away * self.at(u, 2), axis=-1), FLATTEST * square)
            step = np.sum(away * slope, axis=-1) / steep
            beyond = ~np.asarray(self.closed) & ((u <= self.knots[0]) | (u >= self.knots[-1]))
            step = np.where(beyond, step, np.clip(step, -limit, limit))
            found[moving] = u + step
            moving = moving[np.abs(step) > FOOT_STALLED * self.length]
            if not len(moving):
                break
        u = found.reshape(p.shape[:-1])
        if self.closed:
            u = self.knots[0] + np.remainder(u - self.knots[0], self.length)
        return u, np.sum((p - self.at(u)) * self.normal(u), axis=-1)

    def gap(self, points: Any) -> Array:
        """Distances [m] of `points` (..., 2) [m] from the material: as `foot`, but beyond an end, and below `depth`,
        all is free space, at the distance of the end or the curve."""
        p = np.asarray(points, float)
        u, distance = self.foot(p)
        if self.closed:
            return distance
        ends = np.clip(u, self.knots[0], self.knots[-1])
        distance = np.where(ends == u, distance, np.linalg.norm(p - self.at(ends), axis=-1))
        return distance if self.depth is None else np.where(distance < -self.depth, -distance, distance)

    @cached_property
    def seeds(self) -> tuple[Array, float, Array]:
        """Lower corner (2,) [m] and pitch [m] of a lattice, and the piece (columns, rows) nearest to the centre of
        each of its cells, -1 - piece below `depth`."""
        low, high = self.points.min(axis=0), self.points.max(axis=0)
        margin = max(MARGIN * self.extent, 1.5 * (self.depth or 0.0))
        low, high = low - margin, high + margin
        pitch = float((high - low).max()) / SEEDS
        counts = np.maximum(np.ceil((high - low) / pitch).astype(int), 1)
        x, y = (low[i] + pitch * (np.arange(counts[i]) + 0.5) for i in (0, 1))
        _, tree = self._samples
        centers = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
        nearest = np.minimum(tree.query(centers.reshape(-1, 2))[1] // SAMPLES, len(self.knots) - 2).reshape(counts)
        if self.depth is None:
            return low, pitch, nearest
        return low, pitch, np.where(self.foot(centers)[1] < -self.depth, -1 - nearest, nearest)

    def describe(self) -> dict[str, Any]:
        """Plain numbers and lists for hashing and files: the arguments."""
        return {
            "knots": self.knots.tolist(), "points": self.points.tolist(), "tangents": self.tangents.tolist(),
            "closed": self.closed, "depth": self.depth,
        }  # fmt: skip

    # --- inside

    @cached_property
    def _samples(self) -> tuple[Array, Any]:
        """Places (m,) [m] along the curve, SAMPLES a piece and the last knot, and the tree of their points."""
        from scipy.spatial import KDTree

        parts = np.arange(SAMPLES) / SAMPLES
        places = np.append((self.knots[:-1, None] + parts * np.diff(self.knots)[:, None]).ravel(), self.knots[-1])
        return places, KDTree(self.at(places))

    def _refuse_crossings(self) -> None:
        """Raises `InputError` where two chords of the curve intersect."""
        from scipy.spatial import KDTree

        a, d = self.points[:-1], np.diff(self.points, axis=0)
        low, high = np.minimum(a, a + d), np.maximum(a, a + d)
        reach = np.linalg.norm(d, axis=1).max()
        for i, j in sorted(KDTree(0.5 * (low + high)).query_pairs(reach * (1.0 + 1e-9))):
            if j - i < 2 or (self.closed and i == 0 and j == len(a) - 1):
                continue
            if np.any(low[i] > high[j]) or np.any(low[j] > high[i]):
                continue
            across = d[i, 0] * d[j, 1] - d[i, 1] * d[j, 0]
            if across == 0.0:
                continue
            between = a[j] - a[i]
            s = (between[0] * d[j, 1] - between[1] * d[j, 0]) / across
            t = (between[0] * d[i, 1] - between[1] * d[i, 0]) / across
            if 0.0 < s < 1.0 and 0.0 < t < 1.0:
                x, y = a[i] + s * d[i]
                raise InputError(
                    f"curve: it intersects itself at ({x:.6g}, {y:.6g}) m, between knots {self.knots[i]:.6g} and "
                    f"{self.knots[j + 1]:.6g} m; correct the points there"
                )
