"""`warpffrf compare` and `warpffrf plot` on results files of the smallest runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import warpffrf as wf
from warpffrf import cli
from warpffrf.output.plots.figure import about_kinds, drawable
from warpffrf.output.plots.panels import HISTORY_PLOTS

STEPS = 20


def fall(path: Path, gravity: float) -> Path:
    """Results of a body that falls freely for 20 steps of 1 ms."""
    scene = wf.Scene(gravity=(0.0, 0.0, -gravity))
    scene.add_rigid_body(2.0, (0.01, 0.01, 0.01), name="stone")
    wf.simulate(scene, STEPS * 1e-3, step=1e-3, results=path, progress=False, start="initial")
    return path


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp("falls")
    return fall(folder / "earth.h5", 9.81), fall(folder / "mars.h5", 3.71)


def test_two_runs_are_compared_and_drawn(
    files: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    picture = tmp_path / "both.png"
    assert cli.main(["compare", *map(str, files), "--out", str(picture)]) == 0
    said = capsys.readouterr().out
    assert (
        "settings that differ" in said
        and "  gravity  0, 0, -9.81  0, 0, -3.71" in said
        and f"drawn to {picture}" in said
    )
    # all of a free fall from rest goes with g
    (line,) = [line for line in said.splitlines() if line.startswith("body_velocity[stone]")]
    assert float(line.split()[2]) == pytest.approx(1.0 - 3.71 / 9.81, abs=1e-4)  # printed with four digits
    assert picture.stat().st_size > 10_000
    assert cli.main(["compare", *map(str, files), "--history", "x"]) == 1
    assert "--out" in capsys.readouterr().err


def test_a_plot_is_written(files: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    from matplotlib.image import imread

    picture = tmp_path / "energy.png"
    assert cli.main(["plot", str(files[0]), "energy", "--out", str(picture)]) == 0
    pixels = imread(picture)
    assert np.isfinite(pixels).all() and np.ptp(pixels[..., :3]) > 0.5
    capsys.readouterr()
    for arguments, error in (
        (["plot", str(files[0]), "energy", "--out", str(picture)], "exists"),
        (["plot", str(files[0]), "energi", "--out", str(tmp_path / "b.png")], "unknown kind 'energi'"),
        (["plot", str(files[0]), "energy"], "--out"),
        (["plot"], "--list"),
    ):
        assert cli.main(arguments) == 1
        assert error in capsys.readouterr().err


def test_kinds_are_listed(files: tuple[Path, Path], capsys: pytest.CaptureFixture) -> None:
    assert cli.main(["plot", "--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(about_kinds()) and all(len(line.split()) > 3 for line in lines)
    assert cli.main(["plot", str(files[0]), "--list"]) == 0
    kinds = [line.split()[0] for line in capsys.readouterr().out.splitlines()]
    assert kinds == [*drawable(wf.Result.load(files[0])), *HISTORY_PLOTS, "summary"]
    assert kinds == ["energy", "spectrum", "waterfall", "summary"]
