"""A small-sliding contact of two blocks, one on the other, whose upper one is pressed down and pushed to and fro: its
scene and run."""

from __future__ import annotations

from typing import Any

import numpy as np

import warpffrf as wf
from warpffrf import forces, joints, mesh, sensors, signals
from warpffrf.output.result import Result

FRICTION, PRESSED, PUSHED = 0.3, 2000.0, 550.0  # -, N, N: near sliding as a whole
STEPS, CYCLES, PERIOD = 40, 2, 1.0  # of a cycle, -, s
SIZE = (0.06, 0.02, 0.02)  # m, of each block
CELLS = (8, 3)  # along x and y


def block(name: str, fixed: str, face: str, cells: tuple[int, int] = CELLS) -> Any:
    """A steel block with the small-sliding contact `face`."""
    steel = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7800.0)
    box = mesh.box(SIZE, (*cells, 2), order=1, name=name)
    return wf.reduce(
        box,
        steel,
        interfaces={fixed: "rigid"},
        contact={"face": wf.surfaces.Matched(first=face)},
        max_frequency=6e4,
        cache=False,
        progress=False,
    )


def scene() -> wf.Scene:
    """The lower block stands on the ground; a force presses the upper one, and pushes it along x."""
    found = wf.Scene(gravity=(0.0, 0.0, 0.0))
    base = found.add_body(block("base", "z_min", "z_max"), name="base", position=(0.0, 0.0, 0.01))
    top = found.add_body(block("top", "z_max", "z_min"), name="top", position=(0.0, 0.0, 0.03))
    found.add(joints.Fixed(found.ground, base["z_min"], name="foot"))
    found.add(wf.Contact(top["face"], base["face"], sliding="small", friction=FRICTION, name="lap"))
    time = np.linspace(0.0, CYCLES * PERIOD, STEPS * CYCLES + 1)
    push = signals.Table(time, PUSHED * np.sin(2.0 * np.pi * time / PERIOD))
    found.add(forces.PointForce(top["z_max"], (push, 0.0, -PRESSED), name="push"))
    found.add(sensors.Position(top["z_max"], name="tip"))
    return found


def static_run() -> Result:
    """Load steps through the cycles."""
    return wf.simulate(scene(), CYCLES * PERIOD, step=PERIOD / STEPS, kind="static", progress=False)
