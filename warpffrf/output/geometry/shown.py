"""What of a run is shown: which of its saved rows, and how often its elastic displacement is magnified."""

from __future__ import annotations

import numpy as np

SHOWN_DISPLACEMENT = (
    0.015  # automatic magnification: the largest displacement is drawn at most this part of the smallest body's size
)


def frame_rows(steps: int, max_frames: int) -> tuple[np.ndarray, int]:
    """Rows to show, first and last among them, at most `max_frames`, and the stride between them."""
    if steps == 0:
        return np.zeros(0, dtype=int), 1
    if steps == 1 or max_frames == 1:
        return np.array([steps - 1]), max(steps, 1)
    stride = -(-(steps - 1) // (max_frames - 1))
    return rows_every(steps, stride), stride


def rows_every(steps: int, stride: int) -> np.ndarray:
    """Every `stride`th row from the first on, and the last."""
    rows = np.arange(0, steps, stride)
    return rows if rows[-1] == steps - 1 else np.append(rows, steps - 1)


def automatic_factor(largest: float, size: float) -> float:
    """Magnification of elastic displacements up to `largest` [m] on bodies whose smallest has the extent `size` [m]."""
    return round_factor(SHOWN_DISPLACEMENT * size / largest) if largest > 0.0 else 1.0


def round_factor(factor: float) -> float:
    """The largest of 1, 2, 5 times a power of ten not above `factor`; at least 1."""
    if not np.isfinite(factor) or factor <= 1.0:
        return 1.0
    decade = 10.0 ** np.floor(np.log10(factor))
    return float(max(m * decade for m in (1.0, 2.0, 5.0) if m * decade <= factor * (1.0 + 1e-12)))
