"""The tilted roller on a coarser mesh: where the patch goes, and what holds the tilt."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind

from demos import tilted_roller as demo

SMALL = demo.Size(sectors=600, layers=7, axial=8, frames=5)


@pytest.mark.slow
def test_the_patch_goes_along_the_crown_and_the_cradle_holds_the_torque(monkeypatch: pytest.MonkeyPatch) -> None:
    """A crown of 2 m tilted by 0.5 mrad: by 1 mm; the force goes through the centre of the crown's arc."""
    monkeypatch.setattr(demo, "TURNING", demo.STEP)
    result = demo.run(demo.build(SMALL, progress=False), progress=False)
    assert result.status == "completed", result.message
    pair, i = result.contact(demo.PAIR), -2
    assert pair.history.pressure.min() >= 0.0
    assert pair.force[i, 2] == pytest.approx(1000.0, rel=demo.BALANCE)
    assert pair.center_of_pressure[0, 1] == pytest.approx(0.0, abs=1e-9)
    shift = float(pair.center_of_pressure[i, 1])
    assert shift == pytest.approx(2.0 * np.sin(0.5e-3), rel=demo.PLACE)
    torque = float(abs(result.joint(demo.TILTS).torque[i, 0]))
    assert torque == pytest.approx(1000.0 * (2.0 - 0.01) / 2.0 * shift, rel=1e-3)
    a, b = demo.HERTZ.half_axes
    assert pair.half_widths[i] == pytest.approx((a, b), rel=0.05)  # two nodes across, four along in a half-axis


@pytest.mark.slow
def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    left_behind(tmp_path / "out", "tilted_roller")
