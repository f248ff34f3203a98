"""The energy ledger of an attempt.

With E the energy of the state (kinetic, strain of the modes, contact, potential of gravity and springs) every step
books

    work of forces    sum (F_0 + F_1)/2 . (x_1 - x_0)           drive   -(lambda_0 + lambda_1)/2 (s_1 - s_0)
    damping           h/2 (d_0 + d_1), d the power of dampers and modal damping
    friction          sum tau_1 . S: the tractions at the end of the step times the slip over it, never positive
    contact grid      dE_contact + (work of the contact wrench on bodies and modes, trapezoidal; in
                      impulsive steps, `sudden`, of the wrench at the end) - friction
    numerical         what is left of dE: negative where the integrator dissipates.

A proximal step towards a static state must not end higher than it began, dE no more than the work of forces: Newton's
method would go to a maximum as well as to a minimum.
"""

import warp as wp

from warpffrf_kernels import control as k
from warpffrf_kernels.forces import group_energy
from warpffrf_kernels.model import Model
from warpffrf_kernels.rows import evaluate_signal
from warpffrf_kernels.scalars import MODULE_OPTIONS, mat33, real, vec3

wp.set_module_options(MODULE_OPTIONS)

UNSEEN = wp.constant(wp.float64(1.0e-8))  # of the energies: what joints work that close to the tolerance of 1e-9


@wp.kernel
def generalise_contact(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    r1: wp.array2d(dtype=vec3),
    axes: wp.array2d(dtype=mat33),
    pair_wrench: wp.array3d(dtype=real),
    pair_force: wp.array4d(dtype=real),
):
    """Per (world, pair): contact force (world) and torque about the centre of mass (body axes) on A, then on B."""
    w, pair = wp.tid()
    model = models[0]
    if ctl[w, k.ATTEMPT] == 0:
        return
    A = model.surface_body[model.pair_first[pair]]
    B = model.surface_body[model.pair_second[pair]]
    f = vec3(pair_wrench[w, pair, 0], pair_wrench[w, pair, 1], pair_wrench[w, pair, 2])
    t = vec3(pair_wrench[w, pair, 3], pair_wrench[w, pair, 4], pair_wrench[w, pair, 5])
    t_a = wp.transpose(axes[w, A]) * t
    t_b = vec3(real(0.0), real(0.0), real(0.0))  # on the ground it does nothing
    if B >= 0:
        t_b = -(wp.transpose(axes[w, B]) * (t + wp.cross(r1[w, A] - r1[w, B], f)))
    for i in range(3):
        pair_force[w, pair, 1, i] = f[i]
        pair_force[w, pair, 1, 3 + i] = t_a[i]
        pair_force[w, pair, 1, 6 + i] = -f[i]
        pair_force[w, pair, 1, 9 + i] = t_b[i]


@wp.func
def mean_load(sudden: bool, before: real, after: real) -> real:
    """Load over a step: the mean of both ends, and where contact is sudden the one at the end (`sudden`)."""
    if sudden:
        return after
    return real(0.5) * (before + after)


@wp.func
def mean_force(sudden: bool, pair_force: wp.array4d(dtype=real), w: int, pair: int, c: int) -> real:
    return mean_load(sudden, pair_force[w, pair, 0, c], pair_force[w, pair, 1, c])


@wp.kernel
def balance_energy(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    r1: wp.array2d(dtype=vec3),
    v1: wp.array2d(dtype=vec3),
    omega1: wp.array2d(dtype=vec3),
    dx: wp.array2d(dtype=vec3),
    psi: wp.array2d(dtype=vec3),
    q1: wp.array2d(dtype=real),
    qd: wp.array2d(dtype=real),
    qd1: wp.array2d(dtype=real),
    dq: wp.array2d(dtype=real),
    lam0: wp.array2d(dtype=real),
    lam: wp.array2d(dtype=real),
    coordinate: wp.array2d(dtype=real),
    stretch: wp.array2d(dtype=real),
    drive_rate: wp.array3d(dtype=real),
    applied: wp.array3d(dtype=vec3),
    applied_at: wp.array3d(dtype=vec3),
    load: wp.array3d(dtype=real),
    load_on_modes: wp.array3d(dtype=real),
    pair_force: wp.array4d(dtype=real),
    modal_load: wp.array3d(dtype=real),
    contact_energy: wp.array2d(dtype=real),
    extra_energy: wp.array2d(dtype=real),
    friction_work: wp.array3d(dtype=real),
    clk: wp.array2d(dtype=real),
    energy: wp.array3d(dtype=real),
):
    """Per world: the ledger of the trial state, energy[w, 1], from that of the accepted one, energy[w, 0]; of a static
    step whether it went downhill, `RISE`."""
    w = wp.tid()
    model = models[0]
    if ctl[w, k.ATTEMPT] == 0:
        return
    half = real(0.5)
    h = clk[w, k.H]
    kinetic = real(0.0)
    strain = real(0.0)
    potential = real(0.0)
    damping = real(0.0)
    force_work = real(0.0)
    drive_work = real(0.0)
    held_work = real(0.0)
    contact_work = real(0.0)
    sudden = ctl[w, k.SUDDEN] == k.IMPULSIVE and ctl[w, k.MODE] == k.DYNAMIC
    b = int(0)
    while b < model.body_count:
        kinetic += half * model.mass[b] * wp.dot(v1[w, b], v1[w, b])
        kinetic += half * wp.dot(omega1[w, b], model.inertia[b] * omega1[w, b]) + extra_energy[w, b]
        potential -= model.mass[b] * wp.dot(model.gravity, r1[w, b])
        for c in range(3):
            force_work += half * (load[w, 0, 6 * b + c] + load[w, 1, 6 * b + c]) * dx[w, b][c]
            force_work += half * (load[w, 0, 6 * b + 3 + c] + load[w, 1, 6 * b + 3 + c]) * psi[w, b][c]
        b += 1
    n = int(0)
    while n < model.modal_count:
        kinetic += half * qd1[w, n] * qd1[w, n]
        strain += half * model.stiffness[n] * q1[w, n] * q1[w, n]
        damping += half * h * model.damping[n] * (qd[w, n] * qd[w, n] + qd1[w, n] * qd1[w, n])
        contact_work += mean_load(sudden, modal_load[w, 0, n], modal_load[w, 1, n]) * dq[w, n]
        force_work += half * (load_on_modes[w, 0, n] + load_on_modes[w, 1, n]) * dq[w, n]
        n += 1
    row = int(0)
    while row < model.row_count:
        if model.row_rigid[row] == 0:
            change = coordinate[w, row] - model.row_reference[row]
            potential += half * model.row_stiffness[row] * change * change + model.row_preload[row] * change
            d0 = drive_rate[w, 0, row]
            d1 = drive_rate[w, 1, row]
            damping += half * h * model.row_damping[row] * (d0 * d0 + d1 * d1)
        else:
            held_work -= half * (lam0[w, row] + lam[w, row]) * (coordinate[w, row] - stretch[w, row])
        if model.row_rigid[row] != 0 and model.row_signal[row] >= 0:
            s0 = evaluate_signal(model, model.row_signal[row], clk[w, k.TIME], 0)
            s1 = evaluate_signal(model, model.row_signal[row], clk[w, k.NEXT_TIME], 0)
            drive_work -= half * (lam0[w, row] + lam[w, row]) * (s1 - s0)
        row += 1
    groups = group_energy(model, w, h, coordinate, stretch, drive_rate)
    potential += groups[0]
    damping += groups[1]
    force_work += groups[2]
    i = int(0)
    while i < model.force_count:
        f = half * (applied[w, 0, i] + applied[w, 1, i])
        force_work += wp.dot(f, applied_at[w, 1, i] - applied_at[w, 0, i])
        i += 1
    pair = int(0)
    while pair < model.pair_count:
        A = model.surface_body[model.pair_first[pair]]
        B = model.surface_body[model.pair_second[pair]]
        for c in range(3):
            contact_work += mean_force(sudden, pair_force, w, pair, c) * dx[w, A][c]
            contact_work += mean_force(sudden, pair_force, w, pair, 3 + c) * psi[w, A][c]
            if B >= 0:
                contact_work += mean_force(sudden, pair_force, w, pair, 6 + c) * dx[w, B][c]
                contact_work += mean_force(sudden, pair_force, w, pair, 9 + c) * psi[w, B][c]
        pair += 1
    energy[w, 1, k.KINETIC] = kinetic
    energy[w, 1, k.STRAIN] = strain
    energy[w, 1, k.CONTACT] = contact_energy[w, 0]
    energy[w, 1, k.POTENTIAL] = potential
    total = kinetic + strain + contact_energy[w, 0] + potential
    before = energy[w, 0, k.KINETIC] + energy[w, 0, k.STRAIN] + energy[w, 0, k.CONTACT] + energy[w, 0, k.POTENTIAL]
    friction = real(0.0)
    pair = int(0)
    while pair < model.pair_count:
        friction += friction_work[w, pair, 0]
        pair += 1
    grid = contact_energy[w, 0] - energy[w, 0, k.CONTACT] + contact_work - friction
    numerical = total - before - force_work - drive_work + damping - grid - friction
    clk[w, k.RISE] = real(0.0)
    if ctl[w, k.MODE] == k.STATIC and ctl[w, k.STEPS] > 0:
        largest = wp.max(wp.abs(strain - energy[w, 0, k.STRAIN]), wp.abs(potential - energy[w, 0, k.POTENTIAL]))
        largest = wp.max(largest, wp.max(wp.abs(contact_energy[w, 0] - energy[w, 0, k.CONTACT]), wp.abs(force_work)))
        stored = strain + contact_energy[w, 0] + potential - energy[w, 0, k.STRAIN] - energy[w, 0, k.CONTACT]
        stored -= energy[w, 0, k.POTENTIAL] + force_work + held_work
        if stored > UNSEEN * (wp.abs(strain) + wp.abs(potential) + wp.abs(contact_energy[w, 0])):
            clk[w, k.RISE] = stored / largest
    if ctl[w, k.MODE] != k.DYNAMIC:  # a start or a static step opens the books
        force_work = real(0.0)
        drive_work = real(0.0)
        damping = real(0.0)
        grid = real(0.0)
        friction = real(0.0)
        numerical = real(0.0)
    energy[w, 1, k.FORCE_WORK] = energy[w, 0, k.FORCE_WORK] + force_work
    energy[w, 1, k.DRIVE_WORK] = energy[w, 0, k.DRIVE_WORK] + drive_work
    energy[w, 1, k.DAMPING] = energy[w, 0, k.DAMPING] + damping
    energy[w, 1, k.CONTACT_GRID] = energy[w, 0, k.CONTACT_GRID] + grid
    energy[w, 1, k.NUMERICAL] = energy[w, 0, k.NUMERICAL] + numerical
    energy[w, 1, k.FRICTION] = energy[w, 0, k.FRICTION] + friction
