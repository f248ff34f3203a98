"""Random scenes: forces balance, energies are booked, and nothing depends on where, or from what drift, it is seen.

The same scenes come each time: hypothesis derives them from the tests, and no database is kept. `EXAMPLES` in the
environment is how many times as many are looked at; `make verify` looks at twice as many.
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import pytest
from balances import axes, differences, missing, sides, stored, unbalanced
from hypothesis import HealthCheck, given, settings
from random_scenes import GROUND, HERE, Impact, Mechanism, Place, drifting, elsewhere, impacts, mechanisms

from warpffrf.model import forces
from warpffrf.model import rotation as rot
from warpffrf.model.scene import Scene
from warpffrf.online import GeneralizedAlpha, Settings, run
from warpffrf.online.history.history import History

MANY = int(os.environ.get("EXAMPLES", "1"))
STEP, DURATION = 1e-3, 0.04  # s, of rigid bodies that move by centimetres and turn by tenths
SHORT, CLASH = 2e-5, 8e-4  # s, of bodies that meet with up to 1 m/s: 40 steps, a contact at least begins
# of the largest force and torque: a step ends at 1e-9 of the forces, a torque being the force at a radius of gyration
BALANCED = 1e-7
IMPULSIVE = 5e-6  # of the largest torque: bodies move under the mean force of an impulsive step, second order in it
CLOSED = 1e-12  # of the energies: sums of some ten numbers over some ten steps, from one array
SAME = 1e-11  # of the energies: the same sums from the recorded motion
NUMERICAL = 1e-3  # of the energies: error of the integrator, of second order in the step
ORDER = 3.0  # at least, between a step and its half, where that is 4
FLAT = 1e-9  # of the energies: too little to have an order
MOVED = 1e-10  # m, rad: round-off of coordinates of order 1, grown by what the motion makes of it
RATES = 1e-8  # m/s, rad/s: the same over a step of 2e-5 s
ALIKE = 1e-9  # of the energies: velocities that differ that much less
PULLED = 1e-6  # of the largest force: round-off of 1e-16 m over the square of 1e-6 s, the steps that begin a run
PRESSED = 1e-8  # of the largest: gaps of 1e-6 m of places of order 1 m
WITHIN = {"velocity": RATES, "spin": RATES, "load": PULLED, "pressure": PRESSED}
# the second side of a contact is summed up when it is recorded, for parallel axes (docs/method.md, section 13): these
# are skew by some milliradians; of forces the square
SKEW, SKEW_FORCE = 5e-3, 2.5e-5
ORDINARY = Settings(
    gain_limit=0.0
)  # patches of few nodes gain from their grid: that is `contact_grid`, and not looked at
# energies at hand, of which steps may gain a part, are others for who drifts along
BLIND = Settings(gain_limit=0.0, energy_tolerance=1e9)


def of(examples: int) -> Any:
    """Settings that do not look at a clock."""
    return settings(
        max_examples=MANY * examples, derandomize=True, deadline=None, database=None,
        suppress_health_check=[HealthCheck.too_slow],
    )  # fmt: skip


def moved(plan: Mechanism, at: Place = HERE, step: float = STEP) -> tuple[Scene, History]:
    """Initial velocities are those that the joints leave of random ones."""
    scene = plan.build(at)
    history = run(
        scene, DURATION, step=step, integrator=GeneralizedAlpha(0.9), project_start=True, progress=False
    )  # fmt: skip
    assert history.status == "completed", history.message
    return scene, history


def met(plan: Impact, at: Place = HERE, settings: Settings = ORDINARY) -> tuple[Scene, History]:
    scene = plan.build(at)
    history = run(scene, CLASH, step=SHORT, settings=settings, progress=False)
    assert history.status == "completed", history.message
    assert np.abs(history.contacts["pair"].force).max() > 0.0, "this scene tests nothing"
    return scene, history


def at_hand(energy: dict[str, np.ndarray]) -> float:
    """The largest energy of a run; nothing moves where all is fixed to the ground: then that of 1 kg at 5 cm/s."""
    return max(1e-3, *(float(np.ptp(e)) for e in energy.values()), float(np.abs(energy["kinetic"]).max()))


def check_ledger(scene: Scene, history: History) -> None:
    """What is stored is what the motion says, and all of it is accounted for; what is lost is lost."""
    energy, hand = history.energy, at_hand(history.energy)
    for name, values in stored(scene, history).items():
        assert np.abs(values - values[0] - energy[name] + energy[name][0]).max() < SAME * hand, name
    assert np.abs(missing(energy)).max() < CLOSED * hand
    assert np.diff(energy["damping"]).min() >= -CLOSED * hand
    assert np.diff(energy["friction"]).max() <= CLOSED * hand


def check_same(here: History, there: History, at: Place, lines: tuple[str, ...]) -> None:
    found, hand = differences(here, there, at), at_hand(here.energy)
    for name, size in found.items():
        assert size < WITHIN.get(name, MOVED), (name, found)
    for name in lines:
        a, b = here.energy[name], there.energy[name]
        assert np.abs(a - a[0] - b + b[0]).max() < ALIKE * hand, name


EVERYWHERE = (
    "kinetic", "strain", "contact", "potential", "force_work", "drive_work", "damping", "contact_grid", "numerical",
    "friction",
)  # fmt: skip
FROM_ANY_DRIFT = ("strain", "contact", "damping", "contact_grid", "friction")


# --- rigid bodies in joints, with springs and loads


@of(20)
@given(mechanisms())
def test_mechanisms_are_in_balance_and_their_energies_are_booked(plan: Mechanism) -> None:
    """Newton's and Euler's equations of each body, with reactions on both sides of all joints and forces."""
    lost = []
    for step in (2.0 * STEP, STEP):
        scene, history = moved(plan, step=step)
        assert max(unbalanced(scene, history)) < BALANCED
        check_ledger(scene, history)
        lost.append(np.abs(history.energy["numerical"]).max() / at_hand(history.energy))
    assert lost[1] < NUMERICAL
    assert lost[1] < FLAT or lost[0] > ORDER * lost[1], lost


@of(20)
@given(mechanisms(), elsewhere())
def test_mechanisms_move_alike_everywhere(plan: Mechanism, at: Place) -> None:
    check_same(moved(plan)[1], moved(plan, at)[1], at, EVERYWHERE)


@of(15)
@given(mechanisms(grounded=False), drifting())
def test_free_mechanisms_do_not_feel_a_drift(plan: Mechanism, at: Place) -> None:
    check_same(moved(plan)[1], moved(plan, at)[1], at, FROM_ANY_DRIFT)


def braked(turn: float) -> tuple[History, Place]:
    """A body that spins in a bearing that brakes it, tilting by a tenth of a radian; built after a turn about the
    bearing's axis."""
    at = Place(rot.rotation_vector_matrix(np.array([0.0, 0.0, turn])))
    scene = Scene()
    body = scene.add_rigid_body(
        1.0, (0.01, 0.01, 0.02), name="body", rotation=at.rotation(np.eye(3)),
        angular_velocity=at.vector((1.0, 0.0, 5.0)),
    )  # fmt: skip
    port = body.at((0.0, 0.0, 0.0))
    scene.add(forces.BearingSpring(scene.ground.at((0, 0, 0)), port, axis=(0, 0, 1), radial=1e3, spin_damping=0.05))
    return run(scene, 0.1, step=STEP, integrator=GeneralizedAlpha(0.9), progress=False), at


def test_the_brake_of_a_bearing() -> None:
    """The brake of a spin that tilts does not know which axes the world has chosen for it."""
    (here, _), (there, at) = braked(0.0), braked(0.25 * np.pi)
    assert differences(here, there, at)["spin"] < MOVED


# --- two free bodies that meet


@of(10)
@given(impacts())
def test_impacts_are_in_balance_and_their_energies_are_booked(plan: Impact) -> None:
    """Each body under the contact's force or its opposite; the force on the second surface by itself; momentum."""
    scene, history = met(plan)
    force, torque = unbalanced(scene, history)
    assert force < BALANCED and torque < IMPULSIVE
    force, torque = sides(scene, history)
    both = plan.partner == "flexible"
    assert force < (SKEW_FORCE if both else CLOSED) and torque < (SKEW if both else CLOSED)
    check_ledger(scene, history)
    assert np.abs(history.energy["numerical"]).max() < NUMERICAL * at_hand(history.energy)
    assert history.energy["contact"].min() >= 0.0
    P = np.zeros((len(history.time), 3))
    for body in scene.bodies:
        motion = history.bodies[body.name]
        arm = axes(motion) @ body.center_of_mass
        weight = history.time[:, None] * np.asarray(scene.gravity)
        P += body.mass * (motion.velocity + np.cross(motion.angular_velocity, arm) - weight)
    assert np.abs(P - P[0]).max() < CLOSED * np.abs(P).max()


@of(10)
@given(impacts(), elsewhere())
def test_impacts_are_alike_everywhere(plan: Impact, at: Place) -> None:
    check_same(met(plan)[1], met(plan, at)[1], at, EVERYWHERE)


@of(8)
@given(impacts(), drifting())
def test_impacts_do_not_feel_a_drift(plan: Impact, at: Place) -> None:
    """Where decisions do not look at energies."""
    check_same(met(plan, settings=BLIND)[1], met(plan, at, settings=BLIND)[1], at, FROM_ANY_DRIFT)


# --- the measures themselves


def test_what_is_wrong_is_seen() -> None:
    """A force or a torque that is a little too large, or a line of the ledger; a run from another place."""
    plan = Mechanism(1, ((GROUND, "revolute"), (0, "spherical")), (("spring_damper", 0, 1),), True, True)
    scene, history = moved(plan)
    (spring,) = history.forces.values()
    for array in (spring.force, history.joints["joint 0"].torque, history.bodies["body 1"].acceleration):
        kept = array.copy()
        assert max(unbalanced(scene, history)) < BALANCED
        array *= 1.0 + 1e-4
        assert max(unbalanced(scene, history)) > BALANCED
        array[:] = kept
    check_ledger(scene, history)
    for name in ("kinetic", "potential", "force_work", "drive_work", "damping", "numerical"):
        wrong = {**history.energy, name: 1.00001 * history.energy[name]}
        assert np.abs(wrong[name]).max() == 0.0 or np.abs(missing(wrong)).max() > CLOSED * at_hand(wrong), name
    check_same(history, moved(plan)[1], HERE, EVERYWHERE)
    for other in (Place(shift=np.array([1e-9, 0.0, 0.0])), Place(rot.rotation_vector_matrix(np.full(3, 1e-9)))):
        with pytest.raises(AssertionError):
            check_same(history, moved(plan)[1], other, EVERYWHERE)
