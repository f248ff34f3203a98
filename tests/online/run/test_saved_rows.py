"""Rows at every so many steps, and one at the end of a run whatever their number."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from warpffrf.model.errors import InputError
from warpffrf.model.integrators import RungeKutta4
from warpffrf.model.scene import Scene
from warpffrf.online.engine import Engine
from warpffrf.online.run import run
from warpffrf_kernels.core import control as k

STEP = 1e-3  # s


def falling() -> Scene:
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    scene.add_rigid_body(1.0, (0.1,) * 3, name="stone")
    return scene


@pytest.mark.parametrize("integrator", [None, RungeKutta4()], ids=["kernels", "host"])
@pytest.mark.parametrize(("steps", "every", "saved"), [(10, 4, (0, 4, 8, 10)), (8, 4, (0, 4, 8)), (3, 7, (0, 3))])
def test_the_end_is_saved(integrator: Any, steps: int, every: int, saved: tuple[int, ...]) -> None:
    history = run(falling(), steps * STEP, step=STEP, save_every=every, integrator=integrator, progress=False)
    np.testing.assert_allclose(history.time, STEP * np.array(saved), rtol=0.0, atol=1e-15)


def test_a_run_that_goes_on_saves_its_own_end() -> None:
    first = run(falling(), 5 * STEP, step=STEP, save_every=3, progress=False)
    second = run(falling(), 5 * STEP, step=STEP, save_every=3, start=first, progress=False)
    np.testing.assert_allclose(second.time, STEP * np.array([6, 9, 10]), rtol=0.0, atol=1e-15)


def test_an_engine_saves_every_step_and_refuses_none() -> None:
    engine = Engine(falling())
    engine.enter(k.DYNAMIC, STEP, target=3)
    engine.replay(3)
    assert len(engine.saved()["saved_time"]) == 3
    with pytest.raises(InputError, match="every is 0; save every step, 1"):
        engine.control(every=0)
