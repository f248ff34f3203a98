"""A patch that carries less than a hundredth of the largest load: its friction acts on one cell, in full."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.online import History, run

STEEL = wf.Material(210e9, 0.3, 7850.0)
RADIUS, TREAD, WIDTH = 0.05, 0.02, 0.02  # m
HEAVY, LIGHT = 2e4, 100.0  # N
MU, SPEED, INERTIA = 0.1, 20.0, 1e-5  # of the ring [rad/s]; of a roller [kg m2]
STEP = 4e-5  # s: the light patch advances by less than its length
UNIFORM = 2e-3  # load that shaking of the ring by the other roller adds
ROLLING = 5e-3  # creepage of the two bodies' deformation is below


@pytest.fixture(scope="module")
def ring() -> wf.ReducedBody:
    mesh = wf.mesh.roller(RADIUS, 0.015, WIDTH, sectors=36, layers=2, axial=2, grading=1.6, order=1)
    return wf.reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=0,
        grid=wf.ContactGrid(contact_fixed=True, tangential=True), cache=False, progress=False,
    )  # fmt: skip


def spun_up(ring: wf.ReducedBody, duration: float) -> History:
    """A turning ring, a heavy roller that rolls with it, and a light one that it spins up from rest."""
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    turning = scene.add_body(ring, name="ring", angular_velocity=(0.0, SPEED, 0.0))
    axle = scene.add(wf.joints.Revolute(scene.ground, turning["bore"], axis=(0, 1, 0)))
    scene.add(wf.joints.Drive(axle, SPEED, quantity="velocity"))
    here = (0.0, 0.0, 0.0)
    tread = wf.surfaces.Cylinder(radius=TREAD, axis_point=here, axis_direction=(0.0, 1.0, 0.0))
    for name, way, load, spin in (("heavy", 1.0, HEAVY, -SPEED * RADIUS / TREAD), ("light", -1.0, LIGHT, 0.0)):
        at = (0.0, 0.0, way * (RADIUS + TREAD))
        carriage = scene.add_rigid_body(0.1, (INERTIA,) * 3, name=f"{name} carriage", position=at)
        roller = scene.add_rigid_body(
            0.1, (INERTIA,) * 3, name=name, position=at, angular_velocity=(0.0, spin, 0.0), surfaces={"tread": tread}
        )
        scene.add(wf.joints.Prismatic(scene.ground, carriage.at(here), axis=(0, 0, 1)))
        scene.add(wf.joints.Revolute(carriage.at(here), roller.at(here), axis=(0, 1, 0)))
        scene.add(wf.Contact(turning["rim"], roller["tread"], friction=MU, cells=(9, 5), name=f"on {name}"))
        scene.add(wf.forces.PointForce(carriage.at(here), (load, (0.0, 0.0, -way))))
    return run(scene, duration, step=STEP, start="equilibrium", progress=False)


def test_a_light_roller_is_spun_up_by_its_whole_friction_and_then_rolls(ring: wf.ReducedBody) -> None:
    rate = MU * LIGHT * TREAD / INERTIA  # rad/s2
    rolls_at = SPEED * RADIUS / TREAD / rate
    history = spun_up(ring, 1.2 * rolls_at)
    assert history.status == "completed", history.message
    spin = history.bodies["light"].angular_velocity[:, 1]
    slides = history.time < 0.9 * rolls_at
    assert np.abs(spin + rate * history.time)[slides].max() < UNIFORM * rate * rolls_at
    assert abs(spin[-1] + SPEED * RADIUS / TREAD) < ROLLING * SPEED * RADIUS / TREAD
    told = [note for note in history.notes if "acts on one of its cells" in note]
    assert len(told) == 1 and told[0].startswith("contact 'on light': in 100% of the saved rows")
