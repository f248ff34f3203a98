"""A sweep of crowned rollers: crown by load by tilt, and the best crown.

`python demos/crown_sweep.py [--out DIR] [--quick]`. The scene and the sweep are in `warpffrf/demos/crown_sweep.py`, so
that an installed wheel has them too; this script is `warpffrf demo crown-sweep` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.crown_sweep import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "crown-sweep", *sys.argv[1:]]))
