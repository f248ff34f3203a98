"""Parts of the state that a rejected attempt restores, see `warpffrf_kernels.step.snapshot`."""

from __future__ import annotations

import warp as wp

from warpffrf.online.arrays.scratch import RESTORED
from warpffrf.online.step.launches import Launch, blocks
from warpffrf.online.step.phases import Participant
from warpffrf_kernels.core.declaration import parts
from warpffrf_kernels.step import snapshot

COPY = {wp.float64: snapshot.copy_reals, wp.int32: snapshot.copy_integers}


def copies(source: str, target: str, *, rejected: int) -> list[Launch]:
    """One launch for each array that is restored, with name `{}`, if the scene has its last axis.

    Raises TypeError at import for an array that has no pair axis, or is not numeric.
    """
    found = []
    for name, d in RESTORED.items():
        axes = [parts(axis)[1] for axis in d.axes if isinstance(axis, str)]
        if d.dtype not in COPY or axes[:1] != ["world"] or axes[1:2] not in (["pair"], ["friction_pair"]):
            raise TypeError(f"{name}: only reals and integers with the axes 'world' and 'pair' can be restored")
        given = {"source": source.format(name), "target": target.format(name)}
        found.append(blocks(COPY[d.dtype], "pair", when=axes[-1], rejected=rejected, **given))
    return found


SNAPSHOT = Participant(
    "snapshot",
    when="pair",
    remember=copies("{}", "{}_before", rejected=0),
    restore=copies("{}_before", "{}", rejected=1),
)
