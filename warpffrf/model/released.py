"""Joints and drives that hold nothing in a part of a run, and those that hold again where they stand.

A stage changes which rows hold. The state keeps its meaning, because every part of the run has the rows that hold in
any of them: one that holds nothing here is a spring row without stiffness, lambda = 0
(`warpffrf_kernels.constraints.rows`). Rows that are redundant here, but not in another part, are such rows, too. A
row that holds again does so at the coordinate that it has then, so that no position jumps.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

RowKey = tuple[str, Any]  # the owner of a row, a joint or drive, and the `joints.Row`


@dataclass(frozen=True)
class Released:
    """names: of joints and drives that hold nothing. rows: all that hold in some part of the run. held_at: coordinates
    [m, rad, 1] at which rows hold that were released before; of a drive, in addition to its signal. changed: other rows
    hold than before; held_again: among them some that did not."""

    names: frozenset[str] = frozenset()
    rows: frozenset[RowKey] = frozenset()
    held_at: Mapping[RowKey, float] = field(default_factory=dict)
    changed: bool = False
    held_again: bool = False


NOTHING = Released()
