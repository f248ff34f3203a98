"""Friction in joints: stick and slip of its rows, dissipation, and what is stored."""

from __future__ import annotations

from warpffrf.online.step.launches import blocks, threads
from warpffrf.online.step.phases import Participant
from warpffrf_kernels.constraints import joint_friction

JOINT_FRICTION = Participant(
    "joint friction",
    when="joint_friction",
    load=[blocks(joint_friction.rub)],
    store=[threads(joint_friction.renew)],
    assemble=[blocks(joint_friction.couple_friction)],
    estimate=[threads(joint_friction.end_slips)],
    commit=[blocks(joint_friction.keep_slips)],
    record=[blocks(joint_friction.record_slips)],
)
