"""A shallow arch that snaps through: `python demos/snapping_arch.py [--out DIR] [--quick]`.

The scene and the run are in `warpffrf/demos/snapping_arch.py`, so that an installed wheel has them too; this
script is `warpffrf demo snapping-arch` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.snapping_arch import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "snapping-arch", *sys.argv[1:]]))
