"""Lumped contacts of rigid surfaces: forces at their nearest places, their tangent, and what a step keeps of them."""

from __future__ import annotations

from warpffrf_kernels.lumped import forces
from warpffrf_kernels.step import leaps

from warpffrf.online.step.launches import threads
from warpffrf.online.step.phases import Participant

LUMPED = Participant(
    "lumped contacts",
    when="lumped",
    load=[threads(forces.find_forces, "lumped_place"), threads(forces.push_lumped)],
    assemble=[threads(forces.stiffen_lumped)],
    judge=[threads(leaps.refuse_leaps_of_places)],
    keep=[threads(forces.keep_lumped, "lumped_place")],
    record=[threads(forces.record_lumped, "lumped_place")],
)
