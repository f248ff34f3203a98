r"""A block on a running belt, held by a spring, with friction that falls with the slip speed: it sticks and slips.

Falling friction is negative damping; amplitude and period of the cycle are found event by event
(`references.stick_slip.BeltOscillator`).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from references.stick_slip import BeltOscillator
from scenes.block_on_belt import LOAD, MASS, SPEED, STIFFNESS, on_belt, wheel_body
from studies.hard_cases.case import Case, Finding
from warpffrf.model import laws
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

FALL = laws.Stribeck(0.4, 0.2, 0.1)
DURATION = 0.65  # s


@lru_cache
def _body() -> ReducedBody:
    return wheel_body()


def build() -> Scene:
    """The block on the belt."""
    return on_belt(_body(), FALL)


def check(result: Result) -> list[Finding]:
    """Amplitude after the first cycle, and the coefficient at which it breaks away."""
    pair = result.history.contacts["pair"]
    used = float(np.abs(pair.force[1:, 0] / pair.force[1:, 2]).max())
    found = [Finding("coefficient beyond the static one", max(used / FALL.static - 1.0, 0.0), 1e-6, 1e-3)]
    amplitude, period = BeltOscillator(MASS + _body().mass, STIFFNESS, LOAD, SPEED).cycle(
        lambda v: float(FALL.coefficient_at(v))
    )
    x = result.history.bodies["slide"].position[:, 0]
    later = result.time > 0.25
    if result.time[-1] > 0.25 + 2.0 * period:
        found.append(Finding("amplitude", abs(0.5 * float(np.ptp(x[later])) / amplitude - 1.0), 2e-2, 1e-1))
    return found


CASE = Case(
    "stick-slip",
    "A block on a belt with friction that falls with the slip speed: negative damping, stick and slip in turn.",
    build, DURATION, check, steps=(1e-6, 1e-5, 1e-4, 1e-3, 1e-2), middle=1e-3, tolerances=(1e-6,), most_steps=7000,
    options={"start": "equilibrium"},
)  # fmt: skip
