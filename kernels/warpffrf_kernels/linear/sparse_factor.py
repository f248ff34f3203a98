"""Block LU factorisation with a precomputed pattern, and its solves; see `retained_solve` for the use.

For node e of `Pattern`, with the diagonal block D, the lines U to its right and X below,

    P D = L R,      U <- L^-1 P U,      X <- X R^-1,      A_fg <- A_fg - X_f U_g   for all later coupled nodes f, g,

with row pivoting inside the node only. The matrix is equilibrated first, as in `retained_solve.invert`: bodies by the
roots of their diagonal, rows by their largest entry. Solve: y <- L^-1 P y, y_f <- y_f - X_f y, then z = R^-1 (y - U
z_f) backwards. Native for contiguous inner loops like `scalars.axpy`.

A pivot of rows no larger than the round-off of its cancelling terms indicates a linearly dependent row. It is compared
with the root of the sums of |terms| on the diagonals of its line and its column. This criterion is independent of the
scale of a line: a light body between heavy ones makes pivots small, but nothing cancels in them. The pivots of a body
are positive (`retained_pattern`); their round-off is assessed by the residual.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


@wp.struct
class Pattern:
    """See `warpffrf.online.compile.retained_pattern.RetainedPattern`, whose arrays these are."""

    node_count: int
    retained_count: int
    factor_size: int
    widest: int
    order: wp.array(dtype=int)
    size: wp.array(dtype=int)
    width: wp.array(dtype=int)
    first: wp.array(dtype=int)
    start: wp.array(dtype=int)
    panel_start: wp.array(dtype=int)
    panel: wp.array(dtype=int)
    target_start: wp.array(dtype=int)
    target: wp.array(dtype=int)
    gather_line: wp.array(dtype=int)
    gather_column: wp.array(dtype=int)
    entry_start: wp.array(dtype=int)
    entry_column: wp.array(dtype=int)
    row_start: wp.array(dtype=int)
    row: wp.array(dtype=int)
    row_flexible: wp.array(dtype=int)


# Factor of the equilibrated matrix; returns 1 if a pivot of rows is below `tolerance` of its terms, or one vanishes.
# Lanes over the columns of a node during its elimination, then over the lines of its update; each lane collects a line
# of the update before it is scattered, so that the inner loops are contiguous. `vector` is scratch: sums of terms.
@wp.func_native("""
    const int n = p.retained_count, rigid = model.retained.row_offset, L = WP_TILE_THREAD_IDX, NL = WP_TILE_BLOCK_DIM;
    const double* A = tangent.data + (size_t)w * n * n;
    double* a = factor.data + (size_t)w * p.factor_size;
    double* scale = scaling.data + (size_t)w * n;
    int* swapped = pivots.data + (size_t)w * n;
    double* __restrict sum = lines.data + ((size_t)w * lanes + L) * p.widest;
    double* terms = vector.data + (size_t)w * 2 * n; double* of_line = terms + n;
    for (int i = L; i < n; i += NL) {
        const double d = ::fabs(A[(size_t)i * n + i]);
        scale[i] = i < rigid && d > 0.0 ? 1.0 / ::sqrt(d) : 1.0;
    }
    WP_TILE_SYNC();
    for (int i = rigid + L; i < n; i += NL) {
        double big = 0.0;
        for (int e = p.entry_start.data[i]; e < p.entry_start.data[i + 1]; ++e) {
            const int j = p.entry_column.data[e];
            const double entry = j < rigid ? ::fabs(A[(size_t)i * n + j]) * scale[j] : 0.0;
            if (entry > big) big = entry;
        }
        if (big == 0.0) big = ::sqrt(::fabs(A[(size_t)i * n + i]));
        scale[i] = big > 0.0 ? 1.0 / big : 1.0;
    }
    WP_TILE_SYNC();
    for (int e = L; e < p.factor_size; e += NL) {
        const int i = p.gather_line.data[e], j = p.gather_column.data[e];
        a[e] = i < 0 ? 0.0 : A[(size_t)i * n + j] * scale[i] * scale[j];
    }
    for (int i = L; i < n; i += NL) {
        const int o = p.order.data[i];
        terms[i] = ::fabs(A[(size_t)o * n + o]) * scale[o] * scale[o];
    }
    WP_TILE_SYNC();
    for (int node = 0; node < p.node_count; ++node) {
        const int s = p.size.data[node], t = p.width.data[node], first = p.first.data[node];
        double* D = a + p.start.data[node]; double* U = D + s * s; double* X = U + s * t;
        const double least = p.order.data[first] < rigid ? 0.0 : tolerance;
        for (int q = L; q < s; q += NL) of_line[first + q] = terms[first + q];
        WP_TILE_SYNC();
        for (int q = 0; q < s; ++q) {
            int best = q;
            for (int i = q + 1; i < s; ++i) if (::fabs(D[i * s + q]) > ::fabs(D[best * s + q])) best = i;
            WP_TILE_SYNC();
            if (L == 0) {
                const double swap = of_line[first + q];
                swapped[first + q] = best;
                of_line[first + q] = of_line[first + best];
                of_line[first + best] = swap;
            }
            if (best != q) {
                double* x = D + q * s; double* y = D + best * s; double* u = U + q * t; double* v = U + best * t;
                for (int j = L; j < s; j += NL) { const double swap = x[j]; x[j] = y[j]; y[j] = swap; }
                for (int j = L; j < t; j += NL) { const double swap = u[j]; u[j] = v[j]; v[j] = swap; }
            }
            WP_TILE_SYNC();
            const double pivot = D[q * s + q];
            if (!(::fabs(pivot) > least * ::sqrt(of_line[first + q] * terms[first + q]))) return 1;
            const double r = 1.0 / pivot;
            for (int i = q + 1; i < s; ++i) {
                const double m = D[i * s + q] * r;
                if (m == 0.0) continue;
                for (int j = q + 1 + L; j < s; j += NL) D[i * s + j] -= m * D[q * s + j];
                double* __restrict x = U + i * t; const double* __restrict u = U + q * t;
                for (int j = L; j < t; j += NL) x[j] -= m * u[j];
            }
            WP_TILE_SYNC();
            for (int i = q + 1 + L; i < s; i += NL) D[i * s + q] *= r;
        }
        WP_TILE_SYNC();
        for (int q = 0; q < s; ++q) {
            double* __restrict x = X + q * t;
            for (int m = 0; m < q; ++m) {
                const double d = D[m * s + q]; const double* __restrict y = X + m * t;
                if (d != 0.0) for (int i = L; i < t; i += NL) x[i] -= d * y[i];
            }
            const double r = 1.0 / D[q * s + q];
            for (int i = L; i < t; i += NL) x[i] *= r;
        }
        WP_TILE_SYNC();
        const int* target = p.target.data + p.target_start.data[node];
        const int* panel = p.panel.data + p.panel_start.data[node];
        for (int i = L; i < t; i += NL) {
            double taken = 0.0;
            for (int q = 0; q < s; ++q) taken += ::fabs(X[q * t + i] * U[q * t + i]);
            terms[panel[i]] += taken;
            for (int j = 0; j < t; ++j) sum[j] = X[i] * U[j];
            int q = 1;
            for (; q + 1 < s; q += 2) {
                const double m = X[q * t + i], l = X[(q + 1) * t + i];
                const double* __restrict u = U + q * t; const double* __restrict v = u + t;
                for (int j = 0; j < t; ++j) sum[j] += m * u[j] + l * v[j];
            }
            for (; q < s; ++q) {
                const double m = X[q * t + i]; const double* __restrict u = U + q * t;
                for (int j = 0; j < t; ++j) sum[j] += m * u[j];
            }
            const int* to = target + i * t;
            for (int j = 0; j < t; ++j) a[to[j]] -= sum[j];
        }
        WP_TILE_SYNC();
    }
    return 0;
""")
def factorise(
    model: Model,
    p: Pattern,
    w: int,
    lanes: int,
    tolerance: real,
    tangent: wp.array3d(dtype=real),
    scaling: wp.array2d(dtype=real),
    pivots: wp.array2d(dtype=int),
    factor: wp.array(dtype=real),
    lines: wp.array(dtype=real),
    vector: wp.array(dtype=real),
) -> int: ...


# solution += A^-1 right with the factor; `vector` is scratch. One lane inside a node, lanes over the panel's entries.
@wp.func_native("""
    const int n = p.retained_count, L = WP_TILE_THREAD_IDX, NL = WP_TILE_BLOCK_DIM;
    const double* a = factor.data + (size_t)w * p.factor_size;
    const double* scale = scaling.data + (size_t)w * n;
    const int* swapped = pivots.data + (size_t)w * n;
    double* y = vector.data + (size_t)w * 2 * n;
    for (int i = L; i < n; i += NL) { const int o = p.order.data[i]; y[i] = scale[o] * right.data[at + o]; }
    WP_TILE_SYNC();
    for (int node = 0; node < p.node_count; ++node) {
        const int s = p.size.data[node], t = p.width.data[node];
        const double* D = a + p.start.data[node]; const double* X = D + s * s + s * t;
        double* x = y + p.first.data[node];
        if (L == 0) for (int q = 0; q < s; ++q) {
            const int best = swapped[p.first.data[node] + q];
            const double swap = x[q]; x[q] = x[best]; x[best] = swap;
        }
        if (L == 0) for (int q = 0; q < s; ++q) {
            double value = x[q];
            for (int m = 0; m < q; ++m) value -= D[q * s + m] * x[m];
            x[q] = value;
        }
        WP_TILE_SYNC();
        const int* panel = p.panel.data + p.panel_start.data[node];
        for (int i = L; i < t; i += NL) {
            double value = 0.0;
            for (int q = 0; q < s; ++q) value += X[q * t + i] * x[q];
            y[panel[i]] -= value;
        }
        WP_TILE_SYNC();
    }
    for (int node = p.node_count - 1; node >= 0; --node) {
        const int s = p.size.data[node], t = p.width.data[node];
        const double* D = a + p.start.data[node]; const double* U = D + s * s;
        double* x = y + p.first.data[node];
        const int* panel = p.panel.data + p.panel_start.data[node];
        for (int q = L; q < s; q += NL) {
            double value = x[q];
            for (int i = 0; i < t; ++i) value -= U[q * t + i] * y[panel[i]];
            x[q] = value;
        }
        WP_TILE_SYNC();
        if (L == 0) for (int q = s - 1; q >= 0; --q) {
            double value = x[q];
            for (int m = q + 1; m < s; ++m) value -= D[q * s + m] * x[m];
            x[q] = value / D[q * s + q];
        }
        WP_TILE_SYNC();
    }
    for (int i = L; i < n; i += NL) {
        const int o = p.order.data[i];
        solution.data[(size_t)w * n + o] += scale[o] * y[i];
    }
    WP_TILE_SYNC();
""")
def solve_factored(
    p: Pattern,
    w: int,
    factor: wp.array(dtype=real),
    scaling: wp.array2d(dtype=real),
    pivots: wp.array2d(dtype=int),
    right: wp.array(dtype=real),
    at: int,
    vector: wp.array(dtype=real),
    solution: wp.array(dtype=real),
): ...


# Largest entry of rhs - A z in the equilibrated system over that of |z| + |rhs|; the residual itself is returned in the
# second half of `vector`.
@wp.func_native("""
    const int n = p.retained_count, L = WP_TILE_THREAD_IDX, NL = WP_TILE_BLOCK_DIM;
    const double* A = tangent.data + (size_t)w * n * n;
    const double* scale = scaling.data + (size_t)w * n;
    const double* b = rhs.data + (size_t)w * n; const double* z = solution.data + (size_t)w * n;
    double* r = vector.data + (size_t)w * 2 * n + n;
    for (int i = L; i < n; i += NL) {
        double value = b[i];
        for (int e = p.entry_start.data[i]; e < p.entry_start.data[i + 1]; ++e) {
            const int j = p.entry_column.data[e];
            value -= A[(size_t)i * n + j] * z[j];
        }
        r[i] = value;
    }
    WP_TILE_SYNC();
    double worst = 0.0, size = 1.0e-300, sum = 0.0;
    for (int i = 0; i < n; ++i) {
        const double value = ::fabs(r[i]) * scale[i], right = ::fabs(b[i]) * scale[i], left = ::fabs(z[i]) / scale[i];
        if (value > worst) worst = value;
        if (left > size) size = left;
        if (right > size) size = right;
        sum += value;
    }
    WP_TILE_SYNC();
    return sum == sum && sum - sum == 0.0 ? worst / size : 1.0;
""")
def residual_of(
    p: Pattern,
    w: int,
    tangent: wp.array3d(dtype=real),
    scaling: wp.array2d(dtype=real),
    rhs: wp.array(dtype=real),
    solution: wp.array(dtype=real),
    vector: wp.array(dtype=real),
) -> real: ...
