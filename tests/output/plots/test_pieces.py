"""Paths, thinning, frames, colours."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from synthetic_run import COLUMNS, ROWS, WINDOW, R

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import checked_output_path, size_text, written_whole
from warpffrf.model.files.sealed_file import written_sealed
from warpffrf.output.geometry.skin_nodes import frame_rows, round_factor, rows_every, thinned, vertex_normals
from warpffrf.output.plots.colors import PRESSURE_STOPS, ColorScale, legend_picture, map_axes_picture
from warpffrf.output.recording.frames import grid_triangles, patch_frame, relief
from warpffrf.output.recording.patch_map import MapWindow, node_map
from warpffrf.output.result import Result


def test_output_path_makes_folders_and_keeps_files(tmp_path: Path) -> None:
    target = checked_output_path(tmp_path / "a" / "b.h5", "results", overwrite=False)
    assert target.parent.is_dir() and not target.exists()
    target.write_text("old, written by warpffrf")
    checked_output_path(target, "results", overwrite=True)
    assert target.read_text() == "old, written by warpffrf"


def test_what_exists_is_replaced_only_if_asked_and_only_what_is_ours(tmp_path: Path) -> None:
    target = tmp_path / "run.h5"
    with written_sealed(target) as file:
        file["zeros"] = np.zeros(20_000)
    with pytest.raises(InputError, match=r"run.h5' exists; .*overwrite=True"):
        checked_output_path(target, "results", overwrite=False)
    checked_output_path(target, "results", overwrite=True)
    with h5py.File(target, "w") as foreign:
        foreign["warpffrf"] = np.zeros(20_000)
    notes = b"# What I did with warpffrf\nimport warpffrf as wf\n"
    for content in (target.read_bytes(), notes, b"x" * 100_000 + notes, b"\x89PNG\r\n" + notes, b"%PDF-1.4\n" + notes):
        target.write_bytes(content)
        with pytest.raises(InputError, match="was not written by warpffrf and is not replaced"):
            checked_output_path(target, "results", overwrite=True)


def test_files_that_killed_processes_left_are_removed(tmp_path: Path) -> None:
    """Of the same target, of this machine, and of processes that are no more."""
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    host = socket.gethostname().replace(".", "-")
    names = [f".run.h5.{host}.{ended.pid}.ab.part", f".run.h5.{host}.{os.getpid()}.ab.part"]
    names += [f".run.h5.elsewhere.{ended.pid}.ab.part", f".other.h5.{host}.{ended.pid}.ab.part"]
    for name in names:
        (tmp_path / name).touch()
    with written_whole(tmp_path / "run.h5") as partial:
        partial.touch()
    assert {file.name for file in tmp_path.iterdir()} == {"run.h5", *names[1:]}


def test_output_path_that_cannot_be_written(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("")
    with pytest.raises(InputError, match="record: .* cannot be written"):
        checked_output_path(file / "run.rrd", "record", overwrite=False)
    with pytest.raises(InputError, match="is a folder"):
        checked_output_path(tmp_path, "record", overwrite=False)


def test_written_whole_keeps_the_old_file_on_error(tmp_path: Path) -> None:
    target = tmp_path / "x"
    target.write_text("old")
    with pytest.raises(RuntimeError), written_whole(target) as partial:
        partial.write_text("half")
        raise RuntimeError
    assert target.read_text() == "old" and len(list(tmp_path.iterdir())) == 1


@given(st.integers(1, 5000), st.integers(1, 400))
def test_frame_rows(steps: int, most: int) -> None:
    rows, stride = frame_rows(steps, most)
    assert 1 <= len(rows) <= most and rows[-1] == steps - 1
    assert np.all(np.diff(rows) > 0) and np.all(np.diff(rows) <= stride)
    if most > 1:
        assert rows[0] == 0


@given(st.integers(1, 500), st.integers(1, 600))
def test_rows_every(steps: int, stride: int) -> None:
    rows = rows_every(steps, stride)
    assert list(rows) == sorted({*range(0, steps, stride), steps - 1})


@pytest.mark.parametrize(("size", "text"), [(11, "11 bytes"), (14_230_000, "14.2 MB"), (5.28e15, "5.28e+03 TB")])
def test_sizes_as_people_say_them(size: float, text: str) -> None:
    assert size_text(size) == text


@given(st.floats(1.0, 1e9))
def test_round_factor_is_a_round_number_below(factor: float) -> None:
    rounded = round_factor(factor)
    assert factor / 2.5 <= rounded * (1 + 1e-9) and rounded <= factor * (1 + 1e-9)
    mantissa = rounded / 10.0 ** np.floor(np.log10(rounded) + 1e-9)
    assert min(abs(mantissa - m) for m in (1, 2, 5)) < 1e-9


def test_round_factor_without_displacement() -> None:
    assert round_factor(np.inf) == 1.0 and round_factor(0.3) == 1.0


def test_thinning_keeps_shape_and_indices(body) -> None:
    points, triangles = body.surface.points, body.surface.triangles
    kept, coarse = thinned(points, triangles, 300)
    assert len(kept) <= 300 and coarse.max() < len(kept)
    assert np.ptp(points[kept], axis=0) == pytest.approx(np.ptp(points, axis=0), rel=0.05)
    normals = vertex_normals(points[kept], coarse)
    on_rim = np.hypot(points[kept][:, 0], points[kept][:, 2]) > 0.9 * R
    outwards = (normals * points[kept])[:, [0, 2]].sum(axis=1)
    assert np.all(outwards[on_rim] > 0.0) and np.all(outwards[~on_rim] < 0.0)
    kept, coarse = thinned(points[: COLUMNS * ROWS], triangles[: 2 * COLUMNS * (ROWS - 1)], 300, sectors=COLUMNS)
    assert np.array_equal(np.unique(kept // ROWS), np.arange(0, COLUMNS, 2))  # every second sector: still round
    assert len(coarse) == COLUMNS * (ROWS - 1)
    same, all_triangles = thinned(points, triangles, len(points))
    assert len(same) == len(points) and len(all_triangles) == len(triangles)


def test_patch_frame_is_right_handed_and_in_place(result: Result) -> None:
    contact = result.contact("lower-upper")
    for i in (0, 7):
        frame = patch_frame(result, contact, i)
        assert np.linalg.det(frame.axes) == pytest.approx(1.0)
        assert frame.origin == pytest.approx([0.0, 0.0, R], abs=1e-12)
        assert frame.axes[:, 2] == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)  # outwards of the lower roller, at its top
        # the arc grows with theta, which runs from +z towards -x about the axis +y for e_1 = -z
        d = 1e-6
        shape = contact.view.first.shape
        theta = contact.view.first.grid.pitch * contact.history.center_column[0]
        along = (shape.point(theta + d, 0.0) - shape.point(theta, 0.0)) / (R * d)
        assert patch_frame(result, contact, 0).axes[:, 0] == pytest.approx(along, abs=1e-5)


def test_relief_and_map_show_the_nodes(result: Result) -> None:
    contact = result.contact("lower-upper")
    patch = contact.pressure(4)
    height = 2e-3
    vertices = relief(contact, 4, patch.pressure.max(), height).reshape(WINDOW, ROWS, 3)
    above = np.hypot(vertices[..., 0], vertices[..., 2] + R) - R
    assert above == pytest.approx(height * patch.pressure / patch.pressure.max(), abs=1e-12)
    loaded = patch.pressure[:, 1] > 0.0
    arc = R * np.arctan2(vertices[:, 1, 0], vertices[:, 1, 2] + R)
    assert arc[loaded] == pytest.approx(patch.arc[loaded])
    assert np.ptp(arc) <= np.ptp(patch.arc[loaded]) + 2.0 * contact.spacing * (1.0 + 1e-9)
    window = MapWindow(1.5 * contact.half_width[4], float(patch.z[0]), float(patch.z[-1]))
    picture = node_map(contact, 4, patch.pressure, window, (3, 101))
    expected = np.interp(window.x(101), patch.arc, patch.pressure[:, 1])
    assert picture[1] == pytest.approx(expected)


def test_grid_triangles_face_up() -> None:
    x, y = np.meshgrid(np.arange(3.0), np.arange(4.0), indexing="ij")
    points = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)
    corners = points[grid_triangles(3, 4)]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
    assert np.all(area == 1.0) and len(area) == 12


def test_colors_have_a_fixed_range() -> None:
    scale = ColorScale("p [MPa]", 2.0, 1.0, PRESSURE_STOPS)
    first, last = (int(s[1:], 16) << 8 | 0xFF for s in (PRESSURE_STOPS[0], PRESSURE_STOPS[-1]))
    assert scale.packed(np.array([-1.0, 0.0, 2.0, 9.0])).tolist() == [first, first, last, last]
    assert ColorScale("p", 0.0, 1.0, PRESSURE_STOPS).packed(np.zeros(2)).tolist() == [first, first]
    legend = legend_picture([scale, scale])
    assert legend.shape[2] == 4 and np.all(legend[[0, -1]][:, [0, -1], 3] == 0)  # a transparent ground
    picture, (left, top) = map_axes_picture((-1.0, 1.0), (-10.0, 10.0), ("arc [mm]", "axis [mm]"), (60, 200))
    assert picture.shape[0] > 60 + top and picture.shape[1] > 200 + left


def test_importing_output_is_light() -> None:
    heavy = "('rerun', 'matplotlib', 'meshio', 'xarray')"
    code = f"import sys, warpffrf.output.result; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.stdout.strip().endswith("[]"), done.stderr
