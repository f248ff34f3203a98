"""A fast heavy top on a ball joint: `python demos/heavy_top.py [--out DIR] [--quick]`.

The scene and the run are in `warpffrf/demos/heavy_top.py`, so that an installed wheel has them too; this script is
`warpffrf demo heavy-top` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.heavy_top import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "heavy-top", *sys.argv[1:]]))
