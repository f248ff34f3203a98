"""The blocks of docs/stepping.md run as printed, in order, and do what the page says."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

PAGE = Path(__file__).resolve().parents[2] / "docs" / "stepping.md"
BLOCK = re.compile(r"```py\n(.*?)```", re.DOTALL)


def test_blocks_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    for number, block in enumerate(BLOCK.findall(PAGE.read_text(encoding="utf-8"))):
        exec(compile(block, f"stepping.md, block {number}", "exec"), names)
    speeds = names["result"].body("rotor").angular_velocity[:, 1]
    torque, inertia, step = 3.0, 0.2, 1e-3
    assert speeds[-1] == pytest.approx(torque / inertia * (0.15 - 0.5 * step), rel=1e-9)  # a ramp in the first step
    assert len(speeds) == 151
    assert names["loop"].outputs[names["speed"]] == pytest.approx(20.0, rel=1e-2)
    assert names["hysteresis"].outputs[names["speed"]] < 5.0 + 0.02
    assert np.ptp(names["hysteresis"].result().force("motor").torque[:, 1]) <= 1.0
    assert [path.name for path in tmp_path.iterdir()] == ["hysteresis.rrd"]
