"""The rollers of 4 mm tetrahedra, pressed: statics, Hertz, and the closed form of the stress below."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import coarse_rollers as demo
from demos import two_rollers as fine
from demos.coarse_rollers import DEPTHS, PAIR, STEEL
from references.closed_forms import LineContact

BALANCE = 1e-6  # of the force
HALF_WIDTH, PEAK = 0.01, 0.01  # of Hertz's, on nine strips
BETWEEN = 0.01  # of the fine run's peak pressure, which is itself 0.3 % off Hertz
MISES, MISES_DEPTH = 0.02, 0.02  # the mesh's own 1 %, and what the free ends let go of the axial stress
RIPPLE = 5e-4  # of the peak pressure


def ripple(result: wf.Result) -> float:
    """How far the peak pressure at mid-width goes up and down over the last part of the run, of its mean [-]."""
    peak = result.contact(PAIR).mid_peak_pressure[result.time >= result.time[-1] - fine.SETTLED]
    return float(np.ptp(peak) / peak.mean())


def largest_mises(z: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """Largest value and its depth, of von Mises stresses `values` at depths `z`, by a curve through those around it."""
    near = np.abs(z - z[np.argmax(values)]) < 0.5 * z[np.argmax(values)]
    curve, at = np.polynomial.Polynomial.fit(z[near], values[near], 4), np.linspace(z[near][0], z[near][-1], 2001)
    return float(curve(at).max()), float(at[np.argmax(curve(at))])


def line_contact(result: wf.Result, i: int) -> LineContact:
    """Hertz's contact at the line load found in saved step `i`."""
    pair = result.contact(PAIR)
    return LineContact(float(pair.line_load[i]), pair.effective_radius, pair.effective_modulus)


def checks(scene: wf.Scene, coarse: wf.Result, beside: wf.Result) -> list[Check]:
    """Of the coarse run, compared with statics, Hertz and the fine one."""
    rows = np.flatnonzero(coarse.time >= coarse.time[-1] - fine.SETTLED)
    pair, other = coarse.contact(PAIR), beside.contact(PAIR)
    hertz = [pair.hertz(int(i)) for i in rows]
    width, peak = (float(np.mean([getattr(h, what) for h in hertz])) for what in ("half_width", "peak_pressure"))
    last = beside.time >= beside.time[-1] - fine.SETTLED
    found = largest_mises(DEPTHS, coarse.stress("lower", "below").von_mises[0])
    exact = largest_mises(DEPTHS, line_contact(coarse, 0).von_mises(DEPTHS, STEEL.poisson_ratio))
    return [
        Check("contact force", float(pair.force_magnitude[rows].mean()),
              fine.static_force(scene, coarse, fine.LOAD_AFTER), "statics", BALANCE, "kN", 1e-3),
        Check("half-width", float(pair.half_width[rows].mean()), width, "Hertz", HALF_WIDTH, "um", 1e6),
        Check("peak pressure", float(pair.mid_peak_pressure[rows].mean()), peak, "Hertz", PEAK, "MPa", 1e-6),
        Check("peak pressure", float(pair.mid_peak_pressure[rows].mean()), float(other.mid_peak_pressure[last].mean()),
              "two_rollers", BETWEEN, "MPa", 1e-6),
        Check("line load at mid-width", float(pair.line_load[rows].mean()), float(other.line_load[last].mean()),
              "two_rollers", BETWEEN, "kN/m", 1e-3),
        Check("largest von Mises stress, at 20 kN", found[0], exact[0], "Hertz, plane strain", MISES, "MPa", 1e-6),
        Check("its depth", found[1], exact[1], "Hertz, plane strain", MISES_DEPTH, "um", 1e6),
        Check("ripple of the peak pressure", ripple(coarse), 0.0,
              f"the true rim is round; two_rollers {ripple(beside):.0e}", RIPPLE, scale=1.0),
    ]  # fmt: skip


# Johnson, section 4.2.1, nu = 0.3: the largest von Mises stress of a line contact, and where; to their digits.
LARGEST, WHERE = 0.558, 0.70


def test_the_curve_finds_the_largest_stress_of_a_line_contact() -> None:
    t = np.linspace(0.1, 2.0, 39)
    value, depth = largest_mises(t, LineContact(0.5 * np.pi, 1.0, 2.0).von_mises(t, 0.3))
    assert value == pytest.approx(LARGEST, abs=1e-3) and depth == pytest.approx(WHERE, abs=1e-2)


@pytest.mark.slow
def test_the_pressed_pair_carries_the_load_and_is_hertzian() -> None:
    scene = demo.build(progress=False)
    result = wf.equilibrium(scene)
    assert result.status == "completed", result.message
    pair = result.contact(demo.PAIR)
    assert pair.loaded == "cells"
    assert pair.force_magnitude[-1] == pytest.approx(fine.static_force(scene, result, fine.LOAD), rel=BALANCE)
    # in closed form here, at the line load found at mid-width
    E_star, R = 210e9 / (2 * (1 - 0.3**2)), fine.OUTER_RADIUS / 2
    a = np.sqrt(4 * pair.line_load[-1] * R / (np.pi * E_star))
    peak = 2 * pair.line_load[-1] / (np.pi * a)
    assert pair.half_width[-1] == pytest.approx(a, rel=HALF_WIDTH)
    assert pair.mid_peak_pressure[-1] == pytest.approx(peak, rel=PEAK)
    found = largest_mises(demo.DEPTHS, result.stress("lower", "below").von_mises[-1])[0]
    assert found == pytest.approx(LARGEST * peak, rel=MISES)


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    """Compared with the run of the demo `two_rollers` as well, whose mesh is made for the contact."""
    (coarse,) = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "coarse_rollers")
    beside = wf.simulate(
        fine.build(fine.QUICK if quick else fine.FULL, progress=False), fine.DURATION, step=fine.STEP,
        start="equilibrium", progress=False,
    )  # fmt: skip
    assert not missed(checks(coarse.scene, coarse, beside))
