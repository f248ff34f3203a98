"""Bodies that nothing leads to the ground from are at rest where their loads balance, and report what is left over
where they do not."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model import forces, joints, signals
from warpffrf.model.scene import Scene
from warpffrf.online import find_equilibrium
from warpffrf.online.load_steps import run_static

CUBE = (0.01,) * 3  # kg m2
LOAD, STIFFNESS = 1e3, 1e6  # N, N/m
ALONG = np.array([2.0, -1.0, 2.0]) / 3.0  # an oblique line
ROUND_OFF = 1e-9  # of displacements of 1 mm: Newton's method ends at 1e-9 of the load


def sprung(back: float = LOAD) -> Scene:
    """Two bodies of 1 and 2 kg that a spring holds together, pulled apart."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    a = scene.add_rigid_body(1.0, CUBE, name="a")
    b = scene.add_rigid_body(2.0, CUBE, name="b", position=tuple(0.1 * ALONG))
    scene.add(forces.SpringDamper(a.at((0, 0, 0)), b.at((0, 0, 0)), STIFFNESS))
    scene.add(forces.PointForce(a.at((0, 0, 0)), tuple(-back * ALONG)))
    scene.add(forces.PointForce(b.at((0, 0, 0)), tuple(LOAD * ALONG)))
    return scene


@pytest.mark.parametrize("friction", [False, True])
def test_bodies_pulled_apart_keep_their_centre_of_mass(friction: bool) -> None:
    found = find_equilibrium(sprung(), friction=friction)
    assert found.status == "completed", found.message
    longer = LOAD / STIFFNESS
    for name, way in (("a", -longer * 2.0 / 3.0), ("b", 0.1 + longer / 3.0)):
        np.testing.assert_allclose(found.bodies[name].position[0], way * ALONG, atol=ROUND_OFF * longer)
    assert "equilibrium: nothing leads to the ground from 'a', 'b', whose loads balance: left where they are" in (
        found.notes
    )


def test_a_bar_turns_into_the_line_of_its_loads() -> None:
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    bar = scene.add_rigid_body(1.0, CUBE, name="bar")
    scene.add(forces.PointForce(bar.at((-0.05, 0.0, 0.0)), (-LOAD, 0.0, 0.0)))
    scene.add(forces.PointForce(bar.at((0.05, 0.02, 0.0)), (LOAD, 0.0, 0.0)))
    found = find_equilibrium(scene)
    assert found.status == "completed", found.message
    half = -0.5 * np.arctan2(0.02, 0.1)
    np.testing.assert_allclose(found.bodies["bar"].rotation[0], [0.0, 0.0, np.sin(half), np.cos(half)], atol=1e-6)


@pytest.mark.parametrize("friction", [False, True])
def test_rollers_that_loads_press_together_carry_them(friction: bool) -> None:
    """On a guide between them: without one they would roll off each other."""
    mesh = wf.mesh.roller(0.05, 0.015, 0.02, sectors=24, layers=2, axial=2, order=1)
    roller = wf.reduce(
        mesh, wf.Material(210e9, 0.3, 7800.0), interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()},
        modes=0, cache=False, progress=False,
    )  # fmt: skip
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    pair = [scene.add_body(roller, name=name, position=(0, 0, z)) for name, z in (("lower", 0.0), ("upper", 0.1))]
    scene.add(wf.Contact(*(body["rim"] for body in pair), name="pair"))
    scene.add(joints.Prismatic(*(body["bore"] for body in pair), axis=(0, 0, 1)))
    for body, force in zip(pair, (LOAD, -LOAD), strict=True):
        scene.add(forces.PointForce(body["bore"], (0.0, 0.0, force)))
    found = find_equilibrium(scene, friction=friction)
    assert found.status == "completed", found.message
    assert np.linalg.norm(found.contacts["pair"].force[0]) == pytest.approx(LOAD, rel=1e-8)
    assert np.mean([found.bodies[b.name].position[0, 2] for b in pair]) == pytest.approx(0.05, abs=1e-12)


@pytest.mark.parametrize("friction", [False, True])
def test_loads_that_do_not_balance_are_reported_with_their_resultant(friction: bool) -> None:
    found = find_equilibrium(sprung(back=LOAD - 9.0), friction=friction)
    assert found.status == "no_equilibrium" and not len(found.time)
    assert "'a', 'b', whose loads do not balance: the resultant is (6, -3, 6) N" in found.message
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    wheel = scene.add_rigid_body(1.0, CUBE, name="wheel")
    scene.add(forces.PointTorque(wheel.at((0, 0, 0)), (0.0, 0.0, 3.0)))
    found = find_equilibrium(scene, friction=friction)
    assert found.status == "no_equilibrium"
    assert (
        "'wheel', whose loads do not balance: the resultant is (0, 0, 3) N m about the centre of mass" in found.message
    )


@pytest.mark.parametrize("back", [LOAD, LOAD - 100.0])
def test_load_steps_go_on_as_long_as_loads_balance(back: float) -> None:
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    bar = scene.add_rigid_body(1.0, CUBE, name="bar")
    for x, force in ((0.05, LOAD), (-0.05, -back)):
        ramp = signals.Table((0.0, 0.5, 1.0), (0.0, np.sign(force) * LOAD, force))
        scene.add(forces.PointForce(bar.at((x, 0.0, 0.0)), (ramp, (1.0, 0.0, 0.0))))
    found = run_static(scene, 1.0, step=0.25, progress=False)
    if back == LOAD:
        assert found.status == "completed" and np.abs(found.bodies["bar"].position).max() < 1e-9
    else:
        assert found.status == "no_equilibrium" and found.time[-1] == 0.5
        assert "'bar', whose loads do not balance:" in found.message


def test_what_hangs_on_a_hinge_of_a_floating_body_is_named_with_it() -> None:
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    a = scene.add_rigid_body(1.0, CUBE, name="a")
    b = scene.add_rigid_body(2.0, CUBE, name="b", position=(0.1, 0.0, 0.0))
    scene.add(joints.Revolute(a.at((0.05, 0, 0)), b.at((-0.05, 0, 0)), axis=(0, 0, 1)))
    notes = [note for note in find_equilibrium(scene).notes if note.startswith("equilibrium:")]
    assert notes == [
        "equilibrium: nothing leads to the ground from 'a', 'b', whose loads balance: left where they are",
        "equilibrium: bodies 'a', 'b' are free to turn about (0, 0, 1), and left where they are",
    ]
