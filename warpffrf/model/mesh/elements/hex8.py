"""The trilinear hexahedron, 8 nodes."""

from warpffrf.model.mesh.elements.domains import CONSTANT, HEX_CORNERS, HEX_FACES, hex_rule, powers_up_to
from warpffrf.model.mesh.elements.kinds import CellKind, complete_faces

# det J has degree 2 in each variable: 2 Gauss points are exact
CELL = CellKind(
    "hex8",
    "hex",
    HEX_CORNERS,
    powers_up_to(1, 1, 1),
    8,
    {"quad4": complete_faces(HEX_CORNERS, HEX_FACES, edges=False, center=False)},
    *hex_rule(2),
    CONSTANT,
)
