"""A connecting rod on its crank pin with an oil film: `python demos/connecting_rod.py [--out DIR] [--quick]`.

The scene and the run are in `warpffrf/demos/connecting_rod.py`, so that an installed wheel has them too; this
script is `warpffrf demo connecting-rod` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.connecting_rod import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "connecting-rod", *sys.argv[1:]]))
