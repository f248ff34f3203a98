"""Impact, steps of all sizes, and what a frictionless contact must leave alone."""

from __future__ import annotations

import numpy as np
import pytest

from scenes.rollers import PAIR, guided_pair, roller_body
from studies.contact.impact import Drop, drop, ledger_rise
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online import Settings, find_equilibrium, run

RISE = 0.01  # of the energy at hand: the promise for the ledger
BOUNCE = 0.03  # of the restitution with the finest step
ENDS = 0.03  # of the energy at hand: 1 % and what a step of this grid makes
GOES_ON = Settings(gain_limit=0.0)  # whatever a grid of one column across the patch makes of the energy
FORCE = 0.01  # deviation from equilibrium over one revolution


def check_drops(body: ReducedBody, steps: tuple[float, ...], phases: int) -> None:
    """Drop through 1 mm at every step size and phase against the finest step."""
    finest, _ = drop(body, body, step=min(steps) / 10.0)
    assert finest.status == "completed" and 0.9 < finest.restitution < 1.0  # the rest rings in the rollers
    found: list[Drop] = []
    for step in steps:
        for phase in np.arange(phases) / phases:
            one, _ = drop(body, body, step=step, phase=float(phase))
            found.append(one)
            assert one.status == "completed"
    rise = max(found, key=lambda d: d.rise)
    bounce = max(found, key=lambda d: abs(d.restitution / finest.restitution - 1.0))
    print(f"finest restitution {finest.restitution:.4f}, worst {bounce}\nlargest rise {rise}")
    assert rise.rise < RISE
    assert abs(bounce.restitution / finest.restitution - 1.0) < BOUNCE


@pytest.mark.slow
def test_dropped_roller_gains_nothing_and_bounces_alike(small_body: ReducedBody) -> None:
    check_drops(small_body, (1e-5, 1e-4, 1e-3), 4)


@pytest.mark.slow
def test_dropped_roller_at_every_phase(small_body: ReducedBody) -> None:
    """20 phases of the impact at each step; the finest is 1e-7 s."""
    check_drops(small_body, (1e-6, 1e-5, 1e-4, 1e-3), 20)


def rolling_run(body: ReducedBody, load: float, step: float, speed: float = 100.0) -> tuple[float, float]:
    """Worst deviation of the force from equilibrium, and rise of the ledger over the largest energy at hand."""
    ramp = 0.02
    scene = guided_pair(body, body, load=load, speed=speed, ramp=ramp)
    rest = find_equilibrium(scene)
    assert rest.status == "completed"
    duration = step * np.ceil((ramp + 2.0 * np.pi / speed) / step)
    history = run(scene, duration, step=step, start="equilibrium", progress=False)
    assert history.status == "completed", history.message
    assert history.counters["rejected_steps"] == 0
    assert history.counters["max_iterations"] <= 12 and history.counters["mean_iterations"] <= 4.0
    F = np.linalg.norm(history.contacts[PAIR].force, axis=1)
    F0 = np.linalg.norm(rest.contacts[PAIR].force[-1])
    at_hand = np.sum([history.energy[name] for name in ("kinetic", "strain", "contact")], axis=0)
    return float(np.abs(F / F0 - 1.0).max()), ledger_rise(history) / float(at_hand.max())


@pytest.mark.slow
@pytest.mark.parametrize("step", [1e-4, 1e-3])
def test_force_stays_at_equilibrium_over_a_revolution(fine_body: ReducedBody, step: float) -> None:
    """Two elements per half-width (55 kN), 100 rad/s."""
    deviation, rise = rolling_run(fine_body, 55e3, step)
    print(f"step {step:g}: force within {deviation:.2%}, ledger rises {rise:.2e}")
    assert deviation < FORCE and rise < RISE


@pytest.mark.slow
@pytest.mark.parametrize("step", [1e-6, 1e-5, 1e-4, 1e-3])
def test_force_stays_at_equilibrium_at_every_step(step: float) -> None:
    body = roller_body(720, layers=9, axial=2, grading=1.4, order=2)
    deviation, rise = rolling_run(body, 55e3, step)
    print(f"step {step:g}: force within {deviation:.2%}, ledger rises {rise:.2e}")
    assert deviation < FORCE and rise < RISE


def test_frictionless_contact_leaves_free_spins_alone(small_body: ReducedBody) -> None:
    """Free axles, equal and unequal speeds: no torque, no change of speed."""
    scene = guided_pair(small_body, small_body, load=20e3)
    lower, upper = scene.body("lower"), scene.body("upper")
    lower.angular_velocity = np.array([0.0, 50.0, 0.0])
    upper.angular_velocity = np.array([0.0, -30.0, 0.0])
    history = run(scene, 0.02, step=1e-4, start="equilibrium", progress=False)
    assert history.status == "completed", history.message
    for name, speed in (("lower", 50.0), ("upper", -30.0)):
        assert np.abs(history.bodies[name].angular_velocity[:, 1] / speed - 1.0).max() < 1e-4


@pytest.mark.parametrize("gap", [0.0, 1e-5, 1e-3])
@pytest.mark.parametrize("stiffness", [1e3, 2e6])
def test_equilibrium_is_found_across_an_open_gap(small_body: ReducedBody, gap: float, stiffness: float) -> None:
    """Load, weight and spring balance the contact force; the guide never passes the gap by more than the
    deformation."""
    load = 20e3
    scene = guided_pair(small_body, small_body, load=load, stiffness=stiffness, gap=gap, speed=10.0)
    rest = find_equilibrium(scene)
    assert rest.status == "completed", rest.message
    travel = scene.body("carriage").position[2] - rest.bodies["carriage"].position[-1, 2]
    weight = (small_body.mass + scene.body("carriage").mass) * 9.81
    force = np.linalg.norm(rest.contacts[PAIR].force[-1])
    assert force == pytest.approx(load + weight - stiffness * travel, rel=1e-8)
    assert gap < travel < gap + 100e-6


def test_force_returns_after_a_load_cycle(small_body: ReducedBody) -> None:
    """Load, roll by a tenth of a turn and unload: elastic, frictionless contact has no memory."""
    from warpffrf.model import signals

    load = signals.Table([0.0, 0.01, 0.02, 0.03], [5e3, 20e3, 20e3, 5e3], cubic=True, hold=True)
    scene = guided_pair(small_body, small_body, load=load, speed=30.0, ramp=0.005)
    history = run(scene, 0.06, step=2e-5, start="equilibrium", progress=False, settings=GOES_ON)
    assert history.status == "completed", history.message
    F = np.linalg.norm(history.contacts[PAIR].force, axis=1)
    bounces = F[-1250:]  # 0.2 elements per half-width: a coarse ripple, on which they bounce
    assert bounces.mean() == pytest.approx(F[0], rel=0.05)


def test_a_run_that_makes_energy_ends(small_body: ReducedBody) -> None:
    """One column across the patch, on which the rollers are pumped up: the run ends soon, names the pair, and says that
    smaller steps were tried and are no cure; the finer grid that it asks for is one."""
    from warpffrf.model import signals

    load = signals.Table([0.0, 0.01, 0.02, 0.03], [5e3, 20e3, 20e3, 5e3], cubic=True, hold=True)
    scene = guided_pair(small_body, small_body, load=load, speed=30.0, ramp=0.005)
    history = run(scene, 0.06, step=1e-4, start="equilibrium", progress=False)
    assert history.status == "energy"
    for text in (f"contact {PAIR!r} creates energy", "tried", "do not help", "finer grid"):
        assert text in history.message
    energy = history.energy
    hand = max(np.abs(values).max() for name, values in energy.items() if name != "potential")
    made = energy["numerical"][-1] + energy["contact_grid"][-1] - energy["contact"][-1]  # what it holds may come back
    assert 0.0 < made < ENDS * hand
