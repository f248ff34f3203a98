"""The cells of a mesh for programs that know sets as arrays of cells: blocks of cells, beams, shells and the facets of
sets, each once, and for each set its members among them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpffrf.model.mesh.structure import Beam, Shell

if TYPE_CHECKING:
    from warpffrf.model.mesh.data import Mesh

LINE = "line"  # the kind of a beam


def marked_blocks(mesh: Mesh) -> tuple[list[tuple[str, np.ndarray]], dict[str, np.ndarray]]:
    """Kinds and nodes (m, k): volume cells first, then beams, then every shell and every facet that is in a set, once;
    and {set: (cells,) 0 or 1}, over all blocks in this order."""
    blocks = list(mesh.cells.items())
    count = mesh.cell_count
    places: dict[str, list[np.ndarray]] = {name: [members] for name, members in mesh.cell_sets.items()}
    for beam in mesh.structure.of(Beam):
        blocks.append((LINE, beam.nodes))
        count += len(beam.nodes)
    by_kind: dict[str, list[tuple[str | None, np.ndarray]]] = {}
    for shell in mesh.structure.of(Shell):
        by_kind.setdefault(shell.kind, []).append((None, shell.nodes))
    for name, facets in mesh.facet_sets.items():
        for kind, nodes in facets.blocks.items():
            by_kind.setdefault(kind, []).append((name, nodes))
    for kind, members in by_kind.items():
        rows = np.concatenate([nodes for _, nodes in members])
        _, first, place = np.unique(np.sort(rows, axis=1), axis=0, return_index=True, return_inverse=True)
        stops = np.cumsum([len(nodes) for _, nodes in members])[:-1]
        for (name, _), part in zip(members, np.split(place.ravel(), stops), strict=True):
            if name is not None:
                places.setdefault(name, []).append(count + part)
        blocks.append((kind, rows[first]))
        count += len(first)
    marks = {name: np.zeros(count, dtype=np.int32) for name in places}
    for name, parts in places.items():
        marks[name][np.concatenate(parts)] = 1
    return blocks, marks
