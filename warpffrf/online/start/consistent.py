"""The start of a run: velocities that agree with joints and drives, then accelerations and multipliers.

Two tiny steps on the device come first (`warpffrf_kernels.bodies.motion`: PROJECT makes the velocities consistent in
the mass metric, START finds accelerations, multipliers, and the pressures of what touches). They are a fraction of the
user's step, so that contact does next to nothing in them of what it does in a step. Both divide displacements by their
size, so that round-off of the positions returns as errors of the accelerations; `accelerations` then takes those out,
with the joints' equations differentiated instead, and opens the ledger with the energies of the state that it leaves.
"""

from __future__ import annotations

import numpy as np
from warpffrf_kernels.core import control as k

from warpffrf.online.engine import Engine
from warpffrf.online.start.accelerations import refine

STEP = 1e-3  # s/m: 0.1 ms for a scene of 0.1 m, where no step is given
VELOCITY_CHANGE = 1e-5  # of the largest velocity and 1 m/s: what is typed with six digits


def start_consistently(engine: Engine, step: float | None = None) -> None:
    """Bring the state of `engine` to consistent velocities, accelerations and multipliers at the present positions, and
    open the ledger, for steps of `step` [s], None where none follow. Velocities that had to change are noted in
    `engine.start_notes`; a step that fails is left in its status."""
    step = STEP * float(engine.compiled.model.length) if step is None else step
    given = {name: getattr(engine.state, name).numpy().copy() for name in ("v", "omega", "qd")}
    for mode in (k.PROJECT, k.START):
        engine.enter(mode, engine.settings.start_fraction * step)
        engine.replay(1)
    if np.any(engine.word("status")):
        return
    if not refine(engine, given) and engine.compiled.slips.laws:
        engine.control(forget=1)  # friction is found with the first step
    for name, unit, least in (("v", "m/s", 1.0), ("omega", "rad/s", 1.0 / engine.compiled.model.length)):
        change = np.linalg.norm(getattr(engine.state, name).numpy() - given[name], axis=-1)
        for i, body in enumerate(engine.scene.bodies):
            if change[:, i].max() > VELOCITY_CHANGE * (least + np.abs(given[name]).max()):
                engine.start_notes.append(
                    f"body {body.name!r}: its initial velocity did not agree with joints and drives and was "
                    f"changed by {change[:, i].max():.3g} {unit}"
                )
