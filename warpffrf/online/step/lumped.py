"""Lumped contacts of rigid surfaces: forces at their closest points, moments that resist rolling and pivoting (if any),
their tangents, and what a step stores."""

from __future__ import annotations

from warpffrf.online.step.launches import blocks, threads
from warpffrf.online.step.phases import Participant
from warpffrf_kernels.lumped import balance, forces, moments
from warpffrf_kernels.step import missed_contact

RESISTING = "lumped_moment"  # points with rolling or pivoting resistance

LUMPED = Participant(
    "lumped contacts",
    when="lumped",
    load=[
        blocks(forces.find_forces),
        threads(moments.find_moments, RESISTING, when=RESISTING),
        blocks(balance.push_lumped),
    ],
    assemble=[blocks(balance.stiffen_lumped)],
    judge=[blocks(missed_contact.refuse_leaps_of_places)],
    keep=[blocks(balance.keep_lumped)],
    record=[blocks(balance.record_lumped), threads(balance.record_moments, RESISTING, when=RESISTING)],
)
