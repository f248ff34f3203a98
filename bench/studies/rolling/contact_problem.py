"""The contact problem: convergence of the iterations of a step, and the time of a step by the number of cells.

Two rollers roll on each other (`driven_pair`) on 4 mm hexahedra and more and more cells. *Convergence*: after some
crossings of the patch, the largest residual after each iteration of a step, of its scale (`step.balance`), median of
LAST steps. *Time*: one run of STEPS steps, in U of the same run.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from studies.charts import save_curves
from studies.rolling.driven_pair import FRICTION, STEEL, Rollers, body, scene
from warpffrf.online import run
from warpffrf.online.checkpoint import restore
from warpffrf.online.engine import Engine
from warpffrf.study.machine import unit_seconds
from warpffrf.study.markdown import table

MESH: dict[str, Any] = {"sectors": 78, "layers": 8, "axial": 5, "order": 1}
PAIR = Rollers("patch", 0.02, 0.4e-3, MESH, (13, 10), 10)
SETTLING, LAST = 30, 10  # steps before those that are looked at, and their number
STIFFER = 10.0  # modulus of the other roller of the unlike pair over that of steel
CONVERGENCE = {  # cells, steps of a crossing, friction, saturation, unlike
    "13 x 10 cells, no friction": ((13, 10), 10, 0.0, 0.5, False),
    "13 x 10 cells, stick and slip": ((13, 10), 10, FRICTION, 0.5, False),
    "26 x 20 cells, stick and slip": ((26, 20), 20, FRICTION, 0.5, False),
    "26 x 20 cells, sliding": ((26, 20), 20, FRICTION, 3.0, False),
    "26 x 20 cells, unlike bodies": ((26, 20), 20, FRICTION, 0.5, True),
    "40 x 30 cells, stick and slip": ((40, 30), 20, FRICTION, 0.5, False),
}
CELLS = ((10, 10), (15, 15), (22, 22), (32, 32), (46, 46), (68, 68), (100, 100))  # strips, rows
STEPS = 6
CROSSING = 20  # steps of a crossing in the table of times


@dataclass(frozen=True)
class Time:
    """A row of the table of times: cells of the patch, active ones, seconds per step, in U, iterations."""

    cells: int
    active: int
    seconds: float
    units: float
    iterations: float
    systems: float


def residuals(machine: wf.Scene, step: float) -> tuple[np.ndarray, float]:
    """Median residual after each iteration of the last steps, until half of them have ended, and systems of a step."""
    begun = run(machine, SETTLING * step, step=step, start="equilibrium", progress=False)
    if begun.status != "completed":
        raise RuntimeError(begun.message)
    engine = Engine(machine)
    done = restore(engine, begun.checkpoint, step)
    engine.control(every=1)
    found = []
    for n in range(1, LAST + 1):
        engine.control(target=done + n)
        engine.replay(1)
        own = engine.scratch.residual_history.numpy()[0].copy()
        own[int(engine.word("iteration")[0]) + 1 :] = np.nan
        found.append(own[1:])
    rows = np.array(found)
    kept = int((np.isfinite(rows).sum(axis=0) >= LAST / 2).sum())
    again = run(machine, LAST * step, step=step, start=begun, progress=False)
    return np.nanmedian(rows[:, :kept], axis=0), float(again.factorisations[1:].mean())


def timed(roller: wf.ReducedBody, cells: tuple[int, int], friction: float) -> Time:
    """Step time on a number of cells."""
    pair = replace(PAIR, cells=cells, steps=CROSSING)
    machine = scene(pair, roller, friction, 0.5)
    start = run(machine, 4 * pair.step, step=pair.step, start="equilibrium", progress=False)
    history = run(machine, STEPS * pair.step, step=pair.step, start=start, progress=False)
    if history.status != "completed":
        raise RuntimeError(history.message)
    seconds = history.counters["seconds_in_graph"] / STEPS
    return Time(
        cells[0] * cells[1], int(history.contacts["pair"].active_nodes[-1]), seconds, seconds / unit_seconds(),
        float(history.iterations[1:].mean()), float(history.factorisations[1:].mean()),
    )  # fmt: skip


def exponent(times: list[Time]) -> float:
    """Of the step time against the active cells, between the first and the last row."""
    return float(np.log(times[-1].seconds / times[0].seconds) / np.log(times[-1].active / times[0].active))


def compute() -> dict[str, Any]:
    """Residuals of all cases, and times without and with friction."""
    roller = body(PAIR)
    other = body(PAIR, replace(STEEL, youngs_modulus=STIFFER * STEEL.youngs_modulus))
    found = {}
    for name, (cells, steps, friction, saturation, unlike) in CONVERGENCE.items():
        pair = replace(PAIR, cells=cells, steps=steps)
        found[name] = residuals(scene(pair, roller, friction, saturation, other if unlike else None), pair.step)
    times = {mu: [timed(roller, cells, mu) for cells in CELLS] for mu in (0.0, FRICTION)}
    return {"residuals": found, "times": times}


def page(figures: dict[str, Any]) -> str:
    """The page."""
    most = max(len(residual) for residual, _ in figures["residuals"].values())
    rows = [
        [name, *(f"{r:.0e}" for r in residual), *[""] * (most - len(residual)), f"{systems:.1f}"]
        for name, (residual, systems) in figures["residuals"].items()
    ]
    head = ["patch", *(str(i + 1) for i in range(most)), "systems"]
    parts = []
    for mu, times in figures["times"].items():
        lines = [
            [str(t.cells), str(t.active), f"{1e3 * t.seconds:.3g}", f"{t.units:.3g}", f"{t.iterations:.1f}",
             f"{t.systems:.1f}"] for t in times
        ]  # fmt: skip
        title = "Without friction"
        if mu > 0.0:
            title = f"With friction, mu = {mu:g}, at half of the creepage of gross sliding"
        columns = ["cells", "active", "ms", "U", "iterations", "systems"]
        parts.append(f"{title}: exponent {exponent(times):.2f}.\n\n{table(columns, lines)}")
    return f"""# The contact problem: convergence, and step time by the number of cells

The algorithm is in [section 19 of the method](../method/19_contact_problem.md).

## Convergence

Largest residual of a step after each iteration, as a fraction of its scale (forces of the largest force, gaps of the
penetration, tractions of the largest bound), median of {LAST} steps; the step ends below 1e-9. *systems*: linear ones
for tractions of a step, or for pressures where there are none.

{table(head, rows)}
![Residuals](contact_problem.png)

An iteration leaves what its matrices omit: bounds that follow the pressures once, terms of unlike
bodies, and what its systems were not solved for (a thousandth of the defect).

## Step time

Patches of equal cells on the same bodies, {STEPS} steps after the start, one run.

{chr(10).join(parts)}"""


def picture(figures: dict[str, Any], path: Path) -> Path:
    """Residuals by iteration."""
    curves = {name: (np.arange(1, len(r) + 1), r) for name, (r, _) in figures["residuals"].items()}
    return save_curves(
        curves, path, labels=("iteration", "largest residual of its scale"), title="Convergence of a step", log_y=True
    )
