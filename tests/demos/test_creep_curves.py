"""Crowned rollers rolled with creepages and spin: CONTACT's force, Kalker's coefficient; the whole demo, quick, among
the slow tests."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind

import warpffrf as wf
from demos import creep_curves as demo

SMALL = demo.Size(cells=15, columns=13, every=3, frames=5, kalker_error=0.04)
# CONTACT's Eurosprinter: force over mu N at a longitudinal creepage of 1.2e-3
CONTACT = 0.6482
# Kalker's C23 of an ellipse twice as long across as along the rolling direction, at Poisson's ratios 0.25 and 0.5
C23 = 0.929, 1.07


@pytest.fixture(scope="module")
def body() -> wf.ReducedBody:
    return demo.reduced(progress=False)


def rolled(body: wf.ReducedBody, run: list[demo.Stair]) -> tuple[wf.Result, demo.Curve]:
    result = demo.roll(demo.build(run, SMALL, body=body, progress=False), run, SMALL, progress=False)
    assert result.status == "completed", result.message
    return result, demo.curve(result, run)


def test_the_force_is_contacts(body: wf.ReducedBody) -> None:
    result, found = rolled(body, [(1.2e-3, 0.0, 0.0)])
    pair = result.contact(demo.PAIR)
    assert pair.loaded == "cells" and pair.normal_load[-1] == pytest.approx(170.72, rel=1e-4)
    assert pair.friction.creepage[-1] == pytest.approx([1.2e-3, 0.0], abs=2e-6)
    assert found.forces[0] == pytest.approx([CONTACT, 0.0], abs=demo.CONTACT_ERROR)


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
    assert np.all(result.contact(demo.PAIR).friction.traction_coefficient <= 0.33 * (1.0 + demo.BOUND))
    assert 0.95 < np.hypot(*found.forces[0]) < 1.0 and found.forces[0, 0] > found.forces[0, 1] > 0.6


@pytest.mark.slow
def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    left_behind(tmp_path / "out", "creep_curves", "longitudinal", "lateral", "both", "spin")
