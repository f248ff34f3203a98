"""The two-stage gearbox: ratio of torques, loads of its bearings by statics, sides on which its flanks carry."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from checks import Check, both_sizes, left_behind, missed

from demos import gearbox as demo

RATIO = 1e-4
BEARING = 1e-3  # of the largest load of its shaft: the moments of tilted bearings are left out; observed 1e-4
TORQUE = 240.0  # N m
ENERGY = 1e-4  # of the largest energy; observed 8e-6
EVEN = 1e-3  # of the mean speed of the output shaft: transmission errors change by 2.3 um while flanks move on by 9 mm


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    result, moving = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "gearbox", "at_speed")
    for each in (result, moving):
        assert each.status == "completed", each.message
    taken = demo.torque_of(result, "coupling")
    rows = [Check("torque", taken, TORQUE / (40.0 / 20.0 * 60.0 / 20.0), "teeth", RATIO, "N m")]
    found, known = demo.bearing_loads(result), demo.statics(result, TORQUE)
    for shaft in demo.SHAFTS:
        scale = max(known[f"{shaft}_{end}"] for end in demo.ENDS)
        for end in demo.ENDS:
            name = f"{shaft}_{end}"
            rows.append(Check(name, found[name], known[name], "statics", BEARING, "N", scale=scale))
    assert not missed(rows)
    for stage in demo.STAGES:
        gear = result.gear(stage)
        assert np.count_nonzero(gear.load[-1]) == 1  # near the pitch point
    assert np.abs(moving.energy_residual).max() < ENERGY
    own = moving.body("output").angular_velocity[:, 1].mean()
    assert abs(own / demo.SPEED * demo.RATIO + 1.0) < EVEN
