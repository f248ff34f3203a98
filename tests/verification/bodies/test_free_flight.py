"""Free flight: case D4 with every integrator, and a soft ring that tumbles, bends and keeps its momenta."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from studies.bodies.free_flight import RING_TIME, fly, orders, rigid_flight, ring, ring_flight, ring_scene
from warpffrf.model.integrators import HHT, EnergyMomentum, GeneralizedAlpha, Newmark, RungeKutta4
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online import History

STEPPERS = [GeneralizedAlpha(0.8), HHT(-0.1), HHT(-0.3), Newmark()]
CONSERVED = 1e-9  # of energy and angular momentum by the conserving update: what is promised; it does better
LINEAR = 1e-10  # of linear momentum by any integrator
AT_A_THOUSANDTH = 2.5e-6  # of energy and angular momentum in case D4 at h = 1e-3, generalized-alpha
ORDER = 0.1


@pytest.mark.parametrize("integrator", STEPPERS, ids=str)
def test_rigid_body_turns_over_to_second_order(integrator: Any) -> None:
    """Down to 1e-4 rad/s; the error of energy and momentum has the same order."""
    flights = [rigid_flight(integrator, h) for h in (4e-3, 2e-3, 1e-3)]
    for what in ("error", "energy", "angular"):
        assert orders(flights, what) == pytest.approx(2.0, abs=ORDER)
    assert flights[-1].error < 1e-4
    if isinstance(integrator, GeneralizedAlpha):
        assert max(flights[-1].energy, flights[-1].angular) < AT_A_THOUSANDTH


@pytest.mark.slow
@pytest.mark.parametrize("integrator", STEPPERS, ids=str)
def test_rigid_body_turns_over_down_to_round_off(integrator: Any) -> None:
    """omega(10 s) to some 1e-6 rad/s, below which the motion amplifies what Newton's tolerance leaves; energy and
    momentum have order 2 down to 1e-9."""
    flights = [rigid_flight(integrator, h) for h in (4e-3, 1e-3, 2.5e-4, 1.25e-4)]
    assert orders(flights[:3]) == pytest.approx(2.0, abs=0.15)
    assert flights[-1].error < 5e-6
    flights.append(rigid_flight(integrator, 1e-5))
    for what in ("energy", "angular"):
        assert orders(flights, what) == pytest.approx(2.0, abs=ORDER)
    assert max(flights[-1].energy, flights[-1].angular) < CONSERVED


@pytest.mark.slow
def test_rigid_body_turns_over_with_the_conserving_update() -> None:
    flights = [rigid_flight(EnergyMomentum(), h) for h in (8e-3, 4e-3)]
    assert orders(flights) == pytest.approx(2.0, abs=ORDER)
    assert max(max(f.energy, f.angular) for f in flights) < 1e-12


def test_rigid_body_turns_over_with_runge_kutta() -> None:
    """To the fourth order, down to 1e-6 rad/s."""
    flights = [rigid_flight(RungeKutta4(), h) for h in (4e-2, 2e-2, 1e-2)]
    assert orders(flights) == pytest.approx(4.0, abs=0.2)
    assert flights[-1].error < 1e-6


@pytest.fixture(scope="module")
def soft_ring() -> ReducedBody:
    return ring()


@pytest.fixture(scope="module")
def reference(soft_ring: ReducedBody) -> History:
    """Runge-Kutta on the host, far below its own limit: 100 steps a period of the highest mode."""
    return fly(ring_scene(soft_ring), RING_TIME, 5e-5, RungeKutta4())


@pytest.mark.slow
def test_the_ring_is_bent_by_its_turning(soft_ring: ReducedBody, reference: History) -> None:
    """More than a millimetre on a wall of 8 mm: what is neglected at lower levels is seen."""
    modes = soft_ring.surface.modes.transpose(1, 2, 0)
    assert np.abs(modes @ reference.bodies["ring"].modal.T).max() > 1e-3
    for level, least in (("constant", 0.5), ("deformed", 1e-2), ("gyroscopic", 1e-3)):
        other = fly(ring_scene(soft_ring, level), RING_TIME, 1e-4, RungeKutta4())
        apart = np.abs(other.bodies["ring"].modal[-1] - reference.bodies["ring"].modal[-1]).max()
        assert apart > least * np.abs(reference.bodies["ring"].modal[-1]).max()


@pytest.mark.parametrize("integrator", STEPPERS, ids=str)
def test_free_flight_of_a_flexible_body(soft_ring: ReducedBody, reference: History, integrator: Any) -> None:
    """Motion, energy and angular momentum to second order, linear momentum to round-off."""
    flights = [ring_flight(soft_ring, integrator, h, reference) for h in (2e-4, 1e-4, 5e-5)]
    assert all(f.status == "completed" for f in flights)
    for what in ("error", "energy", "angular"):
        assert orders(flights, what) == pytest.approx(2.0, abs=ORDER)
    assert flights[-1].error < 3e-4
    assert max(f.linear for f in flights) < LINEAR


def test_free_flight_of_a_flexible_body_with_the_conserving_update(soft_ring: ReducedBody, reference: History) -> None:
    """Energy and momenta at any step, here up to a sixth of the period of the lowest mode; motion to second order."""
    flights = [ring_flight(soft_ring, EnergyMomentum(), h, reference) for h in (5e-3, 1e-3, 2e-4, 1e-4)]
    for flight in flights:
        assert flight.energy < CONSERVED and flight.angular < CONSERVED and flight.linear < LINEAR
    assert orders(flights[2:]) == pytest.approx(2.0, abs=ORDER)


@pytest.mark.parametrize("level", ["deformed", "gyroscopic"])
def test_every_level_conserves_its_own_energy_and_momentum(soft_ring: ReducedBody, level: str) -> None:
    """With the step graph to second order, with the conserving update to round-off."""
    own = fly(ring_scene(soft_ring, level), RING_TIME, 5e-5, RungeKutta4())
    flights = [ring_flight(soft_ring, GeneralizedAlpha(0.8), h, own, level) for h in (1e-4, 5e-5)]
    for what in ("error", "energy", "angular"):
        assert orders(flights, what) == pytest.approx(2.0, abs=ORDER)
    kept = ring_flight(soft_ring, EnergyMomentum(), 1e-3, own, level)
    assert kept.energy < CONSERVED and kept.angular < CONSERVED
