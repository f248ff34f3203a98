"""What a hard case is: a scene, the steps that it is run with, and what must come out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from warpffrf.model.scene import Scene
from warpffrf.output.result import Result

STEPS = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)  # s


@dataclass(frozen=True)
class Case:
    """A hard case. what: what it tests. build: the scene, anew for each run. duration [s]. error: of a completed run, a
    fraction, against a closed form or an invariant; `good` and `usable` are its limits. options: of
    `simulate`."""

    name: str
    what: str
    build: Callable[[], Scene]
    duration: float
    error: Callable[[Scene, Result], float]
    good: float
    usable: float
    options: Mapping[str, Any] = field(default_factory=dict)
    most: int = 3000  # steps of one run: finer ones are left out, they would say little more and take long

    def steps(self) -> list[float]:
        """Steps [s] of the suite that go into the duration and are not too many."""
        return [h for h in STEPS if 1 <= round(self.duration / h) <= self.most]
