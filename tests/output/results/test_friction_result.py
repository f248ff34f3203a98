"""Friction of a pair against Carter's closed form, and what is asked of a pair without friction."""

from __future__ import annotations

import numpy as np
import pytest
from rubbing_run import (
    CREEPAGE,
    MU,
    SHIFT,
    SPEED,
    STICK,
    add_friction,
    carter_slip,
    carter_traction,
    make_rubbing_history,
)
from shape_runs import contact_of, ellipsoid, grid_of
from synthetic_run import HALF_WIDTH, PEAK, PITCH, ROWS, WIDTH, R, make_history

from warpffrf.model.errors import InputError
from warpffrf.model.surfaces import Bore, Cylinder, Plane, Sphere
from warpffrf.online.history.history import FrictionHistory
from warpffrf.output.contact.friction import OPEN, SLIP
from warpffrf.output.contact.friction import STICK as STICKS
from warpffrf.output.contact.pair_result import PairResult
from warpffrf.output.contact.result import ContactResult
from warpffrf.output.result import Result

CELL = R * PITCH


@pytest.fixture
def rubbing(body) -> Result:
    return Result(make_rubbing_history(body))


@pytest.fixture
def contact(rubbing: Result) -> PairResult:
    return rubbing.contact("lower-upper")


def test_carter_s_force_from_the_tractions(contact: ContactResult) -> None:
    """Q = mu P (1 - (c/a)^2), with the tractions sampled at eight points across: a few percent."""
    friction = contact.friction
    peak = PEAK * (1.0 + np.linspace(0.0, 1.0, len(contact.force)))
    load = 0.5 * np.pi * HALF_WIDTH * peak * WIDTH
    expected = MU * load * (1.0 - (STICK / HALF_WIDTH) ** 2)
    assert friction.tangential_force[:, 0] == pytest.approx(expected, rel=0.05)
    assert np.all(friction.tangential_force[:, 1] == 0.0)
    # and exactly the sum of what was put in: the cells' areas on the cylinder add up to arc times width
    rows = contact.history.friction.traction[:, 0, :, 1].sum(axis=1) * CELL * WIDTH
    assert friction.tangential_force[:, 0] == pytest.approx(rows, rel=1e-12)
    assert friction.traction_coefficient == pytest.approx(rows / contact.normal_load, rel=1e-12)


def test_creepage_is_creep_over_rolling_speed(contact: ContactResult) -> None:
    assert contact.friction.creepage[:, 0] == pytest.approx(np.full(len(contact.force), CREEPAGE))
    assert np.all(contact.friction.creepage[:, 1] == 0.0)
    contact.history.friction.rolling_velocity[2] = -SPEED  # the direction of creep stays
    contact.history.friction.rolling_velocity[3] = 0.0
    again = ContactResult(contact.history, contact.view).friction.creepage
    assert again[2, 0] == pytest.approx(CREEPAGE) and np.isnan(again[3, 0])


def test_a_pair_that_stands_has_no_creepage(contact: ContactResult) -> None:
    contact.history.friction.rolling_velocity[:] = 0.0
    assert np.all(np.isnan(ContactResult(contact.history, contact.view).friction.creepage))


def test_power_of_the_fields_is_the_integral(contact: ContactResult) -> None:
    friction = contact.friction
    fine = np.linspace(-HALF_WIDTH, HALF_WIDTH, 200_001)
    peak = PEAK * (1.0 + np.linspace(0.0, 1.0, len(contact.force)))
    integral = -np.trapezoid(carter_traction(fine, 1.0) * carter_slip(fine), fine) * WIDTH
    assert friction.power == pytest.approx(integral * peak, rel=1e-5)  # ten times coarser points there
    assert np.all(friction.field_power > 0.0)
    assert friction.field_power == pytest.approx(integral * peak, rel=0.1)  # a third of the patch slips: 3 cells
    # where everything that moves slips at the bound, power is mu times the wear index
    assert friction.field_power == pytest.approx(MU * friction.wear_rate, rel=0.05)
    assert np.all(friction.wear_peak * contact.patch_area >= friction.wear_rate)


def test_stick_and_slip_areas(contact: ContactResult) -> None:
    friction = contact.friction
    assert friction.stick_area == pytest.approx(np.full(9, 2.0 * STICK * WIDTH), abs=1.01 * CELL * WIDTH)
    assert friction.slip_area == pytest.approx(np.full(9, 2.0 * SHIFT * WIDTH), abs=1.01 * CELL * WIDTH)
    touching = (friction.state != OPEN).sum(axis=(1, 2)) / ROWS
    assert friction.stick_area + friction.slip_area == pytest.approx(touching * CELL * WIDTH)


def test_profile_at_mid_width_runs_along_e_theta(contact: ContactResult) -> None:
    i = 4
    profile = contact.friction.profile(i, MU)
    assert np.all(np.diff(profile["arc"]) > 0.0)
    peak = PEAK * (1.0 + i / 8.0)
    assert profile["traction"] == pytest.approx(carter_traction(profile["arc"], peak), rel=1e-9, abs=1.0)
    assert profile["bound"] == pytest.approx(MU * profile["pressure"])
    sticks, slips = profile["arc"][profile["state"] == STICKS], profile["arc"][profile["state"] == SLIP]
    assert sticks.max() < slips.min()  # material enters on the left, where it sticks
    assert np.all(np.isnan(contact.friction.profile(i)["bound"]))
    count = len(contact.friction.power)
    from_the_end = contact.friction.profile(i - count, MU)
    for name, values in profile.items():
        np.testing.assert_array_equal(from_the_end[name], values)
    for wrong in (count, -count - 1):
        with pytest.raises(InputError, match=f"saved step {wrong} does not exist; there are {count}"):
            contact.friction.profile(wrong)


def test_inside_forms_turn_the_profile() -> None:
    """On a bore e_theta points against increasing theta: the same field over theta is mirrored."""
    shapes = {1.0: Cylinder(radius=0.03, axis_point=(0, 0, 0), axis_direction=(0, 1, 0)), -1.0: Bore(
        radius=0.03, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))}  # fmt: skip
    profiles = {}
    for side, shape in shapes.items():
        grid = grid_of(shape, 1e-3, 41, np.linspace(-0.01, 0.01, 3))
        ramp = np.zeros((1, 2, 41, 3))
        ramp[0, 0] = np.arange(41.0)[:, None]
        nothing = np.zeros((1, 41, 3))
        friction = FrictionHistory(
            ramp, np.zeros_like(ramp), nothing.astype(np.int8), np.zeros(1), np.zeros((1, 2)), np.zeros(1), np.zeros(1)
        )
        pressure = ellipsoid(4e-4, 1.0, 1e9)
        contact = contact_of(shape, grid, shape, lambda t, z, p=pressure: p(0.03 * t, 0.0 * z), friction=friction)
        assert contact.side == side
        profiles[side] = contact.friction.profile(0)
    for profile in profiles.values():
        assert np.all(np.diff(profile["arc"]) > 0.0)
    assert profiles[-1.0]["traction"] == pytest.approx(profiles[1.0]["traction"][::-1])


@pytest.mark.parametrize(("cells", "warned"), [(11, True), (101, False)])
def test_a_thin_slip_annulus_is_warned_about(cells: int, warned: bool) -> None:
    """Cattaneo and Mindlin: of a circle of radius a that carries Q all beyond a (1 - Q/(mu N))^(1/3) slips. The annulus
    in cells is that of the closed form to what whole cells leave of areas; where all slips, none is left."""
    R, a, share = 0.02, 2e-4, 0.5
    ball = Sphere(radius=R, axis_point=(0, 0, 0), axis_direction=(0.0, 1.0, 0.0))
    floor = Plane(origin=(R, 0.0, 0.0), outward=(-1.0, 0.0, 0.0))
    step = 2.0 * a / cells
    grid = grid_of(ball, step / R, cells + 6, step * (np.arange(cells + 6) - 0.5 * (cells + 5)))
    r = np.hypot(R * grid.theta[:, None], np.asarray(grid.z)[None, :])
    rim = a * np.cbrt(1.0 - share)
    for stuck in (rim, 0.0):
        state = np.where(r >= a, OPEN, np.where(r < stuck, STICKS, SLIP))[None].astype(np.int8)
        zero = np.zeros((1, 2, *r.shape))
        rubs = FrictionHistory(zero, zero, state, np.zeros(1), np.zeros((1, 2)), np.zeros(1), np.zeros(1))
        contact = contact_of(ball, grid, floor, lambda t, z: ellipsoid(a, a, 1e9)(R * t, z), friction=rubs)
        friction = contact.friction
        if stuck == 0.0:
            assert np.isnan(friction.slip_width) and friction.warning() is None
            continue
        width = (a - rim) / step
        assert friction.slip_width == pytest.approx(width, abs=0.15 + 0.01 * width)
        assert (friction.warning() is not None) == warned
        assert not warned or f"may err by about {friction.loss_error:.0%}" in str(friction.warning())


def test_more_than_a_cell_per_step_is_warned_about(body) -> None:
    result = Result(add_friction(make_history(body), cells=2.5))
    warning = result.contact("lower-upper").friction.warning()
    assert warning is not None and "2.5 cells per step, in 9 of 9" in warning and "2.5 times shorter" in warning
    assert warning in result.report()
    slow = Result(add_friction(make_history(body), cells=1.0))
    assert slow.contact("lower-upper").friction.warning() is None and "warning" not in slow.report()


def test_report_has_the_figures_of_friction(rubbing: Result) -> None:
    text = rubbing.report()
    friction = rubbing.contact("lower-upper").friction
    for part in (
        f"{friction.traction_coefficient[-1]:.5g} of the load", f"creepage        {CREEPAGE:+.4e} longitudinal",
        f"friction power  {friction.power[-1]:.5g} W", "cells per step  0.25", "work of friction since the start",
    ):  # fmt: skip
        assert part in text


def test_a_pair_without_friction_says_so(result: Result) -> None:
    contact = result.contact("lower-upper")
    assert not contact.has_friction
    with pytest.raises(InputError, match=r"contact 'lower-upper' has no friction.*give Contact\(\.\.\., friction=mu\)"):
        _ = contact.friction
    assert "friction" not in result.report()


def test_open_rows_are_nan_or_zero(body) -> None:
    history = make_rubbing_history(body)
    contact = history.contacts["lower-upper"]
    contact.pressure[2] = 0.0
    assert contact.friction is not None
    contact.friction.traction[2] = contact.friction.slip_velocity[2] = 0.0
    contact.friction.state[2] = OPEN
    friction = Result(history).contact("lower-upper").friction
    assert np.all(np.isnan(friction.creepage[2])) and np.all(np.isfinite(friction.creepage[3]))
    assert np.isnan(friction.traction_coefficient[2]) and friction.wear_rate[2] == 0.0
    assert friction.stick_area[2] == friction.slip_area[2] == 0.0
    assert np.all(np.isfinite(friction.traction_coefficient[[0, 1, 3]]))
