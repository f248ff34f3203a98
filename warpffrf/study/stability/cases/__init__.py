"""The cases of the suite, one file each; a new one is a file with `CASE`, and its name here."""

from __future__ import annotations

from warpffrf.study.stability.case import Case
from warpffrf.study.stability.cases import (
    any_friction,
    bounces,
    fast_impact,
    flat_parallelogram,
    long_chain,
    mass_ratio,
    other_units,
    redundant_loop,
    stiffness_ratio,
)

CASES: dict[str, Case] = {
    module.CASE.name: module.CASE
    for module in (
        stiffness_ratio,
        mass_ratio,
        fast_impact,
        bounces,
        any_friction,
        flat_parallelogram,
        redundant_loop,
        long_chain,
        other_units,
    )  # fmt: skip
}
