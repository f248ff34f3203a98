"""Joint coordinates by name, from the run through the file and the dataset."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError


def test_both_coordinates_of_a_cylindrical_joint_come_back(tmp_path: Path) -> None:
    scene = wf.Scene()
    screw = scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="screw")
    pipe = scene.add(wf.joints.Cylindrical(scene.ground, screw.at((0, 0, 0)), axis=(0, 0, 1), name="pipe"))
    scene.add(wf.joints.Drive(pipe, 3.0, coordinate="rotation"))
    scene.add(wf.joints.Drive(pipe, 0.5, coordinate="translation"))
    result = wf.simulate(scene, duration=0.01, step=1e-3, progress=False)
    again = wf.Result.load(result.save(tmp_path / "run.h5"))
    for found in (result.joint("pipe"), again.joint("pipe")):
        assert found.names == ("translation", "rotation")
        assert found.named("translation") == pytest.approx(0.5 * result.time, abs=1e-12)
        assert found.named("rotation") == pytest.approx(3.0 * result.time, abs=1e-12)
        assert np.array_equal(found.named("rotation"), np.asarray(found.second_coordinate))
        with pytest.raises(InputError, match="known: 'translation', 'rotation'"):
            found.named("angle")
    data = again.to_xarray()
    assert data["joint_second_coordinate"].sel(joint="pipe").values == pytest.approx(3.0 * result.time, abs=1e-12)
