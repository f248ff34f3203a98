"""Size of the patch of a place of a lumped contact, which moments come from; laws of the force know it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Patch:
    """Under the force F: half-axes `short` and `long` [m/N^growth] times F^growth, None of a line, and the moment
    `ahead` [-] of the pressure ahead of the middle, over F and the short one."""

    short: float
    long: float | None
    growth: float
    ahead: float
