"""Pretensions: the forces of their rows, and the lengths that they lock."""

from __future__ import annotations

from warpffrf.online.step.launches import blocks, threads
from warpffrf.online.step.phases import Participant
from warpffrf_kernels.constraints import pretension

PRETENSION = Participant(
    "pretension",
    when="pretension",
    load=[blocks(pretension.tighten)],
    estimate=[threads(pretension.stop_lengths)],
    keep=[blocks(pretension.keep_lengths)],
)
