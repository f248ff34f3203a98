"""Frequencies of plates, tubes and boxes of shells by CalculiX: writes shells.json; needs the program `ccx`.

PYTHONPATH=tests python tests/data/calculix/make_shells.py
"""

from __future__ import annotations

import json
import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from scenes.shells import closed_box, patch, tube

TYPES = {"quad4": "S4", "quad8": "S8R"}
KEPT = 8
SIZES = (0.4, 0.3, 0.2)  # m


def body(name: str, kind: str, count: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Points [m], shells, thickness [m] of a plate, a tube or a box."""
    if name == "plate":
        p = patch(kind, count, count, lambda u, v: np.stack([SIZES[0] * u, SIZES[1] * v, 0.0 * u], axis=1))
        return p.points, p.nodes, 0.003
    if name == "tube":
        return (*tube(kind, 3 * count, count, 0.1, 0.3), 0.002)
    return (*closed_box(kind, count, SIZES), 0.003)


MESHES = [("plate", "quad4", 16), ("plate", "quad8", 8), ("plate", "quad8", 16)]
MESHES += [("tube", "quad8", 6), ("tube", "quad8", 12), ("box", "quad8", 6), ("box", "quad8", 12), ("box", "quad4", 24)]


def deck(name: str, kind: str, count: int) -> str:
    """The deck in N, mm, t."""
    points, nodes, thickness = body(name, kind, count)
    lines = ["*NODE"]
    lines += [f"{i}, " + ", ".join(f"{1e3 * x:.12g}" for x in p) for i, p in enumerate(points, start=1)]
    lines += [f"*ELEMENT, TYPE={TYPES[kind]}, ELSET=SHELLS"]
    lines += [", ".join(str(a) for a in (i, *(row + 1))) for i, row in enumerate(nodes, start=1)]
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", "210000., 0.3", "*DENSITY", "7.85E-9"]
    lines += ["*SHELL SECTION, ELSET=SHELLS, MATERIAL=STEEL", f"{1e3 * thickness:g}"]
    return "\n".join([*lines, "*STEP", "*FREQUENCY", str(6 + KEPT + 4), "*END STEP", ""])


def frequencies(text: str) -> list[float]:
    """The first elastic frequencies [Hz] of a free body by CalculiX."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "body.inp").write_text(text, encoding="utf-8")
        subprocess.run(["ccx", "-i", "body"], cwd=folder, check=True, capture_output=True)
        written = (Path(folder) / "body.dat").read_text(encoding="utf-8")
    rows = [line.split() for line in written.splitlines() if re.match(r"\s+\d+\s+-?\d\.\d+E", line)]
    found = [float(row[3]) for row in rows if len(row) == 5]
    return found[6 : 6 + KEPT]


if __name__ == "__main__":
    made = {"-".join(map(str, mesh)): frequencies(deck(*mesh)) for mesh in MESHES}
    Path(__file__).with_name("shells.json").write_text(json.dumps(made, indent=1) + "\n", encoding="utf-8")
