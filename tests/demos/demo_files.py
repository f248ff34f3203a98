"""What every demo that ends in `checks.finish` leaves behind."""

from __future__ import annotations

import json
from pathlib import Path


def left_behind(folder: Path, name: str, *runs: str) -> dict[str, dict]:
    """The checks of summary.json by name, after a look at the files of the demo `name` and of its further `runs`."""
    files = {f"{name}.h5", f"{name}.rrd", f"{name}.png", "summary.json", *(f"{name}.{run}.h5" for run in runs)}
    assert {p.name for p in folder.iterdir()} == files
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert all(check["passed"] for check in summary["checks"])
    return {check["name"]: check for check in summary["checks"]}
