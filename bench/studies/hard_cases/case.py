"""What a hard case is, and the settings it is run with.

A case is run over `STEPS`, as many of them as it names, and at its middle step with other tolerances: that of the
iteration (`Settings.residual_tolerance`), of the energy in a step of an impact (`Settings.energy_tolerance`) where
impacts are what it is about, with a local error that halves steps, and with nothing but a wanted `accuracy`. No run
takes more than `most_steps` steps of the size asked for: with the smallest steps only the beginning is run, and the
checks judge what was reached.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.online.settings import Settings
from warpffrf.output.result import Result

STEPS = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)  # s
TOLERANCES = (1e-4, 1e-6, 1e-11)  # of the iteration, besides the usual one
ERROR = 1e-4  # of a step, that halves it
ACCURACY = 1e-3  # wanted of a run that finds its setting itself: what most comparisons pass to
MOST_STEPS = 10_000
FEWEST_STEPS = 5  # a run is longer than its case asks for where that is less
ROWS = 4000  # saved at most


@dataclass(frozen=True)
class Finding:
    """One comparison: `error`, a fraction or in the unit that `of` names, passes up to `good`, is degraded up to
    `bad` and wrong beyond; NaN is wrong."""

    of: str
    error: float
    good: float
    bad: float

    @property
    def level(self) -> int:
        """0 right, 1 degraded, 2 wrong."""
        if not self.error <= self.bad:
            return 2
        return int(self.error > self.good)


@dataclass(frozen=True)
class Ledger:
    """Limits of what the energy ledger may gain and lose, over the energy at hand; `floor` [J]: least energy at hand,
    for scenes in which next to nothing moves."""

    gain: tuple[float, float] = (1e-3, 1e-2)  # a run says so itself beyond a hundredth
    loss: tuple[float, float] = (1e-2, 1e-1)  # numerical damping takes what steps do not resolve
    floor: float = 0.0


@dataclass(frozen=True)
class Setting:
    """How a case is run: step [s], tolerances of the iteration and of the energy in a step of an impact, local error
    allowed (None: steps as they are); accuracy that the run finds its own setting for, whatever the rest says."""

    step: float
    tolerance: float = Settings.residual_tolerance
    energy: float = Settings.energy_tolerance
    error: float | None = None
    accuracy: float | None = None

    @property
    def column(self) -> str:
        """Its column in table and map."""
        if self.accuracy is not None:
            return f"accuracy {self.accuracy:g}"
        if self.error is not None:
            return f"error {self.error:g}"
        if self.energy != Settings.energy_tolerance:
            return f"energy {self.energy:g}"
        if self.tolerance != Settings.residual_tolerance:
            return f"tolerance {self.tolerance:g}"
        return f"{self.step:g} s"


@dataclass(frozen=True)
class Case:
    """A scene that is hard to step.

    tests: what it tests, in a sentence or two. build: makes the scene anew for every run. duration [s], steps [s] and
    middle [s], the step at which tolerances are varied. check: comparisons of a Result with what is known from
    elsewhere. options: of `online.run` (start, integrator, local_modes). said: words of notes that warn of
    what the check finds.
    twin, alike: another scene that has to do the same, run with the same setting, and comparisons of the two results.
    memory: limits [MB] of what a run may grow by (`memory`). quick: whether `--quick` runs it, at its middle and its
    longest step. slow: run only where it is named. Raises `InputError` for a middle that is none of the steps.
    """

    name: str
    tests: str
    build: Callable[[], Any]
    duration: float
    check: Callable[[Result], Sequence[Finding]]
    steps: tuple[float, ...] = STEPS
    middle: float = 1e-4
    tolerances: tuple[float, ...] = TOLERANCES
    energies: tuple[float, ...] = ()
    errors: tuple[float, ...] = (ERROR,)
    accuracies: tuple[float, ...] = (ACCURACY,)
    options: Mapping[str, Any] = field(default_factory=dict)
    most_steps: int = MOST_STEPS
    rows: int = ROWS
    twin: Callable[[], Any] | None = None
    alike: Callable[[Result, Result], Sequence[Finding]] | None = None
    ledger: Ledger = Ledger()
    memory: tuple[float, float] | None = None
    said: tuple[str, ...] = ()
    quick: bool = False
    slow: bool = False

    def __post_init__(self) -> None:
        if self.middle not in self.steps:
            raise InputError(f"case {self.name!r}: middle must be one of its steps {self.steps}, got {self.middle}")

    def settings(self, *, quick: bool = False) -> list[Setting]:
        """All settings of the case; quick: the middle and the longest step only."""
        if quick:
            return [Setting(step) for step in dict.fromkeys((self.middle, max(self.steps)))]
        found = [Setting(step) for step in self.steps]
        found += [Setting(self.middle, tolerance=tolerance) for tolerance in self.tolerances]
        found += [Setting(self.middle, energy=energy) for energy in self.energies]
        found += [Setting(self.middle, error=error) for error in self.errors]
        return found + [Setting(self.middle, accuracy=accuracy) for accuracy in self.accuracies]

    def step_count(self, step: float) -> int:
        """Steps of a run with steps of `step` [s]."""
        return int(min(max(round(self.duration / step), FEWEST_STEPS), self.most_steps))
