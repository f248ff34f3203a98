"""Impulsive steps of a pair against their equations in NumPy: a mass that meets a spring; and what they must not do."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from warpffrf.model import forces, joints, laws, signals
from warpffrf.model.contact import Contact
from warpffrf.model.material import Material
from warpffrf.model.mesh import box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Plane
from warpffrf.offline import reduce
from warpffrf.online import Settings, find_equilibrium, run

SIDE = 0.02  # m
MASS, SPEED, LOAD = 0.2, 0.5, 1000.0  # kg, m/s, N
HARD = Material(210e13, 0.0, 7800.0)
LAYER = laws.LinearLayer(1e12)  # Pa/m: a thousand times softer than the block behind it
LINE = "along"
RINGS = (
    1e-3  # of the largest energy: what unresolved modes of the block gain after an impact, a tenth of what is promised
)
UNGATED = Settings(energy_tolerance=1e9)  # whatever the stiff modes of the block do after the impact
AGREE = 3e-4  # of force and speed: an impulsive step may lose 2e-4 of the energy, `impulsive_means.LOST`
CREATED = 1e-6  # of the energy put in: a round-off of 1e-8 a bounce, in a hundred of them


@pytest.fixture(scope="module")
def block() -> ReducedBody:
    """A cube to clamp on one side; a rigid plane that meets the layer on the other feels a spring that acts one way."""
    mesh = box((SIDE, SIDE, SIDE), (2, 2, 2))
    return reduce(
        mesh, HARD, interfaces={"x_min": "rigid"}, contact={"x_max": Plane()}, modes=0, cache=False, progress=False
    )


def between(block: ReducedBody, gap: float, *, walls: int = 1, velocity: float = SPEED, force: Any = None) -> Scene:
    """A mass on a guide along x that flies to a clamped block at `gap` [m], and back to another one as far behind."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    faces = {
        "front": Plane(origin=(0.0, 0.0, 0.0), outward=(1.0, 0.0, 0.0)),
        "back": Plane(origin=(0.0, 0.0, 0.0), outward=(-1.0, 0.0, 0.0)),
    }
    mass = scene.add_rigid_body(MASS, (1e-4,) * 3, name="mass", velocity=(velocity, 0.0, 0.0), surfaces=faces)
    scene.add(joints.Prismatic(scene.ground, mass.at((0.0, 0.0, 0.0)), axis=(1, 0, 0), name=LINE))
    for face, turn in (("front", (0.0, 0.0, 1.0, 0.0)), ("back", (0.0, 0.0, 0.0, 1.0)))[:walls]:
        side = 1.0 if face == "front" else -1.0
        wall = scene.add_body(block, name=face, position=(side * (gap + 0.5 * SIDE), 0.0, 0.0), rotation=turn)
        scene.add(joints.Fixed(scene.ground, wall["x_min"], name=f"{face} clamp"))
        scene.add(Contact(wall["x_max"], mass[face], name=face, law=LAYER, overlap=1.0))
    if force is not None:
        scene.add(forces.PointForce(mass.at((0.0, 0.0, 0.0)), (force, (1.0, 0.0, 0.0))))
    return scene


def stiffness(block: ReducedBody) -> float:
    """Of the spring [N/m], from rest under LOAD."""
    rest = find_equilibrium(between(block, 1e-6, velocity=0.0, force=LOAD))
    assert rest.status == "completed", rest.message
    return LOAD / (rest.joints[LINE].coordinate[-1] - 1e-6)


def bounce(spring: float, gap: float, h: float) -> tuple[float, float]:
    """Force at the end of the step in which the mass meets the spring, and its speed after the step in which it leaves
    it: x_1 = x_0 + h (v_0 + v_1)/2 under the mean force that gives back the energy of the spring."""
    x, v = gap - SPEED * h * np.floor(gap / (SPEED * h)), SPEED  # the distance left as the step begins

    def depth(theta: float) -> float:  # of x_1 = h v + h^2 f/2, f = -theta spring depth/mass
        return (h * v - x) / (1.0 + 0.5 * h**2 * theta * spring / MASS)

    def created(theta: float) -> float:
        d = depth(theta)
        return 0.5 * spring * d**2 - theta * spring * d * (x + d)

    theta = float(brentq(created, 1e-9, 1.0, xtol=1e-15))  # pyright: ignore[reportArgumentType]
    force = spring * depth(theta)
    v -= h * theta * force / MASS
    stored = 0.5 * force**2 / spring

    def left(mean: float) -> float:  # the mean force that opens
        return stored + mean * (h * v - 0.5 * h**2 * mean / MASS)

    mean = float(brentq(left, 1e-9 * force, force, xtol=1e-12))  # pyright: ignore[reportArgumentType]
    speed = v - h * mean / MASS
    assert 0.5 * h * (v + speed) < -depth(theta)  # it does leave the spring in this step
    return force, speed


@pytest.mark.parametrize("omega_h", [10.0, 30.0, 100.0])
@pytest.mark.parametrize("part", [0.1, 0.5, 0.9])
def test_a_bounce_within_two_steps(block: ReducedBody, omega_h: float, part: float) -> None:
    """The step that closes the gap and the one that opens it, at any phase and any step compared with the spring."""
    spring = stiffness(block)
    h = omega_h / np.sqrt(spring / MASS)
    gap = SPEED * h * (2.0 + part)
    history = run(between(block, gap), 6 * h, step=h, settings=UNGATED, progress=False)
    assert history.status == "completed", history.message
    force, speed = bounce(spring, gap, h)
    assert -speed == pytest.approx(SPEED, rel=1e-12)  # the reference gives back all
    assert -history.bodies["mass"].velocity[4, 0] == pytest.approx(SPEED, rel=AGREE)
    assert np.linalg.norm(history.contacts["front"].force, axis=1)[3] == pytest.approx(force, rel=AGREE)
    assert history.counters["impulsive_steps"] == 2


def check_random(block: ReducedBody, omega_h: float, steps: int) -> None:
    """A mass between two springs that act one way, pushed at random: contact makes no energy, nor does the run."""
    h = omega_h / np.sqrt(stiffness(block) / MASS)
    push = np.random.default_rng(1).normal(size=steps // 5) * min(1.0, omega_h) * MASS * SPEED / (20.0 * h)
    force = signals.Table(np.linspace(0.0, steps * h, steps // 5), push)
    scene = between(block, 10.0 * SPEED * h, walls=2, force=force)
    history = run(scene, steps * h, step=h, save_every=max(1, steps // 2000), progress=False)
    assert history.status == "completed", history.message
    assert history.counters["impulsive_steps"] > steps // 100
    energy = history.energy
    put_in = np.max(energy["kinetic"] + energy["strain"] + energy["contact"])
    gained = energy["numerical"] + energy["contact_grid"]
    print(f"omega h {omega_h:g}: contact {energy['contact_grid'].max() / put_in:.1e}, all {gained.max() / put_in:.1e}")
    assert energy["contact_grid"].max() < CREATED * put_in
    assert gained.max() < RINGS * put_in


@pytest.mark.parametrize("omega_h", [0.1, 1.0, 10.0])
def test_a_mass_between_two_springs(block: ReducedBody, omega_h: float) -> None:
    check_random(block, omega_h, 2000)


@pytest.mark.slow
@pytest.mark.parametrize("omega_h", [0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0])
def test_a_mass_between_two_springs_for_long(block: ReducedBody, omega_h: float) -> None:
    check_random(block, omega_h, 100_000)
