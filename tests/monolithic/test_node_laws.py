"""The laws at a node: pressures and their slopes, return mapping, and what friction takes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize

from references.monolithic.nodal.friction import SLIP, STICK, closest_point, node_traction
from references.monolithic.nodal.layer_slopes import layer_pressure, reach
from warpffrf.model import laws
from warpffrf.model.friction import Coulomb, RegularisedCoulomb

LAYERS = {
    "linear_layer": laws.LinearLayer(1e13),
    "nonlinear_layer": laws.NonlinearLayer(1e16, 1.5),
    "tabulated_layer": laws.TabulatedLayer((-4e-6, -1e-6, 0.5e-6), (9e7, 1e7, 0.0)),
    "exponential_asperities": laws.ExponentialAsperities(1e7, 3e-7),
    "greenwood_tripp": laws.GreenwoodTripp(1e-7, 1e10, 5e-5, 1e11),
    "hunt_crossley": laws.HuntCrossley(1e16, 1.5, damping=20.0),
}
K_T, H = 3e13, 1e-4  # Pa/m, s
FRICTION: list[Any] = [
    Coulomb(0.3),
    RegularisedCoulomb(0.3, 5e-3),
    laws.Stribeck(0.3, 0.2, 2.0),  # p |mu'|/(h k_t) at most 0.009
    laws.TabulatedFriction((0.0, 0.01, 0.03), (0.3, 0.25, 0.28)),
]


def test_every_layer_is_tested() -> None:
    assert {*LAYERS, "unilateral"} == set(laws.LAWS)


@pytest.mark.parametrize("kind", list(LAYERS))
def test_slopes_are_those_of_the_pressure(kind: str) -> None:
    """Central differences, away from the kinks; with a rate for the layer that has one."""
    law: Any = LAYERS[kind]
    gap = np.linspace(-3.7e-6, 2e-6, 41) + 3.3e-8
    before, d = gap + 2e-9 * np.sin(1e7 * gap), 1e-12
    for moving in (False, True):
        at = layer_pressure(law, gap, before, H, moving=moving)
        ends = [layer_pressure(law, gap + s * d, before, H, moving=moving).pressure for s in (1.0, -1.0)]
        assert np.abs(at.slope - (ends[0] - ends[1]) / (2.0 * d)).max() < 1e-5 * np.abs(at.slope).max()
        assert np.all(at.pressure >= 0.0) and np.all(at.lost >= 0.0)
    assert np.all(law.curve.slope(-gap) >= 0.0)
    assert layer_pressure(law, np.array([reach(law) + 1e-9]), gap[:1], H, moving=False).pressure[0] == 0.0
    assert layer_pressure(law, np.array([reach(law) - 1e-9]), gap[:1], H, moving=False).pressure[0] > 0.0


def test_a_damped_layer_loses_what_it_says() -> None:
    """There and back: int p dg around the cycle is what was booked, to the quadrature of the steps."""
    law = LAYERS["hunt_crossley"]
    t = np.linspace(0.0, 1.0, 20001)
    gap, h = 1e-7 - 2e-6 * np.sin(np.pi * t) ** 2, 1e-3 * (t[1] - t[0])
    at = layer_pressure(law, gap[1:], gap[:-1], h, moving=True)
    work = -float(at.pressure @ np.diff(gap))
    assert float(at.lost.sum()) == pytest.approx(work, rel=2e-3) and work > 0.0


def rub(law: Any, pressure: Any, slip: Any, before: Any, tau: Any = None, search: float = 1e12) -> Any:
    return node_traction(law, pressure, slip, before, tau, stick=K_T, search=search, h=H)


def random_nodes(count: int = 200) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(1)
    pressure = rng.uniform(1e6, 3e8, count)
    before = closest_point(1e8 * rng.normal(size=(count, 2)), 0.3 * pressure)
    return pressure, 2e-6 * rng.normal(size=(count, 2)), before


def test_return_mapping_is_the_closest_point() -> None:
    """tau minimises |tau - tau*| on the disc, found by an optimiser that knows nothing of it."""
    pressure, slip, before = random_nodes(6)
    found = rub(Coulomb(0.3), pressure, slip, before)
    trial = before - K_T * slip
    for i in range(len(pressure)):
        b = 0.3 * pressure[i]
        best = minimize(
            lambda x, i=i, b=b: float(np.sum((x - trial[i] / b) ** 2)), before[i] / b, method="SLSQP",
            constraints={"type": "ineq", "fun": lambda x: 1.0 - x @ x}, options={"ftol": 1e-14},
        )  # fmt: skip
        assert np.abs(found.traction[i] / b - best.x).max() < 1e-5
    assert set(random_states()) == {STICK, SLIP}


def random_states() -> np.ndarray:
    pressure, slip, before = random_nodes()
    return rub(Coulomb(0.3), pressure, slip, before).state


@pytest.mark.parametrize("law", FRICTION, ids=lambda law: law.kind)
def test_tangent_of_the_law(law: Any) -> None:
    """by_slip and by_pressure against differences of the law itself, stick and slip."""
    pressure, slip, before = random_nodes()
    slip = 0.5 * slip if law.creep_limit else slip
    at = rub(law, pressure, slip, before)
    assert {STICK, SLIP} == set(at.state)
    for i, d in ((0, np.array([1e-13, 0.0])), (1, np.array([0.0, 1e-13]))):
        ends = [rub(law, pressure, slip + s * d, before).traction for s in (1.0, -1.0)]
        off = np.linalg.norm((ends[0] - ends[1]) / 2e-13 - at.by_slip[:, :, i], axis=1)
        assert off.max() < 1e-5 * np.abs(at.by_slip).max()
    ends = [rub(law, pressure + s * 10.0, slip, before).traction for s in (1.0, -1.0)]
    assert np.abs((ends[0] - ends[1]) / 20.0 - at.by_pressure).max() < 1e-5


@pytest.mark.parametrize("law", FRICTION, ids=lambda law: law.kind)
@pytest.mark.parametrize("search", [1e11, 1e13, 1e20])
def test_newton_on_the_tractions_ends_at_the_law(law: Any, search: float) -> None:
    """Slips and pressures given: from any traction on the disc the iteration comes to that of the law."""
    pressure, slip, before = random_nodes()
    law_itself = rub(law, pressure, slip, before).traction
    tau = before
    for _ in range(60):
        found = rub(law, pressure, slip, before, tau, search)
        tau = tau + found.constant
    assert np.abs(tau - law_itself).max() < 1e-9 * np.abs(law_itself).max()
    assert found.off.max() < 1e-6 * np.abs(law_itself).max()


@pytest.mark.slow
@pytest.mark.parametrize("law", FRICTION, ids=lambda law: law.kind)
def test_friction_only_takes(law: Any) -> None:
    """A random walk: what is put in is never less than what is stored and booked as lost, and no loss is negative."""
    rng = np.random.default_rng(7)
    tau, stored, put_in, lost = np.zeros((1, 2)), 0.0, 0.0, 0.0
    for _ in range(2000):
        pressure, slip = rng.uniform(1e6, 1e8, 1), 1e-6 * rng.normal(size=(1, 2))
        at = rub(law, pressure, slip, tau)
        tau = at.traction
        assert at.lost[0] >= 0.0 and np.linalg.norm(tau) <= 0.3 * pressure[0] * (1.0 + 1e-12)
        put_in -= float(tau[0] @ slip[0])
        lost += float(at.lost[0])
        stored = float(at.stored[0])
    assert put_in >= stored + lost > 0.0


def test_small_steps_lose_as_the_stretch_says() -> None:
    """The part of implicit Euler goes with the step: first order."""
    off = []
    for steps in (50, 100, 200):
        path = 4e-6 * np.sin(2.0 * np.pi * np.arange(steps + 1) / steps)
        tau, put_in, lost, stored = np.zeros((1, 2)), 0.0, 0.0, 0.0
        for ds in np.diff(path):
            slip = np.array([[ds, 0.0]])
            at = rub(Coulomb(0.3), np.array([1e8]), slip, tau)
            tau, put_in, lost = at.traction, put_in - float(at.traction[0] @ slip[0]), lost + float(at.lost[0])
            stored = float(at.stored[0])
        off.append(put_in - lost - stored)
    assert off[0] > off[1] > off[2] > 0.0
    assert off[0] / off[1] == pytest.approx(2.0, rel=0.15) and off[1] / off[2] == pytest.approx(2.0, rel=0.15)
