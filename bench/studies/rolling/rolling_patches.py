"""Writes docs/studies/rolling_patches.md: `python -m studies.rolling.rolling_patches [FOLDER]`. Ten minutes.

Friction on cells that travel with the patch, measured by simulations of rollers on coarse meshes: steady rolling and
sliding (`rolling_steady`, `rolling_bodies`), and histories (`rolling_changes`).
"""

from __future__ import annotations

import sys
from pathlib import Path

from studies.rolling import rolling_bodies, rolling_changes, rolling_steady

HEAD = """# Rollers with friction on cells of the patch

Made by `python -m studies.rolling.rolling_patches`; do not edit.

Two equal hollow rollers (R 50, bore 15, width 20 mm unless said), everything prescribed at their bores.

"""


def page() -> str:
    """The whole page."""
    return HEAD + rolling_steady.section() + rolling_bodies.section() + rolling_changes.section()


def main(folder: str = "docs/studies") -> None:
    """Write the page."""
    Path(folder).mkdir(parents=True, exist_ok=True)
    (Path(folder) / "rolling_patches.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
