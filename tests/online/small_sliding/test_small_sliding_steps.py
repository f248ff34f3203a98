"""Load steps of joints that are stiff compared with their bodies: faces that touch to begin with, loads that turn back,
and forces that cancel."""

from __future__ import annotations

import numpy as np

from studies.small_sliding.cases import FIT, LEAVES, TURNED, pressed_on, two_leaves
from studies.small_sliding.rows import cycle, loads, static


def test_leaves_begin_pressed_and_turn_back_without_small_steps() -> None:
    """Alone, a leaf would bend by a tenth of its length under the pressure: a step of Newton's method that begins with
    open cells, or goes on with slipping ones, ends far away."""
    path = cycle(2)
    found = static(two_leaves((10, 1), loads(path, 2.0 * LEAVES.slip_force)), len(path) - 1)
    lap = found.contact("joint")
    assert np.all(lap.counts[:, 0] == 0)
    assert lap.counts[0].tolist() == [0, 10, 0] and lap.counts[2].tolist() == [0, 0, 10]
    assert np.mean(found.history.iterations[1:]) < 25.0
    tip = found.sensor("tip").values[:, 2]
    assert abs(tip[-1] - tip[2]) < 1e-6 * abs(tip[2] - tip[6])  # closed loop


def test_pressures_that_cancel_are_in_equilibrium() -> None:
    """Of a press fit neither a body nor a mode feels more than round-off: what counts is the forces that cancel."""
    found = static(pressed_on(8, loads([0.0, 1.0], TURNED)), 1)
    lap = found.contact("seat")
    assert np.linalg.norm(lap.force[0]) < 1e-8 * lap.normal_force[0]
    assert np.ptp(lap.pressure[0]) < 1e-6 * FIT.pressure
