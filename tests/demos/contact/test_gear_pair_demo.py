"""The gear pair: forces of the torque, Hertz's pressure at the pitch point, relief."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

from demos import gear_pair as demo

FREE_ENDS = 1.019  # they raise the pressure in the middle of a contact of this length
HERTZ, FORCE = 0.01, 1e-3


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    results = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "gear_pair")
    rows = []
    for result, torque in zip(results, list(demo.STAGES.values())[-len(results) :], strict=True):
        assert result.status == "completed", result.message
        gear, (row, pair) = result.gear("mesh"), demo.single(result)
        force, name = torque / demo.PINION.base_radius, f"{torque:g} N m: "
        rows.append(Check(f"{name}force", float(gear.load[row].sum()), force, "torque", FORCE, "N"))
        peak = float(demo.PAIR.hertz(torque, demo.WIDTH, gear.place[row, pair])[0]) * FREE_ENDS
        middle = float(result.contact(gear.contacts[pair]).mid_peak_pressure[row])
        rows.append(Check(f"{name}pressure", middle, peak, "Hertz", HERTZ, "MPa", 1e-6))
        assert gear.load_share.sum(axis=1) == pytest.approx(1.0)
        assert np.abs(gear.transmission_error[-1] / gear.transmission_error[0] - 1.0) < 0.01  # one pitch later
    assert not missed(rows)
    if not quick:  # relief for the largest load: the lighter ones deflect less than it, so that a pair carries longer
        assert results[0].gear("mesh").orders(1).amplitude < results[-1].gear("mesh").orders(1).amplitude
