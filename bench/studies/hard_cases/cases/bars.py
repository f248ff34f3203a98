"""Two steel bars meet end to end at 10 m/s: St Venant's impact (case C8 at a hundred times its speed).

They exchange their velocities, and touch for 2 L/c; bodies of the closed form of a rod, with 20 modes and one column of
nodes (`studies.contact.colliding_bars`).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from references.closed_forms.impact import BarImpact
from studies.contact.colliding_bars import LENGTH, SIDE, STEEL, bar, meeting
from studies.hard_cases.case import Case, Finding
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

SPEED, GAP, MODES = 10.0, 1e-4, 20  # m/s, m
EXACT = BarImpact(STEEL, LENGTH, SIDE**2, SPEED)
OVER = GAP / SPEED + 1.2 * EXACT.duration


@lru_cache
def _body() -> ReducedBody:
    return bar(MODES)


def build() -> Scene:
    """The left bar comes, the right one is at rest."""
    return meeting(_body(), speed=SPEED, gap=GAP)


def check(result: Result) -> list[Finding]:
    """Momentum at all times; impulse and time of the touch once it is over."""
    v = [result.body(name).velocity[:, 0] for name in ("first", "second")]
    found = [Finding("momentum", float(np.abs(v[0] + v[1] - SPEED).max()) / SPEED, 1e-8, 1e-5)]
    if result.time[-1] < OVER:
        return found
    found.append(Finding("impulse", abs(float(v[1][-1]) / SPEED - 1.0), 5e-2, 1.5e-1))
    step = float(result.history.step_size[1:].max())
    if step < 0.02 * EXACT.duration:
        on = np.flatnonzero(result.history.contacts["pair"].force[:, 0] < 0.0)
        touched = result.time[on[-1]] - result.time[on[0]]
        found.append(Finding("time of the touch", abs(float(touched) / EXACT.duration - 1.0), 5e-2, 1.5e-1))
    return found


CASE = Case(
    "bars at 10 m/s",
    "Elastic bars meet end to end at 10 m/s, with waves that run through them.",
    build, 1e-3, check, middle=1e-6, most_steps=10_000, energies=(1e-5,), quick=True,
)  # fmt: skip
