"""Abaqus and CalculiX input decks (.inp) as meshes, by a reader of our own.

`deck` makes keyword blocks of the lines, `parse` a `Deck` of the blocks, `select` picks the body, `solid` makes its
nodes and cells, `sets` and `sections` its named sets and materials. What a deck says that a mesh cannot hold is listed
in `Mesh.notes`, never passed over in silence.
"""

from warpffrf.model.mesh.files.inp.build import read_inp

__all__ = ["read_inp"]
