"""Contact, and local modes with and without inertia: at the same coefficients both solvers agree at every step, and
as the step shrinks they converge at order two to the same limit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from references import monolithic
from scenes.rollers import PAIR, guided_pair
from warpffrf.model import signals
from warpffrf.model.material import Material
from warpffrf.model.mesh import roller
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline import ContactGrid, ReductionOptions, reduce
from warpffrf.online import HHT, LocalModes, Settings, run

DURATION = 1e-3  # s: two periods of the contact, which carries eight kilograms, while the load rises
STEPS = (50, 100, 200)
ALPHA = -0.3
TIGHT = 1e-10  # below, round-off of the accelerations of the stiffest local modes, 450 kHz, is larger
AGREE = 1e-10  # of the largest force, and of the largest movement


@pytest.fixture(scope="module")
def body() -> Any:
    mesh = roller(0.05, 0.015, 0.02, sectors=60, layers=3, axial=2, grading=1.6, order=1)
    return reduce(
        mesh, Material(210e9, 0.3, 7850.0), interfaces={"bore": "rigid"}, contact={"rim": Cylinder()},
        max_frequency=15e3, cache=False, progress=False, options=ReductionOptions(local_dynamics=True),
        grid=ContactGrid(contact_fixed=False),
    )  # fmt: skip


def pressed(body: Any) -> Scene:
    """Two rollers, pressed together harder; the patch keeps its nodes, so that the motion is smooth in time."""
    load = signals.SmoothStep(20e3, 24e3, duration=DURATION)
    scene = guided_pair(body, body, load=load, speed=None)
    for item in scene.bodies:
        item.level = "constant"
    return scene


def histories(scene: Scene, steps: int, local: str) -> list[np.ndarray]:
    """Contact force and place of the upper roller (2, 51) at the same times, of the separated and the monolithic
    solver."""
    found = []
    treatment: Any = LocalModes("hht", alpha=ALPHA) if local == "hht" else local
    settings = Settings(residual_tolerance=TIGHT)
    for history in (
        run(scene, DURATION, step=DURATION / steps, start="equilibrium", integrator=HHT(ALPHA), local_modes=treatment,
            progress=False, settings=settings),
        monolithic.run(scene, DURATION, step=DURATION / steps, start="equilibrium", integrator=HHT(ALPHA),
                       local=local, variant="low_rank", progress=False, tolerance=TIGHT),
    ):  # fmt: skip
        assert history.status == "completed", history.message
        assert not history.counters.get("rejected_steps", 0)
        every = steps // STEPS[0]
        place = history.bodies["upper"].position
        found.append(np.stack([history.contacts[PAIR].force[::every, 2], (place - place[0])[::every, 2]]))
    return found


@pytest.mark.slow
@pytest.mark.parametrize("local", ["quasi_static", "hht"])
def test_equal_at_every_step_and_order_two(body: Any, local: str) -> None:
    scene = pressed(body)
    runs = [histories(scene, steps, local) for steps in STEPS]
    for separated, reference in runs:
        assert np.all(np.abs(separated - reference).max(axis=1) < AGREE * np.abs(reference).max(axis=1))
    orders, limits = [], []
    for solver in (0, 1):
        a, b, c = (found[solver] for found in runs)
        orders.append(np.log2(np.abs(a - b).max(axis=1) / np.abs(b - c).max(axis=1)))
        limits.append(c + (c - b) / 3.0)
    # 1.91 from 50 to 200 steps and 1.975 from 100 to 400: the first has 22 steps in a period of the contact
    assert orders[1] == pytest.approx(2.0, abs=0.15)
    assert orders[0] == pytest.approx(orders[1], abs=1e-4)
    assert np.all(np.abs(limits[0] - limits[1]).max(axis=1) < AGREE * np.abs(limits[1]).max(axis=1))


@pytest.mark.slow
def test_inertia_of_local_modes_moves_what_is_fast_only(body: Any) -> None:
    """A1: with the mass of the local modes the force differs the less, the slower the load is."""
    away = []
    for duration in (1e-3, 4e-3):
        load = signals.SmoothStep(20e3, 24e3, duration=duration)
        scene = guided_pair(body, body, load=load, speed=None)
        forces = [
            monolithic.run(
                scene, duration, step=2e-5, start="equilibrium", integrator=HHT(ALPHA), local=local,
                variant="low_rank", progress=False,
            ).contacts[PAIR].force
            for local in ("quasi_static", "hht")
        ]  # fmt: skip
        away.append(np.abs(forces[0] - forces[1]).max() / np.abs(forces[0]).max())
    assert 0.0 < away[1] < 0.5 * away[0] < 1e-3
