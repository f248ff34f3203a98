"""A pin in a bore of nearly its own radius: `python demos/pin_in_bore.py [--out DIR] [--quick]`.

The scene and the run are in `warpffrf/demos/pin_in_bore.py`, so that an installed wheel has them too; this
script is `warpffrf demo pin-in-bore` for a checkout.
"""

from __future__ import annotations

import sys

from warpffrf.cli import main as command_line  # first: it settles the threads of the BLAS before NumPy is loaded
from warpffrf.demos.pin_in_bore import build, main

__all__ = ["build", "main"]

if __name__ == "__main__":
    sys.exit(command_line(["demo", "pin-in-bore", *sys.argv[1:]]))
