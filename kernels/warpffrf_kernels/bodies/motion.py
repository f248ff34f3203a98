"""Start of a step, and the motion of bodies and global modes as a function of the step's displacement increments.

Unknowns of a step are the increments `dx = r_1 - r_0` (m), `psi` with `R_1 = R_0 exp(psi^)` (rad) and `dq` (modes).
With the algorithmic acceleration `a` of generalized-alpha (Arnold and Bruels 2007, eq. 17 to 19), for any of the three
kinds of coordinates

    d = h v_0 + h^2 ((1/2 - beta) a_0 + beta a_1),      v_1 = v_0 + h ((1 - gamma) a_0 + gamma a_1),
    (1 - alpha_m) a_1 + alpha_m a_0 = (1 - alpha_f) vdot_1 + alpha_f vdot_0,

so that `a_1`, `v_1`, `vdot_1` are affine in `d` with slopes `1/(beta h^2)`, `VEL = gamma/(beta h)` and
`ACC = (1 - alpha_m)/(beta h^2 (1 - alpha_f))`. Five other uses of the same formulas:

* STATIC (beta = 1, gamma = 0, alphas 0, all rates zero): `vdot_1 = d/h^2`, a proximal step towards the static state;
  motions that are to stay where they are get an inertia of their own (`hold_motions`).
* PROJECT (beta = gamma = 1, alphas 0): one tiny implicit Euler step; its velocity is the given one made consistent with
  joints and drives, in the mass metric.
* START (beta = 1/2, gamma = 1, alphas 0): one tiny step of constant acceleration gives `vdot`, `lambda` and pressures
  (`warpffrf.online.start.accelerations` then takes out the round-off of its size).
* LOADING (a load step, `warpffrf_kernels.step.proximal`): the same of d less what the proximal step before has come to,
  d counted from the beginning of the load step.
* A step that forgets (alphas 0, beta = gamma = 1, no part of a_0 in d): the implicit Euler method, `d = h v_1`, where
  friction in a joint becomes another within the step (`warpffrf_kernels.constraints.joint_friction`).

Modes of kind 1 (HHT) have coefficients of their own in a dynamic step, those of kind 2 the exact step for a linear load
(`exact_step`), in which the load at the end plays the part of the residual and D that of the receptance. The
load of contact keeps no memory where it is impulsive: `impulsive_contact`.

Balance of a body in the floating frame with origin in its centre of mass and constant inertia (linear momentum in world
axes, angular in body axes): `m rddot = F`, `J wdot + w x J w = M`; a mode of unit mass: `qddot + 2 zeta omega qdot +
omega^2 q = f`. What a deforming body adds to these: `inertia`.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import changed, inout, out
from warpffrf_kernels.core.control import Clock, Control
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
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.rotation import exponential, hat, matrix, tangent_inverse
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, quat, real, vec3

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def first_tau(ctl: wp.array(dtype=Control), clk: wp.array(dtype=Clock), w: int) -> real:
    """The first proximal step of a load step [s]."""
    return clk[w].tau * wp.pow(real(0.01), real(ctl[w].careful))


@wp.kernel
def begin_step(
    models: wp.array(dtype=Model),
    coefficients: wp.array2d(dtype=real),
    local_coefficients: wp.array2d(dtype=real),
    budget: wp.array(dtype=int),
    ctl: inout(wp.array(dtype=Control)),
    clk: inout(wp.array(dtype=Clock)),
):
    """Per world: step size, end time and coefficients (alpha_m, alpha_f, beta, gamma) of this attempt."""
    w = wp.tid()
    ctl[w].run = 0
    ctl[w].attempt = 0
    ctl[w].accept = 0
    ctl[w].record = 0
    if ctl[w].status != 0 or ctl[w].step >= ctl[w].target or budget[w] <= 0:
        return
    ctl[w].run = 1
    ctl[w].attempt = 1
    ctl[w].moved = 1
    ctl[w].reassemble = 1
    ctl[w].refresh = 1
    ctl[w].recenter = 0
    ctl[w].iteration = 0
    ctl[w].inner = 0
    ctl[w].changes = 0
    ctl[w].failure = 0
    ctl[w].slots = 0
    ctl[w].fresh = 0
    ctl[w].touched = ctl[w].active
    h_user = clk[w].user_step
    fraction = wp.pow(real(0.5), real(ctl[w].level))
    h = h_user * fraction
    am = real(0.0)
    af = real(0.0)
    beta = real(1.0)
    gamma = real(0.0)
    clk[w].next_time = clk[w].time
    ctl[w].trapezoidal = 0
    ctl[w].round = 0
    if ctl[w].mode == k.DYNAMIC or ctl[w].mode == k.LOADING:
        clk[w].next_time = clk[w].start_time + h_user * (real(ctl[w].step) + real(ctl[w].sub + 1) * fraction)
    if ctl[w].mode == k.DYNAMIC:
        am = coefficients[w, 0]
        af = coefficients[w, 1]
        beta = coefficients[w, 2]
        gamma = coefficients[w, 3]
        # see `impulsive_contact`
        if ctl[w].again != 0 and (ctl[w].shaken == 0 or models[w].elements[0].layers.count > 0):
            ctl[w].trapezoidal = 1
            am = real(0.0)
            af = real(0.0)
            beta = real(0.25)
            gamma = real(0.5)
    if ctl[w].mode == k.START or ctl[w].mode == k.PROJECT:
        gamma = real(1.0)
        clk[w].next_time = clk[w].time + h
        if ctl[w].mode == k.START:
            beta = real(0.5)
    clk[w].h = h
    clk[w].outer = coefficients_from(am, af, beta, gamma, h)
    ctl[w].turned = 0
    if ctl[w].mode == k.LOADING:
        clk[w].outer = coefficients_from(am, af, beta, gamma, first_tau(ctl, clk, w))
        ctl[w].forget = 1  # friction of joints may become another within the step
    if ctl[w].mode == k.DYNAMIC and ctl[w].forget != 0:
        clk[w].outer = forgetful(h)
    if ctl[w].mode == k.DYNAMIC:
        am = local_coefficients[w, 0]
        af = local_coefficients[w, 1]
        beta = local_coefficients[w, 2]
        gamma = local_coefficients[w, 3]
    clk[w].local = coefficients_from(am, af, beta, gamma, h)


@wp.func
def write_exact(stiffness: real, damping: real, h: real, table: wp.array3d(dtype=real), w: int, m: int):
    """Coefficients of `exact_step` for mode m: h, then A, B, C, D of the displacement and those of the velocity. They
    are kept until the step changes."""
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
def driven_step(
    ctl: wp.array(dtype=Control), table: wp.array3d(dtype=real), w: int, m: int, q0: real, v0: real, f0: real
):
    """`exact_step`, and where contact is impulsive the same for the load f1 all through the step."""
    held, D, slid, S = exact_step(table, w, m, q0, v0, f0)
    if ctl[w].impulsive == k.IMPULSIVE:
        held -= table[w, m, 3] * f0
        D += table[w, m, 3]
        slid -= table[w, m, 7] * f0
        S += table[w, m, 7]
    return held, D, slid, S


@wp.kernel
def predict_bodies(
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    v: wp.array2d(dtype=vec3),
    v_rate: wp.array2d(dtype=vec3),
    v_alg: wp.array2d(dtype=vec3),
    omega: wp.array2d(dtype=vec3),
    omega_rate: wp.array2d(dtype=vec3),
    omega_alg: wp.array2d(dtype=vec3),
    dx: out(wp.array2d(dtype=vec3)),
    psi: out(wp.array2d(dtype=vec3)),
):
    w, lane = wp.tid()
    if ctl[w].run == 0 or ctl[w].again != 0:  # an attempt that repeats one starts from where that has led
        return
    h = clk[w].h
    rule = clk[w].outer
    b = lane
    while b < v.shape[1]:
        dx[w, b] = predicted(h, rule, v[w, b], v_rate[w, b], v_alg[w, b])
        psi[w, b] = predicted(h, rule, omega[w, b], omega_rate[w, b], omega_alg[w, b])
        b += wp.block_dim()


@wp.kernel
def predict_modes(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    q: wp.array2d(dtype=real),
    qd: wp.array2d(dtype=real),
    qd_rate: wp.array2d(dtype=real),
    qd_alg: wp.array2d(dtype=real),
    modal_load: wp.array3d(dtype=real),
    dq: out(wp.array2d(dtype=real)),
    exact: inout(wp.array3d(dtype=real)),
):
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0:
        return
    m = lane
    while m < qd.shape[1]:
        if ctl[w].again == 0:
            rule = coefficients_of(clk, w, rule_of(model, ctl, clk, w, m))
            p = predicted(clk[w].h, rule, vec3(qd[w, m]), vec3(qd_rate[w, m]), vec3(qd_alg[w, m]))
            dq[w, m] = p[0]
        if rule_of(model, ctl, clk, w, m) == EXACT:  # the load of before, kept
            f0 = modal_load[w, 0, m]
            if exact[w, m, 0] != clk[w].h:
                write_exact(model.modes.stiffness[m], model.modes.damping[m], clk[w].h, exact, w, m)
            held, D, slid, S = driven_step(ctl, exact, w, m, q[w, m], qd[w, m], f0)
            dq[w, m] = held + D * f0 - q[w, m]
        m += wp.block_dim()


@wp.kernel
def move_bodies(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    r: wp.array2d(dtype=vec3),
    p: wp.array2d(dtype=quat),
    v: wp.array2d(dtype=vec3),
    v_rate: wp.array2d(dtype=vec3),
    v_alg: wp.array2d(dtype=vec3),
    omega: wp.array2d(dtype=vec3),
    omega_rate: wp.array2d(dtype=vec3),
    omega_alg: wp.array2d(dtype=vec3),
    dx: wp.array2d(dtype=vec3),
    psi: wp.array2d(dtype=vec3),
    centre_dx: wp.array2d(dtype=vec3),
    centre_psi: wp.array2d(dtype=vec3),
    r1: out(wp.array2d(dtype=vec3)),
    p1: out(wp.array2d(dtype=quat)),
    axes: out(wp.array2d(dtype=mat33)),
    v1: out(wp.array2d(dtype=vec3)),
    v1_rate: out(wp.array2d(dtype=vec3)),
    omega1: out(wp.array2d(dtype=vec3)),
    omega1_rate: out(wp.array2d(dtype=vec3)),
    residual: out(wp.array2d(dtype=real)),
    tangent: out(wp.array3d(dtype=real)),
    psi_inverse: out(wp.array2d(dtype=mat33)),
):
    """Trial state of each body, its unbalanced inertia and gravity forces, and their tangent (blocks of `tangent`)."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    h = clk[w].h
    rule = clk[w].outer
    b = lane
    while b < model.bodies.count:
        a_t = acceleration_of(ctl[w].mode, h, rule, dx[w, b], centre_dx[w, b], v[w, b], v_alg[w, b])
        a_r = acceleration_of(ctl[w].mode, h, rule, psi[w, b], centre_psi[w, b], omega[w, b], omega_alg[w, b])
        vel = velocity_of(h, rule, v[w, b], v_alg[w, b], a_t)
        spin = velocity_of(h, rule, omega[w, b], omega_alg[w, b], a_r)
        acc = rate_of(rule, v_rate[w, b], v_alg[w, b], a_t)
        spin_rate = rate_of(rule, omega_rate[w, b], omega_alg[w, b], a_r)
        q1 = wp.normalize(p[w, b] * exponential(psi[w, b]))
        r1[w, b] = r[w, b] + dx[w, b]
        p1[w, b] = q1
        axes[w, b] = matrix(q1)
        v1[w, b] = vel
        v1_rate[w, b] = acc
        omega1[w, b] = spin
        omega1_rate[w, b] = spin_rate
        m = model.bodies.mass[b]
        J = model.bodies.inertia[b]
        f = m * acc - m * model.gravity
        t = J * spin_rate + wp.cross(spin, J * spin)
        Ti = tangent_inverse(psi[w, b])
        psi_inverse[w, b] = Ti
        S = (clk[w].outer.acc * J + clk[w].outer.vel * (hat(spin) * J - hat(J * spin))) * Ti
        o = 6 * b
        for i in range(3):
            residual[w, o + i] = f[i]
            residual[w, o + 3 + i] = t[i]
            for j in range(3):
                tangent[w, o + i, o + j] = real(0.0)
                tangent[w, o + i, o + 3 + j] = real(0.0)
                tangent[w, o + 3 + i, o + j] = real(0.0)
                tangent[w, o + 3 + i, o + 3 + j] = S[i, j]
            tangent[w, o + i, o + i] = m * clk[w].outer.acc
        b += wp.block_dim()


@wp.kernel
def hold_motions(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    dx: wp.array2d(dtype=vec3),
    psi: wp.array2d(dtype=vec3),
    centre_dx: wp.array2d(dtype=vec3),
    centre_psi: wp.array2d(dtype=vec3),
    hold: wp.array3d(dtype=real),
    hold_count: wp.array(dtype=int),
    residual: changed(wp.array2d(dtype=real)),
):
    """Per world, in static steps: the force n (n.d) of each held motion n."""
    w = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0 or not is_static(ctl, w):
        return
    h = int(0)
    while h < hold_count[w]:
        along = real(0.0)
        b = int(0)
        while b < model.bodies.count:
            d = dx[w, b]
            turn = psi[w, b]
            if ctl[w].mode == k.LOADING:
                d -= centre_dx[w, b]
                turn -= centre_psi[w, b]
            for c in range(3):
                along += hold[w, h, 6 * b + c] * d[c] + hold[w, h, 6 * b + 3 + c] * turn[c]
            b += 1
        i = int(0)
        while i < 6 * model.bodies.count:
            residual[w, i] = residual[w, i] + hold[w, h, i] * along
            i += 1
        h += 1


@wp.kernel
def move_modes(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    q: wp.array2d(dtype=real),
    qd: wp.array2d(dtype=real),
    qd_rate: wp.array2d(dtype=real),
    qd_alg: wp.array2d(dtype=real),
    modal_load: wp.array3d(dtype=real),
    exact: wp.array3d(dtype=real),
    dq: wp.array2d(dtype=real),
    centre_dq: wp.array2d(dtype=real),
    q1: inout(wp.array2d(dtype=real)),
    qd1: inout(wp.array2d(dtype=real)),
    qd1_rate: out(wp.array2d(dtype=real)),
    modal_residual: out(wp.array2d(dtype=real)),
    receptance: out(wp.array2d(dtype=real)),
):
    """Trial state of each global mode, its unbalanced force, and the inverse of its (diagonal) tangent."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    m = lane
    while m < model.modes.count:
        c = model.modes.damping[m]
        stiffness = model.modes.stiffness[m]
        q1[w, m] = q[w, m] + dq[w, m]
        if rule_of(model, ctl, clk, w, m) == EXACT:
            held, D, slid, S = driven_step(ctl, exact, w, m, q[w, m], qd[w, m], modal_load[w, 0, m])
            f1 = (q1[w, m] - held) / D
            qd1[w, m] = slid + S * f1
            qd1_rate[w, m] = f1 - c * qd1[w, m] - stiffness * q1[w, m]
            modal_residual[w, m] = f1
            receptance[w, m] = D
        else:
            h = clk[w].h
            rule = coefficients_of(clk, w, rule_of(model, ctl, clk, w, m))
            centre = vec3(centre_dq[w, m])
            a = acceleration_of(ctl[w].mode, h, rule, vec3(dq[w, m]), centre, vec3(qd[w, m]), vec3(qd_alg[w, m]))
            vel = velocity_of(h, rule, vec3(qd[w, m]), vec3(qd_alg[w, m]), a)
            rate = rate_of(rule, vec3(qd_rate[w, m]), vec3(qd_alg[w, m]), a)
            qd1[w, m] = vel[0]
            qd1_rate[w, m] = rate[0]
            modal_residual[w, m] = rate[0] + c * vel[0] + stiffness * q1[w, m]
            receptance[w, m] = real(1.0) / (rule.acc + c * rule.vel + stiffness)
        m += wp.block_dim()
