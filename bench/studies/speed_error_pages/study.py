"""What a study of this package is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from warpffrf.study.speed_against_error.outcome import SpeedError

FEWER = 2  # of the steps with --quick


class Made(Protocol):
    """What runs a study; quick: a coarser machine and fewer steps, only to see that it runs."""

    def __call__(self, quick: bool, *, progress: bool = True) -> SpeedError: ...


@dataclass(frozen=True)
class Study:
    """`name` of its files, `heading`, `text` of its page (what is run, Markdown), and `make`, which runs it."""

    name: str
    heading: str
    text: str
    make: Made


def steps(all_steps: Sequence[float], quick: bool) -> list[float]:
    """The steps [s] of a study, coarse ones first."""
    return list(all_steps[:-FEWER] if quick else all_steps)
