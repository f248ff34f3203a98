"""A spall on a raceway: lines of the envelope spectrum at the defect frequencies, and what a round raceway has."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import raceway_defect as demo
from demos.raceway_defect import SIDES, envelope, expected, line

FREQUENCY = 5e-3  # of the defect frequencies: promised
STANDS_OUT = 10.0  # times the median below the first line
SHORT = 0.12  # s: a dozen passages


def checks(side: str, result: wf.Result) -> list[Check]:
    """Each line of the envelope compared with the defect frequency by rigid kinematics."""
    found = envelope(result)
    return [
        Check(f"{side}: {name}", line(found, frequency)[0], frequency, "rolling without slip", FREQUENCY, "Hz")
        for name, places in expected(side).items()
        for frequency in places
    ]


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    results = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "raceway_defect", "inner")
    for side, result in zip(SIDES, results, strict=True):
        assert not missed(checks(side, result))
        places = next(iter(expected(side).values()))
        assert line(envelope(result), places[0])[1] > STANDS_OUT * np.median(envelope(result).amplitude)
        assert np.ptp(result.energy_residual) < 1e-2 * result.energy_scale


@pytest.mark.parametrize("depth", [demo.DEPTH, 0.0])
def test_a_spall_of_the_outer_raceway_shows_at_bpfo(monkeypatch: pytest.MonkeyPatch, depth: float) -> None:
    """The largest line and its multiples; a round raceway, with the passing of the balls alone, has a tenth at most."""
    monkeypatch.setattr(demo, "DEPTH", depth)
    result = wf.simulate(demo.build("outer"), SHORT, step=demo.QUICK.step, start="equilibrium", progress=False)
    assert result.status == "completed", result.message
    found = envelope(result)
    if not depth:
        assert found.amplitude.max() < 1e-2
        return
    assert not missed(checks("outer", result))
    assert found.peaks(1)[0] == line(found, expected("outer")["multiples of BPFO"][0])
    assert found.amplitude.max() > 0.1
