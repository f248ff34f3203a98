"""What the tests of the demos share: a computed value with the value that it must have, the two sizes, the files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest


def both_sizes(test: Callable[..., None]) -> Callable[..., None]:
    """A whole demo, `quick` and in full: two slow tests."""
    return pytest.mark.slow(pytest.mark.parametrize("quick", [True, False])(test))


@dataclass(frozen=True)
class Check:
    """A computed value and the expected one, in SI units.

    `source` names where the expected value comes from. `tolerance` is the largest difference, divided by `scale` where
    the expected value is zero or not the size that matters, otherwise by the expected value. `unit` and `factor` are
    those of a message.
    """

    name: str
    computed: float
    expected: float
    source: str
    tolerance: float
    unit: str = "-"
    factor: float = 1.0
    scale: float | None = None

    @property
    def error(self) -> float:
        """The difference divided by `scale`, or by the expected value."""
        return (self.computed - self.expected) / (self.expected if self.scale is None else self.scale)

    @property
    def passed(self) -> bool:
        """Whether the difference is within the tolerance; NaN is not."""
        return bool(abs(self.error) <= self.tolerance)


def missed(checks: Sequence[Check]) -> list[str]:
    """A line for each check that failed."""
    return [
        f"{c.name}: {c.computed * c.factor:.9g} {c.unit}, {c.source}: {c.expected * c.factor:.9g}, "
        f"error {c.error:+.1e}, tolerance {c.tolerance:.1g}"
        for c in checks
        if not c.passed
    ]


def left_behind(folder: Path, name: str, *runs: str) -> None:
    """A demo has written its results, its recording and its picture, the results of its other `runs`, and no more."""
    files = {f"{name}.h5", f"{name}.rrd", f"{name}.png", *(f"{name}.{run}.h5" for run in runs)}
    assert {path.name for path in folder.iterdir()} == files
