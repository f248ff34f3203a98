r"""Exact compliances between the tractions of a uniform grid on a half-plane and a half-space.

Lengths are in half-widths of the patch, tractions in the peak pressure p0, displacements in p0 b / E' with
E' = E/(1 - nu^2). The normal displacement under a pressure p is then

    plane: u(x) = -(2/pi) int p(t) ln(|x - t|/L) dt,        space: u = (1/pi) int p(t) / |x - t| dA,

L the depth of the fixed point. `a(p, q) = int p u[q]` is the compliance energy (twice the elastic one).

**Between functions of the grid** it depends on their distance only. Hat functions of a grid of spacing s, correlated
with each other, are `s B3(x/s)`, cells `s B1(x/s)`, with B the B-splines of degree 3 and 1. So

    plane: a_k = -(2/pi) delta^n F_n / s^(n-2),    F_n'...' = ln|x| n times, n = 4 (nodes) or 2 (cells),
    space: a_kl = (s_x s_y)^2 / pi  int int B(t - k) B(v - l) / sqrt(s_x^2 t^2 + s_y^2 v^2) dt dv,

delta the central difference of step s. The second integral is cut along the lines of the grid, and into squares; the
square at the origin is halved along its diagonal and mapped by t = r, v = r w (Duffy), which cancels the 1/r.

**Of Hertz's pressures** (K. L. Johnson, Contact Mechanics, 1985, sections 3.2 and 4.2): p = sqrt(1 - x^2), and on an
ellipse of semi-axes b, a p = sqrt(1 - x^2/b^2 - y^2/a^2), whose potential is

    u = (a b / 2) int_l^inf (1 - x^2/(b^2 + t) - y^2/(a^2 + t)) dt / sqrt((a^2 + t) (b^2 + t) t),

l = 0 inside, else the root of 1 = x^2/(b^2 + l) + y^2/(a^2 + l): Carlson's integrals R_F and R_D.
"""

from __future__ import annotations

import numpy as np
from scipy.special import elliprd, elliprf

Array = np.ndarray
DEGREE = {"nodes": 3, "cells": 1}  # of the B-spline that is the autocorrelation of a function of the grid
GAUSS = 10  # points each way in a square: 1e-9 next to the one at the origin
INVERSE_REACH = 16  # the inverse of the Gram matrix decays by 0.27 per node: 1e-9 remains


def spline(degree: int, x: Array) -> Array:
    """The B-spline of unit integral, degree 1 or 3, centred at 0, knots 1 apart."""
    x = np.abs(x)
    if degree == 1:
        return np.maximum(1.0 - x, 0.0)
    return (np.maximum(2.0 - x, 0.0) ** 3 - 4.0 * np.maximum(1.0 - x, 0.0) ** 3) / 6.0


def plane_table(traction: str, spacing: float, count: int, depth: float) -> Array:
    """a_k (count,) between functions k spacings apart on a half-plane fixed at `depth` L."""
    n = DEGREE[traction] + 1
    x = spacing * (np.arange(count + n) - 0.5 * n)
    safe = np.where(x == 0.0, 1.0, np.abs(x))
    log = np.log(safe / depth)  # F_n(x) for ln|x|/L
    F = x**4 / 24.0 * (log - 25.0 / 12.0) if n == 4 else x**2 / 2.0 * (log - 1.5)
    return -2.0 / np.pi * np.diff(F, n=n) / spacing ** (n - 2)


def space_table(traction: str, spacing: tuple[float, float], counts: tuple[int, int]) -> Array:
    """a_kl (counts) between functions (k, l) spacings apart on a half-space."""
    degree = DEGREE[traction]
    reach = (degree + 1) // 2  # spacings from the middle to the end of B
    s = np.array(spacing)
    pieces = np.maximum(np.rint(s / s.min()).astype(int), 1)  # nearly square parts of a cell of the grid
    x, w = np.polynomial.legendre.leggauss(GAUSS)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    points, weights, offsets = [], [], []
    for axis in range(2):
        parts = (counts[axis] + reach) * pieces[axis]
        t = (np.arange(parts)[:, None] + x) / pieces[axis]
        k = np.arange(1 - reach, counts[axis])  # smaller k do not reach t > 0
        points.append(t)
        weights.append(np.tile(w / pieces[axis], (parts, 1)))
        offsets.append(k)
    # the quadrant t, v > 0: all parts but the one at the origin
    kernel = 1.0 / np.hypot(s[0] * points[0].reshape(-1, 1), s[1] * points[1].reshape(1, -1))
    kernel *= weights[0].reshape(-1, 1) * weights[1].reshape(1, -1)
    kernel[:GAUSS, :GAUSS] = 0.0
    B = [spline(degree, points[i].ravel()[None] - offsets[i][:, None]) for i in range(2)]
    quadrant = B[0] @ kernel @ B[1].T
    r, v = (m.ravel() for m in np.meshgrid(x, x, indexing="ij"))
    duffy = (w[:, None] * w[None]).ravel() * r / np.prod(pieces)
    for t0, t1 in ((r, r * v), (r * v, r)):
        t0, t1 = t0 / pieces[0], t1 / pieces[1]
        value = duffy / np.hypot(s[0] * t0, s[1] * t1)
        B = [spline(degree, t[None] - offsets[i][:, None]) for i, t in enumerate((t0, t1))]
        quadrant += (B[0] * value) @ B[1].T
    table = np.zeros(counts)
    for flip_x in (1, -1):
        for flip_y in (1, -1):
            i, j = (f * np.arange(n) for f, n in ((flip_x, counts[0]), (flip_y, counts[1])))
            here = np.ix_(*(np.maximum(k, 1 - reach) + reach - 1 for k in (i, j)))
            table += quadrant[here] * np.multiply.outer(i > -reach, j > -reach)
    return np.prod(s) ** 2 / np.pi * table


def facing(shift: float) -> Array:
    """Kernel r (2 n + 1,) that converts the table of one grid to that of the pressures of another, `shift` spacings
    away, which this one represents in its own functions: a'_k = sum_m r_m a_(k-m) in each direction.

    The second body has the L2 projection of the first one's functions, `l M^-1`, `l_k = s B3(k + shift)`,
    `(M^-1)_k = sqrt(3) (sqrt(3) - 2)^|k| / s`; r is the correlation of that with itself.
    """
    k = np.arange(-INVERSE_REACH, INVERSE_REACH + 1)
    inverse = np.sqrt(3.0) * (np.sqrt(3.0) - 2.0) ** np.abs(k)
    seen = np.convolve(inverse, spline(3, np.arange(-3, 4) + shift))
    return np.convolve(seen, seen[::-1])


def toeplitz(table: Array) -> Array:
    """The matrix (n, n) of a table of distances (n_1,) or (n_1, n_2), the last index fastest."""
    index = [np.abs(np.subtract.outer(np.arange(n), np.arange(n))) for n in table.shape]
    if table.ndim == 1:
        return table[index[0]]
    n = table.size
    return table[index[0][:, None, :, None], index[1][None, :, None, :]].reshape(n, n)


class LinePatch:
    """Hertz's line contact on a half-plane: half-width 1, peak pressure 1, fixed at `depth` L."""

    axes = (1.0,)

    def __init__(self, depth: float) -> None:
        self.depth = depth
        self.force = 0.5 * np.pi
        self.approach = np.log(2.0 * depth) + 0.5
        self.curvature = (1.0,)  # u = approach - x^2 inside
        self.energy = self.force * (self.approach - 0.25)

    def table(self, traction: str, spacing: tuple[float, ...], counts: tuple[int, ...]) -> Array:
        """Compliances (counts) between functions of a grid by their distance."""
        return plane_table(traction, spacing[0], counts[0], self.depth)

    def pressure(self, x: Array) -> Array:
        """p/p0 at x/b."""
        return np.sqrt(np.maximum(1.0 - x**2, 0.0))

    def displacement(self, x: Array) -> Array:
        """u E'/(p0 b) at x/b, in and outside the patch."""
        out = np.maximum(np.abs(x), 1.0)
        root = np.sqrt(out**2 - 1.0)
        return self.approach - x**2 + out * root - np.arccosh(out)


class EllipsePatch:
    """Hertz's point contact: semi-axes 1 (across, x) and `ratio` (along, y), peak pressure 1."""

    def __init__(self, ratio: float) -> None:
        self.axes = (1.0, float(ratio))
        b2, a2 = 1.0, float(ratio) ** 2
        self.force = 2.0 * np.pi * ratio / 3.0
        self.approach = ratio * float(elliprf(0.0, a2, b2))
        self.curvature = (ratio / 3.0 * float(elliprd(0.0, a2, b2)), ratio / 3.0 * float(elliprd(0.0, b2, a2)))
        self.energy = self.force * (self.approach - (self.curvature[0] * b2 + self.curvature[1] * a2) / 5.0)

    def table(self, traction: str, spacing: tuple[float, ...], counts: tuple[int, ...]) -> Array:
        """Compliances (counts) between functions of a grid by their distance."""
        return space_table(traction, (spacing[0], spacing[1]), (counts[0], counts[1]))

    def pressure(self, x: Array, y: Array) -> Array:
        """p/p0 at (x, y)/b."""
        return np.sqrt(np.maximum(1.0 - x**2 - (y / self.axes[1]) ** 2, 0.0))

    def displacement(self, x: Array, y: Array) -> Array:
        """u E'/(p0 b) at (x, y)/b, in and outside the patch."""
        b2, a2 = 1.0, self.axes[1] ** 2
        m = x**2 + y**2 - a2 - b2  # l^2 - m l - n = 0
        n = a2 * x**2 + b2 * y**2 - a2 * b2
        root = np.maximum(0.5 * (m + np.sqrt(np.maximum(m**2 + 4.0 * n, 0.0))), 0.0)
        F = elliprf(root, a2 + root, b2 + root)
        D_x, D_y = elliprd(root, a2 + root, b2 + root), elliprd(root, b2 + root, a2 + root)
        return self.axes[1] * (F - (x**2 * D_x + y**2 * D_y) / 3.0)
