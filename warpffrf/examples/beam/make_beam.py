"""Writes beam.vtu, a warpffrf example: a beam of hexahedra with 27 nodes, lengths in mm.

Named sets of a .vtu are cell arrays of 0 and 1: quadrilaterals among the cells are its facets, here of the sets hub and
tip. Run, with the package meshio: python make_beam.py
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import meshio
import numpy as np

import warpffrf as wf

LENGTH, WIDTH, HEIGHT = 200.0, 10.0, 8.0  # mm
COUNTS = (16, 2, 2)
ENDS = {"hub": "x_min", "tip": "x_max"}
FILE = Path(__file__).with_name("beam.vtu")
DECLARATION = '<?xml version="1.0"?>\n'
ABOUT = "<!-- A beam of hexahedra with 27 nodes, sets hub and tip, lengths in mm; a warpffrf example. -->\n"


def beam() -> meshio.Mesh:
    """The mesh with a block of facets for each end, and an array that marks each."""
    mesh = wf.mesh.box((LENGTH, WIDTH, HEIGHT), COUNTS, order=2)
    cells: list[Any] = [("hexahedron27", mesh.cells["hex27"])]
    cells += [("quad9", mesh.facets(name).blocks["quad9"]) for name in ENDS.values()]
    marks: dict[str, Any] = {
        name: [np.full(len(nodes), int(block == number + 1)) for block, (_, nodes) in enumerate(cells)]
        for number, name in enumerate(ENDS)
    }
    return meshio.Mesh(mesh.points, cells, cell_data=marks)


def main() -> None:
    beam().write(FILE, binary=False)
    text = FILE.read_text(encoding="utf-8")
    FILE.write_text(ABOUT + text.removeprefix(DECLARATION), encoding="utf-8")


if __name__ == "__main__":
    main()
