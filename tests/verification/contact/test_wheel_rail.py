"""A wheel S1002 on a rail UIC 60: where it touches, by brute force; Hertz; the Manchester benchmark by CONTACT."""

from __future__ import annotations

from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from references.wheel_rail import BENCHMARK, BENCHMARK_ENDS, Wheelset
from scenes import wheel_on_rail
from warpffrf.model.surfaces.railway import RAIL_ENDS, head_of_arcs
from warpffrf.online.diagnosis import cell_notes
from warpffrf.output.simulate import equilibrium

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


@pytest.mark.slow
def test_a_patch_that_has_moved_to_the_flange_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """As a run that began on the tread, where rows are as long as their z."""
    wheelset, curve = track(BENCHMARK_ENDS)
    case = BENCHMARK["flange"][-1]
    scene = wheel_on_rail.scene("flange", wheelset, curve, case.pose, case.load)
    said = "the patch moved along the profile of wheel['rim']"
    assert said not in equilibrium(scene, progress=False).report()
    monkeypatch.setattr(cell_notes, "stretch_at_start", lambda _: 1.0)
    report = " ".join(equilibrium(scene, progress=False).report().split())
    assert said in report and "found to be nearest" not in report


def test_cells_that_are_not_about_the_pressure_are_named() -> None:
    """By a record whose pressure is off the middle of its rows."""
    wheelset, curve = track(BENCHMARK_ENDS)
    pose = (-3e-3, 0.0, 0.0)
    contact = wheel_on_rail.scene("tread", wheelset, curve, pose, LIGHT).contact(wheel_on_rail.CONTACT)
    rows, pressure = wheelset.touch(1, *pose).s + np.linspace(-2e-3, 2e-3, 11), np.zeros((1, 13, 11))
    pressure[0, 6, 5] = 1e8
    record: Any = SimpleNamespace(cells=SimpleNamespace(z=rows[None]), pressure=pressure)
    assert cell_notes._along_profile(contact, record) == []
    pressure[0, 6] = np.roll(pressure[0, 6], 3)
    (note,) = cell_notes._along_profile(contact, record)
    assert "no pressure acts where the surfaces were found to be nearest" in note


def test_closing_the_gap_reaches_the_height_of_the_profiles() -> None:
    """A wheel lowered on the rail touches at the height by brute force."""
    wheelset, curve = track(RAIL_ENDS)
    scene = wheel_on_rail.scene("tread", wheelset, curve, (-3e-3, 0.0, 0.0), LIGHT)
    height = scene.body("wheel").position[2]
    scene.body("wheel").position += (0.0, 0.0, 0.01)
    scene.close_gap(scene.contact(wheel_on_rail.CONTACT), along=(0, 0, -1))
    assert scene.body("wheel").position[2] == pytest.approx(height, abs=1e-7)
