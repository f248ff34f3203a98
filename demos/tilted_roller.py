"""A crowned roller, tilted: `python demos/tilted_roller.py [--out DIR] [--quick]`.

The scene and the run are in `warpffrf/demos/tilted_roller.py`, so that an installed wheel has them too; this
script is `warpffrf demo tilted-roller` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.tilted_roller import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "tilted-roller", *sys.argv[1:]]))
