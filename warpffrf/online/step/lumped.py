"""Lumped contacts of rigid surfaces: forces at their closest points, moments that resist rolling and pivoting (if any),
their tangents, and what a step stores."""

from __future__ import annotations

from warpffrf.online.step.launches import threads
from warpffrf.online.step.phases import Participant
from warpffrf_kernels.lumped import forces, moments
from warpffrf_kernels.step import missed_contact

LUMPED = Participant(
    "lumped contacts",
    when="lumped",
    load=[threads(forces.find_forces, "lumped_place"), threads(forces.push_lumped)],
    assemble=[threads(forces.stiffen_lumped)],
    judge=[threads(missed_contact.refuse_leaps_of_places)],
    keep=[threads(forces.keep_lumped, "lumped_place")],
    record=[threads(forces.record_lumped, "lumped_place")],
)

MOMENTS = Participant(
    "moments of lumped contacts",
    when="lumped_moment",
    load=[threads(moments.find_moments, "lumped_moment"), threads(moments.push_moments)],
    assemble=[threads(moments.stiffen_moments)],
    record=[threads(moments.record_moments, "lumped_moment")],
)
