"""A whole ball bearing that turns under a load: `python demos/ball_bearing.py [--out DIR] [--quick]`.

The scene and the run are in `warpffrf/demos/ball_bearing.py`, so that an installed wheel has them too; this
script is `warpffrf demo ball-bearing` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.ball_bearing import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "ball-bearing", *sys.argv[1:]]))
