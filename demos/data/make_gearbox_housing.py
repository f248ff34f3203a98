"""Make gearbox_housing.msh, the housing of a two-stage gearbox of quadratic hexahedra. Lengths in m.

A closed box about three parallel shafts along y: two walls across the shafts with a round bore for each bearing, and
between them a shell. Facet groups `NAME_front` and `NAME_back`, the bores of the shafts `input`, `middle` and `output`
in the walls at y < 0 and y > 0, and `feet`, the corners of the bottom. Around a bore the cells form a
ring between its circle and a rectangle, the rest of a wall is a grid.
Run: python demos/data/make_gearbox_housing.py
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import meshio
import numpy as np

import warpffrf as wf
from warpffrf.model.mesh.shapes.disc import assembled, refined

BORES = {"input": (0.0, 26e-3), "middle": (75e-3, 31e-3), "output": (195e-3, 36e-3)}  # x and radius
BLOCKS = {
    "input": (-37.5e-3, 37.5e-3),
    "middle": (37.5e-3, 112.5e-3),
    "output": (149e-3, 241e-3),
}  # x of the rectangles
ENDS, SHELL, HEIGHT, BLOCK = (-46e-3, 304e-3), 8.5e-3, 110e-3, 46e-3  # x; thickness; half heights
WALLS = ((-58e-3, -42e-3), (42e-3, 58e-3))  # y
FOOT = 36e-3  # width of a foot along x
AROUND, RADIAL, ALONG = 4, 2, 4  # cells: on each side of a rectangle, of a ring, between the walls
FOLDER = Path(__file__).parent


def housing() -> wf.mesh.Mesh:
    """The mesh with its facet sets."""
    blocks = [np.linspace(*ends, AROUND + 1) for ends in BLOCKS.values()]
    beyond = np.array([268e-3, ENDS[1] - SHELL, ENDS[1]])
    x = np.unique(np.round(np.concatenate([[ENDS[0]], *blocks, beyond]), 9))
    up = np.concatenate([np.linspace(BLOCK, HEIGHT - SHELL, 3), [HEIGHT]])
    z = np.concatenate([-up[::-1], np.linspace(-BLOCK, BLOCK, AROUND + 1)[1:-1], up])
    lattices, sets = [], {f"{name}_{side}": [] for name in BORES for side in ("front", "back")}
    middle = np.linspace(WALLS[0][1], WALLS[1][0], ALONG + 1)
    for rows, side in ((np.array(WALLS[0]), "front"), (middle, ""), (np.array(WALLS[1]), "back")):
        for i in range(len(x) - 1):
            for k in range(len(z) - 1):
                at = 0.5 * (x[i] + x[i + 1])
                shell = i == 0 or i == len(x) - 2 or k == 0 or k == len(z) - 2
                bored = abs(z[k] + z[k + 1]) < 2.0 * BLOCK and any(low < at < high for low, high in BLOCKS.values())
                if shell or (side and not bored):
                    lattices.append(_standing(_cell(x[i : i + 2], z[k : k + 2]), rows))
        for name in BORES if side else ():
            for part in _ring(*BORES[name], *BLOCKS[name]):
                sets[f"{name}_{side}"].append((len(lattices), 0, 0))
                lattices.append(_standing(part, rows))
    mesh = assembled(lattices, 2, sets, "gearbox housing")
    mesh = mesh.select_plane("bottom", point=(0, 0, -HEIGHT), normal=(0, 0, -1))
    inside = np.array([ENDS[0] + FOOT, WALLS[0][1]]), np.array([ENDS[1] - FOOT, WALLS[1][0]])

    def corners(x: np.ndarray) -> np.ndarray:
        return np.all((x[:, :2] < inside[0]) | (x[:, :2] > inside[1]), axis=1)

    mesh = mesh.select("feet", "bottom", corners)
    return mesh


def _cell(x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """The lattice (3, 3, 2) of a rectangular cell of a wall."""
    return np.stack(np.meshgrid(refined(x, 2), refined(z, 2), indexing="ij"), axis=-1)


def _ring(center: float, radius: float, low: float, high: float) -> list[np.ndarray]:
    """Four lattices (2 RADIAL + 1, 2 AROUND + 1, 2) between a circle and the sides of a rectangle."""
    corners = np.array([(high, -BLOCK), (high, BLOCK), (low, BLOCK), (low, -BLOCK)])
    part, depth = np.linspace(0.0, 1.0, 2 * AROUND + 1)[:, None], np.linspace(0.0, 1.0, 2 * RADIAL + 1)[:, None, None]
    quarters = []
    for k in range(4):
        side = (1.0 - part) * corners[k] + part * corners[(k + 1) % 4]
        angle = 0.5 * np.pi * (k - 0.5 + part)
        circle = [center, 0.0] + radius * np.hstack([np.cos(angle), np.sin(angle)])
        quarters.append((1.0 - depth) * circle + depth * side)
    return quarters


def _standing(section: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The lattice (a, b, c, 3) over points (a, b, 2) x, z of a wall, in cells along `y`."""
    rows = refined(y, 2)
    lattice = np.empty((*section.shape[:2], len(rows), 3))
    lattice[..., [0, 2]], lattice[..., 1] = section[:, :, None, :], rows
    return lattice


def write(mesh: wf.mesh.Mesh, file: Path) -> None:
    """Gmsh's format 2.2 with the facet sets of the mesh, but the whole bottom, as groups."""
    names = [name for name in mesh.sets if name != "bottom"]
    blocks: Any = [("hexahedron27", mesh.single[1]), *(("quad9", mesh.facets(name).single[1]) for name in names)]
    numbers = [np.full(len(block), n, dtype=np.int32) for n, (_, block) in enumerate(blocks)]
    data: Any = {"gmsh:physical": numbers, "gmsh:geometrical": [number + 1 for number in numbers]}
    groups = {name: np.array([n, 2]) for n, name in enumerate(names, start=1)}
    meshio.write(file, meshio.Mesh(mesh.points, blocks, cell_data=data, field_data=groups), "gmsh22", binary=True)


if __name__ == "__main__":
    write(housing(), FOLDER / "gearbox_housing.msh")
