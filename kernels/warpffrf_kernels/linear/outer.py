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

Its inverse H is formed in the first Newton iteration, and again while the residual is above `balance.REFRESH_ABOVE`
(tens of unknowns; without contact `sparse_outer` solves instead). Contact then sees the compliance `G + L H L^T`, in
which whatever can move is condensed (Josephy-Newton): the first iteration already knows what will touch.
"""

import warp as wp

from warpffrf_kernels.bodies.interfaces import compliance, modal_line, pulled, side_of
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import changed, inout, out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, mat33, real, sync, vec3

wp.set_module_options(MODULE_OPTIONS)

PIVOT_TOLERANCE = wp.constant(wp.float64(1.0e-13))  # of the equilibrated matrix: below, a row depends on the others


@wp.kernel
def add_multipliers(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    lam: wp.array2d(dtype=real),
    C: wp.array3d(dtype=real),
    C_modal: wp.array(dtype=real),
    residual: changed(wp.array2d(dtype=real)),
    modal_residual: changed(wp.array(dtype=real)),
):
    """Lanes over rigid coordinates, then over modes: r += C^T lambda."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    i = lane
    while i < 6 * model.bodies.count:
        total = real(0.0)
        row = int(0)
        while row < model.rows.count:
            total += C[w, row, i] * lam[w, row]
            row += 1
        residual[w, i] = residual[w, i] + total
        i += wp.block_dim()
    row = int(0)
    while row < model.rows.count:
        for side in range(2):
            b = side_of(model, row, side)
            if b >= 0:
                at = w * model.modes.count + model.bodies.modal_start[b]
                axpy(
                    model.bodies.global_count[b], lam[w, row], C_modal, modal_line(model, w, row, b), modal_residual, at
                )
        row += 1


@wp.func
def entry_of_rows(
    model: Model,
    w: int,
    row: int,
    other: int,
    C_modal: wp.array(dtype=real),
    receptance: wp.array(dtype=real),
    softness: wp.array2d(dtype=real),
    flexibility: wp.array(dtype=real),
) -> real:
    """-C_m sigma^-1 C_m^T - E of two rows; E couples the rows of a group of springs, else it is diagonal."""
    total = -compliance(model, w, row, other, C_modal, receptance)
    group = model.rows.group[row]
    if group >= 0 and group == model.rows.group[other]:
        first = model.groups.start[group]
        entry = 6 * (row - first) + other - first
        total -= flexibility[(w * model.groups.count + group) * 36 + entry]
    elif other == row:
        total -= softness[w, row]
    return total


@wp.kernel
def condense(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    C: wp.array3d(dtype=real),
    C_modal: wp.array(dtype=real),
    receptance: wp.array(dtype=real),
    softness: wp.array2d(dtype=real),
    flexibility: wp.array(dtype=real),
    defect: wp.array2d(dtype=real),
    residual: wp.array2d(dtype=real),
    modal_residual: wp.array(dtype=real),
    tangent: out(wp.array3d(dtype=real)),
    rhs: out(wp.array2d(dtype=real)),
    C_receptance: out(wp.array(dtype=real)),
):
    """Lanes over outer unknowns: rows of the condensed matrix (rigid blocks are there already) and its right-hand
    side.
    """
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    i = lane
    while i < model.outer.count:
        rigid = model.outer.row_offset
        if i < 6 * model.bodies.count:
            rhs[w, i] = -residual[w, i]
        elif i < rigid:
            rhs[w, i] = -modal_residual[w * model.modes.count + model.dense.mode[i - 6 * model.bodies.count]]
        else:
            rhs[w, i] = -defect[w, i - rigid] + pulled(model, w, i - rigid, C_modal, receptance, modal_residual)
        if ctl[w].refresh != 0:
            if i >= rigid:
                for side in range(2):
                    b = side_of(model, i - rigid, side)
                    if b >= 0:
                        line = modal_line(model, w, i - rigid, b)
                        first = w * model.modes.count + model.bodies.modal_start[b]
                        n = int(0)
                        while n < model.bodies.global_count[b]:
                            C_receptance[line + n] = C_modal[line + n] * receptance[first + n]
                            n += 1
            j = int(0)
            while j < rigid:
                if i >= rigid:
                    if j < 6 * model.bodies.count:
                        tangent[w, i, j] = C[w, i - rigid, j]
                    else:
                        line = (w * model.rows.count + i - rigid) * model.modes.count
                        tangent[w, i, j] = C_modal[line + model.dense.mode[j - 6 * model.bodies.count]]
                elif j < 6 * model.bodies.count and i < 6 * model.bodies.count and j / 6 != i / 6:
                    tangent[w, i, j] = real(0.0)
                j += 1
            other = int(0)
            while other < model.rows.count:
                total = real(0.0)
                if i < 6 * model.bodies.count:
                    total = C[w, other, i]
                elif i < rigid:
                    line = (w * model.rows.count + other) * model.modes.count
                    total = C_modal[line + model.dense.mode[i - 6 * model.bodies.count]]
                else:
                    total = entry_of_rows(model, w, i - rigid, other, C_modal, receptance, softness, flexibility)
                tangent[w, i, rigid + other] = total
                other += 1
        i += wp.block_dim()


# Inverse of the equilibrated matrix by Gauss-Jordan elimination in place, with row pivoting; rows stay contiguous.
# Native for contiguous inner loops like `axpy`; not measured separately. Returns 1 if a pivot is below `tolerance`.
@wp.func_native("""
    const int n = model.outer.count, rigid = model.outer.row_offset, L = WP_TILE_THREAD_IDX, NL = WP_TILE_BLOCK_DIM;
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


@wp.func
def apply_inverse(
    model: Model,
    w: int,
    lane: int,
    first: int,
    rhs: wp.array(dtype=real),
    at: int,
    inverse_transposed: wp.array(dtype=real),
    z: wp.array(dtype=real),
):
    """z[w] = H (0, rhs[at:]), `first` zeros in front; one block per world."""
    N = model.outer.count
    i = lane
    while i < N:
        z[w * N + i] = real(0.0)
        i += wp.block_dim()
    sync()
    j = first
    while j < N:
        axpy(N, rhs[at + j - first], inverse_transposed, (w * N + j) * N, z, w * N)
        j += 1


@wp.kernel
def factor_outer(
    models: wp.array(dtype=Model),
    tangent: wp.array3d(dtype=real),
    rhs: wp.array(dtype=real),
    ctl: inout(wp.array(dtype=Control)),
    scaling: inout(wp.array2d(dtype=real)),
    pivots: inout(wp.array2d(dtype=int)),
    work: inout(wp.array3d(dtype=real)),
    inverse_transposed: inout(wp.array(dtype=real)),
    z_free: inout(wp.array(dtype=real)),
):
    """Per world: H^T (where it is to be renewed), and z without contact, H rhs."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    if ctl[w].refresh != 0:
        bad = invert(model, w, PIVOT_TOLERANCE, tangent, scaling, pivots, work, inverse_transposed)
        if bad != 0 and lane == 0:
            ctl[w].failure = ctl[w].failure | k.SINGULAR
    apply_inverse(model, w, lane, 0, rhs, w * model.outer.count, inverse_transposed, z_free)


@wp.kernel
def advance_outer(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    z: wp.array(dtype=real),
    psi_inverse: wp.array2d(dtype=mat33),
    dx: inout(wp.array2d(dtype=vec3)),
    psi: inout(wp.array2d(dtype=vec3)),
):
    """Per body: apply the Newton increments once the active set has settled."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    b = lane
    while b < model.bodies.count:
        o = w * model.outer.count + 6 * b
        dx[w, b] = dx[w, b] + vec3(z[o], z[o + 1], z[o + 2])
        psi[w, b] = psi[w, b] + psi_inverse[w, b] * vec3(z[o + 3], z[o + 4], z[o + 5])
        b += wp.block_dim()


@wp.kernel
def advance_rest(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    z: wp.array(dtype=real),
    modal_step: wp.array(dtype=real),
    lam: inout(wp.array2d(dtype=real)),
    dq: inout(wp.array2d(dtype=real)),
):
    """Lanes over rows and modes."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    i = lane
    while i < model.rows.count + model.modes.count:
        if i < model.rows.count:
            lam[w, i] = lam[w, i] + z[w * model.outer.count + model.outer.row_offset + i]
        else:
            n = i - model.rows.count
            dq[w, n] = dq[w, n] + modal_step[w * model.modes.count + n]
        i += wp.block_dim()


@wp.kernel
def count_iteration(
    models: wp.array(dtype=Model),
    ctl: inout(wp.array(dtype=Control)),
    any_running: out(wp.array(dtype=int)),
):
    """One thread for all worlds: bookkeeping of the loop, and its condition."""
    model = models[0]
    running = int(0)
    w = int(0)
    while w < ctl.shape[0]:
        if ctl[w].run != 0:
            ctl[w].moved = 0
            ctl[w].pending_solves = ctl[w].pending_solves + 1
            ctl[w].inner = ctl[w].inner + 1
            if ctl[w].changes == 0:
                ctl[w].moved = 1
                ctl[w].iteration = ctl[w].iteration + 1
                ctl[w].inner = 0
            elif ctl[w].reassemble != 0:
                ctl[w].moved = 1  # a window was widened: evaluate again, with the pressures found so far
            elif ctl[w].inner >= model.limits.max_inner + model.limits.max_guarded:
                ctl[w].failure = ctl[w].failure | k.CYCLING
                ctl[w].run = 0
            if ctl[w].failure != 0:
                ctl[w].run = 0
            running += ctl[w].run
        w += 1
    any_running[0] = running
