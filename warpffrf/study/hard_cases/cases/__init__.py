"""One file a case; `CASES` is the registry by name, in the order of the page."""

from __future__ import annotations

from warpffrf.study.hard_cases.case import Case
from warpffrf.study.hard_cases.cases import (
    bounces,
    fast_impact,
    friction_ladder,
    heavy_on_light,
    jam,
    long_chain,
    mass_ratio,
    redundant_loop,
    singular_pose,
    squeezer,
    stiffness_ratio,
)

_ALL = (
    stiffness_ratio.CASE, mass_ratio.CASE, fast_impact.CASE, heavy_on_light.CASE, bounces.CASE, bounces.DAMPED,
    friction_ladder.CASE, jam.CASE, redundant_loop.CASE, singular_pose.CASE, squeezer.CASE, long_chain.CASE,
)  # fmt: skip

CASES: dict[str, Case] = {case.name: case for case in _ALL}
