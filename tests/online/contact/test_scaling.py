"""One scene in three sizes: with lengths and times scaled by s, materials and speeds kept, energies grow with s^3 and
forces with s^2, and nothing else changes. What depends on an absolute length, time, force or energy would show."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from scenes.rollers import roller_body
from warpffrf.model import forces, joints, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import History, run

SIZES = (1e-4, 1e4)
STEP, STEPS = 1e-5, 30  # s, of the scene of size 1
SAME = 1e-9  # of the largest: round-off of gaps compared with penetrations, 1e-17 m over 1e-7 m
NEARLY = 1e-6  # the same, of the small energies about an equilibrium, which is found to 1e-9 of its forces


@functools.cache
def roller(s: float, radius: float, width: float, friction: bool = False, crown: float | None = None) -> ReducedBody:
    return roller_body(
        60, layers=2, axial=2 if crown is None else 4, grading=1.6, outer_radius=radius * s, inner_radius=0.015 * s,
        width=width * s, crown_radius=None if crown is None else crown * s, max_frequency=20e3 / s, tangential=friction,
        cache=False,
    )  # fmt: skip


def pressed_rollers(s: float, *, speed: float = 0.0, spin: float = 0.0, friction: float = 0.0) -> Scene:
    """A roller on a sprung and damped slide, pressed on another; speed [m/s] towards it, spin [rad/s] at size 1."""
    scene = Scene(gravity=(0.0, 0.0, -9.81 / s))
    lower = scene.add_body(roller(s, 0.05, 0.02, friction > 0.0), name="lower")
    upper = scene.add_body(
        roller(s, 0.04, 0.018, friction > 0.0), name="upper", position=(0.0, 0.0, 0.09 * s),
        velocity=(0.0, 0.0, -speed), angular_velocity=(0.0, spin / s, 0.0),
    )  # fmt: skip
    pair = Contact(lower["rim"], upper["rim"], friction=friction, name="pair")
    scene.add(pair)
    scene.close_gap(pair, along=(0.0, 0.0, 1.0))
    slide = scene.add_rigid_body(
        5.0 * s**3, (0.01 * s**5,) * 3, name="slide", position=upper["bore"].world_point(), velocity=(0.0, 0.0, -speed)
    )
    center = slide.at((0.0, 0.0, 0.0))
    scene.add(joints.Revolute(scene.ground, lower["bore"], axis=(0, 1, 0), name="lower axle"))
    guide = scene.add(joints.Prismatic(scene.ground, center, axis=(0, 0, 1), name="guide"))
    axle = scene.add(joints.Revolute(center, upper["bore"], axis=(0, 1, 0), name="upper axle"))
    scene.add(forces.JointSpringDamper(guide, 2e6 * s, 2e3 * s**2))
    scene.add(forces.JointSpringDamper(axle, 50.0 * s**3, 0.01 * s**4))
    scene.add(forces.PointForce(center, (2e4 * s**2, (0.0, 0.0, -1.0))))
    return scene


def dropped_roller(s: float) -> Scene:
    """A crowned roller, rotated in all directions, thrown on a plane: gaps at points."""
    scene = Scene(gravity=(0.0, 0.0, -9.81 / s))
    thrown = scene.add_body(
        roller(s, 0.05, 0.02, crown=0.6), name="thrown", position=(0.3 * s, 0.0, 0.06 * s), velocity=(0.4, 0.0, -0.5),
        angular_velocity=(0.0, 3.0 / s, 1.0 / s), rotation=(0.01, 0.0, 0.05, np.sqrt(1.0 - 0.0026)),
    )  # fmt: skip
    floor = scene.ground.surface(surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    pair = Contact(thrown["rim"], floor, name="pair")
    scene.add(pair)
    scene.close_gap(pair, along=(0.0, 0.0, -1.0), gap=1e-6 * s)
    return scene


def settled(s: float) -> tuple[Scene, str]:
    return pressed_rollers(s, spin=3.0), "equilibrium"


CASES = {
    "at touch": (lambda s: (pressed_rollers(s, speed=0.3), "initial"), SAME),
    "with friction": (lambda s: (pressed_rollers(s, speed=0.05, spin=20.0, friction=0.3), "initial"), SAME),
    "thrown": (lambda s: (dropped_roller(s), "initial"), SAME),
    "from equilibrium": (settled, NEARLY),
}


@functools.cache
def history(case: str, s: float) -> History:
    scene, start = CASES[case][0](s)
    found = run(scene, STEPS * STEP * s, step=STEP * s, start=start, progress=False)
    assert found.status == "completed", found.message
    return found


@pytest.mark.parametrize("s", SIZES)
@pytest.mark.parametrize("case", CASES)
def test_the_ledger_of_a_scene_scales_with_its_volume(case: str, s: float) -> None:
    one, other = history(case, 1.0), history(case, s)
    largest = max(np.ptp(line) for line in one.energy.values())
    for name, line in one.energy.items():
        assert np.abs(other.energy[name] / s**3 - line).max() < CASES[case][1] * largest, name
    force, scaled = (h.contacts["pair"].force for h in (one, other))
    assert np.abs(scaled / s**2 - force).max() < SAME * np.abs(force).max()
    assert other.counters["rejected_steps"] == one.counters["rejected_steps"]
    assert len(other.notes) == len(one.notes)


@pytest.mark.parametrize("s", (1.0, *SIZES))
def test_the_first_row_has_the_kinetic_energy_of_the_start(s: float) -> None:
    """Two bodies at 0.3 m/s, already in touch: what pressure takes of their speed belongs to the steps."""
    found = history("at touch", s)
    moving = [roller(s, 0.04, 0.018).mass, 5.0 * s**3]
    assert found.energy["kinetic"][0] == pytest.approx(0.5 * sum(moving) * 0.3**2, rel=1e-12)
