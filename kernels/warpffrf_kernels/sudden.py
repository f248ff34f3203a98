r"""Contact that comes and goes suddenly, on modes with inertia: its force acts in one step and is then forgotten.

A face that carries mass meets a surface that hardly yields: unlike quasi-static local modes, dynamic ones leave contact
next to no compliance (D_rest), and what stops the face in a step is a force of the size of an impulse over h. The
integrators of `motion` remember forces, in a_0 and vdot_0: of a force f that acts at the end of one step only,

    v_1 = v_0 + gamma h f/m,      v_2 = v_1 + (1 - gamma) h f/m,

the second part comes after contact has opened. A face that reaches the surface with speed V after the part t of a step
needs f/m = V (1 - t)/(beta h) to be there at its end; both parts are up to V/beta, 4 V for the trapezoidal rule, where
2 V is all that an elastic impact takes. Halving the step changes none of this. After Kane, Repetto, Ortiz and Marsden
(1999), and like schemes that keep impulses out of the recursion of generalized-alpha (Bruels, Acary and Cardona 2014),
the contact force s at the end of an *impulsive* step acts all through it and stays out of the accelerations. With
those, a and vdot, without contact, and w = M^-1 J^T s,

    d = h v_0 + h^2 ((1/2 - beta) a_0 + beta a_1 + b w),
    v_1 = v_0 + h ((1 - gamma) a_0 + gamma a_1 + w),           M vdot_1 = F_1, contact left out.

**The weight b.** 1/2 keeps what is pressed at rest, a_0 = a_1 = -w, d = v_1 = 0, and makes v_1 = -v_0 where a rigid
surface holds a face; beta/gamma damps that alternation, v_1 = -(gamma/beta - 1) v_0, and gives what is pressed the
velocity -h (b - 1/2) w, a kinetic energy of ((b - 1/2) omega h)^2 times the strain energy. Hence

    b = 1/2 + (beta/gamma - 1/2)/(1 + (omega h)^2),

omega that of a local mode, and for bodies and global modes that of the highest global mode.

**Energy.** For beta = 1/4, gamma = b = 1/2 is d = h (v_0 + v_1)/2, so the work of contact is exactly -s.(g_1 - g_0), g
the gap; where contact closes, g_0 >= 0 and g_1 = -D_rest s, and with the contact energy s.D_rest s/2 nothing is gained
for any h, mass and D_rest. A face comes out with any velocity between plus and minus what it came in with. Numerical
damping adds terms of the order of gamma - 1/2, which may have either sign while contact stays closed (a spectral radius
of 1.0002 for HHT at omega h = 0.45 beside generalized-alpha). The smooth treatment is stable there, and of second
order. So impulsive steps end when contact is calm: the forces of the hats differ from those of the step before by at
most CALM. They begin with the repetition of a step that is not, or in which the integrator gains more than the energy
tolerance. The gate of `commit` holds for both. A step that resolves all modes is not halved for what it loses: that is
the kinetic energy of the faces themselves, which vanishes with more modes, and without the loss they would chatter on
D_rest.

**In the unknowns of `motion`** the above is: its formulas, with a_0 and vdot_0 freed of contact, and a contact force in
the balance that is multiplied by

    kappa = (1 - alpha_m)/(1 - alpha_f) b/beta - c h (1 - gamma b/beta),

c the damping; the formulas' vdot^, a^ and v^ are vdot_1 + (1 - alpha_m)/(1 - alpha_f) (b/beta) w, a_1 + (b/beta) w, and
v_1 - h (1 - gamma b/beta) w. Without c, kappa is one number for bodies and global modes, so that L H L^T stays
symmetric; joints' dampers and gyroscopic forces see v^. A mode with the exact step takes the constant load s all
through the step, kappa = 1, which does exactly the work s.dq. Between impulsive steps the state holds accelerations
without contact; what is recorded has it.
"""

import warp as wp

from warpffrf_kernels import control as k
from warpffrf_kernels.contact_solve import change_of
from warpffrf_kernels.model import Model
from warpffrf_kernels.motion import rule_of
from warpffrf_kernels.scalars import MODULE_OPTIONS, axpy, mat33, real, sync, vec3

wp.set_module_options(MODULE_OPTIONS)


# of the larger contact force: a step in which the forces of the hats change by more does not resolve them
CALM = wp.constant(wp.float64(0.5))


@wp.func
def impulsive(ctl: wp.array2d(dtype=int), w: int) -> bool:
    """Whether contact is sudden in this attempt."""
    return ctl[w, k.MODE] == k.DYNAMIC and ctl[w, k.SUDDEN] == k.IMPULSIVE


@wp.func
def share(c: wp.array2d(dtype=real), w: int, at: int, stiffness: real) -> real:
    """b over beta, of coordinates with omega^2 = stiffness and the coefficients from column `at` on."""
    excess = c[w, at + 2] / c[w, at + 3] - real(0.5)
    b = real(0.5) + excess / (real(1.0) + stiffness * c[w, k.H] * c[w, k.H])
    return b / c[w, at + 2]


@wp.func
def outer_share(model: Model, c: wp.array2d(dtype=real), w: int) -> real:
    """b over beta of bodies and global modes."""
    return share(c, w, k.ALPHA_M, model.outer_frequency * model.outer_frequency)


@wp.func
def kappa_of(c: wp.array2d(dtype=real), w: int, at: int, part: real) -> real:
    """kappa, of b/beta = part."""
    return (real(1.0) - c[w, at]) / (real(1.0) - c[w, at + 1]) * part


@wp.func
def slip_of(c: wp.array2d(dtype=real), w: int, at: int, part: real) -> real:
    """What the velocity has above the formula's, over w [s]."""
    return c[w, k.H] * (real(1.0) - c[w, at + 3] * part)


@wp.func
def mode_share(model: Model, ctl: wp.array2d(dtype=int), clk: wp.array2d(dtype=real), w: int, m: int) -> real:
    """b over beta of mode m; 0 where it steps exactly and needs none."""
    rule = rule_of(model, ctl, clk, w, m)
    part = real(0.0)
    if rule == 0:
        part = outer_share(model, clk, w)
    if rule == 1:
        part = share(clk, w, k.LOCAL, model.stiffness[m])
    return part


@wp.func
def columns_of(model: Model, ctl: wp.array2d(dtype=int), clk: wp.array2d(dtype=real), w: int, m: int) -> int:
    """Where the coefficients of mode m begin."""
    at = int(k.ALPHA_M)
    if rule_of(model, ctl, clk, w, m) == 1:
        at = int(k.LOCAL)
    return at


@wp.func
def mode_kappa(model: Model, ctl: wp.array2d(dtype=int), clk: wp.array2d(dtype=real), w: int, m: int) -> real:
    """kappa of mode m, less what its damper makes of the velocity."""
    part = mode_share(model, ctl, clk, w, m)
    if part == real(0.0):
        return real(1.0)
    at = columns_of(model, ctl, clk, w, m)
    return kappa_of(clk, w, at, part) - model.damping[m] * slip_of(clk, w, at, part)


@wp.func
def push_on(model: Model, pair_force: wp.array4d(dtype=real), w: int, side: int, b: int):
    """Contact force (world axes) and torque (body axes) on body b; side 0: accepted, 1: of the attempt."""
    f = vec3(real(0.0), real(0.0), real(0.0))
    t = vec3(real(0.0), real(0.0), real(0.0))
    pair = int(0)
    while pair < model.pair_count:
        for i in range(2):
            surface = model.pair_first[pair]
            if i == 1:
                surface = model.pair_second[pair]
            if model.surface_body[surface] == b:
                o = 6 * i
                for c in range(3):
                    f[c] = f[c] + pair_force[w, pair, side, o + c]
                    t[c] = t[c] + pair_force[w, pair, side, o + 3 + c]
        pair += 1
    return f, t


@wp.kernel
def add_excess(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    clk: wp.array2d(dtype=real),
    r1: wp.array2d(dtype=vec3),
    axes: wp.array2d(dtype=mat33),
    pair_wrench: wp.array3d(dtype=real),
    modal_load: wp.array3d(dtype=real),
    residual: wp.array2d(dtype=real),
    modal_residual: wp.array2d(dtype=real),
):
    """Per world: kappa - 1 times the contact forces off the residuals, after `contact_fields.add_contact`."""
    w = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0 or not impulsive(ctl, w):
        return
    extra = kappa_of(clk, w, k.ALPHA_M, outer_share(model, clk, w)) - real(1.0)
    pair = int(0)
    while pair < model.pair_count:
        A = model.surface_body[model.pair_first[pair]]
        B = model.surface_body[model.pair_second[pair]]
        f = extra * vec3(pair_wrench[w, pair, 0], pair_wrench[w, pair, 1], pair_wrench[w, pair, 2])
        t = extra * vec3(pair_wrench[w, pair, 3], pair_wrench[w, pair, 4], pair_wrench[w, pair, 5])
        t_a = wp.transpose(axes[w, A]) * t
        for i in range(3):
            residual[w, 6 * A + i] = residual[w, 6 * A + i] - f[i]
            residual[w, 6 * A + 3 + i] = residual[w, 6 * A + 3 + i] - t_a[i]
        if B >= 0:
            t_b = wp.transpose(axes[w, B]) * (t + wp.cross(r1[w, A] - r1[w, B], f))
            for i in range(3):
                residual[w, 6 * B + i] = residual[w, 6 * B + i] + f[i]
                residual[w, 6 * B + 3 + i] = residual[w, 6 * B + 3 + i] + t_b[i]
        pair += 1
    n = int(0)
    while n < model.modal_count:
        excess = mode_kappa(model, ctl, clk, w, n) - real(1.0)
        modal_residual[w, n] = modal_residual[w, n] - excess * modal_load[w, 1, n]
        n += 1


@wp.kernel
def weigh_answers(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    clk: wp.array2d(dtype=real),
    receptance: wp.array2d(dtype=real),
    inverse_transposed: wp.array(dtype=real),
    contact_receptance: wp.array2d(dtype=real),
    contact_inverse: wp.array(dtype=real),
):
    """Per world: kappa sigma^-1 of the modes and kappa H, the answers to a contact force."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0:
        return
    n = lane
    while n < model.modal_count:
        factor = real(1.0)
        if impulsive(ctl, w):
            factor = mode_kappa(model, ctl, clk, w, n)
        contact_receptance[w, n] = factor * receptance[w, n]
        n += wp.block_dim()
    outer = real(1.0)
    if impulsive(ctl, w):
        outer = kappa_of(clk, w, k.ALPHA_M, outer_share(model, clk, w))
    N = model.outer_count
    i = lane
    while i < N * N:
        contact_inverse[w * N * N + i] = outer * inverse_transposed[w * N * N + i]
        i += wp.block_dim()


@wp.kernel
def push_suddenly(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    active: wp.array3d(dtype=int),
    slot_mode: wp.array3d(dtype=int),
    J: wp.array(dtype=real),
    pressure: wp.array3d(dtype=real),
    base: wp.array3d(dtype=real),
    receptance: wp.array2d(dtype=real),
    contact_receptance: wp.array2d(dtype=real),
    push: wp.array(dtype=real),
    modal_step: wp.array(dtype=real),
):
    """Per world, lanes over modes: what the modal increments lack, (kappa - 1) sigma^-1 J^T ds, after
    `contact_solve.modal_increments`. Modes that carry inertia terms have it from the outer system (their receptance is
    0)."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or not impulsive(ctl, w):
        return
    first = w * model.modal_count
    n = lane
    while n < model.modal_count:
        push[first + n] = real(0.0)
        n += wp.block_dim()
    sync()
    slot = int(0)
    while slot < ctl[w, k.SLOTS]:
        change = change_of(w, slot, slot_mode, active, pressure, base)
        if change != real(0.0):
            pair = slot_mode[w, slot, 0]
            start = (w * model.slot_capacity + slot) * model.pair_modes
            A = model.pair_first[pair]
            B = model.pair_second[pair]
            modes_a = model.surface_modal_count[A]
            axpy(modes_a, change, J, start, push, first + model.surface_modal_start[A])
            at = first + model.surface_modal_start[B]
            axpy(model.surface_modal_count[B], change, J, start + modes_a, push, at)
        slot += 1
    sync()
    n = lane
    while n < model.modal_count:
        excess = contact_receptance[w, n] - receptance[w, n]
        modal_step[first + n] = modal_step[first + n] + excess * push[first + n]
        n += wp.block_dim()


@wp.kernel
def find_restless(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    area: wp.array3d(dtype=real),
    pressure: wp.array3d(dtype=real),
    pressure_before: wp.array3d(dtype=real),
    offset: wp.array2d(dtype=real),
    offset_before: wp.array2d(dtype=real),
    restless: wp.array2d(dtype=int),
):
    """Per (world, pair): 1 where the forces of the hats changed by more than CALM in the attempt, the sum of |change|.
    Where the window was laid anew, the hats of before are those that `contact_geometry.open_window` put in their place.
    """
    w, pair = wp.tid()
    model = models[0]
    if ctl[w, k.ATTEMPT] == 0:
        return
    shift = int(wp.floor(offset[w, pair] - offset_before[w, pair] + real(0.5)))
    shift = shift * model.surface_rows[model.pair_first[pair]]
    change = real(0.0)
    before = real(0.0)
    after = real(0.0)
    m = int(0)
    while m < model.mode_capacity:
        weight = wp.max(area[w, pair, m], real(0.0))
        p0 = real(0.0)
        if m - shift >= 0 and m - shift < model.mode_capacity:
            p0 = weight * pressure_before[w, pair, m - shift]
        p1 = weight * pressure[w, pair, m]
        change += wp.abs(p1 - p0)
        before += p0
        after += p1
        m += 1
    restless[w, pair] = 0
    if change > CALM * wp.max(before, after):
        restless[w, pair] = 1


@wp.kernel
def free_rates(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    clk: wp.array2d(dtype=real),
    pair_force: wp.array4d(dtype=real),
    modal_load: wp.array3d(dtype=real),
    v1: wp.array2d(dtype=vec3),
    v1_rate: wp.array2d(dtype=vec3),
    omega1: wp.array2d(dtype=vec3),
    omega1_rate: wp.array2d(dtype=vec3),
    qd1: wp.array2d(dtype=real),
    qd1_rate: wp.array2d(dtype=real),
):
    """Per world: the velocities of an impulsive attempt, and its accelerations without contact, vdot^ - kappa w."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w, k.ATTEMPT] == 0 or not impulsive(ctl, w):
        return
    part = outer_share(model, clk, w)
    kappa = kappa_of(clk, w, k.ALPHA_M, part)
    slip = slip_of(clk, w, k.ALPHA_M, part)
    b = lane
    while b < model.body_count:
        f, t = push_on(model, pair_force, w, 1, b)
        push = f / model.mass[b]
        twist = wp.inverse(model.inertia[b]) * t
        v1[w, b] = v1[w, b] + slip * push
        omega1[w, b] = omega1[w, b] + slip * twist
        v1_rate[w, b] = v1_rate[w, b] - kappa * push
        omega1_rate[w, b] = omega1_rate[w, b] - kappa * twist
        b += wp.block_dim()
    n = lane
    while n < model.modal_count:
        load = modal_load[w, 1, n]
        of_mode = mode_share(model, ctl, clk, w, n)
        if of_mode == real(0.0):
            qd1_rate[w, n] = qd1_rate[w, n] - load
        else:
            at = columns_of(model, ctl, clk, w, n)
            qd1[w, n] = qd1[w, n] + slip_of(clk, w, at, of_mode) * load
            qd1_rate[w, n] = qd1_rate[w, n] - kappa_of(clk, w, at, of_mode) * load
        n += wp.block_dim()


@wp.kernel
def forget_contact(
    models: wp.array(dtype=Model),
    pair_force: wp.array4d(dtype=real),
    modal_load: wp.array3d(dtype=real),
    ctl: wp.array2d(dtype=int),
    v_rate: wp.array2d(dtype=vec3),
    v_alg: wp.array2d(dtype=vec3),
    omega_rate: wp.array2d(dtype=vec3),
    omega_alg: wp.array2d(dtype=vec3),
    qd_rate: wp.array2d(dtype=real),
    qd_alg: wp.array2d(dtype=real),
):
    """Per world whose attempt is to be repeated: accelerations of the accepted state without contact, vdot_0 - w_0,
    from which the algorithmic ones restart."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w, k.ATTEMPT] == 0 or ctl[w, k.SUDDEN] != k.WANTED:
        return
    b = lane
    while b < model.body_count:
        f, t = push_on(model, pair_force, w, 0, b)
        v_rate[w, b] = v_rate[w, b] - f / model.mass[b]
        omega_rate[w, b] = omega_rate[w, b] - wp.inverse(model.inertia[b]) * t
        v_alg[w, b] = v_rate[w, b]
        omega_alg[w, b] = omega_rate[w, b]
        b += wp.block_dim()
    n = lane
    while n < model.modal_count:
        qd_rate[w, n] = qd_rate[w, n] - modal_load[w, 0, n]
        qd_alg[w, n] = qd_rate[w, n]
        n += wp.block_dim()
    sync()
    if lane == 0:
        ctl[w, k.SUDDEN] = k.IMPULSIVE
