"""Rollers of the two-roller demo, which several studies share; each is reduced once in a process."""

from __future__ import annotations

from functools import cache

import warpffrf as wf
from demos import two_rollers as rollers

COARSE = rollers.Size(sectors=80, layers=8, axial=5)  # hexahedra of 4 mm
QUICK_SECTORS = 600  # an element wider than half the patch: only to see that a study runs


@cache
def roller(quick: bool, size: rollers.Size = rollers.QUICK) -> wf.ReducedBody:
    """For pressures on its mesh and on contact-fixed cells; quick: no finer than to see that a study runs."""
    if quick and size.sectors > QUICK_SECTORS:
        size = rollers.Size(QUICK_SECTORS, layers=10, axial=2)
    return rollers.roller_body(size, contact_fixed=True, progress=False)
