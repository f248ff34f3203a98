"""The linear wedge, 6 nodes: bottom triangle, top triangle."""

import numpy as np

from warpffrf.model.mesh.elements.domains import WEDGE_CORNERS, WEDGE_QUADS, WEDGE_TRIANGLES, powers_up_to, wedge_rule
from warpffrf.model.mesh.elements.kinds import CellKind, complete_faces

_ALL = powers_up_to(1, 1, 1)

CELL = CellKind(
    "wedge6",
    "wedge",
    WEDGE_CORNERS,
    _ALL[_ALL[:, :2].sum(axis=1) <= 1],
    6,
    {"tri3": np.array(WEDGE_TRIANGLES), "quad4": complete_faces(WEDGE_CORNERS, WEDGE_QUADS, edges=False, center=False)},
    *wedge_rule(2),
)
