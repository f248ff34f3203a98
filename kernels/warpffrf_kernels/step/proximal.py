r"""Load steps: from one equilibrium to the next, under the loads and prescribed motions at the end of the step.

An attempt of a load step (mode LOADING) counts its increments d = (dx, psi, dq) from the accepted state, the last
equilibrium, and has no velocities. It goes to the next equilibrium in rounds of proximal steps of size tau, each
balanced by Newton's method,

    M (d - c)/tau^2 + R(d, t_1) = 0,        c = d of the round before, 0 at first,

with R the static residual. A long tau is Newton's step; a short one goes down the slope of the energy, as far as the
step of an implicit integrator of a motion without velocities. What the inertia of the last round has is what the
statics have not balanced: below `BALANCED` of what Newton's method leaves, the rounds have come to rest. Vibrations of
frequency omega are nearer to rest by 1 + (omega tau)^2 with every round, so that with a tau of some seconds two rounds
do, and the second of them costs as many solves with the matrix of the first.

**History.** All that a step takes from the accepted state stays that of the last equilibrium until the attempt is
accepted, as in a step in time: friction sees the slip of the whole load step and commits it once. So `commit` is 1 of
accepted attempts in time and of load steps. It is 0 of the proximal steps by which `warpffrf.online.start.settle` goes
to a first equilibrium (mode STATIC), each of which is an accepted attempt of its own, and of the tiny steps of a start:
what remembers a history keeps it where `commit` is 1, in phase `keep`, and forces are functions of that history and of
the present state. `settle` commits once, when it has come to rest.

**Free motions** that are held (`warpffrf_kernels.bodies.motion.hold_motions`) must not be driven: what holds one is
next to nothing, `PULLED` of the largest force, or `TURNED` of it where a body turns, which grids leave of torques.
Motions that friction resists are held as well, four times less from round to round, until what still holds them is
below the tolerance of Newton's method: with k_h the holding of the first round and k_f what the patch resists with, the
load that is not on the patch yet falls by (1 + 4^r k_f/k_h) in round r.

**Failure.** A load step whose Newton's method fails, that goes uphill (`ledger`), or that does not come to rest in
`MOST` rounds, is halved, its loads with it. One that cannot be halved again is taken with shorter proximal steps: the
first is 100^-n tau, n = `careful`, and from round to round they grow by 10^(1/n) up to tau, to follow a structure that
snaps through. Accepted steps take both back.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.core.scratch import OuterSystem, Residuals, Trial

wp.set_module_options(MODULE_OPTIONS)

BALANCED = wp.constant(wp.float64(1.0e-2))  # of the residual tolerance
MOST = wp.constant(60)  # rounds: what has omega tau = 0.7 then comes to 1e-11, a mechanism never
PULLED = wp.constant(wp.float64(1.0e-8))  # see `warpffrf.online.start.free_motions`
TURNED = wp.constant(wp.float64(1.0e-5))
MOST_HELD = wp.constant(5)  # rounds in which motions that friction resists are held by far more than inertia
WEAKEST = wp.constant(wp.float64(1.0e-6))  # of what it was at first: motions held that little weigh nothing beside tau
STANDS = wp.constant(wp.float64(1.0e-6))  # of a motion's square: what of it slides where a body turns
GROWN = wp.constant(wp.float64(2.302585092994046))  # ln 10


@wp.func
def weaken(model: Model, w: int, hold_firm: int, hold_count: int, by: real, system: OuterSystem):
    """Motions that are not held firmly, their holding times by^2: 4^-r in round r, and back, without round-off."""
    h = hold_firm
    while h < hold_count:
        i = int(0)
        while i < 6 * model.bodies.count:
            system.hold[w, h, i] = system.hold[w, h, i] * by
            i += 1
        h += 1
    system.hold_weak[w] = system.hold_weak[w] * by


@kernel
def open_rounds(run: Run, system: OuterSystem, trial: Trial):
    """Per world: the first round of an attempt is about the accepted state."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    if lane == 0:
        system.hold_force[w] = real(0.0)
    if lane == 0 and run.ctl[w].mode == k.LOADING and system.hold_count[w] > system.hold_firm[w]:
        weaken(model, w, system.hold_firm[w], system.hold_count[w], real(1.0) / system.hold_weak[w], system)
    b = lane
    while b < trial.centre_dx.shape[1]:
        trial.centre_dx[w, b] = vec3(real(0.0))
        trial.centre_psi[w, b] = vec3(real(0.0))
        b += wp.block_dim()
    m = lane
    while m < trial.centre_dq.shape[1]:
        trial.centre_dq[w, m] = real(0.0)
        m += wp.block_dim()


@wp.func
def along_of(model: Model, w: int, h: int, trial: Trial, system: OuterSystem) -> real:
    """Free motion h of a round."""
    along = real(0.0)
    b = int(0)
    while b < model.bodies.count:
        d = trial.dx[w, b] - trial.centre_dx[w, b]
        turn = trial.psi[w, b] - trial.centre_psi[w, b]
        for c in range(3):
            along += system.hold[w, h, 6 * b + c] * d[c] + system.hold[w, h, 6 * b + 3 + c] * turn[c]
        b += 1
    return along


@wp.func
def held_back(model: Model, run: Run, w: int, h: int, along: real, given: real, system: OuterSystem) -> real:
    """The force that holds free motion h over the one allowed, `given` of the largest, or where that is zero what loads
    may leave of what is free; `along`: the motion less that of the round before."""
    force = real(0.0)
    slides = real(0.0)
    turns = real(0.0)
    b = int(0)
    while b < model.bodies.count:
        m = model.bodies.mass[b]
        J = wp.trace(model.bodies.inertia[b]) / real(3.0)
        for c in range(3):
            f = system.hold[w, h, 6 * b + c]
            t = system.hold[w, h, 6 * b + 3 + c]
            force += f * f + t * t * m / J
            slides += f * f / m
            turns += t * t / J
        b += 1
    allowed = TURNED
    if slides > STANDS * (slides + turns):
        allowed = PULLED
    if given > real(0.0):
        allowed = given
    return wp.abs(along) * wp.sqrt(force) / (allowed * run.clk[w].force)


@kernel
def end_round(run: Run, trial: Trial, system: OuterSystem, residuals: Residuals):
    """Per world in a load step whose iteration has just converged: another round where it has not come to rest."""
    w = wp.tid()
    model = run.models[w]
    if run.ctl[w].mode != k.LOADING or run.ctl[w].attempt == 0 or run.ctl[w].run != 0 or run.ctl[w].failure != 0:
        return
    if run.ctl[w].iteration == 0:
        return
    grows = run.clk[w].outer.acc * run.clk[w].tau * run.clk[w].tau > real(1.0) + real(1.0e-9)
    held = int(0)
    firm = int(0)
    if model.pairs.count > 0:
        held = system.hold_count[w]
        firm = system.hold_firm[w]
    driven = real(0.0)
    dragged = real(0.0)
    h = int(0)
    while h < held:
        along = along_of(model, w, h, trial, system)
        allowed = real(0.0)
        if h >= firm:
            allowed = model.limits.residual_tolerance
        back = held_back(model, run, w, h, along, allowed, system)
        driven = wp.max(driven, back)
        if h >= firm:
            dragged = wp.max(dragged, back * allowed)
        h += 1
    if not grows and driven <= real(1.0) and run.clk[w].left <= BALANCED * model.limits.residual_tolerance:
        return
    if run.ctl[w].round >= MOST:
        run.ctl[w].failure = run.ctl[w].failure | k.RESTLESS
        return
    if run.ctl[w].round <= MOST_HELD:  # later the inertia of the body bears it
        system.hold_force[w] = dragged
    # what the balance sees of the new centre, but for the inertia of deformed bodies, which the next iteration adds
    h = int(0)
    while h < held:
        along = along_of(model, w, h, trial, system)
        i = int(0)
        while i < 6 * model.bodies.count:
            residuals.residual[w, i] = residuals.residual[w, i] - system.hold[w, h, i] * along
            i += 1
        h += 1
    b = int(0)
    while b < model.bodies.count:
        f = model.bodies.mass[b] * trial.v1_rate[w, b]
        t = model.bodies.inertia[b] * trial.omega1_rate[w, b]
        for c in range(3):
            residuals.residual[w, 6 * b + c] = residuals.residual[w, 6 * b + c] - f[c]
            residuals.residual[w, 6 * b + 3 + c] = residuals.residual[w, 6 * b + 3 + c] - t[c]
        trial.centre_dx[w, b] = trial.dx[w, b]
        trial.centre_psi[w, b] = trial.psi[w, b]
        b += 1
    m = int(0)
    while m < model.modes.count:
        residuals.modal_residual[w, m] = residuals.modal_residual[w, m] - run.clk[w].outer.acc * (
            trial.dq[w, m] - trial.centre_dq[w, m]
        )
        trial.centre_dq[w, m] = trial.dq[w, m]
        m += 1
    if held > firm and system.hold_weak[w] > WEAKEST:
        weaken(model, w, firm, held, real(0.5), system)
        run.ctl[w].reassemble = 1
        run.ctl[w].stale = 1
        run.ctl[w].refresh = 1
    if grows:
        growth = wp.exp(real(2.0) * GROWN / real(wp.max(run.ctl[w].careful, 1)))
        run.clk[w].outer.acc = wp.max(run.clk[w].outer.acc / growth, real(1.0) / (run.clk[w].tau * run.clk[w].tau))
        run.clk[w].local.acc = run.clk[w].outer.acc
        run.ctl[w].reassemble = 1
        run.ctl[w].stale = 1
        run.ctl[w].refresh = 1
    run.ctl[w].round = run.ctl[w].round + 1
    run.ctl[w].run = 1
