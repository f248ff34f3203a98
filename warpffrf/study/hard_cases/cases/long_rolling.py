"""Two rollers with friction that roll on each other for a million steps of 1e-4 s: a hundred seconds, 160 turns.

The lower one is driven, the upper one is rolled along. Nothing may drift: the force, its ripple and the friction at the
end are those at the beginning, what the ledger does not account for stays below a thousandth of the work done (of
drives, dampers and friction), and memory does not grow. The upper roller turns as the lower one, but for what friction
in its axle costs: nothing, so that their angles stay together to the creep of the start.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from warpffrf.model import joints, signals
from warpffrf.model.reduced_body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result
from warpffrf.study.hard_cases.case import Case, Finding, Ledger
from warpffrf.verification.scenes.rollers import PAIR, guided_pair, roller_body

STEPS, STEP, LOAD, SPEED, FRICTION = 1_000_000, 1e-4, 20e3, 10.0, 0.1  # s, N, rad/s
RAMP = 0.02  # s
SHARE = 0.05  # of the run at either end
ROWS = 2000  # not a whole number a turn


@lru_cache
def _body() -> ReducedBody:
    return roller_body(180, layers=4, axial=2, grading=1.6, order=1, modes=4, tangential=True)


def build() -> Scene:
    """The pair under its load, the lower roller driven."""
    scene = guided_pair(_body(), _body(), load=LOAD, friction=FRICTION)
    axle = next(joint for joint in scene.joints if joint.name == "axle")
    scene.add(joints.Drive(axle, signals.SmoothStep(0.0, SPEED, duration=RAMP), quantity="velocity"))
    return scene


def check(result: Result) -> list[Finding]:
    """Drift of force, ripple and friction, over the mean force, and of the angles."""
    t, force = result.time, result.history.contacts[PAIR].force
    begin = 5.0 * RAMP
    span = SHARE * (t[-1] - begin)
    early, late = (t > begin) & (t < begin + span), t > t[-1] - span
    mean = float(np.abs(force[early, 2]).mean())
    normal = abs(float(force[late, 2].mean() - force[early, 2].mean())) / mean
    ripple = abs(float(force[late, 2].std() - force[early, 2].std())) / mean
    along = abs(float(force[late, 0].mean() - force[early, 0].mean())) / mean
    lower, upper = (result.joint(name).named("rotation") for name in ("axle", "upper_axle"))
    apart = lower + upper
    return [
        Finding("drift of the force", normal, 1e-3, 1e-2),
        Finding("drift of its ripple", ripple, 1e-3, 1e-2),
        Finding("drift of the friction", along, 1e-3, 1e-2),
        Finding("drift of the angles, a turn [rad]", _slope(lower[t > begin], apart[t > begin]), 1e-5, 1e-3),
    ]


def _slope(angle: np.ndarray, apart: np.ndarray) -> float:
    """How much further apart the angles come in a turn [rad]."""
    return abs(float(np.polyfit(angle, apart, 1)[0])) * 2.0 * np.pi


CASE = Case(
    "1e6 steps of rolling",
    "Two rollers with friction roll on each other for a million steps, one driven: nothing may drift.",
    build, STEPS * STEP, check, steps=(STEP,), middle=STEP, tolerances=(), errors=(), accuracies=(), most_steps=STEPS,
    rows=ROWS, ledger=Ledger(gain=(1e-3, 1e-2), loss=(1e-3, 1e-2)), memory=(32.0, 128.0),
    options={"start": "equilibrium"}, slow=True,
)  # fmt: skip
