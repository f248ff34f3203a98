"""Rows of the local compliance of patches that stand from step to step: they change the way, not where it leads."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.online import run
from warpffrf.online.checkpoint import restore
from warpffrf.online.compile.patches import tables as patches
from warpffrf.online.engine import Engine
from warpffrf_kernels.normal.compliance_reuse import AGE

RADIUS, STEP, STEPS = 0.05, 1e-4, 60
SPEED = 40.0  # rad/s: the patch travels over an element of 8 mm in 40 steps
NAME = "lower-upper"
# Of force and pressure. Both ways end below 1e-9 of the force and of the gaps (`Settings.residual_tolerance`), each
# step; pressures answer to a gap that is left open by a few times its fraction of the penetration.
SAME = 1e-7
# With seven strips the patch reaches the outermost ones on the way to some solutions, where W grows; so cells differ a
# little (of W 3e-5 measured), and the force by what cells of another width change. Their own error is 1e-2.
OTHER_CELLS = 1e-4


@pytest.fixture(scope="module")
def roller() -> wf.ReducedBody:
    mesh = wf.mesh.roller(RADIUS, 0.015, 0.02, sectors=40, layers=4, axial=3, order=1)
    return wf.reduce(
        mesh, wf.Material(210e9, 0.3, 7800.0), interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()},
        max_frequency=12e3, grid=wf.ContactGrid(contact_fixed=True), cache=False, progress=False,
    )  # fmt: skip


def scene_of(roller: wf.ReducedBody, cells: tuple[int, int]) -> wf.Scene:
    """Two rollers that are driven to roll on each other, the upper one pressed down by a force that grows by a half."""
    scene = wf.Scene(gravity=(0, 0, 0))
    lower = scene.add_body(roller, name="lower")
    upper = scene.add_body(roller, name="upper", position=(0, 0, 2 * RADIUS))
    contact = scene.add(wf.Contact(lower["rim"], upper["rim"], name=NAME, grid="contact_fixed", cells=cells))
    scene.close_gap(contact)
    slide = scene.add_rigid_body(5.0, (0.01,) * 3, name="slide", position=upper["bore"].world_point())
    center = slide.at((0, 0, 0))
    guide = scene.add(wf.joints.Prismatic(scene.ground, center, axis=(0, 0, 1)))
    scene.add(wf.forces.JointSpringDamper(guide, 1e6, 2e3))
    for first, placed, sense in ((scene.ground, lower, 1.0), (center, upper, -1.0)):
        axle = scene.add(wf.joints.Revolute(first, placed["bore"], axis=(0, 1, 0)))
        spin = wf.signals.SmoothStep(0.0, sense * SPEED, duration=20 * STEP)
        scene.add(wf.joints.Drive(axle, spin, quantity="velocity"))
    press = wf.signals.SmoothStep(10e3, 15e3, duration=20 * STEP, delay=20 * STEP)
    scene.add(wf.forces.PointForce(center, (press, (0, 0, -1))))
    return scene


def rolled(scene: wf.Scene, start: object = "equilibrium", steps: int = STEPS) -> wf.online.History:
    """A run of so many steps."""
    history = run(scene, steps * STEP, step=STEP, start=start, progress=False)  # pyright: ignore[reportArgumentType]
    assert history.status == "completed", history.message
    return history


@pytest.mark.parametrize(("cells", "same"), [((9, 9), SAME), ((7, 7), OTHER_CELLS)], ids=["steady", "flickering edge"])
def test_they_lead_to_the_same_forces(roller, cells, same: float, monkeypatch: pytest.MonkeyPatch) -> None:
    lasting = rolled(scene_of(roller, cells)).contacts[NAME]
    monkeypatch.setattr(patches, "_rows_stand", lambda collector, model: False)
    anew = rolled(scene_of(roller, cells)).contacts[NAME]
    force = np.linalg.norm(anew.force, axis=1).max()
    assert np.abs(lasting.force - anew.force).max() < same * force
    if same == SAME:  # on the same cells
        assert np.abs(lasting.pressure - anew.pressure).max() < SAME * anew.pressure.max()


def test_they_stand_while_the_patch_rolls(roller) -> None:
    """At the end of the run, twenty steps behind the load step, the rows are older than that, and the steps have not
    taken more solves for it."""
    scene = scene_of(roller, (9, 9))
    first = rolled(scene, steps=STEPS)
    engine = Engine(scene)
    done = restore(engine, first.checkpoint, STEP)
    engine.control(target=done + 20)
    engine.replay(40)
    assert engine.word("step")[0] == done + 20
    assert engine.scratch.lasting.numpy()[0, AGE] >= 20
    assert first.iterations[1:].mean() < 2.5


def test_a_run_goes_on_bit_for_bit(roller) -> None:
    """In the middle of the load step, with rows of an earlier one and pressures that are extrapolated."""
    scene = scene_of(roller, (9, 9))
    whole = rolled(scene)
    half = rolled(scene, steps=30)
    assert half.checkpoint["kept_lasting"][0, 0] == 1
    rest = rolled(scene, start=half, steps=STEPS - 30)
    for key in ("force", "pressure"):
        assert np.array_equal(getattr(whole.contacts[NAME], key)[31:], getattr(rest.contacts[NAME], key)), key


def test_a_checkpoint_without_them_goes_on_to_the_tolerance(roller) -> None:
    scene = scene_of(roller, (9, 9))
    whole = rolled(scene)
    half = rolled(scene, steps=30)
    half.checkpoint = {name: a for name, a in half.checkpoint.items() if not name.startswith("kept_")}
    rest = rolled(scene, start=half, steps=STEPS - 30)
    assert any("not bit for bit" in note for note in rest.notes)
    force = np.linalg.norm(whole.contacts[NAME].force, axis=1).max()
    assert np.abs(whole.contacts[NAME].force[31:] - rest.contacts[NAME].force).max() < SAME * force


def test_scenes_with_layers_or_nodes_make_them_anew(roller) -> None:
    scene = scene_of(roller, (9, 9))
    assert Engine(scene).compiled.elements.patches.lasting == 1
    scene.contacts[0].law = wf.laws.HuntCrossley(1e20, 1.5, 0.1)
    assert Engine(scene).compiled.elements.patches.lasting == 0
    scene.contacts[0].law = wf.laws.Unilateral()
    scene.contacts[0].grid = "body_fixed"
    assert Engine(scene).compiled.elements.patches.lasting == 0
