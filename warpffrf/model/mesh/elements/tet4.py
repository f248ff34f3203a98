"""The linear tetrahedron, 4 nodes."""

import numpy as np

from warpffrf.model.mesh.elements.domains import TET_CORNERS, TET_FACES, powers_up_to, tet_rule
from warpffrf.model.mesh.elements.kinds import CellKind

_ALL = powers_up_to(1, 1, 1)

CELL = CellKind("tet4", "tet", TET_CORNERS, _ALL[_ALL.sum(axis=1) <= 1], 4, {"tri3": np.array(TET_FACES)}, *tet_rule(2))
