"""A beam spun up about one end: `python demos/spinning_beam.py [--out DIR] [--quick]`.

The scene and the run are in `warpffrf/demos/spinning_beam.py`, so that an installed wheel has them too; this script is
`warpffrf demo spinning-beam` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.spinning_beam import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "spinning-beam", *sys.argv[1:]]))
