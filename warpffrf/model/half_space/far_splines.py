r"""Displacements that are smooth beside the contact grid, as quadratic splines on its columns and rows.

What a body adds to the half-space under a patch of contact varies over the spacing of the grid's hats, and it is wanted
at any place between their nodes, with a continuous slope: the kinks of hats would be felt as ripple by a patch that
travels over them. A displacement is known by its means over the hats,

    m_j = int psi_j u dA / int psi_j dA,      u(theta, z) = sum_jk B_j(theta) B_k(z) sum Q_jj' Q_kk' m_j'k',

in each direction by itself, psi the hats, or the cells of tangential displacements, whose coefficients are the means.
Both kinds have the same splines and differ in Q, by the moments of their functions. A row of Q takes the `TAPS` nearest
means so that every parabola is reproduced, that a field which alternates from function to function gives nothing, and
is the shortest of those. A mesh's own error near a load shows in the first and second neighbours of the load, that is
in what alternates: a projection, which would reproduce it, enlarges it five times at each end of a compliance, and had
ten times the ripple.

Around a full turn of c columns B_j stands on column j, its knots half-way between columns. Between two ends there are
as many splines as hats: the knots are the ends, three times, and the middles between nodes but the outermost two.

Forces go the other way: a force at (theta, z) is a force B_j(theta) B_k(z) on each spline, and Q^T takes it to the
loads of the hats. With hat coefficients a of displacements and forces f of hats (`ContactSurface`), and
m = diag(1/area) M a,

    splines = Z a,   hat forces = Z^T spline forces,   Z = Q diag(1/area) M,   D among splines = Z D Z^T,

and Z = Q of cells, whose Gram matrix M is diag(area).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.interpolate import BSpline

from warpffrf.model.reduced.contact_grid import GAUSS_PER_ROW, ContactGrid, cell_edges

Array = np.ndarray
DEGREE = 2
# Of functions around a full turn, in pitches: second moment about the middle, and the row of the Gram matrix.
VARIANCE = {"hats": 1.0 / 6.0, "cells": 1.0 / 12.0}
OVERLAP = {"hats": ((-1, 1.0 / 6.0), (0, 2.0 / 3.0), (1, 1.0 / 6.0)), "cells": ((0, 1.0),)}
TAPS = 5  # 3 reproduce parabolas, but see what alternates, with five times the ripple on hex8; 7 smooth more


@dataclass(frozen=True, eq=False)
class FarSplines:
    """The splines of a contact `grid` of hats or cells on a resolved `shape`; `turn`: columns of the full
    turn that the grid is part of, 0 of an arc or a plane that is none."""

    grid: ContactGrid
    shape: Any
    turn: int

    @cached_property
    def z_knots(self) -> Array:
        """Knots (rows + degree + 1,) [m] along the meridian."""
        return _knots(self.grid.z)

    @cached_property
    def theta_knots(self) -> Array:
        """Knots (columns + degree + 1,) [rad, on a plane m] between two ends. On a full turn those of column j begin
        1.5 pitches before it."""
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
        """Z (columns, columns) around; where the grid is an arc of a full turn, of its columns alone."""
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
            knots = g.theta_start + g.pitch * (np.arange(g.columns + DEGREE + 1) - 0.5 * (DEGREE + 1))
        return _functionals(knots, moments) @ (g.gram_theta() / (functions.T @ weight)[:, None])

    @cached_property
    def _turn_row(self) -> Array:
        """First column (turn,) of the circulant Z of the full turn."""
        taps = min(TAPS, self.turn - (self.turn + 1) % 2)
        near = np.arange(taps) - taps // 2
        Q = _functionals(np.arange(-1.5, 2.0), (near.astype(float), near**2 + VARIANCE[self.grid.kind]))[0]
        row = np.zeros(self.turn)
        for offset, share in OVERLAP[self.grid.kind]:
            np.add.at(row, (near + offset) % self.turn, share * Q)
        return row

    def of_hats(self, values: Array) -> Array:
        """`of_functions` of a grid of hats."""
        return self.of_functions(values)

    def of_functions(self, values: Array) -> Array:
        """Z `values` (columns rows, ...) of coefficients of the grid's functions."""
        g = self.grid
        v = values.reshape(g.columns, g.rows, -1)
        v = np.einsum("ij,jkm->ikm", self.theta_transform, v)
        return np.einsum("kl,jlm->jkm", self.z_transform, v).reshape(values.shape)

    def compliance(self, lags: Array, directions: int = 1) -> Array:
        """Z D Z^T in the layout of `lags` (sectors, directions c rows, directions c rows), of D among functions in that
        layout; Z takes each direction by itself."""
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
    degree = min(DEGREE, len(nodes) - 1)
    middles = 0.5 * (nodes[1:] + nodes[:-1])
    inner = middles[1:-1] if degree == DEGREE else np.zeros(0)
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
    splines = len(knots) - DEGREE - 1 if count > DEGREE else count
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
        if degree == DEGREE:
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
    """Points (q,), weights (q,) and values (q, nodes) of hats on `nodes` or of cells around them, of a rule without
    kinks or jumps between its points."""
    x, w = np.polynomial.legendre.leggauss(GAUSS_PER_ROW)
    lines = cell_edges(nodes) if kind == "cells" else nodes
    step = np.diff(lines)
    at = (lines[:-1, None] + step[:, None] * 0.5 * (x + 1.0)).ravel()
    weight = (0.5 * step[:, None] * w).ravel()
    if kind == "cells":
        return at, weight, np.repeat(np.eye(len(nodes)), GAUSS_PER_ROW, axis=0)
    return at, weight, np.stack([np.interp(at, nodes, row) for row in np.eye(len(nodes))], axis=1)
