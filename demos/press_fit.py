"""A shaft pressed into a hub and turned: `python demos/press_fit.py [--out DIR] [--quick]`.

The scene and the run are in `warpffrf/demos/press_fit.py`, so that an installed wheel has them too; this
script is `warpffrf demo press-fit` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.press_fit import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "press-fit", *sys.argv[1:]]))
