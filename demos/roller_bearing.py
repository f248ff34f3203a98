"""A roller bearing whose thin outer ring stands on two feet: `python demos/roller_bearing.py [--out DIR] [--quick]`.

The scene and the run are in `warpffrf/demos/roller_bearing.py`, so that an installed wheel has them too; this
script is `warpffrf demo roller-bearing` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.roller_bearing import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "roller-bearing", *sys.argv[1:]]))
