"""The serendipity hexahedron, 20 nodes: corners, then edges in VTK's order (bottom, top, vertical).

Its functions span all products of powers up to 2 with at most one square (superlinear degree 2; Arnold and Awanou
2011, Found. Comput. Math. 11, 337).
"""

import numpy as np

from warpffrf.model.mesh.elements.domains import HEX_CORNERS, HEX_EDGES, HEX_FACES, LINEAR, hex_rule, powers_up_to
from warpffrf.model.mesh.elements.kinds import CellKind, complete_faces, means

_NODES = np.concatenate([HEX_CORNERS, means(HEX_CORNERS, HEX_EDGES)])
_ALL = powers_up_to(2, 2, 2)

CELL = CellKind(
    "hex20",
    "hex",
    _NODES,
    _ALL[(_ALL == 2).sum(axis=1) <= 1],
    8,
    {"quad8": complete_faces(_NODES, HEX_FACES, edges=True, center=False)},
    *hex_rule(3),  # det J has degree 5 in each variable at most
    LINEAR,
)
