"""What `simulate(accuracy=)` chooses, compared with other settings of the same machine; an hour.

Each machine is run with `simulate(accuracy=)`. What it chose is compared with runs of the same machine with other
steps, contact grids, inertia levels and stiffening: whether the wanted error is kept, and how much faster the fastest
of those runs is that keep it too. Errors are those of the studies of speed against error
(`warpffrf.study.speed_against_error.errors`), compared with a run with several times the steps, all inertia terms, and
finer cells where bodies have what those need.
"""

from __future__ import annotations

import itertools
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

import warpffrf as wf
from studies.accuracy.machines import FINER, MACHINES, Machine
from warpffrf.model.contact import CELL_ERRORS
from warpffrf.model.errors import unknown_name
from warpffrf.model.messages.status import Status
from warpffrf.study.markdown import table
from warpffrf.study.speed_against_error.choices import can_stiffen
from warpffrf.study.speed_against_error.errors import errors_of, measures_of
from warpffrf.study.speed_against_error.machines import applied

ACCURACY = 0.01
PRESSURES = 2.0  # times the accuracy, as `output.accuracy` has it
RATIOS = (0.125, 0.25, 0.5, 1.0, 2.0)  # of those steps, that are tried
REFERENCE_CELLS = 0.002  # and at most half of what was chosen
TIMES, LONG_ENOUGH = (2, 4), 0.5  # runs of each, at least and at most, the fastest counts; s in all, else


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
    result = _whole(wf.simulate(scene, machine.duration, accuracy=ACCURACY, progress=progress, **machine.options))
    whole = time.perf_counter() - begin
    steps = len(result.time) - 1
    exact = _reference(machine, result.scene, machine.finer * steps)
    tried = []
    for setting, other in itertools.product(_settings(machine, scene, result.scene), others(steps, machine.finer)):
        try:
            tried.append(_timed(machine, scene, setting, other, exact))
        except wf.InputError:  # a body without inertia terms
            continue
    chosen = _timed(machine, result.scene, {}, steps, exact)
    return Found(machine, chosen, int(result.history.counters["accuracy_runs"]), whole, tried)


def _settings(machine: Machine, scene: wf.Scene, chosen: wf.Scene) -> list[dict[str, Any]]:
    """What is tried besides steps: inertia level, stiffening, grid, and cells for the errors that the machine names and
    for the largest one that was `chosen`. What was chosen is kept where it is the least there is: more takes longer."""
    flexible = [body for body in scene.bodies if body.reduced is not None]
    used = [body for body in chosen.bodies if body.reduced is not None]
    choices: list[list[dict[str, Any]]] = []
    if flexible:
        levels = {"constant", *("full" for body in used if body.level != "constant")}
        choices.append([{"inertia": level} for level in sorted(levels)])
    if any(map(can_stiffen, flexible)):
        choices.append([{"stiffening": kept} for kept in sorted({False, *(body.stiffening for body in used)})])
    if scene.contacts:
        choices.append([{"grid": "body_fixed"}])
        if all(contact.without_patch() is None for contact in scene.contacts):
            errors = {*machine.cells, max(contact.cell_error for contact in chosen.contacts)}
            choices[-1] += [{"grid": "contact_fixed", "cell_error": error} for error in sorted(errors, reverse=True)]
    return [dict(itertools.chain.from_iterable(c.items() for c in chosen)) for chosen in itertools.product(*choices)]


def others(steps: int, finer: int) -> list[int]:
    """Numbers of steps near RATIOS times `steps` that divide those of the reference, `finer` times as many, so that
    times are common."""
    whole = finer * steps
    divisors = np.array([n for n in range(1, whole + 1) if whole % n == 0])
    return sorted({int(divisors[np.argmin(np.abs(np.log(divisors / (ratio * steps))))]) for ratio in RATIOS})


def _reference(machine: Machine, scene: wf.Scene, steps: int) -> wf.Result:
    setting: dict[str, Any] = {}
    flexible = [body.reduced for body in scene.bodies if body.reduced is not None]
    if flexible and all(body.inertia_terms is not None for body in flexible):
        setting["inertia"] = "full"
    if any(can_stiffen(body) for body in scene.bodies if body.reduced is not None):
        setting["stiffening"] = True
    if scene.contacts and all(contact.without_patch() is None for contact in scene.contacts):
        chosen = min(contact.cell_error for contact in scene.contacts)
        error = max(min(REFERENCE_CELLS, 0.5 * chosen), CELL_ERRORS[0])
        setting |= {"grid": "contact_fixed", "cell_error": machine.exact or error}
    return _run(machine, scene, setting, steps)


def _run(machine: Machine, scene: wf.Scene, setting: dict[str, Any], steps: int) -> wf.Result:
    with applied(scene, setting):
        result = wf.simulate(scene, machine.duration, step=machine.duration / steps, progress=False, **machine.options)
    return _whole(result)


def _whole(result: wf.Result) -> wf.Result:
    """The result of a run that nobody has interrupted."""
    if result.status == Status.INTERRUPTED:
        raise KeyboardInterrupt
    return result


def _timed(machine: Machine, scene: wf.Scene, setting: dict[str, Any], steps: int, exact: wf.Result) -> Tried:
    seconds, errors = [], {}
    while len(seconds) < TIMES[0] or (len(seconds) < TIMES[1] and sum(seconds) < LONG_ENOUGH):
        result = _run(machine, scene, setting, steps)
        seconds.append(float(result.history.counters["loop_seconds"]))
    if result.status == "completed":
        rows = np.arange(len(result.time))
        same = np.arange(len(result.time)) * ((len(exact.time) - 1) // steps)
        points = {body: np.asarray(places, dtype=float) for body, places in machine.points.items()}
        errors = errors_of(result, rows, exact, same, measures_of(scene, machine.measures), points)
    else:
        errors = {"force": float("inf")}
    return Tried(steps, setting, errors, min(seconds))


def _fewer(found: list[Found]) -> str:
    """Which references have fewer steps."""
    return "".join(f" (of {f.machine.title} {f.machine.finer})" for f in found if f.machine.finer != FINER)


def compute(*cases: str) -> list[Found]:
    """The named machines, or all, measured. Raises `InputError` for a name that does not exist."""
    for name in cases:
        if name not in MACHINES:
            raise unknown_name("study 'accuracy': machine", name, MACHINES)
    return [measure(MACHINES[name]) for name in cases or MACHINES]


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

`simulate(accuracy={ACCURACY:g})` compared with runs of the same machine with about
{", ".join(f"{r:g}" for r in RATIOS)} times its steps, on both contact grids where bodies are prepared for them, inertia
levels constant and full, and with and without stiffening where bodies have it. Errors are relative to a run with
{FINER} times the steps{_fewer(found)}, all inertia terms and finer cells where bodies can have them; wanted are 1 % of
forces, displacements and deformations and 2 % of pressures. Times are wall time of the loop over steps, the fastest of
{TIMES[0]} runs or as many more as {LONG_ENOUGH:g} s hold; the whole call has all runs that it took to choose, their
set-up and their budgets.

{table(head, rows)}"""
