"""The faces of a body's cells with their S numbers: surfaces and node sets become facets.

A surface `elset, S3` is face 3 of each element of the set; without a face it is all free faces of those elements. A
*free* (outer) face belongs to one cell only. Facets keep the node order of the cell's face, outward.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from warpffrf.model.mesh.elements import facet_kind
from warpffrf.model.mesh.facets import FacetSet, row_numbers
from warpffrf.model.mesh.files.inp.cells import FACE_COUNT, faces_of


@dataclass(frozen=True, eq=False)
class FaceBlock:
    """Faces of one facet kind: `nodes` (f, kf), the `cell` (f,) and S number (f,) of each, and whether it is free."""

    nodes: np.ndarray
    cell: np.ndarray
    number: np.ndarray
    free: np.ndarray

    @cached_property
    def free_nodes(self) -> np.ndarray:
        """Nodes of the free faces."""
        return self.nodes[self.free]


class Faces:
    """All faces of the cells {kind: (m, k)}, cells numbered through the kinds."""

    def __init__(self, cells: Mapping[str, np.ndarray]) -> None:
        self.cell_count = sum(len(nodes) for nodes in cells.values())
        self.exists = np.zeros((self.cell_count, FACE_COUNT + 1), dtype=bool)  # column 0 is no face
        pieces: dict[str, list[tuple[np.ndarray, np.ndarray, np.ndarray]]] = {}
        start = 0
        for kind, nodes in cells.items():
            numbers = np.arange(start, start + len(nodes))
            for s, (facet, local) in enumerate(faces_of(kind), start=1):
                self.exists[numbers, s] = True
                pieces.setdefault(facet, []).append((nodes[:, local], numbers, np.full(len(nodes), s)))
            start += len(nodes)
        self.blocks: dict[str, FaceBlock] = {}
        for facet, parts in pieces.items():
            nodes, cell, number = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
            free = _single(nodes[:, : facet_kind(facet).corner_count])
            self.blocks[facet] = FaceBlock(nodes, cell, number, free)

    def selected(self, wanted: np.ndarray) -> tuple[FacetSet, int]:
        """The free faces marked in `wanted` (cells, FACE_COUNT + 1), and the number of marked faces that are inside."""
        found, inside = {}, 0
        for facet, block in self.blocks.items():
            marked = wanted[block.cell, block.number]
            found[facet] = block.nodes[marked & block.free]
            inside += int(np.sum(marked & ~block.free))
        return FacetSet(found), inside

    def free_of(self, cells: np.ndarray) -> np.ndarray:
        """The mask (cells, FACE_COUNT + 1) of the free faces of some cells."""
        chosen = np.zeros(self.cell_count, dtype=bool)
        chosen[cells] = True
        mask = np.zeros_like(self.exists)
        for block in self.blocks.values():
            rows = block.free & chosen[block.cell]
            mask[block.cell[rows], block.number[rows]] = True
        return mask

    def under(self, corners: np.ndarray) -> FacetSet:
        """The free faces that have the same corners (m, 3 or 4) as one of the rows, in any order."""
        found = {}
        keys = np.sort(corners, axis=1)
        for facet, block in self.blocks.items():
            own = np.sort(block.free_nodes[:, : facet_kind(facet).corner_count], axis=1)
            if own.shape[1] != keys.shape[1]:
                continue
            same = row_numbers(np.concatenate([keys, own]))
            found[facet] = block.free_nodes[np.isin(same[len(keys) :], same[: len(keys)])]
        return FacetSet(found)

    def over_nodes(self, node_mask: np.ndarray) -> FacetSet:
        """The free faces all of whose nodes are marked in `node_mask` (n,)."""
        return FacetSet({f: b.free_nodes[node_mask[b.free_nodes].all(axis=1)] for f, b in self.blocks.items()})


def _single(corners: np.ndarray) -> np.ndarray:
    """Which rows of node numbers (f, c) occur once, in any order of the numbers."""
    keys = np.sort(corners, axis=1)
    order = np.lexsort(keys.T[::-1])
    same = np.all(keys[order[1:]] == keys[order[:-1]], axis=1)
    single = np.ones(len(keys), dtype=bool)
    single[order[1:][same]] = False
    single[order[:-1][same]] = False
    return single
