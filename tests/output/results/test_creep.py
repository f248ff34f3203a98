"""Creepages, forces, spin moment and T-gamma against closed forms, on both kinds of cells."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import h5py
import numpy as np
import pytest
from matplotlib.figure import Figure
from patch_rubbing_run import CELL_ROWS, STRIPS, TURNING, cell_widths, make_patch_history, patch_contact
from recordings import columns
from rubbing_run import CREEPAGE, MU, SPEED, STICK, carter_traction, make_rubbing_history
from shape_runs import contact_of, ellipsoid, grid_of, still
from synthetic_run import HALF_WIDTH, PEAK, PITCH, STEPS, WIDTH, R

from references.pressure_wrench import traction_wrench
from vtkhdf_reader import read_vtkhdf
from warpffrf.model.errors import InputError
from warpffrf.model.surfaces import Bore, Cone, Cylinder, Plane, Sphere
from warpffrf.online.history.history import FrictionHistory
from warpffrf.output.accuracy.demands import steps_wanted
from warpffrf.output.accuracy.limits import Limits
from warpffrf.output.bodies.patch_on_skin import tangential_forces
from warpffrf.output.budget.contacts import friction_lines
from warpffrf.output.contact.cell_result import CellContactResult
from warpffrf.output.contact.friction import FRICTION_ERROR, MOST_CELLS, OPEN, SLIP, center_creep
from warpffrf.output.contact.friction import STICK as STICKS
from warpffrf.output.geometry.places import rotate
from warpffrf.output.plots.friction import FRICTION_PLOTS
from warpffrf.output.recording.recorder import record
from warpffrf.output.result import Result

PAIR = "lower-upper"
FLOOR = Plane(origin=(0, 0, 0), outward=(0, 0, 1))
ROLLER = Cylinder(radius=0.02, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
HOLE = Bore(radius=0.02, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
ROUND = 1e-3  # relative: a patch of half-width W on a radius R is flat to (W/R)^2, here 0.6e-3
TIPPED = np.array([[0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5)]])  # x, y, z, w: the axis z of the body along x of the world
LEAST_CELLS = 0.05  # of T-gamma: Carter's traction is sampled at the middles of eight cells across


@pytest.fixture
def rubbing(body) -> Result:
    return Result(make_rubbing_history(body))


@pytest.fixture
def patch(body) -> Result:
    return Result(make_patch_history(body))


def spread(x: np.ndarray, y: np.ndarray, *values: float) -> np.ndarray:
    """Constants over the cells (2, columns, rows)."""
    return np.stack([np.full(np.broadcast_shapes(x.shape, y.shape), v) for v in values])


def rigid(x: np.ndarray, y: np.ndarray, creep: tuple[float, float], spin: float) -> np.ndarray:
    """Slip velocity (2, columns, rows) of two rigid bodies."""
    return spread(x, y, *creep) + spin * np.stack([-y + 0.0 * x, x + 0.0 * y])


# --- cells that travel with the patch ---


@pytest.mark.parametrize("shape", [FLOOR, ROLLER, HOLE])
def test_a_constant_traction_is_force_over_area(shape: Any) -> None:
    """The area of the cells changes with their half-width; a round surface has its own arc for it."""
    tau, widths, length = (2e6, -3e6), (0.3e-3, 0.6e-3), 1.4e-3
    contact = patch_contact(
        shape, lambda x, y: (spread(x, y, 1e7)[0], spread(x, y, *tau), spread(x, y, -1e-3, 0.0)), widths=widths
    )
    area = 2.0 * np.array(widths) * length
    friction = contact.friction
    assert friction.tangential_force == pytest.approx(area[:, None] * tau, rel=1e-12)
    assert friction.spin_moment == pytest.approx([0.0, 0.0], abs=1e-12 * area[1] * 3e6 * length)
    assert friction.slip_area == pytest.approx(area, rel=1e-12) and not friction.stick_area.any()
    assert friction.wear_rate == pytest.approx(1e7 * 1e-3 * area, rel=1e-12)
    assert friction.field_power == pytest.approx(2e6 * 1e-3 * area, rel=1e-12)
    assert friction.traction_coefficient == pytest.approx(np.hypot(*tau) / 1e7 * np.ones(2), rel=1e-9)


@pytest.mark.parametrize("shape", [FLOOR, ROLLER, HOLE])
def test_a_field_that_turns_has_the_moment_of_its_cells(shape: Any) -> None:
    """tau = k (-y, x): M_z = k int (x^2 + y^2) dA, with the middles of n by m cells k A (W^2 (1 - 1/n^2) + L^2 (1 -
    1/m^2))/3 of a rectangle 2 W by 2 L."""
    k, W, L = 1e9, 0.5e-3, 0.7e-3
    contact = patch_contact(
        shape, lambda x, y: (spread(x, y, 1e7)[0], rigid(x, y, (0.0, 0.0), k), rigid(x, y, (0, 0), 0))
    )
    n, m = contact.mean_pressure.shape[1:]
    expected = k * 4.0 * W * L * (W**2 * (1.0 - 1.0 / n**2) + L**2 * (1.0 - 1.0 / m**2)) / 3.0
    exact = 1e-12 if shape.kind == "plane" else ROUND
    assert contact.friction.spin_moment[0] == pytest.approx(expected, rel=exact)
    assert contact.friction.tangential_force[0] == pytest.approx([0.0, 0.0], abs=1e-9 * k * W**3)


@pytest.mark.parametrize("rolling", [2.0, -2.0])
@pytest.mark.parametrize("shape", [FLOOR, ROLLER, HOLE])
def test_t_gamma_of_rigid_slip_is_power_over_speed(shape: Any, rolling: float) -> None:
    """All of the patch slides against friction at mu p: what is taken per metre is that of forces and creepages."""
    creep, spin = (2e-3, -1e-3), 4.0

    def fields(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        slip, p = rigid(x, y, creep, spin), 1e8 * (1.0 + 200.0 * (x + 0.5 * y))
        return p, -MU * p * slip / np.linalg.norm(slip, axis=0), slip

    contact = patch_contact(shape, fields, creep=creep, spin=spin, rolling=rolling)
    friction = contact.friction
    assert friction.spin_velocity == pytest.approx([spin], rel=1e-12)
    assert friction.spin_creepage == pytest.approx([spin / abs(rolling)], rel=1e-12)
    m, above = contact.mean_pressure.shape[2], contact.patch_center[0, 1] - contact.creep_place[0, 1]
    assert above == pytest.approx(100.0 * 0.7e-3**2 * (1.0 - 1.0 / m**2) / 3.0, rel=1e-9)  # centre of pressure
    expected = rigid(np.zeros(1), np.full(1, above), creep, spin)[:, 0]
    assert friction.creepage[0] == pytest.approx(expected / abs(rolling), rel=1e-9)
    assert friction.t_gamma[0] > 0.0
    exact = 1e-12 if shape.kind == "plane" else ROUND
    assert friction.t_gamma == pytest.approx(friction.field_power / abs(rolling), rel=exact)
    by_hand = (
        -(friction.tangential_force * friction.creepage).sum(axis=1) - friction.spin_moment * friction.spin_creepage
    )
    assert friction.t_gamma == pytest.approx(by_hand, rel=1e-12)
    # friction turns the first body back, against its spin
    assert friction.spin_moment[0] < 0.0
    # and the power of the fields is mu times the wear rate
    assert friction.field_power == pytest.approx(MU * friction.wear_rate, rel=1e-12)


def test_a_cone_creeps_by_the_radius_at_its_center() -> None:
    """Rotating about its axis at Omega, the surface of a cone moves by Omega R(z) along e_theta; recorded elsewhere."""
    cone = Cone(radius=0.02, half_angle=0.3, axis_point=(0, 0, 0), axis_direction=(0, 0, 1))
    rate, z, z_0, theta = 5.0, 2e-3, -1e-3, 0.4
    grid = SimpleNamespace(e_0=cone.e_0)
    contact = SimpleNamespace(
        view=SimpleNamespace(
            first=SimpleNamespace(shape=cone, grid=grid), first_body=SimpleNamespace(name="a"),
            second_body=SimpleNamespace(name="b"),
        ),
        bodies={"a": SimpleNamespace(angular_velocity=rate * np.array([[1.0, 0, 0]]), rotation=TIPPED)},
        patch_center=np.array([[theta, z]]), creep_place=np.array([[theta, z_0]]), side=1.0,
    )  # fmt: skip
    drift = -0.03  # of the other body's plane
    found = center_creep(contact, np.array([[rate * float(cone.radius_at(z_0)) + drift, 0.0]]))
    assert found == pytest.approx(np.array([[rate * float(cone.radius_at(z)) + drift, 0.0]]), abs=1e-15)


def test_no_rolling_no_creepage(patch: Result) -> None:
    history = patch.history.contacts[PAIR]
    assert history.friction is not None
    history.friction.rolling_velocity[3] = 0.0
    friction = patch.contact(PAIR).friction
    for values in (friction.creepage[:, 0], friction.spin_creepage, friction.t_gamma, friction.power_per_metre):
        assert np.flatnonzero(np.isnan(values)).tolist() == [3]
    assert np.all(np.isfinite(friction.spin_velocity)) and np.all(np.isfinite(friction.spin_moment))


def test_the_ground_and_rigid_bodies_turn_or_do_not(patch: Result, body: Any) -> None:
    assert patch.contact(PAIR).friction.spin_velocity == pytest.approx(np.full(STEPS, TURNING), rel=1e-12)
    assert Result(make_patch_history(body, spin=0.0)).contact(PAIR).friction.spin_velocity == pytest.approx(
        np.zeros(STEPS)
    )
    history = make_patch_history(body)
    history.bodies["lower"].angular_velocity[:, 2] = 0.5
    del history.bodies["upper"]  # as if it were the ground, which has no motion
    assert Result(history).contact(PAIR).friction.spin_velocity == pytest.approx(np.full(STEPS, 0.5))


# --- a run on cells that travel ---


def test_carter_on_cells(patch: Result) -> None:
    contact = patch.contact(PAIR)
    assert isinstance(contact, CellContactResult)
    friction, W = contact.friction, cell_widths()
    strip = 2.0 * W / STRIPS
    x = strip[:, None] * (np.arange(STRIPS) - 0.5 * (STRIPS - 1))
    peak = PEAK * (1.0 + np.linspace(0.0, 1.0, STEPS))
    rows = np.stack([carter_traction(a, p) for a, p in zip(x, peak, strict=True)]).sum(axis=1)
    assert friction.tangential_force[:, 0] == pytest.approx(rows * strip * WIDTH, rel=1e-12)
    assert friction.tangential_force[:, 1] == pytest.approx(0.1 * rows * strip * WIDTH, rel=1e-12)
    assert friction.creepage[:, 0] == pytest.approx(np.full(STEPS, CREEPAGE))
    assert friction.spin_creepage == pytest.approx(np.full(STEPS, TURNING / SPEED))
    loaded = (friction.state != OPEN).sum(axis=(1, 2)) / CELL_ROWS
    assert friction.stick_area + friction.slip_area == pytest.approx(loaded * strip * WIDTH, rel=1e-12)
    assert friction.stick_area == pytest.approx(np.full(STEPS, 2.0 * STICK * WIDTH), abs=1.01 * strip.max() * WIDTH)
    profile = friction.profile(4, MU)
    assert np.all(np.diff(profile["arc"]) > 0.0)
    assert profile["traction"] == pytest.approx(carter_traction(profile["arc"], peak[4]), rel=1e-6, abs=1e-3)
    assert profile["arc"][profile["state"] == STICKS].max() < profile["arc"][profile["state"] == SLIP].min()


def test_moments_are_those_of_the_wrench(patch: Result) -> None:
    """M_z from force and torque about the body's origin, in world axes: n.(T - x_C x F), with n = +z at the top."""
    contact = patch.contact(PAIR)
    force, torque = traction_wrench(patch, PAIR)
    top = np.array([0.0, 0.0, R])
    expected = (torque - np.cross(top, force))[:, 2]
    assert contact.friction.spin_moment == pytest.approx(expected, rel=1e-9, abs=1e-12 * np.abs(torque).max())
    assert np.abs(expected).min() > 0.0  # the lateral tractions lean on one side of the middle


def test_files_keep_friction_on_cells(patch: Result, tmp_path: Path) -> None:
    path = patch.save(tmp_path / "run.h5")
    loaded = Result.load(path)
    before, after = patch.contact(PAIR).friction, loaded.contact(PAIR).friction
    units = {
        "spin_creepage": "rad/m", "spin_velocity": "rad/s", "spin_moment": "N m", "t_gamma": "N", "stick_area": "m2"
    }  # fmt: skip
    data = patch.to_xarray()
    with h5py.File(path) as opened:
        file: Any = opened
        for name, unit in units.items():
            expected = getattr(before, name)
            assert np.array_equal(getattr(after, name), expected)
            stored = file[f"contact_{name}"]
            assert stored.attrs["units"] == unit and np.array_equal(stored[:, 0], expected)
            assert data[f"contact_{name}"].units == unit and data[f"contact_{name}"].dims == ("time", "friction_pair")
            assert np.array_equal(data[f"contact_{name}"].sel(friction_pair=PAIR), expected)
        assert "travel" in file[f"contact_wear_index/{PAIR}"].attrs["frame"]
    assert "longitudinal" in data["contact_creepage"].frame
    assert loaded.report() == patch.report()


def test_the_report_has_words_of_the_field(patch: Result) -> None:
    text, friction = patch.report(), patch.contact(PAIR).friction
    force, shares = friction.tangential_force[-1], (friction.stick_area[-1], friction.slip_area[-1])
    for part in (
        f"creep forces    Fx {force[0]:+.5g} N longitudinal, Fy {force[1]:+.5g} N lateral, ",
        f"Mz {friction.spin_moment[-1]:+.4g} N m of spin, on 'lower'",
        f"creepage        {CREEPAGE:+.4e} longitudinal, +0.0000e+00 lateral, {TURNING / SPEED:+.4e} rad/m of spin",
        f"T-gamma         {friction.t_gamma[-1]:.5g} N by forces and creepages, ",
        f"{friction.power_per_metre[-1]:.5g} N by the friction power over the rolling speed",
        f"area of adhesion {shares[0] / sum(shares):.0%}",
    ):
        assert part in text
    for slides in (0.0, 1e-8 * np.abs(friction.creep_velocity).max()):  # at rest, and in sliding, to round-off
        patch.history.contacts[PAIR].friction.rolling_velocity[:] = slides  # type: ignore[union-attr]
        still_text = Result(patch.history).report()
        assert "creepage        not rolling" in still_text and "T-gamma         not rolling" in still_text


def test_too_fast_patches_are_reported_with_their_strips(patch: Result) -> None:
    friction = patch.contact(PAIR).friction
    friction.cells_per_step[:] = 2.0  # right to 1 %
    assert friction.warning() is None
    friction.cells_per_step[:] = 4.0
    warning = friction.warning()
    assert (
        warning is not None
        and "take steps 1.6 times shorter, or fewer strips, Contact(..., cells=(strips, rows))" in warning
    )


def test_too_fast_patches_are_in_the_budget(patch: Result) -> None:
    """Where a patch advances 4 cells, friction errs by 1.6 times what it does at 2.5: a shorter step cures it."""
    contacts = [SimpleNamespace(name=PAIR, friction=SimpleNamespace(acts=True))]
    run = SimpleNamespace(
        history=SimpleNamespace(scene=SimpleNamespace(finite_sliding=contacts)), contact=patch.contact
    )
    friction = patch.contact(PAIR).friction
    friction.cells_per_step[:] = 2.0
    assert friction_lines(run) == []
    friction.cells_per_step[-1] = 4.0
    lines = friction_lines(run)
    assert [line.size for line in lines] == [pytest.approx(1.6 * FRICTION_ERROR)]
    assert "4 cells per step" in lines[0].basis
    limits = Limits.of(0.01)
    steps, _ = steps_wanted(100, lines, limits)
    assert 4.0 * 100 / steps < MOST_CELLS["cells"]


@pytest.mark.parametrize("kind", [*FRICTION_PLOTS, "summary"])
def test_plots_draw_cells(patch: Result, kind: str, tmp_path: Path) -> None:
    figure = patch.summary() if kind == "summary" else Figure()
    if kind != "summary":
        axes = patch.plot(kind, figure.add_subplot())
        assert "[" in axes.get_xlabel() and "[" in axes.get_ylabel() and axes.has_data()
    figure.savefig(tmp_path / "picture.png", dpi=40)
    assert (tmp_path / "picture.png").stat().st_size > 0


def test_the_map_has_the_cells_in_millimetres(patch: Result) -> None:
    axes: Any = patch.plot("stick_slip", Figure().add_subplot())
    mesh, arrows = axes.collections[:2]
    lines = np.asarray(mesh.get_coordinates())
    assert np.ptp(lines[..., 0]) == pytest.approx(2e3 * cell_widths()[-1]) and np.ptp(lines[..., 1]) == pytest.approx(
        20.0
    )
    assert np.asarray(mesh.get_array()).size == STRIPS * CELL_ROWS
    friction = patch.contact(PAIR).friction
    assert len(arrows.get_offsets()) == np.count_nonzero(np.any(friction.traction[-1] != 0.0, axis=0))
    assert "area of adhesion" in axes.get_title()


def test_recordings_draw_friction_on_cells(patch: Result, tmp_path: Path) -> None:
    info = record(patch, tmp_path / "run.rrd", color="state")
    friction = patch.contact(PAIR).friction
    for field in ("traction", "state", "slip", "wear"):
        assert len(columns(info.path, f"/patch_map/{PAIR}/{field}", "Image:buffer")) == STEPS
        relief = columns(info.path, f"/world/contacts/{PAIR}/relief_{field}", "Mesh3D:vertex_colors")
        assert len(relief[4]) == 4 * STRIPS * CELL_ROWS  # a cell has four corners of its own
    arrows = np.array(columns(info.path, f"/patch_map/{PAIR}/traction_arrows", "Arrows2D:vectors")[3])
    assert len(arrows) == np.count_nonzero(np.any(friction.traction[3] != 0.0, axis=0))
    assert np.all(arrows[:, 0] > 0.0) and arrows[:, 1] == pytest.approx(-0.1 * arrows[:, 0], rel=1e-5)
    got = np.array(columns(info.path, f"/plots/t_gamma/{PAIR}", "Scalars:scalars")).ravel()
    assert got == pytest.approx(friction.t_gamma)


def test_skins_have_the_values_of_the_cells(patch: Result) -> None:
    """The synthetic rim has a node every 2 degrees: several lie in the cells, of both rollers."""
    contact, i = patch.contact(PAIR), 4
    friction = contact.friction
    for name, sign in (("lower", 1.0), ("upper", -1.0)):
        skin, motion = patch.skins()[name], patch.body(name)
        state, speed = skin.state(i), skin.slip_speed(i)
        assert set(np.unique(state)) == {0, 1, 2}
        world = motion.position[i] + rotate(motion.rotation[i], skin.points)
        x = R * np.arcsin(np.clip(world[:, 0] / R, -1.0, 1.0))  # the top is the line of centres
        slips = state == SLIP
        assert np.all(x[slips] > x[state == STICKS].max())
        assert (
            speed[slips].max() == pytest.approx(friction.slip_speed[i].max(), rel=0.5)
            and not speed[state == STICKS].any()
        )
        traction = rotate(motion.rotation[i], skin.traction(i))
        assert np.all(sign * traction[slips, 0] > 0.0)
        assert np.array_equal(skin.wear(i) > 0.0, (skin.pressure(i) > 0.0) & (speed > 0.0))


@pytest.mark.parametrize("i", [0, 5])
def test_forces_of_cells_load_both_bodies(patch: Result, i: int) -> None:
    """Shared between cells of both grids, along their own tangents: these turn by half a cell at most, and by x/R."""
    pair, contact, bodies = patch.view.pairs[PAIR], patch.history.contacts[PAIR], patch.history.bodies
    expected = patch.contact(PAIR).friction.tangential_force[i]
    own = tangential_forces(pair, contact, bodies, i, first=True)
    other = tangential_forces(pair, contact, bodies, i, first=False)
    assert own.sum(axis=(1, 2)) == pytest.approx(expected, rel=1e-9)
    angle = HALF_WIDTH / R
    # e_theta of the upper roller at the patch is that of the lower one, t_z is the same axis
    assert np.abs(other.sum(axis=(1, 2))) == pytest.approx(np.abs(expected), rel=angle**2)
    assert other[1].sum() == pytest.approx(-own[1].sum(), rel=1e-9)
    loaded = np.flatnonzero(np.any(own[0] != 0.0, axis=1))
    assert 0 < len(loaded) < 2.0 * HALF_WIDTH / (R * PITCH) + 3


def test_vtkhdf_of_friction_on_cells(patch: Result, tmp_path: Path) -> None:
    blocks, _ = read_vtkhdf(patch.to_vtkhdf(tmp_path / "run.vtkhdf", stride=8), 1)
    mesh = blocks[0]
    assert set(np.unique(mesh.point_data["state"])) == {0, 1, 2} and mesh.point_data["wear"].max() > 0.0


# --- the contact grid ---


def test_t_gamma_of_carter_is_power_over_speed(rubbing: Result) -> None:
    """Steady rolling: friction takes Q times the creep."""
    friction = rubbing.contact(PAIR).friction
    assert np.all(friction.spin_velocity == 0.0) and np.all(friction.spin_creepage == 0.0)
    assert friction.spin_moment == pytest.approx(np.zeros(STEPS), abs=1e-9 * PEAK * HALF_WIDTH * WIDTH**2)
    assert friction.t_gamma == pytest.approx(friction.power / SPEED, rel=LEAST_CELLS)
    assert friction.power_per_metre == pytest.approx(friction.power / SPEED)


@pytest.mark.parametrize(
    "shape", [FLOOR, *(kind(radius=0.03, axis_point=(0, 0, 0), axis_direction=(0, 1, 0)) for kind in (Sphere, Bore))]
)
def test_a_ball_that_spins_on_the_contact_grid(shape: Any) -> None:
    """The patch lies off the middle row and off the columns, the recorded creep is that of a node: creepages and the
    moment are those of the middle of the patch."""
    scale = 1.0 if shape.kind == "plane" else 0.03
    z = np.linspace(-1e-3, 1e-3, 20)  # an even number: no row in the middle
    grid = grid_of(shape, 1e-4 / scale, 31, z)
    spin, creep, off = 5.0, np.array([1e-3, 2e-3]), 2e-4
    p = ellipsoid(4e-4, 4e-4, 1e9)
    contact = contact_of(shape, grid, shape, lambda t, z: p(scale * t, z - off), bodies={"a": still(), "b": still()})
    contact.patch_kind = "point"
    at = np.stack([contact.side * contact.arc[0][:, None] + 0.0 * z, z + 0.0 * contact.arc[0][:, None]])
    middle = contact.center_of_pressure[0]
    slip = creep[:, None, None] + spin * np.stack([-(at[1] - middle[1]), at[0] - contact.side * middle[0]])
    tau = -MU * contact.mean_pressure[0] * slip / np.linalg.norm(slip, axis=0)
    node = slip[:, 15, len(z) // 2]  # the column of the line of centres
    state = np.where(contact.mean_pressure > 0.0, 2, 0).astype(np.int8)
    friction = FrictionHistory(tau[None], slip[None], state, np.zeros(1), node[None], np.ones(1), np.full(1, 0.5))
    contact.history.friction = friction
    contact.bodies["a"].angular_velocity = spin * shape.normal(0.0, off)[None]
    found = contact.friction
    assert found.creepage[0] == pytest.approx(creep, rel=ROUND) and abs(node[0] - creep[0]) > 0.1 * creep[0]
    assert found.spin_creepage == pytest.approx([spin], rel=ROUND)
    assert found.t_gamma == pytest.approx(found.field_power, rel=ROUND)
    assert found.spin_moment[0] < 0.0


def test_a_frictionless_pair_has_no_creepages(result: Result) -> None:
    with pytest.raises(InputError, match="contact 'lower-upper' has no friction"):
        _ = result.contact(PAIR).friction.spin_creepage
