"""Rollers that carry nothing but their weight, between flexible rings whose other rollers carry tons."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf

STEEL = wf.Material(210e9, 0.3, 7850.0)
INNER, SHAFT, RADIUS, LENGTH, WALL = 0.018, 0.011, 0.0042, 0.011, 0.009  # m
OUTER = INNER + 2.0 * RADIUS
LOAD, GRAVITY = 6e3, 9.81  # N, m/s2
CARRIED = 5e-3  # of the load: raceways deform, so that rollers do not press along their radii


@pytest.mark.slow
@pytest.mark.parametrize("cells", [(9, 5), (13, 13), None])
def test_idle_rollers_find_their_rest(cells: tuple[int, int] | None) -> None:
    """Of nine, four lie above the shaft with 0.05 N each. Contacts close all at once: patches grow by a factor of 150
    in one step, on any number of strips; the iteration for pressures ends where those of idle rollers are found, too.
    """
    grid = wf.ContactGrid(contact_fixed=True)
    ring = wf.reduce(
        wf.mesh.sleeve(OUTER, OUTER + WALL, LENGTH, sectors=56, layers=3, axial=3), STEEL, modes=10, grid=grid,
        interfaces={"outside": "rigid"}, contact={"bore": wf.surfaces.Bore()}, progress=False,
    )  # fmt: skip
    shaft = wf.reduce(
        wf.mesh.roller(INNER, SHAFT, LENGTH, sectors=40, layers=2, axial=3), STEEL, modes=10, grid=grid,
        interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, progress=False,
    )  # fmt: skip
    scene = wf.Scene(gravity=(0.0, 0.0, -GRAVITY))
    housing, inner = scene.add_body(ring, name="outer"), scene.add_body(shaft, name="inner")
    scene.add(wf.joints.Fixed(scene.ground, housing["outside"]))
    bearing = scene.add_bearing(
        "b",
        wf.bearings.RollerGeometry(
            elements=9, roller_diameter=2.0 * RADIUS, roller_length=LENGTH, pitch_diameter=INNER + OUTER
        ),
        first=(0, 0, -1), inner=inner["rim"], outer=housing["bore"],
        cage=wf.bearings.PrescribedCage(speed=0.0), materials=wf.bearings.Materials(STEEL),
    )  # fmt: skip
    for contact in bearing.contacts.values():
        assert isinstance(contact, wf.Contact)
        contact.cells = cells
    hub = scene.add_rigid_body(0.5, (1e-3,) * 3, name="hub")
    scene.add(wf.joints.Prismatic(scene.ground, hub.at((0, 0, 0)), axis=(0, 0, 1)))
    scene.add(wf.joints.Fixed(hub.at((0, 0, 0)), inner["bore"]))
    scene.add(wf.forces.PointForce(hub.at((0, 0, 0)), (0.0, 0.0, -LOAD)))
    rest = wf.equilibrium(scene, progress=False)
    assert rest.status == "completed", rest.message
    forces = {name: contact.force[-1] for name, contact in rest.history.contacts.items()}
    weight = bearing.elements[0].mass * GRAVITY
    for k in (4, 5, 6, 7):
        pressed = np.linalg.norm([forces[f"b inner {k}"], forces[f"b outer {k}"]], axis=1)
        assert 0.0 < pressed.max() < 3.0 * weight
    down = -LOAD - GRAVITY * (0.5 + inner.mass + 9.0 * weight / GRAVITY)
    carried = sum(force[2] for name, force in forces.items() if " outer " in name)
    assert abs(carried / down) == pytest.approx(1.0, rel=CARRIED)
