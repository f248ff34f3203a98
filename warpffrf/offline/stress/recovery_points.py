"""Recovery points of each kind of cell, where the gradient of a finite-element displacement is most accurate."""

from __future__ import annotations

from functools import cache

import numpy as np

from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.elements.domains import CONSTANT, LINEAR, powers_up_to
from warpffrf.model.mesh.elements.kinds import monomials

Array = np.ndarray
_GAUSS = 1.0 / np.sqrt(3.0)  # two-point Gauss rule on [-1, 1]
_TET = (5.0 - np.sqrt(5.0)) / 20.0  # four-point rule of degree 2 on the unit tetrahedron


def _line_by(flat: list[tuple[float, float]]) -> Array:
    return np.array([(a, b, z) for z in (-_GAUSS, _GAUSS) for a, b in flat])


_CUBE = _line_by([(x, y) for x in (-_GAUSS, _GAUSS) for y in (-_GAUSS, _GAUSS)])
_TRIANGLE_BY_LINE = np.array([(*flat, z) for z in (0, 1) for flat in ((0, 0), (1, 0), (0, 1))])
_SIXTHS = [(1.0 / 6.0, 1.0 / 6.0), (2.0 / 3.0, 1.0 / 6.0), (1.0 / 6.0, 2.0 / 3.0)]
# recovery points (q, 3) of each kind, and the exponents (q, 3) of the polynomial through them
RECOVERY = {
    "hex8": (_CUBE, powers_up_to(1, 1, 1)),
    "hex20": (_CUBE, powers_up_to(1, 1, 1)),
    "hex27": (_CUBE, powers_up_to(1, 1, 1)),
    "wedge6": (_line_by([(1.0 / 3.0, 1.0 / 3.0)]), np.array([(0, 0, 0), (0, 0, 1)])),
    "wedge15": (_line_by(_SIXTHS), _TRIANGLE_BY_LINE),
    "tet4": (np.full((1, 3), 0.25), CONSTANT),
    "tet10": (_TET + (1.0 - 4.0 * _TET) * LINEAR, LINEAR),
}


@cache
def to_nodes(kind: str) -> Array:
    """E (k, q): values at the recovery points of `kind` to those at its nodes, by the polynomial through them."""
    points, powers = RECOVERY[kind]
    return monomials(cell_kind(kind).nodes, powers) @ np.linalg.inv(monomials(points, powers))


@cache
def recovery_points(kind: str) -> tuple[Array, Array]:
    """Shape functions (q, k) and reference gradients (q, k, 3) at the recovery points of `kind`."""
    return cell_kind(kind).shape(RECOVERY[kind][0])
