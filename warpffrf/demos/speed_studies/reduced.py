"""The roller of the two-roller demo, which several studies share; it is reduced once in a process."""

from __future__ import annotations

from functools import cache

import warpffrf as wf
from warpffrf.demos import two_rollers as rollers

QUICK_SECTORS = 600  # an element wider than half the patch: only to see that a study runs


@cache
def roller(quick: bool) -> wf.ReducedBody:
    """For pressures on its mesh and on cells that travel."""
    size = rollers.Size(QUICK_SECTORS, layers=10, axial=2) if quick else rollers.QUICK
    return rollers.roller_body(size, patch_grid=True, progress=False)
