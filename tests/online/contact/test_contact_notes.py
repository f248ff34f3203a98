"""What a run says of contacts that are not to be trusted."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from scenes.rollers import StaticPath, guided_pair, roller_body
from warpffrf.model.errors import InputError
from warpffrf.online import Settings
from warpffrf.online.compile import pairs
from warpffrf.online.diagnosis.contact_notes import MOST_SKEW, angle_between_axes, energy_notes

SECOND_MOMENT = 2.0 / 4**2  # nodes on n = 4 cells take z^2, W^2/12 in the mean, too large by W^2/(6 n^2)


@pytest.fixture(scope="module")
def coarse() -> wf.ReducedBody:
    return roller_body(60, layers=2, axial=2, grading=1.6, modes=0, cache=False)


def notes_of(scene: wf.Scene, **options) -> str:
    result = wf.simulate(scene, 1e-4, step=1e-4, progress=False, **options)
    return "\n".join(result.history.notes)


def test_a_patch_of_two_columns_is_named(coarse) -> None:
    assert "columns of the grid wide" in notes_of(guided_pair(coarse, coarse, load=2e3), start="equilibrium")


def test_nodes_over_the_end_of_a_narrower_surface_are_named(coarse) -> None:
    """Three rows of nodes over 20 mm against a roller of 11 mm: the middle nodes hang over its ends."""
    narrow = roller_body(60, layers=2, axial=2, grading=1.6, width=0.011, modes=0, cache=False)
    assert "extend beyond the end" in notes_of(guided_pair(coarse, narrow, load=2e4), start="equilibrium")
    assert "extend beyond the end" not in notes_of(guided_pair(narrow, coarse, load=2e4), start="equilibrium")


def test_an_overlap_at_the_start_is_named(coarse) -> None:
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    a = scene.add_body(coarse, name="a")
    b = scene.add_body(coarse, name="b", position=(0.0, 0.0, 0.1 - 2e-5))
    scene.add(wf.Contact(a["rim"], b["rim"]))
    said = notes_of(scene)
    assert "overlap of 2e-05 m" in said and "close_gap" in said


def test_energy_from_nowhere_and_energy_that_is_lost_are_named() -> None:
    rows = {name: np.zeros(4) for name in ("kinetic", "strain", "contact", "numerical", "contact_grid")}
    rows["kinetic"] += 1.0
    assert energy_notes(rows, 0.0) == []
    rows["numerical"] = np.array([0.0, -0.005, 0.015, 0.0])  # falls, then rises by two per cent
    gained, taken = energy_notes(rows, 0.0)
    assert "gained 0.02 J" in gained and "dissipated 0.015 J" in taken
    assert energy_notes(rows, 0.1) == []
    rows["numerical"] = np.array([0.0, -0.02, -0.04, -0.5])
    assert [note.split(",")[0] for note in energy_notes(rows, 0.0)] == ["the integrator dissipated 0.5 J"]


@pytest.mark.parametrize("step, taken", [(0.05, True), (0.005, False)])  # 1.6 and 0.16 over the frequency
def test_an_oscillation_that_the_step_does_not_resolve_is_named(step: float, taken: bool) -> None:
    """Without any damper: what the integrator takes of it is no gain, and the run completes."""
    scene = wf.Scene()
    block = scene.add_rigid_body(1.0, (1.0, 1.0, 1.0), name="block")
    guide = scene.add(wf.joints.Prismatic(scene.ground, block.at((0.0, 0.0, 0.0)), axis=(0, 0, 1)))
    scene.add(wf.forces.JointSpringDamper(guide, stiffness=1e3, preload=10.0))
    result = wf.simulate(scene, 20.0, step=step, options=wf.RunOptions(save_every=7), progress=False)
    assert result.status == "completed" and result.time[-1] == pytest.approx(20.0)
    said = [note for note in result.history.notes if note.startswith("the integrator dissipated")]
    assert len(said) == taken and all("smaller step" in note for note in said)


def test_a_common_width_between_the_sampling_points_is_refused(coarse) -> None:
    """Two rollers that face each other over 1 mm, rows 10 mm apart: they would fall through each other."""
    scene = wf.Scene()
    a = scene.add_body(coarse, name="a")
    b = scene.add_body(coarse, name="b", position=(0.0, 0.019, 0.1))
    scene.add(wf.Contact(a["rim"], b["rim"]))
    with pytest.raises(InputError, match="finer rows"):
        wf.simulate(scene, 1e-4, step=1e-4, progress=False)


def turning_pair(body, angle: float) -> wf.Scene:
    """A narrow roller on another, pressed down by a soft force while its axle turns about the common normal."""
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    lower = scene.add_body(body, name="lower")
    upper = scene.add_body(body, name="upper", position=(0.0, 0.0, 0.1))
    scene.add(wf.joints.Fixed(scene.ground, lower["bore"]))
    swivel = scene.add(wf.joints.Cylindrical(scene.ground, upper["bore"], axis=(0, 0, 1), name="swivel"))
    turn = wf.signals.SmoothStep(0.0, angle, duration=2e-3)
    scene.add(wf.joints.Drive(swivel, turn, quantity="position", coordinate="rotation"))
    scene.add(wf.forces.PointForce(upper["bore"], (2e4, (0.0, 0.0, -1.0))))
    scene.add(wf.Contact(lower["rim"], upper["rim"], name="pair"))
    return scene


@pytest.fixture(scope="module")
def fine() -> wf.ReducedBody:
    return roller_body(240, layers=5, axial=4, grading=1.5, modes=0, cache=False)


@pytest.mark.parametrize(("angle", "named"), [(0.5 * MOST_SKEW, False), (1.2 * MOST_SKEW, True)])
def test_axes_that_turn_against_each_other_are_named(coarse, angle: float, named: bool) -> None:
    scene = turning_pair(coarse, angle)
    result = wf.simulate(scene, 2e-3, step=2e-4, start="equilibrium", progress=False)
    assert result.status == "completed"
    skew = angle_between_axes(scene.contacts[0], result.history)
    assert skew[-1] == pytest.approx(angle, rel=1e-3) and skew[0] == pytest.approx(0.0, abs=1e-9)  # the bore gives
    assert named == ("were skewed by up to 0.084 rad" in "\n".join(result.history.notes))


def test_up_to_the_named_skew_both_families_agree(fine, monkeypatch) -> None:
    """Same prescribed state, gaps along the line of centres and at points. The relative curvature differs by e^2/2."""
    monkeypatch.setattr(pairs, "SKEW", np.inf)
    found = []
    for points in (False, True):
        scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
        lower = scene.add_body(fine, name="lower")
        half = 0.5 * MOST_SKEW
        rotation = (0.0, 0.0, np.sin(half), np.cos(half))
        upper = scene.add_body(fine, name="upper", position=(0.0, 0.0, 0.1), rotation=rotation)
        scene.add(wf.joints.Fixed(scene.ground, lower["bore"]))
        guide = scene.add(wf.joints.Prismatic(scene.ground, upper["bore"], axis=(0, 0, 1), name="guide"))
        down = wf.signals.Table([0.0, 1.0], [-1e-4, -1e-4])
        scene.add(wf.joints.Drive(guide, down, quantity="position"))
        scene.add(wf.Contact(lower["rim"], upper["rim"], name="pair"))
        settings = Settings(window_strain=0.3, force_points=points)
        found.append(StaticPath(scene, settings=settings).solve(1).contacts["pair"])
    line, at_points = found
    force = [np.linalg.norm(f.force[0]) for f in found]
    assert force[0] == pytest.approx(force[1], rel=2e-3)
    assert line.pressure.max() == pytest.approx(at_points.pressure.max(), rel=5e-3)
    # action and reaction: the moment about the common normal, which nodes on the second grid take a little too large
    moments = [f.torque[0, 2] for f in found], [f.torque_second[0, 2] for f in found]
    # the force is along z but for skew^2, its line may shift the moment about the other axes only
    assert -moments[1][0] == pytest.approx(moments[0][0], rel=SECOND_MOMENT)
    assert -moments[1][1] == pytest.approx(moments[0][1], rel=1e-9)
