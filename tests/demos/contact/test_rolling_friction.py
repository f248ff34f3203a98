"""Rollers with friction on a coarse grid: carried along, braked, slipping; the whole demo among the slow tests."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import rolling_friction as demo
from demos.rolling_friction import FRICTION, LOAD, PAIR, RELATIVE_RADIUS, STEEL, WIDTH, Size, schedule, shares
from references.closed_forms import CarterRolling, LineContact, contact_modulus

HERTZ = LineContact(LOAD / WIDTH, RELATIVE_RADIUS, contact_modulus(STEEL, STEEL))
AGREE = 5e-5  # of the surface speed: rolling freely, what is left of the flywheel's swinging
CELL_ERROR = 0.7  # of the creepage, times the square of the cells in a half-width: 0.5 at 5 of them, 0.4 at 7.6
EXTRAPOLATED = 0.015  # of the creepage, from two grids: ends of the rollers, and what is of higher order in the cell
ON_PATCH = 0.01  # of the creepage, from cells of the patch: ends of the rollers, thirteen cells
BESIDE = 0.02  # of the creepage, of both runs from each other
COEFFICIENT = 1e-3  # tractions are tangents of a patch that is an arc, (a/R)^2, and it slips with mu on all sides
DISSIPATION = 1e-12  # of the work of friction: rounding


def on_carters_curve(result: wf.Result, *, line_load: float | None = None) -> list[tuple[float, float, float]]:
    """At the end of each wait of the brake: share of the friction force, creepage found, and Carter's at that share.

    Carter's is that of `line_load` [N/m], unless given the one found at mid-width, which is a little above the mean.
    """
    pair, found = result.contact(PAIR), shares(result)
    values = []
    for end in schedule().waits:
        load = demo.settled(result, pair.line_load, end) if line_load is None else line_load
        line = LineContact(load, RELATIVE_RADIUS, HERTZ.modulus)
        share = demo.settled(result, found, end)
        creepage = demo.settled(result, pair.friction.creepage[:, 0], end)
        values.append((share, creepage, CarterRolling.from_share(line, FRICTION, share).creepage))
    return values


def extrapolated(fine: wf.Result, coarse: wf.Result) -> list[float]:
    """Creepage at the end of each wait from two grids, of which one has cells twice as large.

    With friction in cells the creepage that belongs to a force is too small, by about half of the cell over the
    half-width squared; xi + (xi - xi_coarse)/3 is left with an error of higher order.
    """
    found = zip(on_carters_curve(fine), on_carters_curve(coarse), strict=True)
    return [xi + (xi - carter * xi_coarse / carter_coarse) / 3.0
            for (_, xi, carter), (_, xi_coarse, carter_coarse) in found]  # fmt: skip


def checks(result: wf.Result, coarse: wf.Result, size: Size) -> list[Check]:
    """The figures of a run, and of one with cells twice as large."""
    found = _free("", result)
    of_cells = CELL_ERROR * (size.spacing / HERTZ.half_width) ** 2
    for (share, xi, carter), best in zip(on_carters_curve(result), extrapolated(result, coarse), strict=True):
        label = f"creepage at {share:.2f} mu P"
        found += [
            Check(label, xi, carter, "Carter", of_cells),
            Check(f"{label}, two grids", best, carter, "Carter", EXTRAPOLATED),
        ]
    return [*found, *_slipping("", result)]


def checks_on_patch(result: wf.Result, fine: wf.Result, coarse: wf.Result) -> list[Check]:
    """The figures of the run on cells of the patch, also compared with the two others."""
    found = _free("4 mm: ", result)
    settled = on_carters_curve(result, line_load=LOAD / WIDTH)
    for (share, xi, carter), best in zip(settled, extrapolated(fine, coarse), strict=True):
        label = f"4 mm: creepage at {share:.2f} mu P"
        found += [
            Check(label, xi, carter, "Carter, mean line load", ON_PATCH),
            Check(label, xi, best, "the other mesh, two grids", BESIDE),
        ]
    return [*found, *_slipping("4 mm: ", result)]


def _free(label: str, result: wf.Result) -> list[Check]:
    free = demo.settled(result, result.contact(PAIR).friction.creepage[:, 0], schedule().free)
    return [Check(f"{label}rolling freely: speeds differ by", free, 0.0, "no torque, over the speed", AGREE, scale=1.0)]


def _slipping(label: str, result: wf.Result) -> list[Check]:
    pair = result.contact(PAIR)
    force = np.hypot(pair.force[-1, 0], pair.force[-1, 1]) / pair.force[-1, 2]
    stick, work = float((pair.friction.state[-1] == 1).sum()), result.energy["friction"]
    return [
        Check(f"{label}traction coefficient in gross slip", abs(float(force)), FRICTION, "Coulomb", COEFFICIENT),
        Check(f"{label}cells that stick then", stick, 0.0, "all slip", 0.0, scale=1.0),
        Check(f"{label}largest gain from friction", max(float(np.diff(work).max()), 0.0), 0.0,
              "takes energy only, over all work", DISSIPATION, "J", scale=float(np.ptp(work))),
    ]  # fmt: skip


SMALL = demo.Size(sectors=750, layers=8)


@pytest.fixture(scope="module")
def result() -> wf.Result:
    found = demo.run(demo.build(SMALL, progress=False), SMALL, progress=False)
    assert found.status == "completed", found.message
    return found


@pytest.mark.slow
def test_the_upper_roller_is_carried_along_and_then_slips(result: wf.Result) -> None:
    plan, t = demo.schedule(), result.time
    lower, upper = (np.abs(result.body(name).angular_velocity[:, 1]) for name in ("lower", "upper"))
    free = int(np.flatnonzero(t <= plan.free)[-1])
    assert upper[0] < 1e-9 and upper[free] == pytest.approx(lower[free], rel=1e-3)
    pair = result.contact(demo.PAIR)
    assert np.hypot(*pair.force[-1, :2]) / -pair.force[-1, 2] == pytest.approx(0.3, rel=COEFFICIENT)
    # brake less friction slows the flywheel and the roller on it down
    inertia = demo.FLYWHEEL_INERTIA[1] + result.history.scene.body("upper").inertia[1, 1]  # pyright: ignore
    excess = (demo.BEYOND - 1.0) * 0.3 * demo.LOAD * demo.OUTER_RADIUS
    late = t > t[-1] - 3 * demo.CROSSING
    slows = -np.polyfit(t[late], upper[late], 1)[0]
    assert slows == pytest.approx(excess / inertia, rel=0.01)


def test_the_creepage_is_carters_up_to_the_cells(result: wf.Result) -> None:
    """Carter in closed form here: xi = mu a/R' (1 - sqrt(1 - q)) at the mean line load."""
    E_star, R = 210e9 / (2 * (1 - 0.3**2)), 0.025
    a = np.sqrt(4 * 13e3 / 0.01 * R / (np.pi * E_star))
    for share, xi, _ in on_carters_curve(result):
        carter = 0.3 * a / R * (1 - np.sqrt(1 - share))
        assert 1.0 - CELL_ERROR * (SMALL.spacing / a) ** 2 < xi / carter < 1.0  # too small, see `extrapolated`
    assert np.all(np.diff(result.energy["friction"]) <= 1e-12)
    assert result.contact(demo.PAIR).friction.cells_per_step.max() <= 1.0


@pytest.mark.slow
def test_the_creepage_on_a_mesh_of_4_mm_is_carters() -> None:
    """The same in closed form; cells travel with the patch, of which an element is seven half-widths long."""
    result = demo.run(demo.build(demo.QUICK, progress=False), demo.QUICK, progress=False)
    assert result.status == "completed" and result.contact(demo.PAIR).loaded == "cells"
    E_star, R = 210e9 / (2 * (1 - 0.3**2)), 0.025
    a = np.sqrt(4 * 13e3 / 0.01 * R / (np.pi * E_star))
    for share, xi, _ in on_carters_curve(result):
        assert xi == pytest.approx(0.3 * a / R * (1 - np.sqrt(1 - share)), rel=ON_PATCH)
    pair = result.contact(demo.PAIR)
    assert np.hypot(*pair.force[-1, :2]) / -pair.force[-1, 2] == pytest.approx(0.3, rel=COEFFICIENT)
    assert np.all(pair.friction.state[-1] != 1) and np.all(np.diff(result.energy["friction"]) <= 1e-12)


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    """Compared with runs on a fine mesh made for the contact, and on one with cells twice as large."""
    (on_patch,) = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "rolling_friction")
    size = demo.Size(sectors=1500 if quick else 2000)
    fine, coarse = (demo.run(demo.build(s, progress=False), s, progress=False)
                    for s in (size, replace(size, sectors=size.sectors // 2)))  # fmt: skip
    assert not missed([*checks(fine, coarse, size), *checks_on_patch(on_patch, fine, coarse)])
    assert demo.HALF_WIDTH == pytest.approx(HERTZ.half_width, rel=1e-12)
    assert demo.carter(0.3) == pytest.approx(CarterRolling.from_share(HERTZ, FRICTION, 0.3).creepage, rel=1e-12)
