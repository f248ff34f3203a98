"""One file a case; `CASES` is the registry by name, in the order of the page."""

from __future__ import annotations

from studies.hard_cases.case import Case
from studies.hard_cases.cases import (
    bars,
    bearing,
    bounces,
    duplicate_modes,
    edge_contact,
    fast_impact,
    fine_grid,
    friction_ladder,
    grazing,
    heavy_on_light,
    incompressible,
    jam,
    long_chain,
    long_rolling,
    mass_ratio,
    misaligned,
    over_the_end,
    redundant_loop,
    rotor,
    singular_pose,
    squeezer,
    stick_slip,
    stiffness_ratio,
    units,
)

_ALL = (
    stiffness_ratio.CASE, mass_ratio.CASE, heavy_on_light.CASE, long_chain.CASE, redundant_loop.CASE,
    singular_pose.CASE, squeezer.CASE, rotor.CASE, duplicate_modes.CASE, units.CASE, fast_impact.CASE, bars.CASE,
    bounces.CASE, bounces.DAMPED, grazing.CASE, grazing.LONG_STEPS, over_the_end.CASE, edge_contact.CASE,
    misaligned.CASE, misaligned.SKEWED, fine_grid.CASE, incompressible.CASE, bearing.CASE, stick_slip.CASE,
    friction_ladder.CASE, jam.CASE, long_rolling.CASE,
)  # fmt: skip

CASES: dict[str, Case] = {case.name: case for case in _ALL}
