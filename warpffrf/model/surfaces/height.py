r"""Heights over a rectangle of a plane: a bicubic spline on a lattice of equal pieces.

x = h(u, v) e_0 + u e_1 + v e_a over |u| <= a, |v| <= b. With B the cubic B-spline of uniform knots, on i x j pieces,

    h(u, v) = sum_mn c_mn B_m(u) B_n(v),      n = (1, -h_u, -h_v)/sqrt(1 + h_u^2 + h_v^2),

C2: normals are smooth and curvatures continuous. Of a surface of radius R through points at distances d it errs by
about d^4/(128 R^3), 1e-9 m for 2 mm and 50 mm; the facets between the points by d^2/(8 R), 1e-5 m.

Fit. Nodes lie where they do, in number about that of the coefficients. Minimised is

    sum (h(u_k, v_k) - h_k)^2 + w sum (fourth differences of c)^2,

w small: the spline runs through the nodes, and is the smoothest one where they leave it free, at unequal nodes and in
corners without any. Third differences over the size of a piece also show an edge: on a smooth surface they are (d/R)^2,
across an edge of the order of its angle.

Foot. The nearest point to (y, p, q) is a root of (y - h) (h_u, h_v) + (p - u, q - v) = 0, by Newton's method; where its
matrix is not positive definite, beyond a centre of curvature, that of Gauss and Newton. Beyond the rectangle the chart
continues along the tangents at its border; the surface ends there, and beyond all is free space, at the distance of the
border.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError

Array = np.ndarray

# powers of the place in a piece (rows) of the four B-splines on it (columns)
SPLINES = np.array([[1.0, 4.0, 1.0, 0.0], [-3.0, 0.0, 3.0, 0.0], [3.0, -6.0, 3.0, 0.0], [-1.0, 3.0, -3.0, 1.0]]) / 6.0
FOURTH = (1.0, -4.0, 6.0, -4.0, 1.0)  # differences
SMOOTH = 1e-7  # w, per node and coefficient
REFINED = 3  # solutions of the residual, which restore what the squared condition costs
FEWEST = 16  # nodes: coefficients of a bicubic, which fourth differences leave free
SAMPLES = 3  # per piece and direction: starts of Newton's method for a foot
FOOT_STEPS = 40
FOOT_STALLED = 1e-12  # of the rectangle: smaller steps end the iteration
INDEFINITE = 0.05  # of the determinant of the metric: below, Gauss and Newton's matrix is taken
ON_BORDER = 1e-9  # of the rectangle: a foot whose rest along the surface is longer lies on the border
SHARP = 0.1  # third difference over the size of a piece of an edge: 1.3 degrees, or facets of a sixth of the radius


@dataclass(frozen=True, eq=False)
class Height:
    """A spline over a rectangle about the origin: half its sides (2,) [m], coefficients (columns + 3, rows + 3) [m] of
    its `counts` of pieces."""

    half: Array
    coefficients: Array

    @property
    def counts(self) -> Array:
        """Columns and rows of pieces (2,)."""
        return np.array(self.coefficients.shape) - 3

    @property
    def pitch(self) -> Array:
        """Sides (2,) [m] of a piece."""
        return 2.0 * self.half / self.counts

    @cached_property
    def pieces(self) -> Array:
        """(columns, rows, 4, 4): coefficients of each piece, in powers of the places in it from 0 to 1."""
        windows = np.lib.stride_tricks.sliding_window_view(self.coefficients, (4, 4))
        return np.einsum("am,bn,ijmn->ijab", SPLINES, SPLINES, windows)

    def at(self, u: Any, v: Any) -> tuple[Array, Array, Array]:
        """h [m], its gradient [-] (..., 2) and its second derivatives (..., 2, 2) [1/m] at u, v [m], any shape (...);
        beyond the rectangle along the tangents at its border, where second derivatives are those of the border."""
        u, v = np.broadcast_arrays(np.asarray(u, float), np.asarray(v, float))
        inside = [np.clip(x, -a, a) for x, a in zip((u, v), self.half, strict=True)]
        beyond = u - inside[0], v - inside[1]
        place, number = self._place(*inside)
        across, along = (_powers(x, d) for x, d in zip(place, self.pitch, strict=True))
        by = np.swapaxes(across, -1, -2) @ self.pieces[number[0], number[1]] @ along  # derivatives by u, by v
        mixed = by[..., 1, 1]
        h = by[..., 0, 0] + beyond[0] * by[..., 1, 0] + beyond[1] * by[..., 0, 1] + beyond[0] * beyond[1] * mixed
        gradient = np.stack([by[..., 1, 0] + beyond[1] * mixed, by[..., 0, 1] + beyond[0] * mixed], axis=-1)
        bend = np.stack([by[..., 2, 0], mixed, mixed, by[..., 0, 2]], axis=-1)
        return h, gradient, bend.reshape(*mixed.shape, 2, 2)

    def foot(self, points: Any, *, ends: bool = False) -> tuple[Array, Array, Array]:
        """u, v [m] of the nearest points to `points` (..., 3) [m], height first, and the distances [m], positive above
        the surface. ends: the surface ends at the border of the rectangle, beyond which distances are positive."""
        shape = np.shape(points)[:-1]
        p = np.asarray(points, float).reshape(-1, 3)
        places, tree = self._samples
        at, left = places[tree.query(p)[1]], np.arange(len(p))
        for _ in range(FOOT_STEPS):
            was = at[left]
            off, gradient, bend = self._off(p[left], was)
            metric = np.eye(2) + gradient[:, :, None] * gradient[:, None, :]
            matrix = metric - off[:, 0, None, None] * bend
            definite = (matrix[:, 0, 0] > 0.0) & (np.linalg.det(matrix) > INDEFINITE * np.linalg.det(metric))
            matrix = np.where(definite[:, None, None], matrix, metric)
            pull = off[:, 1:] + off[:, :1] * gradient
            held = ends & (np.abs(was) >= self.half) & (pull * was > 0.0)
            pull = np.where(held, 0.0, pull)
            matrix = np.where(held[:, :, None] | held[:, None, :], np.eye(2) * matrix, matrix)
            to = was + np.linalg.solve(matrix, pull[..., None])[..., 0]
            at[left] = to = np.clip(to, -self.half, self.half) if ends else to
            left = left[np.abs(to - was).max(axis=1) > FOOT_STALLED * self.half.max()]
            if not len(left):
                break
        off, gradient, _ = self._off(p, at)
        normal = unit_normal(gradient)
        distance = np.sum(off * normal, axis=-1)
        if ends:
            along = np.linalg.norm(off - distance[:, None] * normal, axis=-1)
            distance = np.where(along > ON_BORDER * self.half.max(), np.linalg.norm(off, axis=-1), distance)
        return at[:, 0].reshape(shape), at[:, 1].reshape(shape), distance.reshape(shape)

    def sharpest(self) -> tuple[float, Array]:
        """The largest third difference of the coefficients over the size of a piece, and its place (2,) [m]."""
        found = (0.0, np.zeros(2))
        for axis in (0, 1):
            across = np.abs(np.diff(self.coefficients, 3, axis=axis)) / self.pitch[axis]
            if across.size and across.max() > found[0]:
                number = np.array(np.unravel_index(np.argmax(across), across.shape), float)
                number[axis] += 1.5  # differences lie between the knots that they are of
                found = float(across.max()), np.clip((number - 1.0) * self.pitch - self.half, -self.half, self.half)
        return found

    @classmethod
    def fitted(cls, points: Array, spacing: float | None) -> Height:
        """Through `points` (n, 3) [m], height first; `spacing` [m] of pieces, as many as points where None. Raises
        `InputError` for too few points, and points on a line."""
        from scipy.sparse import csc_matrix, eye_array, kron, vstack
        from scipy.sparse.linalg import splu

        if len(points) < FEWEST:
            raise InputError(f"{len(points)} nodes determine no smooth surface, {FEWEST} at least are needed; refine")
        half = np.abs(points[:, 1:]).max(axis=0)
        if not half.min() > 1e-6 * half.max():
            raise InputError("the nodes lie on one line; choose other facets, or give outward")
        size = np.sqrt(4.0 * half.prod() / len(points)) if spacing is None else spacing
        counts = np.maximum(np.round(2.0 * half / size).astype(int), 2)
        empty = cls(half, np.zeros(counts + 3))
        place, number = empty._place(points[:, 1], points[:, 2])
        shares = [_powers(x, 1.0)[..., 0] @ SPLINES for x in place]
        columns = [number[axis][:, None] + np.arange(4) for axis in (0, 1)]
        entries = (shares[0][:, :, None] * shares[1][:, None, :]).reshape(len(points), 16)
        where = (columns[0][:, :, None] * (counts[1] + 3) + columns[1][:, None, :]).reshape(len(points), 16)
        rows, unknowns = np.repeat(np.arange(len(points)), 16), int((counts + 3).prod())
        A = csc_matrix((entries.ravel(), (rows, where.ravel())), shape=(len(points), unknowns))
        fourth = [sum(w * eye_array(n - 1, n + 3, k=k) for k, w in enumerate(FOURTH)) for n in counts]
        D = vstack([kron(fourth[0], eye_array(counts[1] + 3)), kron(eye_array(counts[0] + 3), fourth[1])])
        rough = SMOOTH * (D.T @ D)
        solver = splu(csc_matrix(A.T @ A + rough))
        c = np.zeros(unknowns)
        for _ in range(REFINED):
            c += solver.solve(A.T @ (points[:, 0] - A @ c) - rough @ c)
        return cls(half, c.reshape(counts + 3))

    # --- inside

    def _place(self, u: Any, v: Any) -> tuple[list[Array], list[Array]]:
        """Places in the pieces, 0 to 1 within them, and numbers of the pieces, along u and v."""
        both = np.broadcast_arrays(np.asarray(u, float), np.asarray(v, float))
        scaled = [(x + a) / d for x, a, d in zip(both, self.half, self.pitch, strict=True)]
        number = [np.clip(np.floor(x), 0, n - 1).astype(int) for x, n in zip(scaled, self.counts, strict=True)]
        return [x - i for x, i in zip(scaled, number, strict=True)], number

    def _off(self, p: Array, at: Array) -> tuple[Array, Array, Array]:
        """From the points at (u, v) to `p`, and gradient and second derivatives of h there."""
        h, gradient, bend = self.at(at[..., 0], at[..., 1])
        return p - np.concatenate([h[..., None], at], axis=-1), gradient, bend

    @cached_property
    def _samples(self) -> tuple[Array, Any]:
        """Places (m, 2) [m] on the surface, and the tree of their points."""
        from scipy.spatial import KDTree

        u, v = (np.linspace(-a, a, SAMPLES * n + 1) for a, n in zip(self.half, self.counts, strict=True))
        places = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
        h, _, _ = self.at(places[:, 0], places[:, 1])
        return places, KDTree(np.column_stack([h, places]))


def _powers(x: Array, size: float) -> Array:
    """Powers of the places (..., 4, 3) `x` in pieces of a `size` [m], and their first and second derivatives."""
    one, zero = x**0, 0.0 * x
    columns = [[one, x, x**2, x**3], [zero, one, 2.0 * x, 3.0 * x**2], [zero, zero, 2.0 * one, 6.0 * x]]
    return np.stack([np.stack(c, axis=-1) / size**order for order, c in enumerate(columns)], axis=-1)


def unit_normal(gradient: Array) -> Array:
    """(1, -h_u, -h_v) of unit length (..., 3), from the gradient (..., 2) of a height."""
    n = np.concatenate([np.ones((*gradient.shape[:-1], 1)), -gradient], axis=-1)
    return n / np.linalg.norm(n, axis=-1, keepdims=True)
