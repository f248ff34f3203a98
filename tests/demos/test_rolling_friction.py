"""Rollers with friction on a coarse grid: carried along, braked, slipping; the whole demo among the slow tests."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind

import warpffrf as wf
from demos import rolling_friction as demo

SMALL = demo.Size(sectors=750, layers=8, frames=5)
BIG_CELLS = demo.Size(sectors=78, layers=8, axial=2, frames=5, patch=(11, 5))


@pytest.fixture(scope="module")
def result() -> wf.Result:
    found = demo.run(demo.build(SMALL, progress=False), SMALL, progress=False)
    assert found.status == "completed", found.message
    return found


def test_the_upper_roller_is_carried_along_and_then_slips(result: wf.Result) -> None:
    plan, t = demo.schedule(), result.time
    lower, upper = (np.abs(result.body(name).angular_velocity[:, 1]) for name in ("lower", "upper"))
    free = int(np.flatnonzero(t <= plan.free)[-1])
    assert upper[0] < 1e-9 and upper[free] == pytest.approx(lower[free], rel=1e-3)
    pair = result.contact(demo.PAIR)
    assert np.hypot(*pair.force[-1, :2]) / -pair.force[-1, 2] == pytest.approx(0.3, rel=demo.COEFFICIENT)
    # brake less friction slows the flywheel and the roller on it down
    inertia = demo.FLYWHEEL_INERTIA[1] + result.history.scene.body("upper").inertia[1, 1]  # pyright: ignore
    excess = (demo.BEYOND - 1.0) * 0.3 * demo.LOAD * demo.OUTER_RADIUS
    late = t > t[-1] - 3 * demo.CROSSING
    slows = -np.polyfit(t[late], upper[late], 1)[0]
    assert slows == pytest.approx(excess / inertia, rel=0.01)


def test_the_creepage_is_carters_up_to_the_cells(result: wf.Result) -> None:
    """Carter in closed form here: xi = mu a/R' (1 - sqrt(1 - q)) at the mean line load."""
    E_star, R = 210e9 / (2 * (1 - 0.3**2)), 0.025
    a = np.sqrt(4 * 13e3 / 0.01 * R / (np.pi * E_star))
    for share, xi, _ in demo.on_carters_curve(result):
        carter = 0.3 * a / R * (1 - np.sqrt(1 - share))
        assert 1.0 - demo.CELL_ERROR * (SMALL.spacing / a) ** 2 < xi / carter < 1.0  # too small, see the module
    assert np.all(np.diff(result.energy["friction"]) <= 1e-12)
    assert result.contact(demo.PAIR).friction.cells_per_step.max() <= 1.0


def test_the_creepage_on_a_mesh_of_4_mm_is_carters() -> None:
    """The same in closed form; cells travel with the patch, of which an element is seven half-widths long."""
    result = demo.run(demo.build(BIG_CELLS, progress=False), BIG_CELLS, progress=False)
    assert result.status == "completed" and result.contact(demo.PAIR).loaded == "cells"
    E_star, R = 210e9 / (2 * (1 - 0.3**2)), 0.025
    a = np.sqrt(4 * 13e3 / 0.01 * R / (np.pi * E_star))
    for share, xi, _ in demo.on_carters_curve(result):
        assert xi == pytest.approx(0.3 * a / R * (1 - np.sqrt(1 - share)), rel=demo.ON_PATCH)
    pair = result.contact(demo.PAIR)
    assert np.hypot(*pair.force[-1, :2]) / -pair.force[-1, 2] == pytest.approx(0.3, rel=demo.COEFFICIENT)
    assert np.all(pair.friction.state[-1] != 1) and np.all(np.diff(result.energy["friction"]) <= 1e-12)


@pytest.mark.slow
def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    left_behind(tmp_path / "out", "rolling_friction", "coarse", "patch")
