"""Output of a run in progress.

A *keeper* is asked regularly whether it is due, and then receives all rows of the run so far with a checkpoint. A
stopped run continues from the last checkpoint bit for bit: `Unfinished` holds its rows as collected, together with the
checkpoint, so that results are computed from all rows at once, as in an uninterrupted run.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

Rows = dict[str, np.ndarray]
"""Saved rows by name. Those of later chunks follow along the first axis, in which arrays need not be alike."""


@dataclass(frozen=True)
class Source:
    """What it takes, beside rows, to make their history: the kind of run ("steps", "check"), the scene, and what
    of its options the history depends on."""

    kind: str
    scene: Any
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Plan:
    """The target of a run, and its data from the start."""

    last_step: int  # user steps, counted as the checkpoint does
    rejected: int  # attempts that an earlier run, which this one continues, had rejected
    notes: tuple[str, ...]


@dataclass(frozen=True)
class Unfinished:
    """A run up to its last checkpoint; `rows` in chunks as they came, which nobody changes any more."""

    rows: Sequence[Rows]
    checkpoint: Mapping[str, np.ndarray]
    plan: Plan
    start: Any = "initial"  # of the run, for one that has to begin anew


class Keeper(Protocol):
    """Somewhere to put what a run has done so far."""

    def begin(self, source: Source) -> None:
        """Of a run that is about to give something out: what its rows are of."""
        ...

    def clear(self) -> None:
        """Forget what was given out: the run begins anew."""
        ...

    def due(self) -> bool:
        """Whether it is time to be given something, and the last of it has been put away."""
        ...

    def keep(self, run: Unfinished) -> None:
        """Take the run so far, of which chunks that were put away before are not taken again. It may be put away later,
        in another thread."""
        ...
