"""Creep curves of two crowned rollers: `python demos/creep_curves.py [--out DIR] [--quick]`.

The scene and the run are in `warpffrf/demos/creep_curves.py`, so that an installed wheel has them too; this
script is `warpffrf demo creep-curves` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.creep_curves import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "creep-curves", *sys.argv[1:]]))
