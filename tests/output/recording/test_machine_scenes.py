"""Load zones, orbits and films of a recording; magnification that keeps surfaces apart; arrangement and speed."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from recordings import columns
from shape_runs import grid_of, still

import warpffrf as wf
from warpffrf.model.surfaces import Bore, Cylinder
from warpffrf.output.recording import recorder as recorder_module
from warpffrf.output.recording.extent import HALF_FIELD, distance, extent, length_text, round_length, seen_along
from warpffrf.output.recording.film_scene import LIFTED, MAP_SHAPE, FilmScene, _sorted
from warpffrf.output.recording.frames import BodyFrames
from warpffrf.output.recording.glyphs import joined
from warpffrf.output.recording.layout import MOST_PANELS, MOST_SECONDS, RUN_SECONDS, TURN_SECONDS, _emptiest, _speed
from warpffrf.output.recording.magnification import largest_factor
from warpffrf.output.recording.rigid_bodies import RigidBodies

R = 0.05
AXIS: dict[str, Any] = {"axis_point": (0.0, 0.0, 0.0), "axis_direction": (0.0, 1.0, 0.0)}
SINGLE = 1e-6  # relative: recordings are single precision
LOAD = 3000.0  # N


@pytest.fixture(scope="module")
def bearing() -> wf.Result:
    """A ball bearing at rest on the ground, loaded along -z, whose first ball is under the load."""
    scene = wf.Scene()
    geometry = wf.bearings.BallGeometry(elements=8, ball_diameter=0.01, pitch_diameter=0.06)
    made = scene.add_bearing("b", geometry, first=(0, 0, -1), outer=scene.ground)
    ring: Any = made.inner
    scene.add(wf.joints.Planar(scene.ground.at((0, 0, 0)), ring, axis=(0, 1, 0), name="plane"))
    scene.add(wf.forces.PointForce(ring, (0, 0, -LOAD), name="load"))
    scene.add(wf.joints.Drive(scene.joint("plane"), 0.0))
    return wf.equilibrium(scene, progress=False)


def test_a_load_zone_has_the_loads_in_their_directions(bearing: wf.Result, tmp_path: Path) -> None:
    info = wf.record(bearing, tmp_path / "run.rrd")
    spokes = np.array(columns(info.path, "/load_zones/b/loads", "LineStrips2D:strips")[-1])
    load = bearing.bearing("b").outer_load[-1]
    assert np.linalg.norm(spokes[:, 1], axis=1) == pytest.approx(load / load.max(), abs=SINGLE)
    # the picture's y axis points downwards: the ball under the load is at the bottom, where it is in the machine
    assert spokes[0, 1] == pytest.approx([0.0, 1.0], abs=1e-3)
    assert "b inner 1" not in str(columns(info.path, "/world/lumped_arrows/**", "Arrows3D:vectors"))
    colors = np.array(columns(info.path, r"/world/b\ ball\ 1/solid", "Mesh3D:vertex_colors")[-1], dtype=np.uint32)
    unloaded = np.array(columns(info.path, r"/world/b\ ball\ 5/solid", "Mesh3D:vertex_colors")[-1], dtype=np.uint32)
    assert colors.max() >> 24 < unloaded.max() >> 24  # dark red, and light grey


def test_at_most_six_views_at_first_sight(bearing: wf.Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import rerun.blueprint as rrb

    kept, made = [], recorder_module.blueprint

    def keep(recorder: Any) -> Any:
        kept.append(made(recorder))
        return kept[-1]

    monkeypatch.setattr(recorder_module, "blueprint", keep)
    wf.record(bearing, tmp_path / "run.rrd")

    def count(part: Any) -> int:
        if isinstance(part, rrb.Tabs) or not isinstance(part, rrb.Container):
            return 1
        return sum(count(inner) for inner in part.contents)

    first = kept[0].root_container.contents[0]
    assert first.name == "Bearing" and 2 <= count(first) <= MOST_PANELS


def film_of(columns_: int, rows: int) -> tuple[FilmScene, dict[str, np.ndarray]]:
    shape = Bore(radius=R, **AXIS)
    z = np.linspace(-0.01, 0.01, rows)
    grid = replace(grid_of(shape, 2.0 * np.pi / columns_, columns_, z), periodic=True)
    surface = SimpleNamespace(shape=shape, grid=grid)
    theta = grid.theta_start + grid.pitch * np.arange(columns_)
    values = 2.0 + np.cos(theta - 1.0)[:, None] * (1.0 + 10.0 * z)
    first = SimpleNamespace(name="sleeve")
    view = SimpleNamespace(first=surface, first_body=first, second_body=SimpleNamespace(name="shaft"))
    result = SimpleNamespace(
        view=SimpleNamespace(films={"f": view}), history=SimpleNamespace(films={"f": SimpleNamespace()})
    )
    return FilmScene(SimpleNamespace(result=result), "f"), {"theta": theta, "z": z, "values": values}


def test_a_film_lies_on_its_surface_and_is_unwrapped_from_minus_to_plus_pi() -> None:
    scene, given = film_of(72, 5)
    points = scene.points.reshape(-1, 3)
    assert np.hypot(points[:, 0], points[:, 2]) == pytest.approx(R + LIFTED * scene.size, rel=1e-12)
    assert np.ptp(points[:, 1]) == pytest.approx(0.02, rel=1e-12)
    scene.right, scene.order = _sorted(scene.theta, False)
    picture = scene._picture(given["values"][scene.columns])
    x = np.linspace(scene.right[0], scene.right[-1], MAP_SHAPE[1])
    z = np.linspace(0.01, -0.01, MAP_SHAPE[0])[:, None]
    exact = 2.0 + np.cos(x - 1.0) * (1.0 + 10.0 * z)
    assert picture == pytest.approx(exact, abs=1.1 * (2.0 * np.pi / 72) ** 2 / 8.0 * 1.1)  # of linear interpolation
    assert scene.right[0] == pytest.approx(-np.pi, abs=2.0 * np.pi / 72) and np.ptp(scene.right) == pytest.approx(
        2.0 * np.pi
    )


def test_magnification_ends_where_surfaces_would_meet() -> None:
    """A shaft in a bore with the clearance c: a node that the load moves by 0.4 c outwards meets it at the factor 2.5,
    one that moves inwards never."""
    c, columns_ = 1e-4, 24
    shape = Cylinder(radius=R, **AXIS)
    grid = grid_of(shape, 2.0 * np.pi / columns_, columns_, np.linspace(-0.01, 0.01, 3))
    grid = replace(grid, periodic=True)
    theta = np.linspace(0.0, 2.0 * np.pi, columns_, endpoint=False)
    points, outwards = shape.point(theta, 0.0), shape.normal(theta, 0.0)
    met = SimpleNamespace(
        first_body=SimpleNamespace(name="shaft"), second_body=SimpleNamespace(name="ground"),
        first=SimpleNamespace(shape=shape, grid=grid), second=SimpleNamespace(shape=Bore(radius=R + c, **AXIS)),
    )  # fmt: skip
    result = SimpleNamespace(
        view=SimpleNamespace(pairs={}, films={"f": met}), history=SimpleNamespace(bodies={"shaft": still()})
    )

    def limit(share: float, carried: float = 0.0) -> float:
        u = np.zeros((1, columns_, 3))
        u[0, 7] = share * c * outwards[7]
        body = BodyFrames(points, np.zeros((0, 3), dtype=int), u, carried * c * outwards[None], 0.0, np.arange(0))
        return largest_factor(result, {"shaft": body}, np.array([0]), np.array([0]))

    assert limit(0.4) == pytest.approx(2.5, rel=1e-9)
    assert limit(-0.4) == np.inf
    assert limit(0.4, carried=0.2) == pytest.approx(2.0, rel=1e-9)  # what the reference takes of the clearance


def test_the_time_is_shown_so_slowly_that_turns_can_be_followed() -> None:
    def screen_seconds(turns: float, duration: float) -> float:
        time = np.linspace(0.0, duration, 11)
        omega = np.zeros((11, 3))
        omega[:, 1] = 2.0 * np.pi * turns / duration
        bodies = {"shaft": SimpleNamespace(angular_velocity=omega)}
        return duration / _speed(SimpleNamespace(time=time, history=SimpleNamespace(bodies=bodies)))

    assert screen_seconds(1.0, 0.02) == pytest.approx(RUN_SECONDS)
    assert screen_seconds(8.0, 0.02) == pytest.approx(8.0 * TURN_SECONDS)
    assert screen_seconds(1e3, 7.0) == pytest.approx(MOST_SECONDS)


def test_a_legend_stands_where_no_curve_is() -> None:
    import rerun.blueprint as rrb

    x = np.linspace(0.0, 1.0, 101)
    assert _emptiest([x, x**2 + 0.3 * x]) in (rrb.Corner2D.LeftTop, rrb.Corner2D.RightBottom)
    assert _emptiest([np.where(x > 0.5, 0.0, 1.0), np.zeros(101)]) == rrb.Corner2D.RightTop


def test_labels_that_would_cover_each_other_are_one() -> None:
    places = [np.array([x, 0.0, 0.0]) for x in (0.0, 0.5, 0.05, 0.45, 0.0)]
    assert joined(["a", "b", "c", "", "d"], places, 0.1) == ["a\nc\nd", "b", "", "", ""]


def test_lengths_are_round_and_have_units() -> None:
    assert [round_length(v) for v in (1.0, 0.0199, 0.02, 7e-6)] == pytest.approx([1.0, 0.01, 0.02, 5e-6])
    assert [length_text(v) for v in (2.0, 0.05, 5e-6)] == ["2 m", "50 mm", "5 µm"]


def test_directions_of_a_picture_along_an_axis() -> None:
    for axis in np.vstack([np.eye(3), -np.eye(3), [[0.6, 0.8, 0.0]]]):
        right, up = seen_along(axis)
        assert np.abs(np.cross(right, up) @ axis) == pytest.approx(1.0)
        assert up[2] >= -1e-12 or abs(axis[2]) > 0.9
    assert seen_along(np.array([0.0, 1.0, 0.0]))[0] == pytest.approx([1.0, 0.0, 0.0])


def test_the_view_contains_all_bodies(bearing: wf.Result) -> None:
    of: Any = SimpleNamespace(result=bearing, rows=np.array([0]), good=np.array([True]), bodies={})
    of.rigid = RigidBodies(of)
    middle, points = extent(of)
    ring = of.rigid.meshes["ground"].points - middle
    radius = np.linalg.norm(ring, axis=1).max()
    assert np.linalg.norm(points, axis=1).max() == pytest.approx(radius, rel=0.02)
    for towards, aspect in ((np.array([0.1, -1.0, 0.2]), 1.0), (np.array([1.0, -1.0, 1.0]), 1.6)):
        depth = towards / np.linalg.norm(towards)
        right = np.cross([0.0, 0.0, 1.0], depth)
        right /= np.linalg.norm(right)
        away = distance(points, towards, np.array([0.0, 0.0, 1.0]), aspect) - ring @ depth  # of points from the eye
        seen = np.stack([ring @ right / aspect, ring @ np.cross(depth, right)]) / away
        assert 0.97 * HALF_FIELD < np.abs(seen).max() < 1.03 * HALF_FIELD
