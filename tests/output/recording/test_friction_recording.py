"""Recordings and plots of friction, and of rigid partners, read back."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from recordings import columns
from rubbing_run import MU, make_rubbing_history
from shape_runs import on_the_floor
from synthetic_run import ROWS, STEPS, WINDOW, R

from warpffrf.model.errors import InputError
from warpffrf.output.plots.colors import STATE_COLORS, ColorClasses, legend_picture, legend_rows
from warpffrf.output.plots.friction import FRICTION_PLOTS
from warpffrf.output.recording.contact_scene import FRICTION_FIELDS, relief_name
from warpffrf.output.recording.contact_scene import FRICTION_PLOTS as CURVES
from warpffrf.output.recording.recorder import record
from warpffrf.output.result import Result


@pytest.fixture
def rubbing(body) -> Result:
    return Result(make_rubbing_history(body))


def packed(colors: tuple[str, ...]) -> list[int]:
    return [int(c[1:], 16) << 8 | 0xFF for c in colors]


def test_every_field_has_its_relief_and_map(rubbing: Result, tmp_path: Path) -> None:
    info = record(rubbing, tmp_path / "run.rrd")
    pair = "lower-upper"
    heights = columns(info.path, f"/world/contacts/{pair}/relief", "Mesh3D:vertex_positions")
    for field in FRICTION_FIELDS:
        place = f"/world/contacts/{pair}/{relief_name(field)}"
        assert len(columns(info.path, place, "Mesh3D:triangle_indices")) == 1  # topology once
        positions = columns(info.path, place, "Mesh3D:vertex_positions")
        assert len(positions) == STEPS and np.array_equal(positions[4], heights[4])
        assert len(columns(info.path, f"/patch_map/{pair}/{field}", "Image:buffer")) == STEPS
    states = columns(info.path, f"/world/contacts/{pair}/relief_state", "Mesh3D:vertex_colors")
    i = 4
    expected = np.array(packed(STATE_COLORS))[rubbing.contact(pair).friction.state[i].reshape(-1)]
    assert np.array_equal(np.array(states[i]), expected) and len(expected) == WINDOW * ROWS


def test_curves_are_those_of_the_result(rubbing: Result, tmp_path: Path) -> None:
    info = record(rubbing, tmp_path / "run.rrd")
    friction = rubbing.contact("lower-upper").friction
    expected = {
        "traction_coefficient/lower-upper": friction.traction_coefficient,
        "creepage/lower-upper/around": friction.creepage[:, 0],
        "spin_creepage/lower-upper": friction.spin_creepage,
        "creep_force/lower-upper/around": friction.tangential_force[:, 0],
        "spin_moment/lower-upper": friction.spin_moment,
        "t_gamma/lower-upper": friction.t_gamma,
        "friction_power/lower-upper": friction.power,
        "contact_area/lower-upper/stick": friction.stick_area * 1e6,
        "wear/lower-upper": friction.wear_peak * 1e-6,
        "cells_per_step/lower-upper": friction.cells_per_step,
    }
    for place, values in expected.items():
        got = np.array(columns(info.path, f"/plots/{place}", "Scalars:scalars")).ravel()
        assert got == pytest.approx(values)
    assert {place.split("/")[0] for place in expected} == set(CURVES)


def test_arrows_of_the_traction_lie_on_the_map(rubbing: Result, tmp_path: Path) -> None:
    info = record(rubbing, tmp_path / "run.rrd")
    arrows = columns(info.path, "/patch_map/lower-upper/traction_arrows", "Arrows2D:vectors")
    vectors = np.array(arrows[3])
    tau = rubbing.contact("lower-upper").friction.traction[3]
    assert len(vectors) == np.count_nonzero(np.any(tau != 0.0, axis=0))
    assert np.all(vectors[:, 0] > 0.0) and np.all(vectors[:, 1] == 0.0)


@pytest.mark.parametrize("color", ["pressure", "state"])
def test_bodies_can_show_their_contacts(rubbing: Result, tmp_path: Path, color: str) -> None:
    info = record(rubbing, tmp_path / "run.rrd", color=color)
    shown = np.array(columns(info.path, "/world/upper/surface", "Mesh3D:vertex_colors")[5])
    values = rubbing.skins()["upper"].contact_field(color, 5)
    assert len(np.unique(shown[values == 0.0])) == 1 and np.any(shown[values > 0.0] != shown[values == 0.0][0])
    if color == "state":
        assert set(shown) == set(packed(STATE_COLORS))


def test_a_colour_that_the_run_does_not_have(result: Result, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="record: color 'slip' does not exist; known: 'displacement', 'pressure'"):
        record(result, tmp_path / "run.rrd", color="slip")


def test_rows_with_slip_that_is_not_finite_are_left_out(rubbing: Result, tmp_path: Path) -> None:
    rubbing.history.contacts["lower-upper"].friction.slip_velocity[2, 0, 8, 1] = np.nan  # type: ignore[union-attr]
    assert record(rubbing, tmp_path / "run.rrd").skipped_rows == [2]


def test_rerun_verifies_a_recording_with_friction(rubbing: Result, tmp_path: Path) -> None:
    info = record(rubbing, tmp_path / "run.rrd", max_frames=2)
    program = shutil.which("rerun", path=str(Path(sys.executable).parent))
    assert program is not None, "the rerun wheel brings the program"
    done = subprocess.run([program, "rrd", "verify", str(info.path)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_rigid_floor_is_drawn_under_the_patch(body, tmp_path: Path) -> None:
    info = record(Result(on_the_floor(body)), tmp_path / "run.rrd")
    points = np.array(columns(info.path, "/world/ground/solid", "Mesh3D:vertex_positions")[0])
    assert points[:, 2].min() == pytest.approx(R, abs=1e-7)  # float32; the material lies above
    assert points[:, 0].min() < -0.5 * R < 0.5 * R < points[:, 0].max()


def test_legends_of_many_fields_stand_in_two_columns() -> None:
    classes = ColorClasses("state", ("open", "stick", "slip"), STATE_COLORS)
    assert [legend_rows([classes] * n) for n in (1, 3, 4, 6)] == [1, 3, 2, 3]
    one, two = legend_picture([classes] * 2), legend_picture([classes] * 4)
    assert one.shape[0] == two.shape[0] and two.shape[1] > one.shape[1]
    assert classes.packed(np.array([0, 1, 2])).tolist() == packed(STATE_COLORS)


@pytest.mark.parametrize("kind", FRICTION_PLOTS)
def test_plots_of_friction_have_axes_with_units(rubbing: Result, kind: str) -> None:
    axes = rubbing.plot(kind, Figure().add_subplot())
    assert "[" in axes.get_xlabel() and "[" in axes.get_ylabel() and axes.has_data()


def test_the_traction_plot_shows_what_the_profile_holds(rubbing: Result) -> None:
    axes = rubbing.plot("traction", Figure().add_subplot())
    profile = rubbing.contact("lower-upper").friction.profile(STEPS - 1, MU)
    lines = {str(line.get_label()): line for line in axes.get_lines()}
    bound, tau = lines[f"{MU:g} p"], lines["traction along e_theta, on the first body"]
    assert np.asarray(bound.get_ydata()) == pytest.approx(profile["bound"] * 1e-6)
    assert np.asarray(tau.get_ydata()) == pytest.approx(profile["traction"] * 1e-6)
    low, high = axes.get_ylim()
    assert low <= 0.0 and high > profile["bound"].max() * 1e-6


def test_the_summary_has_friction_where_there_is_some(rubbing: Result, result: Result) -> None:
    titles = [axes.get_title() for axes in rubbing.summary().axes]
    assert any("Stick and slip" in t for t in titles) and any("Creepage" in t for t in titles)
    with pytest.raises(InputError, match="no contact pair of the run has friction"):
        result.plot("traction")
    assert not any("Stick" in axes.get_title() for axes in result.summary().axes)
