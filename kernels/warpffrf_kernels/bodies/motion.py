"""Start of a step, and the motion of bodies and global modes as a function of the step's displacement increments.

Unknowns of a step are the increments `dx = r_1 - r_0` (m), `psi` with `R_1 = R_0 exp(psi^)` (rad) and `dq` (modes).
With the algorithmic acceleration `a` of generalized-alpha (Arnold and Bruels 2007, eq. 17 to 19), for any of the three
kinds of coordinates

    d = h v_0 + h^2 ((1/2 - beta) a_0 + beta a_1),      v_1 = v_0 + h ((1 - gamma) a_0 + gamma a_1),
    (1 - alpha_m) a_1 + alpha_m a_0 = (1 - alpha_f) vdot_1 + alpha_f vdot_0,

so that `a_1`, `v_1`, `vdot_1` are affine in `d` with slopes `1/(beta h^2)`, `VEL = gamma/(beta h)` and
`ACC = (1 - alpha_m)/(beta h^2 (1 - alpha_f))`. Five other uses of the same formulas:

* STATIC (beta = 1, gamma = 0, alphas 0, all rates zero): `vdot_1 = d/h^2`, a proximal step towards the static state;
  motions that must not change get an inertia of their own (`hold_motions`).
* PROJECT (beta = gamma = 1, alphas 0): one tiny implicit Euler step; its velocity is the given one made consistent with
  joints and drives, in the mass metric.
* START (beta = 1/2, gamma = 1, alphas 0): one tiny step of constant acceleration gives `vdot`, `lambda` and pressures
  (`warpffrf.online.start.accelerations` then removes the round-off of its size).
* LOADING (a load step, `warpffrf_kernels.step.proximal`): the same with d minus the result of the previous proximal
  step, d measured from the start of the load step.
* A step without old accelerations (alphas 0, beta = gamma = 1, no part of a_0 in d): the implicit Euler method,
  `d = h v_1`, where friction in a joint changes its state in the step (`warpffrf_kernels.constraints.joint_friction`).

Modes of kind 1 (HHT) have coefficients of their own in a dynamic step, those of kind 2 the exact step for a linear load
(`exact_step`), in which the load at the end corresponds to the residual and D to the receptance. An impulsive contact
load has no history: `impulsive_contact`.

**Prediction.** An attempt starts from the increment of constant acceleration, or from that of the last step, whichever
was nearer to the last one found, for each coordinate by itself: the accelerations of stiff coordinates, which follow
their loads, oscillate from step to step; their increments do not.

Balance of a body in the floating frame with origin in its centre of mass and constant inertia (linear momentum in world
axes, angular in body axes): `m rddot = F`, `J wdot + w x J w = M`; a mode of unit mass: `qddot + 2 zeta omega qdot +
omega^2 q = f`. Additional terms of a deforming body: `inertia`.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.integration import (
    EXACT,
    acceleration_of,
    coefficients_from,
    coefficients_of,
    forgetful,
    is_static,
    predicted,
    rate_of,
    rule_of,
    velocity_of,
)
from warpffrf_kernels.core.lanes import total
from warpffrf_kernels.core.rotation import exponential, hat, matrix, tangent_inverse
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.core.scratch import ImpulsiveContact, Residuals, RetainedSystem, Trial
from warpffrf_kernels.core.state import LoadState, MotionState

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def first_tau(run: Run, w: int) -> real:
    """The first proximal step of a load step [s]."""
    return run.clk[w].tau * wp.pow(real(0.01), real(run.ctl[w].proximal_level))


@kernel
def begin_step(run: Run):
    """Per world: step size, end time and coefficients (alpha_m, alpha_f, beta, gamma) of this attempt."""
    w = wp.tid()
    run.ctl[w].run = 0
    run.ctl[w].attempt = 0
    run.ctl[w].accept = 0
    run.ctl[w].record = 0
    if run.ctl[w].status != 0 or run.ctl[w].step >= run.ctl[w].target or run.budget[w] <= 0:
        return
    run.ctl[w].run = 1
    run.ctl[w].attempt = 1
    run.ctl[w].moved = 1
    run.ctl[w].reassemble = 1
    run.ctl[w].refresh = 1
    run.ctl[w].recenter = 0
    run.ctl[w].iteration = 0
    run.ctl[w].inner = 0
    run.ctl[w].changes = 0
    run.ctl[w].failure = 0
    run.ctl[w].slots = 0
    run.ctl[w].fresh = 0
    run.ctl[w].touched = run.ctl[w].active
    h_user = run.clk[w].user_step
    fraction = wp.pow(real(0.5), real(run.ctl[w].level))
    h = h_user * fraction
    am = real(0.0)
    af = real(0.0)
    beta = real(1.0)
    gamma = real(0.0)
    run.clk[w].next_time = run.clk[w].time
    run.ctl[w].trapezoidal = 0
    run.ctl[w].round = 0
    if run.ctl[w].mode == k.DYNAMIC or run.ctl[w].mode == k.LOADING:
        run.clk[w].next_time = run.clk[w].start_time + h_user * (
            real(run.ctl[w].step) + real(run.ctl[w].sub + 1) * fraction
        )
    if run.ctl[w].mode == k.DYNAMIC:
        am = run.coefficients[w, 0]
        af = run.coefficients[w, 1]
        beta = run.coefficients[w, 2]
        gamma = run.coefficients[w, 3]
        # see `impulsive_contact`
        if run.ctl[w].again != 0 and (run.ctl[w].shaken == 0 or run.models[w].elements[0].layers.count > 0):
            run.ctl[w].trapezoidal = 1
            am = real(0.0)
            af = real(0.0)
            beta = real(0.25)
            gamma = real(0.5)
    if run.ctl[w].mode == k.START or run.ctl[w].mode == k.PROJECT:
        gamma = real(1.0)
        run.clk[w].next_time = run.clk[w].time + h
        if run.ctl[w].mode == k.START:
            beta = real(0.5)
    run.clk[w].h = h
    run.clk[w].retained = coefficients_from(am, af, beta, gamma, h)
    run.ctl[w].friction_changed = 0
    if run.ctl[w].mode == k.LOADING:
        run.clk[w].retained = coefficients_from(am, af, beta, gamma, first_tau(run, w))
        run.ctl[w].restart = 1  # the friction state of joints may change in the step
    if run.ctl[w].mode == k.DYNAMIC and run.ctl[w].restart != 0:
        run.clk[w].retained = forgetful(h)
    if run.ctl[w].mode == k.DYNAMIC:
        am = run.local_coefficients[w, 0]
        af = run.local_coefficients[w, 1]
        beta = run.local_coefficients[w, 2]
        gamma = run.local_coefficients[w, 3]
    run.clk[w].local = coefficients_from(am, af, beta, gamma, h)


@wp.func
def write_exact(stiffness: real, damping: real, h: real, table: wp.array3d(dtype=real), w: int, m: int):
    """Coefficients of `exact_step` for mode m: h, then A, B, C, D of the displacement and those of the velocity. They
    are stored until the step changes."""
    one = real(1.0)
    omega = wp.sqrt(stiffness)
    zeta = real(0.5) * damping / omega
    root = wp.sqrt(one - zeta * zeta)
    turned = omega * root
    x = turned * h
    e = wp.exp(-zeta * omega * h)
    s = e * wp.sin(x)
    c = e * wp.cos(x)
    z = zeta / root
    g = real(2.0) * zeta / (omega * h)
    table[w, m, 0] = h
    table[w, m, 1] = z * s + c
    table[w, m, 2] = s / turned
    table[w, m, 3] = (g + ((one - real(2.0) * zeta * zeta) / x - z) * s - (one + g) * c) / stiffness
    table[w, m, 4] = (one - g + (real(2.0) * zeta * zeta - one) / x * s + g * c) / stiffness
    table[w, m, 5] = -omega / root * s
    table[w, m, 6] = c - z * s
    table[w, m, 7] = (-one / h + (omega / root + z / h) * s + c / h) / stiffness
    table[w, m, 8] = (one - z * s - c) / (stiffness * h)


@wp.func
def exact_step(table: wp.array3d(dtype=real), w: int, m: int, q0: real, v0: real, f0: real):
    """q1 = held + D f1 and q1' = slid + S f1 of q'' + c q' + omega^2 q = f0 + (f1 - f0) t/h: held, D, slid, S."""
    held = table[w, m, 1] * q0 + table[w, m, 2] * v0 + table[w, m, 3] * f0
    slid = table[w, m, 5] * q0 + table[w, m, 6] * v0 + table[w, m, 7] * f0
    return held, table[w, m, 4], slid, table[w, m, 8]


@wp.func
def driven_step(run: Run, trial: Trial, w: int, m: int, q0: real, v0: real, f0: real):
    """`exact_step`, and if contact is impulsive the same for the load f1 throughout the step."""
    held, D, slid, S = exact_step(trial.exact, w, m, q0, v0, f0)
    if run.ctl[w].impulsive == k.IMPULSIVE:
        held -= trial.exact[w, m, 3] * f0
        D += trial.exact[w, m, 3]
        slid -= trial.exact[w, m, 7] * f0
        S += trial.exact[w, m, 7]
    return held, D, slid, S


@kernel
def predict_bodies(run: Run, state: MotionState, impulses: ImpulsiveContact, trial: Trial):
    """Lanes over bodies: increments from which the attempt starts."""
    w, lane = wp.tid()
    if run.ctl[w].run == 0 or run.ctl[w].again != 0:  # a repeated attempt starts from the result of the previous one
        return
    h = run.clk[w].h
    rule = run.clk[w].retained
    b = lane
    while b < state.v.shape[1]:
        trial.dx[w, b] = predicted(h, rule, state.v[w, b], impulses.v_rate0[w, b], impulses.v_alg0[w, b])
        trial.psi[w, b] = predicted(h, rule, state.omega[w, b], impulses.omega_rate0[w, b], impulses.omega_alg0[w, b])
        if run.ctl[w].mode == k.DYNAMIC and state.steady[w, b, 0] != 0:
            trial.dx[w, b] = h * state.v_mean[w, b]
        if run.ctl[w].mode == k.DYNAMIC and state.steady[w, b, 1] != 0:
            trial.psi[w, b] = h * state.omega_mean[w, b]
        b += wp.block_dim()


@kernel
def predict_modes(run: Run, state: MotionState, impulses: ImpulsiveContact, loads: LoadState, trial: Trial):
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    m = lane
    while m < state.qd.shape[1]:
        if run.ctl[w].again == 0:
            rule = coefficients_of(run.clk, w, rule_of(model, run, w, m))
            p = predicted(
                run.clk[w].h, rule, vec3(state.qd[w, m]), vec3(impulses.qd_rate0[w, m]), vec3(impulses.qd_alg0[w, m])
            )
            trial.dq[w, m] = p[0]
            if run.ctl[w].mode == k.DYNAMIC and state.steady_mode[w, m] != 0:
                trial.dq[w, m] = run.clk[w].h * state.qd_mean[w, m]
        if rule_of(model, run, w, m) == EXACT:  # the previous load, held constant
            f0 = loads.modal_load[w, 0, m]
            if trial.exact[w, m, 0] != run.clk[w].h:
                write_exact(model.modes.stiffness[m], model.modes.damping[m], run.clk[w].h, trial.exact, w, m)
            held, D, slid, S = driven_step(run, trial, w, m, state.q[w, m], state.qd[w, m], f0)
            trial.dq[w, m] = held + D * f0 - state.q[w, m]
        m += wp.block_dim()


@kernel
def move_bodies(
    run: Run, state: MotionState, impulses: ImpulsiveContact, trial: Trial, residuals: Residuals, system: RetainedSystem
):
    """Trial state of each body, its unbalanced inertia and gravity forces, and their tangent (blocks of `tangent`)."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    h = run.clk[w].h
    rule = run.clk[w].retained
    b = lane
    while b < model.bodies.count:
        a_t = acceleration_of(
            run.ctl[w].mode, h, rule, trial.dx[w, b], trial.centre_dx[w, b], state.v[w, b], impulses.v_alg0[w, b]
        )
        a_r = acceleration_of(
            run.ctl[w].mode, h, rule, trial.psi[w, b], trial.centre_psi[w, b], state.omega[w, b],
            impulses.omega_alg0[w, b],
        )  # fmt: skip
        vel = velocity_of(h, rule, state.v[w, b], impulses.v_alg0[w, b], a_t)
        spin = velocity_of(h, rule, state.omega[w, b], impulses.omega_alg0[w, b], a_r)
        acc = rate_of(rule, impulses.v_rate0[w, b], impulses.v_alg0[w, b], a_t)
        spin_rate = rate_of(rule, impulses.omega_rate0[w, b], impulses.omega_alg0[w, b], a_r)
        q1 = wp.normalize(state.p[w, b] * exponential(trial.psi[w, b]))
        trial.r1[w, b] = state.r[w, b] + trial.dx[w, b]
        trial.p1[w, b] = q1
        trial.axes[w, b] = matrix(q1)
        trial.v1[w, b] = vel
        trial.v1_rate[w, b] = acc
        trial.omega1[w, b] = spin
        trial.omega1_rate[w, b] = spin_rate
        m = model.bodies.mass[b]
        J = model.bodies.inertia[b]
        f = m * acc - m * model.gravity
        t = J * spin_rate + wp.cross(spin, J * spin)
        Ti = tangent_inverse(trial.psi[w, b])
        trial.psi_inverse[w, b] = Ti
        S = (run.clk[w].retained.acc * J + run.clk[w].retained.vel * (hat(spin) * J - hat(J * spin))) * Ti
        o = 6 * b
        for i in range(3):
            residuals.residual[w, o + i] = f[i]
            residuals.residual[w, o + 3 + i] = t[i]
            for j in range(3):
                system.tangent[w, o + i, o + j] = real(0.0)
                system.tangent[w, o + i, o + 3 + j] = real(0.0)
                system.tangent[w, o + 3 + i, o + j] = real(0.0)
                system.tangent[w, o + 3 + i, o + 3 + j] = S[i, j]
            system.tangent[w, o + i, o + i] = m * run.clk[w].retained.acc
        b += wp.block_dim()


@kernel
def hold_motions(run: Run, trial: Trial, system: RetainedSystem, residuals: Residuals):
    """Per world, lanes over bodies, then over rows, in static steps: the force n (n.d) of each constrained motion n."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not is_static(run.ctl, w):
        return
    h = int(0)
    while h < system.hold_count[w]:
        along = real(0.0)
        b = lane
        while b < model.bodies.count:
            d = trial.dx[w, b]
            turn = trial.psi[w, b]
            if run.ctl[w].mode == k.LOADING:
                d -= trial.centre_dx[w, b]
                turn -= trial.centre_psi[w, b]
            for c in range(3):
                along += system.hold[w, h, 6 * b + c] * d[c] + system.hold[w, h, 6 * b + 3 + c] * turn[c]
            b += wp.block_dim()
        along = total(along)
        i = lane
        while i < 6 * model.bodies.count:
            residuals.residual[w, i] = residuals.residual[w, i] + system.hold[w, h, i] * along
            i += wp.block_dim()
        h += 1


@kernel
def move_modes(
    run: Run, state: MotionState, impulses: ImpulsiveContact, loads: LoadState, trial: Trial, residuals: Residuals,
    q1: wp.array2d(dtype=real), receptance: wp.array2d(dtype=real),
):  # fmt: skip
    """Trial state of each global mode, its unbalanced force, and the inverse of its (diagonal) tangent."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    m = lane
    while m < model.modes.count:
        c = model.modes.damping[m]
        stiffness = model.modes.stiffness[m]
        q1[w, m] = state.q[w, m] + trial.dq[w, m]
        if rule_of(model, run, w, m) == EXACT:
            held, D, slid, S = driven_step(run, trial, w, m, state.q[w, m], state.qd[w, m], loads.modal_load[w, 0, m])
            f1 = (q1[w, m] - held) / D
            trial.qd1[w, m] = slid + S * f1
            trial.qd1_rate[w, m] = f1 - c * trial.qd1[w, m] - stiffness * q1[w, m]
            residuals.modal_residual[w, m] = f1
            receptance[w, m] = D
        else:
            h = run.clk[w].h
            rule = coefficients_of(run.clk, w, rule_of(model, run, w, m))
            centre = vec3(trial.centre_dq[w, m])
            a = acceleration_of(
                run.ctl[w].mode, h, rule, vec3(trial.dq[w, m]), centre, vec3(state.qd[w, m]),
                vec3(impulses.qd_alg0[w, m]),
            )  # fmt: skip
            vel = velocity_of(h, rule, vec3(state.qd[w, m]), vec3(impulses.qd_alg0[w, m]), a)
            rate = rate_of(rule, vec3(impulses.qd_rate0[w, m]), vec3(impulses.qd_alg0[w, m]), a)
            trial.qd1[w, m] = vel[0]
            trial.qd1_rate[w, m] = rate[0]
            residuals.modal_residual[w, m] = rate[0] + c * vel[0] + stiffness * q1[w, m]
            receptance[w, m] = real(1.0) / (rule.acc + c * rule.vel + stiffness)
        m += wp.block_dim()
