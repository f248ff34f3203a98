"""Reference cells: node positions, shape functions, faces and quadrature, in VTK node order.

A cell kind is its reference nodes `xi_a` and a list of monomials `m_i(xi)` with as many terms as nodes. The Lagrange
shape functions follow from `N_a(xi_b) = delta_ab`: with the Vandermonde matrix `V_bi = m_i(xi_b)`,

    N_a(xi) = sum_i (V^-1)_ia m_i(xi),      dN_a/dxi likewise from the derivatives of the monomials.

A face is named by its corners, in an order whose right-hand normal points outwards; the nodes in the middle of its
edges and of the face itself are found as the reference nodes at the mean of the corners. Orders follow VTK's file
formats (linear, quadratic and triquadratic cells), which are also meshio's.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from warpffrf.model.errors import unknown_name

_HEX_CORNERS = ((-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1))
_HEX_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
_HEX_FACE_CENTERS = ((-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1))
_HEX_FACES = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7))
_TET_CORNERS = ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))
_TET_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
_TET_FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))

FACET_CORNERS = {"quad4": 4, "quad9": 4, "tri3": 3, "tri6": 3}
FACET_NODES = {"quad4": 4, "quad9": 9, "tri3": 3, "tri6": 6}


@dataclass(frozen=True)
class CellKind:
    """One kind of cell: reference nodes, monomials, faces, and a quadrature rule exact for its volume."""

    name: str
    nodes: np.ndarray  # (k, 3) reference coordinates
    powers: np.ndarray  # (k, 3) exponents of the monomials
    facet_kind: str
    faces: np.ndarray  # (f, kf) local node numbers, outward
    quadrature_points: np.ndarray  # (q, 3)
    quadrature_weights: np.ndarray  # (q,)

    def shape(self, xi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Shape functions (q, k) and their reference gradients (q, k, 3) at points `xi` (q, 3)."""
        inverse = np.linalg.inv(_monomials(self.nodes, self.powers))
        values = _monomials(xi, self.powers) @ inverse
        gradients = np.stack([_monomial_slopes(xi, self.powers, d) @ inverse for d in range(3)], axis=2)
        return values, gradients

    def jacobians(self, coordinates: np.ndarray, xi: np.ndarray) -> np.ndarray:
        """Determinants (m, q) of dx/dxi for cells with node `coordinates` (m, k, 3) at points `xi` (q, 3)."""
        gradients = self.shape(xi)[1]
        columns = np.tensordot(coordinates, gradients, axes=([1], [1]))  # (m, 3 components, q, 3 reference axes)
        return np.linalg.det(columns.transpose(0, 2, 1, 3))


def _monomials(xi: np.ndarray, powers: np.ndarray) -> np.ndarray:
    return np.prod(xi[:, None, :] ** powers[None], axis=2)


def _monomial_slopes(xi: np.ndarray, powers: np.ndarray, axis: int) -> np.ndarray:
    lowered = powers.copy()
    lowered[:, axis] = np.maximum(lowered[:, axis] - 1, 0)
    return powers[:, axis] * _monomials(xi, lowered)


def _midpoints(corners: tuple, edges: tuple) -> list[np.ndarray]:
    return [0.5 * (np.array(corners[a], float) + np.array(corners[b], float)) for a, b in edges]


def _complete_faces(nodes: np.ndarray, corner_faces: tuple, with_center: bool) -> np.ndarray:
    """Faces with the nodes at the middle of their edges (and of the face) appended, found by position."""
    faces = []
    for corners in corner_faces:
        positions = nodes[list(corners)]
        extra = [0.5 * (positions[i] + positions[(i + 1) % len(corners)]) for i in range(len(corners))]
        if with_center:
            extra.append(positions.mean(axis=0))
        local = [int(np.argmin(np.linalg.norm(nodes - x, axis=1))) for x in extra]
        faces.append(list(corners) + local)
    return np.array(faces, dtype=np.int64)


def _hex(name: str, degree: int) -> CellKind:
    corners = [np.array(c, float) for c in _HEX_CORNERS]
    if degree == 1:
        nodes = np.array(corners)
        faces = np.array(_HEX_FACES, dtype=np.int64)
    else:
        centers = [np.array(c, float) for c in _HEX_FACE_CENTERS]
        nodes = np.array(corners + _midpoints(_HEX_CORNERS, _HEX_EDGES) + centers + [np.zeros(3)])
        faces = _complete_faces(nodes, _HEX_FACES, with_center=True)
    powers = np.array([(i, j, k) for i in range(degree + 1) for j in range(degree + 1) for k in range(degree + 1)])
    # det J of a degree-d hex has degree 3d - 1 in each variable: 2 points are exact for d = 1, 3 for d = 2
    x, w = np.polynomial.legendre.leggauss(degree + 1)
    points = np.array([(a, b, c) for a in x for b in x for c in x])
    weights = np.array([a * b * c for a in w for b in w for c in w])
    return CellKind(name, nodes, powers, "quad4" if degree == 1 else "quad9", faces, points, weights)


def _tet(name: str, degree: int) -> CellKind:
    corners = [np.array(c, float) for c in _TET_CORNERS]
    if degree == 1:
        nodes = np.array(corners)
        faces = np.array(_TET_FACES, dtype=np.int64)
    else:
        nodes = np.array(corners + _midpoints(_TET_CORNERS, _TET_EDGES))
        faces = _complete_faces(nodes, _TET_FACES, with_center=False)
    exponents = [(i, j, k) for i in range(degree + 1) for j in range(degree + 1) for k in range(degree + 1)]
    powers = np.array([e for e in exponents if sum(e) <= degree])
    # Duffy map of a Gauss product rule: exact for the cubic det J of a quadratic tetrahedron
    x, w = np.polynomial.legendre.leggauss(3)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    points, weights = [], []
    for a, wa in zip(x, w, strict=True):
        for b, wb in zip(x, w, strict=True):
            for c, wc in zip(x, w, strict=True):
                points.append((a, (1 - a) * b, (1 - a) * (1 - b) * c))
                weights.append(wa * wb * wc * (1 - a) ** 2 * (1 - b))
    return CellKind(name, nodes, powers, "tri3" if degree == 1 else "tri6", faces, np.array(points), np.array(weights))


_BUILDERS = {
    "hex8": lambda: _hex("hex8", 1),
    "hex27": lambda: _hex("hex27", 2),
    "tet4": lambda: _tet("tet4", 1),
    "tet10": lambda: _tet("tet10", 2),
}
CELL_KINDS = tuple(_BUILDERS)


@cache
def cell_kind(name: str) -> CellKind:
    """The reference cell called `name`, one of `CELL_KINDS`; raises `InputError` for any other."""
    if name not in _BUILDERS:
        raise unknown_name("cell kind", name, CELL_KINDS)
    return _BUILDERS[name]()
