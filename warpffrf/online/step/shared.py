"""Surfaces that serve several pairs: what the loads of one do to the others
(`warpffrf_kernels.shared.shared_surface`)."""

from __future__ import annotations

from warpffrf_kernels.shared import shared_assembly, shared_surface

from warpffrf.online.step.launches import blocks
from warpffrf.online.step.phases import Participant

SHARED = Participant(
    "shared surfaces",
    when="shared_pair",
    displace=[blocks(shared_surface.share_pressures, "pair")],
    respond=[blocks(shared_assembly.assemble_shared, field="shared_field")],
)
