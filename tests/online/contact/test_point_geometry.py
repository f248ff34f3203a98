"""Weak gaps, areas, wrenches and stencils of pairs of any shape against plain NumPy, in random poses."""

from __future__ import annotations

import functools
import sys
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import Any

import numpy as np
import pytest

from warpffrf.model import rotation as rot
from warpffrf.model import surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.scene import Scene
from warpffrf.online import Engine, Settings
from warpffrf_kernels.core import control as k

sys.path.insert(0, str(FilePath(__file__).parents[1]))
from made_bodies import MODES, made_body
from reference_contact import Pose
from reference_points import point_problem, surface_point

SETTINGS = Settings(window_strain=0.5, force_points=True)
UP, ALONG = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)
DEPTH = 300e-6  # m: nodes of a ball average over some millimetres, and are to overlap too
NO_TORQUE = 1e-12  # of force times radius: round-off of positions of 0.1 m
AGREE = 1e-12  # of the largest entry: sums of a hundred terms, positions of 0.1 m


def unit(q: Any) -> np.ndarray:
    """`q` at length one."""
    return np.asarray(q, float) / np.linalg.norm(q)


def of_revolution(kind: Any, radius: float, **others: Any) -> Any:
    return kind(radius=radius, axis_point=(0.003, -0.002, 0.001), axis_direction=ALONG, **others)


PLANE = surfaces.Plane(origin=(0.01, 0.0, 0.02), outward=UP, direction=ALONG)
SHAPES = {
    "roller": of_revolution(surfaces.Cylinder, 0.05),
    "shaft": of_revolution(surfaces.Cylinder, 0.035),
    "barrel": of_revolution(surfaces.CrownedCylinder, 0.04, crown_radius=0.3),
    "ball": of_revolution(surfaces.Sphere, 0.03),
    "bead": of_revolution(surfaces.Sphere, 0.003),
    "cone": of_revolution(surfaces.Cone, 0.04, half_angle=0.3),
    "bore": of_revolution(surfaces.Bore, 0.052),
    "cup": of_revolution(surfaces.Cup, 0.031),
    "groove": of_revolution(surfaces.Groove, 0.04, groove_radius=0.034),
    "ring": of_revolution(surfaces.Ring, 0.09, groove_radius=0.034),
    "plane": PLANE,
}


@dataclass(frozen=True)
class Case:
    first: str
    second: str
    rigid: bool = False
    skew: float = 0.004  # rad, turn of B about the common normal
    tilt: float = 0.003  # rad
    arcs: bool = False  # grids on arcs
    place: float = 0.0  # m, z on both surfaces where they meet


CASES = {
    "roller on a rigid plane": Case("roller", "plane", rigid=True),
    "roller on a plane": Case("roller", "plane"),
    "roller on a roller, crossed": Case("roller", "shaft", skew=1.2),
    "barrel on a shaft": Case("barrel", "shaft"),
    "ball on a plane": Case("ball", "plane", skew=0.7),
    "ball on a rigid plane": Case("ball", "plane", rigid=True, skew=0.7, place=0.002),
    "roller on a rigid bead": Case("roller", "bead", rigid=True),
    "plane under a ball": Case("plane", "ball", skew=0.4),
    "plane under a rigid ball": Case("plane", "ball", rigid=True),
    "plane on a rigid plane": Case("plane", "plane", rigid=True, tilt=1e-4),
    "plane on a plane": Case("plane", "plane", tilt=1e-4, skew=0.3),
    "cone on a rigid plane": Case("cone", "plane", rigid=True),
    "cone on a plane": Case("cone", "plane"),
    "pin in a bore": Case("roller", "bore"),
    "pin in a rigid bore": Case("roller", "bore", rigid=True),
    "bore around a pin": Case("bore", "roller"),
    "bore around a rigid pin": Case("bore", "roller", rigid=True),
    "ball in a cup": Case("ball", "cup", skew=0.2),
    "ball in a ring": Case("ball", "ring"),
    "ring around a ball": Case("ring", "ball"),
    "ball on a grooved shaft": Case("ball", "groove"),
    "roller that runs off a plane": Case("roller", "plane", arcs=True, place=0.006),
}


def flexible(name: str, case: Case, seed: int) -> Any:
    """A made-up body; grids of the first and the second never match."""
    shape, first = SHAPES[name], seed == 1
    z = np.linspace(-1.0, 1.0, 6 if first else 7) * (0.0081 if first else 0.009)
    if name == "plane":
        return made_body(shape, z, pitch=0.0017 if first else 0.0021, columns=15 if first else 13, seed=seed)
    columns = 120 if first else 96
    if case.arcs:
        return made_body(shape, z, pitch=2.0 * np.pi / columns, columns=9, seed=seed)
    return made_body(shape, z, pitch=0.0, columns=columns, periodic=True, seed=seed)


def frame_at(shape: Any, grid: Any, theta: float, z: float) -> tuple[np.ndarray, np.ndarray]:
    """Point, and columns t_z, n x t_z, n there."""
    x, n, *_ = surface_point(shape, grid, theta, z)
    step = 1e-6
    t = surface_point(shape, grid, theta, z + step)[0] - surface_point(shape, grid, theta, z - step)[0]
    t /= np.linalg.norm(t)
    return x, np.stack([t, np.cross(n, t), n], axis=1)


def touching(case: Case, column: float | None = None, depth: float = DEPTH) -> Scene:
    """The two in contact, `depth` deep, at a grid column of the first (near the middle of the grid, between two
    columns); anywhere in the world."""
    scene = Scene()
    turn = unit((0.3, -0.2, 0.5, 0.7))
    body = scene.add_body(flexible(case.first, case, 1), name="A", position=(0.11, -0.07, 0.05), rotation=turn)
    other: Any = None
    if case.rigid:
        other = scene.add_rigid_body(1.0, (0.01, 0.01, 0.01), name="B", surfaces={"face": SHAPES[case.second]})
    else:
        other = scene.add_body(flexible(case.second, case, 2), name="B")
    grid = body["face"].surface.grid
    around = grid.theta_start + (0.5 * (grid.columns - 1) + 0.37 if column is None else column) * grid.pitch
    x_a, F_a = frame_at(SHAPES[case.first], grid, around, case.place)
    shape = SHAPES[case.second]
    grid_b = other["face"].surface.grid
    at_b = 0.0 if grid_b is None else grid_b.theta_start + (0.5 * (grid_b.columns - 1) - 0.21) * grid_b.pitch

    class Rigid:
        e_0 = shape.e_0

    x_b, F_b = frame_at(shape, grid_b if grid_b is not None else Rigid, at_b, -case.place)
    c, s = np.cos(case.skew), np.sin(case.skew)
    onto = F_a @ np.array([[c, s, 0.0], [s, -c, 0.0], [0.0, 0.0, -1.0]])  # normals oppose each other
    tilt = rot.matrix(unit((0.5 * case.tilt, 0.3 * case.tilt, 0.0, 1.0)))
    R = rot.matrix(body.rotation) @ onto @ tilt @ F_b.T
    other.rotation = rot.quaternion(R)
    overlap = depth * rot.matrix(body.rotation) @ F_a[:, 2]
    other.position = body.to_world(x_a) - overlap - R @ x_b
    scene.add(Contact(body["face"], other["face"], name="pair", overlap=1.0))
    return scene


@functools.cache
def evaluated(name: str) -> tuple[Scene, Engine]:
    """A case's scene, and an engine whose contact arrays are those of its initial pose."""
    scene = touching(CASES[name])
    engine = Engine(scene, settings=SETTINGS)
    engine.control(mode=int(k.STATIC), run=1, moved=1, reassemble=1, refresh=1, iteration=0)
    engine.clock(user_step=1.0, h=1.0)
    engine.graph.evaluate()
    return scene, engine


@pytest.mark.parametrize("name", list(CASES))
def test_fields_of_a_pose(name: str) -> None:
    case = CASES[name]
    scene, engine = evaluated(name)
    assert engine.word("failure")[0] == 0
    m, work = engine.compiled.model, engine.scratch
    A, B = scene.bodies
    first, second = A["face"].surface, B["face"].surface
    rows_a = first.grid.rows
    center, window = work.center.numpy()[0, 0], work.window.numpy()[0, 0]
    columns = center[0] + np.arange(window[0], window[1] + 1)
    poses = [Pose(b.position, rot.matrix(b.rotation), np.zeros(MODES)) for b in (A, B)]
    place = work.nearest.numpy()[0, 0]
    problem = point_problem(first, second, poses[0], poses[1], columns, place, theta_points=3, z_points=2)
    at = slice((window[0] + m.window.half) * rows_a, (window[1] + m.window.half + 1) * rows_a)
    found = {key: getattr(work, key).numpy()[0, 0, at] for key in ("shifted_gap", "area", "wrench", "stencil")}
    used = found["area"] > 0.0
    assert np.array_equal(used, problem.area > 0.0) and used.sum() >= 6
    scale = problem.area.max()
    assert np.abs(found["area"] - problem.area).max() < AGREE * scale
    assert np.abs(found["shifted_gap"] - problem.gap)[used].max() < AGREE * scale * 1e-3  # of gaps of a millimetre
    wrench = found["wrench"] + work.more_wrench.numpy()[0, 0, at]
    # moments about the user origin
    arm = poses[0].rotation @ A.center_of_mass
    moment = wrench[:, 3:] + np.cross(arm, wrench[:, :3])
    assert np.abs(wrench[:, :3] - problem.wrench[:, :3])[used].max() < AGREE * scale
    assert np.abs(moment - problem.wrench[:, 3:])[used].max() < AGREE * scale
    if case.rigid:
        assert not np.any(found["stencil"])
        return
    stencil_at = work.stencil_at.numpy()[0, 0, at]
    load = np.zeros_like(problem.load)
    gb = second.grid
    for i in np.flatnonzero(used):
        weights = found["stencil"][i].reshape(m.window.stencil_columns, m.window.stencil_rows)
        for c, r in np.argwhere(weights):
            column = center[1] - m.window.second_half + stencil_at[i, 0] + c
            column = column % gb.columns if gb.periodic else column
            if 0 <= column < gb.columns:
                load[i, column * gb.rows + stencil_at[i, 1] + r] += weights[c, r]
    assert np.abs(load - problem.load)[used].max() < AGREE * scale


@pytest.mark.parametrize("name", list(CASES))
def test_the_nearest_place_is_found(name: str) -> None:
    """No column of the section looked at has a smaller gap; the recorded gap is the smallest of the whole grid."""
    scene, engine = evaluated(name)
    engine.save_now()
    A, B = scene.bodies
    first, second = A["face"].surface, B["face"].surface
    x, z = engine.scratch.nearest.numpy()[0, 0]
    g = first.grid

    def gap(column: float, at: float) -> float:
        point = A.to_world(surface_point(first.shape, g, g.theta_start + column * g.pitch, at)[0])
        return float(second.shape.chart(B.to_user(point))[2])

    span = np.linspace(-3.0, 3.0, 61)
    if not g.periodic:
        span = span[(x + span >= 0.0) & (x + span <= g.columns - 1)]
    assert gap(x, z) <= min(gap(x + s, z) for s in span.tolist()) + 1e-13
    everywhere = [gap(c, at) for c in np.clip(x + span, 0, None) for at in np.linspace(g.z[0], g.z[-1], 41)]
    smallest = engine.scratch.station.numpy()[0, 0, 0, 0]
    assert smallest <= min(everywhere) + 1e-11
    assert smallest == pytest.approx(min(everywhere), abs=2e-6)
    assert smallest <= -DEPTH + 1e-11


APART = 1e-6  # m
SIDES = 7  # columns on the first grid, most of them two columns from the nearest of the angles first looked at


@pytest.mark.parametrize("name", list(CASES))
def test_a_pair_that_is_open_is_looked_for_where_it_is_nearest(name: str) -> None:
    """At any angle, nothing active: the window's middle is the nearest place of the whole grid, to a column."""
    case = CASES[name]
    scene, engine = evaluated.__wrapped__(name)  # one of its own, since poses change
    grid = scene.bodies[0]["face"].surface.grid
    poses = {key: getattr(engine.state, key).numpy().copy() for key in ("r", "p")}
    inside = 0.0 if grid.periodic else 3.0  # columns from the ends of an arc
    for column in np.linspace(inside, grid.columns - 1 - inside, SIDES) + (1.79 if grid.periodic else 0.0):
        placed = touching(case, float(column), -APART)
        A, B = placed.bodies
        poses["r"][0] = [A.to_world(A.center_of_mass), B.to_world(B.center_of_mass)]
        poses["p"][0] = [A.rotation, B.rotation]
        for key, array in poses.items():
            getattr(engine.state, key).assign(array)
        engine.state.active.zero_()
        engine.control(mode=int(k.STATIC), run=1, moved=1, reassemble=1, refresh=1, iteration=0, failure=0)
        engine.graph.evaluate()
        center, window = engine.scratch.center.numpy()[0, 0, 0], engine.scratch.window.numpy()[0, 0]
        theta = grid.theta_start + np.arange(grid.columns) * grid.pitch
        sections = np.linspace(grid.z[0], grid.z[-1], 17)
        points = np.array([surface_point(SHAPES[case.first], grid, t, z)[0] for t in theta for z in sections])
        gaps = SHAPES[case.second].chart(B.to_user(A.to_world(points)))[2].reshape(grid.columns, -1).min(axis=1)
        nearest = engine.scratch.nearest.numpy()[0, 0, 0]
        away = np.abs(nearest - np.arange(grid.columns))
        if grid.periodic:
            away = np.minimum(away % grid.columns, -away % grid.columns)
        assert gaps[away <= 1.0].min() <= gaps.min() + 1e-12  # round-off of a place between two columns
        assert window[0] + center <= nearest <= window[1] + center
        if grid.periodic:  # the window of a short arc is that of the arc
            assert abs(0.5 * (window[0] + window[1]) + center - nearest) <= 1.0


@pytest.mark.parametrize("name", list(CASES))
def test_no_pressure_turns_a_body_about_its_own_axle(name: str) -> None:
    """Of every node by itself, on and off the line of centres: the wrench has no moment about either body's axis, of a
    ball none about its centre."""
    case = CASES[name]
    scene, engine = evaluated(name)
    A, B = scene.bodies
    m, work = engine.compiled.model, engine.scratch
    rows, window = A["face"].surface.grid.rows, work.window.numpy()[0, 0]
    at = slice((window[0] + m.window.half) * rows, (window[1] + m.window.half + 1) * rows)
    wrench = work.wrench.numpy()[0, 0, at] + work.more_wrench.numpy()[0, 0, at]
    wrench = wrench[work.area.numpy()[0, 0, at] > 0.0]
    origin = A.to_world(A.center_of_mass)
    largest = np.linalg.norm(wrench[:, :3], axis=1).max()
    for body, shape in ((A, SHAPES[case.first]), (B, SHAPES[case.second])):
        profile = shape.profile()
        if profile.planar:
            continue
        center = body.to_world(shape.axis_point)
        moment = wrench[:, 3:] + np.cross(origin - center, wrench[:, :3])
        axes = np.eye(3) if isinstance(shape, surfaces.Sphere | surfaces.Cup) else np.atleast_2d(shape.e_a)
        about = moment @ (rot.matrix(body.rotation) @ axes.T)
        assert np.abs(about).max() < NO_TORQUE * largest * profile.radius
