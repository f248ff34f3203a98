"""Two rollers with friction, one carried along, then braked: `python demos/rolling_friction.py [--out DIR] [--quick]`.

The scene and the run are in `warpffrf/demos/rolling_friction.py`, so that an installed wheel has them too; this
script is `warpffrf demo rolling-friction` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.rolling_friction import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "rolling-friction", *sys.argv[1:]]))
