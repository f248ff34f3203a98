"""Small-sliding contacts in what is made of a run: cells and joint, losses, loops, files, arrays, report, plots,
recording, VTK."""

from __future__ import annotations

import re
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from recordings import columns
from small_sliding_runs import CELLS, FRICTION, PERIOD, PRESSED, PUSHED, SIZE, STEPS, pulled, static_run

from vtkhdf_reader import read_vtkhdf
from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError
from warpffrf.model.files.sealed_file import seal
from warpffrf.online.history.history import SmallSlidingHistory
from warpffrf.online.stages import joined_parts
from warpffrf.output.budget.quantities import quantities
from warpffrf.output.files.fields import SMALL_SLIDING_FIELDS
from warpffrf.output.plots.figure import write_figure
from warpffrf.output.plots.panels import save_panels
from warpffrf.output.plots.small_sliding import SMALL_SLIDING_PLOTS
from warpffrf.output.recording.recorder import record
from warpffrf.output.result import Result
from warpffrf.output.small_sliding import SLIDES, SmallSlidingResult

TRAPEZOID = (2.0 * np.pi / STEPS) ** 2 / 6.0  # of the area of a smooth loop, what its polygon is short of
LEANS = 1e-5  # rad, that the upper block turns by under the push, and normals with it
SOLVED = 1e-6  # of a force: tolerance of the equilibrium of a load step


@pytest.fixture(scope="module")
def result() -> Result:
    return static_run()


@pytest.fixture(scope="module")
def lap(result: Result) -> SmallSlidingResult:
    return result.contact("lap")


# --- cells and the joint


def test_cells_cover_the_face(lap: SmallSlidingResult) -> None:
    assert lap.cells == CELLS[0] * CELLS[1]
    np.testing.assert_allclose(lap.area.sum(), SIZE[0] * SIZE[1], rtol=1e-12)
    triangles, cell = lap.polygons
    edges = triangles[:, 1:] - triangles[:, :1]
    area = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    np.testing.assert_allclose(np.bincount(cell, weights=area), lap.area, rtol=1e-12)
    means = np.stack([np.bincount(cell, weights=area * x) for x in triangles.mean(axis=1).T], axis=1)
    np.testing.assert_allclose(means / lap.area[:, None], lap.points, atol=1e-15)


def test_the_peak_is_in_the_cell_of_the_largest_pressure(lap: SmallSlidingResult) -> None:
    for pressure, at in zip(lap.pressure, lap.peak_position, strict=True):
        (cell,) = np.flatnonzero(np.all(lap.points == at, axis=1))
        assert pressure[cell] == pressure.max() > 0.0


def test_forces_of_cells_add_up_to_the_joint_s(result: Result, lap: SmallSlidingResult) -> None:
    """And those to what presses and pushes the upper block, as no load step has inertia."""
    own = np.concatenate([-lap.pressure[:, :, None], lap.traction], axis=2) * lap.area[:, None]
    in_user = np.einsum("tck,ckd->tcd", own, lap.frames)
    turns = np.array([rot.matrix(p) for p in result.body("top").rotation])
    force = np.einsum("tij,tcj->ti", turns, in_user)
    np.testing.assert_allclose(lap.force, force, atol=1e-12 * PRESSED)
    torque = np.einsum("tij,tcj->ti", turns, np.cross(lap.points, in_user))
    np.testing.assert_allclose(lap.torque, torque, atol=1e-12 * PRESSED)
    np.testing.assert_allclose(lap.force, -result.force("push").force, atol=SOLVED * PRESSED)
    np.testing.assert_allclose(lap.normal_force, PRESSED, atol=LEANS * PUSHED)


def test_tractions_keep_the_bound_and_states_say_where(lap: SmallSlidingResult) -> None:
    bound = FRICTION * lap.pressure
    assert np.all(lap.traction_magnitude <= bound * (1.0 + SOLVED))
    slips = lap.state == 2
    np.testing.assert_allclose(lap.traction_magnitude[slips], bound[slips], rtol=SOLVED)
    np.testing.assert_array_equal(lap.counts.sum(axis=1), lap.cells)
    np.testing.assert_allclose(lap.slip_area, slips.sum(axis=1) * lap.area[0], rtol=1e-12)
    assert np.any(slips) and np.all(lap.slip_area + lap.stick_area <= lap.area.sum() * (1.0 + 1e-12))


# --- losses and loops


def test_the_loss_is_that_of_the_ledger(result: Result, lap: SmallSlidingResult) -> None:
    np.testing.assert_allclose(lap.loss, -result.energy["friction"], rtol=1e-12)
    assert lap.loss[-1] == pytest.approx(lap.loss_density[-1] @ lap.area)
    assert np.all(np.diff(lap.cell_loss, axis=0) >= -SOLVED * lap.loss[-1])


def test_the_loss_of_a_closed_cycle_is_the_area_of_its_loop(result: Result, lap: SmallSlidingResult) -> None:
    """Of the second cycle, less what is stored at its end and was not at its begin, and what presses has sunk by."""
    loop = result.hysteresis(("push", "x"), ("tip", "x")).cycles(PERIOD)[1]
    first, last = STEPS, 2 * STEPS
    stored = result.energy["strain"] + result.energy["contact"]
    sunk = PRESSED * abs(result.sensor("tip").values[last, 2] - result.sensor("tip").values[first, 2])
    apart = abs(stored[last] - stored[first]) + sunk
    loss = lap.loss_between(PERIOD, 2.0 * PERIOD)
    assert loop.open < 1e-3 and apart < 2e-2 * loss
    assert loop.loss == pytest.approx(loss, rel=2.0 * TRAPEZOID, abs=apart)
    assert loop.work > 0.0 and loop.equivalent_damping == pytest.approx(loop.loss / (4 * np.pi * loop.strain_energy))


def test_losses_by_cycle(lap: SmallSlidingResult) -> None:
    each = lap.loss_per_cycle(PERIOD)
    assert each.shape == (2,) and each.sum() == pytest.approx(lap.loss[-1], rel=1e-12)
    np.testing.assert_allclose(each, lap.loss_per_cycle([0.0, PERIOD, 2.0 * PERIOD]), rtol=1e-12)
    between = 0.3 * PERIOD / STEPS  # straight between rows
    assert lap.loss_between(0.0, between) == pytest.approx(0.3 * lap.loss[1], abs=1e-18)
    for wrong, words in ((3.0 * PERIOD, "longer than"), (-1.0, "positive"), ([1.0, 0.5], "ascending"), ([0, 9], "go")):
        with pytest.raises(InputError, match=words):
            lap.loss_per_cycle(wrong)


def test_the_secant_stiffness_falls_as_cells_slip(result: Result) -> None:
    found = result.hysteresis(("push", "x"), ("tip", "x")).stiffness(0.0, 0.25 * PERIOD)
    stuck = found.secant[1]
    np.testing.assert_allclose(found.tangent[1:4], stuck, rtol=1e-6)  # all cells stick
    assert np.all(np.diff(found.secant[1:]) < 1e-9 * stuck) and found.tangent[-1] < 0.5 * stuck
    assert np.isnan(found.secant[0]) and found.unit == "N/m"


def test_cells_of_the_slip_zone_lost_energy(lap: SmallSlidingResult) -> None:
    zone = lap.slip_zone(0.0, 0.15 * PERIOD)  # before all of them slip
    assert 0 < zone.cells < lap.cells and zone.coarse
    np.testing.assert_array_equal(zone.slips, lap.cell_loss[round(0.15 * STEPS)] > 1e-6 * lap.cell_loss[6].max())
    assert zone.area == pytest.approx(lap.area[zone.slips].sum())
    assert zone.across == pytest.approx(zone.cells / CELLS[1], rel=0.5)  # a strip across the face
    assert lap.slip_zone(0.0, 0.02 * PERIOD).cells == 0


def test_gross_slip_is_at_the_friction_coefficient_times_the_preload() -> None:
    """Of a block pulled by a rope: its force grows to mu N, and stays there from the time on that the report
    states."""
    result = pulled()
    lap, rope = result.contact("lap"), np.linalg.norm(result.force("rope").force, axis=1)
    begin = lap.gross_slip_time
    row = int(np.flatnonzero(result.time == begin)[0])
    assert 0 < row < len(result.time) - 1 and np.all(lap.slip_share[row:] == 1.0) and np.all(lap.slip_share[:row] < 1.0)
    np.testing.assert_allclose(rope[row:], FRICTION * PRESSED, rtol=1e-4)  # the rope tilts as the block shears
    assert np.all(rope[: row - 1] < FRICTION * PRESSED * (1.0 - 1e-3))
    np.testing.assert_allclose(np.linalg.norm(lap.friction_force, axis=1), rope, rtol=1e-4, atol=SOLVED * PRESSED)
    centred = np.linalg.norm(lap.friction_torque, axis=1)
    assert centred.max() < 1e-9 * FRICTION * PRESSED * SIZE[0]  # it is pulled in its plane of symmetry
    says = next(line for line in result.report(progress=False).splitlines() if "gross slip" in line)
    force = np.linalg.norm(lap.friction_force[row])
    assert f"from t = {begin:.6g} s, with {force:.5g} N along the faces and 0 N m" in says

    sticks = pulled(travel=5e-6)
    assert np.isnan(sticks.contact("lap").gross_slip_time) and "gross slip" not in sticks.report(progress=False)


def test_a_force_beyond_friction_is_said_to_make_the_joint_slide() -> None:
    """It ends where the force is mu N."""
    failed = pulled(force=1.25 * FRICTION * PRESSED)
    assert failed.status == "no_equilibrium"
    found = re.match(r"equilibrium at t = (\S+) s: the loads are more than friction of 'lap' holds", failed.message)
    assert found is not None and float(found[1]) == pytest.approx(1.0 / 1.25, rel=1e-3)


def test_slides_compared_with_cells_are_reported(result: Result, lap: SmallSlidingResult) -> None:
    assert not any("partners of cells" in warning for warning in lap.warnings())
    far = replace(lap.history, slip=lap.slip + [0.8 * SLIDES * lap.size[0], 0.8 * SLIDES * lap.size[0]])
    found = SmallSlidingResult(far, lap.view, lap.time, result.history.bodies)
    assert any("partners of cells are fixed" in warning for warning in found.warnings())
    moved = 0.8 * SLIDES * lap.size[0] * found.frames[0, 1:].sum(axis=0)
    np.testing.assert_allclose(found.sliding[0], moved, atol=1e-6 * SIZE[0])


def test_without_friction_user_frames_say_how_far_faces_slid(result: Result, lap: SmallSlidingResult) -> None:
    bodies = dict(result.history.bodies)
    way = np.array([SLIDES * SIZE[0] / CELLS[0], -1e-3, 2e-5])
    bodies["top"] = replace(bodies["top"], position=bodies["top"].position + way)
    free = replace(lap.view, friction=0.0)
    found = SmallSlidingResult(lap.history, free, lap.time, bodies)
    still = SmallSlidingResult(lap.history, free, lap.time, result.history.bodies)
    np.testing.assert_allclose(found.sliding - still.sliding, np.tile([*way[:2], 0.0], (len(lap.time), 1)), atol=1e-9)
    assert found.warnings() and not still.warnings()


# --- files, arrays, report


def test_a_result_knows_its_small_sliding_contacts(result: Result) -> None:
    assert result.small_sliding_names == ["lap"] and "cells=24" in repr(result.contact("lap"))
    with pytest.raises(InputError, match="no contact called 'steps'; it has: 'lap'"):
        result.contact("steps")


def test_files_bring_everything_back(result: Result, lap: SmallSlidingResult, tmp_path: Path) -> None:
    found = Result.load(result.save(tmp_path / "run.h5")).contact("lap")
    for field in fields(SmallSlidingHistory):
        np.testing.assert_array_equal(getattr(found.history, field.name), getattr(lap.history, field.name))
    assert {field.attribute for field in SMALL_SLIDING_FIELDS} == {field.name for field in fields(SmallSlidingHistory)}
    for field in fields(lap.view):
        if not field.name.endswith("_body"):
            np.testing.assert_array_equal(getattr(found.view, field.name), getattr(lap.view, field.name))
    np.testing.assert_array_equal(found.polygons[0], lap.polygons[0])
    np.testing.assert_allclose(found.sliding, lap.sliding, rtol=1e-12, atol=1e-20)
    with h5py.File(tmp_path / "run.h5") as file:
        stored: Any = file["small_sliding_pressure/lap"]
        assert stored.attrs["units"] == "Pa" and stored.attrs["dims"] == "time small_sliding_cell"
        derived: Any = file["small_sliding_loss"]
        np.testing.assert_array_equal(derived[:, 0], lap.loss)


@pytest.mark.parametrize("name", ["small_sliding_pressure/lap", "small_sliding_slip/lap"])
def test_wrong_arrays_are_refused(result: Result, name: str, tmp_path: Path) -> None:
    path = result.save(tmp_path / "run.h5")
    with h5py.File(path, "r+") as file:
        values = np.asarray(file[name])
        attributes = dict(file[name].attrs)
        del file[name]
        file[name] = np.concatenate([values, values[:, :1]], axis=1)
        file[name].attrs.update(attributes)
    seal(path)
    with pytest.raises(InputError, match="lap"):
        Result.load(path)


def test_an_array_has_the_names_of_the_file(result: Result, lap: SmallSlidingResult) -> None:
    data = result.to_xarray()
    np.testing.assert_array_equal(data["small_sliding_pressure_lap"], lap.pressure)
    assert data["small_sliding_pressure_lap"].dims == ("time", "small_sliding_cell_lap")
    np.testing.assert_array_equal(data["small_sliding_slip_area"].sel(small_sliding="lap"), lap.slip_area)
    assert list(data["along"].values) == ["t_1", "t_2"]
    np.testing.assert_array_equal(data["small_sliding_point_lap"], lap.points)


def test_parts_of_a_run_join(result: Result, lap: SmallSlidingResult) -> None:
    joined = joined_parts([result.history, result.history]).small_sliding["lap"]
    assert joined.pressure.shape == (2 * len(lap.time), lap.cells)


def test_the_part_of_a_run_from_a_time_on(result: Result, lap: SmallSlidingResult, tmp_path: Path) -> None:
    """Its last cycle: all arrays are those of its rows, also from a file; totals count from the start of the run."""
    read = Result.load(result.save(tmp_path / "run.h5"))
    rows = slice(STEPS * (len(result.time) // STEPS - 1), None)
    for whole in (result, read):
        part = whole.since(whole.time[-1] - PERIOD)
        assert np.array_equal(part.time, whole.time[rows]) and len(part.time) == STEPS + 1
        own = part.contact("lap")
        for name in ("force", "pressure", "slip", "loss", "slip_area"):
            np.testing.assert_array_equal(getattr(own, name), getattr(lap, name)[rows])
        assert part.joint("foot").names == whole.joint("foot").names
        np.testing.assert_array_equal(part.sensor("tip").values, whole.sensor("tip").values[rows])
        np.testing.assert_array_equal(part.energy["friction"], whole.energy["friction"][rows])
        assert f"{part.time[0]:.6g} to {part.time[-1]:.6g} s, {STEPS + 1} rows saved" in part.report(progress=False)
        assert len(whole.time) == len(lap.time)  # the run is not changed
    with pytest.raises(InputError, match="since: no saved step from 9 s on; the last one is at 2 s"):
        result.since(9.0)


def test_errors_are_reported_of_force_and_loss(result: Result, lap: SmallSlidingResult) -> None:
    found = quantities(result.history)
    assert found["loss of contact 'lap'"].size == pytest.approx(lap.loss[-1])
    assert found["force of contact 'lap'"].size > PRESSED


def test_the_report_names_small_sliding_contacts(result: Result) -> None:
    text = result.report()
    assert "contact 'lap': normal force 2000 N (largest 2000)" in text
    assert f"loss            {result.contact('lap').loss[-1]:.5g} J by friction, in 24 cells" in text
    assert "each load step ends in an equilibrium" in text  # there is no error of time


# --- pictures


@pytest.mark.parametrize("kind", SMALL_SLIDING_PLOTS)
def test_plots(result: Result, kind: str) -> None:
    import matplotlib.pyplot as plt

    ax = result.plot(kind, row=10)
    assert "lap" in ax.get_title().lower()
    plt.close("all")
    with pytest.raises(InputError, match="no contact called 'rivet'"):
        result.plot(kind, contact="rivet")


def test_a_map_has_the_colour_of_its_cells(result: Result, lap: SmallSlidingResult) -> None:
    ax: Any = result.plot("patch", row=10)
    (cells,) = ax.collections
    np.testing.assert_allclose(cells.get_array(), lap.pressure[10, lap.polygons[1]] * 1e-6)


def test_pages_and_summaries(result: Result, tmp_path: Path) -> None:
    figure = result.small_sliding_page(times=[0.25, 1.24])
    assert len([ax for ax in figure.axes if ax.get_title()]) == 6
    assert write_figure(result, tmp_path / "summary.png").stat().st_size > 0
    found = result.hysteresis(("push", "x"), ("tip", "x"))
    assert save_panels([found, found.stiffness(0.0, 0.25)], tmp_path / "loop.png").exists()
    with pytest.raises(InputError, match="saved steps go from 0 to 2 s"):
        result.small_sliding_page(times=[3.0])


def test_a_recording_shows_cells(result: Result, lap: SmallSlidingResult, tmp_path: Path) -> None:
    path = record(result, tmp_path / "run.rrd", max_frames=5, deformation_factor=1.0).path
    places = [np.asarray(p) for p in columns(path, "/world/small_sliding/lap/pressure", "vertex_positions")]
    corners = lap.polygons[0].reshape(-1, 3)
    assert np.max(np.abs(places[-1] - corners)) < 1e-5  # of blocks that yield by micrometres
    colors = [np.asarray(c) for c in columns(path, "/world/small_sliding/lap/state", "vertex_colors")]
    assert len(places) == len(colors) == 5 and len(colors[0]) == len(corners)
    assert columns(path, "/plots/small_sliding_loss/lap", "scalars")


def test_a_recording_colours_the_faces(result: Result, lap: SmallSlidingResult, tmp_path: Path) -> None:
    """Of both bodies, where they lie on each other, by the pressure of the small-sliding contact."""
    path = record(result, tmp_path / "run.rrd", max_frames=3, color="pressure").path
    for name in ("base", "top"):
        colors = np.asarray(columns(path, f"/world/{name}/surface", "vertex_colors")[-1])
        skin = result.skins()[name]
        on = skin.pressure(len(result.time) - 1) > 0.0
        assert on.sum() == (CELLS[0] + 1) * (CELLS[1] + 1) and len(np.unique(colors[~on])) == 1
        assert not np.isin(colors[on][np.argmax(skin.pressure(len(result.time) - 1)[on])], colors[~on])


def test_vtk_has_the_cells_as_a_part(result: Result, lap: SmallSlidingResult, tmp_path: Path) -> None:
    blocks, _ = read_vtkhdf(result.to_vtkhdf(tmp_path / "run.vtkhdf", stride=20), 1)
    mesh, body = blocks["lap"], blocks["top"].point_data
    np.testing.assert_allclose(mesh.cell_data["pressure"], lap.pressure[20, lap.polygons[1]])
    np.testing.assert_allclose(body["pressure"], result.skins()["top"].pressure(20), rtol=1e-9)
    assert set(body) == {"displacement", "pressure", "traction", "state"}
    turned = np.linalg.norm(mesh.cell_data["slip"], axis=1)
    np.testing.assert_allclose(turned, lap.shift_distance[20, lap.polygons[1]], rtol=1e-9, atol=1e-18)
