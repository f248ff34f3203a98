"""The cloud of bearings against the equations of rigid rings, row by row, and the Sobol indices of a linear case."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from checks import Check, left_behind, missed
from scipy.optimize import brentq

import warpffrf as wf
from demos import tolerance_cloud as demo
from references.closed_forms.rolling_bearings import iso_profiles, sjoevall
from warpffrf.study.sweeps.outcome import Sweep, open_sweep

GEOMETRY = wf.bearings.catalogue(demo.NAME)
COUNT, LENGTH, DIAMETER = GEOMETRY.elements, GEOMETRY.roller_length, GEOMETRY.roller_diameter
STORE = "tolerance_cloud.sweep"
SIGMA = {"clearance": 5e-6, "ovality": 1e-6, "tilt": 5e-4}
BALANCE = 1e-3  # of loads and displacements: displacement over the radius of the raceway, as rings approach in space
ALIGNED = 0.01  # likewise under misalignment of up to 1.4 mrad, of which each roller takes half to first order
JOINED = 0.08  # of Sjoevall's integral for straight rollers: a profile leaves 6.4 % more to the most loaded one
LINEAR = 0.03  # of the whole variance: curvature of the response over three standard deviations, and the surface
PSI = 2.0 * np.pi * np.arange(COUNT) / COUNT


def loads(sinks: float, clearance: float, ovality: float, tilt: float = 0.0) -> np.ndarray:
    """Q (rollers,) [N] with rings displaced by `sinks` [m]: each roller takes half of the tilt of its plane, so that
    both its contacts have the same laminae (ISO/TS 16281)."""
    x = LENGTH * ((np.arange(30) + 0.5) / 30 - 0.5)
    delta = sinks * np.cos(PSI) - 0.5 * clearance - ovality * np.cos(2.0 * PSI)
    depth = delta[:, None] + tilt * np.cos(PSI)[:, None] * x - iso_profiles(LENGTH, DIAMETER)
    c_L = 35948.0 * (1e3 * LENGTH) ** (8.0 / 9.0)
    return c_L / 30 * np.sum(np.maximum(1e3 * depth, 0.0) ** (10.0 / 9.0), axis=1)


def displacement(clearance: float, ovality: float, tilt: float = 0.0) -> float:
    """d [m] at which the rollers carry the load."""
    found: Any = brentq(lambda d: loads(d, clearance, ovality, tilt) @ np.cos(PSI) - demo.LOAD, 0.0, 1e-3, xtol=1e-15)
    return float(found)


def linear_indices() -> dict[str, float]:
    """Of the displacement, by its derivatives at the means; that by the tilt is zero, as its sign does not matter."""
    mean = {"clearance": 20e-6, "ovality": 0.0}
    part = {}
    for name in mean:
        step = 0.1 * SIGMA[name]
        high, low = (displacement(**{**mean, name: mean[name] + sign * step}) for sign in (1.0, -1.0))
        part[name] = ((high - low) / (2.0 * step) * SIGMA[name]) ** 2
    return {name: value / sum(part.values()) for name, value in part.items()} | {"tilt": 0.0}


def of_row(found: Sweep, n: int) -> dict[str, float]:
    return {name: float(found[name][n]) for name in demo.SCATTER}


def checks(found: Sweep) -> list[Check]:
    """Of all bearings."""
    rows = [of_row(found, n) for n in range(found.count)]
    d = np.array([displacement(**row) for row in rows])
    Q = np.array([loads(one, **row).max() for one, row in zip(d, rows, strict=True)])
    sinks = found.sensitivities(demo.SINKS)
    exact = linear_indices()
    completed = found.counts.get("completed", 0)
    off = [
        float(np.abs(values / right - 1.0).max())
        for values, right in ((-found[demo.SINKS], d), (1e3 * found[demo.FORCE], Q))
    ]
    return [
        Check("bearings that were completed", completed, found.count, "all", 0.0),
        Check("displacement of all, off by", off[0], 0.0, "ISO/TS 16281", ALIGNED, scale=1.0),
        Check("largest load of all, off by", off[1], 0.0, "ISO/TS 16281", ALIGNED, scale=1.0),
        Check("scatter of the largest load", 1e3 * found[demo.FORCE].std() / Q.std(), 1.0, "ISO/TS 16281", ALIGNED),
        *(
            Check(f"Sobol index of {name}, {order}", value, exact[name], "linear", LINEAR, scale=1.0)
            for order in ("first", "total")
            for name, value in zip(sinks.parameters, getattr(sinks, order), strict=True)
        ),
    ]


def test_loads_of_an_aligned_bearing() -> None:
    """Against the equations of rigid rings, and against Sjoevall's integral of many straight rollers with clearance."""
    clearance, ovality = 20e-6, 2e-6
    run = wf.equilibrium(demo.build(clearance, ovality, 0.0), progress=False)
    d = displacement(clearance, ovality)
    np.testing.assert_allclose(
        run.bearing(demo.NAME).inner_load[-1], loads(d, clearance, ovality), atol=BALANCE * 3.4e3
    )
    assert float(run.body(f"{demo.NAME} inner ring").position[-1, 2]) == pytest.approx(-d, rel=BALANCE)
    round_one = displacement(clearance, 0.0)
    J_r, _ = sjoevall(0.5 * (1.0 - 0.5 * clearance / round_one), 10.0 / 9.0)
    alone = 1e3 * demo.largest_load(wf.equilibrium(demo.build(clearance, 0.0, 0.0), progress=False))
    straight = demo.LOAD / (COUNT * J_r)
    assert straight < alone < (1.0 + JOINED) * straight


def test_bearings_as_worlds_have_the_bits_of_each_alone(tmp_path: Path) -> None:
    size = demo.Size(4)
    alone = demo.cloud(tmp_path / "alone.sweep", size, workers=1, progress=False)
    worlds = demo.cloud(tmp_path / "worlds.sweep", demo.Size(4, worlds=4), workers=1, progress=False)
    assert worlds["worlds"].tolist() == [4] * 4 and alone["worlds"].tolist() == [1] * 4
    for name in (*demo.SHOWN, demo.SINKS):
        assert np.array_equal(alone[name], worlds[name])
    assert demo.largest_load(wf.equilibrium(demo.build(**of_row(alone, 0)), progress=False)) == alone[demo.FORCE][0]


@pytest.mark.slow
@pytest.mark.parametrize("quick", [True, False])
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    demo.main(tmp_path, quick=quick, progress=False)
    found = open_sweep(tmp_path / STORE)
    rows = 16 if quick else 64
    page = (tmp_path / "tolerance_cloud.html").read_text(encoding="utf-8")
    assert f"{rows} rows of equilibrium, sample latin:{rows}, seed 0: {rows} completed." in page
    assert not missed(checks(found))
    shutil.rmtree(tmp_path / STORE)
    (tmp_path / "tolerance_cloud.html").unlink()
    left_behind(tmp_path, "tolerance_cloud")
