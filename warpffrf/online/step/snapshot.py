"""What of the state a rejected attempt puts back, see `warpffrf_kernels.step.snapshot`."""

from __future__ import annotations

import warp as wp
from warpffrf_kernels.core.declaration import parts
from warpffrf_kernels.step import snapshot

from warpffrf.online.arrays.scratch import RESTORED
from warpffrf.online.step.launches import Launch, blocks
from warpffrf.online.step.phases import Participant

COPY = {wp.float64: snapshot.copy_reals, wp.int32: snapshot.copy_integers}


def _copy(source: str, target: str, *, rejected: int) -> list[Launch]:
    """One launch for each array that is restored, `{}` its name, where the scene has its last axis."""
    return [
        blocks(
            COPY[d.dtype], when=parts(str(d.axes[-1]))[1], rejected=rejected, source=source.format(name),
            target=target.format(name),
        )
        for name, d in RESTORED.items()
    ]  # fmt: skip


SNAPSHOT = Participant(
    "snapshot",
    when="pair",
    remember=_copy("{}", "{}_before", rejected=0),
    restore=_copy("{}_before", "{}", rejected=1),
)
