"""The study of small-sliding contacts on small meshes: static cycles of the engine are those of full finite elements,
and motion is."""

from __future__ import annotations

import numpy as np
import pytest

from references.small_sliding.quasi_static import StaticSmallSliding
from studies.small_sliding import nodes as study
from studies.small_sliding.bolts import mean_turn, turning
from studies.small_sliding.stacks import BOLTS, FRICTION, SIZE, Cycle, Sheets, difference, with_halves

SAME = 1e-6  # Newton's method ends at 1e-9 of the forces, cells side by side are stiffer than alone


@pytest.mark.parametrize(("by", "along"), [("nodes", 10), ("facets", 20)])
def test_a_cycle_is_that_of_full_finite_elements(by: str, along: int) -> None:
    stacked = Sheets((along, 1, 1))
    cycle = Cycle.of(study.SMALL * study.PRELOAD, study.SMALL * 60.0, (2, 4, 8))
    lap, body = stacked.condensed(by), stacked.reduced(4, by=by)
    found = difference(stacked.followed([body], cycle.path), lap, stacked.loads, cycle)
    assert found.states == 0
    assert max(found.pressure, found.traction, abs(found.loss), abs(found.amplitude)) < SAME


@pytest.mark.slow
@pytest.mark.parametrize("shank", [None, study.SHANK])
def test_what_whole_loads_change_is_the_turning_of_bolts(shank: float | None) -> None:
    """A hundredth of what linear finite elements miss is left: cubes, and squares that change the springs' tension."""
    stacked = Sheets((20, 1, 1), shank=shank)
    cycle = Cycle.of(study.PRELOAD, 60.0, (1, 4, 8))
    lap, body = stacked.condensed("facets"), stacked.reduced(4, by="facets")
    found = stacked.followed([body], cycle.path)
    tension = np.full(len(BOLTS), study.PRELOAD) if shank is None else found.tension
    turned = StaticSmallSliding(stacked.turning(tension), lap.cells, FRICTION)
    linear, rest = (difference(found, one, stacked.loads, cycle) for one in (lap, turned))
    assert abs(linear.amplitude) > 1e-3 and abs(rest.amplitude) < 0.01 * abs(linear.amplitude)
    assert rest.traction < 0.1 * linear.traction


def test_turning_as_one_is_work_of_forces_that_keep_their_direction_alone() -> None:
    """V = -F h theta^2/2 of pairs, the cosine of their lever, and 0 of springs, whose length stays."""
    stacked = Sheets((20, 1, 1))
    x, theta, F, h = stacked.full.points, 1e-3, 3.0, SIZE[2]
    u = theta * np.stack([x[:, 2], np.zeros(len(x)), -x[:, 0]], axis=1).ravel()
    assert mean_turn(stacked.full) @ u == pytest.approx(theta, rel=1e-10)
    for line, exact in ((False, -0.5 * F * h * theta**2), (True, 0.0)):
        springs = turning(stacked.full, stacked.bolted[:1], h, np.array([F]), line=line)
        assert 0.5 * sum(k * (a @ u) ** 2 for a, k in springs) == pytest.approx(exact, rel=1e-9, abs=1e-15)


@pytest.mark.slow
def test_a_release_is_that_of_full_finite_elements() -> None:
    found = study.motion(Sheets((20, 1, 1)), study.MODES, study.FEWER, 150)
    assert found.rms < 0.03 and abs(found.loss) < 0.03  # targets of ten modes


@pytest.mark.slow
def test_a_release_of_whole_loads_is_that_of_full_finite_elements() -> None:
    found = study.motion(Sheets((20, 1, 1), shank=study.SHANK), study.MODES, 1.0, 150)
    assert found.rms < 0.03 and abs(found.loss) < 0.03


def test_halved_steps_are_followed() -> None:
    path, at = with_halves(np.array([[0.0], [1.0], [2.0]]), np.array([1, 1, 2]))
    assert path[:, 0].tolist() == [0.0, 1.0, 1.5, 2.0] and at.tolist() == [0, 1, 3]
