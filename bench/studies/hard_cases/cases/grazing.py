r"""A roller dips into a plate by 10 um and out, a thousand times: its patch grows from nothing and vanishes.

Its displacement is prescribed, whole periods of 1 - cos by a cubic table, slow compared with its modes: the force is
that of the static state at the same depth, found by static solves.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from scenes.rollers import roller_body
from studies.hard_cases.case import Case, Finding
from warpffrf.model import joints, signals, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.online import find_equilibrium
from warpffrf.output.result import Result

PERIOD, DIPS, DEPTH, ABOVE = 0.02, 1000, 12e-6, 2e-6  # s, m: from 2 um above the plate to 10 um below
STATES = 61  # static ones


@lru_cache
def _body() -> ReducedBody:
    return roller_body(720, layers=6, axial=2, grading=1.6, order=1, modes=4)


def _scene(way: Any) -> Scene:
    """The roller on a driven guide, ABOVE a plate at 0."""
    scene = Scene()
    roller = scene.add_body(_body(), name="roller", position=(0.0, 0.0, 0.06))
    plate = scene.ground.surface(surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="plate")
    contact = scene.add(Contact(roller["rim"], plate, name="pair"))
    scene.close_gap(contact, along=(0.0, 0.0, -1.0), gap=ABOVE)
    guide = scene.add(joints.Prismatic(scene.ground, roller["bore"], axis=(0, 0, 1), name="guide"))
    scene.add(joints.Drive(guide, way, quantity="position"))
    return scene


def build() -> Scene:
    """A thousand dips by a cubic spline, eight knots a period."""
    t = np.arange(8 * DIPS + 1) * PERIOD / 8.0
    way = -0.5 * DEPTH * (1.0 - np.cos(2.0 * np.pi * t / PERIOD))  # without slope at its ends, as the spline
    return _scene(signals.Table(t, way, cubic=True, hold=True))


@lru_cache
def _static() -> tuple[np.ndarray, np.ndarray]:
    """Depths (STATES,) [m] and forces [N]."""
    depths = np.linspace(0.0, DEPTH - ABOVE, STATES)
    found = [find_equilibrium(_scene(-ABOVE - depth)).contacts["pair"].force[-1, 2] for depth in depths]
    return depths, np.array(found)


def check(result: Result) -> list[Finding]:
    """The force at every saved step against the static one at its depth, over the largest."""
    depths, forces = _static()
    force, depth = result.history.contacts["pair"].force[:, 2], -result.joint("guide").named("translation") - ABOVE
    wanted = np.interp(depth, depths, forces, left=0.0)
    return [Finding("force at the depth", float(np.abs(force - wanted).max() / forces.max()), 1e-2, 5e-2)]


CASE = Case(
    "grazing contact",
    "A roller dips into a plate by 10 um and leaves it, a thousand times: a patch that vanishes and comes back.",
    build, DIPS * PERIOD, check, steps=(1e-6, 1e-5, 1e-4), most_steps=200_000, tolerances=(), errors=(),
    accuracies=(), rows=20_000,
)  # fmt: skip
LONG_STEPS = Case(
    "grazing, long steps",
    "The same, fifty times, by steps of a twentieth of a dip and of half of one.",
    build, 50 * PERIOD, check, steps=(1e-3, 1e-2), middle=1e-3,
)  # fmt: skip
