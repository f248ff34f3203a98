"""Errors that a run states compared with true ones, of its step and of the figures of its report.

Machines of every kind of motion, free, driven and damped, in contact and in impact, each with a coarse and a fine step.
True errors are those against a run with a step `FINER` times smaller, whose own is 1/256 of them; both are root mean
squares over the run, over the size of the quantity (`warpffrf.output.budget.quantities`). Figures:
`studies.accuracy.figure_errors`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from studies.accuracy.figure_errors import FACTOR, SCENES, Stated
from studies.accuracy.figure_errors import rows as rows_of_figures
from studies.contact import colliding_bars as bars
from studies.speed.step_time import swinging_pair, tread_body
from warpffrf.model import joints, signals
from warpffrf.model.forces import JointSpringDamper, PointForce
from warpffrf.model.scene import Scene
from warpffrf.output.budget.budget import FLOOR
from warpffrf.output.budget.quantities import quantities
from warpffrf.output.budget.time_step import SOURCE
from warpffrf.output.options import RunOptions
from warpffrf.output.simulate import simulate
from warpffrf.study.markdown import table

FINER = 16
ROUND_OFF = 1e-9  # errors below it are those of numbers, not of steps


@dataclass(frozen=True)
class Compared:
    """One quantity of one run: errors as fractions of its size."""

    machine: str
    step: float
    steps: int
    quantity: str
    true: float
    stated: float

    @property
    def ratio(self) -> float:
        """Stated over true."""
        return self.stated / self.true


def pendulum() -> Scene:
    """A pendulum let go at the side."""
    scene = Scene(gravity=(0, 0, -9.81))
    bob = scene.add_rigid_body(2.0, (0.01, 0.01, 0.01), name="bob", position=(0.5, 0.0, 0.0))
    scene.add(joints.Revolute(scene.ground, bob.at((-0.5, 0.0, 0.0)), axis=(0, 1, 0)))
    return scene


def driven_mass() -> Scene:
    """A damped mass on a spring under a force of half its frequency."""
    scene = Scene()
    bob = scene.add_rigid_body(1.0, (0.01, 0.01, 0.01), name="bob")
    guide = scene.add(joints.Prismatic(scene.ground, bob.at((0, 0, 0)), axis=(1, 0, 0)))
    scene.add(JointSpringDamper(guide, 400.0, 4.0))
    t = np.linspace(0.0, 5.0, 1001)
    scene.add(PointForce(bob.at((0, 0, 0)), (signals.Table(t, 100.0 * np.sin(10.0 * t), cubic=True), (1, 0, 0))))
    return scene


def colliding_bars() -> Scene:
    """Two bars with 20 modes, one of which runs into the other."""
    return bars.meeting(bars.bar(20))


def swinging_rollers() -> Scene:
    """Two elastic rollers that swing to and fro on each other at a constant approach, pressed together at once."""
    return swinging_pair(tread_body(None, sectors=480, layers=7, axial=3, modes=6), 30e-6, 0.3, 20.0, 0.1)


BARS = 1.15 * bars.EXACT.duration  # s, with the bars apart again
MACHINES: dict[str, tuple[Callable[[], Scene], float, tuple[int, int], str]] = {  # scene, s, steps, start
    "pendulum": (pendulum, 4.0, (400, 10000), "initial"),
    "driven mass": (driven_mass, 4.0, (400, 10000), "initial"),
    "colliding bars": (colliding_bars, BARS, (600, 2400), "initial"),
    "rollers at rest first": (swinging_rollers, 0.1, (200, 1000), "equilibrium"),
    "rollers pressed at once": (swinging_rollers, 0.1, (200, 1000), "initial"),
}


def compare(machine: str) -> list[Compared]:
    """All quantities of the runs of a machine whose error is more than round-off."""
    build, duration, counts, start = MACHINES[machine]
    scene, found = build(), []
    for steps in counts:
        step = duration / steps
        result = simulate(scene, duration, step=step, start=start, progress=False)
        exact = simulate(
            scene, duration, step=step / FINER, start=start, options=RunOptions(save_every=FINER), progress=False
        )
        own, other = quantities(result.history), quantities(exact.history)
        for line in result.error_budget():
            if line.source != SOURCE or line.of not in own:
                continue
            true = float(np.sqrt(np.mean(own[line.of].apart(other[line.of].values) ** 2))) / own[line.of].size
            if true > ROUND_OFF:
                found.append(Compared(machine, step, steps, line.of, true, line.size))
    return found


def compute() -> tuple[list[Compared], list[Stated]]:
    """Errors of the step of all machines, and of the figures of all scenes."""
    found = [row for machine in MACHINES for row in compare(machine)]
    return found, [stated for scene in SCENES.values() for stated in scene()]


def page(figures: tuple[list[Compared], list[Stated]]) -> str:
    """Stated against true errors."""
    found, stated = figures
    rows = [
        [r.machine, f"{r.step:.2g}", str(r.steps), r.quantity, f"{r.true:.1e}", f"{r.stated:.1e}", f"{r.ratio:.2f}"]
        for r in found
    ]
    ratios = [r.ratio for r in found]
    within = sum(1.0 / 3.0 <= ratio <= 3.0 for ratio in ratios)
    head = ["machine", "step [s]", "steps", "quantity", "true", "stated", "stated / true"]
    return f"""# Errors that runs state of their step

Root mean square errors over the size of the quantity, compared with a run with a step {FINER} times smaller, and as the
error budget of the run itself states them: by the whole run once more with twice the step, of runs of more than 4,000
steps by six windows of a hundredth, and by the beginning and the busiest part with a quarter of the step. {within} of
{len(found)} are right within a factor of 3; ratios are {min(ratios):.2f} to {max(ratios):.2f}.

Vibrations that the step is too long for are damped by the integrator in the first steps, of the run and of the one
with twice the step alike. They are seen where the quarter of the step resolves them, at the start and where
accelerations change most; the report states from which frequency on they may be missed elsewhere.

{table(head, rows)}
{figures_section(stated)}"""


def figures_section(found: list[Stated]) -> str:
    """What reports state of their figures."""
    known = [s for s in found if np.isfinite(s.stated)]
    right, told = sum(s.right for s in known), sum(s.told for s in found)
    scenes = len({s.scene for s in found})
    head = ["scene", "figure", "true [%]", "stated [%]", "largest source", "right"]
    return f"""## Figures of reports

{scenes} scenes on coarse meshes, cells, grids and films compared with the same ones on fine ones. {right} of
{len(known)} figures are right within a factor of {FACTOR:g}, or are below {FLOOR:.1%} and stated to be below
{FACTOR * FLOOR:.1%}. Of {told} the report states that they are not estimated and why; {len(found) - len(known) - told}
are silent.

{table(head, rows_of_figures(found))}"""
