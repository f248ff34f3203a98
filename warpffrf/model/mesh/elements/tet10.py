"""The quadratic tetrahedron, 10 nodes: corners, then edges."""

import numpy as np

from warpffrf.model.mesh.elements.domains import CONSTANT, TET_CORNERS, TET_EDGES, TET_FACES, powers_up_to, tet_rule
from warpffrf.model.mesh.elements.kinds import CellKind, complete_faces, means

_NODES = np.concatenate([TET_CORNERS, means(TET_CORNERS, TET_EDGES)])
_ALL = powers_up_to(2, 2, 2)

CELL = CellKind(
    "tet10",
    "tet",
    _NODES,
    _ALL[_ALL.sum(axis=1) <= 2],
    4,
    {"tri6": complete_faces(_NODES, TET_FACES, edges=True, center=False)},
    *tet_rule(3),  # exact for the cubic det J
    CONSTANT,
)
