"""The scene of every demo, stepped by a `Simulation`, has the numbers of `simulate`, bit for bit.

A demo runs, quick, as far as its first call of `simulate`, whose scene, start, step and options are taken. Demos
without motion are taken at their first call of `equilibrium` or `static`, and their scene is moved in short steps, from
the equilibrium and from the initial state. A `Simulation` that continues a run has its first state as a row. Runs with
small-sliding contacts are continued to round-off only, so that those scenes begin at their initial state.
"""

from __future__ import annotations

import inspect
from copy import copy
from dataclasses import fields, is_dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from demos import crown_sweep, friction_drive, tolerance_cloud
from same_histories import NOT_COMPARED, steps_alone, unlike

DEMOS = sorted(p.stem for p in Path(inspect.getfile(crown_sweep)).parent.glob("*.py") if p.stem != "__init__")
STEPS = 30
SHORT = 1e-5  # s, of demos that have no time step
GIVEN = {  # a row of those that are swept in other processes, and what is stepped by itself
    "crown_sweep": lambda: crown_sweep.build(1 / 8, 4000.0, 1e-3),
    "tolerance_cloud": lambda: tolerance_cloud.build(2e-5, 5e-6, 5e-4),
    "friction_drive": lambda: friction_drive.build(friction_drive.QUICK),
}


class Reached(BaseException):
    """A demo has come to its run, with these arguments of `simulate`."""

    def __init__(self, scene: wf.Scene, step: float, **options: Any) -> None:
        self.scene, self.step = scene, step
        self.options = {name: options[name] for name in ("start", "options") if name in options}


def reached(name: str, folder: Path, patch: pytest.MonkeyPatch) -> Reached:
    """The run of a demo."""
    if name in GIVEN:
        return Reached(GIVEN[name](), SHORT, start="equilibrium")
    demo = import_module(f"demos.{name}")

    def simulate(scene: wf.Scene, duration: float, *, step: float, **options: Any) -> wf.Result:
        raise Reached(scene, step, **options)

    def equilibrium(scene: wf.Scene, **_: Any) -> wf.Result:
        raise Reached(scene, SHORT, start="equilibrium")

    def static(scene: wf.Scene, *_: Any, **__: Any) -> wf.Result:
        raise Reached(scene, SHORT)

    patch.setattr(wf, "simulate", simulate)
    if "wf.simulate(" not in inspect.getsource(demo):
        patch.setattr(wf, "static", static)
        patch.setattr(wf, "equilibrium", equilibrium)
    with pytest.raises(Reached) as found:
        demo.main(folder, quick=True, progress=False)
    patch.undo()
    return found.value


def without_first_row(part: Any, rows: int) -> Any:
    """A history of so many rows, or a part of one, without the first."""
    if isinstance(part, np.ndarray):
        return part[1:] if part.shape[:1] == (rows,) else part
    if isinstance(part, dict):
        return {name: without_first_row(value, rows) for name, value in part.items()}
    if not is_dataclass(part):
        return part
    found = copy(part)
    for field in fields(part):
        if field.name not in (*NOT_COMPARED, "checkpoint"):
            object.__setattr__(found, field.name, without_first_row(getattr(part, field.name), rows))
    return found


@pytest.mark.slow
@pytest.mark.parametrize("name", DEMOS)
def test_demo_is_stepped_as_simulated(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = reached(name, tmp_path, monkeypatch)
    if run.scene.small_sliding:
        run.options.pop("start", None)
    whole = wf.simulate(run.scene, STEPS * run.step, step=run.step, progress=False, **run.options)
    assert whole.status == wf.Status.COMPLETED, whole.message
    sim = wf.Simulation(run.scene, step=run.step, **run.options)
    for _ in range(STEPS):
        sim.step()
    found, wanted = steps_alone(sim.result().history), steps_alone(whole.history)
    if isinstance(run.options.get("start"), wf.Result):
        found = without_first_row(found, STEPS + 1)
        found.notes = wanted.notes  # some are of the largest value of all rows
    assert sim.status == wf.Status.COMPLETED
    assert unlike(found, wanted) == []
