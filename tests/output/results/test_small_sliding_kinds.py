"""Small-sliding contacts within one body, on the ground, and in motion: what results make of each."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from small_sliding_runs import FRICTION, PRESSED, SIZE, block

import warpffrf as wf
from warpffrf import forces, joints, mesh, surfaces
from warpffrf.model.files.object_arrays import from_arrays, to_arrays
from warpffrf.output.bodies.normal_loads import SmallSlidingLoads, left_out
from warpffrf.output.recording.recorder import record
from warpffrf.output.result import Result

SLOT = 1e-5  # m, between the prongs of a fork
PUSHED = 0.4 * FRICTION * PRESSED  # N, along y


def fork() -> wf.Scene:
    """Two prongs that lie on each other, held and loaded outside; the interference closes the slot."""
    filled = np.ones((6, 2, 3), dtype=bool)
    filled[1:, :, 1] = False
    lines = np.linspace(0.0, SIZE[0], 7), np.linspace(0.0, SIZE[1], 3), [0.0, 0.004, 0.004 + SLOT, 0.008]
    shape = mesh.grid(*lines, filled=filled, order=1, name="fork")
    for name, z, normal in (("lower", 0.004, 1), ("upper", 0.004 + SLOT, -1)):
        shape = shape.select_plane(name, point=(0, 0, z), normal=(0, 0, normal), tolerance=0.1 * SLOT)
    steel = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7800.0)
    body = wf.reduce(
        shape,
        steel,
        interfaces={"z_min": "rigid", "z_max": "average"},
        contact={"slot": wf.surfaces.Matched("lower", first="upper")},
        modes=6,
        cache=False,
        progress=False,
    )
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    both = scene.add_body(body, name="fork")
    scene.add(joints.Fixed(scene.ground, both["z_min"]))
    scene.add(wf.Contact(both["slot"], sliding=wf.SmallSliding(interference=SLOT), friction=FRICTION, name="slot"))
    scene.add(forces.PointForce(both["z_max"], (0.0, PUSHED, -PRESSED)))
    return scene


def on_the_floor() -> wf.Scene:
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    floor = scene.ground.surface(surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    body = scene.add_body(block("block", "z_max", "z_min", (4, 2)), name="block", position=(0.0, 0.0, 0.01))
    scene.add(wf.Contact(body["face"], floor, sliding="small", friction=FRICTION, name="foot"))
    scene.add(forces.PointForce(body["z_max"], (0.0, PUSHED, -PRESSED)))
    return scene


@pytest.mark.parametrize("build", [fork, on_the_floor])
def test_an_equilibrium_comes_back_from_its_file(build: object, tmp_path: Path) -> None:
    scene = fork() if build is fork else on_the_floor()
    found = wf.equilibrium(scene)
    (name,) = found.small_sliding_names
    lap = found.contact(name)
    again = Result.load(found.save(tmp_path / "run.h5"))
    np.testing.assert_array_equal(again.contact(name).pressure, lap.pressure)
    np.testing.assert_array_equal(again.contact(name).polygons[1], lap.polygons[1])
    assert again.contact(name).view.second_body.name == ("fork" if build is fork else "ground")
    np.testing.assert_allclose(lap.area.sum(), SIZE[1] * SIZE[0] * (5 / 6 if build is fork else 1), rtol=1e-9)
    assert f"contact '{name}': normal force" in again.report() and len(again.small_sliding_page().axes) >= 3
    assert record(again, tmp_path / "run.rrd").frames == 1
    assert from_arrays(*to_arrays(scene)).content_hash() == scene.content_hash()
    if build is on_the_floor:
        np.testing.assert_allclose(lap.force[0], [0.0, -PUSHED, PRESSED], atol=1e-6 * PRESSED)


def test_what_slid_before_the_first_row_is_in_the_zone() -> None:
    """The equilibrium that a run starts from may have slipped already."""
    lap = wf.equilibrium(on_the_floor()).contact("foot")
    assert lap.loss[0] > 0.0 and lap.slip_zone().cells > 0 and lap.slip_zone(0.0).cells == 0


def test_the_budget_of_a_motion_includes_small_sliding() -> None:
    """A block that is let go on the floor: errors of force and loss by the step."""
    result = wf.simulate(on_the_floor(), 4e-4, step=2e-5, progress=False)
    told = {line.of for line in result.error_budget()}
    assert "force of contact 'foot'" in told and "loss of contact 'foot'" in told
    lap = result.contact("foot")
    np.testing.assert_allclose(lap.loss, -result.energy["friction"], rtol=1e-9, atol=1e-15)


# --- what the skin of a fork shows


def test_both_prongs_have_the_pressure_and_opposite_tractions() -> None:
    """On the nodes of the slot, side by side as the meshes match; forces on the body's small-sliding contacts are
    those of cells."""
    found = wf.equilibrium(fork())
    lap, skin = found.contact("slot"), found.skins()["fork"]
    pressure, traction = skin.pressure(0), skin.traction(0)
    inside = skin.points[:, 0] > SIZE[0] / 6 * 1.001
    sides = [np.flatnonzero(inside & (np.abs(skin.points[:, 2] - z) < 0.1 * SLOT)) for z in (0.004, 0.004 + SLOT)]
    order = [nodes[np.lexsort(np.round(skin.points[nodes, :2].T, 9))] for nodes in sides]
    assert len(order[0]) == len(order[1]) == 15 and pressure[order[0]].max() > 0.5 * lap.pressure.max()
    np.testing.assert_allclose(pressure[order[0]], pressure[order[1]], rtol=1e-9)
    np.testing.assert_allclose(traction[order[0]], -traction[order[1]], rtol=1e-9)
    assert np.all(np.delete(pressure, np.concatenate(sides)) <= pressure.max())
    far = np.abs(skin.points[:, 2] - 0.004 - 0.5 * SLOT) > SLOT
    assert not np.any(pressure[far]) and not np.any(skin.state(0)[far])
    own = SmallSlidingLoads(found.history, found.view, "fork").forces(0)
    assert own is not None
    np.testing.assert_allclose(own[::3], lap.pressure[0] * lap.area, rtol=1e-12)


def test_a_skin_without_the_responses_of_its_laps_says_so(tmp_path: Path) -> None:
    found = wf.equilibrium(on_the_floor())
    body = found.view.bodies["block"]
    assert not left_out([body])
    bare = replace(body, reduced=replace(body.reduced, surface=replace(body.reduced.surface, matched=None)))
    lap = replace(found.view.small_sliding["foot"], first_body=bare)
    view = replace(found.view, bodies={"block": bare}, small_sliding={"foot": lap})
    poor = Result(replace(found.history, scene=view))
    modes = np.tensordot(poor.body("block").modal[0], body.reduced.surface.modes, 1)
    np.testing.assert_allclose(poor.skins()["block"].displacement(0), modes, atol=1e-6 * np.abs(modes).max())
    assert np.abs(found.skins()["block"].displacement(0) - modes).max() > 0.1 * np.abs(modes).max()
    assert "the skin of 'block' moves by its modes alone" in poor.report()
    assert left_out([bare])[0] in record(poor, tmp_path / "run.rrd", color="pressure").notes
