r"""Bilinear shape functions over a chart (x around, z along) in metres, and the operators of Reynolds' equation.

With the gap h, the viscosity mu, the transport speed U of the oil (the mean of both surfaces, relative to the first)
and the cavity volume per area D,

    d(h - D)/dt + div(U (h - D)) - div(h^3/(12 mu) grad p) = 0,      p >= 0, D >= 0, p D = 0,

tested with the shape functions psi_i and integrated at points x_k with weights w_k:

    sum_j A_ij p_j - sum_k w_k h U.grad psi_i + sum_k w_k psi_i h' - m_i D_i' - (T D)_i = 0,
    A_ij = sum_k w_k h^3/(12 mu) grad psi_i.grad psi_j,      m_i = int psi_i.

T D is the net outflow of cavity volume from the box around node i, each box with the upstream value (donor cell): its
columns sum to zero except at open edges, its off-diagonal entries are not positive.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

Array = np.ndarray


class FilmGrid:
    """Nodes x (columns,) by z (rows,) [m], ascending; node (j, k) has the number j*rows + k.

    period [m]: of the chart along x, None for an edge at both ends. points: Gauss points per cell, across and along.
    """

    def __init__(
        self, x: Array, z: Array, *, period: float | None = None, points: tuple[int, int] = (3, 2)
    ) -> None:  # fmt: skip
        self.x, self.z, self.period = np.asarray(x, dtype=float), np.asarray(z, dtype=float), period
        self.columns, self.rows = len(self.x), len(self.z)
        self.count = self.columns * self.rows
        closed = np.append(self.x, self.x[0] + period) if period is not None else self.x
        self._dx, self._dz = np.diff(closed), np.diff(self.z)
        self._next = (np.arange(len(self._dx)) + 1) % self.columns
        self._lay_points(*points)
        self.wide = _half_widths(self._dx, period is not None)
        """(columns,) m, of the boxes around nodes."""
        self.long = _half_widths(self._dz, False)
        """(rows,) m."""
        self.area = np.outer(self.wide, self.long).ravel()
        """(nodes,) m2, m_i."""

    def _lay_points(self, across: int, along: int) -> None:
        """at (points, 2), weights (points,), and value, slope_x, slope_z: csr (points, nodes)."""
        a, wa = np.polynomial.legendre.leggauss(across)
        b, wb = np.polynomial.legendre.leggauss(along)
        a, b = (v.ravel() for v in np.meshgrid(0.5 * (a + 1.0), 0.5 * (b + 1.0), indexing="ij"))
        w = 0.25 * np.outer(wa, wb).ravel()
        cell_x, cell_z = (
            v.ravel() for v in np.meshgrid(np.arange(len(self._dx)), np.arange(len(self._dz)), indexing="ij")
        )
        dx, dz = self._dx[cell_x][:, None], self._dz[cell_z][:, None]
        left, right = cell_x * self.rows + cell_z, self._next[cell_x] * self.rows + cell_z
        corners = np.stack([left, left + 1, right, right + 1], axis=1)  # (cells, 4)
        value = np.stack([(1 - a) * (1 - b), (1 - a) * b, a * (1 - b), a * b], axis=1)
        by_a = np.stack([-(1 - b), -b, 1 - b, b], axis=1)
        by_b = np.stack([-(1 - a), 1 - a, -a, a], axis=1)
        cells, per_cell = len(corners), len(a)
        rows = np.repeat(np.arange(cells * per_cell), 4)
        columns = np.broadcast_to(corners[:, None, :], (cells, per_cell, 4)).ravel()

        def operator(entries: Array) -> sp.csr_matrix:
            entries = np.broadcast_to(entries, (cells, per_cell, 4)).ravel()
            return sp.csr_matrix((entries, (rows, columns)), shape=(cells * per_cell, self.count))

        self.value = operator(value[None])
        self.slope_x, self.slope_z = operator(by_a[None] / dx[:, :, None]), operator(by_b[None] / dz[:, :, None])
        self.weights = (w[None] * dx * dz).ravel()
        at_x, at_z = self.x[cell_x][:, None] + a[None] * dx, self.z[cell_z][:, None] + b[None] * dz
        self.at = np.stack([at_x.ravel(), at_z.ravel()], axis=1)

    def diffusion(self, conductance: Array) -> sp.csr_matrix:
        """A (nodes, nodes) for h^3/(12 mu) (points,)."""
        D = sp.diags(self.weights * conductance)
        return (self.slope_x.T @ D @ self.slope_x + self.slope_z.T @ D @ self.slope_z).tocsr()

    def carried(self, gap: Array, u: Array | float, v: Array | float = 0.0) -> Array:
        """(nodes,) m3/s, sum w_k h U.grad psi_i: the inflow to a node's test with the flow U h; gap, u, v (points,)."""
        return self.slope_x.T @ (self.weights * gap * u) + self.slope_z.T @ (self.weights * gap * v)

    def integral(self, values: Array) -> Array:
        """(nodes,), sum w_k psi_i f_k of f (points,)."""
        return self.value.T @ (self.weights * values)

    def outflow(self, u: float, v: float = 0.0) -> sp.csr_matrix:
        """T (nodes, nodes) [m2/s] for one speed of the whole chart [m/s]."""
        number = np.arange(self.count).reshape(self.columns, self.rows)
        total = sp.csr_matrix((self.count, self.count))
        if u != 0.0:
            one = number if self.period is not None else number[:-1]
            other = np.roll(number, -1, axis=0) if self.period is not None else number[1:]
            total = total + self._donated(one, other, np.broadcast_to(self.long, one.shape), u)
        if v != 0.0:
            one, other = number[:, :-1], number[:, 1:]
            total = total + self._donated(one, other, np.broadcast_to(self.wide[:, None], one.shape), v)
        return total.tocsr()

    def _donated(self, one: Array, other: Array, width: Array, speed: float) -> sp.csr_matrix:
        donor, taker = (one, other) if speed > 0.0 else (other, one)
        flow = np.abs(speed) * width.ravel()
        rows = np.concatenate([donor.ravel(), taker.ravel()])
        columns = np.concatenate([donor.ravel(), donor.ravel()])
        return sp.csr_matrix((np.concatenate([flow, -flow]), (rows, columns)), shape=(self.count, self.count))


def _half_widths(steps: Array, closed: bool) -> Array:
    """Widths of the boxes around nodes that are `steps` apart."""
    if closed:
        return 0.5 * (steps + np.roll(steps, 1))
    return 0.5 * (np.append(steps, 0.0) + np.append(0.0, steps))
