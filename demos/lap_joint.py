"""A bolted lap joint, its hysteresis and what it damps: `python demos/lap_joint.py [--out DIR] [--quick]`.

The scene and the run are in `warpffrf/demos/lap_joint.py`, so that an installed wheel has them too; this
script is `warpffrf demo lap-joint` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.lap_joint import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "lap-joint", *sys.argv[1:]]))
