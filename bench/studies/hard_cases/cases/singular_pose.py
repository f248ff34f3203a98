r"""A parallelogram linkage whose crank drives it through the poses in which all bars lie in one line.

There it could go on as a parallelogram or as an antiparallelogram, and the rows of its joints depend on one another.
Its inertia takes it through as it came: the rocker's angle is that of the crank. Started at an angle of which no whole
number of steps of 1e-4 s leads to the pose itself.
"""

from __future__ import annotations

import numpy as np

from studies.hard_cases.case import Case, Finding
from studies.hard_cases.cases.redundant_loop import linkage
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

CRANK, FRAME, SPEED, START = 0.1, 0.3, 20.0, 0.7  # m, rad/s, rad


def build() -> Scene:
    """The parallelogram in motion; its coupler does not rotate."""
    end = CRANK * np.array([np.cos(START), np.sin(START)])
    frame = np.array([FRAME, 0.0])
    return linkage([np.zeros(2), end, end + frame, frame], [SPEED, 0.0, SPEED], SPEED)


def check(result: Result) -> list[Finding]:
    """The rocker rotates with the crank."""
    found = result.joint("last pin").named("rotation")
    off = np.abs(found - found[0]) - SPEED * result.time
    return [Finding("rocker's angle", float(np.abs(off).max()), 1e-6, 1e-3)]


CASE = Case(
    "singular pose",
    "A flat parallelogram driven through the poses in which its bars lie in one line, six times.",
    build, 1.0, check, middle=1e-3, quick=True,
)  # fmt: skip
