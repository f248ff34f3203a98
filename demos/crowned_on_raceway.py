"""A crowned roller on a raceway, in cells ten times as wide as its contact.

`python demos/crowned_on_raceway.py [--out DIR] [--quick]`. The scene and the run are in
`warpffrf/demos/crowned_on_raceway.py`, so that an installed wheel has them too; this script is `warpffrf demo
crowned-on-raceway` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.crowned_on_raceway import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "crowned-on-raceway", *sys.argv[1:]]))
