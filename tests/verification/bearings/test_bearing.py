"""A bearing of light rollers run up under load: it runs, makes no energy, and its rollers carry what they should."""

from __future__ import annotations

import numpy as np
import pytest

from scenes.bearing import RAMP, Bearing, angles, rings, run_up, sjovall
from warpffrf.online import History, find_equilibrium, run

GAINED, TAKEN = 0.01, 0.02  # of the work done: promised
LOADS = 0.03  # of the largest load, against rings that keep their round shape but where they touch (Sjoevall)
COARSE = 0.08  # the same on a grid of 100 um, one column across the patch, that the loads ripple with
STEPS_AGREE = 0.03  # rms of a roller's force over the time of a revolution of the shaft, of the largest
FAST = 0.01  # s, of a ramp that is over soon


def loads(history: History, bearing: Bearing) -> np.ndarray:
    """Forces (T, count) [N] between the rollers and the outer ring."""
    return np.array([np.linalg.norm(history.contacts[f"out {i}"].force, axis=1) for i in range(bearing.count)]).T


def check_ledger(history: History) -> None:
    assert history.status == "completed", history.message
    energy = history.energy
    work = max(np.abs(energy[name]).max() for name in ("force_work", "drive_work"))
    gained = energy["numerical"] + energy["contact_grid"]
    print(
        f"work {work:.3g} J, gained {np.max(gained - np.minimum.accumulate(gained)) / work:.2%}, taken by the "
        f"integrator {-energy['numerical'].min() / work:.2%}, counters {history.counters}"
    )
    assert np.max(gained - np.minimum.accumulate(gained)) < GAINED * work
    assert -energy["numerical"].min() < TAKEN * work


def check_loads(history: History, bearing: Bearing, since: float, within: float = LOADS) -> None:
    """Against the distribution without clearance, from the time `since` [s] on."""
    steady = history.time >= since
    turned = history.joints["cage"].coordinate[steady]
    exact = sjovall(angles(bearing) - turned[:, None])
    worst = np.abs(loads(history, bearing)[steady] - exact).max(axis=1) / exact.max(axis=1)
    print(f"{bearing}: within {worst.max():.2%} of the largest load")
    assert worst.max() < within


@pytest.mark.slow
def test_a_run_up_of_six_rollers() -> None:
    """On a coarse grid and a short ramp."""
    bearing = Bearing(6)
    history = run(
        run_up(bearing, rings(bearing, 100e-6), FAST), 2.0 * FAST, step=1e-4, start="equilibrium", progress=False
    )
    check_ledger(history)
    check_loads(history, bearing, FAST, COARSE)


@pytest.mark.slow
def test_rest_on_many_cells() -> None:
    """Cells as wide as the step before asked for change the energy by more than the last steps towards rest do: such a
    step does not lead uphill."""
    bearing = Bearing(6)
    scene = run_up(bearing, rings(bearing, 4e-4, contact_fixed=True), FAST)
    for contact in scene.contacts:
        contact.cell_error = 0.003
    history = find_equilibrium(scene)
    assert history.status == "completed", history.message
    check_loads(history, bearing, 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("step", [1e-4, 3e-5, 1e-5])
@pytest.mark.parametrize("count", [6, 12, 18])
def test_a_run_up_without_clearance(count: int, step: float) -> None:
    """Rollers at the edge of the load zone chatter over the columns of a coarse grid, and small steps resolve that."""
    bearing = Bearing(count)
    scene = run_up(bearing, rings(bearing, 35e-6 if count > 15 and step < 3e-5 else 50e-6))
    history = run(scene, 1.4 * RAMP, step=step, start="equilibrium", progress=False)
    check_ledger(history)
    check_loads(history, bearing, RAMP)


@pytest.mark.slow
@pytest.mark.parametrize("count", [6, 12, 18])
def test_a_run_up_with_clearance(count: int) -> None:
    """Rollers leave the load zone and come back to it; two steps agree.

    Eighteen rollers need the grid that a run on 50 um asks for: there pairs make 1 % of the energy, by 60 ms.
    """
    bearing = Bearing(count, 20e-6)
    bodies, found = rings(bearing, 35e-6 if count > 15 else 50e-6), []
    for step in (5e-5, 1e-5):
        history = run(run_up(bearing, bodies), 1.4 * RAMP, step=step, start="equilibrium", progress=False)
        check_ledger(history)
        every = round(5e-5 / step)
        found.append(loads(history, bearing)[::every][-1200:])
    off = np.sqrt(np.mean((found[0] - found[1]) ** 2, axis=0)).max() / found[1].max()
    print(f"{bearing}: steps differ by {off:.2%} rms of the largest load")
    assert off < STEPS_AGREE
