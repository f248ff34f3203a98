"""The kinds of facets: quadrilaterals on [-1, 1]^2 and triangles on the unit simplex."""

from __future__ import annotations

import numpy as np

from warpffrf.model.mesh.elements.domains import powers_up_to
from warpffrf.model.mesh.elements.kinds import FacetKind, means

_QUAD = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float)
_TRI = np.array([(0, 0), (1, 0), (0, 1)], float)
_QUAD_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0))
_TRI_EDGES = ((0, 1), (1, 2), (2, 0))
_QUAD8 = np.concatenate([_QUAD, means(_QUAD, _QUAD_EDGES)])
_FULL = powers_up_to(2, 2)

# Split so that every node is used: a serendipity face has its four corner triangles and the square between them.
_TRIANGLES = {
    "quad4": ((0, 1, 2), (0, 2, 3)),
    "quad8": ((0, 4, 7), (4, 1, 5), (5, 2, 6), (7, 6, 3), (4, 5, 6), (4, 6, 7)),
    "quad9": ((0, 4, 8), (0, 8, 7), (4, 1, 5), (4, 5, 8), (8, 5, 2), (8, 2, 6), (7, 8, 6), (7, 6, 3)),
    "tri3": ((0, 1, 2),),
    "tri6": ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
}


def _facet(name: str, domain: str, nodes: np.ndarray, powers: np.ndarray) -> FacetKind:
    return FacetKind(name, domain, nodes, powers, 4 if domain == "quad" else 3, np.array(_TRIANGLES[name]))


FACETS = {
    facet.name: facet
    for facet in (
        _facet("quad4", "quad", _QUAD, powers_up_to(1, 1)),
        _facet("quad8", "quad", _QUAD8, _FULL[~np.all(_FULL == 2, axis=1)]),
        _facet("quad9", "quad", np.concatenate([_QUAD8, np.zeros((1, 2))]), _FULL),
        _facet("tri3", "tri", _TRI, np.array([(0, 0), (1, 0), (0, 1)])),
        _facet("tri6", "tri", np.concatenate([_TRI, means(_TRI, _TRI_EDGES)]), _FULL[_FULL.sum(axis=1) <= 2]),
    )
}
