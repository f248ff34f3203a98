"""The wheel bearing, whole, compared with the equations of rigid rings in five motions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from checks import Check, left_behind, missed
from scipy.optimize import root

from demos import wheel_bearing as demo
from references.closed_forms.ball_bearing import BallBearing
from references.finite_elements.shaft_in_housing import balls

AXIS, FIRST = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, -1.0])
TOLERANCE = 5e-3  # first order in tilts of 2 mrad, observed 2e-3


def equations(load: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Motion (5,) [m, rad] without rotation about the axis and loads [N] of both rows under a force and moment (6,)."""
    g = demo.GEOMETRY
    (f_i, f_e), D, alpha = g.osculation, g.ball_diameter, g.contact_angle  # pyright: ignore[reportGeneralTypeIssues]
    reach = (f_i + f_e - 1.0) * D
    row = BallBearing(
        g.elements, D, g.pitch_diameter, f_i * D, f_e * D, 2.0 * reach * (1.0 - np.cos(alpha)), 210e9
    )  # of this free contact angle
    laws = []
    for track in g.tracks:
        along = track.sense * (f_i - 0.5) * D * np.sin(alpha) + track.z
        apart = track.sense * (reach * np.sin(alpha) + demo.PRELOAD)
        laws.append(balls(row, AXIS, FIRST, place=along, apart=apart))
    moves = [0, 1, 2, 3, 5]

    def all_of(y: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
        q = np.zeros(6)
        q[moves] = 1e-6 * y
        found = [law(q) for law in laws]
        return sum(f for f, _ in found) + load, [Q for _, Q in found]

    found = root(lambda y: all_of(y)[0][moves], np.zeros(5), tol=1e-10)
    return 1e-6 * found.x, np.concatenate(all_of(found.x)[1])


@pytest.mark.parametrize("quick", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    result = demo.main(tmp_path, quick=quick, progress=False)[0]
    left_behind(tmp_path, "wheel_bearing")
    found, rows = result.bearing(demo.NAME), []
    for i in (0, -1):
        side = demo.SIDE * result.time[i]
        load = np.array([0.0, side, demo.WEIGHT + demo.SHIFT * side, demo.TYRE * side, 0.0, 0.0])
        motion, loads = equations(load)
        largest, source, named = float(loads.max()), "equations of rigid rings", f"side force {side:g} N: "
        for name, part in demo.ROWS.items():
            ours, theirs = float(found.outer_load[i, part].max()), float(loads[part].max())
            rows.append(Check(named + name, ours, theirs, source, TOLERANCE, "N", scale=largest))
        tilt = float(np.hypot(*motion[3:]))
        ours = float(np.hypot(*found.tilt[i, :2]))
        rows.append(Check(f"{named}tilt", ours, tilt, source, TOLERANCE, "mrad", 1e3, scale=1e-3))
    assert not missed(rows)
