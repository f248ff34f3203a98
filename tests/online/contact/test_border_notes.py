"""Notes on patches that reach the end of the first or the second surface."""

from __future__ import annotations

import re

import numpy as np
import pytest

import warpffrf as wf
from scenes.rollers import STEEL, StaticPath, roller_body
from warpffrf.model import surfaces
from warpffrf.model.mesh import box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online import Settings
from warpffrf.online.diagnosis.border_notes import BORDER, border_notes
from warpffrf.online.history.history import ContactHistory

ROW = re.compile(r"the end of (\S+), whose last (row|column) had (\d+)% of the largest pressure")


@pytest.fixture(scope="module")
def straight() -> ReducedBody:
    return roller_body(180, layers=4, axial=8, grading=1.6, modes=0, cache=False)


@pytest.fixture(scope="module")
def crowned() -> ReducedBody:
    return roller_body(180, layers=4, axial=8, grading=1.6, crown_radius=0.5, modes=0, cache=False)


@pytest.fixture(scope="module")
def slab() -> ReducedBody:
    mesh = box((0.02, 0.02, 0.008), (10, 10, 3), center=(0.0, 0.0, -0.004), order=1)
    top = surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0), direction=(0.0, 1.0, 0.0))
    return wf.reduce(
        mesh, STEEL, interfaces={"z_min": "rigid"}, contact={"z_max": top}, modes=0, cache=False, progress=False
    )


def stacked(first, second, *, along: float = 0.0, tilt: float = 0.0, depth: float = 1e-4) -> wf.Scene:
    """`second` above `first`, shifted `along` the axes [m], its axis tilted [rad], pressed by `depth` [m]."""
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    lower = scene.add_body(first, name="lower")
    rotation = (np.sin(0.5 * tilt), 0.0, 0.0, np.cos(0.5 * tilt))
    upper = scene.add_body(second, name="upper", position=(0.0, along, 0.1), rotation=rotation)
    contact = wf.Contact(lower["rim"], upper["rim"], name="pair", overlap=1.0)
    scene.add(contact)
    scene.close_gap(contact, along=(0.0, 0.0, 1.0), gap=-depth)
    for body in (lower, upper):
        scene.add(wf.joints.Fixed(scene.ground, body["bore"]))
    return scene


def solved(scene: wf.Scene) -> tuple[ContactHistory, list[str]]:
    history = StaticPath(scene, settings=Settings(window_strain=0.3)).solve(1)
    assert history.status == "completed", history.message
    return history.contacts["pair"], border_notes(scene.contacts[0], history.contacts["pair"], history.time)


def told(notes: list[str]) -> dict[tuple[str, str], float]:
    """Per cent of the largest pressure that is named, by surface and direction."""
    found = [ROW.search(note) for note in notes]
    return {(m.group(1), m.group(2)): float(m.group(3)) for m in found if m is not None}


def test_straight_rollers_flush_or_offset_meet_over_their_common_width_by_design(straight) -> None:
    for along in (0.0, 0.0051, -0.0051):
        found, notes = solved(stacked(straight, straight, along=along))
        assert np.count_nonzero(found.pressure[0].max(axis=0)) >= 6
        assert notes == []


def test_a_tilted_roller_that_sits_on_its_end_is_named(straight) -> None:
    """As much as the first grid's last row has, at the saved time."""
    found, notes = solved(stacked(straight, straight, tilt=8e-3))
    by_row = found.pressure[0].max(axis=0)
    assert (by_row[0] > 0.0) != (by_row[-1] > 0.0)
    assert told(notes)["lower['rim']", "row"] == pytest.approx(
        100.0 * max(by_row[0], by_row[-1]) / by_row.max(), abs=0.5
    )
    assert "at 0 s" in notes[0]


def test_a_crowned_roller_over_the_end_of_the_second_is_named(crowned, straight) -> None:
    """The crown's middle stands 2 mm inside the end of the second; that of the first is far away. Reversed, it is
    the first one's end."""
    found, notes = solved(stacked(crowned, straight, along=0.008))
    assert found.pressure[0, :, [0, -1]].max() == 0.0
    assert list(told(notes)) == [("upper['rim']", "row")] and len(notes) == 1
    found, notes = solved(stacked(straight, crowned, along=0.008))
    assert list(told(notes)) == [("lower['rim']", "row")] and len(notes) == 1
    by_row = found.pressure[0].max(axis=0)
    assert told(notes)["lower['rim']", "row"] == pytest.approx(100.0 * by_row[-1] / by_row.max(), abs=0.5)
    assert by_row[-1] > BORDER * by_row.max()


def test_a_crown_in_the_middle_is_not_named(crowned, straight) -> None:
    found, notes = solved(stacked(crowned, straight))
    assert found.pressure[0].max() > 0.0 and notes == []


@pytest.mark.parametrize(("x", "named"), [(0.0, []), (0.0095, [("slab['z_max']", "column")])])
def test_a_roller_over_the_edge_of_a_plane_is_named(crowned, slab, x: float, named: list) -> None:
    """Columns of a plane stand along x here; the roller's first grid goes on all around."""
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    turning = scene.add_body(crowned, name="roller", position=(x, 0.0, 0.05 - 5e-5))
    block = scene.add_body(slab, name="slab")
    scene.add(wf.Contact(turning["rim"], block["z_max"], name="pair", overlap=1.0))
    scene.add(wf.joints.Fixed(scene.ground, turning["bore"]))
    scene.add(wf.joints.Fixed(scene.ground, block["z_min"]))
    found, notes = solved(scene)
    assert found.pressure[0].max() > 0.0
    assert list(told(notes)) == named and len(notes) == len(named)


def test_a_run_says_it(straight) -> None:
    scene = stacked(straight, straight, tilt=8e-3)
    result = wf.simulate(scene, 1e-4, step=1e-4, progress=False)
    assert "reaches the end of lower['rim']" in "\n".join(result.history.notes)
