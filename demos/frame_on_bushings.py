"""A flexible frame on four bushings: `python demos/frame_on_bushings.py [--out DIR] [--quick]`.

The scene and the run are in `warpffrf/demos/frame_on_bushings.py`, so that an installed wheel has them too; this
script is `warpffrf demo frame-on-bushings` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.frame_on_bushings import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "frame-on-bushings", *sys.argv[1:]]))
