"""A ball pressed on a plane and pushed sideways: `python demos/ball_on_plane.py [--out DIR] [--quick]`.

The scene and the run are in `warpffrf/demos/ball_on_plane.py`, so that an installed wheel has them too; this
script is `warpffrf demo ball-on-plane` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.ball_on_plane import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "ball-on-plane", *sys.argv[1:]]))
