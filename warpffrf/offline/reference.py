"""Shape functions and quadrature of scikit-fem's elements, in the VTK node order of `Mesh`.

scikit-fem numbers the dofs of quadratic elements by vertices, edges, facets and cells; the meshes here are numbered by
nodes. A Lagrange element is defined by the place of its nodes alone, so its shape functions are matched to the VTK
nodes by reference position, and every later step works in mesh numbering without any permutation of dofs.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

_QUAD = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
_TRI = ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
_HEX = tuple((x, y, z) for z in (0.0, 1.0) for x, y in _QUAD)
_TET = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
_HEX_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
_HEX_FACES = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7))
_TET_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
_QUAD_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0))
_TRI_EDGES = ((0, 1), (1, 2), (2, 0))


@dataclass(frozen=True)
class Kind:
    """One kind of cell or facet: its scikit-fem element and its nodes as groups of corners whose mean they are."""

    element: str
    corners: tuple[tuple[float, ...], ...]
    groups: tuple[tuple[int, ...], ...]

    @property
    def nodes(self) -> np.ndarray:
        """Reference positions of the nodes in VTK order (k, dim)."""
        corners = np.array(self.corners)
        return np.array([corners[list(group)].mean(axis=0) for group in self.groups])


def _single(count: int) -> tuple[tuple[int, ...], ...]:
    return tuple((i,) for i in range(count))


KINDS = {
    "hex8": Kind("ElementHex1", _HEX, _single(8)),
    "hex27": Kind("ElementHex2", _HEX, _single(8) + _HEX_EDGES + _HEX_FACES + (tuple(range(8)),)),
    "tet4": Kind("ElementTetP1", _TET, _single(4)),
    "tet10": Kind("ElementTetP2", _TET, _single(4) + _TET_EDGES),
    "quad4": Kind("ElementQuad1", _QUAD, _single(4)),
    "quad9": Kind("ElementQuad2", _QUAD, _single(4) + _QUAD_EDGES + ((0, 1, 2, 3),)),
    "tri3": Kind("ElementTriP1", _TRI, _single(3)),
    "tri6": Kind("ElementTriP2", _TRI, _single(3) + _TRI_EDGES),
}
# Polynomial degree that the rule integrates exactly, per kind: stiffness and mass. Degrees count per direction for
# quadrilaterals and hexahedra. Hexahedra: full integration with as many points as nodes for K; N_a N_b det J for M.
STIFFNESS_DEGREE = {"hex8": 3, "hex27": 5, "tet4": 1, "tet10": 4}
MASS_DEGREE = {"hex8": 5, "hex27": 7, "tet4": 2, "tet10": 6}
FACET_DEGREE = {"quad4": 7, "quad9": 7, "tri3": 5, "tri6": 6}
_SAME_NODE = 1e-9  # reference coordinates are exact fractions


@dataclass(frozen=True)
class Rule:
    """Quadrature on a reference cell: shape functions (q, k), gradients (q, k, dim), weights (q,)."""

    values: np.ndarray
    gradients: np.ndarray
    weights: np.ndarray


@cache
def rule(kind: str, degree: int, pieces: int = 1) -> Rule:
    """Quadrature of `degree` on the reference cell of `kind`, split into `pieces` along each edge (facets only).

    Splitting serves integrands with kinks inside the cell, like the hats of a contact grid over a facet.
    """
    import skfem
    from skfem.quadrature import get_quadrature

    element = getattr(skfem, KINDS[kind].element)()
    X, W = get_quadrature(element, degree)
    if pieces > 1:
        X, W = _split(X, W, pieces, triangle=kind.startswith("tri"))
    nodes = KINDS[kind].nodes
    distance = np.linalg.norm(element.doflocs[None] - nodes[:, None], axis=2)
    local = np.argmin(distance, axis=1)
    if np.max(distance[np.arange(len(nodes)), local]) > _SAME_NODE:
        raise RuntimeError(f"scikit-fem's {KINDS[kind].element} has other nodes than {kind}")
    evaluated = [element.lbasis(X, int(i)) for i in local]
    values = np.stack([np.broadcast_to(v, (X.shape[1],)) for v, _ in evaluated], axis=1)
    gradients = np.stack([np.asarray(g).T for _, g in evaluated], axis=1)
    return Rule(values, gradients, W)


def _split(X: np.ndarray, W: np.ndarray, pieces: int, triangle: bool) -> tuple[np.ndarray, np.ndarray]:
    n = pieces
    points = []
    for i in range(n):
        for j in range(n):
            if not triangle:
                points.append((X + np.array([[i], [j]])) / n)
                continue
            if i + j <= n - 1:
                points.append((X + np.array([[i], [j]])) / n)
            if i + j <= n - 2:
                points.append((np.array([[i + 1.0], [j + 1.0]]) - X) / n)
    return np.concatenate(points, axis=1), np.tile(W, len(points)) / n**2
