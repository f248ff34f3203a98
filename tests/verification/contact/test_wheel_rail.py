"""A wheel S1002 on a rail UIC 60: where it touches, by brute force; Hertz; the Manchester benchmark by CONTACT."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from references.wheel_rail import BENCHMARK, BENCHMARK_ENDS, Wheelset
from scenes import wheel_on_rail
from warpffrf.model.surfaces.railway import RAIL_ENDS, head_of_arcs

PLACE = 5e-5  # m, of the patch's middle from where the rigid profiles touch
HERTZ = 0.01
LIGHT = 100.0  # N, under which the patch is small against the profile's zones
PRESSURE = 0.02  # CONTACT has cells of 0.2 mm, the wheel here the wall of a ring behind its patch
CENTER = 2e-4  # m, of the centre of pressure from that of CONTACT, in one place


@cache
def track(ends: tuple[float, float]) -> tuple[Wheelset, Any]:
    curve = head_of_arcs(ends)
    return Wheelset(wheel_on_rail.profile(), curve), curve


@pytest.mark.slow
@pytest.mark.parametrize("y", [-6e-3, -3e-3, -1e-3, 3e-3, 4e-3])
def test_a_light_wheel_touches_where_its_profile_does(y: float) -> None:
    """Within zones of constant radius the pressure is Hertz's."""
    wheelset, curve = track(RAIL_ENDS)
    pose = (y, 0.0, 0.0)
    found = wheel_on_rail.pressed("tread", wheelset, curve, pose, LIGHT)
    s = wheelset.touch(1, *pose).s
    assert found.center_of_pressure[-1, 1] == pytest.approx(s, abs=PLACE)
    assert found.z[-1].mean() == pytest.approx(s, abs=PLACE)
    assert found.peak_pressure[-1] == pytest.approx(found.hertz(-1).peak_pressure, rel=HERTZ)


@pytest.mark.slow
@pytest.mark.parametrize(("part", "case"), [(part, case) for part in ("tread", "flange") for case in BENCHMARK[part]])
def test_the_manchester_benchmark(part: str, case: Any) -> None:
    """Tread, root of the flange and flank at 61 degrees, with yaw."""
    wheelset, curve = track(BENCHMARK_ENDS)
    found = wheel_on_rail.pressed(part, wheelset, curve, case.pose, case.load)
    assert found.z[-1].mean() == pytest.approx(wheelset.touch(1, *case.pose).s, abs=PLACE)
    assert found.center_of_pressure[-1, 1] == pytest.approx(1e-3 * case.s, abs=CENTER)
    assert found.force_magnitude[-1] == pytest.approx(case.force, rel=HERTZ)
    assert 1e-6 * found.peak_pressure[-1] == pytest.approx(case.peak, rel=PRESSURE)


@pytest.mark.slow
@pytest.mark.parametrize("case", BENCHMARK["two places"])
def test_the_manchester_benchmark_in_two_places_at_once(case: Any) -> None:
    """On given rows: two places of the tread whose patches have grown together, and the tread and the root of the
    flange."""
    part = "flange" if case.y > 1.0 else "tread"
    wheelset, curve = track(BENCHMARK_ENDS)
    cells = wheel_on_rail.STRIPS, wheel_on_rail.ROWS[part]
    found = wheel_on_rail.pressed(part, wheelset, curve, case.pose, case.load, cells=cells)
    pressed = found.pressure(-1).pressure.max(axis=0) > 0.0
    assert np.count_nonzero(np.diff(pressed.astype(int)) == 1) == (2 if part == "flange" else 1)
    assert found.force_magnitude[-1] == pytest.approx(case.force, rel=HERTZ)
    assert 1e-6 * found.peak_pressure[-1] == pytest.approx(case.peak, rel=PRESSURE)


def test_closing_the_gap_reaches_the_height_of_the_profiles() -> None:
    """A wheel lowered on the rail touches at the height by brute force."""
    wheelset, curve = track(RAIL_ENDS)
    scene = wheel_on_rail.scene("tread", wheelset, curve, (-3e-3, 0.0, 0.0), LIGHT)
    height = scene.body("wheel").position[2]
    scene.body("wheel").position += (0.0, 0.0, 0.01)
    scene.close_gap(scene.contact(wheel_on_rail.CONTACT), along=(0, 0, -1))
    assert scene.body("wheel").position[2] == pytest.approx(height, abs=1e-7)
