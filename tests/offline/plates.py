"""Plates and beams of every kind of cells, and what full finite elements say of their second-order energy."""

from __future__ import annotations

import numpy as np

from warpffrf.model.mesh import Mesh, box
from warpffrf.model.mesh.elements import cell_kind

TETS_OF_HEX = ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))
WEDGES_OF_HEX = ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7))  # with the axis across the plate


def plate(kind: str, size, counts) -> Mesh:
    """A box of cells of a `kind`, with a facet set `rim` of all sides but the large ones, `low` and `high` at its ends
    along x."""
    base = box(size, counts, order=1)
    (hexes,) = base.cells.values()
    shape = cell_kind(kind)
    if shape.domain == "hex":
        corner = cell_kind("hex8").shape(shape.nodes)[0]
        parts = hexes
    elif shape.domain == "tet":
        corner = np.concatenate([1.0 - shape.nodes.sum(axis=1, keepdims=True), shape.nodes], axis=1)
        parts = np.concatenate([hexes[:, list(t)] for t in TETS_OF_HEX])
    else:
        corner = cell_kind("wedge6").shape(shape.nodes)[0]
        inward = np.cross(*(base.points[hexes[0, [1, 3]]] - base.points[hexes[0, 0]]))[2] > 0.0
        orders = WEDGES_OF_HEX if inward else tuple((*w[3:], *w[:3]) for w in WEDGES_OF_HEX)
        parts = np.concatenate([hexes[:, list(w)] for w in orders])
    x = np.einsum("ka,eai->eki", corner, base.points[parts]).reshape(-1, 3)
    points, number = np.unique(x.round(10), axis=0, return_inverse=True)
    bare = Mesh(points, {kind: number.reshape(len(parts), -1)}, {})
    outer = bare.outer_facets()
    middle = outer.centers(points)
    end = [np.abs(middle[:, c]) > 0.5 * size[c] * (1.0 - 1e-9) for c in (0, 1)]
    return Mesh(
        points,
        bare.cells,
        {
            "rim": outer.kept(end[0] | end[1]),
            "low": outer.kept(end[0] & (middle[:, 0] < 0.0)),
            "high": outer.kept(end[0] & (middle[:, 0] > 0.0)),
        },
    )
