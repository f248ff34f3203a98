"""Pictures of the demos' machines for the gallery: `python docs/site_pages/machines.py [NAME ...]` runs the short
versions and writes docs/machines/NAME.png; some minutes for all."""

from __future__ import annotations

import importlib
import sys
import tempfile
from pathlib import Path
from typing import Any

from warpffrf.model.errors import InputError

ROOT = Path(__file__).resolve().parents[2]
PICTURES = ROOT / "docs" / "machines"
WIDTH = 0.12  # m


def draw(name: str) -> None:
    """Run a demo and draw the last state of its first result that has bodies."""
    demo: Any = importlib.import_module(f"demos.{name}")
    with tempfile.TemporaryDirectory() as folder:
        found = demo.main(folder, quick=True, progress=False)
    for result in found:
        try:
            print(result.picture(PICTURES / f"{name}.png", width=WIDTH, overwrite=True))
            return
        except (AttributeError, InputError) as error:
            print(f"{name}: {error}", file=sys.stderr)


if __name__ == "__main__":
    PICTURES.mkdir(exist_ok=True)
    for name in sys.argv[1:] or sorted(path.stem for path in (ROOT / "demos").glob("[a-z]*.py")):
        draw(name)
