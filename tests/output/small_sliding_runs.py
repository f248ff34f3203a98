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


def blocks() -> wf.Scene:
    """The lower block stands on the ground, the upper one lies on it."""
    found = wf.Scene(gravity=(0.0, 0.0, 0.0))
    base = found.add_body(block("base", "z_min", "z_max"), name="base", position=(0.0, 0.0, 0.01))
    top = found.add_body(block("top", "z_max", "z_min"), name="top", position=(0.0, 0.0, 0.03))
    found.add(joints.Fixed(found.ground, base["z_min"], name="foot"))
    found.add(wf.Contact(top["face"], base["face"], sliding="small", friction=FRICTION, name="lap"))
    return found


def scene() -> wf.Scene:
    """A force presses the upper block, and pushes it along x."""
    found = blocks()
    top = found.bodies[1]
    time = np.linspace(0.0, CYCLES * PERIOD, STEPS * CYCLES + 1)
    push = signals.Table(time, PUSHED * np.sin(2.0 * np.pi * time / PERIOD))
    found.add(forces.PointForce(top["z_max"], (push, 0.0, -PRESSED), name="push"))
    found.add(sensors.Position(top["z_max"], name="tip"))
    return found


def static_run() -> Result:
    """Load steps through the cycles."""
    return wf.static(scene(), CYCLES * PERIOD, step=PERIOD / STEPS, progress=False)


def pulled(force: float | None = None, travel: float = 40e-6) -> Result:
    """Load steps of 1/40 s for 1 s: the upper block is pressed, and pulled along x by a force that grows to `force`
    [N], or by a rope whose end moves by `travel` [m]."""
    found = blocks()
    top = found.bodies[1]
    grows = 0.0 if force is None else signals.Ramp(0.0, force, duration=1.0)
    found.add(forces.PointForce(top["z_max"], (grows, 0.0, -PRESSED), name="push"))
    if force is None:
        cart = found.add_rigid_body(1.0, (1e-3,) * 3, name="cart", position=(SIZE[0], 0.0, 2.0 * SIZE[2]))
        rail = found.add(joints.Prismatic(found.ground, cart, axis=(1, 0, 0), name="rail"))
        found.add(joints.Drive(rail, signals.Ramp(0.0, travel, duration=1.0), quantity="position"))
        found.add(forces.SpringDamper(top["z_max"], cart.at((0, 0, 0)), 5e7, name="rope"))
    return wf.static(found, 1.0, step=1.0 / 40, progress=False)
