"""The outer system: rigid coordinates and multipliers, with the global modes condensed.

With `sigma` the diagonal tangent of the modes, J their gradient of the weak gaps, C and C_m the gradients of the rows
by rigid and modal coordinates, r, r_m the residuals and `opened` the weak gaps of the present state, all with the
contact forces of its pressures, the linearised step for the changes dx, dq, dlam, ds reads (x: rigid coordinates and
the modes that carry inertia, q: the others)

    S dx + C^T dlam - L_r^T ds = -r,            sigma dq + C_m^T dlam - J^T ds = -r_m,
    C dx + C_m dq - E dlam = -c,                opened + L_r dx + J dq + G_local ds = 0 on the active set.

Eliminating dq leaves, for z = (dx, dlam),

    [ S   C^T                       ]         [ -r                      ]
    [ C   -C_m sigma^-1 C_m^T - E   ] z  =    [ -c + C_m sigma^-1 r_m   ]  + L^T ds,      L = [L_r, -J sigma^-1 C_m^T].

Its inverse H is formed in the first Newton iteration, and again while the residual is above REFRESH_ABOVE (tens of
unknowns); contact then sees the compliance `G + L H L^T`, in which whatever can move is condensed (Josephy-Newton): the
first iteration already knows what will touch.
"""

import warp as wp

from warpffrf_kernels import control as k
from warpffrf_kernels.model import Model
from warpffrf_kernels.scalars import MODULE_OPTIONS, axpy, mat33, real, sync, vec3

wp.set_module_options(MODULE_OPTIONS)

# residual below which the inverse of the last iteration serves once more
REFRESH_ABOVE = wp.constant(wp.float64(1.0e-7))
# of the coordinates: a joint defect is not measured against less, or round-off would exceed the tolerance
SHORT = wp.constant(wp.float64(1.0e-6))
ROUND_OFF = wp.constant(wp.float64(1.0e-6))  # times the residual tolerance: a few digits above machine precision
CANCELLED = wp.constant(wp.float64(1.0e-5))  # of a joint's force on the modes: round-off of its sums over the tolerance
NO_FORCE = wp.constant(wp.float64(1.0e-30))  # N: a scale that is never zero
PIVOT_TOLERANCE = wp.constant(
    wp.float64(1.0e-13)
)  # of the equilibrated matrix: below it a row is dependent on the others


@wp.kernel
def add_multipliers(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    lam: wp.array2d(dtype=real),
    C: wp.array3d(dtype=real),
    C_modal: wp.array3d(dtype=real),
    residual: wp.array2d(dtype=real),
    modal_residual: wp.array2d(dtype=real),
):
    """Lanes over rigid and modal coordinates: r += C^T lambda."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0:
        return
    i = lane
    while i < 6 * model.body_count + model.modal_count:
        rigid = 6 * model.body_count
        total = real(0.0)
        row = int(0)
        while row < model.row_count:
            if i < rigid:
                total += C[w, row, i] * lam[w, row]
            else:
                total += C_modal[w, row, i - rigid] * lam[w, row]
            row += 1
        if i < rigid:
            residual[w, i] = residual[w, i] + total
        else:
            modal_residual[w, i - rigid] = modal_residual[w, i - rigid] + total
        i += wp.block_dim()


@wp.kernel
def condense(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    C: wp.array3d(dtype=real),
    C_modal: wp.array3d(dtype=real),
    receptance: wp.array2d(dtype=real),
    softness: wp.array2d(dtype=real),
    flexibility: wp.array(dtype=real),
    defect: wp.array2d(dtype=real),
    residual: wp.array2d(dtype=real),
    modal_residual: wp.array2d(dtype=real),
    tangent: wp.array3d(dtype=real),
    rhs: wp.array2d(dtype=real),
    C_receptance: wp.array(dtype=real),
):
    """Lanes over outer unknowns: rows of the condensed matrix (rigid blocks are there already) and its right-hand
    side.
    """
    w, lane = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0:
        return
    i = lane
    while i < model.outer_count:
        rigid = model.row_offset
        if i < 6 * model.body_count:
            rhs[w, i] = -residual[w, i]
        elif i < rigid:
            rhs[w, i] = -modal_residual[w, model.dense_mode[i - 6 * model.body_count]]
        else:
            value = -defect[w, i - rigid]
            n = int(0)
            while n < model.modal_count:
                value += C_modal[w, i - rigid, n] * receptance[w, n] * modal_residual[w, n]
                n += 1
            rhs[w, i] = value
        if ctl[w, k.REFRESH] != 0:
            if i >= rigid:
                n = int(0)
                while n < model.modal_count:
                    at = (w * model.row_count + i - rigid) * model.modal_count + n
                    C_receptance[at] = C_modal[w, i - rigid, n] * receptance[w, n]
                    n += 1
            j = int(0)
            while j < rigid:
                if i >= rigid:
                    if j < 6 * model.body_count:
                        tangent[w, i, j] = C[w, i - rigid, j]
                    else:
                        tangent[w, i, j] = C_modal[w, i - rigid, model.dense_mode[j - 6 * model.body_count]]
                elif j < 6 * model.body_count and i < 6 * model.body_count and j / 6 != i / 6:
                    tangent[w, i, j] = real(0.0)
                j += 1
            other = int(0)
            while other < model.row_count:
                total = real(0.0)
                if i < 6 * model.body_count:
                    total = C[w, other, i]
                elif i < rigid:
                    total = C_modal[w, other, model.dense_mode[i - 6 * model.body_count]]
                else:
                    n = int(0)
                    while n < model.modal_count:
                        total -= C_modal[w, i - rigid, n] * receptance[w, n] * C_modal[w, other, n]
                        n += 1
                    group = model.row_group[i - rigid]
                    if group >= 0 and group == model.row_group[other]:
                        first = model.group_start[group]
                        entry = 6 * (i - rigid - first) + other - first
                        total -= flexibility[(w * model.group_count + group) * 36 + entry]
                    elif other == i - rigid:
                        total -= softness[w, other]
                tangent[w, i, rigid + other] = total
                other += 1
        i += wp.block_dim()


# Inverse of the equilibrated matrix by Gauss-Jordan elimination in place, with row pivoting; rows stay contiguous.
# Native for contiguous inner loops like `axpy`; not measured separately. Returns 1 if a pivot is below `tolerance`.
@wp.func_native("""
    const int n = model.outer_count, rigid = model.row_offset, L = WP_TILE_THREAD_IDX, NL = WP_TILE_BLOCK_DIM;
    double* a = work.data + (size_t)w * n * n;
    double* scale = scaling.data + (size_t)w * n;
    int* swapped = pivots.data + (size_t)w * n;
    const double* A = tangent.data + (size_t)w * n * n;
    for (int i = L; i < n; i += NL) {
        const double d = ::fabs(A[(size_t)i * n + i]);
        scale[i] = i < rigid && d > 0.0 ? 1.0 / ::sqrt(d) : 1.0;
    }
    WP_TILE_SYNC();
    for (int i = rigid + L; i < n; i += NL) {
        double big = 0.0;
        for (int j = 0; j < rigid; ++j) {
            const double entry = ::fabs(A[(size_t)i * n + j]) * scale[j];
            if (entry > big) big = entry;
        }
        if (big == 0.0) big = ::sqrt(::fabs(A[(size_t)i * n + i]));
        scale[i] = big > 0.0 ? 1.0 / big : 1.0;
    }
    WP_TILE_SYNC();
    for (int e = L; e < n * n; e += NL) a[e] = A[e] * scale[e / n] * scale[e % n];
    WP_TILE_SYNC();
    int bad = 0;
    for (int p = 0; p < n; ++p) {
        int best = p;
        for (int i = p + 1; i < n; ++i) if (::fabs(a[(size_t)i * n + p]) > ::fabs(a[(size_t)best * n + p])) best = i;
        WP_TILE_SYNC();
        double* u = a + (size_t)p * n;
        if (L == 0) swapped[p] = best;
        double* x = a + (size_t)best * n;
        if (best != p) for (int j = L; j < n; j += NL) { const double t = u[j]; u[j] = x[j]; x[j] = t; }
        WP_TILE_SYNC();
        double pivot = u[p];
        if (!(::fabs(pivot) > tolerance)) { bad = 1; pivot = 1.0; }
        WP_TILE_SYNC();
        const double r = 1.0 / pivot;
        for (int j = L; j < n; j += NL) u[j] = j == p ? r : u[j] * r;
        WP_TILE_SYNC();
        for (int i = 0; i < n; ++i) {
            double* __restrict x = a + (size_t)i * n; const double m = x[p];
            WP_TILE_SYNC();
            if (i == p || m == 0.0) continue;
            if (L == 0) x[p] = 0.0;
            WP_TILE_SYNC();
            for (int j = L; j < n; j += NL) x[j] -= m * u[j];
        }
        WP_TILE_SYNC();
    }
    for (int p = n - 1; p >= 0; --p) { const int q = swapped[p]; if (q == p) continue;
        for (int i = L; i < n; i += NL) { double* x = a + (size_t)i * n; const double t = x[p]; x[p] = x[q]; x[q] = t; }
        WP_TILE_SYNC(); }
    for (int e = L; e < n * n; e += NL) {
        const int i = e / n, j = e % n;
        inverse_transposed.data[(size_t)w * n * n + (size_t)j * n + i] = a[e] * scale[i] * scale[j];
    }
    WP_TILE_SYNC();
    return bad;
""")
def invert(
    model: Model,
    w: int,
    tolerance: real,
    tangent: wp.array3d(dtype=real),
    scaling: wp.array2d(dtype=real),
    pivots: wp.array2d(dtype=int),
    work: wp.array3d(dtype=real),
    inverse_transposed: wp.array(dtype=real),
) -> int: ...


@wp.kernel
def factor_outer(
    models: wp.array(dtype=Model),
    tangent: wp.array3d(dtype=real),
    rhs: wp.array2d(dtype=real),
    ctl: wp.array2d(dtype=int),
    scaling: wp.array2d(dtype=real),
    pivots: wp.array2d(dtype=int),
    work: wp.array3d(dtype=real),
    inverse_transposed: wp.array(dtype=real),
    z_free: wp.array(dtype=real),
):
    """Per world: H^T (where it is to be renewed), and z without contact, H rhs."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0:
        return
    N = model.outer_count
    if ctl[w, k.REFRESH] != 0:
        bad = invert(model, w, PIVOT_TOLERANCE, tangent, scaling, pivots, work, inverse_transposed)
        if bad != 0 and lane == 0:
            ctl[w, k.FAILURE] = ctl[w, k.FAILURE] | k.SINGULAR
    i = lane
    while i < N:
        z_free[w * N + i] = real(0.0)
        i += wp.block_dim()
    sync()
    j = int(0)
    while j < N:
        axpy(N, rhs[w, j], inverse_transposed, (w * N + j) * N, z_free, w * N)
        j += 1


@wp.func
def gyration_of(J: mat33, mass: real) -> real:
    """Mean radius of gyration: a torque is measured by the force that it is there, also of a slender body."""
    return wp.sqrt(wp.trace(J) / (real(3.0) * mass))


@wp.kernel
def balance(
    models: wp.array(dtype=Model),
    clk: wp.array2d(dtype=real),
    r1: wp.array2d(dtype=vec3),
    v1_rate: wp.array2d(dtype=vec3),
    omega1: wp.array2d(dtype=vec3),
    omega1_rate: wp.array2d(dtype=vec3),
    dx: wp.array2d(dtype=vec3),
    psi: wp.array2d(dtype=vec3),
    lam: wp.array2d(dtype=real),
    defect: wp.array2d(dtype=real),
    softness: wp.array2d(dtype=real),
    row_wrench: wp.array3d(dtype=real),
    row_pull: wp.array3d(dtype=real),
    load: wp.array3d(dtype=real),
    load_on_modes: wp.array3d(dtype=real),
    pair_wrench: wp.array3d(dtype=real),
    gap_defect: wp.array2d(dtype=real),
    modal_residual: wp.array2d(dtype=real),
    modal_load: wp.array3d(dtype=real),
    q1: wp.array2d(dtype=real),
    qd1_rate: wp.array2d(dtype=real),
    dq: wp.array2d(dtype=real),
    residual: wp.array2d(dtype=real),
    ctl: wp.array2d(dtype=int),
    history: wp.array2d(dtype=real),
):
    """Per world: is the state balanced? Residual forces with contact, row defects, spring laws and gaps left open, all
    as fractions.

    The scale of forces is the largest of weight, inertia and gyroscopic force, multiplier and contact force, that of
    modal ones the largest contact load, elastic and inertia force; that of lengths the penetration where there is
    contact, else 1 m (`gap_defect`: gaps left open as a fraction, penetration).
    """
    w = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0 or ctl[w, k.ITERATION] == 0:
        return
    scale = NO_FORCE
    b = int(0)
    while b < model.body_count:
        m = model.mass[b]
        J = model.inertia[b]
        gyration = gyration_of(J, m)
        scale = wp.max(scale, m * (wp.length(model.gravity) + wp.length(v1_rate[w, b])))
        turning = wp.length(J * omega1_rate[w, b]) + wp.length(wp.cross(omega1[w, b], J * omega1[w, b]))
        scale = wp.max(scale, turning / gyration)
        # accelerations are differences of increments: below this they are round-off
        travel = wp.length(dx[w, b]) + gyration * wp.length(psi[w, b])
        scale = wp.max(scale, ROUND_OFF * clk[w, k.ACC] * m * travel)
        for c in range(3):
            scale = wp.max(scale, wp.abs(load[w, 1, 6 * b + c]))
            scale = wp.max(scale, wp.abs(load[w, 1, 6 * b + 3 + c]) / gyration)
        b += 1
    length = real(1.0)
    if gap_defect[w, 1] > real(0.0):
        extent = real(1.0)
        b = int(0)
        while b < model.body_count:
            extent = wp.max(extent, wp.length(r1[w, b]))
            b += 1
        length = wp.max(gap_defect[w, 1], SHORT * extent)
    worst = real(0.0)
    sum = gap_defect[w, 0]  # a largest value drops what is not a number, a sum keeps it
    row = int(0)
    while row < model.row_count:
        if model.row_kind[row] == k.TRANSLATION or model.row_kind[row] == k.DISTANCE:
            scale = wp.max(scale, wp.abs(lam[w, row]))
        elif model.row_rigid[row] == 0:  # a torsional spring, a bushing: force, and torque at the radius of gyration
            f = vec3(row_wrench[w, row, 0], row_wrench[w, row, 1], row_wrench[w, row, 2])
            t = vec3(row_wrench[w, row, 3], row_wrench[w, row, 4], row_wrench[w, row, 5])
            scale = wp.max(scale, wp.abs(lam[w, row]) * wp.length(f))
            for side in range(2):
                b = model.marker_body[model.row_a[row]]
                if side == 1:
                    b = model.marker_body[model.row_b[row]]
                if b >= 0:
                    gyration = gyration_of(model.inertia[b], model.mass[b])
                    scale = wp.max(scale, wp.abs(lam[w, row]) * wp.length(t) / gyration)
        if softness[w, row] == real(0.0):
            worst = wp.max(worst, wp.abs(defect[w, row]) / wp.min(length, real(1.0)))
        row += 1
    pair = int(0)
    while pair < model.pair_count:
        f = vec3(pair_wrench[w, pair, 0], pair_wrench[w, pair, 1], pair_wrench[w, pair, 2])
        scale = wp.max(scale, wp.length(f))
        pair += 1
    row = int(0)
    while row < model.row_count:  # a spring's force against its law; a stretch of round-off size passes
        if softness[w, row] > real(0.0):
            worst = wp.max(worst, wp.abs(defect[w, row]) / wp.max(scale * softness[w, row], ROUND_OFF))
        sum += defect[w, row]
        row += 1
    b = int(0)
    while b < model.body_count:
        f = vec3(residual[w, 6 * b], residual[w, 6 * b + 1], residual[w, 6 * b + 2])
        t = vec3(residual[w, 6 * b + 3], residual[w, 6 * b + 4], residual[w, 6 * b + 5])
        # a torque is measured by the force that it is at the radius of gyration
        gyration = gyration_of(model.inertia[b], model.mass[b])
        worst = wp.max(worst, wp.max(wp.length(f), wp.length(t) / gyration) / scale)
        sum += wp.length(f) + wp.length(t)
        b += 1
    worst = wp.max(worst, gap_defect[w, 0])
    modal_scale = NO_FORCE
    open_load = real(0.0)
    n = int(0)
    while n < model.modal_count:
        modal_scale = wp.max(modal_scale, wp.abs(load_on_modes[w, 1, n]))
        contact = modal_load[w, 1, n]
        modal_scale = wp.max(modal_scale, wp.max(wp.abs(contact), wp.abs(model.stiffness[n] * q1[w, n])))
        travel = wp.abs(dq[w, n])
        modal_scale = wp.max(modal_scale, wp.max(wp.abs(qd1_rate[w, n]), ROUND_OFF * clk[w, k.ACC] * travel))
        open_load = wp.max(open_load, wp.abs(modal_residual[w, n]))
        sum += modal_residual[w, n]
        n += 1
    row = int(0)
    while row < model.row_count:  # forces of joints that cancel each other on the modes leave round-off
        for side in range(2):
            marker = model.row_a[row]
            if side == 1:
                marker = model.row_b[row]
            interface = model.marker_interface[marker]
            if interface >= 0:
                pull = real(0.0)
                for c in range(6):
                    pull += wp.abs(row_pull[w, 2 * row + side, c]) * model.interface_reach[interface, c]
                modal_scale = wp.max(modal_scale, CANCELLED * wp.abs(lam[w, row]) * pull)
        row += 1
    worst = wp.max(worst, open_load / modal_scale)
    history[w, wp.min(ctl[w, k.ITERATION], 31)] = worst
    if not wp.isfinite(worst + sum):
        ctl[w, k.FAILURE] = ctl[w, k.FAILURE] | k.NOT_FINITE
        ctl[w, k.RUN] = 0
        return
    ctl[w, k.REFRESH] = 0
    if worst > REFRESH_ABOVE:
        ctl[w, k.REFRESH] = 1
    if worst <= model.residual_tolerance and (ctl[w, k.REASSEMBLE] == 0 or model.pair_count == 0):
        ctl[w, k.RUN] = 0
    elif ctl[w, k.ITERATION] >= model.max_iterations:
        ctl[w, k.FAILURE] = ctl[w, k.FAILURE] | k.NOT_CONVERGED
        ctl[w, k.RUN] = 0


@wp.kernel
def advance_outer(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    z: wp.array(dtype=real),
    psi_inverse: wp.array2d(dtype=mat33),
    dx: wp.array2d(dtype=vec3),
    psi: wp.array2d(dtype=vec3),
):
    """Per body: apply the Newton increments once the active set has settled."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.CHANGES] != 0:
        return
    b = lane
    while b < model.body_count:
        o = w * model.outer_count + 6 * b
        dx[w, b] = dx[w, b] + vec3(z[o], z[o + 1], z[o + 2])
        psi[w, b] = psi[w, b] + psi_inverse[w, b] * vec3(z[o + 3], z[o + 4], z[o + 5])
        b += wp.block_dim()


@wp.kernel
def advance_rest(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    z: wp.array(dtype=real),
    modal_step: wp.array(dtype=real),
    lam: wp.array2d(dtype=real),
    dq: wp.array2d(dtype=real),
):
    """Lanes over rows and modes."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.CHANGES] != 0:
        return
    i = lane
    while i < model.row_count + model.modal_count:
        if i < model.row_count:
            lam[w, i] = lam[w, i] + z[w * model.outer_count + model.row_offset + i]
        else:
            n = i - model.row_count
            dq[w, n] = dq[w, n] + modal_step[w * model.modal_count + n]
        i += wp.block_dim()


@wp.kernel
def count_iteration(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    any_running: wp.array(dtype=int),
):
    """One thread for all worlds: bookkeeping of the loop, and its condition."""
    model = models[0]
    running = int(0)
    w = int(0)
    while w < ctl.shape[0]:
        if ctl[w, k.RUN] != 0:
            ctl[w, k.MOVED] = 0
            ctl[w, k.PENDING_SOLVES] = ctl[w, k.PENDING_SOLVES] + 1
            ctl[w, k.INNER] = ctl[w, k.INNER] + 1
            if ctl[w, k.CHANGES] == 0:
                ctl[w, k.MOVED] = 1
                ctl[w, k.ITERATION] = ctl[w, k.ITERATION] + 1
                ctl[w, k.INNER] = 0
            elif ctl[w, k.REASSEMBLE] != 0:
                ctl[w, k.MOVED] = 1  # a window was widened: evaluate again, with the pressures found so far
            elif ctl[w, k.INNER] >= model.max_inner + model.max_guarded:
                ctl[w, k.FAILURE] = ctl[w, k.FAILURE] | k.CYCLING
                ctl[w, k.RUN] = 0
            if ctl[w, k.FAILURE] != 0:
                ctl[w, k.RUN] = 0
            running += ctl[w, k.RUN]
        w += 1
    any_running[0] = running
