"""The start of a run: velocities that satisfy joints and drives, then accelerations and multipliers.

Two very small steps on the device come first (`warpffrf_kernels.bodies.motion`: PROJECT makes the velocities consistent
in the mass metric, START finds accelerations, multipliers, and the pressures of closed contacts). They are a fraction
of the user's step, so that the effect of contact is negligible compared with that in a step. Both divide displacements
by their size, so that round-off of the positions appears as errors of the accelerations; `accelerations` then removes
them, with the joints' equations differentiated instead, and opens the ledger with the energies of the resulting state.

From the last equilibrium of a static run (`start_from_loads`) a run begins at rest, at the time of this equilibrium.
Tractions of surfaces with friction would be lost in the small steps, which exclude friction; so where there are any
and no drive moves there, the accelerations are zero, as in an equilibrium whose loads continue without a jump.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.joints import Drive
from warpffrf.online.engine import Engine
from warpffrf.online.start.accelerations import refine
from warpffrf_kernels.core import control as k

# number of halvings of the first step where there is friction: it acts only after the elastic slip, from the end of a
# first step on, and motion at the start would continue for half a step without it
RUB_IN = 6
STEP = 1e-3  # s/m: 0.1 ms for a scene of 0.1 m, where no step is given
VELOCITY_CHANGE = 1e-5  # of the largest velocity and 1 m/s: accuracy of input with six digits


def start_consistently(engine: Engine, step: float | None = None) -> None:
    """Bring the state of `engine` to consistent velocities, accelerations and multipliers at the present positions, and
    open the ledger, for steps of `step` [s], None where none follow. Changed velocities are noted in
    `engine.start_notes`; a step that fails is left in its status.
    """
    step = STEP * float(engine.compiled.model.length) if step is None else step
    given = {name: getattr(engine.state, name).numpy().copy() for name in ("v", "omega", "qd")}
    for mode in (k.PROJECT, k.START):
        engine.enter(mode, engine.settings.start_fraction * step)
        engine.replay(1)
    if np.any(engine.word("status")):
        return
    if not refine(engine, given) and engine.compiled.slips.laws:
        engine.control(restart=1)  # friction is found with the first step
    for name, unit, least in (("v", "m/s", 1.0), ("omega", "rad/s", 1.0 / engine.compiled.model.length)):
        change = np.linalg.norm(getattr(engine.state, name).numpy() - given[name], axis=-1)
        for i, body in enumerate(engine.scene.bodies):
            if change[:, i].max() > VELOCITY_CHANGE * (least + np.abs(given[name]).max()):
                engine.start_notes.append(
                    f"body {body.name!r}: its initial velocity did not agree with joints and drives and was "
                    f"changed by {change[:, i].max():.3g} {unit}"
                )


def start_from_loads(engine: Engine, step: float) -> None:
    """Bring `engine`, restored from the end of a static run, to the beginning of steps in time of `step` [s], at rest
    except for the motion of drives. A step that fails is left in its status.
    """
    engine.clock(start_time=engine.word("time"))
    t = float(engine.word("time")[0])
    moving = any(_speed(drive, t) != 0.0 for drive in engine.scene.drives)
    rubs = engine.compiled.model.capacity.cells > 0
    if not rubs or moving:
        engine.control(restart=0)
        start_consistently(engine, step)
        if rubs:
            engine.start_notes.append(
                "tractions of contact friction that the static run has left begin anew with the drives' velocities; "
                "let the drives begin to move from rest"
            )
    if not np.any(engine.word("status")):
        engine.enter(k.DYNAMIC, step, target=0)
        engine.control(proximal_level=0, energy_bounded=0, reason=0)
        if rubs or any(c.friction.acts for c in engine.scene.lumped_contacts):
            engine.control(level=min(RUB_IN, engine.settings.max_level))


def _speed(drive: Drive, t: float) -> float:
    """Prescribed velocity [m/s or rad/s] at the time t [s]."""
    breaks, c = drive.position().polynomial()
    if t < breaks[0]:
        return 0.0
    piece = int(np.clip(np.searchsorted(breaks, t, side="right") - 1, 0, len(c) - 1))
    return float(np.polynomial.Polynomial(c[piece]).deriv()(t - breaks[piece]))
