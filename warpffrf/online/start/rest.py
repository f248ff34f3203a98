"""What is left of the forces after a proximal step of an equilibrium: whether a scene that still moves is at rest.

A proximal step of size tau balances `m d/tau^2 = F` and `J psi/tau^2 = M` for every body, `d` and `psi` its
displacement and rotation in the step: these inertia forces are what the static forces leave over. A body that nothing
holds in one direction, a roller free to turn on its axle, goes on moving under what the grids leave of a torque that is
zero, some 1e-12 of the load, and never comes to rest. Its forces balance all the same.
"""

from __future__ import annotations

import numpy as np

from warpffrf.online.diagnosis.failure_report import largest_force
from warpffrf.online.engine import Engine

ROUND_OFF = 1e-14  # of the largest force


def left_over(engine: Engine, world: int) -> tuple[float, str]:
    """The largest force left over by the last proximal step, as a fraction of the largest force in play, a torque over
    the radius of gyration; and a clause that says what creeps under it."""
    m, scratch, bodies = engine.compiled.model, engine.scratch, engine.scene.bodies
    if not bodies:
        return 0.0, ""
    mass, inertia = m.bodies.mass.numpy()[: len(bodies)], m.bodies.inertia.numpy()[: len(bodies)]
    rate, turn = (np.asarray(a.numpy()[world][: len(bodies)]) for a in (scratch.v1_rate, scratch.omega1_rate))
    force = mass * np.linalg.norm(rate, axis=1)
    torque = np.linalg.norm(np.einsum("bij,bj->bi", inertia, turn), axis=1)
    gyration = np.sqrt(np.trace(inertia, axis1=1, axis2=2) / (3.0 * mass))
    both = np.maximum(force, torque / gyration)
    b = int(np.argmax(both))
    what = f"{force[b]:.2g} N" if force[b] * gyration[b] >= torque[b] else f"{torque[b]:.2g} N m"
    share = float(both[b]) / largest_force(engine, world)
    creeps = (
        f"body {bodies[b].name!r} is free in some direction and creeps under {what}, {share:.1g} of the largest force"
    )
    return share, creeps


def creeping_notes(engine: Engine) -> list[str]:
    """What to say of an equilibrium in which a body goes on moving, in the world that is the worst; nothing where
    round-off moves it."""
    share, clause = max(left_over(engine, world) for world in range(engine.worlds))
    if share <= ROUND_OFF:
        return []
    return [f"equilibrium: {clause}; taken as at rest there, a weak spring on what is free would hold it"]
