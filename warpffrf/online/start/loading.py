"""Start of load steps by the host, and messages for one that does not come to rest."""

from __future__ import annotations

import numpy as np

from warpffrf.online.diagnosis.no_equilibrium import gross_slip, too_much_for
from warpffrf.online.engine import Engine
from warpffrf.online.start.static_equilibrium import LAST
from warpffrf_kernels.core import control as k
from warpffrf_kernels.step.step_control import DRAGS


def begin_loading(engine: Engine, step: float) -> None:
    """Start a new count of load steps of `step` [s] at the present time."""
    engine.clock(start_time=engine.word("time"), tau=LAST * float(engine.compiled.model.length))
    engine.enter(k.LOADING, step, target=0)
    engine.control(proximal_level=0, reason=0, shaken=0, gaining_steps=0, again=0)


def not_at_rest(engine: Engine) -> str:
    """The contacts that slide as a whole, or the body that kept moving, in a load step that did not come to rest; else
    ""."""
    if not engine.word("status")[0] & int(k.NOT_AT_REST):
        return gross_slip(engine)
    scratch, bodies = engine.scratch, engine.compiled.model.bodies
    count = len(engine.scene.bodies)
    J = np.trace(bodies.inertia.numpy()[:count], axis1=1, axis2=2)
    gyration = np.sqrt(J / (3.0 * bodies.mass.numpy()[:count]))
    moves, turns = (
        np.linalg.norm(d.numpy()[0] - c.numpy()[0], axis=-1)[:count]
        for d, c in ((scratch.dx, scratch.centre_dx), (scratch.psi, scratch.centre_psi))
    )
    b = int(np.argmax(np.maximum(moves, gyration * turns)))
    amount = f"{moves[b]:.3g} m" if moves[b] >= gyration[b] * turns[b] else f"{turns[b]:.3g} rad"
    more = f", {slides(engine)}" if slides(engine) else ""
    return f"body {engine.scene.bodies[b].name!r} does not come to rest ({amount} in the last proximal step){more}"


def slides(engine: Engine) -> str:
    """For a failed load step: the contacts whose friction alone resists a motion and does not suffice; "" if there are
    none."""
    if not engine.compiled.model.pairs.count or engine.scratch.hold_force.numpy()[0] <= DRAGS:
        return gross_slip(engine)
    return too_much_for([str(contact.name) for contact in engine.scene.finite_sliding if contact.friction.acts])
