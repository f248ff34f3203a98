"""Output of a run in progress.

A *keeper* is regularly queried whether it is due, and then receives all rows of the run so far with a checkpoint. A
stopped run continues from the last checkpoint bit for bit: `Unfinished` holds its rows as collected, together with the
checkpoint, so that results are computed from all rows at once, as in an uninterrupted run.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

Rows = dict[str, np.ndarray]
"""Saved rows by name. Those of later chunks follow along the first axis, in whose length arrays may differ."""


@dataclass(frozen=True)
class Source:
    """Data required, in addition to the rows, for their history: the kind of run ("steps", "check"), the scene, and the
    options that the history depends on."""

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
    """A run up to its last checkpoint; `rows` in chunks as received, not changed any more."""

    rows: Sequence[Rows]
    checkpoint: Mapping[str, np.ndarray]
    plan: Plan
    start: Any = "initial"  # of the run, for one that has to start again


class Keeper(Protocol):
    """Storage of the output of a run in progress."""

    def begin(self, source: Source) -> None:
        """The source of the rows that follow, before the first output of a run."""
        ...

    def clear(self) -> None:
        """Discard all output: the run starts again."""
        ...

    def due(self) -> bool:
        """Whether output is due, and the previous output has been stored."""
        ...

    def keep(self, run: Unfinished) -> None:
        """Store the run so far, without the chunks that were stored before. It may be written later, in another
        thread."""
        ...
