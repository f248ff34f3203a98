"""Blocks and rings of every cell kind, cut from one lattice: hexahedra, two wedges or six tetrahedra a lattice cell."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.elements import CELL_KINDS, cell_kind

STEEL, RUBBER = Material(210e9, 0.3, 7850.0), Material(5e6, 0.4999, 1100.0)
_MIXED = [kind for kind in CELL_KINDS if cell_kind(kind).dilatation is not None]
_CASES = [(kind, STEEL) for kind in CELL_KINDS] + [(kind, RUBBER) for kind in _MIXED]
# every kind of cell in the displacement formulation, and those that have one in the mixed formulation
each_formulation = pytest.mark.parametrize(
    ("kind", "material"), _CASES, ids=[f"{kind}-{'mixed' if m.mixed else 'displacement'}" for kind, m in _CASES]
)

# corners of the lattice cell in VTK order, and how they form the cells of each domain
CUTS = {
    "hex": ((0, 1, 2, 3, 4, 5, 6, 7),),
    "wedge": ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)),
    "tet": ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)),
}


def lattice_mesh(
    kind: str,
    counts: tuple[int, int, int],
    place: Callable[[np.ndarray], np.ndarray],
    turn: tuple[bool, bool, bool] = (False, False, False),
) -> Mesh:
    """A mesh of `kind` over a lattice of `counts` cells; `place` maps lattice coordinates (n, 3) in [0, 1]^3 to points.

    Every node lies at the mean of lattice corners, so that mid nodes follow curved maps. `turn`: directions in which
    the lattice closes.
    """
    cell = cell_kind(kind)
    corners = cell.nodes[: cell.corner_count]
    # each node as the mean of its cell's corners: barycentric for edges, faces, middle
    weights = np.array([_mean_of(x, corners) for x in cell.nodes])
    unit = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
    number: dict[tuple[int, ...], int] = {}
    cells = []
    size = 4 * np.array(counts)
    for i in range(counts[0]):
        for j in range(counts[1]):
            for k in range(counts[2]):
                for cut in CUTS[cell.domain]:
                    at = np.rint(4 * weights @ (np.array([i, j, k]) + unit[list(cut)])).astype(int)
                    at = np.where(turn, at % size, at)
                    cells.append([number.setdefault(tuple(x), len(number)) for x in at.tolist()])
    lattice = np.array(list(number)) / size
    return Mesh(place(lattice), {kind: np.array(cells)})


def _mean_of(x: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Weights over the corners whose mean lies at x: those of the smallest face that holds it."""
    low, high = corners.min(axis=0), corners.max(axis=0)
    for count in (1, 2, 4, 8):
        for group in _groups(len(corners), count):
            if np.allclose(corners[list(group)].mean(axis=0), x) and (count < 8 or np.allclose(x, (low + high) / 2)):
                weights = np.zeros(len(corners))
                weights[list(group)] = 1.0 / count
                return weights
    raise ValueError(f"no corners around {x}")


def _groups(corners: int, count: int):
    from itertools import combinations

    return combinations(range(corners), count)


def ring(kind: str, around: int, radial: int, axial: int) -> Mesh:
    """A thick ring, radii 60 and 100 mm, 40 mm wide, nodes on the true circle."""

    def place(s: np.ndarray) -> np.ndarray:
        r, angle = 0.06 + 0.04 * s[:, 1], 2.0 * np.pi * s[:, 0]
        return np.stack([r * np.sin(angle), r * np.cos(angle), 0.04 * s[:, 2]], axis=1)

    return lattice_mesh(kind, (around, radial, axial), place, (True, False, False))


def crooked_block(kind: str) -> Mesh:
    """A block of 2 x 2 x 2 lattice cells whose middle corner and faces are moved; edges stay straight, so that mid
    nodes stay in the middle of their edges."""
    corner = np.random.default_rng(3).uniform(-0.06, 0.06, (3, 3, 3, 3))
    corner[[0, -1], :, :, 0] = corner[:, [0, -1], :, 1] = corner[:, :, [0, -1], 2] = 0.0

    def place(s: np.ndarray) -> np.ndarray:
        return np.array([1.0, 0.8, 0.6]) * (s + _trilinear(corner, 2.0 * s))

    mesh = lattice_mesh(kind, (2, 2, 2), place)
    points = mesh.points.copy()
    cell = cell_kind(kind)  # mid nodes to the means of their corners: affine maps need straight edges
    for nodes in next(iter(mesh.cells.values())):
        x = points[nodes[: cell.corner_count]]
        points[nodes] = np.array([_mean_of(a, cell.nodes[: cell.corner_count]) for a in cell.nodes]) @ x
    return Mesh(points, mesh.cells)


def _trilinear(values: np.ndarray, s: np.ndarray) -> np.ndarray:
    low = np.clip(np.floor(s).astype(int), 0, 1)
    t = s - low
    out = np.zeros_like(s)
    for d in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(d, t, 1.0 - t), axis=1)
        out += weight[:, None] * values[tuple((low + d).T)]
    return out
