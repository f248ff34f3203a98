"""The three reference domains of cells: corners, edges, outward faces, and product quadrature.

Hexahedron [-1, 1]^3; wedge: the unit triangle times [-1, 1]; tetrahedron: the unit simplex.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.mesh.elements.kinds import Array, gauss, triangle_rule

HEX_CORNERS = np.array(
    [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)], float
)
HEX_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
HEX_FACES = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7))  # xi-, xi+, ... zeta+
WEDGE_CORNERS = np.array([(0, 0, -1), (1, 0, -1), (0, 1, -1), (0, 0, 1), (1, 0, 1), (0, 1, 1)], float)
WEDGE_EDGES = ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5))
WEDGE_TRIANGLES = ((0, 2, 1), (3, 4, 5))
WEDGE_QUADS = ((0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))
TET_CORNERS = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float)
TET_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
TET_FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))


def powers_up_to(*degrees: int) -> Array:
    """Exponents of all products of powers up to the given degree in each variable."""
    return np.array(np.meshgrid(*[np.arange(d + 1) for d in degrees], indexing="ij")).reshape(len(degrees), -1).T


CONSTANT = np.zeros((1, 3), dtype=int)  # exponents of a constant, and of a linear function
LINEAR = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])


def hex_rule(points: int) -> tuple[Array, Array]:
    """Gauss rule with `points` per direction on [-1, 1]^3."""
    x, w = gauss(points)
    xi = np.array(np.meshgrid(x, x, x, indexing="ij")).reshape(3, -1).T
    return xi, np.einsum("i,j,k->ijk", w, w, w).ravel()


def wedge_rule(points: int) -> tuple[Array, Array]:
    """Duffy rule on the triangle times Gauss along the axis, `points` per direction."""
    (flat, area), (x, w) = triangle_rule(points), gauss(points)
    xi = np.concatenate([np.repeat(flat, points, axis=0), np.tile(x, len(flat))[:, None]], axis=1)
    return xi, np.outer(area, w).ravel()


def tet_rule(points: int) -> tuple[Array, Array]:
    """Duffy's map of a Gauss product rule on the unit simplex: exact to degree 2 points - 3."""
    (flat, area), (x, w) = triangle_rule(points), gauss(points)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    height, base = np.repeat(x, len(flat)), np.tile(flat, (points, 1))
    xi = np.concatenate([base * (1.0 - height[:, None]), height[:, None]], axis=1)
    return xi, (w[:, None] * area[None]).ravel() * (1.0 - height) ** 2
