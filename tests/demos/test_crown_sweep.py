"""The crown sweep on few rows, and where its rollers touch."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind

from demos import crown_sweep as demo


def test_the_rollers_of_every_row_just_touch() -> None:
    """Two arcs z^2/(2 Rc) and a slope: the axes are as much farther apart as z^2/Rc - phi z is below 0 at its least."""
    z = np.linspace(-demo.HALF_LENGTH, demo.HALF_LENGTH, 160_001)
    for curvature in demo.FULL.curvatures:
        for tilt in demo.FULL.tilts:
            lowest = (curvature * z**2 - tilt * z).min()
            assert demo.lift(curvature, tilt) == pytest.approx(-lowest, abs=1e-15)  # (5e-8 m)^2 of the samples, over Rc
    assert demo.place(1 / 4, 1e-3) == pytest.approx(2e-3)


@pytest.mark.slow
def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(demo, "QUICK", demo.Size(curvatures=(0.0, 1 / 8, 1 / 2), loads=(4000.0,), tilts=(0.0, 1e-3)))
    monkeypatch.setattr(demo, "WORKERS", 1)
    folder = tmp_path / "out"
    assert demo.main(folder, quick=True, progress=False) == 0
    page = (folder / "crown_sweep.html").read_text(encoding="utf-8")
    assert "6 rows of equilibrium: 6 completed." in page and page.count("data:image/png;base64,") >= 5
    assert (folder / demo.STORE / "table.h5").is_file()
    shutil.rmtree(folder / demo.STORE)
    (folder / "crown_sweep.html").unlink()
    checks = left_behind(folder, "crown_sweep")
    assert abs(checks["peak pressure of 2 rows, off by"]["computed"]) < demo.PEAK
