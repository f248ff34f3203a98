"""A ball that hits a half-space: `python demos/ball_impact.py [--out DIR] [--quick]`.

The scene and the run are in `warpffrf/demos/ball_impact.py`, so that an installed wheel has them too; this
script is `warpffrf demo ball-impact` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.ball_impact import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "ball-impact", *sys.argv[1:]]))
