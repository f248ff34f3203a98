r"""Contact that opens, closes or rebounds within a step: impulsive steps of a pair, whose force has no memory.

The integrators of `motion` store forces, in a_0 and vdot_0: for a force f that acts at the end of one step only,

    v_1 = v_0 + gamma h f/m,      v_2 = v_1 + (1 - gamma) h f/m,

the second part acts after contact has opened. A body that meets a stiff partner with speed V after the part t of a step
requires f/m = V (1 - t)/(beta h) to be there at its end; both parts are up to V/beta, 4 V for the trapezoidal rule,
whereas an elastic impact requires 2 V only. Generalized-alpha (rho 0.8) multiplies the energy of an unresolved impact
by up to 8.5, for any step. A pair whose contact does not persist through a step therefore takes it as an *impulsive*
one (after Kane, Repetto, Ortiz and Marsden 1999; like schemes that keep impulses out of the recursion of
generalized-alpha, Bruels, Acary and Cardona 2014): a mean f of its force acts throughout the step and is excluded from
the accelerations. With a and vdot without it, w = M^-1 f,

    d = h v_0 + h^2 ((1/2 - beta) a_0 + beta a_1 + b w),
    v_1 = v_0 + h ((1 - gamma) a_0 + gamma a_1 + w),           M vdot_1 = F_1, without the pair.

With f_0 and f_1 the pair's generalised forces at both ends of the step, including friction,

    f = (1 - theta) f_0 + theta f_1;

`impulsive_means` defines the theta that returns the energy stored by contact, and when a step is impulsive. In steps
before and after, the pair is integrated as usual, with second order and the damping of the integrator: its part of the
accelerations is known as f_0 and its *memory*, generalized-alpha's filter of the pair's force,

    (1 - alpha_m) m_1 + alpha_m m_0 = (1 - alpha_f) f_1 + alpha_f f_0,

so it can be removed (`begin_contact`) and restored (`impulsive_memory.finish_rates`) exactly.

b is 1/2: the impulse f h does the work f.(v_0 + v_1) h/2 = f.d on its own part of the motion. In the first step of an
impact all other forces act by the trapezoidal rule (alphas 0, beta 1/4, gamma 1/2, from the true accelerations): the
reaction of a joint or a stiff mode to the impulse then acts as the impulse does, and v_1 = 2 d/h - v_0. With the
weights of generalized-alpha the velocity h (1 - gamma/(2 beta)) w would remain, and a force that a load increases
slowly would end too high by (2 gamma - 1) of its rise. In consecutive impulsive steps the other forces act as in the
integrator, which is damped: with the trapezoidal rule, stiff unresolved parts would oscillate from step to step, for
example the loads of a bearing whose idle rollers chatter. Scenes with layers keep the trapezoidal rule: the work of a
damped layer may exceed what any mean of its force balances.

In scenes with dynamic local modes, where theta is 1 and all steps keep their rule, b is slightly larger: 1/2 keeps a
pressed body at rest, a_0 = a_1 = -w, d = v_1 = 0, and gives v_1 = -v_0 if a rigid surface constrains a face; beta/gamma
damps that alternation, v_1 = -(gamma/beta - 1) v_0, and gives a pressed body the velocity -h (b - 1/2) w. Hence, with
omega that of a local mode, and for bodies and global modes that of the highest global mode,

    b = 1/2 + (beta/gamma - 1/2)/(1 + (omega h)^2).

**In the unknowns of `motion`** this is: its formulas, with a_0 and vdot_0 without contact, and a contact force in the
balance that is multiplied by

    kappa = (1 - alpha_m)/(1 - alpha_f) b/beta - c h (1 - gamma b/beta),

c the damping; the formulas' vdot^, a^ and v^ are vdot_1 + (1 - alpha_m)/(1 - alpha_f) (b/beta) w, a_1 + (b/beta) w, and
v_1 - h (1 - gamma b/beta) w. Joints' dampers and gyroscopic forces use v^. A mode with the exact step has the constant
load throughout the step, kappa = 1, which does exactly its work.

In the linear systems an end force f_1 acts as kappa theta f_1. With D = diag(kappa theta) over the nodes of impulsive
pairs, 1 for others, the contact matrix G + B D, B = L H L^T + J sigma^-1 J^T, becomes symmetric in D^(1/2) ds, rows
times D^(1/2): G + D^(1/2) B D^(1/2). L, V and J sigma^-1 are therefore multiplied by the *weight* (kappa theta)^(1/2)
of their pair, as are the corresponding gaps, slips, bounds and tractions; the local part G requires no weight except
between pairs with different weights.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import ContactFields, ContactGeometry, ContactSolve
from warpffrf_kernels.core.control import Clock, Coefficients
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells
from warpffrf_kernels.core.integration import EXACT, LOCAL, OUTER, coefficients_of, rule_of
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync, vec3
from warpffrf_kernels.core.scratch import ImpulsiveContact, Residuals, RetainedSystem, Trial
from warpffrf_kernels.core.state import ContactState, FrictionState, LoadState, MotionState
from warpffrf_kernels.normal.contact_solve import push_by_slots
from warpffrf_kernels.normal.pair_forces import force_on, is_closed, mean_of, modal_place, surface_of, whole

wp.set_module_options(MODULE_OPTIONS)

NEGLIGIBLE = wp.constant(wp.float64(1.0e-3))  # of the contact energy of its group: a pair with less is idle
LEAST_WEIGHT = wp.constant(wp.float64(1.0e-4))  # of a pair that closes at the end of the step


@wp.func
def share(h: real, c: Coefficients, stiffness: real) -> real:
    """b over beta, of coordinates with omega^2 = stiffness."""
    excess = c.beta / c.gamma - real(0.5)
    b = real(0.5) + excess / (real(1.0) + stiffness * h * h)
    return b / c.beta


@wp.func
def retained_share(model: Model, clk: wp.array(dtype=Clock), w: int) -> real:
    """b over beta of bodies and global modes."""
    if model.modes.dynamic_count == 0:
        return real(0.5) / clk[w].retained.beta
    return share(clk[w].h, clk[w].retained, model.modes.retained_frequency * model.modes.retained_frequency)


@wp.func
def kappa_of(c: Coefficients, part: real) -> real:
    """kappa, of b/beta = part."""
    return (real(1.0) - c.alpha_m) / (real(1.0) - c.alpha_f) * part


@wp.func
def slip_of(h: real, c: Coefficients, part: real) -> real:
    """Difference between the velocity and the formula's, over w [s]."""
    return h * (real(1.0) - c.gamma * part)


@wp.func
def retained_kappa(model: Model, clk: wp.array(dtype=Clock), w: int) -> real:
    """kappa of bodies."""
    return kappa_of(clk[w].retained, retained_share(model, clk, w))


@wp.func
def mode_share(model: Model, run: Run, w: int, m: int) -> real:
    """b over beta of mode m; 0 if it has the exact step, which requires none."""
    rule = rule_of(model, run, w, m)
    part = real(0.0)
    if rule == OUTER:
        part = retained_share(model, run.clk, w)
    if rule == LOCAL:
        part = share(run.clk[w].h, run.clk[w].local, model.modes.stiffness[m])
    return part


@wp.func
def mode_kappa(model: Model, run: Run, w: int, m: int) -> real:
    """kappa of mode m, minus the effect of its damper on the velocity."""
    rule = rule_of(model, run, w, m)
    if rule == EXACT:
        return real(1.0)
    part = mode_share(model, run, w, m)
    c = coefficients_of(run.clk, w, rule)
    return kappa_of(c, part) - model.modes.damping[m] * slip_of(run.clk[w].h, c, part)


@wp.func
def weight_of(kappa: real, theta: real) -> real:
    """(kappa theta)^(1/2) of an impulsive pair."""
    return wp.max(wp.sqrt(kappa * theta), LEAST_WEIGHT)


# --- idle pairs: see `impulsive_means`


@wp.func
def energy_about(model: Model, w: int, pair: int, pair_energy: wp.array3d(dtype=real)) -> real:
    """Contact energy [J] of all pairs of the group of a pair."""
    energy = real(0.0)
    other = int(0)
    while other < model.pairs.count:
        if model.pairs.group[pair] == model.pairs.group[other]:
            energy += wp.max(pair_energy[w, other, 0], pair_energy[w, other, 1])
        other += 1
    return energy


@wp.func
def is_idle(model: Model, w: int, pair: int, own: real, pair_energy: wp.array3d(dtype=real)) -> bool:
    """Whether the energy of a pair, `own` [J], is negligible compared with the contact energy of its group."""
    return own < NEGLIGIBLE * energy_about(model, w, pair, pair_energy)


# --- start of an attempt


@kernel
def begin_contact(
    run: Run, state: MotionState, contact: ContactState, friction: FrictionState, impulses: ImpulsiveContact
):
    """Per world: the impulsive pairs of this attempt, and the initial accelerations without them."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    # kind of each pair, and the initial theta, bracket and weight of the search
    if lane == 0:
        run.ctl[w].round = 0
        run.ctl[w].even = 0
        run.ctl[w].reweighed = 0
    pair = lane
    while pair < model.pairs.count:
        kind = int(0)
        if run.ctl[w].mode == k.DYNAMIC:
            if model.modes.dynamic_count > 0:
                if run.ctl[w].impulsive == k.IMPULSIVE:
                    kind = 1
            elif run.ctl[w].again != 0:
                kind = contact.impulsive[w, pair]
            elif not is_closed(contact.pair_force, w, pair, 0):
                kind = k.IMPULSIVE
            elif is_idle(model, w, pair, contact.pair_energy[w, pair, 0], contact.pair_energy):
                kind = k.IDLE
        contact.impulsive[w, pair] = kind
        if model.modes.dynamic_count > 0 or run.ctl[w].again == 0:
            impulses.theta[w, pair] = real(1.0)
        impulses.bracket[w, pair, 0] = real(0.0)
        impulses.bracket[w, pair, 1] = real(1.0)
        impulses.bracket[w, pair, 2] = real(0.0)
        impulses.bracket[w, pair, 3] = real(0.0)
        impulses.bracket[w, pair, 4] = real(-1.0)
        impulses.bracket[w, pair, 5] = real(-1.0)
        impulses.bracket[w, pair, 7] = real(-1.0)
        impulses.weight[w, pair] = real(1.0)
        if kind != 0:
            impulses.weight[w, pair] = weight_of(retained_kappa(model, run.clk, w), impulses.theta[w, pair])
        pair += wp.block_dim()
    sync()
    # initial accelerations of bodies, then of modes, minus the forces and the memory of impulsive pairs
    rubs = model.capacity.cells > 0
    b = lane
    while b < model.bodies.count:
        f = vec3(real(0.0), real(0.0), real(0.0))
        t = f
        m_f = f
        m_t = f
        pair = int(0)
        while pair < model.pairs.count:
            if contact.impulsive[w, pair] != 0:
                f_p, t_p = force_on(model, contact.pair_force, w, pair, 0, b)
                f += f_p
                t += t_p
                f_p, t_p = force_on(model, contact.memory, w, pair, 0, b)
                m_f += f_p
                m_t += t_p
                if rubs:
                    f_p, t_p = force_on(model, friction.friction_force, w, pair, 0, b)
                    f += f_p
                    t += t_p
                    f_p, t_p = force_on(model, friction.friction_memory, w, pair, 0, b)
                    m_f += f_p
                    m_t += t_p
            pair += 1
        soft = wp.inverse(model.bodies.inertia[b])
        impulses.v_rate0[w, b] = state.v_rate[w, b] - f / model.bodies.mass[b]
        impulses.omega_rate0[w, b] = state.omega_rate[w, b] - soft * t
        if run.ctl[w].trapezoidal == 0:
            impulses.v_alg0[w, b] = state.v_alg[w, b] - m_f / model.bodies.mass[b]
            impulses.omega_alg0[w, b] = state.omega_alg[w, b] - soft * m_t
        else:
            impulses.v_alg0[w, b] = impulses.v_rate0[w, b]
            impulses.omega_alg0[w, b] = impulses.omega_rate0[w, b]
        b += wp.block_dim()
    n = lane
    while n < model.modes.count:
        f_n = real(0.0)
        m_n = real(0.0)
        pair = int(0)
        while pair < model.pairs.count:
            at = modal_place(model, pair, n)
            if contact.impulsive[w, pair] != 0 and at >= 0:
                f_n += whole(model, contact.pair_modal, friction.friction_modal, w, pair, 0, at)
                m_n += whole(model, contact.modal_memory, friction.modal_friction_memory, w, pair, 0, at)
            pair += 1
        impulses.qd_rate0[w, n] = state.qd_rate[w, n] - f_n
        if run.ctl[w].trapezoidal == 0:
            impulses.qd_alg0[w, n] = state.qd_alg[w, n] - m_n
        else:
            impulses.qd_alg0[w, n] = impulses.qd_rate0[w, n]
        n += wp.block_dim()


# --- within the Newton loop


@kernel
def push_bodies(
    run: Run, trial: Trial, geometry: ContactGeometry, cells: FrictionCells, contact: ContactState,
    impulses: ImpulsiveContact, friction: FrictionState, loads: LoadState, residuals: Residuals,
):  # fmt: skip
    """Per world: contact forces (world axes) and torques (body axes) of the trial state on A, then on B, normal and
    friction; subtracts the forces that act in the step from the residuals."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    rubs = model.capacity.cells > 0
    pair = lane
    while pair < model.pairs.count:
        A = model.surfaces.body[model.pairs.first[pair]]
        B = model.surfaces.body[model.pairs.second[pair]]
        # trial forces on both bodies: normal (part 0), then friction
        for part in range(2):
            if part == 0 or rubs:
                f = vec3(
                    geometry.pair_wrench[w, pair, 0], geometry.pair_wrench[w, pair, 1],
                    geometry.pair_wrench[w, pair, 2],
                )  # fmt: skip
                t = vec3(
                    geometry.pair_wrench[w, pair, 3], geometry.pair_wrench[w, pair, 4],
                    geometry.pair_wrench[w, pair, 5],
                )  # fmt: skip
                if rubs:
                    f_n = vec3(
                        cells.normal_wrench[w, pair, 0], cells.normal_wrench[w, pair, 1],
                        cells.normal_wrench[w, pair, 2],
                    )  # fmt: skip
                    t_n = vec3(
                        cells.normal_wrench[w, pair, 3], cells.normal_wrench[w, pair, 4],
                        cells.normal_wrench[w, pair, 5],
                    )  # fmt: skip
                    if part == 0:
                        f = f_n
                        t = t_n
                    else:
                        f -= f_n
                        t -= t_n
                t_a = wp.transpose(trial.axes[w, A]) * t
                t_b = vec3(real(0.0), real(0.0), real(0.0))  # the ground is fixed
                if B >= 0:
                    t_b = -(wp.transpose(trial.axes[w, B]) * (t + wp.cross(trial.r1[w, A] - trial.r1[w, B], f)))
                for i in range(3):
                    if part == 0:
                        contact.pair_force[w, pair, 1, i] = f[i]
                        contact.pair_force[w, pair, 1, 3 + i] = t_a[i]
                        contact.pair_force[w, pair, 1, 6 + i] = -f[i]
                        contact.pair_force[w, pair, 1, 9 + i] = t_b[i]
                    else:
                        friction.friction_force[w, pair, 1, i] = f[i]
                        friction.friction_force[w, pair, 1, 3 + i] = t_a[i]
                        friction.friction_force[w, pair, 1, 6 + i] = -f[i]
                        friction.friction_force[w, pair, 1, 9 + i] = t_b[i]
        pair += wp.block_dim()
    sync()
    # their effect in the step, lanes over bodies: for impulsive pairs kappa times the mean
    kappa = retained_kappa(model, run.clk, w)
    pair = int(0)
    while pair < model.pairs.count:
        for side in range(2):
            body = model.surfaces.body[surface_of(model, pair, side)]
            if body >= 0 and body % wp.block_dim() == lane:
                for c in range(6):
                    i = 6 * side + c
                    before = whole(model, contact.pair_force, friction.friction_force, w, pair, 0, i)
                    after = whole(model, contact.pair_force, friction.friction_force, w, pair, 1, i)
                    force = after
                    if contact.impulsive[w, pair] != 0:
                        force = kappa * mean_of(impulses.theta[w, pair], before, after)
                    residuals.residual[w, 6 * body + c] = residuals.residual[w, 6 * body + c] - force
        pair += 1
    n = lane
    while n < model.modes.count:
        load = real(0.0)
        acts = real(0.0)
        kappa = mode_kappa(model, run, w, n)
        pair = int(0)
        while pair < model.pairs.count:
            at = modal_place(model, pair, n)
            if at >= 0:
                before = whole(model, contact.pair_modal, friction.friction_modal, w, pair, 0, at)
                after = whole(model, contact.pair_modal, friction.friction_modal, w, pair, 1, at)
                load += after
                force = after
                if contact.impulsive[w, pair] != 0:
                    force = kappa * mean_of(impulses.theta[w, pair], before, after)
                acts += force
            pair += 1
        loads.modal_load[w, 1, n] = load
        residuals.modal_residual[w, n] = residuals.modal_residual[w, n] - acts
        n += wp.block_dim()


@kernel
def compare_receptances(run: Run, impulses: ImpulsiveContact, receptance: wp.array2d(dtype=real)):
    """Per world: kappa sigma^-1 of the modes over kappa of bodies, the response to a contact force without its pair's
    weight; for scenes with dynamic local modes, which have their own kappa."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    n = lane
    while n < model.modes.count:
        factor = real(1.0)
        if run.ctl[w].mode == k.DYNAMIC and run.ctl[w].impulsive == k.IMPULSIVE:
            factor = mode_kappa(model, run, w, n) / retained_kappa(model, run.clk, w)
        impulses.contact_receptance[w, n] = factor * receptance[w, n]
        n += wp.block_dim()


@kernel
def push_further(
    run: Run, contact: ContactState, normal: ContactSolve, fields: ContactFields, impulses: ImpulsiveContact,
    system: RetainedSystem, receptance: wp.array2d(dtype=real),
):  # fmt: skip
    """Per world, lanes over modes: the part of `contact_receptance` missing in the modal increments. Modes with inertia
    terms have it from the retained system (their receptance is 0)."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].impulsive != k.IMPULSIVE or run.ctl[w].mode != k.DYNAMIC:
        return
    first = w * model.modes.count
    n = lane
    while n < model.modes.count:
        impulses.modal_push[first + n] = real(0.0)
        n += wp.block_dim()
    sync()
    push_by_slots(model, run, w, normal, contact, fields, impulses, impulses.modal_push)
    sync()
    n = lane
    while n < model.modes.count:
        excess = impulses.contact_receptance[w, n] - receptance[w, n]
        system.modal_step[first + n] = system.modal_step[first + n] + excess * impulses.modal_push[first + n]
        n += wp.block_dim()
