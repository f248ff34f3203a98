"""The static state of a scene, found by proximal steps on the device.

A proximal step of size tau [s] balances `M d/tau^2 = F` at its end, d the displacement: a step of implicit motion
without velocity. A short one goes down the slope of the energy, a long one is Newton's step. So tau grows while steps
converge, and an iteration that fails, or a step that ends higher than it began (`kernels commit`), is taken again with
a shorter one; once the scene has come much nearer to rest, longer ones are tried again.

Motions that nothing resists (`warpffrf.online.start.free_motions`) are held where they are as soon as the rest is known
to within the tolerance of Newton's method: round-off, and what the grids leave of torques that are zero, would carry
them off. What moves along them all the same, as balls turn by round-off, is no movement of a scene that rests.

Laps that rub go down with their energy and what friction has taken since the state that its history begins in: as
pressures come to rest that falls, and the energy alone may rise by as much. Where even steps shorter than the first one
end higher, it is not asked any more.

Films are squeezed over the time tau while their walls slide with the velocities that the scene begins with, so that
what comes to rest is a steady state; it has no energy to go down."""

from __future__ import annotations

import numpy as np

from warpffrf.online.engine import Engine
from warpffrf.online.start.free_motions import FreeMotions
from warpffrf.online.start.rest import creeping_notes, left_over
from warpffrf.online.start.slow_films import stretch
from warpffrf_kernels.core import control as k

MOST_STEPS = 150  # a snap-through takes about a hundred
GROWTH = 10.0  # of the proximal step from one to the next, ...
CAREFUL = 2.0  # ... below one that failed
# times are those that a length of the scene takes at some speed, as the times of its vibrations grow with its size
FIRST = 1e-2  # s/m: 1 ms for a scene of 0.1 m, moves a body by F/m * 1e-6 s2 at first
LEAST = 1e-6  # s/m: a step that fails even so is no matter of its size
# layers that hardly hold at touch, pairs far apart that seem to close: a body that would go too far at first begins
# again with a shorter step
RETREATS, RETREAT = 2, 1000.0
# s/m: 1 kg of a scene of 0.1 m then weighs 1 N/m, far below any spring that carries a load; larger ill-conditions the
# joints
LAST = 10.0
# of it, where the scene needs it: bodies of a tenth of a millimetre on springs of a few hertz, whose vibrations
# are not faster for being small, come nearer to rest in each of them by less than CREEP
LONGER = 1e6
TOLERANCE = 1e-11  # of the scene's length, movement of the last proximal step: round-off of positions times 1e5
ROUND_OFF = 1e-16  # of it: less is no movement in a step that is not short
VOIDS_STAY = 1e-9  # of the clearance
CREEP = 0.5  # of the movement of the step before: what tends to rest moves less from one long step to the next
LEVEL = 1e-3, 1e-2  # of it: energies differ by no more than what grids of contact make of them; the same of cells that
# travel, which are as wide as the pressures of the step before asked for


def settle(engine: Engine, free: FreeMotions | None = None) -> bool:
    """Bring every world of `engine` to its static state at the present time; True on success. free: the motions that
    are held, None those that nothing resists.

    A scene in which a body creeps although its forces balance, to the tolerance of Newton's method, is at rest too.
    What creeps, and what is free and was left where it is, is named in `engine.start_notes`.
    """
    engine.rates_to_zero()
    free = free or FreeMotions(engine)
    engine.control(downhill=int(not engine.scene.films))
    engine.scratch.film_stretch.fill_(stretch(engine.scene, LAST * float(engine.compiled.model.length)))
    try:
        at_rest = _stepped(engine, free)
        engine.not_at_rest = "" if at_rest else free.unbalanced() or free.driven
        return at_rest
    finally:
        engine.control(downhill=0)
        free.release()


def _stepped(engine: Engine, free: FreeMotions) -> bool:
    """The steps of `settle`."""
    model = engine.compiled.model
    length = float(model.length)
    least, last = LEAST * length, LAST * length
    longest = LONGER * last
    tau = FIRST * length if np.isfinite(free.first) else least
    level = LEVEL[1 if engine.compiled.patches else 0]
    too_long = np.inf
    before = latest = moved = failed_at = np.full(engine.worlds, np.inf)
    retreats = RETREATS if engine.compiled.elements.layers.count or model.pairs.count > 1 else 0
    rubs = any(lap.friction.acts for lap in engine.scene.laps)
    settled = balanced = still = False
    for _ in range(MOST_STEPS):
        words = engine.state.ctl.numpy().copy()
        engine.static_step(tau)
        status = engine.word("status")
        if np.any(status):
            if still:  # what is left of forces and energies is round-off, and may well rise
                engine.state.ctl.assign(words)
                return _at_rest(engine, free, creeping=False)
            if rubs and tau < FIRST * length and np.all((status == 0) | (status == int(k.ENERGY))):
                engine.state.ctl.assign(words)
                engine.control(downhill=0)
                rubs, too_long, tau = False, np.inf, FIRST * length
                continue
            if free.hold_driven():
                engine.state.ctl.assign(words)
                continue
            can_be_shorter = not np.any(status & ~int(k.NOT_CONVERGED | k.ENERGY)) and tau > least
            if retreats == 0 and not (settled or balanced or can_be_shorter):
                return False
            engine.state.ctl.assign(words)
            if retreats > 0 and not (settled or balanced):
                retreats, tau = retreats - 1, tau / RETREAT
            else:
                too_long, failed_at, tau = tau, moved, tau / GROWTH
                before = np.zeros(engine.worlds)
            continue
        if free.unbalanced(turns=False):
            return False
        moved = np.maximum(engine.word("move"), _turned(engine))
        left = np.array([left_over(engine, world)[0] for world in range(engine.worlds)])
        free.look()
        if np.all(left <= free.first):
            free.hold()
        if free.wanders:
            free.hold_driven()
        if np.all(left <= level):
            engine.control(downhill=0)
        if np.all(moved <= failed_at / GROWTH):
            too_long, before = np.inf, np.full(engine.worlds, np.inf)
        longer = [min(tau * growth, last) for growth in (GROWTH, CAREFUL, 1.0)]
        longer = next(t for t in longer if t < too_long)
        settled = bool(np.all(_moved_else(engine, free) <= TOLERANCE * length)) and _films_steady(engine)
        still = tau >= FIRST * length and bool(np.all(moved <= ROUND_OFF * length))
        balanced = bool(np.all(left <= model.limits.residual_tolerance))
        creeping = balanced and bool(np.any(moved > CREEP * before))
        if longer == tau and (creeping or (settled and (balanced or tau >= last))):
            return _at_rest(engine, free, creeping=not settled)
        if tau >= last:
            if last < longest and np.all(moved < latest) and np.any(moved > CREEP * latest):
                last *= GROWTH
            before = latest = moved
        tau = longer
    return balanced and _at_rest(engine, free, creeping=True)


def _turned(engine: Engine) -> np.ndarray:
    """Largest turn of a body in the last step, at its radius of gyration (worlds,) [m]; one that turns about its centre
    of mass does not move otherwise."""
    turns = np.linalg.norm(engine.scratch.psi.numpy()[:, : len(engine.scene.bodies)], axis=-1)
    return np.asarray((_gyration(engine) * turns).max(axis=1, initial=0.0))


def _moved_else(engine: Engine, free: FreeMotions) -> np.ndarray:
    """Largest movement of a body in the last step but for what is free (worlds,) [m], turns at radii of gyration."""
    count, gyration = len(engine.scene.bodies), _gyration(engine)
    found = []
    for world in range(engine.worlds):
        step = np.hstack([getattr(engine.scratch, name).numpy()[world, :count] for name in ("dx", "psi")])
        rest = free.resisted_part(world, step)
        ways, turns = np.linalg.norm(rest.reshape(count, 2, 3), axis=-1).T
        found.append(max(ways.max(initial=0.0), (gyration * turns).max(initial=0.0)))
    return np.array(found)


def _gyration(engine: Engine) -> np.ndarray:
    """Radii of gyration (bodies,) [m]."""
    bodies, count = engine.compiled.model.bodies, len(engine.scene.bodies)
    return np.sqrt(np.trace(bodies.inertia.numpy(), axis1=1, axis2=2)[:count] / (3.0 * bodies.mass.numpy()[:count]))


def _films_steady(engine: Engine) -> bool:
    """Whether the voids of films have stayed in the last step, which take turns to come to where they stay."""
    films = engine.compiled.films
    if not films.count:
        return True
    moved = np.abs(engine.state.film_void.numpy()[:, 0] - engine.state.film_void_before.numpy()).max()
    return bool(moved <= VOIDS_STAY * films.thickness.numpy().min())


def _at_rest(engine: Engine, free: FreeMotions, *, creeping: bool) -> bool:
    """True, with notes of what is free and what creeps; what remembers a history begins it here."""
    engine.start_notes.extend(free.notes())
    if creeping and np.isfinite(free.first):
        engine.start_notes.extend(creeping_notes(engine))
    engine.commit()
    return True
