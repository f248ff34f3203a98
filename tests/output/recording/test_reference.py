"""What elastic displacements are relative to: rigid motions of an interface, and the pose at the first saved step."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from recordings import columns
from synthetic_run import make_history

from warpffrf.model.errors import InputError
from warpffrf.output.bodies.skin import ShownSkin
from warpffrf.output.geometry.places import Pose
from warpffrf.output.geometry.reference import START, Reference
from warpffrf.output.plots.scene_picture import ScenePicture
from warpffrf.output.recording.recorder import record
from warpffrf.output.result import Result

ALL, FACTOR, ROW, BODY = 10**9, 7.0, 5, "lower"
SHIFT, TURN = np.array([200.0, -100.0, 50.0]), np.array([300.0, 2000.0, -700.0])  # of the first mode, at its bore


@pytest.fixture
def carried(body: Any) -> Any:
    """The roller with a first mode that is a rigid motion, of the bore as well."""
    found = copy.deepcopy(body)
    bore = found.interfaces["bore"]
    bore.modes[0] = [*SHIFT, *TURN]
    found.surface.modes[0] = SHIFT + np.cross(TURN, found.surface.points - bore.point)
    return found


def of(body: Any, *, rigid: float = 1.0) -> Result:
    history = make_history(body)
    for motion in history.bodies.values():
        motion.modal[:, 0] *= rigid
    return Result(history)


def shown(result: Result, relative_to: str | None) -> ShownSkin:
    reference = Reference(result.view.bodies, result.history.bodies, relative_to, "test")
    return ShownSkin(result.skins()[BODY], ALL, reference)


def test_a_rigid_motion_of_the_interface_contributes_nothing(carried: Any) -> None:
    result = of(carried)
    still = shown(of(carried, rigid=0.0), None).displacement(ROW)
    seen = shown(result, "bore")
    assert seen.displacement(ROW) == pytest.approx(still, abs=1e-12 * np.abs(still).max() + 1e-18)
    whole = shown(result, None).displacement(ROW)
    assert np.abs(whole - still).max() > 0.1 * np.abs(still).max()
    assert seen.carried(ROW) + seen.displacement(ROW) == pytest.approx(whole, abs=1e-18)


def test_displacements_since_the_start_are_those_of_points_of_the_world(carried: Any) -> None:
    result = of(carried)
    seen, points = shown(result, START), shown(result, None).points
    motions = result.history.bodies
    first, now = Pose.of(motions, BODY, 0), Pose.of(motions, BODY, ROW)
    place = now.to_world(points + shown(result, None).displacement(ROW))
    assert now.to_world(points + seen.carried(ROW)) == pytest.approx(first.to_world(points), abs=1e-15)
    assert now.turned(seen.displacement(ROW)) == pytest.approx(place - first.to_world(points), abs=1e-15)


def test_a_recording_magnifies_what_is_left(carried: Any, tmp_path: Path) -> None:
    result = of(carried)
    drawn, seen = {}, shown(result, "bore")
    for name in (None, "bore"):
        path = tmp_path / f"{name}.rrd"
        info = record(result, path, relative_to=name, deformation_factor=FACTOR, max_frames=len(result.time))
        drawn[name] = np.array(columns(path, f"/world/{BODY}/surface", "Mesh3D:vertex_positions")[ROW])
        assert ("relative to 'bore'" in info.notes[0]) == (name == "bore")
    expected = seen.points + seen.carried(ROW) + FACTOR * seen.displacement(ROW)
    assert drawn["bore"] == pytest.approx(expected, abs=1e-7)
    apart = drawn[None] - drawn["bore"]
    assert apart == pytest.approx((FACTOR - 1.0) * seen.carried(ROW), abs=1e-7) and np.abs(apart).max() > 1e-6


def test_an_unknown_reference_is_refused(carried: Any, tmp_path: Path) -> None:
    result = of(carried)
    with pytest.raises(InputError, match=r"record: relative_to.*'boer'.*bore"):
        record(result, tmp_path / "x.rrd", relative_to="boer")
    with pytest.raises(InputError, match=r"picture: relative_to.*'boer'.*bore"):
        result.picture(tmp_path / "x.png", relative_to="boer")
    result.picture(tmp_path / "x.png", relative_to="bore")


def test_a_picture_shows_all_of_a_magnified_body(carried: Any) -> None:
    result, row, factor = of(carried), np.array([ROW]), 2000.0
    picture = ScenePicture(result, "displacement", row, factor=factor, what="picture", relative_to="bore")
    for name, shown in picture.skins.items():
        points = shown.points + shown.carried(ROW) + factor * shown.displacement(ROW)
        seen = Pose.of(result.history.bodies, name, ROW).to_world(points) @ picture.axes[:2].T
        assert np.all(seen > picture.low) and np.all(seen < picture.high)
        assert np.linalg.norm(factor * shown.displacement(ROW), axis=1).max() > 0.2 * shown.size
