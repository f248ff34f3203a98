"""Recordings are read back: topology once, one position set a frame, rigid motion on the parent, nothing that is not
finite."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from recordings import columns
from synthetic_run import STEPS

from warpffrf.model.errors import InputError
from warpffrf.output.recording.recorder import record
from warpffrf.output.result import Result


def test_recording_reads_back(result: Result, tmp_path: Path) -> None:
    info = record(result, tmp_path / "run.rrd", deformation_factor=40.0)
    assert (info.frames, info.stride, info.deformation_factor) == (STEPS, 1, 40.0)
    positions = columns(info.path, "/world/lower/surface", "Mesh3D:vertex_positions")
    assert len(positions) == STEPS
    assert len(columns(info.path, "/world/lower/surface", "Mesh3D:triangle_indices")) == 1
    skin = result.skins()["lower"]
    for i in (0, 5, STEPS - 1):
        expected = skin.points + 40.0 * skin.displacement(i)
        assert np.array(positions[i]) == pytest.approx(expected, abs=1e-7)  # float32 of 0.05 m
    assert len(columns(info.path, "/world/upper", "Transform3D:translation")) == STEPS
    quaternions = np.array(columns(info.path, "/world/lower", "Transform3D:quaternion")).reshape(STEPS, 4)
    assert quaternions == pytest.approx(result.body("lower").rotation, abs=1e-7)


def test_scalars_are_those_of_the_result(result: Result, tmp_path: Path) -> None:
    info = record(result, tmp_path / "run.rrd")
    contact = result.contact("lower-upper")
    plots = {
        "force": contact.force_magnitude,
        "peak_pressure": contact.peak_pressure * 1e-6,
        "half_width": contact.half_width * 1e6,
    }
    for name, expected in plots.items():
        got = np.array(columns(info.path, f"/plots/{name}/**", "Scalars:scalars")).ravel()
        assert got == pytest.approx(expected)


def test_arrows_show_action_and_reaction(result: Result, tmp_path: Path) -> None:
    info = record(result, tmp_path / "run.rrd")
    vectors = np.array(columns(info.path, "/world/forces/**", "Arrows3D:vectors"))
    assert vectors.shape == (STEPS, 2, 3)
    assert vectors[:, 0] == pytest.approx(-vectors[:, 1], abs=1e-9)
    assert np.all(vectors[:, 0, 2] < 0.0)  # the lower roller is pushed down


def test_rerun_verifies_the_file(result: Result, tmp_path: Path) -> None:
    info = record(result, tmp_path / "run.rrd", max_frames=2)
    program = shutil.which("rerun", path=str(Path(sys.executable).parent))
    assert program is not None, "the rerun wheel brings the program"
    done = subprocess.run([program, "rrd", "verify", str(info.path)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr


def test_stride_keeps_first_and_last(result: Result, tmp_path: Path) -> None:
    info = record(result, tmp_path / "run.rrd", max_frames=4)
    assert info.frames <= 4 and info.stride == 3
    assert any("stride 3" in note for note in info.notes)


def test_nan_is_left_out_and_said(result: Result, tmp_path: Path) -> None:
    result.history.bodies["lower"].modal[3] = np.nan
    result.history.contacts["lower-upper"].force[6] = np.inf
    info = record(result, tmp_path / "run.rrd")
    assert info.skipped_rows == [3, 6] and info.frames == STEPS - 2
    assert any("saved rows 3, 6" in note for note in info.notes)
    for values in columns(info.path, "/world/lower/surface", "Mesh3D:vertex_positions"):
        assert np.all(np.isfinite(np.array(values)))
    assert np.isfinite(info.deformation_factor)


def test_a_run_of_nan_only_still_gives_a_file(result: Result, tmp_path: Path) -> None:
    result.history.bodies["lower"].position[:] = np.nan
    info = record(result, tmp_path / "run.rrd")
    assert info.frames == 0 and len(info.skipped_rows) == STEPS


def test_coarse_surface_is_reported(result: Result, tmp_path: Path) -> None:
    info = record(result, tmp_path / "run.rrd", max_points=200)
    assert any("surface of 'lower' drawn with" in note for note in info.notes)
    positions = columns(info.path, "/world/lower/surface", "Mesh3D:vertex_positions")
    assert 100 < len(positions[0]) <= 200


def test_bad_arguments_are_refused(result: Result, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="deformation_factor is -1"):
        record(result, tmp_path / "run.rrd", deformation_factor=-1)
    with pytest.raises(InputError, match="max_frames is 0"):
        record(result, tmp_path / "run.rrd", max_frames=0)
    with pytest.raises(InputError, match="is a folder"):
        record(result, tmp_path)
