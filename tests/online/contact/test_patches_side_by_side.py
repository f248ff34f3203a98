"""Patches on one body, one of them hardly loaded, with and without a matrix of their pressures."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.online import History, run
from warpffrf.online.compile import pairs

STEEL = wf.Material(210e9, 0.3, 7850.0)
LOAD, IDLE = 2e4, 5.0  # N
BALANCED = 1e-8  # of the largest force: what both runs leave unbalanced, each to 1e-9 in a step


@pytest.fixture(scope="module")
def ring() -> wf.ReducedBody:
    mesh = wf.mesh.roller(0.05, 0.015, 0.02, sectors=36, layers=2, axial=2, grading=1.6, order=1)
    return wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=0,
        grid=wf.ContactGrid(contact_fixed=True), cache=False, progress=False,
    )  # fmt: skip


def thrown_back(ring: wf.ReducedBody, apart: float, law: wf.laws.Law) -> History:
    """Two rigid rollers on a held ring, `apart` [rad]: one pressed on, one lifted off and thrown back."""
    scene = wf.Scene()
    held = scene.add_body(ring, name="ring")
    scene.add(wf.joints.Fixed(scene.ground, held["bore"]))
    thrown = wf.signals.Table([0.0, 4e-5, 8e-5, 1.2e-4], [IDLE, -30.0 * IDLE, 30.0 * IDLE, IDLE], hold=True)
    for angle, load in ((0.0, LOAD), (apart, thrown)):
        out = np.array([np.sin(angle), 0.0, np.cos(angle)])
        tread = wf.surfaces.Cylinder(radius=0.02, axis_point=(0.0, 0.0, 0.0), axis_direction=(0.0, 1.0, 0.0))
        roller = scene.add_rigid_body(
            0.1, (1e-5, 1e-5, 1e-5), name=f"roller_{angle}", position=0.07 * out, surfaces={"tread": tread}
        )
        scene.add(wf.joints.Prismatic(scene.ground, roller.at((0.0, 0.0, 0.0)), axis=out))
        scene.add(wf.Contact(held["rim"], roller["tread"], cells=(9, 5), law=law))
        scene.add(wf.forces.PointForce(roller.at((0.0, 0.0, 0.0)), (load, tuple(-out))))
    return run(scene, 4e-4, step=4e-5, start="equilibrium", progress=False)


@pytest.mark.parametrize(
    ("apart", "law"),
    [(0.5, wf.laws.Unilateral()), (0.25, wf.laws.Unilateral()), (0.25, wf.laws.HuntCrossley(1e20, 1.5, 0.1))],
)
def test_pressures_need_no_matrix(
    ring: wf.ReducedBody, apart: float, law: wf.laws.Law, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Eliminated by their matrix, and iterated with products over strips; both with what patches do to each other."""
    eliminated = thrown_back(ring, apart, law)
    monkeypatch.setattr(pairs, "MATRIX_CELLS", 0)
    iterated = thrown_back(ring, apart, law)
    assert eliminated.status == iterated.status == "completed", iterated.message
    thrown = np.linalg.norm(list(iterated.contacts.values())[1].force, axis=-1)
    assert thrown[-1] > 0.0 and thrown.min() == 0.0  # it comes back as an idle pair: the weights have differed
    assert iterated.counters["rejected_steps"] == iterated.counters["impulsive_steps"] == 0  # nor is it judged
    for name in iterated.contacts:
        force = iterated.contacts[name].force - eliminated.contacts[name].force
        assert np.abs(force).max() < BALANCED * LOAD


def test_small_motions_need_no_matrix(ring: wf.ReducedBody, monkeypatch: pytest.MonkeyPatch) -> None:
    """Frequencies of a roller pressed on the ring: the local compliance of cells is found by unit pressures."""
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    held = scene.add_body(ring, name="ring")
    scene.add(wf.joints.Fixed(scene.ground, held["bore"]))
    tread = wf.surfaces.Cylinder(radius=0.02, axis_point=(0.0, 0.0, 0.0), axis_direction=(0.0, 1.0, 0.0))
    roller = scene.add_rigid_body(0.1, (1e-5,) * 3, name="roller", position=(0, 0, 0.07), surfaces={"tread": tread})
    scene.add(wf.joints.Prismatic(scene.ground, roller.at((0.0, 0.0, 0.0)), axis=(0, 0, 1)))
    scene.add(wf.Contact(held["rim"], roller["tread"], cells=(9, 5)))
    scene.add(wf.forces.PointForce(roller.at((0.0, 0.0, 0.0)), (LOAD, (0, 0, -1))))
    eliminated = wf.eigenmodes(scene, progress=False).frequencies
    monkeypatch.setattr(pairs, "MATRIX_CELLS", 0)
    np.testing.assert_allclose(wf.eigenmodes(scene, progress=False).frequencies, eliminated, rtol=BALANCED)


@pytest.mark.parametrize("idle", [5.0, 50.0])
def test_an_idle_roller_next_to_a_pressed_one_keeps_its_set_on_a_rotating_grid(idle: float) -> None:
    """Blocks between pairs of unequal weights: with symmetric ones in their place nodes of the idle patch entered and
    left the active set without end, and steps were halved."""
    mesh = wf.mesh.roller(0.05, 0.015, 0.02, sectors=720, layers=12, axial=2, grading=1.3, order=1)
    body = wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=0,
        grid=wf.ContactGrid(contact_fixed=False), cache=False, progress=False,
    )  # fmt: skip
    scene, spin = wf.Scene(gravity=(0.0, 0.0, 0.0)), 20.0
    turning = scene.add_body(body, name="ring", angular_velocity=(0.0, spin, 0.0))
    axle = scene.add(wf.joints.Revolute(scene.ground, turning["bore"], axis=(0, 1, 0)))
    scene.add(wf.joints.Drive(axle, spin, quantity="velocity"))
    for name, angle, load in (("pressed", 0.0, LOAD), ("idle", 0.25, idle)):
        out = np.array([np.sin(angle), 0.0, np.cos(angle)])
        tread = wf.surfaces.Cylinder(radius=0.02, axis_point=(0.0, 0.0, 0.0), axis_direction=(0.0, 1.0, 0.0))
        roller = scene.add_rigid_body(0.1, (1e-5,) * 3, name=name, position=0.07 * out, surfaces={"tread": tread})
        scene.add(wf.joints.Prismatic(scene.ground, roller.at((0.0, 0.0, 0.0)), axis=out))
        scene.add(wf.Contact(turning["rim"], roller["tread"]))
        scene.add(wf.forces.PointForce(roller.at((0.0, 0.0, 0.0)), (load, tuple(-out))))
    history = run(scene, 40 * 4e-5, step=4e-5, start="equilibrium", progress=False)
    assert history.status == "completed", history.message
    assert history.counters["rejected_steps"] == history.counters["impulsive_steps"] == 0
    assert history.counters["idle_steps"] > 0
