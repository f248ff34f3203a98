"""What of the state a rejected attempt puts back, see `warpffrf_kernels.step.snapshot`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import warp as wp
from warpffrf_kernels.core.declaration import parts
from warpffrf_kernels.step import snapshot

from warpffrf.online.arrays.scratch import RESTORED
from warpffrf.online.step.launches import Launch, blocks
from warpffrf.online.step.phases import Participant

REMEMBER = {wp.float64: snapshot.remember_reals, wp.int32: snapshot.remember_integers}
RESTORE = {wp.float64: snapshot.restore_reals, wp.int32: snapshot.restore_integers}


def _launches(kernels: Mapping[type, Any]) -> list[Launch]:
    """One an array, where the scene has its last axis."""
    return [
        blocks(kernels[d.dtype], when=parts(str(d.axes[-1]))[1], now=name, before=f"{name}_before")
        for name, d in RESTORED.items()
    ]


SNAPSHOT = Participant("snapshot", when="pair", remember=_launches(REMEMBER), restore=_launches(RESTORE))
