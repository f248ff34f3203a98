"""Groups of bodies that nothing leads to the ground from: what acts on one from outside either balances, and it stays
where it is, or it has no equilibrium.

What bodies of a group do to one another has no resultant, so that of all forces is that of loads and weights. A force
that does not balance never will; a torque may, as the group turns.
"""

from __future__ import annotations

import numpy as np

from warpffrf.online.engine import Engine

Array = np.ndarray


def lines_of(engine: Engine, world: int, group: list[int]) -> Array:
    """The six rigid motions (6, 6 bodies) of a group, displacement in world, turn in body axes: unit displacements, and
    unit turns about its centre of mass."""
    r, axes = (np.asarray(a.numpy()[world]) for a in (engine.scratch.r1, engine.scratch.axes))
    mass = engine.compiled.model.bodies.mass.numpy()[group]
    centre = mass @ r[group] / mass.sum()
    lines = np.zeros((6, len(engine.scene.bodies), 6))
    for b in group:
        lines[:3, b, :3] = np.eye(3)
        lines[3:, b, :3] = np.cross(np.eye(3), r[b] - centre)
        lines[3:, b, 3:] = axes[b]
    return lines.reshape(6, -1)


def told_of(engine: Engine, group: list[int]) -> str:
    """The bodies of a group, as the beginning of a sentence on their loads."""
    names = ", ".join(repr(engine.scene.bodies[b].name) for b in group)
    return f"nothing leads to the ground from {names}, whose loads"
