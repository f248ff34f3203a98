"""Reader of Abaqus and CalculiX input decks (.inp).

`deck` divides the lines into keyword blocks, `parse` reads them into a `Deck`, `select` selects the body, `solid`
builds its nodes and cells, `sets` and `sections` its named sets and materials. Contents that a mesh cannot represent
are listed in `Mesh.notes`.
"""

from warpffrf.model.mesh.files.inp.build import read_inp

__all__ = ["read_inp"]
