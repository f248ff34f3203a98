"""Contact on modes with inertia: impulsive steps against their equations in NumPy, and what they must not do."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from impact_reference import Half, collide

from references.closed_forms import BarImpact
from studies.contact.colliding_bars import LENGTH, SPEED, bar
from warpffrf.model.contact import Contact
from warpffrf.model.damping import default_damping
from warpffrf.model.integrators import HHT, GeneralizedAlpha, Newmark
from warpffrf.model.material import Material
from warpffrf.model.mesh import box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.local_modes import dynamic_modes
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Plane
from warpffrf.offline import ReductionOptions, reduce
from warpffrf.online.engine import Engine
from warpffrf.online.local_modes import LocalModes
from warpffrf.online.run import run
from warpffrf.online.settings import Settings
from warpffrf.online.step.launches import threads
from warpffrf_kernels.core import control as k
from warpffrf_kernels.step.step_control import LEAST_GAIN, MOST_GAINED, decide

MODES, GAP = 6, 1e-7
UNGATED = Settings(energy_tolerance=1e9)
AGREE = 1e-7  # of the largest force: what the residual tolerance of 1e-9 leaves, times the steps in which it adds up
GAINED = 1e-3  # of the energy, a tenth of what is promised
STEEL = Material(210e9, 0.0, 7800.0)
BLOCK, SIDE = 0.2, 0.02  # m


def bars(body: ReducedBody, **options: Any) -> Scene:
    scene = Scene()
    first = scene.add_body(body, name="first", velocity=(SPEED, 0.0, 0.0), **options)
    second = scene.add_body(body, name="second", position=(LENGTH + GAP, 0.0, 0.0), **options)
    scene.add(Contact(first["right"], second["left"], name="pair"))
    return scene


@pytest.mark.parametrize("integrator", [GeneralizedAlpha(0.8), GeneralizedAlpha(0.0), HHT(-0.3), Newmark()])
@pytest.mark.parametrize(
    ("treatment", "alpha", "turn"), [("hht", -0.3, 0.4), ("hht", 0.0, 6.0), ("exponential", -0.1, 4.0)]
)
def test_the_step_is_that_of_its_equations(integrator: Any, treatment: str, alpha: float, turn: float) -> None:
    """Force and energy at every step of two bars, no step halved; `turn`: omega h of the local mode."""
    body = bar(MODES)
    local = LocalModes(treatment, alpha=alpha, damping=0.03)
    h = turn / dynamic_modes(body.contact_surfaces["left"]).omega[0]
    steps = 200
    history = run(
        bars(body), steps * h, step=h, local_modes=local, integrator=integrator, settings=UNGATED, progress=False
    )
    assert history.status == "completed" and not history.counters["rejected_steps"]
    half = Half.of(body, default_damping(body.frequencies), integrator.coefficients, local, h)
    assert half.exact.any() == (treatment == "exponential")
    force, energy, repeated = collide(half, 0.5 * SPEED, GAP, h, steps)
    assert history.counters["repeated_steps"] == repeated > 0
    found = -history.contacts["pair"].force[:, 0]
    assert np.abs(found - force).max() < AGREE * force.max()
    moved = 0.5 * 2.0 * body.mass * (0.5 * SPEED) ** 2  # kinetic energy of the centre of mass, not in the half model
    total = np.sum([history.energy[name] for name in ("kinetic", "strain", "contact")], axis=0) - moved
    assert np.abs(total - energy).max() < 1e-6 * energy.max()


@pytest.fixture(scope="module")
def block() -> ReducedBody:
    """A bar with 63 shape functions on each end."""
    mesh = box((BLOCK, SIDE, SIDE), (20, 4, 4), order=2)
    faces = {"x_max": Plane(), "x_min": Plane()}
    return reduce(
        mesh,
        STEEL,
        contact=faces,
        max_frequency=60e3,
        options=ReductionOptions(local_dynamics=True),
        cache=False,
        progress=False,
    )


def blocks(body: ReducedBody, tilt: float) -> Scene:
    scene = Scene()
    first = scene.add_body(body, name="first", velocity=(SPEED, 0.0, 0.0))
    turned = (0.0, np.sin(0.5 * tilt), 0.0, np.cos(0.5 * tilt))
    second = scene.add_body(body, name="second", position=(BLOCK + GAP + tilt * SIDE, 0.0, 0.0), rotation=turned)
    scene.add(Contact(first["x_max"], second["x_min"], name="pair"))
    return scene


@pytest.mark.parametrize("local", ["hht", LocalModes("hht", max_frequency=200e3), "exponential"])
@pytest.mark.parametrize(("step", "tilt"), [(2e-7, 0.0), (1e-6, 1e-4), (5e-6, 0.0)])
def test_many_nodes_gain_nothing(block: ReducedBody, local: Any, step: float, tilt: float) -> None:
    """Flat and edge first, from resolved to ten times too long steps: contact time of quasi-static local modes where
    flat, momentum kept, no energy from nowhere. (With memory: up to 1e18 times the energy.)"""
    exact = BarImpact(STEEL, BLOCK, SIDE**2, SPEED)
    steps = int(np.ceil(1.6 * exact.duration / step))
    history = run(blocks(block, tilt), steps * step, step=step, local_modes=local, progress=False)
    assert history.status == "completed", history.message
    energy = np.sum([history.energy[name] for name in ("kinetic", "strain", "contact")], axis=0)
    assert energy.max() < (1.0 + GAINED) * energy[0]
    assert energy[-1] > 0.9 * energy[0]  # 6 % by damping, as with quasi-static modes
    velocity = history.bodies["first"].velocity + history.bodies["second"].velocity
    assert np.abs(velocity - velocity[0]).max() < 1e-10 * SPEED
    if not tilt:
        on = history.time[history.contacts["pair"].force[:, 0] < 0.0]
        assert on[-1] - on[0] == pytest.approx(exact.duration, abs=0.1 * exact.duration)


def test_what_is_recorded_has_the_contact_force(block: ReducedBody) -> None:
    """Between impulsive steps the state holds accelerations without it; mass times acceleration is the force."""
    history = run(blocks(block, 1e-4), 4e-5, step=4e-7, local_modes="hht", progress=False)
    assert history.counters["repeated_steps"] > 0
    force = history.contacts["pair"].force
    found = block.mass * history.bodies["first"].acceleration
    assert np.abs(found[1:] - force[1:]).max() < 1e-6 * np.abs(force).max()


def test_a_run_goes_on_from_the_middle_of_an_impact(block: ReducedBody) -> None:
    """Bit for bit, also where the checkpoint is between two impulsive steps."""
    h = 1e-6
    scene = blocks(block, 0.0)
    whole = run(scene, 20 * h, step=h, local_modes="hht", progress=False)
    impulsive = 0
    for steps in (2, 5, 9):
        part = run(scene, steps * h, step=h, local_modes="hht", progress=False)
        impulsive += int(part.checkpoint["ctl"]["impulsive"][0] == int(k.IMPULSIVE))
        rest = run(scene, (20 - steps) * h, step=h, start=part, local_modes="hht", progress=False)
        for name in ("r", "v", "q", "qd", "qd_alg", "pressure"):
            assert np.array_equal(rest.checkpoint[name], whole.checkpoint[name]), name
    assert impulsive > 0


def test_quasi_static_modes_know_nothing_of_it(block: ReducedBody) -> None:
    history = run(blocks(block, 0.0), 2e-5, step=1e-6, progress=False)
    assert not any("without history" in note for note in history.notes)


def test_impacts_together_gain_a_hundredth() -> None:
    """The gate: steps that each gain less than the tolerance are accepted until half of what is left is less; then only
    the smallest are, and a loss makes room again. Losses are those of the integrator and no matter of it."""

    engine = Engine(bars(bar(2)))
    engine.enter(k.DYNAMIC, 1e-6, target=10**6)
    state, program = engine.state, engine.graph.program
    tolerance = engine.settings.energy_tolerance

    def accepted(gain: float) -> bool:
        """Of a step in which contact opens."""
        energy = np.zeros_like(state.energy.numpy())
        energy[0, :, int(k.KINETIC)] = 1.0
        energy[0, 1, int(k.NUMERICAL)] = gain
        state.energy.assign(energy)
        force = np.zeros_like(state.pair_force.numpy())
        force[0, 0, 0, 0] = 1.0
        state.pair_force.assign(force)
        engine.control(every=1, attempt=1, accept=0, failure=0, level=0, sub=0, status=0)
        threads(decide).go(program.arrays, program.sizes, program.device)
        return bool(engine.word("accept")[0])

    assert not accepted(1.1 * tolerance) and accepted(-1.1 * tolerance)
    gain, total = 0.9 * tolerance, 0.0
    while accepted(gain):
        total += gain
        assert total <= float(MOST_GAINED)
    assert total > 0.9 * float(MOST_GAINED)
    least = float(LEAST_GAIN) * tolerance
    assert accepted(0.9 * least)
    assert accepted(-gain) and accepted(-gain) and accepted(gain)
