"""`warpffrf report`, `compare` and `plot` on results files of the smallest runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import warpffrf as wf
from page_reader import Page
from warpffrf import cli
from warpffrf.output.plots.figure import about_kinds, drawable
from warpffrf.output.plots.panels import HISTORY_PLOTS

STEPS = 20
STONE = """
[scene]
gravity = [0, 0, -9.81]
[bodies.stone]
mass = 2.0
inertia_tensor = [0.01, 0.01, 0.01]
[simulate]
duration = 0.02
step = 1e-3
start = "initial"
"""


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


def test_a_page_of_a_run_is_written(files: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    target = tmp_path / "earth.html"
    assert cli.main(["report", str(files[0]), "-o", str(target)]) == 0
    assert f"written to {target}" in capsys.readouterr().out
    page = Page(target.read_text(encoding="utf-8"))
    result = wf.Result.load(files[0])
    assert "Run: earth" in page.text and ["gravity", "(0, 0, -9.81) m/s2"] in page.rows
    assert ["energy scale", f"{result.energy_scale:.6g} J, the largest energy of the run"] in page.rows
    for arguments, error in (
        (["report", str(files[0]), "-o", str(target)], "--overwrite"),
        (["report", str(files[0]), "-o", str(tmp_path / "earth.txt")], ".html"),
        (["report", str(tmp_path / "moon.h5"), "-o", str(tmp_path / "moon.html")], "does not exist"),
        (["info", str(files[0]), "--page", str(tmp_path / "earth2.html")], "warpffrf report"),
    ):
        assert cli.main(arguments) == 1
        assert error in capsys.readouterr().err
    assert cli.main(["report", str(files[0]), "-o", str(target), "--overwrite"]) == 0
    half = 0.5 * wf.Result.load(files[0]).time[-1]
    assert cli.main(["report", str(files[0]), "-o", str(target), "--overwrite", "--since", str(half)]) == 0
    assert f"{half:.6g} to " in target.read_text(encoding="utf-8")


def test_the_errors_of_a_run_are_in_its_file(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    """What the report of `run` prints, a page of the file shows."""
    scene = tmp_path / "stone.toml"
    scene.write_text(STONE, encoding="utf-8")
    assert cli.main(["run", str(scene), "--out", str(tmp_path / "out")]) == 0
    result = wf.Result.load(tmp_path / "out" / "stone.h5")
    (line,) = [line for line in result.error_budget() if line.of == "motion of body 'stone'"]
    assert f"body 'stone': motion {100.0 * line.size:.2g} % (time step)" in capsys.readouterr().out


def test_kinds_are_listed(files: tuple[Path, Path], capsys: pytest.CaptureFixture) -> None:
    assert cli.main(["plot", "--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(about_kinds()) and all(len(line.split()) > 3 for line in lines)
    assert cli.main(["plot", str(files[0]), "--list"]) == 0
    kinds = [line.split()[0] for line in capsys.readouterr().out.splitlines()]
    assert kinds == [*drawable(wf.Result.load(files[0])), *HISTORY_PLOTS, "summary"]
    assert kinds == ["energy", "spectrum", "waterfall", "summary"]
