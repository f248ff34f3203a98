"""Finite-element meshes: the data, structured bodies, and files of other programs."""

from warpffrf.model.mesh.data import Matrices, Mesh, MeshReport
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.mesh.files.matrices import from_matrices, read_matrix
from warpffrf.model.mesh.files.reader import read
from warpffrf.model.mesh.periodicity import Cyclic
from warpffrf.model.mesh.shapes.ball import ball
from warpffrf.model.mesh.shapes.boxes import block, box, grid
from warpffrf.model.mesh.shapes.cage import cage
from warpffrf.model.mesh.shapes.cam import cam
from warpffrf.model.mesh.shapes.gear import gear
from warpffrf.model.mesh.shapes.revolved import ring, sleeve
from warpffrf.model.mesh.shapes.roller import roller
from warpffrf.model.mesh.structure import Beam, BeamSection, PointMass, RigidLink, Shell, Spring

__all__ = [
    "Beam",
    "BeamSection",
    "Cyclic",
    "FacetSet",
    "Matrices",
    "Mesh",
    "MeshReport",
    "PointMass",
    "RigidLink",
    "Shell",
    "Spring",
    "ball",
    "block",
    "box",
    "cage",
    "cam",
    "from_matrices",
    "gear",
    "grid",
    "read",
    "read_matrix",
    "ring",
    "roller",
    "sleeve",
]


def __dir__() -> list[str]:
    return __all__
