"""Two rollers with friction that roll on each other for a million steps of 1e-4 s: a hundred seconds, 160 revolutions.

The lower one is driven at a constant speed, the upper one is rolled along against a brake: 100 W go through the patch.
Nothing may drift: the force, its ripple, the friction and the creep at the end are those at the beginning, what the
ledger does not account for stays below a thousandth of the work done (the energy at hand is twice that: what the drive
gives and what the brake takes), and memory does not grow.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from scenes.rollers import PAIR, guided_pair, roller_body
from studies.hard_cases.case import Case, Finding, Ledger
from warpffrf.model import forces, joints, signals
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

STEPS, STEP, LOAD, SPEED, FRICTION, BRAKE = 1_000_000, 1e-4, 60e3, 10.0, 0.1, 10.0  # s, N, rad/s, N m
RAMP, STEADY = 0.02, 0.1  # s
SHARE = 0.05  # of the run at either end
ROWS = 1000


@lru_cache
def _body() -> ReducedBody:
    return roller_body(720, layers=6, axial=2, grading=1.6, order=1, modes=4, tangential=True)


def build() -> Scene:
    """The pair under its load, one roller driven, the other braked."""
    scene = guided_pair(_body(), _body(), load=LOAD, friction=FRICTION)
    axle = next(joint for joint in scene.joints if joint.name == "axle")
    scene.add(joints.Drive(axle, signals.SmoothStep(0.0, SPEED, duration=RAMP), quantity="velocity"))
    brake = signals.SmoothStep(0.0, BRAKE, duration=RAMP, delay=2.0 * RAMP)
    scene.add(forces.PointTorque(scene.body("upper")["bore"], (brake, (0.0, 1.0, 0.0)), name="brake"))
    return scene


def check(result: Result) -> list[Finding]:
    """Drift of force, ripple and friction, over the mean force, and of the creep."""
    t, force = result.time, result.history.contacts[PAIR].force
    span = SHARE * (t[-1] - STEADY)
    early, late = (t > STEADY) & (t < STEADY + span), t > t[-1] - span
    mean = float(np.abs(force[early, 2]).mean())
    lower, upper = (result.joint(name).named("rotation") for name in ("axle", "upper_axle"))
    creep = [2.0 * np.pi * float(np.polyfit(lower[rows], (lower + upper)[rows], 1)[0]) for rows in (early, late)]
    return [
        Finding("drift of the force", abs(float(force[late, 2].mean() - force[early, 2].mean())) / mean, 1e-3, 1e-2),
        Finding("drift of its ripple", abs(float(force[late, 2].std() - force[early, 2].std())) / mean, 1e-3, 1e-2),
        Finding("drift of the friction", abs(float(force[late, 0].mean() - force[early, 0].mean())) / mean, 1e-3, 1e-2),
        Finding("drift of the creep, a turn [rad]", abs(creep[1] - creep[0]), 1e-5, 1e-3),
    ]


CASE = Case(
    "1e6 steps of rolling",
    "Two rollers with friction roll on each other for a million steps, one driven, one braked: nothing may drift.",
    build, STEPS * STEP, check, steps=(STEP,), middle=STEP, tolerances=(), errors=(), accuracies=(), most_steps=STEPS,
    rows=ROWS, ledger=Ledger(gain=(5e-4, 5e-3), loss=(5e-4, 5e-3)), memory=(32.0, 128.0),
    options={"start": "equilibrium"}, slow=True,
)  # fmt: skip
