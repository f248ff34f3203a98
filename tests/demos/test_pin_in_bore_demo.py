"""The pin in a bore, whole; Persson's closed form for like materials written into the check here."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind

import warpffrf as wf
from demos import pin_in_bore as demo
from references.closed_forms import persson
from references.finite_elements.pin_in_bore import Pin, solve_pin

COARSE, COARSEST = demo.Size(sectors=96), demo.Size(sectors=48)
PEAK, ARC = 0.01, 0.01  # beside full finite elements; six columns of the grid in the smallest half-angle
CELLS = 24.0  # of them in the half-angle: 0.1 % of the finest
GROWS = 100.0  # 1/s: faster than this is no round-off of the linearisation


def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    checks = left_behind(tmp_path / "out", "pin_in_bore", "wide")
    assert len(checks) == 3 * 6
    E_star = 0.5 * 210e9  # two like bodies, Poisson's ratio 0
    for clearance, angles in demo.ANGLES.items():
        for angle in angles:
            ratio, peak = persson(np.radians(angle), np.zeros(1))
            load = E_star * clearance * demo.RADIUS / ratio
            label = f"{angle:.0f} deg, clearance {clearance:g}"
            assert checks[f"{label}: force"]["computed"] == pytest.approx(load * demo.WIDTH, rel=1e-6)
            assert checks[f"{label}: peak"]["computed"] == pytest.approx(peak[0] * load / demo.RADIUS, rel=demo.PEAK)


@pytest.fixture(scope="module")
def wide() -> wf.Result:
    return demo.run(demo.build(demo.WIDE, COARSE, progress=False), demo.WIDE, progress=False)


def test_pressures_are_those_of_full_finite_elements(wide: wf.Result) -> None:
    """The same two bodies, hub held and outside fixed, as quadratic cells without modes, in two dimensions."""
    case = Pin(demo.RADIUS, demo.WIDE * demo.RADIUS, demo.HOLE, demo.OUTSIDE, demo.MATERIAL, demo.MATERIAL, held=True)
    for i, angle, exact in demo.settled(wide, demo.WIDE):
        found = solve_pin(case, exact.load, np.radians(angle), CELLS)
        _, p, half = demo.pressure_around(wide, i)
        peak, arc = p.max() / found.peak_pressure, half / found.moment_angle
        print(f"{angle:g} degrees: peak {peak - 1.0:+.2%}, arc {arc - 1.0:+.2%}")
        assert abs(peak - 1.0) < PEAK
        assert abs(arc - 1.0) < ARC


def test_pressure_is_the_same_over_the_width(wide: wf.Result) -> None:
    """Poisson's ratio is 0: every section is the same plane problem. Newton's tolerance is 1e-9 of the force."""
    p = wide.contact(demo.PAIR).mean_pressure[-1]
    assert p.shape[1] == 3
    assert np.ptp(p, axis=1).max() < 1e-6 * p.max()
    assert wide.history.counters["rejected_steps"] < 10  # where a ramp of the load begins, half of it within a step


@pytest.mark.parametrize(("width", "angle", "stands"), [(5e-3, 60.0, True), (5e-4, 30.0, True), (5e-4, 40.0, False)])
def test_a_thin_slice_tips_and_that_of_the_demo_stands(
    monkeypatch: pytest.MonkeyPatch, width: float, angle: float, stands: bool
) -> None:
    monkeypatch.setattr(demo, "WIDTH", width)
    monkeypatch.setitem(demo.ANGLES, demo.WIDE, (angle,))
    modes = wf.eigenmodes(demo.build(demo.WIDE, COARSEST, progress=False), 40)
    growing = np.flatnonzero(np.real(modes.eigenvalues) > GROWS)
    print(f"{width * 1e3:g} mm, {angle:g} degrees: growing {np.real(modes.eigenvalues)[growing]} 1/s")
    if stands:
        assert not len(growing)
        return
    (mode,) = growing
    shape = modes.shape(int(mode), "pin")
    turn = np.abs(shape.rotation)
    assert modes.energy_shares(int(mode))["pin"] > 0.9  # tips about x, across load and axis
    assert turn[0] > 100.0 * turn[1:].max()
