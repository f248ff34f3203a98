"""Bodies given by mass and stiffness matrices: files of FE programs, the order of their rows, and checks."""

from warpffrf.model.mesh.files.matrices.build import from_matrices
from warpffrf.model.mesh.files.matrices.files import read_matrix
from warpffrf.model.mesh.files.matrices.formats import FileMatrix

__all__ = ["FileMatrix", "from_matrices", "read_matrix"]
