"""Writes machine.inp, a warpffrf example: an Abaqus deck of two instances of a shoe with a round pad on top, in mm.

Run: python make_machine.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

RADIUS, HALF, WIDTH, HEIGHT = 50.0, 2.0, 4.0, 20.0  # mm
COUNTS = (20, 20, 8)  # cells across, along, down
HARDENED = 5 / 8  # of the layers, from the top: steel on cast iron
CORNERS = ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1), (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
FILE = Path(__file__).with_name("machine.inp")
HEAD = """\
** Two instances of a shoe, steel on cast iron, with a round pad on top; mm, MPa, t/mm3. A warpffrf example.
*Part, name=shoe
*Node
"""
TAIL = """\
*Surface, type=ELEMENT, name=pad
top, S2
*Surface, type=ELEMENT, name=foot
bottom, S1
*Solid Section, elset=hardened, material=steel
*Solid Section, elset=core, material=iron
*End Part
*Assembly, name=machine
*Instance, name=shoe-1, part=shoe
*End Instance
*Instance, name=shoe-2, part=shoe
0., 0., 100.
*End Instance
*End Assembly
*Material, name=steel
*Density
7.85e-09
*Elastic
210000., 0.3
*Material, name=iron
*Density
7.1e-09
*Elastic
120000., 0.26
"""


def deck(counts: tuple[int, int, int] = COUNTS) -> str:
    """The text of the deck with so many cells across, along and down; the layers are thinner towards the pad."""
    nx, ny, nz = counts
    x, y = np.linspace(-HALF, HALF, nx + 1), np.linspace(-0.5 * WIDTH, 0.5 * WIDTH, ny + 1)
    X, Y, T = np.meshgrid(x, y, np.linspace(0.0, 1.0, nz + 1) ** 2, indexing="ij")  # T: depth
    Z = (np.sqrt(RADIUS**2 - X**2) - RADIUS) * (1.0 - T) - HEIGHT * T
    number = np.arange(X.size).reshape(X.shape) + 1
    cells = np.stack([number[a : a + nx, b : b + ny, c : c + nz].ravel() for a, b, c in CORNERS], axis=1)
    layer, hardened = np.arange(len(cells)) % nz, round(HARDENED * nz)
    sets = {"top": layer == 0, "bottom": layer == nz - 1, "hardened": layer < hardened, "core": layer >= hardened}
    places = zip(*map(np.ravel, (number, X, Y, Z)), strict=True)
    lines = [f"{n},{a:.8g},{b:.8g},{c:.8g}" for n, a, b, c in places]
    lines += ["*Element, type=C3D8", *(",".join(map(str, (n + 1, *nodes))) for n, nodes in enumerate(cells))]
    for name, members in sets.items():
        found = [str(n + 1) for n in np.flatnonzero(members)]
        lines += [f"*Elset, elset={name}", *(",".join(found[i : i + 16]) for i in range(0, len(found), 16))]
    return HEAD + "\n".join(lines) + "\n" + TAIL


if __name__ == "__main__":
    FILE.write_text(deck(), encoding="utf-8")
