r"""The static state of a scene with friction: one load step from the initial state.

Static friction depends on slip, and slip requires a reference. An equilibrium has none, so it
is frictionless except in small-sliding contacts (`settle`), unless friction is requested: then slip is measured from
the *initial state*, the positions of the assembled scene, with joints closed. With x_0 that state, a load step
(`warpffrf_kernels.step.proximal`) finds x_1 with

    R(x_1, t; slip = x_1 - x_0) = 0        under the loads and prescribed motions of the time t,

all friction by its law with the normal loads at x_1: a joint, a lumped contact or a cell sticks where less than its
bound keeps it at x_0, and has slipped against its traction elsewhere. This equals the result of loads that grow
simultaneously from zero, as long as slip directions stay those of the end; consecutive loads require a static run,
which continues from here.

Halving such a step has no effect, because its loads do not depend on time: it is the last of 2^n parts of a step, n the
largest depth of halving, and so continues with shorter proximal steps at once.

The energy ledger starts at the state found: earlier work is not included.

**Contact of surfaces.** The iteration finds tractions from pressures near those of the previous state, and rarely
converges without pressures. So the scene is pressed together first, without friction and with all motions that friction
will resist constrained at their initial state (`start.settle.PressedMotions`). The load step continues from there:
surfaces slip from the state under the whole pressure, joints with friction from the initial state. This is the path of
a normal load followed by a tangential one, after Cattaneo and Mindlin. It is not the path of both growing in
proportion, in which a patch with a tangential load below mu P does not slip at all. While it is pressed, a body deforms
under the tangential load as if constrained by its inertia, and this motion of its surface is not slip. In a static run
in which the tangential load is applied later it is slip, and the patch displaces a few per cent more
(tests/online/friction/test_surfaces_at_rest.py). If the path matters, run it with `static`.

Laws that give no force without a velocity are refused.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.scene import Scene
from warpffrf.online.engine import Engine
from warpffrf.online.history.history import ENERGY_LINES
from warpffrf.online.start.free_motions import LEANS, FreeMotions
from warpffrf.online.start.loading import begin_loading, not_at_rest, slides
from warpffrf.online.start.static_equilibrium import LEAST, PressedMotions, press
from warpffrf_kernels.core import control as k

TAKES = 1.0  # s, the step for laws that depend on a rate
ATTEMPTS = 8  # exceeds the number of repetitions of a load step with shorter proximal steps
CAREFUL = 2  # proximal steps begin at 1e-4 of their final length
WORKS = ("force_work", "drive_work", "damping", "contact_grid", "numerical", "friction")


def refuse_without_rest(scene: Scene) -> None:
    """Raises `InputError` for what an equilibrium with friction cannot have: films, and laws of a slip velocity."""
    if scene.films:
        raise InputError(
            f"equilibrium: film {scene.films[0].name!r} carries by sliding and squeezing, which friction=True has not; "
            "leave friction out, then films slide as the scene begins"
        )
    laws = [(c.name, c.friction) for c in (*scene.finite_sliding, *scene.lumped_contacts)]
    laws += [(force.name, force.friction) for force in scene.forces if hasattr(force, "slip")]
    for name, law in laws:
        if law.creep_limit > 0.0:
            raise InputError(
                f"equilibrium: regularised friction of {name!r} holds nothing at rest, it needs a slip velocity; give "
                "laws.Coulomb, or leave friction=True out"
            )
    for contact in scene.lumped_contacts:
        if contact.rolling_resistance is not None:
            raise InputError(
                f"equilibrium: the rolling resistance of {contact.name!r} holds nothing at rest, it needs a velocity; "
                "leave it out, or friction=True"
            )


def rub_to_rest(engine: Engine) -> bool:
    """Bring every world of `engine` to its static state with friction at the present time; True on success. The reason
    for a failure is in its status and, where a body keeps moving, in `engine.not_at_rest`.
    """
    engine.rates_to_zero()
    engine.static_step(LEAST * float(engine.compiled.model.length))  # closes joints, finds what overlaps
    if np.any(engine.word("status")):
        return False
    if unbalanced := FreeMotions(engine, rubs=True).unbalanced(turns=False):
        engine.not_at_rest = unbalanced
        return False
    engine.commit()
    if not any(contact.friction.acts for contact in engine.scene.finite_sliding):
        return _rubbed(engine, CAREFUL)
    _joints_stick(engine)
    begin, notes = engine.checkpoint(), list(engine.start_notes)
    motions = PressedMotions(engine)
    pressed = press(engine, motions)
    if (motions.presses or not motions.leans) and pressed and _rubbed(engine, 0):
        return True
    if not motions.leans:
        return False
    for lean in (LEANS, 0.0):  # where neither succeeds, the reason of the first one is reported
        engine.resume(begin)
        engine.start_notes[:] = notes
        if press(engine, PressedMotions(engine, lean)) and _rubbed(engine, 0):
            return True
    return False


def _rubbed(engine: Engine, careful: int) -> bool:
    """The load step in which friction acts, its proximal steps shortened by 100^careful; True on success."""
    free = FreeMotions(engine, rubs=True)
    free.hold_here()
    time = engine.word("time")
    deep = engine.compiled.model.limits.max_level
    whole = TAKES * 2.0**deep
    begin_loading(engine, whole)
    engine.clock(start_time=time - whole)
    engine.control(level=deep, sub=2**deep - 1, proximal_level=careful, target=1, every=2)  # one step records no row
    # where contact closes or opens, energy errors of its grids exceed the changes in a load step
    engine.control(energy_bounded=int(engine.compiled.model.pairs.count == 0))
    engine.replay(ATTEMPTS)
    if np.any(engine.word("status")):
        free.look()
        engine.not_at_rest = free.unbalanced() or ("" if slides(engine) else free.driven) or not_at_rest(engine)
    free.release()
    words = engine.state.ctl.numpy().copy()
    words["status"] &= ~int(k.UNDERFLOW)  # no step was halved
    engine.state.ctl.assign(words)
    engine.control(step=0, sub=0, level=0, energy_bounded=0, proximal_level=0)
    engine.clock(start_time=time, user_step=TAKES)
    if np.any(engine.word("status")):
        return False
    energy = engine.state.energy.numpy().copy()
    energy[:, :, [ENERGY_LINES.index(line) for line in WORKS]] = 0.0
    engine.state.energy.assign(energy)
    engine.start_notes.extend(free.afloat())
    return True


def _joints_stick(engine: Engine) -> None:
    """Joints with friction measure slip from the present state, whatever precedes the action of friction."""
    table, state = engine.compiled.slips, engine.state
    coordinate, stuck_at = engine.scratch.coordinate.numpy(), state.stuck_at.numpy().copy()
    for e, rows in enumerate(table.rows.values()):
        stuck_at[:, e, : len(rows)] = coordinate[:, rows]
    state.stuck_at.assign(stuck_at)
    state.slipping.zero_()
