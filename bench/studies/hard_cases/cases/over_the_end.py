"""A tilted roller slides along its axis until its patch has left the barrel below over the end of the roller.

What is known: the force ends where the roller does, action equals reaction, no pressure is negative, friction takes
energy only, and at an edge, where half of the material is missing, the peak is at most 2.5 times that of the whole
patch.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from scenes.over_the_edge import DURATION, long_roller_body, roller_off_its_end
from studies.hard_cases.case import Case, Finding
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

BOUNDED, BEYOND = 2.5, 4.0  # of the first peak


@lru_cache
def _body() -> ReducedBody:
    return long_roller_body()


def build() -> Scene:
    """The tilted roller."""
    return roller_off_its_end(_body())


def check(result: Result) -> list[Finding]:
    """Invariants at every saved step, and the force at the end."""
    pair = result.history.contacts["pair"]
    force, peak = np.linalg.norm(pair.force, axis=1), pair.pressure.max(axis=(1, 2))
    rise = float(np.diff(result.energy["friction"]).max(initial=0.0)) / max(result.energy_scale, 1e-12)
    found = [
        Finding("reaction", float(np.abs(pair.force + pair.force_second).max()) / force.max(), 1e-9, 1e-6),
        Finding("negative pressure", max(-float(pair.pressure.min()), 0.0) / peak.max(), 1e-12, 1e-9),
        Finding("energy from friction", rise, 1e-9, 1e-6),
        Finding("peak over the first", float(peak.max() / peak[0]), BOUNDED, BEYOND),
    ]
    if result.time[-1] >= 0.99 * DURATION:
        found.append(Finding("force beyond the end", float(force[-1] / force[0]), 1e-12, 1e-6))
    return found


CASE = Case(
    "patch over the end",
    "A tilted roller with friction slides until its patch has left it over its end.",
    build, DURATION, check, options={"start": "equilibrium"}, most_steps=1000,
)  # fmt: skip
