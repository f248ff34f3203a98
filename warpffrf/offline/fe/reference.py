"""Quadrature on reference cells and facets, with the shape functions of `warpffrf.model.mesh.elements` at its points.

The points and weights are scikit-fem's. Those of hexahedra and quadrilaterals are moved from its [0, 1] to the [-1, 1]
of the elements here; a wedge takes its triangle's points times its line's (scikit-fem's own rule for wedges has
weights that sum to half the volume).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from warpffrf.model.mesh.elements import FACET_KINDS, cell_kind, determinants, facet_kind

# Polynomial degree that the rule integrates exactly, per kind: stiffness and mass. Degrees count per direction for
# quadrilaterals, hexahedra and the axis of wedges. Stiffness: full integration. Mass: hex8 and hex20 by 2 x 2 x 2 and
# 3 x 3 x 3 points, as FE programs do it, so that their frequencies come out on the same mesh; the others N_a N_b det J.
STIFFNESS_DEGREE = {"hex8": 3, "hex20": 5, "hex27": 5, "wedge6": 3, "wedge15": 5, "tet4": 1, "tet10": 4}
MASS_DEGREE = {"hex8": 3, "hex20": 5, "hex27": 7, "wedge6": 4, "wedge15": 7, "tet4": 2, "tet10": 6}
FACET_DEGREE = {"quad4": 7, "quad8": 7, "quad9": 7, "tri3": 5, "tri6": 6}


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
    element = facet_kind(kind) if kind in FACET_KINDS else cell_kind(kind)
    X, W = _points(element.domain, degree)
    if pieces > 1:
        X, W = _split(X, W, pieces, triangle=element.domain == "tri")
    if element.domain in ("hex", "quad"):
        X, W = 2.0 * X - 1.0, W * 2.0 ** len(X)
    values, gradients = element.shape(X.T)
    return Rule(values, gradients, W)


def physical_gradients(x: np.ndarray, kind: str) -> tuple[np.ndarray, np.ndarray]:
    """dN_a/dx_i (e, q, k, 3) and volumes (e, q) at the stiffness points of cells with node coordinates x (e, k, 3)."""
    r = rule(kind, STIFFNESS_DEGREE[kind])
    slopes, J = gradients_at(x, r.gradients)
    return slopes, determinants(J) * r.weights


def gradients_at(x: np.ndarray, reference: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """dN_a/dx_i (e, q, k, 3) and the Jacobians dx_i/dxi_j (e, q, 3, 3) of cells with node coordinates x (e, k, 3) at
    points with `reference` gradients dN_a/dxi_j (q, k, 3)."""
    J = np.einsum("eai,qaj->eqij", x, reference)
    return np.einsum("qaj,eqji->eqai", reference, np.linalg.inv(J)), J


def _points(domain: str, degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (dim, q) and weights (q,) on scikit-fem's reference domain; the axis of a wedge on [-1, 1]."""
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefHex, RefLine, RefQuad, RefTet, RefTri

    if domain == "wedge":
        (flat, area), (line, length) = get_quadrature(RefTri, degree), get_quadrature(RefLine, degree)
        along = np.tile(2.0 * line[0] - 1.0, flat.shape[1])
        return np.vstack([np.repeat(flat, line.shape[1], axis=1), along]), np.outer(area, 2.0 * length).ravel()
    return get_quadrature({"hex": RefHex, "tet": RefTet, "quad": RefQuad, "tri": RefTri}[domain], degree)


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
