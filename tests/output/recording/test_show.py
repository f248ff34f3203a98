"""Animated modes are read back: numbers as in finite-element programs, topology once, a closed cycle."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from test_recorder import columns

from warpffrf.model.errors import InputError
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.data import DisplaySurface
from warpffrf.output.recording.show import show_modes

SIZE = 0.1  # m, largest extent of the synthetic roller
FRAMES = 8


def frames_of(path: Path) -> np.ndarray:
    return np.array(columns(path, "/body/skin", "Mesh3D:vertex_positions"))


def test_the_first_elastic_mode_is_number_seven(body: ReducedBody, tmp_path: Path) -> None:
    shown = body.show(mode=7, path=tmp_path / "mode.rrd", frames=FRAMES, scale=0.1)
    assert (shown.modes, shown.frequencies) == ((7,), (5e3,))
    moved = frames_of(shown.path) - body.surface.points
    assert moved.shape == (FRAMES, len(body.surface.points), 3)
    shape = body.surface.modes[0]
    expected = 0.1 * SIZE * shape / np.linalg.norm(shape, axis=1).max()
    phase = np.sin(2.0 * np.pi * np.arange(FRAMES) / FRAMES)
    assert moved == pytest.approx(phase[:, None, None] * expected, abs=1e-8)  # float32 of 0.05 m
    assert len(columns(shown.path, "/body/skin", "Mesh3D:triangle_indices")) == 1
    assert len(columns(shown.path, "/body/skin", "Mesh3D:vertex_colors")) == 1


@pytest.mark.parametrize("number", [2, 4, 6])
def test_rigid_motions_change_no_distance_to_first_order(body: ReducedBody, tmp_path: Path, number: int) -> None:
    scale = 1e-2
    shown = body.show(mode=number, path=tmp_path / "mode.rrd", frames=4, scale=scale)
    assert shown.frequencies == (0.0,)
    x = body.surface.points
    u = frames_of(shown.path)[1] - x
    assert np.linalg.norm(u, axis=1).max() == pytest.approx(scale * SIZE, rel=1e-5)
    strain = np.einsum("ni,ni->n", x[1:] - x[:-1], u[1:] - u[:-1]) / np.sum((x[1:] - x[:-1]) ** 2, axis=1)
    assert np.abs(strain).max() < 1e-4  # float32
    if number <= 3:
        assert u == pytest.approx(np.tile(scale * SIZE * np.eye(3)[number - 1], (len(x), 1)), abs=1e-8)


def test_all_elastic_modes_follow_one_another(body: ReducedBody, tmp_path: Path) -> None:
    shown = body.show(path=tmp_path / "modes.rrd", frames=FRAMES)
    assert shown.modes == (7, 8)
    moved = frames_of(shown.path) - body.surface.points
    assert len(moved) == 2 * FRAMES
    largest = np.linalg.norm(moved, axis=2).max(axis=1)
    assert largest[[0, FRAMES]] == pytest.approx([0.0, 0.0], abs=1e-8)
    assert np.abs(moved[FRAMES // 4, :, 1]).max() > 0.0  # the first bends out of its plane, the second does not
    assert np.abs(moved[FRAMES + FRAMES // 4, :, 1]).max() < 1e-8
    assert len(columns(shown.path, "/body/skin", "Mesh3D:vertex_colors")) == 2
    labels = columns(shown.path, "/about", "TextDocument:text")
    assert "Mode 7: 5000 Hz" in str(labels[0]) and "Mode 8: 8000 Hz" in str(labels[1])


def test_what_cannot_be_shown_is_refused(body: ReducedBody, tmp_path: Path, monkeypatch) -> None:
    path = tmp_path / "mode.rrd"
    with pytest.raises(InputError, match="no mode 9; 1 to 6 are the rigid motions, 7 to 8 are elastic"):
        body.show(mode=9, path=path)
    for mode in (0, -1, 7.5, "first"):
        with pytest.raises(InputError, match="show: mode"):
            show_modes(body, mode, path=path)  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match="show: frames"):
        body.show(mode=7, path=path, frames=1)
    with pytest.raises(InputError, match="show: scale"):
        body.show(mode=7, path=path, scale=0.0)
    with pytest.raises(InputError, match="is a folder"):
        body.show(mode=7, path=tmp_path)
    stiff = replace(body, frequencies=np.zeros(0))
    with pytest.raises(InputError, match="no elastic modes"):
        stiff.show(path=path)
    bare = replace(body, surface=DisplaySurface(np.zeros((0, 3)), np.zeros((0, 3), int), np.zeros((2, 0, 3))))
    with pytest.raises(InputError, match="no skin"):
        bare.show(mode=7, path=path)
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with pytest.raises(InputError, match="no screen"):
        body.show(mode=7)
    assert not path.exists()
