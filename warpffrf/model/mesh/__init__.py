"""Finite-element meshes: the data, a structured roller, and files made elsewhere."""

from warpffrf.model.mesh.data import Cyclic, Matrices, Mesh, MeshReport
from warpffrf.model.mesh.facets import FacetSet
from warpffrf.model.mesh.matrices import from_matrices, read_matrix
from warpffrf.model.mesh.reader import read
from warpffrf.model.mesh.structured import roller

__all__ = ["Cyclic", "FacetSet", "Matrices", "Mesh", "MeshReport", "from_matrices", "read", "read_matrix", "roller"]
