"""What a run to a wanted accuracy begins with: few steps, which still see what the scene says of its time."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from warpffrf.model.checks.signal_cover import quickest_rise
from warpffrf.model.contact import CELL_ERROR as USUAL_CELL_ERROR
from warpffrf.model.contact import CELL_ERRORS
from warpffrf.model.scene import Scene
from warpffrf.online.compile.inertia_plan import InertiaPlan, fastest_turning
from warpffrf.output.accuracy.limits import Limits
from warpffrf.output.accuracy.setting import AUTO, CELL_ERROR, GRID, INERTIA, Setting

FEWEST = 64  # steps: below, twice the step says little
A_RISE = 4  # steps in the quickest rise of a signal: a load that begins and ends between two steps is not seen
TURN = 0.5  # rad in a step, of what is driven or turns at the start
MOST = 4000  # steps of the first run, whatever signals say: the error of the step is measured then


def first_setting(
    scene: Scene, begin: float, duration: float, longest: float | None, local: Any, limits: Limits
) -> Setting:
    """Of a run from `begin` [s] on, with what the scene itself would take. longest: step [s] that the user allows, None
    for any."""
    steps = math.ceil(min(max(FEWEST, steps_to_see(scene, begin, duration)), MOST))
    if longest is not None:
        steps = max(steps, math.ceil(duration / longest * (1.0 - 1e-9)))
    options: dict[tuple[str, str], Any] = {}
    for body, plan in zip(scene.bodies, InertiaPlan.of(scene).bodies, strict=True):
        if body.level == AUTO and body.reduced is not None:
            options[INERTIA, body.name] = plan.level
    for contact in scene.contacts:
        if contact.grid == AUTO:
            options[GRID, contact.name] = AUTO
        if contact.cells is None and contact.cell_error == USUAL_CELL_ERROR and contact.without_patch() is None:
            options[CELL_ERROR, contact.name] = float(np.clip(limits.force, *CELL_ERRORS))
    return Setting(steps + steps % 2, local, options)


def steps_to_see(scene: Scene, begin: float, duration: float) -> float:
    """Steps of a run from `begin` [s] on that see what signals do, and what the scene states of its turning."""
    rise = quickest_rise(scene, begin, begin + duration)
    return duration * max(A_RISE / rise, fastest_turning(scene) / TURN)
