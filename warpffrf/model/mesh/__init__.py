"""Finite-element meshes: the data, structured bodies, and files made elsewhere."""

from warpffrf.model.mesh.ball import ball
from warpffrf.model.mesh.block import block
from warpffrf.model.mesh.box import box, grid
from warpffrf.model.mesh.cyclic import Cyclic
from warpffrf.model.mesh.data import Matrices, Mesh, MeshReport
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.mesh.matrices import from_matrices, read_matrix
from warpffrf.model.mesh.reader import read
from warpffrf.model.mesh.sleeve import ring, sleeve
from warpffrf.model.mesh.structured import roller

__all__ = [
    "Cyclic",
    "FacetSet",
    "Matrices",
    "Mesh",
    "MeshReport",
    "ball",
    "block",
    "box",
    "from_matrices",
    "grid",
    "read",
    "read_matrix",
    "ring",
    "roller",
    "sleeve",
]


def __dir__() -> list[str]:
    return __all__
