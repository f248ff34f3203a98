"""Pictures and animations of a run: frames counted and looked at, memory, interruptions, and what they refuse."""

from __future__ import annotations

import shutil
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from drawn_runs import loaded_bearing
from PIL import Image

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.output.bodies.skin import ShownSkin
from warpffrf.output.geometry.places import Pose, grid_theta_offset
from warpffrf.output.geometry.reference import Reference
from warpffrf.output.geometry.rigid_mesh import rigid_meshes
from warpffrf.output.plots.animation import NEEDS_FFMPEG
from warpffrf.output.plots.colors import ColorScale
from warpffrf.output.plots.restyle import PAPER
from warpffrf.output.plots.scene_picture import PATCH, VIEWS, ScenePicture
from warpffrf.output.result import Result

FALL, ROWS = 0.3, 4  # s, saved steps
SHADES = 30  # of 255: faces are shaded, and edges mixed with the paper


def pixels(image: Image.Image) -> np.ndarray:
    return np.asarray(image.convert("RGB")).astype(int)


def frames_of(path: Path) -> list[np.ndarray]:
    with Image.open(path) as image:
        return [pixels(image) for n in range(image.n_frames) if image.seek(n) is None]  # type: ignore[attr-defined]


@pytest.fixture(scope="module")
def stone() -> Result:
    """A cube that falls from rest."""
    scene = wf.Scene(gravity=(0.0, 0.0, -9.81))
    scene.add_rigid_body(2.0, (0.01, 0.01, 0.01), name="stone")
    return wf.simulate(scene, FALL, step=FALL / (ROWS - 1), start="initial", progress=False)


def test_a_stone_falls_in_its_animation(stone: Result, tmp_path: Path) -> None:
    """The middle of the drawn cube falls by g t^2/2, as pixels, in every frame."""
    path = stone.animate(tmp_path / "stone.gif", every=1, fps=10.0, progress=False)
    frames = frames_of(path)
    assert len(frames) == ROWS
    with Image.open(path) as image:
        assert image.info["duration"] == 100 and image.info["loop"] == 0
    drawn = [np.argwhere(np.ptp(frame, axis=2) + 255 - frame.min(axis=2) > SHADES) for frame in frames]
    height = np.array([rows[rows[:, 0] > 0.1 * len(frames[0])][:, 0].mean() for rows in drawn])
    fall = 0.5 * 9.81 * stone.time**2
    assert np.abs((height - height[0]) / (height[-1] - height[0]) - fall / fall[-1]).max() < 0.01
    assert height[-1] - height[0] > 50.0


@pytest.fixture(scope="module")
def bearing() -> Result:
    return loaded_bearing()


def picture_of(result: Result, field: str = "displacement", **options: Any) -> tuple[ScenePicture, np.ndarray]:
    """A picture of the last row and its pixels (height, width, 3)."""
    last = len(result.time) - 1
    picture = ScenePicture(result, field, np.array([last]), **{"factor": None, "what": "test", **options})
    figure = picture.figure()
    picture.draw(figure, last)
    figure.canvas.draw()
    return picture, np.asarray(figure.canvas.buffer_rgba())[..., :3].astype(int)


def test_a_ball_bearing_is_its_rings_and_balls(bearing: Result) -> None:
    """Seen along its axis: as wide as its outer ring is, a bore without anything in it, and as many balls as it has
    between the rings."""
    _, seen = picture_of(bearing, view="front")
    drawn = np.any(seen != 255, axis=2)[60:]  # below the words
    high, wide = (np.flatnonzero(drawn.any(axis=axis)) for axis in (1, 0))
    middle = np.array([0.5 * (high[0] + high[-1]), 0.5 * (wide[0] + wide[-1])])
    radius = 0.5 * (wide[-1] - wide[0])
    assert 0.5 * (high[-1] - high[0]) == pytest.approx(radius, abs=2.0)
    y, x = np.indices(drawn.shape)
    r = np.hypot(y - middle[0], x - middle[1]) / radius
    meshes = rigid_meshes(bearing)
    outer, inner = (np.hypot(*meshes[name].points[:, [0, 2]].T) for name in ("ground", "bearing inner ring"))
    assert not drawn[r < 0.97 * inner.min() / outer.max()].any() and drawn[(r > 0.97) & (r < 0.99)].all()
    balls = {name: picture.points for name, picture in meshes.items() if "ball" in name}
    assert len(balls) == 7


@pytest.mark.parametrize("view", list(VIEWS))
def test_views_look_from_where_they_say(stone: Result, view: str) -> None:
    axes = ScenePicture(stone, "displacement", np.array([0]), factor=None, what="test", view=view).axes
    right, up, eye = axes
    assert axes @ axes.T == pytest.approx(np.eye(3)) and np.cross(right, up) == pytest.approx(eye)
    expected = {"front": [0, -1, 0], "side": [1, 0, 0], "top": [0, 0, 1], "iso": np.array([1, -1, 1]) / np.sqrt(3.0)}
    assert eye == pytest.approx(np.array(expected[view], dtype=float)) and up[1 if view == "top" else 2] > 0.5


def test_a_close_up_is_of_the_patch_to_scale(result: Result) -> None:
    """Its middle is the patch, and the pressure is seen there though it lies between the bodies."""
    picture, seen = picture_of(result, "pressure", view="lower-upper")
    contact, last = result.contact("lower-upper"), len(result.time) - 1
    assert picture.factor == 1.0
    reach = 0.5 * (picture.high - picture.low)
    turned = np.abs(picture.axes[:2]).sum(axis=1)  # a cube seen from an angle
    assert reach == pytest.approx(PATCH * contact.half_width.max() * turned, rel=0.2)
    pose = Pose.of(result.history.bodies, "lower", last)
    surface = contact.view.first
    theta, z = contact.patch_center[last]
    place = pose.to_world(surface.shape.point(theta + grid_theta_offset(surface), z).reshape(1, 3))[0]
    assert 0.5 * (picture.high + picture.low) == pytest.approx(picture.axes[:2] @ place, abs=1e-6)
    colored = np.ptp(seen[120:600], axis=2) > 4 * SHADES  # greys are bodies
    assert 5e-4 < colored.mean() < 0.5
    _, bare = picture_of(result, view="lower-upper", factor=1.0)
    assert np.any(seen[120:600] != bare[120:600])


def test_a_dark_picture_has_the_same_bodies_on_dark_paper(stone: Result) -> None:
    _, light = picture_of(stone)
    _, dark = picture_of(stone, theme="dark")
    body = np.any(light[60:] != 255, axis=2)
    inner = body & np.roll(body, 3, 0) & np.roll(body, -3, 0) & np.roll(body, 3, 1) & np.roll(body, -3, 1)
    assert inner.any() and np.array_equal(light[60:][inner], dark[60:][inner])
    assert np.abs(dark[60:][~body] - np.round(255 * PAPER)).max() <= 1


def test_print_and_vector_formats(stone: Result, tmp_path: Path) -> None:
    for ending in (".pdf", ".svg"):
        path = stone.picture(tmp_path / f"stone{ending}", width=0.09, theme="dark")
        assert path.stat().st_size > 1000
    assert 'width="255.118' in (tmp_path / "stone.svg").read_text()  # points


@pytest.mark.parametrize("field", ["displacement", "pressure"])
def test_three_frames_of_two_rollers(result: Result, tmp_path: Path, field: str) -> None:
    frames = frames_of(result.animate(tmp_path / "run.gif", field, every=4, progress=False))
    assert len(frames) == 3
    rows = np.array([0, 4, 8])
    picture = ScenePicture(result, field, rows, factor=None, what="test")
    figure = picture.figure()
    picture.draw(figure, 4)
    figure.canvas.draw()
    drawn = np.asarray(figure.canvas.buffer_rgba())[..., :3].astype(int)
    off = np.abs(frames[1] - drawn)
    assert np.quantile(off, 0.999) < SHADES and off.mean() < 1.0  # 256 colours of the frame's own
    for before, after in zip(frames, frames[1:], strict=False):
        changed = np.abs(after - before).max(axis=2)
        assert np.count_nonzero(changed[100:620] > SHADES) > 100  # below the words, above the colours


def test_a_picture_is_the_frame_of_its_time(result: Result, tmp_path: Path) -> None:
    times = result.time
    path = result.picture(tmp_path / "half.png", "pressure", time=0.4 * times[4] + 0.6 * times[5])
    picture = ScenePicture(result, "pressure", np.array([5]), factor=None, what="test")
    figure = picture.figure()
    picture.draw(figure, 5)
    figure.canvas.draw()
    assert np.array_equal(pixels(Image.open(path)), np.asarray(figure.canvas.buffer_rgba())[..., :3])
    assert isinstance(picture.scale, ColorScale)
    assert picture.scale.top == pytest.approx(max(s.pressure(5).max() for s in result.skins().values()), rel=1e-6)


def test_memory_does_not_grow_with_the_number_of_frames(stone: Result, result: Result, tmp_path: Path) -> None:
    """Of what Python and NumPy allocate: more frames, the same peak but for what a step leaves in lists."""
    peaks = []
    result.animate(tmp_path / "warm.gif", every=8, progress=False)  # imports and caches
    for every in (8, 2):  # 2 frames and 5
        tracemalloc.start()
        result.animate(tmp_path / f"{every}.gif", every=every, progress=False)
        result.to_vtkhdf(tmp_path / f"{every}.vtkhdf", stride=every, progress=False)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    frame = 960 * 720 * 3
    assert peaks[1] - peaks[0] < frame  # of three more


def test_an_interrupted_animation_leaves_no_file(
    result: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    draw = ScenePicture.draw

    def interrupted(self: ScenePicture, figure: object, i: int) -> None:
        if i > 3:
            raise KeyboardInterrupt
        draw(self, figure, i)

    monkeypatch.setattr(ScenePicture, "draw", interrupted)
    with pytest.raises(KeyboardInterrupt):
        result.animate(tmp_path / "run.gif", every=3, progress=False)
    assert not list(tmp_path.iterdir())


def test_what_is_refused(result: Result, stone: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    gif = tmp_path / "run.gif"
    for call, error in (
        (lambda: result.animate(tmp_path / "run.avi"), r"must end in .gif or .mp4"),
        (lambda: result.animate(gif, every=0), "every"),
        (lambda: result.animate(gif, fps=0.0), "fps"),
        (lambda: result.animate(gif, "presure"), "did you mean 'pressure'"),
        (lambda: result.picture(tmp_path / "a.png", "von_mises"), r"no stress on its skin; reduce\("),
        (lambda: result.picture(tmp_path / "a.png", time=1.0), "the run has 0 to 0.02 s"),
        (lambda: result.picture(tmp_path / "a.png", deformation_factor=-1.0), "deformation_factor"),
        (lambda: result.picture(tmp_path / "a.gif"), "must end in .png"),
        (lambda: result.picture(tmp_path / "a.png", view="frnt"), "view 'frnt' does not exist; did you mean 'front'"),
        (lambda: result.animate(gif, view="lower-uper"), "did you mean 'lower-upper'"),
        (lambda: result.picture(tmp_path / "a.png", theme="drak"), "did you mean 'dark'"),
        (lambda: result.picture(tmp_path / "a.png", width=0.0), "width"),
        (lambda: stone.picture(tmp_path / "a.png", "pressure"), "does not exist"),
    ):
        with pytest.raises(InputError, match=error):
            call()
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(InputError, match="install it .*ffmpeg.*, or write a .gif"):
        result.animate(tmp_path / "run.mp4")
    assert "ffmpeg" in NEEDS_FFMPEG and not list(tmp_path.iterdir())


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="needs the program ffmpeg")
def test_a_film(result: Result, tmp_path: Path) -> None:
    """As many frames as rows, said by ffmpeg itself."""
    import subprocess

    path = result.animate(tmp_path / "run.mp4", every=4, progress=False)
    command = ["ffmpeg", "-v", "error", "-stats", "-i", str(path), "-map", "0:v", "-f", "null", "-"]
    said = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60).stderr
    assert "frame=    3" in said
    assert b"written by warpffrf" in path.read_bytes()
    with pytest.raises(InputError, match="exists"):
        result.animate(path, every=4, progress=False)
    result.animate(path, every=8, overwrite=True, progress=False)


@pytest.mark.parametrize("points", [40, 200, 10**9])
def test_fewer_points_show_the_same_peak(result: Result, points: int) -> None:
    """The patch is narrower than the distance of the points that are kept of a fine mesh."""
    reference = Reference(result.view.bodies, result.history.bodies, None, "test")
    for skin in result.skins().values():
        shown, last = ShownSkin(skin, points, reference), len(result.time) - 1
        peak = skin.field("pressure", last).max()
        assert peak > 0.0 and shown.values("pressure", last).max() == peak
        assert points < len(skin.points) or np.array_equal(shown.values("pressure", last), skin.field("pressure", last))
