"""The journal bearing, whole; its threshold against eigenvalues, its fit against motions that are known."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind

from demos import journal_bearing as demo

OPPOSITE = 0.5 * demo.COLUMNS  # the column of a groove opposite the load


@pytest.fixture(scope="module")
def linear() -> demo.Linear:
    return demo.linear()


@pytest.mark.slow
def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    checks = left_behind(tmp_path / "out", "journal_bearing", "steady", "light", "heavy")
    assert len(checks) == 18
    light, heavy = (check["computed"] for name, check in checks.items() if "growth over speed" in name)
    assert light < 0.0 < heavy


def test_a_shaft_of_the_critical_mass_neither_grows_nor_dies_out(linear: demo.Linear) -> None:
    mass, frequency = linear.critical
    rate = linear.whirl(mass)
    assert abs(rate.real) < 1e-9 * frequency
    assert rate.imag == pytest.approx(frequency, rel=1e-9)
    assert linear.whirl(0.99 * mass).real < 0.0 < linear.whirl(1.01 * mass).real
    assert linear.stiffness[0, 1] * linear.stiffness[1, 0] < 0.0  # pushes across, round the bore


def test_the_linear_motion_obeys_its_equation(linear: demo.Linear) -> None:
    mass, h = linear.critical[0], 1e-7
    t = 1e-3 + h * np.arange(-1, 2)
    e = linear.motion(mass, np.array([0.1, 0.2]), t)
    rate, second = (e[2] - e[0]) / (2.0 * h), (e[2] - 2.0 * e[1] + e[0]) / h**2
    forces = np.array([mass * second, linear.damping @ rate, linear.stiffness @ e[1]])
    assert np.abs(forces.sum(axis=0)).max() < 1e-4 * np.abs(forces).max()
    begin = linear.motion(mass, np.array([0.1, 0.2]), np.array([0.0, h]))
    assert begin[1] / h == pytest.approx([0.1, 0.2], rel=1e-3)


def test_the_fit_finds_rate_and_frequency() -> None:
    t, rate = np.linspace(0.0, 0.02, 301), complex(-11.0, 760.0)
    e = np.real(np.outer(np.exp(rate * t), [1.0, 0.4 - 0.7j])) + np.array([0.3, -0.2])
    assert demo.fitted(t, e, 700.0) == pytest.approx(rate, rel=1e-9)


def test_a_film_that_damps_by_a_fifth_more_is_told_from_it(linear: demo.Linear) -> None:
    body, shafts = demo.sleeve(demo.RIGID, progress=False), demo.whirling(linear)
    results = {name: demo.turn(body, shaft, degrees=6.0, turns=3, progress=False) for name, shaft in shafts.items()}
    assert all(check.passed for check in demo.whirl_checks(results, shafts, linear))
    other = replace(linear, damping=1.2 * linear.damping)
    failed = [check.name for check in demo.whirl_checks(results, shafts, other) if not check.passed]
    assert "whirl: mass without growth" in failed
    assert sum("growth over speed" in name for name in failed) == 2


def test_voids_between_groove_and_film_let_a_lighter_shaft_whirl() -> None:
    """Of coefficients at rest it would still come to rest; with voids that move in time it grows by 0.0087."""
    film = demo.linear(OPPOSITE)
    shaft = replace(demo.whirling(film, OPPOSITE)["light"], mass=0.95 * film.critical[0])
    result = demo.turn(demo.sleeve(demo.RIGID, progress=False), shaft, degrees=6.0, turns=3, progress=False)
    assert result.status == "completed", result.message
    assert film.whirl(shaft.mass).real < -3e-3 * demo.WHIRL_SPEED
    assert demo.growth(result, film).real == pytest.approx(8.7e-3, abs=1.5e-3)
