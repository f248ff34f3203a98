"""Two rollers in 4 mm tetrahedra beside a mesh made for the contact.

`python demos/coarse_rollers.py [--out DIR] [--quick]`. The scene and the run are in
`warpffrf/demos/coarse_rollers.py`, so that an installed wheel has them too; this script is `warpffrf demo
coarse-rollers` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.coarse_rollers import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "coarse-rollers", *sys.argv[1:]]))
