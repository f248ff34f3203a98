"""A roller between a rigid inner ring and a flexible outer one: nothing stops it along its axis, and it stays there.

Off the middle of the outer ring by y, the load Q on its two lines is a couple Q y, which tilts the roller by phi. The
outer line leans with it, and presses it outwards by Q phi along its axis. The state is unstable, and the force a real
one, next to nothing compared with Q.
"""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf import mesh, offline
from warpffrf.model import forces, joints, laws, surfaces
from warpffrf.model.bearings import RollerGeometry, RollingContact
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import History, find_equilibrium
from warpffrf.output.bearings.stiffness import bearing_stiffness

STEEL = Material(206e9, 0.3, 7850.0)
D, LENGTH, PITCH, WALL = 0.01, 9.6e-3, 0.034, 8e-3  # m
BORE = 0.5 * (PITCH + D)
LOAD = 500.0  # N, on one of three rollers
OFF = 2e-6  # m
STAYS = 0.1 * OFF  # it is followed at first


@pytest.fixture(scope="module")
def ring() -> ReducedBody:
    sleeve = mesh.sleeve(BORE, BORE + WALL, 8e-3, sectors=24, axial=2, layers=1)
    return offline.reduce(
        sleeve, STEEL, interfaces={"outside": "rigid"}, contact={"bore": surfaces.Bore()}, modes=4, cache=False,
        progress=False,
    )  # fmt: skip


def loaded(ring: ReducedBody, off: float, *, held: bool = True) -> Scene:
    scene = Scene()
    outer = scene.add_body(ring, name="outer")
    if held:
        scene.add(joints.Fixed(scene.ground, outer["outside"], name="housing"))
    bearing = scene.add_bearing(
        "r", RollerGeometry(elements=3, roller_diameter=D, roller_length=LENGTH, pitch_diameter=PITCH),
        first=(0, 0, -1), outer=outer["bore"], contact=RollingContact(law=laws.PalmgrenLine(LENGTH, 3)),
        materials=STEEL,
    )  # fmt: skip
    bearing.elements[0].position = bearing.elements[0].position + np.array([0.0, off, 0.0])
    inner = bearing.inner.at((0, 0, 0))
    scene.add(joints.Prismatic(scene.ground.at((0, 0, 0)), inner, axis=(0, 0, 1), name="guide"))
    scene.add(forces.PointForce(inner, (0, 0, -LOAD), name="load"))
    return scene


def at_rest(ring: ReducedBody, off: float) -> History:
    return find_equilibrium(loaded(ring, off))


def test_rollers_off_the_middle_stay_and_are_named_with_what_drives_them(ring: ReducedBody) -> None:
    middle, off = at_rest(ring, 0.0), at_rest(ring, OFF)
    for found in (middle, off):
        assert found.status == "completed", found.message
        assert np.linalg.norm(found.contacts["r outer 1"].force[0]) == pytest.approx(LOAD, rel=1e-6)
    roller = off.bodies["r roller 1"]
    assert roller.position[0, 1] == pytest.approx(OFF, abs=STAYS)
    drive = -off.contacts["r outer 1"].force[0, 1]
    assert drive == pytest.approx(LOAD * abs(2.0 * roller.rotation[0, 0]), rel=1e-3)  # the tilt about x
    assert any("rollers are rigid, 'outer' flexible" in note and "1.4 times" in note for note in middle.notes)
    note = next(note for note in off.notes if "free to slide along" in note)
    assert "'r roller 1'" in note and f"although {drive:.2g} N drive 'r roller 1'" in note


def test_rollers_press_on_their_length_of_a_wider_ring() -> None:
    """A line of 9.6 mm on a ring of 20 mm carries the load; of the ring beyond the rollers nothing does."""
    sleeve = mesh.sleeve(BORE, BORE + WALL, 0.02, sectors=24, axial=10, layers=1)
    wide = offline.reduce(
        sleeve, STEEL, interfaces={"outside": "rigid"}, contact={"bore": surfaces.Bore()}, modes=2, cache=False,
        grid=offline.ContactGrid(contact_fixed=True), progress=False,
    )  # fmt: skip
    for grid in ("contact_fixed", "body_fixed"):
        scene = loaded(wide, 0.0)
        scene.contact("r outer 1").grid = grid
        found = find_equilibrium(scene).contacts["r outer 1"]
        z = found.cells.z[-1] if found.cells is not None else np.asarray(wide.contact_surfaces["bore"].grid.z)
        under = found.pressure[-1].max(axis=0) > 0.0
        assert np.abs(z[under]).max() <= 0.5 * LENGTH and z[under].min() == pytest.approx(-z[under].max(), abs=1e-9)
        assert np.ptp(z[under]) > (0.9 if found.cells is not None else 0.6) * LENGTH  # nodes of the ring: 1 mm apart
        assert np.linalg.norm(found.force[-1]) == pytest.approx(LOAD, rel=1e-6)


def test_the_stiffness_of_a_bearing_wants_its_flexible_ring_held(ring: ReducedBody) -> None:
    history = at_rest(ring, 0.0)
    with pytest.raises(InputError, match="the flexible ring 'outer' is held by no joint between one of its interfaces"):
        bearing_stiffness(loaded(ring, 0.0, held=False), "r", history)
