"""The outer system: rigid coordinates and multipliers, with the global modes condensed.

With `sigma` the diagonal tangent of the modes, J their gradient of the weak gaps, C and C_m the gradients of the rows by rigid and
modal coordinates, the linearised step reads (s: hat pressures in total, everything else increments)

    S dx + C^T dlam - L_r^T s = -r,             sigma dq + C_m^T dlam - J^T s = -r_m,
    C dx + C_m dq - E dlam = -c,                gap + L_r dx + J dq + G_local s = 0 on the active set.

Eliminating dq leaves, for z = (dx, dlam),

    [ S   C^T                       ]         [ -r                      ]
    [ C   -C_m sigma^-1 C_m^T - E   ] z  =    [ -c + C_m sigma^-1 r_m   ]  + L^T s,       L = [L_r, -J sigma^-1 C_m^T].

Its inverse H is formed once per Newton iteration (tens of unknowns); contact then sees the compliance
`G + L H L^T`, in which whatever can move is condensed (Josephy-Newton): the first iteration already knows what will touch.
"""

import warp as wp

from warpffrf_kernels import control as k
from warpffrf_kernels.model import Model
from warpffrf_kernels.scalars import MODULE_OPTIONS, mat33, real, vec3

wp.set_module_options(MODULE_OPTIONS)

PIVOT_TOLERANCE = wp.constant(wp.float64(1.0e-13))  # of the equilibrated matrix: below it a row is dependent on the others


@wp.kernel
def add_multipliers(
    model: Model,
    ctl: wp.array2d(dtype=int),
    lam: wp.array2d(dtype=real),
    C: wp.array3d(dtype=real),
    C_modal: wp.array3d(dtype=real),
    residual: wp.array2d(dtype=real),
    modal_residual: wp.array2d(dtype=real),
):
    """Lanes over rigid and modal coordinates: r += C^T lambda."""
    w, i = wp.tid()
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0:
        return
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


@wp.kernel
def condense(
    model: Model,
    ctl: wp.array2d(dtype=int),
    C: wp.array3d(dtype=real),
    C_modal: wp.array3d(dtype=real),
    receptance: wp.array2d(dtype=real),
    softness: wp.array2d(dtype=real),
    defect: wp.array2d(dtype=real),
    residual: wp.array2d(dtype=real),
    modal_residual: wp.array2d(dtype=real),
    tangent: wp.array3d(dtype=real),
    rhs: wp.array2d(dtype=real),
):
    """Lanes over outer unknowns: rows of the condensed matrix (rigid blocks are there already) and its right-hand side."""
    w, i = wp.tid()
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0:
        return
    rigid = 6 * model.body_count
    if i < rigid:
        rhs[w, i] = -residual[w, i]
        j = int(0)
        while j < rigid:
            if j / 6 != i / 6:
                tangent[w, i, j] = real(0.0)
            j += 1
        row = int(0)
        while row < model.row_count:
            tangent[w, i, rigid + row] = C[w, row, i]
            row += 1
        return
    row = i - rigid
    j = int(0)
    while j < rigid:
        tangent[w, i, j] = C[w, row, j]
        j += 1
    value = -defect[w, row]
    n = int(0)
    while n < model.modal_count:
        value += C_modal[w, row, n] * receptance[w, n] * modal_residual[w, n]
        n += 1
    rhs[w, i] = value
    other = int(0)
    while other < model.row_count:
        total = real(0.0)
        n = int(0)
        while n < model.modal_count:
            total -= C_modal[w, row, n] * receptance[w, n] * C_modal[w, other, n]
            n += 1
        if other == row:
            total -= softness[w, row]
        tangent[w, i, rigid + other] = total
        other += 1


# Inverse of the equilibrated matrix by Gauss-Jordan elimination with row pivoting; rows of [A | I] stay contiguous.
@wp.func_native("""
    const int n = model.outer_count, ld = 2 * n;
    double* a = work.data + (size_t)w * n * ld;
    double* scale = scaling.data + (size_t)w * n;
    const double* A = tangent.data + (size_t)w * n * n;
    const int rigid = 6 * model.body_count, L = WP_TILE_THREAD_IDX, NL = WP_TILE_BLOCK_DIM;
    for (int i = L; i < n; i += NL) {
        double big = 0.0;
        if (i < rigid) big = ::fabs(A[(size_t)i * n + i]);
        scale[i] = big > 0.0 ? 1.0 / ::sqrt(big) : 1.0;
    }
    WP_TILE_SYNC();
    for (int i = rigid + L; i < n; i += NL) {
        double big = 0.0;
        for (int j = 0; j < rigid; ++j) { const double x = ::fabs(A[(size_t)i * n + j]) * scale[j]; if (x > big) big = x; }
        if (big == 0.0) big = ::sqrt(::fabs(A[(size_t)i * n + i]));
        scale[i] = big > 0.0 ? 1.0 / big : 1.0;
    }
    WP_TILE_SYNC();
    for (int e = L; e < n * ld; e += NL) {
        const int i = e / ld, j = e % ld;
        a[e] = j < n ? A[(size_t)i * n + j] * scale[i] * scale[j] : (j - n == i ? 1.0 : 0.0);
    }
    WP_TILE_SYNC();
    int bad = 0;
    for (int p = 0; p < n; ++p) {
        int best = p;
        for (int i = p + 1; i < n; ++i) if (::fabs(a[(size_t)i * ld + p]) > ::fabs(a[(size_t)best * ld + p])) best = i;
        WP_TILE_SYNC();
        double* u = a + (size_t)p * ld;
        if (best != p) { double* x = a + (size_t)best * ld; for (int j = L; j < ld; j += NL) { const double t = u[j]; u[j] = x[j]; x[j] = t; } }
        WP_TILE_SYNC();
        double pivot = u[p];
        if (!(::fabs(pivot) > tolerance)) { bad = 1; pivot = 1.0; }
        WP_TILE_SYNC();
        for (int j = p + L; j <= n + p && j < ld; j += NL) u[j] /= pivot;
        for (int j = n + p + 1 + L; j < ld; j += NL) u[j] /= pivot;
        WP_TILE_SYNC();
        for (int i = 0; i < n; ++i) {
            if (i == p) continue;
            double* x = a + (size_t)i * ld; const double m = x[p];
            WP_TILE_SYNC();
            if (m != 0.0) for (int j = p + L; j < ld; j += NL) x[j] -= m * u[j];
            WP_TILE_SYNC();
        }
    }
    for (int e = L; e < n * n; e += NL) {
        const int i = e / n, j = e % n;
        inverse.data[(size_t)w * n * n + e] = a[(size_t)i * ld + n + j] * scale[i] * scale[j];
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
    work: wp.array3d(dtype=real),
    inverse: wp.array3d(dtype=real),
) -> int: ...


@wp.kernel
def factor_outer(
    model: Model,
    tangent: wp.array3d(dtype=real),
    rhs: wp.array2d(dtype=real),
    ctl: wp.array2d(dtype=int),
    scaling: wp.array2d(dtype=real),
    work: wp.array3d(dtype=real),
    inverse: wp.array3d(dtype=real),
    z_free: wp.array2d(dtype=real),
):
    """Per world: H, and z without contact, H rhs."""
    w, lane = wp.tid()
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0:
        return
    bad = invert(model, w, PIVOT_TOLERANCE, tangent, scaling, work, inverse)
    if bad != 0 and lane == 0:
        ctl[w, k.FAILURE] = ctl[w, k.FAILURE] | k.SINGULAR
    i = lane
    while i < model.outer_count:
        total = real(0.0)
        j = int(0)
        while j < model.outer_count:
            total += inverse[w, i, j] * rhs[w, j]
            j += 1
        z_free[w, i] = total
        i += wp.block_dim()


@wp.kernel
def balance(
    model: Model,
    ctl: wp.array2d(dtype=int),
    clk: wp.array2d(dtype=real),
    r1: wp.array2d(dtype=vec3),
    axes: wp.array2d(dtype=mat33),
    v1_rate: wp.array2d(dtype=vec3),
    lam: wp.array2d(dtype=real),
    defect: wp.array2d(dtype=real),
    softness: wp.array2d(dtype=real),
    pair_wrench: wp.array3d(dtype=real),
    gap_defect: wp.array2d(dtype=real),
    residual: wp.array2d(dtype=real),
    history: wp.array2d(dtype=real),
):
    """Per world: is the state balanced? Residual forces with contact, row defects and gaps left open, all as fractions.

    The scale of forces is the largest of weight, inertia force, multiplier and contact force; of lengths, 1 m for joints and the
    largest rigid penetration for gaps (`gap_defect` arrives scaled).
    """
    w = wp.tid()
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0 or ctl[w, k.ITERATION] == 0:
        return
    scale = real(1.0e-30)
    b = int(0)
    while b < model.body_count:
        scale = wp.max(scale, model.mass[b] * (wp.length(model.gravity) + wp.length(v1_rate[w, b])))
        b += 1
    worst = real(0.0)
    row = int(0)
    while row < model.row_count:
        if model.row_kind[row] == k.TRANSLATION or model.row_kind[row] == k.DISTANCE:
            scale = wp.max(scale, wp.abs(lam[w, row]))
        if softness[w, row] == real(0.0):
            worst = wp.max(worst, wp.abs(defect[w, row]))
        row += 1
    pair = int(0)
    while pair < model.pair_count:
        f = vec3(pair_wrench[w, pair, 0], pair_wrench[w, pair, 1], pair_wrench[w, pair, 2])
        scale = wp.max(scale, wp.length(f))
        pair += 1
    b = int(0)
    while b < model.body_count:
        f = vec3(residual[w, 6 * b], residual[w, 6 * b + 1], residual[w, 6 * b + 2])
        t = vec3(residual[w, 6 * b + 3], residual[w, 6 * b + 4], residual[w, 6 * b + 5])
        pair = int(0)
        while pair < model.pair_count:
            A = model.surface_body[model.pair_first[pair]]
            B = model.surface_body[model.pair_second[pair]]
            cf = vec3(pair_wrench[w, pair, 0], pair_wrench[w, pair, 1], pair_wrench[w, pair, 2])
            ct = vec3(pair_wrench[w, pair, 3], pair_wrench[w, pair, 4], pair_wrench[w, pair, 5])
            if b == A:
                f -= cf
                t -= wp.transpose(axes[w, b]) * ct
            if b == B:
                f += cf
                t += wp.transpose(axes[w, b]) * (ct + wp.cross(r1[w, A] - r1[w, B], cf))
            pair += 1
        # a torque is measured by the force that it is at the radius of gyration
        gyration = wp.sqrt(model.inertia[b][0, 0] / model.mass[b])
        worst = wp.max(worst, wp.max(wp.length(f), wp.length(t) / gyration) / scale)
        b += 1
    worst = wp.max(worst, gap_defect[w, 0])
    clk[w, k.RESIDUAL] = worst
    clk[w, k.FORCE_SCALE] = scale
    history[w, wp.min(ctl[w, k.ITERATION], 31)] = worst
    if not wp.isfinite(worst):
        ctl[w, k.FAILURE] = ctl[w, k.FAILURE] | k.NOT_FINITE
        ctl[w, k.RUN] = 0
        return
    if worst <= model.residual_tolerance and (ctl[w, k.REASSEMBLE] == 0 or model.pair_count == 0):
        ctl[w, k.RUN] = 0
    elif ctl[w, k.ITERATION] >= model.max_iterations:
        ctl[w, k.FAILURE] = ctl[w, k.FAILURE] | k.NOT_CONVERGED
        ctl[w, k.RUN] = 0


@wp.kernel
def advance_outer(
    model: Model,
    ctl: wp.array2d(dtype=int),
    z: wp.array2d(dtype=real),
    psi_inverse: wp.array2d(dtype=mat33),
    dx: wp.array2d(dtype=vec3),
    psi: wp.array2d(dtype=vec3),
):
    """Per body: apply the Newton increments once the active set has settled."""
    w, b = wp.tid()
    if ctl[w, k.RUN] == 0 or ctl[w, k.CHANGES] != 0:
        return
    o = 6 * b
    dx[w, b] = dx[w, b] + vec3(z[w, o], z[w, o + 1], z[w, o + 2])
    psi[w, b] = psi[w, b] + psi_inverse[w, b] * vec3(z[w, o + 3], z[w, o + 4], z[w, o + 5])


@wp.kernel
def advance_rest(
    model: Model,
    ctl: wp.array2d(dtype=int),
    z: wp.array2d(dtype=real),
    modal_step: wp.array2d(dtype=real),
    lam: wp.array2d(dtype=real),
    dq: wp.array2d(dtype=real),
):
    """Lanes over rows and modes."""
    w, i = wp.tid()
    if ctl[w, k.RUN] == 0 or ctl[w, k.CHANGES] != 0:
        return
    if i < model.row_count:
        lam[w, i] = lam[w, i] + z[w, 6 * model.body_count + i]
    else:
        n = i - model.row_count
        dq[w, n] = dq[w, n] + modal_step[w, n]


@wp.kernel
def count_iteration(
    model: Model,
    ctl: wp.array2d(dtype=int),
    any_running: wp.array(dtype=int),
):
    """One thread for all worlds: bookkeeping of the loop, and its condition."""
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
            elif ctl[w, k.INNER] >= model.max_inner:
                ctl[w, k.FAILURE] = ctl[w, k.FAILURE] | k.CYCLING
                ctl[w, k.RUN] = 0
            if ctl[w, k.FAILURE] != 0:
                ctl[w, k.RUN] = 0
            running += ctl[w, k.RUN]
        w += 1
    any_running[0] = running
