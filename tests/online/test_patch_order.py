"""Order in the step of runs on cells that travel: cells follow the pressures of the end of a step, not of its begin."""

from __future__ import annotations

import numpy as np

import warpffrf as wf
from warpffrf.online import run
from warpffrf.verification.scenes.rollers import PAIR, guided_pair, roller_body

STEPS = (4e-5, 2e-5, 1e-5)  # s; the rollers vibrate on their contact with a period of 0.3 ms
EVERY, DURATION, RISE = 4e-5, 2e-3, 1.6e-3  # s
ORDER = 1.8  # 1.9 to 2.0 measured; cells of the begin of a step make it 1.0


def test_cells_and_motion_are_of_second_order_in_the_step() -> None:
    body = roller_body(40, layers=4, axial=3, max_frequency=12e3, patch_grid=True, cache=False)
    widths, places, forces = [], [], []
    for step in STEPS:
        load = wf.signals.SmoothStep(10e3, 20e3, duration=RISE)
        scene = guided_pair(body, body, load=load, speed=20.0, ramp=RISE)
        scene.contacts[0].grid = "patch"
        history = run(scene, DURATION, step=step, start="equilibrium", save_every=round(EVERY / step), progress=False)
        assert history.status == "completed", history.message
        found = history.contacts[PAIR]
        assert found.cells is not None
        widths.append(np.asarray(found.cells.half_width))
        forces.append(np.asarray(found.force))
        places.append(history.bodies["upper"].position - history.bodies["upper"].position[0])
    for values in (widths, places, forces):
        apart = [np.linalg.norm(a - b) for a, b in zip(values, values[1:], strict=False)]
        orders = np.log2(np.divide(apart[:-1], apart[1:]))
        print(orders)
        assert orders.min() > ORDER
