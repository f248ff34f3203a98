"""The serendipity wedge, 15 nodes: corners, edges of the bottom, of the top, vertical ones.

Its functions are the products of the linear wedge's with the quadratic ones that vanish nowhere twice: complete
quadratics in the plane, times a linear function along the axis, and the square along the axis times linear functions
in the plane.
"""

import numpy as np

from warpffrf.model.mesh.elements.domains import (
    CONSTANT,
    WEDGE_CORNERS,
    WEDGE_EDGES,
    WEDGE_QUADS,
    WEDGE_TRIANGLES,
    powers_up_to,
    wedge_rule,
)
from warpffrf.model.mesh.elements.kinds import CellKind, complete_faces, means

_NODES = np.concatenate([WEDGE_CORNERS, means(WEDGE_CORNERS, WEDGE_EDGES)])
_ALL = powers_up_to(2, 2, 2)
_IN_PLANE, _ALONG = _ALL[:, :2].sum(axis=1), _ALL[:, 2]

CELL = CellKind(
    "wedge15",
    "wedge",
    _NODES,
    _ALL[((_IN_PLANE <= 2) & (_ALONG <= 1)) | ((_IN_PLANE <= 1) & (_ALONG == 2))],
    6,
    {
        "tri6": complete_faces(_NODES, WEDGE_TRIANGLES, edges=True, center=False),
        "quad8": complete_faces(_NODES, WEDGE_QUADS, edges=True, center=False),
    },
    *wedge_rule(4),  # det J has degree 6 in the plane at most (Duffy: 2 points - 2), 5 along the axis
    CONSTANT,
)
