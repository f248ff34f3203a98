"""The start of a run: velocities that agree with joints and drives, then accelerations and multipliers.

Two tiny steps on the device come first (`warpffrf_kernels.motion`: PROJECT makes the velocities consistent in the mass
metric, START finds accelerations, multipliers, and the pressures of what touches). Both divide displacements by their
size, so that round-off of the positions returns as errors of the accelerations; `accelerations` then takes those out,
with the joints' equations differentiated instead.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from warpffrf_kernels import control as k

from warpffrf.online.accelerations import refine

VELOCITY_CHANGE = 1e-5  # m/s, rad/s: far above what a step of 1e-7 s changes under any bearable load


def start(engine: Any) -> list[str]:
    """Bring the state of `engine` to consistent velocities, accelerations and multipliers at the present positions, and
    open the ledger; returns notes on velocities that had to change. A step that fails is left in its STATUS."""
    given = {name: getattr(engine.state, name).numpy().copy() for name in ("v", "omega", "qd")}
    for mode in (k.PROJECT, k.START):
        engine.enter(mode, engine.settings.start_step)
        engine.replay(1)
    if np.any(engine.word("STATUS")):
        return []
    refine(engine, given)
    notes = []
    for name, unit in (("v", "m/s"), ("omega", "rad/s")):
        change = np.linalg.norm(getattr(engine.state, name).numpy() - given[name], axis=-1)
        for i, body in enumerate(engine.scene.bodies):
            if change[:, i].max() > VELOCITY_CHANGE * (1.0 + np.abs(given[name]).max()):
                notes.append(
                    f"body {body.name!r}: its initial velocity did not agree with joints and drives and was "
                    f"changed by {change[:, i].max():.3g} {unit}"
                )
    return notes
