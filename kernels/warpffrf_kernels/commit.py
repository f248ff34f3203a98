"""End of an attempt: energy ledger, acceptance, step size, state copy, and the record.

Ledger. With E the energy of the state (kinetic, strain of the modes, contact, potential of gravity and springs) every
step books

    work of forces    sum (F_0 + F_1)/2 . (x_1 - x_0)           drive   -(lambda_0 + lambda_1)/2 (s_1 - s_0)
    damping           h/2 (d_0 + d_1), d the power of dampers and modal damping
    contact grid      dE_contact + (work of the contact wrench on bodies and modes, trapezoidal)
    numerical         what is left of dE: negative where the integrator dissipates.

A step is accepted when its Newton loop converged, everything is finite, and, if it opened or closed a contact,
`numerical + contact grid` did not rise by more than `energy_tolerance` of the energy at hand. Otherwise it is halved
(levels are powers of two of the user's step, so time stays exact). Contact opens or closes where the force of a pair
vanishes on one side of the step only; the algorithmic accelerations then restart from the true ones.
"""

import warp as wp

from warpffrf_kernels import control as k
from warpffrf_kernels.forces import group_energy
from warpffrf_kernels.model import Model
from warpffrf_kernels.rows import evaluate_signal
from warpffrf_kernels.scalars import MODULE_OPTIONS, mat33, quat, real, vec3

wp.set_module_options(MODULE_OPTIONS)

QUIET = wp.constant(
    wp.float64(0.125)
)  # of the energy tolerance: a step of second order with a defect below 1/2^3 of it may be doubled


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
    t_b = -(wp.transpose(axes[w, B]) * (t + wp.cross(r1[w, A] - r1[w, B], f)))
    for i in range(3):
        pair_force[w, pair, 1, i] = f[i]
        pair_force[w, pair, 1, 3 + i] = t_a[i]
        pair_force[w, pair, 1, 6 + i] = -f[i]
        pair_force[w, pair, 1, 9 + i] = t_b[i]


@wp.kernel
def balance_energy(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    clk: wp.array2d(dtype=real),
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
    energy: wp.array3d(dtype=real),
):
    """Per world: the ledger of the trial state, energy[w, 1], from that of the accepted one, energy[w, 0]."""
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
    contact_work = real(0.0)
    b = int(0)
    while b < model.body_count:
        kinetic += half * model.mass[b] * wp.dot(v1[w, b], v1[w, b])
        kinetic += half * wp.dot(omega1[w, b], model.inertia[b] * omega1[w, b])
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
        contact_work += half * (modal_load[w, 0, n] + modal_load[w, 1, n]) * dq[w, n]
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
        elif model.row_signal[row] >= 0:
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
            contact_work += half * (pair_force[w, pair, 0, c] + pair_force[w, pair, 1, c]) * dx[w, A][c]
            contact_work += half * (pair_force[w, pair, 0, 3 + c] + pair_force[w, pair, 1, 3 + c]) * psi[w, A][c]
            contact_work += half * (pair_force[w, pair, 0, 6 + c] + pair_force[w, pair, 1, 6 + c]) * dx[w, B][c]
            contact_work += half * (pair_force[w, pair, 0, 9 + c] + pair_force[w, pair, 1, 9 + c]) * psi[w, B][c]
        pair += 1
    energy[w, 1, k.KINETIC] = kinetic
    energy[w, 1, k.STRAIN] = strain
    energy[w, 1, k.CONTACT] = contact_energy[w, 0]
    energy[w, 1, k.POTENTIAL] = potential
    total = kinetic + strain + contact_energy[w, 0] + potential
    before = energy[w, 0, k.KINETIC] + energy[w, 0, k.STRAIN] + energy[w, 0, k.CONTACT] + energy[w, 0, k.POTENTIAL]
    grid = contact_energy[w, 0] - energy[w, 0, k.CONTACT] + contact_work
    numerical = total - before - force_work - drive_work + damping - grid
    if ctl[w, k.MODE] != k.DYNAMIC:  # a start or a static step opens the books
        force_work = real(0.0)
        drive_work = real(0.0)
        damping = real(0.0)
        grid = real(0.0)
        numerical = real(0.0)
    energy[w, 1, k.FORCE_WORK] = energy[w, 0, k.FORCE_WORK] + force_work
    energy[w, 1, k.DRIVE_WORK] = energy[w, 0, k.DRIVE_WORK] + drive_work
    energy[w, 1, k.DAMPING] = energy[w, 0, k.DAMPING] + damping
    energy[w, 1, k.CONTACT_GRID] = energy[w, 0, k.CONTACT_GRID] + grid
    energy[w, 1, k.NUMERICAL] = energy[w, 0, k.NUMERICAL] + numerical


@wp.kernel
def decide(
    models: wp.array(dtype=Model),
    energy: wp.array3d(dtype=real),
    dx: wp.array2d(dtype=vec3),
    pair_force: wp.array4d(dtype=real),
    ctl: wp.array2d(dtype=int),
    clk: wp.array2d(dtype=real),
):
    """Per world: accept or reject the attempt, and choose the next step."""
    w = wp.tid()
    model = models[0]
    if ctl[w, k.ATTEMPT] == 0:
        return
    total = real(0.0)
    for line in range(k.LINES):
        total += energy[w, 1, line]
    if not wp.isfinite(total):
        ctl[w, k.FAILURE] = ctl[w, k.FAILURE] | k.NOT_FINITE
    event = int(0)
    pair = int(0)
    while pair < model.pair_count:
        before = real(0.0)
        after = real(0.0)
        for c in range(3):
            before += wp.abs(pair_force[w, pair, 0, c])
            after += wp.abs(pair_force[w, pair, 1, c])
        if (before > real(0.0)) != (after > real(0.0)):
            event = int(1)
        pair += 1
    ctl[w, k.EVENT] = event
    dynamic = ctl[w, k.MODE] == k.DYNAMIC
    defect = energy[w, 1, k.NUMERICAL] - energy[w, 0, k.NUMERICAL]
    defect += energy[w, 1, k.CONTACT_GRID] - energy[w, 0, k.CONTACT_GRID]
    hand = real(0.0)
    for side in range(2):
        at_hand = energy[w, side, k.KINETIC] + energy[w, side, k.STRAIN] + energy[w, side, k.CONTACT]
        hand = wp.max(hand, at_hand)
    if dynamic and ctl[w, k.FAILURE] == 0 and event != 0:
        if wp.abs(defect) > model.energy_tolerance * hand:
            ctl[w, k.FAILURE] = ctl[w, k.FAILURE] | k.ENERGY
    failure = ctl[w, k.FAILURE]
    deep = ctl[w, k.LEVEL] >= model.max_level
    if failure == k.ENERGY and deep:
        failure = 0  # as fine as allowed: the ledger shows what is left
    if failure != 0:
        ctl[w, k.REJECTED] = ctl[w, k.REJECTED] + 1
        ctl[w, k.REASON] = ctl[w, k.REASON] | failure
        if not dynamic or deep or (failure & k.CAPACITY) != 0 or (failure & k.SINGULAR) != 0:
            ctl[w, k.STATUS] = failure
            if dynamic and deep:
                ctl[w, k.STATUS] = failure | k.UNDERFLOW
        else:
            ctl[w, k.LEVEL] = ctl[w, k.LEVEL] + 1
            ctl[w, k.SUB] = 2 * ctl[w, k.SUB]
        ctl[w, k.ACTIVE] = ctl[w, k.TOUCHED]
        return
    ctl[w, k.ACCEPT] = 1
    ctl[w, k.STEPS] = ctl[w, k.STEPS] + 1
    ctl[w, k.ITERATIONS] = ctl[w, k.ITERATIONS] + ctl[w, k.ITERATION]
    ctl[w, k.PENDING] = ctl[w, k.PENDING] + ctl[w, k.ITERATION]
    ctl[w, k.WORST] = wp.max(ctl[w, k.WORST], ctl[w, k.ITERATION])
    clk[w, k.TIME] = clk[w, k.NEXT_TIME]
    clk[w, k.DONE_STEP] = clk[w, k.H]
    if not dynamic:
        move = real(0.0)
        b = int(0)
        while b < model.body_count:
            move = wp.max(move, wp.length(dx[w, b]))
            b += 1
        clk[w, k.MOVE] = move
        ctl[w, k.STEP] = ctl[w, k.STEP] + 1
        if ctl[w, k.MODE] != k.STATIC:
            clk[w, k.TIME] = clk[w, k.START_TIME]
        return
    ctl[w, k.SUB] = ctl[w, k.SUB] + 1
    if ctl[w, k.LEVEL] > 0:
        quiet = event == 0 and wp.abs(defect) <= QUIET * model.energy_tolerance * hand
        if quiet and ctl[w, k.SUB] % 2 == 0:  # one level at a time
            ctl[w, k.LEVEL] = ctl[w, k.LEVEL] - 1
            ctl[w, k.SUB] = ctl[w, k.SUB] / 2
    whole = int(1)
    level = int(0)
    while level < ctl[w, k.LEVEL]:
        whole = whole * 2
        level += 1
    if ctl[w, k.SUB] >= whole:
        ctl[w, k.SUB] = 0
        ctl[w, k.STEP] = ctl[w, k.STEP] + 1
        if ctl[w, k.STEP] % ctl[w, k.EVERY] == 0:
            ctl[w, k.RECORD] = 1


@wp.kernel
def keep_bodies(
    ctl: wp.array2d(dtype=int),
    r1: wp.array2d(dtype=vec3),
    p1: wp.array2d(dtype=quat),
    v1: wp.array2d(dtype=vec3),
    v1_rate: wp.array2d(dtype=vec3),
    omega1: wp.array2d(dtype=vec3),
    omega1_rate: wp.array2d(dtype=vec3),
    dx: wp.array2d(dtype=vec3),
    psi: wp.array2d(dtype=vec3),
    clk: wp.array2d(dtype=real),
    r: wp.array2d(dtype=vec3),
    p: wp.array2d(dtype=quat),
    v: wp.array2d(dtype=vec3),
    v_rate: wp.array2d(dtype=vec3),
    v_alg: wp.array2d(dtype=vec3),
    omega: wp.array2d(dtype=vec3),
    omega_rate: wp.array2d(dtype=vec3),
    omega_alg: wp.array2d(dtype=vec3),
):
    w, lane = wp.tid()
    if ctl[w, k.ACCEPT] == 0:
        return
    b = lane
    while b < r.shape[1]:
        mode = ctl[w, k.MODE]
        if mode == k.DYNAMIC or mode == k.STATIC:
            r[w, b] = r1[w, b]
            p[w, b] = p1[w, b]
        h = clk[w, k.H]
        a_t = (dx[w, b] - h * v[w, b] - h * h * (real(0.5) - clk[w, k.BETA]) * v_alg[w, b]) / (clk[w, k.BETA] * h * h)
        a_r = (psi[w, b] - h * omega[w, b] - h * h * (real(0.5) - clk[w, k.BETA]) * omega_alg[w, b]) / (
            clk[w, k.BETA] * h * h
        )
        if mode == k.START or ctl[w, k.EVENT] != 0:
            a_t = v1_rate[w, b]
            a_r = omega1_rate[w, b]
        if mode == k.DYNAMIC or mode == k.START:
            v_rate[w, b] = v1_rate[w, b]
            omega_rate[w, b] = omega1_rate[w, b]
            v_alg[w, b] = a_t
            omega_alg[w, b] = a_r
        if mode == k.DYNAMIC or mode == k.PROJECT:
            v[w, b] = v1[w, b]
            omega[w, b] = omega1[w, b]
        if mode == k.START:  # PROJECT found the velocity at the end of its tiny step: back to its beginning
            v[w, b] = v[w, b] - h * v1_rate[w, b]
            omega[w, b] = omega[w, b] - h * omega1_rate[w, b]
        b += wp.block_dim()


@wp.kernel
def keep_modes(
    ctl: wp.array2d(dtype=int),
    clk: wp.array2d(dtype=real),
    q1: wp.array2d(dtype=real),
    qd1: wp.array2d(dtype=real),
    qd1_rate: wp.array2d(dtype=real),
    dq: wp.array2d(dtype=real),
    q: wp.array2d(dtype=real),
    qd: wp.array2d(dtype=real),
    qd_rate: wp.array2d(dtype=real),
    qd_alg: wp.array2d(dtype=real),
    modal_load: wp.array3d(dtype=real),
):
    w, lane = wp.tid()
    if ctl[w, k.ACCEPT] == 0:
        return
    n = lane
    while n < q.shape[1]:
        mode = ctl[w, k.MODE]
        modal_load[w, 0, n] = modal_load[w, 1, n]
        if mode == k.DYNAMIC or mode == k.STATIC:
            q[w, n] = q1[w, n]
        h = clk[w, k.H]
        a = (dq[w, n] - h * qd[w, n] - h * h * (real(0.5) - clk[w, k.BETA]) * qd_alg[w, n]) / (clk[w, k.BETA] * h * h)
        if mode == k.START or ctl[w, k.EVENT] != 0:
            a = qd1_rate[w, n]
        if mode == k.DYNAMIC or mode == k.START:
            qd_rate[w, n] = qd1_rate[w, n]
            qd_alg[w, n] = a
        if mode == k.DYNAMIC or mode == k.PROJECT:
            qd[w, n] = qd1[w, n]
        if mode == k.START:
            qd[w, n] = qd[w, n] - h * qd1_rate[w, n]
        n += wp.block_dim()


@wp.kernel
def keep_rest(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    coordinate: wp.array2d(dtype=real),
    lam: wp.array2d(dtype=real),
    lam0: wp.array2d(dtype=real),
    stretch: wp.array2d(dtype=real),
    drive_rate: wp.array3d(dtype=real),
    applied: wp.array3d(dtype=vec3),
    applied_at: wp.array3d(dtype=vec3),
    load: wp.array3d(dtype=real),
    load_on_modes: wp.array3d(dtype=real),
    pair_force: wp.array4d(dtype=real),
    energy: wp.array3d(dtype=real),
):
    """Per world: what is left to take over, or to restore after a rejection."""
    w = wp.tid()
    model = models[0]
    if ctl[w, k.ATTEMPT] == 0:
        return
    accept = ctl[w, k.ACCEPT] != 0 and ctl[w, k.MODE] != k.PROJECT  # whose multipliers are impulses over the tiny step
    row = int(0)
    while row < model.row_count:
        if accept:
            lam0[w, row] = lam[w, row]
            drive_rate[w, 0, row] = drive_rate[w, 1, row]
            stretch[w, row] = coordinate[w, row]
        else:
            lam[w, row] = lam0[w, row]
        row += 1
    if not accept:
        return
    i = int(0)
    while i < model.force_count:
        applied[w, 0, i] = applied[w, 1, i]
        applied_at[w, 0, i] = applied_at[w, 1, i]
        i += 1
    i = int(0)
    while i < 6 * model.body_count:
        load[w, 0, i] = load[w, 1, i]
        i += 1
    i = int(0)
    while i < model.modal_count:
        load_on_modes[w, 0, i] = load_on_modes[w, 1, i]
        i += 1
    pair = int(0)
    while pair < model.pair_count:
        for c in range(12):
            pair_force[w, pair, 0, c] = pair_force[w, pair, 1, c]
        pair += 1
    for line in range(k.LINES):
        energy[w, 0, line] = energy[w, 1, line]


@wp.kernel
def sum_second(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    station: wp.array4d(dtype=real),
    station_wrench: wp.array4d(dtype=real),
    second_load: wp.array3d(dtype=real),
    second_wrench: wp.array3d(dtype=real),
):
    """Per (world, pair): the wrench that the hat forces on the second surface sum to there (about A's centre of mass).

    The wrench of a unit force is interpolated linearly between the first and the last station, at the axial position of
    the node. Hats reproduce linear functions, so force and moment agree with those of the first side to round-off where
    that wrench is linear in z: for parallel axes. On tilted ones the line of centres turns along the width, and what is
    left is of the order of the tilt squared.
    """
    w, pair = wp.tid()
    model = models[0]
    if ctl[w, k.RECORD] == 0:
        return
    B = model.pair_second[pair]
    rows_b = model.surface_rows[B]
    for c in range(6):
        second_wrench[w, pair, c] = real(0.0)
    last = (model.surface_rows[model.pair_first[pair]] - 1) * model.z_points - 1
    z0 = station[w, pair, 0, 3]
    z1 = station[w, pair, last, 3]
    i = int(0)
    while i < model.second_columns * rows_b:
        f = second_load[w, pair, i]
        if f != real(0.0):
            z = model.surface_z[model.surface_z_start[B] + i % rows_b]
            e = real(0.0)
            if last > 0:
                e = (z - z0) / (z1 - z0)
            for c in range(6):
                value = (real(1.0) - e) * station_wrench[w, pair, 0, c] + e * station_wrench[w, pair, last, c]
                second_wrench[w, pair, c] = second_wrench[w, pair, c] - f * value
        i += 1


@wp.kernel
def record(
    models: wp.array(dtype=Model),
    clk: wp.array2d(dtype=real),
    r: wp.array2d(dtype=vec3),
    p: wp.array2d(dtype=quat),
    v: wp.array2d(dtype=vec3),
    omega: wp.array2d(dtype=vec3),
    v_rate: wp.array2d(dtype=vec3),
    omega_rate: wp.array2d(dtype=vec3),
    q: wp.array2d(dtype=real),
    qd: wp.array2d(dtype=real),
    qd_rate: wp.array2d(dtype=real),
    lam: wp.array2d(dtype=real),
    coordinate: wp.array2d(dtype=real),
    row_wrench: wp.array3d(dtype=real),
    center: wp.array3d(dtype=int),
    station: wp.array4d(dtype=real),
    active: wp.array3d(dtype=int),
    pair_wrench: wp.array3d(dtype=real),
    second_wrench: wp.array3d(dtype=real),
    pressure: wp.array3d(dtype=real),
    second_load: wp.array3d(dtype=real),
    energy: wp.array3d(dtype=real),
    ctl: wp.array2d(dtype=int),
    ring: wp.array3d(dtype=real),
):
    """Per world: one row of the ring. Layout: `warpffrf.online.record`."""
    w = wp.tid()
    model = models[0]
    if ctl[w, k.RECORD] == 0:
        return
    at = ctl[w, k.SAVED] % ring.shape[1]
    ctl[w, k.SAVED] = ctl[w, k.SAVED] + 1
    ring[w, at, 0] = clk[w, k.TIME]
    ring[w, at, 1] = clk[w, k.DONE_STEP]
    ring[w, at, 2] = real(ctl[w, k.PENDING])
    ring[w, at, 3] = real(ctl[w, k.PENDING_SOLVES])
    ctl[w, k.PENDING] = 0
    ctl[w, k.PENDING_SOLVES] = 0
    for line in range(k.LINES):
        ring[w, at, 4 + line] = energy[w, 0, line]
    o = int(4 + k.LINES)
    b = int(0)
    while b < model.body_count:
        for i in range(3):
            ring[w, at, o + i] = r[w, b][i]
            ring[w, at, o + 7 + i] = v[w, b][i]
            ring[w, at, o + 10 + i] = omega[w, b][i]
            ring[w, at, o + 13 + i] = v_rate[w, b][i]
            ring[w, at, o + 16 + i] = omega_rate[w, b][i]
        for i in range(4):
            ring[w, at, o + 3 + i] = p[w, b][i]
        o += 19
        b += 1
    n = int(0)
    while n < model.modal_count:
        ring[w, at, o + n] = q[w, n]
        ring[w, at, o + model.modal_count + n] = qd[w, n]
        ring[w, at, o + 2 * model.modal_count + n] = qd_rate[w, n]
        n += 1
    o += 3 * model.modal_count
    row = int(0)
    while row < model.row_count:
        ring[w, at, o] = coordinate[w, row]
        for i in range(6):
            ring[w, at, o + 1 + i] = -lam[w, row] * row_wrench[w, row, i]
        o += 7
        row += 1
    pair = int(0)
    while pair < model.pair_count:
        last = (model.surface_rows[model.pair_first[pair]] - 1) * model.z_points - 1
        ring[w, at, o] = real(center[w, pair, 0])
        ring[w, at, o + 1] = real(center[w, pair, 1])
        ring[w, at, o + 2] = real(0.5) * (station[w, pair, 0, 1] + station[w, pair, last, 1])
        ring[w, at, o + 3] = real(0.5) * (station[w, pair, 0, 0] + station[w, pair, last, 0])
        for i in range(6):
            ring[w, at, o + 4 + i] = pair_wrench[w, pair, i]
            ring[w, at, o + 10 + i] = second_wrench[w, pair, i]
        o += 16
        number = int(0)
        m = int(0)
        while m < model.mode_capacity:
            value = real(0.0)
            if active[w, pair, m] != 0:
                value = pressure[w, pair, m]
                number += 1
            ring[w, at, o + m] = value
            m += 1
        o += model.mode_capacity
        ring[w, at, o] = real(number)
        o += 1
        m = int(0)
        while m < model.node_capacity:
            ring[w, at, o + m] = second_load[w, pair, m]
            m += 1
        o += model.node_capacity
        pair += 1


@wp.kernel
def count_attempts(ctl: wp.array2d(dtype=int), budget: wp.array(dtype=int), more: wp.array(dtype=int)):
    """One thread: does any world still have steps to do in this chunk, and attempts left?"""
    budget[0] = budget[0] - 1
    running = int(0)
    w = int(0)
    while w < ctl.shape[0]:
        if ctl[w, k.STATUS] == 0 and ctl[w, k.STEP] < ctl[w, k.TARGET]:
            running += 1
        w += 1
    more[0] = 0
    if running > 0 and budget[0] > 0:
        more[0] = 1
