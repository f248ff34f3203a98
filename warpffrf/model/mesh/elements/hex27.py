"""The triquadratic hexahedron, 27 nodes: corners, edges, faces (xi-, xi+, eta-, eta+, zeta-, zeta+), middle."""

import numpy as np

from warpffrf.model.mesh.elements.domains import HEX_CORNERS, HEX_EDGES, HEX_FACES, LINEAR, hex_rule, powers_up_to
from warpffrf.model.mesh.elements.kinds import CellKind, complete_faces, means

_NODES = np.concatenate([HEX_CORNERS, means(HEX_CORNERS, HEX_EDGES), means(HEX_CORNERS, HEX_FACES), np.zeros((1, 3))])

CELL = CellKind(
    "hex27",
    "hex",
    _NODES,
    powers_up_to(2, 2, 2),
    8,
    {"quad9": complete_faces(_NODES, HEX_FACES, edges=True, center=True)},
    *hex_rule(3),  # det J has degree 5 in each variable
    LINEAR,
)
