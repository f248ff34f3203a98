"""Energy with friction (VERIFICATION C10): a spinning roller strikes the ground at steps from 1e-6 to 1e-3 s."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from scenes.rollers import STEEL
from warpffrf.model import forces, joints, laws, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ContactGrid, reduce
from warpffrf.online.history.history import History
from warpffrf.online.run import run

RADIUS, FRICTION = 0.05, 0.3
GAINED = 0.01  # of the energy that arrives, in one impact
SPEED, SPIN = 0.14, 4.0  # m/s, of a fall of 1 mm; rad/s
PRESSED, MOVING = 2000.0, 1.0  # N; m/s, with which a block begins to slide
STOPS = 4e-3  # of the stopping distance: half of a step halved six times, and elastic slip
RUBBED = 1e-9  # of the energy: round-off of one step's friction work
LAWS: list[Any] = [
    (laws.Unilateral(), laws.Coulomb(FRICTION)),
    (laws.Unilateral(), laws.RegularisedCoulomb(FRICTION, 1e-3)),
    (laws.LinearLayer(1e13), laws.Coulomb(FRICTION)),
    (laws.NonlinearLayer(1e15, 1.5), laws.Coulomb(FRICTION)),
    (laws.ExponentialAsperities(1e7, 1e-6), laws.Coulomb(FRICTION)),
    (laws.HuntCrossley(1e15, 1.5, restitution=0.6, impact_speed=SPEED), laws.Coulomb(FRICTION)),
]


def named(index: int) -> str:
    return f"{LAWS[index][0].kind}-{LAWS[index][1].kind}"


@pytest.fixture(scope="module")
def body() -> ReducedBody:
    mesh = roller(RADIUS, 0.015, 0.01, sectors=720, layers=4, axial=1, grading=1.8, order=1)
    return reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()}, max_frequency=12e3,
        grid=ContactGrid(tangential=True, contact_fixed=False), cache=False, progress=False,
    )  # fmt: skip


def strike(body: ReducedBody, law: Any, friction: Any, step: float, phase: float) -> History:
    """A free roller, spinning, falls on the ground; `phase` of the step at which it touches."""
    gap = 2e-6 + phase * SPEED * step
    scene = Scene()
    spinning = scene.add_body(
        body, name="roller", position=(0.0, 0.0, RADIUS + gap), velocity=(0.02, 0.0, -SPEED),
        angular_velocity=(0.0, SPIN, 0.0),
    )  # fmt: skip
    plane = surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0), direction=(0.0, 1.0, 0.0))
    floor = scene.ground.surface(plane, name="floor")
    scene.add(Contact(spinning["rim"], floor, law=law, friction=friction, name="pair"))
    steps = int(np.ceil(max(4e-4, 6.0 * step) / step))
    return run(scene, steps * step, step=step, progress=False)


def gains_nothing(body: ReducedBody, index: int, step: float, phase: float) -> None:
    law, friction = LAWS[index]
    history = strike(body, law, friction, step, phase)
    assert history.status == "completed", history.message
    energy = sum((history.energy[line] for line in ("kinetic", "strain", "contact", "potential")), np.zeros(1))
    c = history.contacts["pair"]
    gained, left = energy.max() / energy[0] - 1.0, energy[-1] / energy[0]
    print(f"{named(index)}, h = {step:g}: {gained:.1e} gained, {left:.3f} left")
    assert energy.max() < (1.0 + GAINED) * energy[0]
    assert np.diff(history.energy["friction"]).max() < RUBBED * energy[0]
    assert c.friction is not None and c.friction.power.min() * step > -RUBBED * energy[0]
    assert c.pressure.min() >= 0.0
    assert history.bodies["roller"].velocity[-1, 2] > 0.0
    turned = SPIN - history.bodies["roller"].angular_velocity[-1, 1]
    assert turned > 0.01 * SPIN  # friction has slowed the spin and sped the roller up
    assert history.bodies["roller"].velocity[-1, 0] > 0.02


@pytest.mark.parametrize("index", range(len(LAWS)), ids=named)
def test_a_strike_gains_nothing(body: ReducedBody, index: int) -> None:
    for step in (3e-5, 1e-3):
        gains_nothing(body, index, step, 0.37)


@pytest.mark.slow
@pytest.mark.parametrize("phase", [0.03, 0.31, 0.62, 0.87])
@pytest.mark.parametrize("step", [1e-6, 1e-5, 1e-4, 3e-4, 1e-3])
@pytest.mark.parametrize("index", range(len(LAWS)), ids=named)
def test_a_strike_gains_nothing_at_more_steps(body: ReducedBody, index: int, step: float, phase: float) -> None:
    gains_nothing(body, index, step, phase)


@pytest.mark.parametrize("step", [2e-4, 5e-5])
def test_a_block_that_slides_at_the_start_stops_where_it_should(body: ReducedBody, step: float) -> None:
    """From an equilibrium, at a velocity: friction acts from the start on, x = v^2/(2 a), a = mu N/m."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    velocity = (MOVING, 0.0, 0.0)
    block = scene.add_body(body, name="block", position=(0.0, 0.0, RADIUS), velocity=velocity)
    slide = scene.add_rigid_body(1.0, (0.01,) * 3, name="slide", position=(0.0, 0.0, RADIUS), velocity=velocity)
    center = slide.at((0.0, 0.0, 0.0))
    scene.add(joints.Prismatic(scene.ground, center, axis=(1, 0, 0), name="along"))
    scene.add(joints.Prismatic(center, block["bore"], axis=(0, 0, 1), name="down"))
    scene.add(forces.PointForce(block["bore"], (0.0, 0.0, -PRESSED)))
    floor = scene.ground.surface(surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    scene.add(Contact(block["rim"], floor, friction=FRICTION, name="pair"))
    slowed = FRICTION * PRESSED / (1.0 + body.mass)
    steps = int(np.ceil(1.5 * MOVING / slowed / step))
    history = run(scene, steps * step, step=step, start="equilibrium", progress=False)
    assert history.status == "completed", history.message
    t = np.minimum(history.time, MOVING / slowed)
    stops = MOVING**2 / (2.0 * slowed)
    assert history.bodies["slide"].position[:, 0] == pytest.approx(
        MOVING * t - 0.5 * slowed * t**2, rel=0.0, abs=STOPS * stops
    )
