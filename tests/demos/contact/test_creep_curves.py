"""Crowned rollers rolled with creepages and spin: CONTACT's force, Kalker's coefficient; the whole demo, quick, among
the slow tests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import creep_curves as demo
from demos.creep_curves import (
    CROWN,
    FRICTION,
    LOAD,
    OUTER_RADIUS,
    PAIR,
    POISSON,
    SEMI_ACROSS,
    SEMI_ALONG,
    SHEAR,
    SPINS,
    STEEL,
    Size,
    Stair,
    rows,
    stairs,
)
from references.closed_forms import contact_modulus
from references.closed_forms import rolling_tables as published
from references.closed_forms.elliptic import EllipticContact
from references.half_space.patch_rolling import HalfSpaces, PatchRolling, settle

HERTZ = EllipticContact(LOAD, 0.5 * OUTER_RADIUS, 0.5 * CROWN, contact_modulus(STEEL, STEEL))
SIZE = float(np.sqrt(SEMI_ALONG * SEMI_ACROSS))  # m
CREEPAGES = tuple(xi for xi, _ in published.EUROSPRINTER_FORCES)
LITTLE = CREEPAGES[0], CREEPAGES[0], SPINS[0]  # at which nearly all sticks, for Kalker's coefficients
CONTACT_ERROR = 0.01  # of mu N: CONTACT's own cells, see `rolling_tables`
HALF_SPACE_ERROR = 0.01  # of mu N: cells here and there
AXES = 0.01  # of the half-axes
BOUND = 1e-6  # of mu N above the bound
BALANCE = 1e-4  # of the load
DISSIPATION = 1e-9  # of the work of friction


@dataclass(frozen=True)
class Curve:
    """At the end of each stair: forces (n, 2) over mu N and spin moment (n,) over mu N sqrt(a b), on the upper body, so
    that they have the signs of the creepages."""

    forces: np.ndarray
    moment: np.ndarray

    def minus(self, other: Curve) -> float:
        """Largest difference of a force or moment from another curve's."""
        return float(max(np.abs(self.forces - other.forces).max(), np.abs(self.moment - other.moment).max()))


def curve(result: wf.Result, run: Sequence[Stair]) -> Curve:
    """What a run finds."""
    pair, at = result.contact(PAIR), rows(result, run)
    most = FRICTION * pair.normal_load[at]
    forces, moment = pair.friction.tangential_force[at], pair.friction.spin_moment[at]
    return Curve(-forces / most[:, None], -moment / (most * SIZE))


def of_half_spaces(run: Sequence[Stair], columns: int) -> Curve:
    """The same of two half-spaces, each stair rolled until it is steady."""
    rolling = PatchRolling(HERTZ, FRICTION, (columns, columns), HalfSpaces(STEEL, STEEL))
    forces, moments = [], []
    for stair in run:
        forces.append(-settle(rolling, 1.0, stair)[-1])
        x, y = rolling.centers.T
        moment = (x * rolling.traction[:, 1] - y * rolling.traction[:, 0]).sum() * rolling.area
        moments.append(-moment / (FRICTION * LOAD * SIZE))
    return Curve(np.array(forces), np.array(moments))


def kalker() -> np.ndarray:
    """C11, C22, C23 at this Poisson's ratio; the patch has a/b = 0.49995."""
    table = np.array(published.KALKER[0.5])
    return np.array([np.polynomial.Polynomial.fit(published.KALKER_POISSON, row, 2)(POISSON) for row in table])


def slopes() -> np.ndarray:
    """(3,) what Kalker's coefficients are multiplied by: force over mu N by creepages [-] and by spin [1/m]."""
    return SHEAR * SEMI_ALONG * SEMI_ACROSS / (FRICTION * LOAD) * np.array([1.0, 1.0, SIZE])


WITH_SPIN = 4.0  # rad/m together with longitudinal creepage


def all_stairs(size: Size) -> dict[str, list[Stair]]:
    """Those of the demo, of both creepages together, and of longitudinal creepage with spin."""
    runs, half = stairs(size), np.sqrt(0.5)
    creepages = [xi for xi, _, _ in runs["longitudinal"]]
    return {
        **runs,
        "both": [(half * c, half * c, 0.0) for c in creepages],
        "with_spin": [(c, 0.0, WITH_SPIN * sign) for c, sign in zip(creepages, demo.SIGNS, strict=False)],
    }


def checks(results: dict[str, wf.Result], exact: dict[str, Curve], size: Size, kalker_error: float) -> list[Check]:
    """The figures of all runs, compared with CONTACT, Kalker, half-spaces and Coulomb; kalker_error: of forces without
    slip, by the cells that the patch touches at its sides."""
    runs = all_stairs(size)
    found = {name: curve(result, runs[name]) for name, result in results.items()}
    pair = results["longitudinal"].contact(PAIR)
    a, b = pair.half_widths[0]
    values = [
        Check("contact force", float(pair.normal_load[-1]), LOAD, "statics", BALANCE, "N"),
        Check("half-axis along the rolling direction", float(a), SEMI_ALONG, "Hertz", AXES, "um", 1e6),
        Check("half-axis across", float(b), SEMI_ACROSS, "Hertz", AXES, "um", 1e6),
    ]
    for (xi, wanted), share in zip(published.EUROSPRINTER_FORCES[:: size.every], found["longitudinal"].forces[:, 0],
                                   strict=True):  # fmt: skip
        values.append(Check(f"Fx/(mu N) at {xi * 1e3:.2g}e-3", share, wanted, "CONTACT", CONTACT_ERROR, scale=1.0))
    little = np.array([found["longitudinal"].forces[0, 0], found["lateral"].forces[0, 1], found["spin"].forces[0, 1]])
    coefficients = little / (slopes() * LITTLE)
    for label, value, wanted in zip(("C11", "C22", "C23"), coefficients, kalker(), strict=True):
        values.append(Check(label, float(value), float(wanted), "Kalker's table", kalker_error))
    for name in exact:
        label = f"{name.replace('_', ' ')}, {len(runs[name])} stairs: differs by"
        values.append(Check(label, found[name].minus(exact[name]), 0.0, "half-spaces, over mu N", HALF_SPACE_ERROR,
                            scale=1.0))  # fmt: skip
    largest = max(float(np.nanmax(result.contact(PAIR).friction.traction_coefficient)) for result in results.values())
    gain = max(float(np.diff(result.energy["friction"]).max()) for result in results.values())
    work = max(float(np.ptp(result.energy["friction"])) for result in results.values())
    return [
        *values,
        Check("largest traction coefficient", max(largest, FRICTION), FRICTION, "Coulomb", BOUND),
        Check("largest gain from friction", max(gain, 0.0), 0.0, "takes energy only", DISSIPATION, "J", scale=work),
    ]


SMALL = demo.QUICK
# CONTACT's Eurosprinter: force over mu N at a longitudinal creepage of 1.2e-3
CONTACT = 0.6482
# Kalker's C23 of an ellipse twice as long across as along the rolling direction, at Poisson's ratios 0.25 and 0.5
C23 = 0.929, 1.07


@pytest.fixture(scope="module")
def body() -> wf.ReducedBody:
    return demo.reduced(progress=False)


def rolled(body: wf.ReducedBody, run: list[demo.Stair]) -> tuple[wf.Result, Curve]:
    result = demo.roll(demo.build(run, SMALL, body=body, progress=False), run, SMALL, progress=False)
    assert result.status == "completed", result.message
    return result, curve(result, run)


@pytest.mark.slow
def test_the_force_is_contacts(body: wf.ReducedBody) -> None:
    result, found = rolled(body, [(1.2e-3, 0.0, 0.0)])
    pair = result.contact(demo.PAIR)
    assert pair.loaded == "cells" and pair.normal_load[-1] == pytest.approx(170.72, rel=1e-4)
    assert pair.friction.creepage[-1] == pytest.approx([1.2e-3, 0.0], abs=2e-6)
    assert found.forces[0] == pytest.approx([CONTACT, 0.0], abs=CONTACT_ERROR)


def test_a_little_spin_makes_kalkers_lateral_force_and_no_other(body: wf.ReducedBody) -> None:
    spin = 0.1
    result, found = rolled(body, [(0.0, 0.0, spin)])
    friction = result.contact(demo.PAIR).friction
    assert friction.spin_creepage[-1] == pytest.approx(spin, rel=1e-3)
    # -G (a b)^(3/2) C23 phi; the patch of the wheel on the rail, 6.304 and 12.61 mm, at a twenty-fifth of its size
    c23 = 0.12 * (C23[1] - C23[0]) + C23[0]
    force = 82e9 * (6.304e-3 * 12.61e-3 * 0.04**2) ** 1.5 * c23 * spin
    assert -friction.tangential_force[-1, 1] == pytest.approx(force, rel=0.03)
    assert abs(found.forces[0, 0]) < 1e-2 * found.forces[0, 1]


def test_both_creepages_share_what_friction_gives(body: wf.ReducedBody) -> None:
    result, found = rolled(body, [(2.3e-3, 2.3e-3, 0.0)])
    assert np.all(result.contact(demo.PAIR).friction.traction_coefficient <= 0.33 * (1.0 + BOUND))
    assert 0.95 < np.hypot(*found.forces[0]) < 1.0 and found.forces[0, 0] > found.forces[0, 1] > 0.6


@both_sizes
def test_the_whole_demo(tmp_path: Path, body: wf.ReducedBody, quick: bool) -> None:
    size, columns, kalker_error = (demo.QUICK, 13, 0.04) if quick else (demo.FULL, 17, 0.02)
    runs, found = all_stairs(size), demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "creep_curves", "lateral", "spin")
    results = dict(zip(stairs(size), found, strict=True))
    for name in ("both", "with_spin"):
        scene = demo.build(runs[name], size, body=body, progress=False)
        results[name] = demo.roll(scene, runs[name], size, progress=False)
    exact = {name: of_half_spaces(run, columns) for name, run in runs.items() if name != "longitudinal"}
    assert not missed(checks(results, exact, size, kalker_error))


def test_the_figures_of_the_demo_are_the_published_ones() -> None:
    assert tuple(demo.CONTACT.items()) == published.EUROSPRINTER_FORCES
    found = (POISSON, SHEAR, FRICTION, LOAD, OUTER_RADIUS, CROWN)
    radii = (2.0 * 0.04 * radius for radius in published.EUROSPRINTER_RADII)
    exact = (published.EUROSPRINTER_POISSON, published.EUROSPRINTER_SHEAR, published.EUROSPRINTER_FRICTION)
    assert found == pytest.approx((*exact, published.EUROSPRINTER_LOAD * 0.04**2, *radii), rel=1e-12)
    assert (SEMI_ALONG, SEMI_ACROSS) == pytest.approx(HERTZ.half_axes, rel=1e-8)
