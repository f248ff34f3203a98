"""Results of pairs whose pressure stands on cells that travel with the patch: moments, loads on bodies, stress, files,
pictures.

The run is two equal rollers that roll on each other, with a patch of 0.44 mm half-width under nodes 4 mm apart.
"""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from recordings import columns

import warpffrf as wf
from references.closed_forms import LineContact
from references.pressure_wrench import pressure_wrench
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.reduced.stress_field import rotated, to_tensor
from warpffrf.model.surfaces import Cylinder, Sphere
from warpffrf.offline import ContactGrid, reduce
from warpffrf.online.history.history import CellHistory
from warpffrf.output.bodies.half_space_stress import under_cells, under_nodes
from warpffrf.output.bodies.normal_loads import CellLoads, normal_loads
from warpffrf.output.contact.cell_result import CellContactResult
from warpffrf.output.recording import frames as fr
from warpffrf.output.recording.patch_map import map_window, pressure_map
from warpffrf.output.recording.recorder import record
from warpffrf.output.result import Result

STEEL = wf.Material(210e9, 0.3, 7800.0)
R, BORE, WIDTH, SECTORS, APPROACH = 0.05, 0.015, 0.02, 79, 19.74e-6
PAIR = "lower-upper"
DEPTH = np.linspace(0.02, 3.0, 40) * 0.44e-3  # m
# p0: sigma across and into the depth (`patch_stress`); what is left of the axial stress where Hertz is plane strain
IN_PLANE, AXIAL = 0.015, 0.025
MISES, MISES_DEPTH = 0.02, 0.02  # relative
WRENCH = 1e-5  # relative: normals of the true surface here, of the pair's frame in the simulation


@pytest.fixture(scope="module")
def body() -> Any:
    mesh = wf.mesh.roller(R, BORE, WIDTH, sectors=SECTORS, layers=7, axial=5, order=1)
    top = np.outer(R - DEPTH, [0.0, 0.0, 1.0])
    across = R * np.stack([np.sin([0.0, 0.004, -0.004]), [0.0, 0.0, 0.0], np.cos([0.0, 0.004, -0.004])], axis=1)
    stress = {"top": top, "below": -top, "surface": across, "opposite": -across}
    return reduce(
        mesh, STEEL, interfaces={"bore": "rigid"}, contact={"rim": Cylinder()}, max_frequency=10e3,
        grid=ContactGrid(contact_fixed=True), stress=stress, progress=False,
    )  # fmt: skip


@pytest.fixture(scope="module")
def result(body: Any) -> Result:
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    lower = scene.add_body(body, name="lower")
    upper = scene.add_body(body, name="upper", position=(0.0, 0.0, 2.0 * R - 2.0 * 0.5 * APPROACH))
    for roller, speed in ((lower, 20.0), (upper, -20.0)):
        joint = scene.add(wf.joints.Revolute(scene.ground, roller["bore"], axis=(0.0, 1.0, 0.0)))
        scene.add(wf.joints.Drive(joint, wf.signals.Ramp(0.0, speed, duration=0.001), quantity="velocity"))
    scene.add(wf.Contact(lower["rim"], upper["rim"], grid="contact_fixed"))
    return wf.simulate(scene, 0.002, step=2e-4, start="equilibrium", progress=False)


# --- moments of a pressure made by hand ---


def made(shape: Any, *, rows: int = 41, strips: int = 61, z0: float = 0.0) -> CellContactResult:
    """A pair with Hertz's elliptical pressure, half-widths 0.4 across and 0.7 mm along, around theta 0.3 and z0."""
    a, b, W = 0.4e-3, 0.7e-3, 0.6e-3
    grid = SurfaceGrid(shape.e_0, 0.0, 0.01, 63, False, np.linspace(-4e-3, 4e-3, 9), 63)
    edges = z0 + 1e-3 * np.linspace(-1.0, 1.0, rows + 1)
    z, length = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    cells = CellHistory(np.array([30.0]), np.array([W]), z[None], length[None], np.array([30.0]), np.zeros((1, len(z))))
    x = 2.0 * W / strips * (np.arange(strips) - 0.5 * (strips - 1))
    bowl = 1.0 - (x[:, None] / a) ** 2 - ((z - z0) / b) ** 2
    pressure = 1e9 * np.sqrt(np.maximum(bowl, 0.0))

    nothing = np.zeros((1, 3))
    history = SimpleNamespace(
        force=nothing, torque=nothing, force_second=nothing, torque_second=nothing, approach=np.zeros(1),
        active_nodes=np.zeros(1), center_column=np.array([29.9]), pressure=pressure[None], cells=cells, friction=None,
    )  # fmt: skip
    surface: Any = SimpleNamespace(shape=shape, grid=grid)
    view: Any = SimpleNamespace(name="a-b", first=surface, second=surface)
    contact = CellContactResult(history, view)
    contact.patch_kind = "point"  # the second surface of the fixture is only a stand-in
    return contact


@pytest.mark.parametrize("shape", [Cylinder, Sphere])
def test_moments_of_an_ellipse(shape: Any) -> None:
    z0 = 1.2e-3
    contact = made(shape(radius=0.02, axis_point=(0, 0, 0), axis_direction=(0, 1, 0)), z0=z0)
    volume = 2.0 / 3.0 * np.pi * 0.4e-3 * 0.7e-3 * 1e9
    slope = np.sqrt(1.0 + float(contact.view.first.shape.slope_at(z0)) ** 2)
    assert contact.normal_load[0] == pytest.approx(volume * slope, rel=2e-3)  # the rim of the patch in cells
    assert contact.half_widths[0] == pytest.approx([0.4e-3, 0.7e-3 * slope], rel=5e-3)
    assert contact.semi_axes[0] == pytest.approx([0.7e-3 * slope, 0.4e-3], rel=5e-3)
    radius = float(contact.view.first.shape.radius_at(z0))
    assert contact.center_of_pressure[0] == pytest.approx([0.1 * 0.01 * radius, z0], rel=1e-3)
    assert contact.peak_pressure[0] == pytest.approx(1e9, rel=1e-3)
    assert contact.patch_area[0] == pytest.approx(np.pi * 0.4e-3 * 0.7e-3 * slope, rel=2e-2)
    # through the middle: an ellipse's line load p0 a pi/2
    assert contact.line_load[0] == pytest.approx(0.5 * np.pi * 0.4e-3 * 1e9, rel=3e-3)


def test_half_width_on_strips() -> None:
    """Hertz's line contact solved on strips of a half-plane, as the cells of a pair are, at the default eleven over 2.6
    half-widths: p > 0 or gap > 0 in their middles."""
    strips, a, load = 11, 1.0, np.pi / 4.0  # E* = R = 1: P' = pi a^2/4
    w = 2.6 * a / strips
    x = w * (np.arange(strips) - 0.5 * (strips - 1))
    d = x[:, None] - x
    before, after = d - 0.5 * w, d + 0.5 * w
    G = (before * np.log(np.abs(before)) - after * np.log(np.abs(after))) * 2.0 / np.pi
    active = np.ones(strips, dtype=bool)
    for _ in range(20):
        n = int(active.sum())
        system = np.block([[G[np.ix_(active, active)], -np.ones((n, 1))], [w * np.ones((1, n)), np.zeros((1, 1))]])
        found = np.linalg.solve(system, np.append(-0.5 * x[active] ** 2, load))
        p = np.zeros(strips)
        p[active] = found[:-1]
        active = np.where(active, p > 0.0, 0.5 * x**2 + G @ p < found[-1])
    assert np.all(p >= 0.0)
    second = (p * x**2).sum() / p.sum()
    assert 2.0 * np.sqrt(second) == pytest.approx(a, rel=0.008)
    assert 2.0 * np.sqrt(second + w**2 / 12.0) > 1.012 * a  # as if it were constant on strips


def test_one_cell_has_the_moments_of_a_line() -> None:
    contact = made(Cylinder(radius=0.02, axis_point=(0, 0, 0), axis_direction=(0, 1, 0)), strips=5, rows=4)
    p = np.zeros_like(contact.history.pressure)
    p[0, 3, 1] = 2e8
    contact.history.pressure = p
    width, length = 1.2e-3 / 5, 0.5e-3
    assert contact.normal_load[0] == pytest.approx(2e8 * width * length, rel=1e-12)
    assert np.diag(contact.moments.covariance[0]) == pytest.approx([0.0, length**2 / 12], rel=1e-9, abs=1e-25)
    assert contact._line.half_width[0] == pytest.approx(0.5 * width, rel=1e-9)  # no patch is narrower than its strip
    assert contact.center[0] == pytest.approx(width + 0.1 * 0.01 * 0.02, rel=1e-9)
    assert contact.patch_area[0] == pytest.approx(width * length, rel=1e-12)
    assert contact.peak_pressure[0] == 2e8  # its neighbours have none: no parabola


@pytest.mark.parametrize("strips", [8, 9, 10, 11])
def test_peak_does_not_depend_on_where_strips_lie(strips: int) -> None:
    contact = made(Cylinder(radius=0.02, axis_point=(0, 0, 0), axis_direction=(0, 1, 0)), strips=strips, rows=31)
    assert contact.peak_pressure[0] == pytest.approx(1e9, rel=5e-3)  # fourth order, over a strip of 0.37 half-widths


@pytest.mark.parametrize("shape", [Cylinder, Sphere])
@pytest.mark.parametrize("strips", [8, 11])
def test_the_peak_is_at_the_middle_of_an_ellipse(shape: Any, strips: int) -> None:
    z0 = 1.2e-3
    contact = made(shape(radius=0.02, axis_point=(0, 0, 0), axis_direction=(0, 1, 0)), strips=strips, rows=30, z0=z0)
    exact = contact.view.first.shape.point(0.3, z0)
    assert contact.peak_position[0] == pytest.approx(exact, abs=1e-9)
    contact.history.pressure = 0.0 * contact.history.pressure
    nothing = CellContactResult(contact.history, contact.view)
    nothing.patch_kind = "point"
    assert np.all(np.isnan(nothing.peak_position))


def test_stress_errors_are_not_known(result: Result) -> None:
    found = result.contact(PAIR).stress_errors(-1)
    assert found and all(np.isnan(one.von_mises) and "cells that travel" in one.reason for one in found.values())


# --- a run ---


def test_forces_are_those_of_the_cells(result: Result) -> None:
    contact = result.contact(PAIR)
    assert isinstance(contact, CellContactResult) and contact.patch_kind == "line"
    force, torque = pressure_wrench(result, PAIR)
    size = contact.force_magnitude.max()
    assert force == pytest.approx(contact.force, abs=WRENCH * size)
    assert torque == pytest.approx(contact.torque, abs=WRENCH * size * R)
    assert contact.normal_load == pytest.approx(contact.force_magnitude, rel=1e-4)  # normals lean by a/R
    assert np.ptp(contact.history.cells.column) > 0.1  # the patch has travelled


def test_compared_with_hertz(result: Result) -> None:
    contact = result.contact(PAIR)
    hertz = contact.hertz(-1)
    assert contact.half_width[-1] == pytest.approx(hertz.half_width, rel=0.02)  # a strip is 0.24 half-widths
    assert contact.mid_peak_pressure[-1] == pytest.approx(hertz.peak_pressure, rel=5e-3)
    patch = contact.pressure(-1)
    assert patch.pressure.shape == (len(patch.arc), len(patch.z))
    assert np.all(np.diff(patch.theta) > 0.0) and patch.arc.mean() == pytest.approx(0.0, abs=1e-7)
    inside = np.abs(patch.arc) < 0.7 * hertz.half_width
    exact = contact.hertz_pressure(-1, patch.arc)
    assert contact.mid_pressure[-1][inside] == pytest.approx(exact[inside], rel=0.02)


def test_node_forces_carry_the_force(result: Result) -> None:
    pair = result.view.pairs[PAIR]
    load = result.contact(PAIR).normal_load[-1]
    for first in (True, False):
        loads = CellLoads(pair, result.history, first=first)
        assert isinstance(normal_loads(pair, result.history, first=first), CellLoads)
        forces = loads.forces(-1)
        assert forces.sum() == pytest.approx(-load, rel=1e-9)
        grid = loads.surface.grid
        middle = float(loads.on_surface(-1, loads.places.center[-1:], loads.places.middle[-1:])[0][0])
        away = (grid.theta - middle + np.pi) % (2.0 * np.pi) - np.pi
        assert forces.sum(axis=1) @ away == pytest.approx(0.0, abs=1e-6 * load)
        assert forces.sum(axis=0) @ np.asarray(grid.z) == pytest.approx(0.0, abs=1e-6 * load)


def test_skins_are_pressed_in(result: Result) -> None:
    contact, skins = result.contact(PAIR), result.skins()
    for name, sign in (("lower", -1.0), ("upper", 1.0)):
        motion, skin = result.body(name), skins[name]
        world = motion.position[-1] + fr.rotate(motion.rotation[-1], skin.points)
        moved = fr.rotate(motion.rotation[-1], skin.displacement(-1))
        assert np.all(np.isfinite(moved))
        near = np.argmin(np.linalg.norm(world - [0.0, 0.0, R], axis=1))
        # a node within half a spacing: pressed in by a part of the body's own half of the approach
        assert 0.2 * 0.5 * APPROACH < sign * moved[near, 2] < 0.5 * APPROACH
    # the node that the patch is over has the pressure of its cell, one next to it none
    skin = skins["lower"]
    angle = 2.0 * np.pi / SECTORS
    at = np.flatnonzero(np.hypot(skin.points[:, 0], skin.points[:, 2]) > R * (1.0 - 1e-9))
    cells = result.history.contacts[PAIR].cells
    assert cells is not None
    before = cells.column[-1]
    cells.column[-1] = np.rint(before)  # over a column of nodes
    try:
        pressure = result.skins()["lower"].pressure(-1)
    finally:
        cells.column[-1] = before
    loaded = at[pressure[at] > 0.0]
    theta = np.arctan2(skin.points[loaded, 2], skin.points[loaded, 0])
    assert len(loaded) == 6 and np.ptp(theta) < 1e-6 * angle
    assert pressure.max() == pytest.approx(contact.mid_pressure[-1].max(), rel=0.02)


# --- stress ---


def test_closed_forms_of_the_half_space() -> None:
    """Against Boussinesq's point force, far below small rectangles and summed over many of them."""
    rng = np.random.default_rng(1)
    x, y, p = np.array([-1.0, -0.3, 0.5, 1.4]), np.array([-2.0, -0.5, 0.7, 1.1]), rng.random((4, 4))
    points = np.column_stack([rng.uniform(-2.0, 2.0, (6, 2)), rng.uniform(0.4, 2.0, 6)])
    fine_x, fine_y = (
        np.concatenate([np.linspace(a, b, 40, endpoint=False) for a, b in zip(v, v[1:], strict=False)]) for v in (x, y)
    )
    fine_x, fine_y = np.append(fine_x, x[-1]), np.append(fine_y, y[-1])
    middle = [0.5 * (v[1:] + v[:-1]) for v in (fine_x, fine_y)]
    along = np.stack([np.interp(middle[1], y, row) for row in p])
    values = np.stack([np.interp(middle[0], x, column) for column in along.T], axis=1)
    grid_nodes = under_nodes(points, x, y, p, 0.3)
    assert grid_nodes == pytest.approx(under_cells(points, fine_x, fine_y, values, 0.3), abs=2e-4)  # constants on 1/40
    # at the surface the normal stress is minus the pressure, to the depth it is taken at
    below = np.column_stack([middle[0][5::30], np.full(4, middle[1][50]), np.zeros(4)])
    exact = values[5::30, 50]
    assert -under_nodes(below, x, y, p, 0.3)[:, 2] == pytest.approx(exact, abs=1e-5)
    force = np.array([[0.0, 0.0, 300.0]])
    total = np.sum(np.diff(fine_x)[:, None] * np.diff(fine_y) * values)
    assert under_nodes(force, x, y, p, 0.3)[0, 2] == pytest.approx(-1.5 * total / (np.pi * 300.0**2), rel=1e-4)


@pytest.mark.parametrize("name, points, side", [("lower", "top", 1.0), ("upper", "below", -1.0)])
def test_stress_below_the_line_is_hertz(result: Result, name: str, points: str, side: float) -> None:
    hertz = result.contact(PAIR).hertz(0)
    a, p0 = hertz.half_width, hertz.peak_pressure
    z = DEPTH / a
    line = LineContact(0.5 * np.pi, 1.0, 2.0)  # a = p0 = 1
    across, down = line.on_axis(z)
    axial = STEEL.poisson_ratio * (across + down)
    found = result.stress(name, points)
    tensor = found.tensor[0] / p0
    assert tensor[:, 0] == pytest.approx(across, abs=IN_PLANE)
    assert tensor[:, 2] == pytest.approx(down, abs=IN_PLANE)
    assert tensor[:, 1] == pytest.approx(axial, abs=AXIAL)
    assert np.abs(tensor[:, 3:]).max() < IN_PLANE
    # the largest von Mises stress, by a curve through what is found
    near, fine = (z > 0.3) & (z < 1.3), np.linspace(0.4, 1.2, 401)
    exact = line.von_mises(z, STEEL.poisson_ratio)
    curves = [np.polynomial.Polynomial.fit(z[near], v[near], 5)(fine) for v in (found.von_mises[0] / p0, exact)]
    assert curves[0].max() == pytest.approx(curves[1].max(), rel=MISES)
    assert fine[curves[0].argmax()] == pytest.approx(fine[curves[1].argmax()], rel=MISES_DEPTH)


@pytest.mark.parametrize("name, points", [("lower", "surface"), ("upper", "opposite")])
def test_traction_at_the_surface_is_the_pressure(result: Result, name: str, points: str) -> None:
    stress = result.stress(name, points)
    normal = stress.points / np.linalg.norm(stress.points, axis=1)[:, None]
    traction = np.einsum("pi,pij,pj->p", normal, to_tensor(stress.tensor[0]), normal)
    p = result.contact(PAIR).mid_pressure[0].max()
    assert -traction / p == pytest.approx(
        [1.0, np.sqrt(1.0 - (0.2 / 0.44) ** 2), np.sqrt(1.0 - (0.2 / 0.44) ** 2)], abs=0.05
    )
    assert np.all(np.isfinite(rotated(stress.tensor, np.eye(3))))


# --- files, pictures ---


def test_files_keep_the_cells(result: Result, tmp_path: Path) -> None:
    loaded = Result.load(result.save(tmp_path / "run.h5"))
    before, after = (r.history.contacts[PAIR].cells for r in (result, loaded))
    for name in ("column", "half_width", "z", "length"):
        assert np.array_equal(getattr(before, name), getattr(after, name))
    assert isinstance(loaded.contact(PAIR), CellContactResult)
    assert np.array_equal(loaded.contact(PAIR).half_widths, result.contact(PAIR).half_widths)
    data = result.to_xarray()
    assert (
        data["contact_cell_half_width"].dims == ("time", "cell_pair") and data["contact_cell_half_width"].units == "m"
    )
    assert data[f"contact_cell_z_{PAIR}"].dims == ("time", f"row_{PAIR}")
    pressure = data[f"contact_pressure_{PAIR}"]
    assert pressure.shape == result.history.contacts[PAIR].pressure.shape and "travel" in pressure.frame
    assert data[f"arc_{PAIR}"].shape == pressure.shape[:2]
    assert result.to_vtkhdf(tmp_path / "skin.vtkhdf", stride=10).exists()


def test_a_run_that_never_touches_and_one_without_rows(result: Result, tmp_path: Path) -> None:
    open_run = Result.load(result.save(tmp_path / "run.h5"))
    contact = open_run.history.contacts[PAIR]
    contact.pressure = np.zeros_like(contact.pressure)
    found = open_run.contact(PAIR)
    assert not found.touching.any() and not found.half_width.any() and not found.peak_pressure.any()
    assert not open_run.skins()["upper"].pressure(0).any() and "open in the last row" in open_run.report()
    assert np.all(np.isfinite(open_run.stress("lower", "top").tensor))
    open_run.summary()
    assert record(open_run, tmp_path / "open.rrd", max_frames=1).frames == 1
    empty = Result.load(tmp_path / "run.h5")
    history, contact = empty.history, empty.history.contacts[PAIR]
    assert contact.cells is not None
    for array in ("time", "step_size", "iterations", "factorisations"):
        setattr(history, array, getattr(history, array)[:0])
    history.energy = {line: values[:0] for line, values in history.energy.items()}
    for owner in (contact, contact.cells, *history.bodies.values(), *history.joints.values()):
        for entry in fields(owner):
            if isinstance(getattr(owner, entry.name), np.ndarray):
                setattr(owner, entry.name, getattr(owner, entry.name)[:0])
    history.sensors = {}
    assert Result.load(empty.save(tmp_path / "empty.h5")).contact(PAIR).peak_pressure.shape == (0,)


def test_plots_and_report(result: Result, tmp_path: Path) -> None:
    figure = result.summary()
    figure.savefig(tmp_path / "summary.png", dpi=40)
    assert (tmp_path / "summary.png").stat().st_size > 0
    text = result.report()
    assert "cells of the patch" in text and "a line across the width" in text and "at the computed line load" in text


def test_recording_draws_the_cells(result: Result, tmp_path: Path) -> None:
    contact = result.contact(PAIR)
    info = record(result, tmp_path / "run.rrd", max_frames=3)
    relief = columns(info.path, f"/world/contacts/{PAIR}/relief", "Mesh3D:vertex_positions")
    strips, rows = contact.mean_pressure.shape[1:]
    assert len(relief) == info.frames and len(relief[0]) == 4 * strips * rows
    # corners of the cells of one strip at their height above the true surface, round about the line of centres
    heights = fr.relief(contact, -1, 1e9, 1e-3).reshape(2 * strips, 2 * rows, 3)
    above = np.hypot(heights[..., 0], heights[..., 2] + R) - R
    assert above[1::2, 1::2] == pytest.approx(contact.mean_pressure[-1] * 1e-12, abs=1e-9)
    assert np.allclose(above[::2, ::2], above[1::2, 1::2])
    window = map_window(contact, np.arange(len(result.time)))
    picture = pressure_map(contact, -1, contact.mean_pressure[-1], window, (40, 300))
    pixel = 2.0 * window.reach / 300 * (window.high - window.low) / 40
    assert picture.sum() * pixel == pytest.approx(contact.normal_load[-1], rel=0.03)  # to the pixels at the edges
