"""Rows of the table of `studies.small_sliding.acceptance`, and the load steps of its cases."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from warpffrf.model import signals
from warpffrf.model.scene import Scene
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate

Array = np.ndarray


@dataclass(frozen=True)
class Row:
    """A `case` of so many `cells`, what is `compared`, in `unit`, its `exact` value, what was `found`, and the largest
    error: of the exact value where `relative`."""

    case: str
    cells: str
    compared: str
    unit: str
    exact: float
    found: float
    target: float
    relative: bool = True

    @property
    def error(self) -> float:
        """Of the exact value, or as it is."""
        off = self.found - self.exact
        return off / abs(self.exact) if self.relative else off

    @property
    def reached(self) -> bool:
        """Whether the target is."""
        return bool(abs(self.error) <= self.target)

    def line(self) -> list[str]:
        """Of the table."""
        error, target = f"{self.error:+.2g}", f"{self.target:g}"
        if self.relative and self.target >= 1e-4:
            error, target = f"{100.0 * self.error:+.2g} %", f"{100.0 * self.target:g} %"
        exact, found = (f"{value:.5g} {self.unit}".strip() for value in (self.exact, self.found))
        return [self.case, self.cells, self.compared, exact, found, error, target, "" if self.reached else "missed"]


def loads(path: Sequence[float] | Array, scale: float = 1.0) -> signals.Table:
    """A load that passes through `path` times `scale`, one of its values a second."""
    return signals.Table(np.arange(len(path), dtype=float), scale * np.asarray(path, dtype=float))


def cycle(steps: int) -> Array:
    """From 0 to 1, to -1 and back to 1, `steps` load steps a quarter."""
    up = np.linspace(0.0, 1.0, steps + 1)
    down = np.linspace(1.0, -1.0, 2 * steps + 1)[1:]
    return np.concatenate([up, down, -down])


def static(scene: Scene, steps: int) -> Result:
    """Load steps of a second each."""
    return completed(simulate(scene, float(steps), step=1.0, kind="static", progress=False))


def completed(found: Result) -> Result:
    """The result of a run that went through."""
    if found.status != "completed":
        raise RuntimeError(f"{found.status}: {found.message}")
    return found
