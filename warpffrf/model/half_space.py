r"""Displacements of half-spaces and quarter spaces under loads on rectangles, and splines of a body's far field.

Pressure. Love's integral: surface displacement of a half-space under constant pressure on a rectangle.

A. E. H. Love (1929), "The stress produced in a semi-infinite solid by pressure on part of the boundary"; K. L. Johnson,
"Contact Mechanics", 3.4. The displacement is (1 - nu^2)/(pi E) times the pressure times the integral.

Traction. Cerruti's integrals: tangential surface displacement of a half-space under constant traction on a rectangle,
and under pressure.

V. Cerruti (1882), J. Boussinesq (1885); K. L. Johnson, "Contact Mechanics", 1985, section 3.6. With x, z from the
loaded point to the field point, r^2 = x^2 + z^2, the shear modulus G and per unit force

    along x by a force along x: ((1 - nu)/r + nu x^2/r^3)/(2 pi G),      along z: nu x z/r^3/(2 pi G),
    along x by a force pushed into the material: -(1 - 2 nu)/(4 pi G) x/r^2,

and the last, with the other sign, is the displacement into the material by a force along x. Over a rectangle they
are sums over its corners of

    1/r: x asinh(z/|x|) + z asinh(x/|z|),    x^2/r^3: z asinh(x/|z|),    z^2/r^3: x asinh(z/|x|),    x z/r^3: -r,
    x/r^2: (z/2) ln r^2 + x atan(z/x).

Box means. Pressures on two grids as means over common boxes of a chart.

A contact has one pressure for each of its boxes: the mean over a cell of a contact-fixed grid, or over the cell around
a node. It does not resolve the pressure within a box, and the subdivision by one grid is not an error of another. So
both are compared as means over the boxes of the coarser grid, across and along for itself, continued to wherever either
has boxes:

    P_B = sum_j |B and box j| p_j / |B|,        |P|^2 = sum_B A_B P_B^2

Quarter surface. The surface of a quarter space: the contribution of a free end face in addition to the half-space under
a load near it and its mirror image, from a table computed by `warpffrf.offline.near_field.quarter_space`.

With `|x| = hypot(s, zeta)`, zeta the distance of a point and d that of the load from the end face, s along the edge,

    w(s, zeta; d) = g(t, theta)/(d + |x|),    t = |x|/(d + |x|),    theta = atan2(zeta, |s|),

g smooth on a box, as coefficients of a cubic spline. By Maxwell and Betti point and load may be exchanged; the mean of
both values is exactly symmetric.

Far splines. Displacements that are smooth on the scale of the contact grid, as quadratic splines on its columns and
rows.

The far field of a body under a contact patch varies over the spacing of the grid, and is required at any point between
the nodes, with a continuous slope: the kinks of bilinear functions would excite ripple in a moving patch. A
displacement is known by its means over the shape functions,

    m_j = int psi_j u dA / int psi_j dA,      u(theta, z) = sum_jk B_j(theta) B_k(z) sum Q_jj' Q_kk' m_j'k',

in each direction separately, psi the bilinear shape functions, or the cells of tangential displacements, whose
coefficients are the means. Both kinds have the same splines and differ in Q, by the moments of their functions. A row
of Q takes the `TAPS` nearest means so that every parabola is reproduced, that a field which alternates from function to
function is mapped to zero, and has the smallest norm of those. A mesh's own error near a load shows in the first and
second neighbours of the load, that is in alternating components: a projection, which would reproduce them, amplifies
them five times at each end of a compliance, and had ten times the ripple.

Around a full revolution of c columns B_j is centred on column j, its knots half-way between columns. Between two ends
there are as many splines as nodes: the knots are the ends, three times, and the middles between nodes except the
outermost two.

Forces are mapped in reverse: a force at (theta, z) is a force B_j(theta) B_k(z) on each spline, and Q^T maps it to the
nodal loads. With nodal coefficients a of displacements and nodal forces f (`ContactSurface`), and m = diag(1/area) M a,

    splines = Z a,   nodal forces = Z^T spline forces,   Z = Q diag(1/area) M,   D among splines = Z D Z^T,

and Z = Q of cells, whose Gram matrix M is diag(area).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import BSpline

from warpffrf.model.errors import InputError
from warpffrf.model.reduced.contact_grid import GAUSS_PER_ROW, SurfaceGrid, cell_edges

Array = np.ndarray


def rectangle(x: Any, z: Any, width: Any, length: Any) -> Array:
    """Integral of 1/r [m] over a rectangle about the origin, seen from (x, z)."""
    a, b = 0.5 * width, 0.5 * length
    return _corner(x + a, z + b) - _corner(x + a, z - b) - _corner(x - a, z + b) + _corner(x - a, z - b)


def _corner(x: Array, z: Array) -> Array:
    """The integral over the rectangle between the origin and (x, z), odd in both."""

    def part(s: Array, t: Array) -> Array:
        return s * np.arcsinh(t / np.where(s == 0.0, np.inf, np.abs(s)))

    return part(x, z) + part(z, x)


def along_x(x: Any, z: Any, width: Any, length: Any) -> Array:
    """Integral of x^2/r^3 [m] over a rectangle of `width` along x and `length` along z about the origin, seen from
    (x, z)."""
    return _over(lambda a, b: _product(b, a), x, z, width, length)


def along_z(x: Any, z: Any, width: Any, length: Any) -> Array:
    """Integral of z^2/r^3 [m]."""
    return _over(_product, x, z, width, length)


def across(x: Any, z: Any, width: Any, length: Any) -> Array:
    """Integral of x z/r^3 [m]."""
    return _over(lambda a, b: -np.hypot(a, b), x, z, width, length)


def toward_x(x: Any, z: Any, width: Any, length: Any) -> Array:
    """Integral of x/r^2 [m]."""

    def corner(a: Array, b: Array) -> Array:
        r2 = a * a + b * b
        angle = np.arctan(b / np.where(a == 0.0, np.inf, a))
        return 0.5 * b * np.log(np.where(r2 == 0.0, 1.0, r2)) + a * angle

    return _over(corner, x, z, width, length)


def toward_z(x: Any, z: Any, width: Any, length: Any) -> Array:
    """Integral of z/r^2 [m]."""
    return toward_x(z, x, length, width)


def _product(s: Array, t: Array) -> Array:
    return s * np.arcsinh(t / np.where(s == 0.0, np.inf, np.abs(s)))


def _over(corner: Callable[[Array, Array], Array], x: Any, z: Any, width: Any, length: Any) -> Array:
    """Sum of `corner` over the corners of the rectangle."""
    a, b = 0.5 * width, 0.5 * length
    x, z, a, b = np.broadcast_arrays(x, z, a, b)
    return corner(x + a, z + b) - corner(x + a, z - b) - corner(x - a, z + b) + corner(x - a, z - b)


@dataclass(frozen=True, eq=False)
class Boxes:
    """Pressures p (columns, rows) [Pa] of boxes between lines x (columns + 1,) and z (rows + 1,) [m], ascending."""

    x: Array
    z: Array
    p: Array

    def means(self, x: Array, z: Array) -> Array:
        """(n, m) Pa, means over the boxes between lines x (n + 1,) and z (m + 1,); beyond the own ones p is zero."""
        return _shares(x, self.x) @ self.p @ _shares(z, self.z).T


def squares(one: Boxes, reference: Boxes, scale: Callable[[Array], Array] = np.ones_like) -> tuple[float, float]:
    """int (p - p_ref)^2 dA and int p_ref^2 dA [Pa2 m2], of means over common boxes; scale: dA/(dx dz) at heights z
    (m,), which lie within those of the two."""
    x, z = _common(one.x, reference.x), _common(one.z, reference.z)
    ends = min(one.z[0], reference.z[0]), max(one.z[-1], reference.z[-1])
    middle = np.clip(0.5 * (z[:-1] + z[1:]), *ends)
    area = np.diff(x)[:, None] * (np.broadcast_to(scale(middle), middle.shape) * np.diff(z))
    p, p_ref = one.means(x, z), reference.means(x, z)
    return float((area * (p - p_ref) ** 2).sum()), float((area * p_ref**2).sum())


def _shares(lines: Array, of: Array) -> Array:
    """(n, m), how much of each interval between `lines` (n + 1,) lies in each of those between `of` (m + 1,)."""
    low = np.maximum(lines[:-1, None], of[None, :-1])
    high = np.minimum(lines[1:, None], of[None, 1:])
    return np.maximum(high - low, 0.0) / np.diff(lines)[:, None]


def _common(one: Array, other: Array) -> Array:
    """Lines of the coarser of two grids, continued by its outermost widths until they span both."""
    wide = max((one, other), key=lambda lines: float(np.diff(lines).mean()))
    low, high = min(one[0], other[0]), max(one[-1], other[-1])
    first, last = wide[1] - wide[0], wide[-1] - wide[-2]
    before = int(np.ceil((wide[0] - low) / first))
    behind = int(np.ceil((high - wide[-1]) / last))
    return np.concatenate([
        wide[0] - first * np.arange(before, 0, -1), wide, wide[-1] + last * np.arange(1, behind + 1)
    ])  # fmt: skip


DEGREE = 3


@dataclass(frozen=True, eq=False)
class QuarterSurface:
    """Spline `coefficients` (t, theta) of g times Young's modulus, two more than nodes along each axis."""

    coefficients: Array

    def displacement(self, s: ArrayLike, zeta: ArrayLike, d: ArrayLike) -> Array:
        """Depth component (...) of w [1/m], per unit load and times Young's modulus, at the points (s, zeta) [m] under
        loads at d [m]; they are broadcast. Not finite where a point on the edge coincides with a load on it. Raises
        `InputError` for points or loads outside the material."""
        x, z, load = np.broadcast_arrays(*(np.asarray(a, float) for a in (s, zeta, d)))
        require_inside(z, load)
        return 0.5 * (self._read(x, z, load) + self._read(x, load, z))

    def _read(self, s: Array, zeta: Array, d: Array) -> Array:
        from scipy.ndimage import map_coordinates

        radius = np.hypot(s, zeta)
        steps = np.array(self.coefficients.shape) - 3
        places = (radius / (radius + d), np.arctan2(zeta, np.abs(s)) / (0.5 * np.pi))
        at = [(place * n + 1.0).ravel() for place, n in zip(places, steps, strict=True)]
        g = map_coordinates(self.coefficients, at, order=DEGREE, prefilter=False)
        return g.reshape(radius.shape) / (radius + d)


def require_inside(*distances: Array) -> None:
    """Raises `InputError` for a negative distance."""
    if any(np.any(a < 0.0) for a in distances):
        raise InputError("quarter space: distance from the end face, depth and place of the load must not be negative")


SPLINE_DEGREE = 2
# Of functions around a full revolution, in pitches: second moment about the middle, and the row of the Gram matrix.
VARIANCE = {"nodes": 1.0 / 6.0, "cells": 1.0 / 12.0}
OVERLAP = {"nodes": ((-1, 1.0 / 6.0), (0, 2.0 / 3.0), (1, 1.0 / 6.0)), "cells": ((0, 1.0),)}
TAPS = 5  # 3 reproduce parabolas, but also alternating components, with five times the ripple on hex8; 7 smooth more


@dataclass(frozen=True, eq=False)
class FarSplines:
    """The splines of a contact `grid` of bilinear functions or cells on a resolved `shape`; `turn`: columns of the full
    revolution that the grid is part of, 0 for an arc or a plane that is not."""

    grid: SurfaceGrid
    shape: Any
    turn: int

    @cached_property
    def z_knots(self) -> Array:
        """Knots (rows + degree + 1,) [m] along the meridian."""
        return _knots(self.grid.z)

    @cached_property
    def theta_knots(self) -> Array:
        """Knots (columns + degree + 1,) [rad, on a plane m] between two ends. On a full revolution those of column j
        begin 1.5 pitches before it."""
        return _knots(self.grid.theta)

    def around(self, theta: Any) -> Array:
        """Values (n, columns) of the splines at theta (n,)."""
        g, theta = self.grid, np.atleast_1d(np.asarray(theta, dtype=float))
        if not self.turn:
            return _values(self.theta_knots, g.columns, theta)
        x = (theta - g.theta_start) / g.pitch
        j = np.rint(x).astype(np.int64)
        d = x - j
        found = np.zeros((len(theta), self.turn))
        for step, value in ((-1, 0.5 * (0.5 - d) ** 2), (0, 0.75 - d * d), (1, 0.5 * (0.5 + d) ** 2)):
            np.add.at(found, (np.arange(len(theta)), (j + step) % self.turn), value)
        return found[:, : g.columns]

    def along(self, z: Any) -> Array:
        """Values (n, rows) of the splines at z (n,) [m]."""
        return _values(self.z_knots, self.grid.rows, np.atleast_1d(np.asarray(z, dtype=float)))

    @cached_property
    def z_transform(self) -> Array:
        """Z (rows, rows) along the meridian, with the measure of the shape."""
        at, weight, functions = _function_points(self.grid.kind, self.grid.z)
        weight = weight * self.shape.measure_at(at)
        return _functionals(self.z_knots, _moments(at, weight, functions)) @ (
            self.grid.gram_z(self.shape) / (functions.T @ weight)[:, None]
        )

    @cached_property
    def theta_transform(self) -> Array:
        """Z (columns, columns) around; where the grid is an arc of a full revolution, of its columns alone."""
        g = self.grid
        if self.turn == g.columns:
            row = self._turn_row
            return row[(np.arange(self.turn)[:, None] - np.arange(self.turn)) % self.turn]
        theta = np.concatenate([[g.theta[0] - g.pitch], g.theta, [g.theta[-1] + g.pitch]])
        at, weight, functions = _function_points(g.kind, theta)
        functions = functions[:, 1:-1]  # whole ones, which end beyond the outermost columns
        moments = _moments(at, weight, functions)
        knots = self.theta_knots
        if self.turn:
            knots = g.theta_start + g.pitch * (np.arange(g.columns + SPLINE_DEGREE + 1) - 0.5 * (SPLINE_DEGREE + 1))
        return _functionals(knots, moments) @ (g.gram_theta() / (functions.T @ weight)[:, None])

    @cached_property
    def _turn_row(self) -> Array:
        """First column (turn,) of the circulant Z of the full revolution."""
        taps = min(TAPS, self.turn - (self.turn + 1) % 2)
        near = np.arange(taps) - taps // 2
        Q = _functionals(np.arange(-1.5, 2.0), (near.astype(float), near**2 + VARIANCE[self.grid.kind]))[0]
        row = np.zeros(self.turn)
        for offset, share in OVERLAP[self.grid.kind]:
            np.add.at(row, (near + offset) % self.turn, share * Q)
        return row

    def of_nodes(self, values: Array) -> Array:
        """`of_functions` of a grid of bilinear functions."""
        return self.of_functions(values)

    def of_functions(self, values: Array) -> Array:
        """Z `values` (columns rows, ...) of coefficients of the grid's functions."""
        g = self.grid
        v = values.reshape(g.columns, g.rows, -1)
        v = np.einsum("ij,jkm->ikm", self.theta_transform, v)
        return np.einsum("kl,jlm->jkm", self.z_transform, v).reshape(values.shape)

    def compliance(self, lags: Array, directions: int = 1) -> Array:
        """Z D Z^T in the layout of `lags` (sectors, directions c rows, directions c rows), of D among functions in that
        layout; Z acts on each direction separately."""
        return self.sources(self.targets(lags, directions), directions)

    def targets(self, lags: Array, directions: int = 1) -> Array:
        """Z times D (sectors, directions c rows, lines), of which the targets are functions of this grid."""
        sectors, rows = len(lags), self.grid.rows
        total = sectors * lags.shape[1] // (directions * rows)
        D = lags.reshape(sectors, directions, total // sectors, rows, -1).swapaxes(1, 2)
        D = D.reshape(total, directions, rows, -1)
        if total == self.turn:
            spectrum = np.fft.rfft(self._turn_row)[:, None, None, None]
            D = np.fft.irfft(np.fft.rfft(D, axis=0) * spectrum, n=total, axis=0)
        else:
            D = (self.theta_transform @ D.reshape(total, -1)).reshape(D.shape)
        D = (self.z_transform @ D).reshape(sectors, total // sectors, directions, rows, -1)
        return D.swapaxes(1, 2).reshape(lags.shape)

    def sources(self, lags: Array, directions: int = 1) -> Array:
        """D (sectors, lines, directions c rows) times Z^T, of which the sources are functions of this grid."""
        return np.ascontiguousarray(transposed(self.targets(transposed(lags), directions)))


def transposed(lags: Array) -> Array:
    """`lags` (sectors, sources, targets) of the transposed operator, of those (sectors, targets, sources) of one."""
    return np.roll(lags[::-1], 1, axis=0).transpose(0, 2, 1)


def _knots(nodes: Array) -> Array:
    degree = min(SPLINE_DEGREE, len(nodes) - 1)
    middles = 0.5 * (nodes[1:] + nodes[:-1])
    inner = middles[1:-1] if degree == SPLINE_DEGREE else np.zeros(0)
    return np.concatenate([[nodes[0]] * (degree + 1), inner, [nodes[-1]] * (degree + 1)])


def _values(knots: Array, count: int, x: Array) -> Array:
    return BSpline(knots, np.eye(count), len(knots) - count - 1, extrapolate=True)(x)


def _functionals(knots: Array, moments: tuple[Array, Array]) -> Array:
    """Q (splines, functions) of the splines on `knots`, by the functions' means of x and of x^2.

    The splines' coefficients of 1, x - xi and (x - xi)^2, xi the mean of a spline's inner knots t, are 1, 0 and the
    product of the t - xi (of two knots; 0 of one: a straight line has no parabola).
    """
    means, squares = moments
    count = len(means)
    splines = len(knots) - SPLINE_DEGREE - 1 if count > SPLINE_DEGREE else count
    degree = len(knots) - splines - 1
    Q = np.zeros((splines, count))
    for k in range(splines):
        inner = knots[k + 1 : k + 1 + degree]
        xi = inner.mean()
        near = np.sort(np.argsort(np.abs(means - xi), kind="stable")[: min(TAPS, count)])
        scale = np.ptp(means[near])
        x = (means[near] - xi) / scale
        x2 = (squares[near] - 2.0 * xi * means[near] + xi * xi) / scale**2
        rows, wanted = [np.ones(len(near)), x], [1.0, 0.0]
        if degree == SPLINE_DEGREE:
            rows, wanted = [*rows, x2], [*wanted, np.prod(inner - xi) / scale**2]
        if len(near) > len(rows):
            rows, wanted = [*rows, (-1.0) ** np.arange(len(near))], [*wanted, 0.0]
        Q[k, near] = np.linalg.lstsq(np.stack(rows), np.array(wanted), rcond=None)[0]
    return Q


def _moments(at: Array, weight: Array, functions: Array) -> tuple[Array, Array]:
    """Means of x and of x^2 over the functions (q, n), of x = `at` (q,)."""
    area = functions.T @ weight
    return functions.T @ (weight * at) / area, functions.T @ (weight * at * at) / area


def _function_points(kind: str, nodes: Array) -> tuple[Array, Array, Array]:
    """Points (q,), weights (q,) and values (q, nodes) of linear functions on `nodes` or of cells around them, of a rule
    without kinks or jumps between its points."""
    x, w = np.polynomial.legendre.leggauss(GAUSS_PER_ROW)
    lines = cell_edges(nodes) if kind == "cells" else nodes
    step = np.diff(lines)
    at = (lines[:-1, None] + step[:, None] * 0.5 * (x + 1.0)).ravel()
    weight = (0.5 * step[:, None] * w).ravel()
    if kind == "cells":
        return at, weight, np.repeat(np.eye(len(nodes)), GAUSS_PER_ROW, axis=0)
    return at, weight, np.stack([np.interp(at, nodes, row) for row in np.eye(len(nodes))], axis=1)
