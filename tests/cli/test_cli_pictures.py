"""`warpffrf view` and `warpffrf picture`: commands are built without being started, and files are looked at."""

from __future__ import annotations

import shutil
import socket
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import warpffrf as wf
from warpffrf import cli
from warpffrf.output.recording import viewer

SCREENS = ("DISPLAY", "WAYLAND_DISPLAY")


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A body that falls, ten rows."""
    scene = wf.Scene(gravity=(0.0, 0.0, -9.81))
    scene.add_rigid_body(2.0, (0.01, 0.01, 0.01), name="stone")
    path = tmp_path_factory.mktemp("fall") / "fall.h5"
    wf.simulate(scene, 0.09, step=0.01, results=path, progress=False, start="initial")
    return path


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """A Linux machine without a screen, on which nothing is started."""
    monkeypatch.setattr("sys.platform", "linux")
    for name in SCREENS:
        monkeypatch.delenv(name, raising=False)
    return monkeypatch


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch) -> list[list[str]]:
    """The commands that would have been started."""
    found: list[list[str]] = []

    def run(command: list[str]) -> int:
        assert Path(command[1]).stat().st_size > 0
        found.append(command)
        return 0

    monkeypatch.setattr(viewer, "run", run)
    return found


def test_view_opens_a_recording_of_the_results(
    results: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, started: list, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.setenv("DISPLAY", ":7")
    recording = tmp_path / "fall.rrd"
    assert cli.main(["view", str(results), "--out", str(recording), "--every", "3"]) == 0
    assert "fall.rrd', " in (said := capsys.readouterr().out) and "4 frames" in said and not started
    assert cli.main(["view", str(recording)]) == 0
    assert cli.main(["view", str(results)]) == 0
    assert [command[1] for command in started][0] == str(recording)
    assert [Path(command[0]).stem for command in started] == ["rerun", "rerun"] and len(started[1]) == 2
    assert not Path(started[1][1]).exists()  # made for the viewer, and gone with it
    assert cli.main(["view", str(recording), "--field", "pressure"]) == 1
    assert "--field" in capsys.readouterr().err


def test_view_on_a_server_says_what_to_do(
    results: Path, tmp_path: Path, server: pytest.MonkeyPatch, started: list, capsys: pytest.CaptureFixture
) -> None:
    recording = tmp_path / "fall.rrd"
    assert cli.main(["view", str(results), "--out", str(recording)]) == 0
    for file in (results, recording):
        assert cli.main(["view", str(file)]) == 1
        assert "no screen" in (error := capsys.readouterr().err) and "--serve" in error
    assert not started
    assert cli.main(["view", str(recording), "--serve"]) == 0
    assert started[0][1:] == [str(recording), "--serve-web", "--bind", "127.0.0.1"]
    assert "http://127.0.0.1:9090?" in capsys.readouterr().out
    assert cli.main(["view", str(recording), "--serve", "--bind", "0.0.0.0"]) == 0
    assert started[1][-1] == "0.0.0.0" and f"http://{socket.gethostname()}:9090?" in capsys.readouterr().out
    assert cli.main(["view", str(recording), "--serve", "--bind", "everybody"]) == 1
    assert "--bind everybody is no address" in capsys.readouterr().err
    assert cli.main(["picture", str(recording), str(tmp_path / "x.png"), "--time", "0.05"]) == 1
    assert "--time" in capsys.readouterr().err
    assert cli.main(["view", str(tmp_path / "none.rrd")]) == 1
    assert "does not exist" in capsys.readouterr().err


def test_picture_of_a_recording_names_the_packages(
    results: Path, tmp_path: Path, server: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    """The command for a virtual screen where both packages are there, else the names of those that are missing."""
    recording, picture = tmp_path / "fall.rrd", tmp_path / "fall.png"
    assert cli.main(["view", str(results), "--out", str(recording)]) == 0
    for name in viewer.DRIVER_VARIABLES:
        server.delenv(name, raising=False)
    server.setattr(viewer, "DRIVERS", (str(tmp_path),))
    which = shutil.which
    server.setattr(shutil, "which", lambda name, path=None: None if name == "xvfb-run" else which(name, path=path))
    capsys.readouterr()
    assert cli.main(["picture", str(recording), str(picture)]) == 1
    assert "apt install xvfb mesa-vulkan-drivers" in capsys.readouterr().err
    (tmp_path / "lvp_icd.json").write_text("{}")
    assert cli.main(["picture", str(recording), str(picture)]) == 1
    assert "apt install xvfb)" in capsys.readouterr().err
    server.setattr(shutil, "which", lambda name, path=None: f"/usr/bin/{name}")
    command = viewer.picture_command(recording, picture)
    assert command[:4] == ["xvfb-run", "-a", "-s", "-screen 0 6600x4200x24"] and command[-1] == str(picture)
    server.setenv("DISPLAY", ":7")
    assert viewer.picture_command(recording, picture) == command[4:]
    assert cli.main(["picture", str(recording), str(tmp_path / "fall.gif")]) == 1
    assert "must end in .png" in capsys.readouterr().err


def test_pictures_of_results(results: Path, tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    still, moving = tmp_path / "fall.png", tmp_path / "fall.gif"
    assert cli.main(["picture", str(results), str(still), "--time", "0.03"]) == 0
    assert capsys.readouterr().out == f"written to {still}\n"
    assert np.ptp(np.asarray(Image.open(still).convert("RGB"))) > 100
    assert cli.main(["picture", str(results), str(moving), "--every", "3", "--fps", "5"]) == 0
    with Image.open(moving) as image:
        assert image.n_frames == 4 and image.info["duration"] == 200  # type: ignore[attr-defined]
    for arguments, error in (
        ([still], "--overwrite"),
        ([tmp_path / "b.png", "--time", "3"], "time is 3 s; the run has 0 to 0.09 s"),
        ([tmp_path / "b.png", "--field", "pressure"], "field 'pressure' does not exist"),
        ([tmp_path / "b.txt"], "must end in .png"),
    ):
        assert cli.main(["picture", str(results), *map(str, arguments)]) == 1
        assert error in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("xvfb-run") is None, reason="needs a virtual screen")
def test_the_viewer_draws_on_a_virtual_screen(results: Path, tmp_path: Path, server: pytest.MonkeyPatch) -> None:
    recording = tmp_path / "fall.rrd"
    assert cli.main(["view", str(results), "--out", str(recording)]) == 0
    picture = viewer.recording_picture(recording, tmp_path / "fall.png")
    pixels = np.asarray(Image.open(picture).convert("RGB"))
    assert pixels.shape == (2000, 3200, 3) and len(np.unique(pixels[::8, ::8].reshape(-1, 3), axis=0)) > 20
