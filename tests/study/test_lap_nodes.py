"""The study of laps on small meshes: static cycles of the engine are those of full finite elements, and motion is."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.study import lap_nodes as study
from warpffrf.study.lap_stacks import Cycle, Sheets, difference, with_halves

SAME = 1e-6  # Newton's method ends at 1e-9 of the forces, cells beside each other are stiffer than alone


@pytest.mark.parametrize(("by", "along"), [("nodes", 10), ("facets", 20)])
def test_a_cycle_is_that_of_full_finite_elements(by: str, along: int) -> None:
    stacked = Sheets((along, 1, 1))
    cycle = Cycle.of(study.SMALL * study.PRELOAD, study.SMALL * 60.0, (2, 4, 8))
    lap, body = stacked.condensed(by), stacked.reduced(4, by=by)
    found = difference(stacked.followed([body], cycle.path), lap, stacked.loads, cycle)
    assert found.states == 0
    assert max(found.pressure, found.traction, abs(found.loss), abs(found.amplitude)) < SAME


def test_a_release_is_that_of_full_finite_elements() -> None:
    found = study.motion(Sheets((20, 1, 1)), study.MODES, study.FEWER, 150)
    assert found.rms < 0.03 and abs(found.loss) < 0.03  # targets of ten modes


def test_halved_steps_are_followed() -> None:
    path, at = with_halves(np.array([[0.0], [1.0], [2.0]]), np.array([1, 1, 2]))
    assert path[:, 0].tolist() == [0.0, 1.0, 1.5, 2.0] and at.tolist() == [0, 1, 3]
