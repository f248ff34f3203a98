r"""Definition of a cell or facet kind: reference nodes and the monomials of its shape functions.

With as many monomials `m_i(xi)` as nodes `xi_a`, the shape functions follow from `N_a(xi_b) = delta_ab`: with the
Vandermonde matrix `V_bi = m_i(xi_b)`,

    N_a(xi) = sum_i (V^-1)_ia m_i(xi),      dN_a/dxi likewise from the derivatives of the monomials.

Tensor-product, simplex and serendipity elements differ only in these two tables. A face is named by its corners, in an
order whose right-hand normal points outwards; the nodes in the middle of its edges, and of the face itself, are found
as the reference nodes at the mean of the corners.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Lagrange:
    """Nodal shape functions on reference `nodes` (k, dim) spanned by monomials with exponents `powers` (k, dim)."""

    name: str
    domain: str  # "hex", "wedge", "tet", "quad" or "tri"
    nodes: Array
    powers: Array
    corner_count: int

    @cached_property
    def _inverse(self) -> Array:
        return np.linalg.inv(monomials(self.nodes, self.powers))

    @property
    def degree(self) -> int:
        """Polynomial degree along an edge: 1 or 2."""
        return 1 if len(self.nodes) == self.corner_count else 2

    def shape(self, xi: Array) -> tuple[Array, Array]:
        """Shape functions (q, k) and their reference gradients (q, k, dim) at points `xi` (q, dim)."""
        values = monomials(xi, self.powers) @ self._inverse
        slopes = [_slopes(xi, self.powers, d) @ self._inverse for d in range(self.nodes.shape[1])]
        return values, np.stack(slopes, axis=2)


@dataclass(frozen=True, eq=False)
class FacetKind(Lagrange):
    """A kind of facet; `triangles` (t, 3) split it at its own nodes, outwards like the facet, for pictures."""

    triangles: Array


@dataclass(frozen=True, eq=False)
class CellKind(Lagrange):
    """A kind of volume cell: its `faces` {facet kind: (f, kf) local node numbers, outward}, a quadrature rule exact for
    its volume, and the exponents of the polynomial in which the dilatation of a nearly incompressible material is
    taken, None where there is none (`warpffrf.offline.fe`)."""

    faces: dict[str, Array]
    quadrature_points: Array  # (q, 3)
    quadrature_weights: Array  # (q,)
    dilatation: Array | None = None  # (m, 3)

    def jacobians(self, coordinates: Array, xi: Array) -> Array:
        """Determinants (m, q) of dx/dxi for cells with node `coordinates` (m, k, 3) at points `xi` (q, 3)."""
        columns = np.tensordot(coordinates, self.shape(xi)[1], axes=([1], [1]))  # (m, 3, q, 3 reference axes)
        return determinants(columns.transpose(0, 2, 1, 3))


def determinants(J: Array) -> Array:
    """Determinants (...) of 3x3 matrices (..., 3, 3), written out: ten times faster than a factorisation of each."""
    (a, b, c), (d, e, f), (g, h, i) = (np.moveaxis(J[..., row, :], -1, 0) for row in range(3))
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def monomials(xi: Array, powers: Array) -> Array:
    """Values (q, k) of the monomials with exponents `powers` (k, dim) at points `xi` (q, dim)."""
    return np.prod(xi[:, None, :] ** powers[None], axis=2)


def _slopes(xi: Array, powers: Array, axis: int) -> Array:
    lowered = powers.copy()
    lowered[:, axis] = np.maximum(lowered[:, axis] - 1, 0)
    return powers[:, axis] * monomials(xi, lowered)


def means(corners: Array, groups: tuple[tuple[int, ...], ...]) -> Array:
    """Mean (g, dim) of each group of corners: mid-edge, mid-face and middle nodes."""
    return np.array([corners[list(group)].mean(axis=0) for group in groups])


def complete_faces(nodes: Array, corner_faces: tuple[tuple[int, ...], ...], *, edges: bool, center: bool) -> Array:
    """Faces (f, kf): the given corners, then the nodes at the middle of their edges, then of the face."""
    faces = []
    for corners in corner_faces:
        x = nodes[list(corners)]
        extra = [0.5 * (x[i] + x[(i + 1) % len(x)]) for i in range(len(x))] if edges else []
        if center:
            extra.append(x.mean(axis=0))
        faces.append([*corners, *(int(np.argmin(np.linalg.norm(nodes - e, axis=1))) for e in extra)])
    return np.array(faces, dtype=np.int64)


def gauss(points: int) -> tuple[Array, Array]:
    """Gauss-Legendre points and weights on [-1, 1]."""
    return np.polynomial.legendre.leggauss(points)


def triangle_rule(points: int) -> tuple[Array, Array]:
    """Product rule on the unit triangle by Duffy's map, `points` per direction: exact to degree 2 points - 2."""
    x, w = gauss(points)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    a, b = (v.ravel() for v in np.meshgrid(x, x, indexing="ij"))
    weights = np.outer(w, w).ravel() * (1.0 - a)
    return np.stack([a, (1.0 - a) * b], axis=1), weights
