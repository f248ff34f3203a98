r"""Load steps: from one equilibrium to the next, under the loads and prescribed motions at the end of the step.

An attempt of a load step (mode LOADING) measures its increments d = (dx, psi, dq) from the accepted state, the last
equilibrium, and has no velocities. It approaches the next equilibrium in rounds of proximal steps of size tau, each
balanced by Newton's method,

    M (d - c)/tau^2 + R(d, t_1) = 0,        c = d of the previous round, 0 at first,

with R the static residual. A long tau is Newton's step; a short one follows the gradient of the energy, as far as the
step of an implicit integrator of a motion without velocities. The inertia of the last round is the residual of the
statics: below `BALANCED` of the tolerance of Newton's method, the rounds have come to rest. Each round reduces
vibrations of frequency omega by 1 + (omega tau)^2, so that with a tau of some seconds two rounds suffice, and the
second of them costs as many solves with the matrix of the first.

**History.** All quantities that a step takes from the accepted state remain those of the last equilibrium until the
attempt is accepted, as in a step in time: friction uses the slip of the whole load step and commits it once. So
`commit` is 1 for accepted attempts in time and of load steps. It is 0 for the proximal steps by which
`warpffrf.online.start.static_equilibrium` approaches a first equilibrium (mode STATIC), each of which is an accepted
attempt of its own, and for the tiny steps of a start: history variables are stored when `commit` is 1, in phase `keep`,
and forces are functions of that history and of the present state. `settle` commits once, when it has come to rest.

**Free motions** that are constrained artificially (`warpffrf_kernels.bodies.motion.hold_motions`) must not be driven:
the constraining force is at most `PULLED` of the largest force, or `TURNED` of it for rotations, the level of torque
errors due to the grids. Motions that friction resists are constrained as well, four times less in each round, until the
remaining constraining force is below the tolerance of Newton's method: with k_h the constraint stiffness of the first
round and k_f that of the patch, the load that is not yet on the patch falls by (1 + 4^r k_f/k_h) in round r.

**Failure.** A load step whose Newton's method fails, whose energy increases (`ledger`), or that does not come to rest
in `MOST` rounds, is halved, together with its loads. One that cannot be halved again is taken with shorter proximal
steps: the first is 100^-n tau, n = `proximal_level`, and they grow by 10^(1/n) per round up to tau, to follow a
structure that snaps through. Accepted steps reverse both.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.core.scratch import Residuals, RetainedSystem, Trial

wp.set_module_options(MODULE_OPTIONS)

BALANCED = wp.constant(wp.float64(1.0e-2))  # of the residual tolerance
MOST = wp.constant(60)  # rounds: a motion with omega tau = 0.7 is then reduced to 1e-11, a mechanism never
PULLED = wp.constant(wp.float64(1.0e-8))  # see `warpffrf.online.start.free_motions`
TURNED = wp.constant(wp.float64(1.0e-5))
MOST_HELD = wp.constant(5)  # rounds in which motions that friction resists are constrained far more than by inertia
WEAKEST = wp.constant(wp.float64(1.0e-6))  # of the initial value: weaker constraints are negligible compared with tau
STANDS = wp.constant(wp.float64(1.0e-6))  # of a motion's square: translational part where a body rotates
GROWN = wp.constant(wp.float64(2.302585092994046))  # ln 10


@wp.func
def weaken(model: Model, w: int, hold_firm: int, hold_count: int, by: real, system: RetainedSystem):
    """Multiplies the constraints of motions not held firmly by by^2: 4^-r in round r, and back, without round-off."""
    h = hold_firm
    while h < hold_count:
        i = int(0)
        while i < 6 * model.bodies.count:
            system.hold[w, h, i] = system.hold[w, h, i] * by
            i += 1
        h += 1
    system.hold_weak[w] = system.hold_weak[w] * by


@kernel
def open_rounds(run: Run, system: RetainedSystem, trial: Trial):
    """Per world: the first round of an attempt is centred on the accepted state."""
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
def along_of(model: Model, w: int, h: int, trial: Trial, system: RetainedSystem) -> real:
    """Component of the increment of a round along free motion h."""
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
def held_back(model: Model, run: Run, w: int, h: int, along: real, given: real, system: RetainedSystem) -> real:
    """Constraining force of free motion h over the allowed one: `given` of the largest force, or if that is zero the
    limit of residual loads on free motions; `along`: the motion relative to the previous round."""
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
def end_round(run: Run, trial: Trial, system: RetainedSystem, residuals: Residuals):
    """Per world in a load step whose iteration has just converged: starts another round if it has not come to rest."""
    w = wp.tid()
    model = run.models[w]
    if run.ctl[w].mode != k.LOADING or run.ctl[w].attempt == 0 or run.ctl[w].run != 0 or run.ctl[w].failure != 0:
        return
    if run.ctl[w].iteration == 0:
        return
    grows = run.clk[w].retained.acc * run.clk[w].tau * run.clk[w].tau > real(1.0) + real(1.0e-9)
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
        run.ctl[w].failure = run.ctl[w].failure | k.NOT_AT_REST
        return
    if run.ctl[w].round <= MOST_HELD:  # later the inertia of the body constrains it
        system.hold_force[w] = dragged
    # terms of the balance due to the new centre, except for the inertia of deformed bodies, which the next iteration
    # adds
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
        residuals.modal_residual[w, m] = residuals.modal_residual[w, m] - run.clk[w].retained.acc * (
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
        growth = wp.exp(real(2.0) * GROWN / real(wp.max(run.ctl[w].proximal_level, 1)))
        run.clk[w].retained.acc = wp.max(
            run.clk[w].retained.acc / growth, real(1.0) / (run.clk[w].tau * run.clk[w].tau)
        )
        run.clk[w].local.acc = run.clk[w].retained.acc
        run.ctl[w].reassemble = 1
        run.ctl[w].stale = 1
        run.ctl[w].refresh = 1
    run.ctl[w].round = run.ctl[w].round + 1
    run.ctl[w].run = 1
