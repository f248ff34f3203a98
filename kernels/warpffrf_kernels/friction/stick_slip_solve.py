r"""Tractions of the cells: stick and slip of all cells at once, for given bounds.

With r(tau) = r_0 + K tau the weak slips that the tractions lead to, K symmetric positive definite
(`cell_compliance`) and everything else that moves with them condensed, Coulomb's law in every cell i reads

    |tau_i| <= b_i,     r_i = 0 where |tau_i| < b_i,     r_i = -lambda_i tau_i, lambda_i >= 0 where |tau_i| = b_i,

the conditions of the strictly convex problem min tau.K tau/2 + r_0.tau over discs: its solution exists and is the only
one (Panagiotopoulos; Kalker's tangential problem). The regularised law adds `area h v_slip/b_i` to the diagonal, a cell
that the patch has reached during the step its softness (`bounds`).

A few sweeps of projected Gauss-Seidel over 2 x 2 blocks, which decrease the objective always, find who sticks; a
semismooth Newton method then has quadratic convergence. With y_i = tau_i - r_i/c (c the block's stiffness) a cell
sticks where |y_i| <= b_i and is free in both directions. A sliding one is put on its circle, tau = b d + alpha t with
d = y/|y| and t across it, and keeps the free coordinate alpha: t.r + lambda alpha = 0 with lambda = -r.d/b, so that the
reduced matrix stays symmetric positive definite.

Where Newton does not settle, an interior-point method comes near the solution. It does on a body that turns freely,
which all tractions move alike, by 1e4 times as much as what they do to each other: from all sliding one way Newton goes
to all sliding the other. With c_i = (b_i^2 - |tau_i|^2)/2 > 0 and lambda_i > 0, a Newton step of

    r + lambda tau = 0,      lambda_i c_i = mu,      (K + lambda + (lambda/c) tau tau^T) dtau = -r - (mu/c) tau,

mu a tenth of the mean of lambda c, goes at most to where a cell would leave its disc, or its lambda be negative; some
ten of them suffice from any start (the primal-dual method of convex programs). Sweeps are the last resort.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import inout
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync

wp.set_module_options(MODULE_OPTIONS)

SLOW = wp.constant(wp.float64(0.1))  # of the defect before: an old factor that leaves more is formed anew
SETTLED = wp.constant(wp.float64(1.0e-12))  # of the largest bound: below the tolerance of the outer iteration
SWEEPS = wp.constant(3)  # of Gauss-Seidel before Newton
MORE_SWEEPS = wp.constant(20)  # where Newton has not settled from within either
NEWTON = wp.constant(12)  # iterations between two rounds of sweeps
ROUNDS = wp.constant(20)  # of sweeps and Newton iterations
INTERIOR = wp.constant(60)  # steps of the interior-point method at most: 10 to 20 are needed
NEAR = wp.constant(wp.float64(1.0e-6))  # of the largest bound, or SETTLED: where they end the first time, and again


# One round of sweeps: every cell takes the traction that is best for it with the others held, the point of its disc
# where its 2 x 2 problem has its minimum. Of one lane: Gauss-Seidel is sequential.
@wp.func_native("""
    const int cap = 2 * model.capacity.cells;
    const double* A = K.data + (size_t)w * cap * cap;
    double* x = tau.data + (size_t)w * cap;
    const double* r0 = right.data + (size_t)w * cap;
    const double* b = radius.data + (size_t)w * model.capacity.cells;
    const double* soft = softness.data + (size_t)w * model.capacity.cells;
    if (WP_TILE_THREAD_IDX == 0)
    for (int sweep = 0; sweep < sweeps; ++sweep) for (int i = 0; i < count; ++i) {
        const int p = 2 * i;
        if (!(b[i] > 0.0)) { x[p] = x[p + 1] = 0.0; continue; }
        const double *a0 = A + (size_t)p * cap, *a1 = a0 + cap;
        double s0[8] = {0.0}, s1[8] = {0.0}; const int n = 2 * count; int j = 0;
        for (; j + 7 < n; j += 8) for (int c = 0; c < 8; ++c) {
            s0[c] += a0[j + c] * x[j + c]; s1[c] += a1[j + c] * x[j + c];
        }
        double r_0 = r0[p], r_1 = r0[p + 1];
        for (; j < n; ++j) { r_0 += a0[j] * x[j]; r_1 += a1[j] * x[j]; }
        for (int c = 0; c < 8; ++c) { r_0 += s0[c]; r_1 += s1[c]; }
        const double k00 = a0[p] + soft[i], k01 = a0[p + 1], k11 = a1[p + 1] + soft[i];
        // y = K_ii tau - r without the soft part: the block's own right-hand side
        const double y0 = a0[p] * x[p] + k01 * x[p + 1] - r_0, y1 = k01 * x[p] + a1[p + 1] * x[p + 1] - r_1;
        const double det = k00 * k11 - k01 * k01;
        double t0 = (k11 * y0 - k01 * y1) / det, t1 = (k00 * y1 - k01 * y0) / det;
        if (t0 * t0 + t1 * t1 > b[i] * b[i]) {  // (K + lambda) tau = y on the circle: Newton on 1/|tau|, monotone
            double lambda = 0.0;
            for (int it = 0; it < 30; ++it) {
                const double m00 = k00 + lambda, m11 = k11 + lambda, d = m00 * m11 - k01 * k01;
                t0 = (m11 * y0 - k01 * y1) / d; t1 = (m00 * y1 - k01 * y0) / d;
                const double size = ::sqrt(t0 * t0 + t1 * t1);
                if (size <= b[i] * (1.0 + 1e-14)) break;
                const double g = (m11 * t0 * t0 - 2.0 * k01 * t0 * t1 + m00 * t1 * t1) / d;  // tau.(K+lambda)^-1 tau
                lambda += (size - b[i]) / b[i] * size * size / g;
            }
            const double scale = b[i] / ::sqrt(t0 * t0 + t1 * t1);
            t0 *= scale; t1 *= scale;
        }
        x[p] = t0; x[p + 1] = t1;
    }
    WP_TILE_SYNC();
""")
def sweep_cells(
    model: Model,
    w: int,
    count: int,
    sweeps: int,
    K: wp.array3d(dtype=real),
    right: wp.array2d(dtype=real),
    radius: wp.array2d(dtype=real),
    softness: wp.array2d(dtype=real),
    tau: wp.array2d(dtype=real),
): ...


# Residuals of the tractions, who sticks (1), slides (2) or is free of load (0), and the right-hand side of the reduced
# system after sliding cells have jumped to their circles. Returns the defect of the tractions as a fraction of the
# largest bound; outcome[1] is 1 where a kind differs from that of the factorisation at hand.
@wp.func_native("""
    const int cap = 2 * model.capacity.cells, L = WP_TILE_THREAD_IDX, NL = WP_TILE_BLOCK_DIM, n = 2 * count;
    const double* A = K.data + (size_t)w * cap * cap;
    const double* x = tau.data + (size_t)w * cap;
    double* r = slip.data + (size_t)w * cap;
    double* dir = direction.data + (size_t)w * cap;
    double* jump = jumps.data + (size_t)w * cap;
    int* kind = sliding.data + (size_t)w * 2 * model.capacity.cells;  // present, then of the factorisation
    double* report = outcome.data + (size_t)w * 2;
    const double* b = radius.data + (size_t)w * model.capacity.cells;
    const double* soft = softness.data + (size_t)w * model.capacity.cells;
    for (int pass = 0; pass < 2; ++pass) {  // r = right + K tau + soft tau, then what the jumps add to it
        const double* v = pass == 0 ? x : jump;
        for (int i = L; i < n; i += NL) {
            const double* a = A + (size_t)i * cap; double s[8] = {0.0}; int j = 0;
            for (; j + 7 < n; j += 8) for (int c = 0; c < 8; ++c) s[c] += a[j + c] * v[j + c];
            double sum = (pass == 0 ? right.data[(size_t)w * cap + i] : r[i]) + soft[i / 2] * v[i];
            for (; j < n; ++j) sum += a[j] * v[j];
            for (int c = 0; c < 8; ++c) sum += s[c];
            r[i] = sum;
        }
        WP_TILE_SYNC();
        if (pass == 1) break;
        if (L == 0) {
            double defect = 0.0, largest = 0.0; int changed = 0, jumped = 0;
            for (int i = 0; i < count; ++i) {
                const int p = 2 * i;
                int found = 0; jump[p] = jump[p + 1] = 0.0;
                if (b[i] > 0.0) {
                    const double c = 0.5 * (A[(size_t)p * cap + p] + A[(size_t)(p + 1) * cap + p + 1]) + soft[i];
                    const double y0 = x[p] - r[p] / c, y1 = x[p + 1] - r[p + 1] / c;
                    const double size = ::sqrt(y0 * y0 + y1 * y1);
                    double v0 = y0, v1 = y1; found = 1;
                    if (size > b[i]) {
                        found = 2; dir[p] = y0 / size; dir[p + 1] = y1 / size;
                        v0 = b[i] * dir[p]; v1 = b[i] * dir[p + 1];
                        jump[p] = v0 - x[p]; jump[p + 1] = v1 - x[p + 1];
                        if (jump[p] != 0.0 || jump[p + 1] != 0.0) jumped = 1;
                        const double lambda = -(r[p] * dir[p] + r[p + 1] * dir[p + 1]) / b[i];
                        curvature.data[(size_t)w * model.capacity.cells + i] = lambda > 0.0 ? lambda : 0.0;
                    }
                    const double e = ::sqrt((v0 - x[p]) * (v0 - x[p]) + (v1 - x[p + 1]) * (v1 - x[p + 1]));
                    defect = defect > e ? defect : e; largest = largest > b[i] ? largest : b[i];
                }
                if (found != kind[model.capacity.cells + i]) changed = 1;
                kind[i] = found;
            }
            report[0] = largest > 0.0 ? defect / largest : 0.0; report[1] = (double)(changed + 2 * jumped);
        }
        WP_TILE_SYNC();
        if (report[1] < 2.0) break;
    }
    WP_TILE_SYNC();
    return report[0];
""")
def judge_cells(
    model: Model,
    w: int,
    count: int,
    K: wp.array3d(dtype=real),
    right: wp.array2d(dtype=real),
    radius: wp.array2d(dtype=real),
    softness: wp.array2d(dtype=real),
    tau: wp.array2d(dtype=real),
    slip: wp.array2d(dtype=real),
    jumps: wp.array2d(dtype=real),
    direction: wp.array2d(dtype=real),
    curvature: wp.array2d(dtype=real),
    sliding: wp.array2d(dtype=int),
    outcome: wp.array2d(dtype=real),
) -> real: ...


# Cholesky factor of the first m lines in `work`, upper triangle. Returns 1 where it is not definite.
@wp.func_native("""
    const int ld = 2 * model.capacity.cells, L = WP_TILE_THREAD_IDX, NL = WP_TILE_BLOCK_DIM;
    double* U = work.data + (size_t)w * ld * ld;
    int bad = 0;
    for (int p = 0; p < m; p += 4) {
        const int kb = m - p < 4 ? m - p : 4;
        for (int q = 0; q < kb; ++q) {
            double* u = U + (size_t)(p + q) * ld;
            double pivot = u[p + q];
            WP_TILE_SYNC();
            if (!(pivot > 0.0)) { bad = 1; pivot = 1.0; }
            const double root = ::sqrt(pivot), scale = 1.0 / root;
            for (int j = p + q + L; j < m; j += NL) u[j] = j == p + q ? root : u[j] * scale;
            WP_TILE_SYNC();
            for (int s = q + 1; s < kb; ++s) { double* y = U + (size_t)(p + s) * ld; const double f = u[p + s];
                for (int j = p + s + L; j < m; j += NL) y[j] -= f * u[j]; }
            WP_TILE_SYNC();
        }
        if (kb == 4) {
            const double *u0 = U + (size_t)p * ld, *u1 = u0 + ld, *u2 = u1 + ld, *u3 = u2 + ld;
            for (int i = p + 4; i < m; ++i) { double* __restrict y = U + (size_t)i * ld;
                const double f0 = u0[i], f1 = u1[i], f2 = u2[i], f3 = u3[i];
                for (int j = i + L; j < m; j += NL) y[j] -= f0 * u0[j] + f1 * u1[j] + f2 * u2[j] + f3 * u3[j]; }
        }
        WP_TILE_SYNC();
    }
    return bad;
""")
def factor_lines(model: Model, w: int, m: int, work: wp.array3d(dtype=real)) -> int: ...


# The reduced matrix of the free coordinates: two of a cell that sticks, the one across its direction of a cell that
# slides. Returns their number.
@wp.func_native("""
    const int cap = 2 * model.capacity.cells, L = WP_TILE_THREAD_IDX, NL = WP_TILE_BLOCK_DIM;
    const double* A = K.data + (size_t)w * cap * cap;
    const double* dir = direction.data + (size_t)w * cap;
    double* held = frozen.data + (size_t)w * cap;
    int* list = order.data + (size_t)w * cap;
    int* kind = sliding.data + (size_t)w * 2 * model.capacity.cells;
    double* U = work.data + (size_t)w * cap * cap;
    const double* soft = softness.data + (size_t)w * model.capacity.cells;
    int m = 0;
    for (int i = 0; i < count; ++i) {  // every lane counts for itself, in the same order
        if (kind[i] == 0) continue;
        if (L == 0) { list[m] = 2 * i; if (kind[i] == 1) list[m + 1] = 2 * i + 1; }
        m += kind[i] == 1 ? 2 : 1;
    }
    for (int i = L; i < count; i += NL) {
        kind[model.capacity.cells + i] = kind[i]; held[2 * i] = dir[2 * i]; held[2 * i + 1] = dir[2 * i + 1];
    }
    WP_TILE_SYNC();
    for (int u = L; u < m; u += NL) {
        const int p = list[u], i = p / 2;
        const int slide = kind[i] == 2, even = 2 * i;
        const double *a0 = A + (size_t)(slide ? even : p) * cap, *a1 = A + (size_t)(even + 1) * cap;
        const double t0 = slide ? -held[even + 1] : 1.0, t1 = slide ? held[even] : 0.0;
        double* row = U + (size_t)u * cap;
        for (int v = u; v < m; ++v) {
            const int q = list[v], j = q / 2;
            double g0, g1 = 0.0;
            if (kind[j] == 2) {
                const double c0 = -held[2 * j + 1], c1 = held[2 * j];
                g0 = a0[2 * j] * c0 + a0[2 * j + 1] * c1;
                if (slide) g1 = a1[2 * j] * c0 + a1[2 * j + 1] * c1;
            } else { g0 = a0[q]; if (slide) g1 = a1[q]; }
            row[v] = t0 * g0 + t1 * g1;
        }
        row[u] += soft[i] + (slide ? curvature.data[(size_t)w * model.capacity.cells + i] : 0.0);
    }
    WP_TILE_SYNC();
    return m;
""")
def reduce_cells(
    model: Model,
    w: int,
    count: int,
    K: wp.array3d(dtype=real),
    softness: wp.array2d(dtype=real),
    direction: wp.array2d(dtype=real),
    curvature: wp.array2d(dtype=real),
    frozen: wp.array2d(dtype=real),
    order: wp.array2d(dtype=int),
    sliding: wp.array2d(dtype=int),
    work: wp.array3d(dtype=real),
) -> int: ...


# Solves with the factor at hand and moves the tractions: those that stick by the solution, sliding ones along their
# circles, across their *present* directions (with those of an old factor a slide's own force would count as an error).
# Of one lane beyond the contiguous runs.
@wp.func_native("""
    const int cap = 2 * model.capacity.cells, ld = cap;
    double* x = tau.data + (size_t)w * cap;
    double* y = solution.data + (size_t)w * cap;
    const double* r = slip.data + (size_t)w * cap;
    const double* dir = direction.data + (size_t)w * cap;
    const int* list = order.data + (size_t)w * cap;
    const int* kind = sliding.data + (size_t)w * 2 * model.capacity.cells;
    const double* U = work.data + (size_t)w * cap * ld;
    const double* b = radius.data + (size_t)w * model.capacity.cells;
    if (WP_TILE_THREAD_IDX == 0) {
        for (int u = 0; u < m; ++u) {
            const int p = list[u], i = p / 2;
            y[u] = kind[i] == 2 ? dir[2 * i + 1] * r[2 * i] - dir[2 * i] * r[2 * i + 1] : -r[p];
        }
        for (int u = 0; u < m; ++u) { const double* row = U + (size_t)u * ld; const double v = y[u] / row[u]; y[u] = v;
            for (int j = u + 1; j < m; ++j) y[j] -= row[j] * v; }
        for (int u = m - 1; u >= 0; --u) { const double* row = U + (size_t)u * ld; double v = y[u];
            for (int j = u + 1; j < m; ++j) v -= row[j] * y[j];
            y[u] = v / row[u]; }
        for (int i = 0; i < count; ++i) if (kind[i] == 0) x[2 * i] = x[2 * i + 1] = 0.0;
        for (int u = 0; u < m; ++u) {
            const int p = list[u], i = p / 2;
            if (kind[i] == 2) {
                const double t0 = b[i] * dir[2 * i] - y[u] * dir[2 * i + 1];
                const double t1 = b[i] * dir[2 * i + 1] + y[u] * dir[2 * i];
                const double scale = b[i] / ::sqrt(t0 * t0 + t1 * t1);
                x[2 * i] = t0 * scale; x[2 * i + 1] = t1 * scale;
            } else x[p] += y[u];
        }
    }
    WP_TILE_SYNC();
""")
def move_cells(
    model: Model,
    w: int,
    count: int,
    m: int,
    radius: wp.array2d(dtype=real),
    slip: wp.array2d(dtype=real),
    direction: wp.array2d(dtype=real),
    order: wp.array2d(dtype=int),
    sliding: wp.array2d(dtype=int),
    work: wp.array3d(dtype=real),
    solution: wp.array2d(dtype=real),
    tau: wp.array2d(dtype=real),
): ...


# Start of the interior-point method: no tractions, slips as they are then, lambda the slope of the slip.
@wp.func_native("""
    const int cap = 2 * model.capacity.cells;
    const double* A = K.data + (size_t)w * cap * cap;
    const double* b = radius.data + (size_t)w * model.capacity.cells;
    if (WP_TILE_THREAD_IDX == 0) for (int i = 0; i < count; ++i) {
        const size_t p = (size_t)w * cap + 2 * i;
        const double r0 = right.data[p], r1 = right.data[p + 1];
        tau.data[p] = tau.data[p + 1] = 0.0; slip.data[p] = r0; slip.data[p + 1] = r1;
        const double least = 1e-3 * A[(size_t)2 * i * cap + 2 * i];
        const double slope = b[i] > 0.0 ? ::sqrt(r0 * r0 + r1 * r1) / b[i] : 0.0;
        curvature.data[(size_t)w * model.capacity.cells + i] = slope > least ? slope : least;
    }
    WP_TILE_SYNC();
""")
def begin_inside(
    model: Model,
    w: int,
    count: int,
    K: wp.array3d(dtype=real),
    right: wp.array2d(dtype=real),
    radius: wp.array2d(dtype=real),
    tau: wp.array2d(dtype=real),
    slip: wp.array2d(dtype=real),
    curvature: wp.array2d(dtype=real),
): ...


# The matrix of a step of the interior-point method, over both lines of all loaded cells. Returns their number.
@wp.func_native("""
    const int cap = 2 * model.capacity.cells, L = WP_TILE_THREAD_IDX, NL = WP_TILE_BLOCK_DIM;
    const double* A = K.data + (size_t)w * cap * cap;
    const double* x = tau.data + (size_t)w * cap;
    const double* b = radius.data + (size_t)w * model.capacity.cells;
    int* list = order.data + (size_t)w * cap;
    double* U = work.data + (size_t)w * cap * cap;
    int m = 0;
    for (int i = 0; i < count; ++i) if (b[i] > 0.0) {  // every lane counts for itself, in the same order
        if (L == 0) { list[m] = 2 * i; list[m + 1] = 2 * i + 1; }
        m += 2;
    }
    WP_TILE_SYNC();
    for (int u = L; u < m; u += NL) {
        const int p = list[u], i = p / 2;
        const double lambda = curvature.data[(size_t)w * model.capacity.cells + i];
        const double room = 0.5 * (b[i] * b[i] - x[2 * i] * x[2 * i] - x[2 * i + 1] * x[2 * i + 1]);
        double* row = U + (size_t)u * cap;
        for (int v = u; v < m; ++v) row[v] = A[(size_t)p * cap + list[v]];
        row[u] += softness.data[(size_t)w * model.capacity.cells + i] + lambda + lambda / room * x[p] * x[p];
        if (p % 2 == 0) row[u + 1] += lambda / room * x[p] * x[p + 1];
    }
    WP_TILE_SYNC();
    return m;
""")
def fill_inside(
    model: Model,
    w: int,
    count: int,
    K: wp.array3d(dtype=real),
    radius: wp.array2d(dtype=real),
    softness: wp.array2d(dtype=real),
    tau: wp.array2d(dtype=real),
    curvature: wp.array2d(dtype=real),
    order: wp.array2d(dtype=int),
    work: wp.array3d(dtype=real),
) -> int: ...


# A step of the interior-point method with the factor at hand. Returns the defect of the tractions, as `judge_cells`. Of
# one lane but for the slips.
@wp.func_native("""
    const int cap = 2 * model.capacity.cells, L = WP_TILE_THREAD_IDX, NL = WP_TILE_BLOCK_DIM, n = 2 * count;
    const double* A = K.data + (size_t)w * cap * cap;
    const double* U = work.data + (size_t)w * cap * cap;
    const double* b = radius.data + (size_t)w * model.capacity.cells;
    const double* soft = softness.data + (size_t)w * model.capacity.cells;
    double *x = tau.data + (size_t)w * cap, *r = slip.data + (size_t)w * cap, *y = solution.data + (size_t)w * cap;
    double* lambda = curvature.data + (size_t)w * model.capacity.cells;
    const int* list = order.data + (size_t)w * cap;
    if (L == 0) {
        double mu = 0.0;
        for (int u = 0; u < m; u += 2) { const int p = list[u], i = p / 2;
            mu += 0.5 * lambda[i] * (b[i] * b[i] - x[p] * x[p] - x[p + 1] * x[p + 1]); }
        mu *= 0.1 * 2 / m;
        for (int u = 0; u < m; ++u) { const int p = list[u], e = p - p % 2, i = p / 2;
            y[u] = -r[p] - 2.0 * mu * x[p] / (b[i] * b[i] - x[e] * x[e] - x[e + 1] * x[e + 1]); }
        for (int u = 0; u < m; ++u) { const double* row = U + (size_t)u * cap; const double v = y[u] / row[u]; y[u] = v;
            for (int j = u + 1; j < m; ++j) y[j] -= row[j] * v; }
        for (int u = m - 1; u >= 0; --u) { const double* row = U + (size_t)u * cap; double v = y[u];
            for (int j = u + 1; j < m; ++j) v -= row[j] * y[j];
            y[u] = v / row[u]; }
        double step = 1.0;
        for (int turn = 0; turn < 2; ++turn) for (int u = 0; u < m; u += 2) {  // how far, then the step
            const int p = list[u], i = p / 2;
            const double room = 0.5 * (b[i] * b[i] - x[p] * x[p] - x[p + 1] * x[p + 1]);
            const double a = y[u] * y[u] + y[u + 1] * y[u + 1], along = x[p] * y[u] + x[p + 1] * y[u + 1];
            const double rise = (mu - lambda[i] * room + lambda[i] * along) / room;
            if (turn == 1) { x[p] += step * y[u]; x[p + 1] += step * y[u + 1]; lambda[i] += step * rise; continue; }
            const double root = ::sqrt(along * along + 2.0 * a * room);  // a s^2/2 + along s = room, without cancelling
            const double most = along > 0.0 ? 2.0 * room / (along + root) : a > 0.0 ? (root - along) / a : 1e30;
            if (0.995 * most < step) step = 0.995 * most;
            if (-rise * step > 0.995 * lambda[i]) step = -0.995 * lambda[i] / rise;
        }
    }
    WP_TILE_SYNC();
    for (int i = L; i < n; i += NL) {
        const double* a = A + (size_t)i * cap; double s[8] = {0.0}; int j = 0;
        for (; j + 7 < n; j += 8) for (int c = 0; c < 8; ++c) s[c] += a[j + c] * x[j + c];
        double sum = right.data[(size_t)w * cap + i] + soft[i / 2] * x[i];
        for (; j < n; ++j) sum += a[j] * x[j];
        for (int c = 0; c < 8; ++c) sum += s[c];
        r[i] = sum;
    }
    WP_TILE_SYNC();
    double defect = 0.0, largest = 0.0;
    for (int u = 0; u < m; u += 2) {
        const int p = list[u], i = p / 2;
        const double c = 0.5 * (A[(size_t)p * cap + p] + A[(size_t)(p + 1) * cap + p + 1]) + soft[i];
        const double y0 = x[p] - r[p] / c, y1 = x[p + 1] - r[p + 1] / c, size = ::sqrt(y0 * y0 + y1 * y1);
        const double part = size > b[i] ? b[i] / size : 1.0;
        const double e0 = part * y0 - x[p], e1 = part * y1 - x[p + 1], e = ::sqrt(e0 * e0 + e1 * e1);
        defect = defect > e ? defect : e; largest = largest > b[i] ? largest : b[i];
    }
    WP_TILE_SYNC();
    return largest > 0.0 ? defect / largest : 0.0;
""")
def move_inside(
    model: Model,
    w: int,
    count: int,
    m: int,
    K: wp.array3d(dtype=real),
    right: wp.array2d(dtype=real),
    radius: wp.array2d(dtype=real),
    softness: wp.array2d(dtype=real),
    order: wp.array2d(dtype=int),
    work: wp.array3d(dtype=real),
    solution: wp.array2d(dtype=real),
    tau: wp.array2d(dtype=real),
    slip: wp.array2d(dtype=real),
    curvature: wp.array2d(dtype=real),
) -> real: ...


@wp.func
def come_near(
    model: Model,
    w: int,
    count: int,
    wanted: real,
    K: wp.array3d(dtype=real),
    right: wp.array2d(dtype=real),
    radius: wp.array2d(dtype=real),
    softness: wp.array2d(dtype=real),
    tau: wp.array2d(dtype=real),
    slip: wp.array2d(dtype=real),
    curvature: wp.array2d(dtype=real),
    order: wp.array2d(dtype=int),
    solution: wp.array2d(dtype=real),
    work: wp.array3d(dtype=real),
) -> int:
    """Tractions near the solution, up to a defect of `wanted`, by the interior-point method; returns its steps."""
    begin_inside(model, w, count, K, right, radius, tau, slip, curvature)
    n = int(0)
    defect = real(1.0)
    while n < INTERIOR and defect > wanted:
        m = fill_inside(model, w, count, K, radius, softness, tau, curvature, order, work)
        n += 1
        if factor_lines(model, w, m, work) != 0:
            return n
        defect = move_inside(
            model, w, count, m, K, right, radius, softness, order, work, solution, tau, slip, curvature
        )
    return n


@wp.kernel
def solve_tractions(
    models: wp.array(dtype=Model),
    K: wp.array3d(dtype=real),
    right: wp.array2d(dtype=real),
    radius: wp.array2d(dtype=real),
    softness: wp.array2d(dtype=real),
    ctl: inout(wp.array(dtype=Control)),
    tau: inout(wp.array2d(dtype=real)),
    slip: inout(wp.array2d(dtype=real)),
    jumps: inout(wp.array2d(dtype=real)),
    direction: inout(wp.array2d(dtype=real)),
    frozen: inout(wp.array2d(dtype=real)),
    curvature: inout(wp.array2d(dtype=real)),
    order: inout(wp.array2d(dtype=int)),
    sliding: inout(wp.array2d(dtype=int)),
    outcome: inout(wp.array2d(dtype=real)),
    solution: inout(wp.array2d(dtype=real)),
    work: inout(wp.array3d(dtype=real)),
):
    """Per world: the tractions tau of CELLS slots, from a first guess, for r = right + K tau + softness tau and discs
    of `radius`. A problem that does not settle is a failure of the attempt.

    The factor of the last solve (FACTORED free coordinates) serves as long as nobody changes sides and it is good for
    a tenth of the defect: within a step the matrix hardly changes.
    """
    w, lane = wp.tid()
    model = models[0]
    count = ctl[w].cells
    if ctl[w].run == 0 or ctl[w].changes != 0 or count == 0:
        return
    free = ctl[w].factored
    sync()
    turn = int(0)
    n = int(0)
    before = real(0.0)
    defect = judge_cells(
        model, w, count, K, right, radius, softness, tau, slip, jumps, direction, curvature, sliding, outcome
    )
    while turn < ROUNDS and defect > SETTLED:
        changed = int(outcome[w, 1]) % 2
        poor = free == 0 or changed != 0 or (n > 0 and defect > NEAR)  # all may slide to and fro
        if poor and n % NEWTON == 0:
            if turn == 1 or turn == 2:
                wanted = SETTLED
                if turn == 1:
                    wanted = NEAR
                steps = come_near(
                    model, w, count, wanted, K, right, radius, softness, tau, slip, curvature, order, solution, work
                )
                free = 0
                if lane == 0:
                    ctl[w].solves = ctl[w].solves + steps
            else:
                sweeps = SWEEPS
                if turn > 0:
                    sweeps = MORE_SWEEPS
                sweep_cells(model, w, count, sweeps, K, right, radius, softness, tau)
            turn += 1
            defect = judge_cells(
                model, w, count, K, right, radius, softness, tau, slip, jumps, direction, curvature, sliding, outcome
            )
            changed = int(outcome[w, 1]) % 2
        if free == 0 or changed != 0 or (before > real(0.0) and defect > SLOW * before):
            free = reduce_cells(model, w, count, K, softness, direction, curvature, frozen, order, sliding, work)
            bad = factor_lines(model, w, free, work)
            if lane == 0:
                ctl[w].solves = ctl[w].solves + 1
            if bad != 0:
                if lane == 0:
                    ctl[w].failure = ctl[w].failure | k.INDEFINITE
                    ctl[w].factored = 0
                return
        move_cells(model, w, count, free, radius, slip, direction, order, sliding, work, solution, tau)
        before = defect
        defect = judge_cells(
            model, w, count, K, right, radius, softness, tau, slip, jumps, direction, curvature, sliding, outcome
        )
        n += 1
        if n > ROUNDS * NEWTON:
            turn = ROUNDS
    if lane == 0:
        ctl[w].factored = free
        if defect > SETTLED:
            ctl[w].failure = ctl[w].failure | k.CYCLING
