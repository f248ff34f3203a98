"""An retained matrix eliminated as one dense block: what sparse factors are held against."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from warpffrf.online.compile.retained_pattern import RetainedPattern


def in_one_block(pattern: RetainedPattern) -> RetainedPattern:
    """The same entries, eliminated as a dense matrix with pivots sought among all rows."""
    n, none = pattern.retained_count, np.zeros(0, int)
    lines = np.repeat(np.arange(n), np.diff(pattern.entry_start))
    there = np.zeros((n, n), bool)
    there[lines, pattern.entry_column] = True
    line, column = np.indices((n, n))
    return replace(
        pattern, order=np.arange(n), size=np.array([n]), width=np.array([0]), first=np.array([0]), start=np.array([0]),
        panel_start=np.array([0]), panel=none, target_start=np.array([0]), target=none,
        gather_line=np.where(there, line, -1).ravel(), gather_column=np.where(there, column, -1).ravel(),
    )  # fmt: skip
