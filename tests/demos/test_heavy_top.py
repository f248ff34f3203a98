"""The heavy top against its published position, shown as a rate, and the files of a whole demo."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from demos import heavy_top as demo


def test_the_error_falls_with_the_square_of_the_step() -> None:
    errors = [
        np.linalg.norm(demo.run(step).body("top").position[-1] - demo.AFTER_ONE_SECOND) for step in (4e-4, 2e-4, 1e-4)
    ]
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx(2.0, abs=0.05)


def test_the_energy_of_the_start_is_that_of_its_closed_form() -> None:
    spin, arm = demo.SPIN, demo.ARM
    kinetic = 0.5 * demo.MASS * np.sum(np.cross(spin, arm) ** 2) + 0.5 * np.sum(np.array(demo.INERTIA) * spin**2)
    assert kinetic == pytest.approx(demo.ENERGY, rel=1e-9)


def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    names = {p.name for p in (tmp_path / "out").iterdir()}
    assert names == {"heavy_top.h5", "heavy_top.coarse.h5", "heavy_top.rrd", "heavy_top.png", "summary.json"}
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert all(check["passed"] for check in summary["checks"]) and len(summary["checks"]) == 9
    assert "order of the error" in capsys.readouterr().out
