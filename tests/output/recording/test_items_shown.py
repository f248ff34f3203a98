"""Joints, forces and sensors in the report, the dataset and the results file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model import forces, joints
from warpffrf.output.report.report import MOST_LINES


@pytest.fixture(scope="module")
def result() -> wf.Result:
    scene = wf.Scene(gravity=(0.0, 0.0, -9.81))
    arm = scene.add_rigid_body(2.0, (0.1, 0.1, 0.1), name="arm", position=(1, 0, 0))
    weight = scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="weight", position=(2, 0, -1))
    scene.add(joints.Revolute(scene.ground, arm.at((-1, 0, 0)), axis=(0, 1, 0), name="hinge"))
    scene.add(joints.Spherical(arm.at((1, 0, 0)), weight.at((0, 0, 1)), name="ball"))
    scene.add(joints.Cylindrical(scene.ground, scene.add_rigid_body(1.0, (1, 1, 1), name="nut").at((0, 0, 0)),
                                 axis=(0, 0, 1), name="thread"))  # fmt: skip
    scene.add(forces.PointForce(arm.at((0, 0, 0)), (0.0, 3.0, 4.0), name="push"))
    for name in ("z", "m", "a"):
        scene.add(wf.sensors.Position(arm.at((0, 0, 0)), name=name))
    return wf.simulate(scene, 0.02, step=1e-3, progress=False)


def test_the_report_has_a_line_each(result: wf.Result) -> None:
    text = result.report()
    hinge = result.joint("hinge")
    sizes = np.linalg.norm(hinge.force, axis=1)
    assert f"joint 'hinge': reaction {sizes[-1]:.5g} N (largest {sizes.max():.5g})" in text
    assert f"; rotation {hinge.coordinate[-1]:.6g} rad" in text
    ball = next(line for line in text.splitlines() if line.startswith("joint 'ball'"))
    assert "rotation" not in ball
    assert "force 'push': 5 N (largest 5)" in text
    assert "sensor 'z' [m]: x " in text


def test_a_long_report_is_capped() -> None:
    scene = wf.Scene()
    for i in range(MOST_LINES + 3):
        body = scene.add_rigid_body(1.0, (1, 1, 1), name=f"b{i}", position=(i, 0, 0))
        scene.add(joints.Spherical(scene.ground, body.at((0, 0, 0)), name=f"j{chr(ord('a') + i)}"))
    text = wf.simulate(scene, 1e-3, step=1e-3, progress=False).report()
    assert text.count("joint 'j") == MOST_LINES and "... and 3 more lines of joints" in text


def test_the_dataset_says_what_a_coordinate_is(result: wf.Result) -> None:
    data = result.to_xarray()
    thread = data.sel(joint="thread")
    assert str(thread["joint_coordinate_name"].values) == "translation"
    assert str(thread["joint_second_coordinate_name"].values) == "rotation"
    assert list(data["joint_coordinate_name"].values) == ["rotation", "", "translation"]


def test_sensors_keep_their_order_in_a_file(result: wf.Result, tmp_path: Path) -> None:
    assert result.sensor_names == ["z", "m", "a"]
    assert wf.Result.load(result.save(tmp_path / "run.h5")).sensor_names == ["z", "m", "a"]


def test_a_results_file_ends_like_one(result: wf.Result, tmp_path: Path) -> None:
    for name in ("run.csv", "run"):
        with pytest.raises(wf.InputError, match=r"must end in \.h5 or \.hdf5"):
            result.save(tmp_path / name)
        assert not (tmp_path / name).exists()
