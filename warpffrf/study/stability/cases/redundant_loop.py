"""A parallelogram with a third and a fourth crank: more constraints than it takes."""

from __future__ import annotations

from warpffrf.model.scene import Scene
from warpffrf.study.stability.case import Case
from warpffrf.study.stability.cases.flat_parallelogram import error, linkage


def build() -> Scene:
    """A tenth of a turn from upright, not flat in between."""
    return linkage((0.5, 0.25))


CASE = Case("redundant loop", "four parallel cranks on one coupler", build, 0.1, error, 1e-3, 1e-2)
