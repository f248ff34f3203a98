"""Light bodies that carry heavy ones: right as far as double precision goes, and named beyond."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.model import joints
from warpffrf.model import rotation as rot
from warpffrf.model.scene import Scene
from warpffrf.online import Engine, run
from warpffrf.online.diagnosis.motion_notes import hidden_inertia
from warpffrf.online.start.consistent import start_consistently

LENGTH, ANGLE, HEAVY = 0.5, 0.8, 1e3  # m, rad, kg


def pendulum(mass: float, inertia: float, skew: float = 0.0) -> Scene:
    """A light link that hangs from the ground and carries a rod of 1 t; `skew` [rad] turns the light body's own axes
    against the link."""
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    down, half = np.array([np.sin(ANGLE), 0.0, -np.cos(ANGLE)]), 0.5 * LENGTH
    turn = rot.rotation_vector_matrix(np.array([0.0, -ANGLE, 0.0]))
    own = rot.rotation_vector_matrix(np.array([0.0, skew, 0.0]))
    light = scene.add_rigid_body(
        mass, (inertia,) * 3, name="light", position=half * down, rotation=rot.quaternion(turn @ own)
    )
    heavy = scene.add_rigid_body(
        HEAVY, (HEAVY * LENGTH**2 / 12.0,) * 3, name="heavy", position=3.0 * half * down, rotation=rot.quaternion(turn)
    )
    up, low = (own.T @ np.array([0.0, 0.0, z]) for z in (half, -half))
    scene.add(joints.Revolute(scene.ground, light.at(tuple(up)), axis=(0, -1, 0), name="upper"))
    scene.add(joints.Revolute(light.at(tuple(low)), heavy.at((0, 0, half)), axis=(0, -1, 0), name="lower"))
    return scene


@pytest.mark.parametrize("skew", [0.0, 0.5])
@pytest.mark.parametrize(("mass", "inertia"), [(1e-3, 1e-10), (1e-3, 1e-15), (1e-9, 1e-15)])
def test_next_to_no_inertia_is_no_fault(mass: float, inertia: float, skew: float) -> None:
    """Up to 1e16 between the two bodies: as with a link whose inertia is a 3e-7th of the rod's."""
    heavier, found = (run(scene, 0.3, step=1e-3, progress=False) for scene in (
        pendulum(1e-3, 2e-5), pendulum(mass, inertia, skew)
    ))  # fmt: skip
    assert found.status == "completed" and not found.counters["dense_fallbacks"]
    off = found.bodies["heavy"].position - heavier.bodies["heavy"].position
    assert np.abs(off).max() < 1e-6 * LENGTH


def test_what_round_off_hides_is_named() -> None:
    history = run(pendulum(1e-12, 1e-18), 0.1, step=1e-3, progress=False)
    assert history.status == "singular"
    assert (
        "body 'light' is too light for a joint with body 'heavy'" in history.message
        and "redundant" not in history.message
    )


def test_other_singular_systems_are_not_blamed_on_masses() -> None:
    """Masses near each other; and rows that depend on each other, whatever the masses."""
    near, far = (Engine(pendulum(*light)) for light in ((10.0, 0.2), (1e-12, 1e-18)))
    for engine in (near, far):
        start_consistently(engine)
    assert hidden_inertia(near) == "" and "too light" in hidden_inertia(far)
    C = far.scratch.C.numpy().copy()
    C[0, 1] = C[0, 0]
    far.scratch.C.assign(C)
    assert hidden_inertia(far) == ""
