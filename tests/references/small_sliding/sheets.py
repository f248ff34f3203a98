"""Meshes of stacked sheets: boxes on top of each other, separate or as one body with a common root."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from warpffrf.model.mesh import FacetSet, Mesh, box, grid

ROOT = "root"  # facet set of one body of sheets: their ends at x = 0 together
SAME_PLACE = 1e-9  # m


def stack(size: Any, counts: Any, layers: int, *, order: int = 2) -> list[Mesh]:
    """`layers` sheets of `size` (3,) [m] from x = 0 along x, the lowest from z = 0, in equal `counts` (3,) of cells of
    `order` 1 (hex8) or 2 (hex27); facet sets as of `mesh.box`."""
    length, _, height = size
    return [
        box(size, counts, center=(0.5 * length, 0.0, (k + 0.5) * height), order=order, name=f"sheet {k}")
        for k in range(layers)
    ]


def graded_stack(lines: Sequence[Any], height: float, layers: int, *, order: int = 2) -> list[Mesh]:
    """As `stack` with grid lines along x, y and z [m], those along z from 0 to `height`."""
    x, y, z = (np.asarray(line, dtype=float) for line in lines)
    return [grid(x, y, z + k * height, order=order, name=f"sheet {k}") for k in range(layers)]


def one_body(sheets: Sequence[Mesh]) -> Mesh:
    """The sheets as one body sharing only the nodes of its root at x = 0, where they touch.

    Facet sets: `root`, and those of sheet k as `sheet0_z_max` and so on.
    """
    offsets = np.concatenate([[0], np.cumsum([len(s.points) for s in sheets])])
    points = np.concatenate([s.points for s in sheets])
    at_root = np.flatnonzero(np.abs(points[:, 0]) < SAME_PLACE)
    first: dict[tuple[int, ...], int] = {}
    number = np.arange(len(points))
    for i in at_root:
        number[i] = first.setdefault(tuple(np.rint(points[i] / SAME_PLACE).astype(int)), int(i))
    kept = np.unique(number)
    new = np.searchsorted(kept, number)
    sets: dict[str, FacetSet] = {}
    roots: dict[str, list[np.ndarray]] = {}
    for k, sheet in enumerate(sheets):
        for name, facets in sheet.facet_sets.items():
            moved = facets.renumbered(new[offsets[k] : offsets[k + 1]])
            sets[f"sheet{k}_{name}"] = moved
            if name == "x_min":
                for kind, nodes in moved.blocks.items():
                    roots.setdefault(kind, []).append(nodes)
    sets[ROOT] = FacetSet({kind: np.concatenate(parts) for kind, parts in roots.items()})
    kind = sheets[0].single[0]
    cells = np.concatenate([new[s.single[1] + offsets[k]] for k, s in enumerate(sheets)])
    return Mesh(points[kept], {kind: cells}, sets, name="sheets")
