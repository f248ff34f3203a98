"""The pin in a bore, whole; Persson's closed form for like materials written into the check here."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import pin_in_bore as demo
from demos.pin_in_bore import ANGLES, MATERIAL, PAIR, RADIUS, WIDTH, waits
from references.closed_forms import ConformalPin, conformal_by_half_angle, persson
from references.finite_elements.pin_in_bore import Pin, solve_pin

CLOSE, WIDE = demo.CLEARANCE, 1e-2  # clearances, of the radius
PERSSON_PEAK, PERSSON_ARC = 0.02, 0.03  # of the peak pressure and of the half-angle


def states(clearance: float) -> list[ConformalPin]:
    """Persson's states that the run at `clearance` of the radius waits in."""
    return [
        conformal_by_half_angle(np.radians(angle), RADIUS, clearance * RADIUS, MATERIAL, MATERIAL) for angle in ANGLES
    ]


def pressure_around(result: wf.Result, i: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Angle from the line of centres (columns,) [rad] and pressure, mean over the width (columns,) [Pa], of the saved
    step `i`; and twice the root of its second moment [rad]."""
    pair = result.contact(PAIR)
    z = pair.z
    share = np.gradient(z) * np.where(np.isin(np.arange(len(z)), (0, len(z) - 1)), 0.5, 1.0)  # trapezoids along z
    share /= share.sum()
    angle = pair.arc[i] / RADIUS
    p, raw = pair.mean_pressure[i] @ share, pair.history.pressure[i] @ share
    pitch = pair.spacing / RADIUS
    center = (raw @ angle) / raw.sum()
    second = raw @ ((angle - center) ** 2 + pitch**2 / 6.0) / raw.sum()  # nodes, see `output.contact.result`
    return angle, p, 2.0 * float(np.sqrt(second))


def settled(result: wf.Result, clearance: float) -> list[tuple[int, float, ConformalPin]]:
    """The saved steps at the ends of the waits, the half-angle [deg] that they should have, and Persson's state."""
    rows = [int(np.argmin(np.abs(result.time - end))) for end in waits()]
    return list(zip(rows, ANGLES, states(clearance), strict=True))


def checks(results: dict[float, wf.Result]) -> list[Check]:
    """The figures of the runs, clearance -> result."""
    found = []
    for clearance, result in results.items():
        for i, angle, exact in settled(result, clearance):
            _, p, half = pressure_around(result, i)
            label = f"{angle:.0f} deg, clearance {clearance:g}"
            force = float(result.contact(PAIR).force[i, 2])
            found += [
                Check(f"{label}: force", force, WIDTH * exact.load, "statics", 1e-6, "N"),
                Check(f"{label}: peak", float(p.max()), exact.peak_pressure, "Persson", PERSSON_PEAK, "MPa", 1e-6),
                Check(f"{label}: half-angle", half, exact.moment_angle, "Persson, of the second moment", PERSSON_ARC,
                      "deg", float(np.degrees(1.0))),
            ]  # fmt: skip
    return found


COARSE, COARSEST = demo.Size(sectors=96), demo.Size(sectors=48)
PEAK, ARC = 0.01, 0.01  # compared with full finite elements; six columns of the grid in the smallest half-angle
CELLS = 24.0  # of them in the half-angle: 0.1 % of the finest
GROWS = 100.0  # 1/s: faster than this is no round-off of the linearisation


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    (close,) = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "pin_in_bore")
    found = checks({CLOSE: close, WIDE: demo.run(demo.build(WIDE, progress=False), progress=False)})
    assert len(found) == 3 * 6 and not missed(found)
    computed = {check.name: check.computed for check in found}
    E_star = 0.5 * 210e9  # two like bodies, Poisson's ratio 0
    for clearance in (CLOSE, WIDE):
        for angle, line, peak in zip(ANGLES, demo.LOADS, demo.PEAKS, strict=True):
            ratio, exact = persson(np.radians(angle), np.zeros(1))
            load = E_star * clearance * RADIUS / ratio
            assert (clearance * line, clearance * peak) == pytest.approx((load, exact[0] * load / RADIUS), rel=1e-8)
            label = f"{angle:.0f} deg, clearance {clearance:g}"
            assert computed[f"{label}: force"] == pytest.approx(load * demo.WIDTH, rel=1e-6)
            assert computed[f"{label}: peak"] == pytest.approx(exact[0] * load / RADIUS, rel=PERSSON_PEAK)


@pytest.fixture(scope="module")
def wide() -> wf.Result:
    return demo.run(demo.build(WIDE, COARSE, progress=False), progress=False)


@pytest.mark.slow
def test_pressures_are_those_of_full_finite_elements(wide: wf.Result) -> None:
    """The same two bodies, hub held and outside fixed, as quadratic cells without modes, in two dimensions."""
    case = Pin(demo.RADIUS, WIDE * demo.RADIUS, demo.HOLE, demo.OUTSIDE, demo.MATERIAL, demo.MATERIAL, held=True)
    for i, angle, exact in settled(wide, WIDE):
        found = solve_pin(case, exact.load, np.radians(angle), CELLS)
        _, p, half = pressure_around(wide, i)
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
    state = conformal_by_half_angle(np.radians(angle), RADIUS, WIDE * RADIUS, MATERIAL, MATERIAL)
    scene = demo.build(WIDE, COARSEST, loads=(state.load / WIDE,), largest=angle, progress=False)
    modes = wf.eigenmodes(scene, 40)
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
