"""A slider-crank with a flexible rod: `python demos/slider_crank.py [--out DIR] [--quick]`.

The scene and the run are in `warpffrf/demos/slider_crank.py`, so that an installed wheel has them too; this script is
`warpffrf demo slider-crank` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.slider_crank import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "slider-crank", *sys.argv[1:]]))
