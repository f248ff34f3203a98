"""Static runs against closed forms and single equilibria: load cycles, large deflections, friction, what follows."""

from __future__ import annotations

import time

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model import forces, joints, sensors
from warpffrf.model.errors import InputError
from warpffrf.model.friction import Coulomb, RegularisedCoulomb
from warpffrf.model.material import Material
from warpffrf.model.mesh import box
from warpffrf.model.reduced_body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.signals import SmoothStep, Table
from warpffrf.offline import reduce
from warpffrf.online.stages import Stage

LENGTH, WIDTH, HEIGHT, YOUNG, DENSITY = 1.0, 0.03, 0.01, 210e9, 7850.0
BENDING = YOUNG * WIDTH * HEIGHT**3 / 12.0  # N m2
BALANCED = 1e-8  # of the largest displacement: forces balance to 1e-9 of the largest one
CYCLE = ([0.0, 1.0, 3.0, 5.0], [0.0, 1.0, -1.0, 1.0])


def cycle(amplitude: float) -> Table:
    return Table(CYCLE[0], amplitude * np.array(CYCLE[1]), hold=True)


@pytest.fixture(scope="module")
def beam() -> ReducedBody:
    """A bar along y, 20 modes."""
    return reduce(
        box((WIDTH, LENGTH, HEIGHT), (1, 24, 1), order=2), Material(YOUNG, 0.0, DENSITY),
        interfaces={"y_min": "rigid", "y_max": "rigid"}, modes=20, stiffening=True, progress=False,
    )  # fmt: skip


def cantilever(beam: ReducedBody, load: object, *, stiffening: bool = False) -> Scene:
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    bar = scene.add_body(beam, name="bar", position=(0.0, 0.5 * LENGTH, 0.0), stiffening=stiffening)
    scene.add(joints.Fixed(scene.ground, bar["y_min"], name="root"))
    scene.add(forces.PointForce(bar["y_max"], (0.0, 0.0, load), name="load"))
    scene.add(sensors.Position(bar["y_max"], name="tip"))
    return scene


def tip(result: wf.Result) -> np.ndarray:
    return result.history.sensors["tip"].values - np.array([0.0, LENGTH, 0.0])


def test_a_load_cycle_of_a_beam_and_a_spring(beam: ReducedBody) -> None:
    """The tip is held by the beam, 3 EI/L^3 but for shear, and a spring: in proportion to the load at all steps. The
    load is small, so that turns of the root are (they go with its square)."""
    free = wf.equilibrium(cantilever(beam, 1e-3))
    stiffness = 1e-3 / tip(free)[-1, 2]
    assert stiffness == pytest.approx(3.0 * BENDING / LENGTH**3, rel=1e-3)
    scene = cantilever(beam, cycle(1e-3))
    spring = scene.add(joints.Prismatic(scene.ground, scene.add_rigid_body(1.0, (1, 1, 1), name="end"), axis=(0, 0, 1)))
    scene.add(forces.JointSpringDamper(spring, 2.0 * stiffness, damping=5.0, name="spring"))
    scene.add(joints.Fixed(scene.bodies[0]["y_max"], scene.bodies[1].at((0, LENGTH, 0)), name="tie", **{}))
    with pytest.raises(InputError):
        scene.add(joints.Fixed(scene.bodies[0]["y_max"], scene.bodies[1], name="tie"))


def test_five_hundred_steps_take_less_than_three_seconds(beam: ReducedBody) -> None:
    scene = cantilever(beam, cycle(BENDING / LENGTH**2), stiffening=True)
    wf.simulate(scene, 0.02, step=0.01, kind="static", progress=False)  # compiles the kernels
    began = time.perf_counter()
    result = wf.simulate(scene, 5.0, step=0.01, kind="static", progress=False)
    assert result.status == "completed", result.message
    assert time.perf_counter() - began < 3.0
