"""Makes docs/studies/accuracy.md: `python -m warpffrf.demos.accuracy_studies [FOLDER] [NAME ...]`, minutes.

Machines are run with `simulate(accuracy=)`, and what it chose is held against runs of the same machine with other
steps, contact grids and inertia levels: whether the wanted error is kept, and how much faster the fastest of those is
that keep it too. Errors are those of the studies of speed against error (`warpffrf.study.speed_against_error.errors`),
beside a run with FINER times the steps, all inertia terms, and the smallest cells where bodies have what those need.
"""

from __future__ import annotations

import itertools
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf.demos import slider_crank as crank
from warpffrf.demos import two_rollers as rollers
from warpffrf.demos.checks import writable_folder
from warpffrf.demos.speed_studies import slider_crank as crank_study
from warpffrf.demos.speed_studies import two_rollers as roller_study
from warpffrf.demos.speed_studies.reduced import roller
from warpffrf.model.contact import CELL_ERRORS
from warpffrf.study.budget_check import BARS, colliding_bars, driven_mass, pendulum
from warpffrf.study.speed_against_error.errors import errors_of, measures_of
from warpffrf.study.speed_against_error.machines import applied
from warpffrf.verification.markdown import table

ACCURACY = 0.01
PRESSURES = 2.0  # times the accuracy, as `output.accuracy` has it
FINER = 8  # times the steps that were chosen, in the reference
RATIOS = (0.125, 0.25, 0.5, 1.0, 2.0)  # of those steps, that are tried
TIMES = 2  # each; the faster counts
FOLDER, PAGE = "docs/studies", "accuracy.md"
MADE = "Made by `python -m warpffrf.demos.accuracy_studies`; do not edit.\n"


@dataclass(frozen=True)
class Machine:
    """A machine, how long it runs [s], from where, and points of flexible bodies whose motion is looked at."""

    title: str
    build: Callable[[], wf.Scene]
    duration: float
    options: dict[str, Any] = field(default_factory=dict)
    points: dict[str, Any] = field(default_factory=dict)
    measures: tuple[str, ...] | None = None


MACHINES: dict[str, Machine] = {
    "pendulum": Machine("a pendulum", pendulum, 4.0),
    "driven_mass": Machine("a mass on a spring, driven", driven_mass, 4.0),
    "two_rollers": Machine(
        "two rollers, spun up and loaded",
        lambda: rollers.machine(roller(False), load_step_at=roller_study.LOAD_STEP),
        roller_study.RUN,
        {"start": "equilibrium"},
    ),
    "pressed_rollers": Machine(
        "the rollers without rolling",
        lambda: rollers.machine(roller(False), load_step_at=roller_study.LOAD_STEP, speed=0.0),
        roller_study.RUN,
        {"start": "equilibrium"},
    ),
    "slider_crank": Machine(
        "slider-crank, elastic rod", lambda: crank.machine(crank.rod_body(crank.FULL, progress=False)),
        crank_study.RUN,
        points={"rod": [(0.0, 0.0, 0.5 * crank.SECTION)]},
    ),
    "colliding_bars": Machine("two bars collide", colliding_bars, BARS),
}  # fmt: skip


@dataclass
class Tried:
    """A setting, its errors as fractions, and wall time [s] of its time loop."""

    steps: int
    setting: dict[str, Any]
    errors: dict[str, float]
    seconds: float

    @property
    def kept(self) -> bool:
        """Whether all errors are within what is wanted."""
        own = {m: e for m, e in self.errors.items() if m in OF}
        return bool(own) and all(e <= ACCURACY * (PRESSURES if m == "pressure" else 1.0) for m, e in own.items())

    def text(self) -> str:
        """The setting in words."""
        return ", ".join([f"{self.steps} steps", *(f"{k}={v}" for k, v in self.setting.items())])


OF = ("force", "pressure", "displacement", "deformation")  # errors that a wanted one is of


@dataclass
class Found:
    """What `accuracy=` chose, its errors and times, and what else was tried."""

    machine: Machine
    chosen: Tried
    runs: int
    whole_seconds: float
    tried: list[Tried]

    @property
    def best(self) -> Tried | None:
        """The fastest of all that keep the wanted error."""
        return min((t for t in [self.chosen, *self.tried] if t.kept), key=lambda t: t.seconds, default=None)


def measure(machine: Machine, *, progress: bool = True) -> Found:
    """One machine."""
    scene = machine.build()
    begin = time.perf_counter()
    result = wf.simulate(scene, machine.duration, accuracy=ACCURACY, progress=progress, **machine.options)
    whole = time.perf_counter() - begin
    steps = len(result.time) - 1
    exact = _reference(machine, result.scene, steps)
    flexible = [body for body in scene.bodies if body.reduced is not None]
    settings = [{"inertia": level} for level in ("constant", "full")] if flexible else [{}]
    if scene.contacts:
        ready = all(contact.without_patch() is None for contact in scene.contacts)
        settings = [{**s, "grid": g} for s in settings for g in (("material", "patch") if ready else ("material",))]
    tried = []
    for setting, other in itertools.product(settings, others(steps)):
        try:
            tried.append(_timed(machine, scene, setting, other, exact))
        except wf.InputError:  # a body without inertia terms
            continue
    chosen = _timed(machine, result.scene, {}, steps, exact)
    return Found(machine, chosen, int(result.history.counters["accuracy_runs"]), whole, tried)


def others(steps: int) -> list[int]:
    """Numbers of steps near RATIOS times `steps` that divide those of the reference, so that times are common."""
    whole = FINER * steps
    divisors = np.array([n for n in range(1, whole + 1) if whole % n == 0])
    return sorted({int(divisors[np.argmin(np.abs(np.log(divisors / (ratio * steps))))]) for ratio in RATIOS})


def _reference(machine: Machine, scene: wf.Scene, steps: int) -> wf.Result:
    setting: dict[str, Any] = {}
    flexible = [body.reduced for body in scene.bodies if body.reduced is not None]
    if flexible and all(body.inertia_terms is not None for body in flexible):
        setting["inertia"] = "full"
    if scene.contacts and all(contact.without_patch() is None for contact in scene.contacts):
        setting |= {"grid": "patch", "cell_error": 4.0 * CELL_ERRORS[0]}
    with applied(scene, setting):
        return wf.simulate(
            scene, machine.duration, step=machine.duration / steps / FINER, progress=False, **machine.options
        )


def _timed(machine: Machine, scene: wf.Scene, setting: dict[str, Any], steps: int, exact: wf.Result) -> Tried:
    seconds, errors = [], {}
    for _ in range(TIMES):
        with applied(scene, setting):
            result = wf.simulate(
                scene, machine.duration, step=machine.duration / steps, progress=False, **machine.options
            )
        seconds.append(float(result.history.counters["loop_seconds"]))
    if result.status == "completed":
        rows = np.arange(len(result.time))
        same = np.arange(len(result.time)) * ((len(exact.time) - 1) // steps)
        errors = errors_of(result, rows, exact, same, measures_of(scene, machine.measures), machine.points)
    else:
        errors = {"force": float("inf")}
    return Tried(steps, setting, errors, min(seconds))


def page(found: list[Found]) -> str:
    """Markdown."""
    rows = []
    for f in found:
        errors = ", ".join(f"{m} {100.0 * e:.2g}" for m, e in f.chosen.errors.items() if m in OF)
        best = f.best
        rows.append([
            f.machine.title, f.chosen.text(), errors, "yes" if f.chosen.kept else "NO", f"{f.chosen.seconds:.3g}",
            "-" if best is None else f"{best.seconds:.3g} ({best.text()})",
            "-" if best is None else f"{f.chosen.seconds / best.seconds:.2f}", str(f.runs), f"{f.whole_seconds:.3g}",
        ])  # fmt: skip
    head = ["machine", "chosen", "errors [%]", "kept", "time loop [s]", "fastest that keeps it [s]", "ratio", "runs",
            "the whole call [s]"]  # fmt: skip
    return f"""# Runs to a wanted accuracy

{MADE}
`simulate(accuracy={ACCURACY:g})` beside runs of the same machine with about {", ".join(f"{r:g}" for r in RATIOS)} times
its steps, on both contact grids where bodies are prepared for them, and inertia levels constant and full. Errors are
beside a run with {FINER} times the steps, all inertia terms and finer cells where bodies can have them; wanted are 1 %
of forces, displacements and deformations and 2 % of pressures. Times are wall time of the loop over steps, the faster
of {TIMES}; the whole call has all runs that it took to choose, their set-up and their budgets.

{table(head, rows)}"""


def main() -> None:
    arguments = sys.argv[1:]
    folder = Path(arguments[0]) if arguments else writable_folder(FOLDER)
    names = arguments[1:] or list(MACHINES)
    text = page([measure(MACHINES[name]) for name in names])
    folder.mkdir(parents=True, exist_ok=True)
    (folder / PAGE).write_text(text, encoding="utf-8")
    print(folder / PAGE)


if __name__ == "__main__":
    main()
