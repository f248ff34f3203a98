"""Loops over contiguous numbers of a tableau, in C++: lanes over segments of lines or over columns."""

import warp as wp

from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


# y[at : at + n] += sum_k a[k] column list[k] of the table from `start` on, columns `stride` apart; column k without a
# list (at_list < 0).
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const int from = (int)((long long)n * lane / lanes), to = (int)((long long)n * (lane + 1) / lanes);
    double* __restrict q = y.data + at; const double* T = table.data + start; const double* c = a.data + at_a;
    const int* j = at_list < 0 ? nullptr : list.data + at_list;
    int k = 0;
    for (; k + 3 < count; k += 4) {
        const double a0 = c[k], a1 = c[k + 1], a2 = c[k + 2], a3 = c[k + 3];
        const double* t0 = T + (size_t)(j ? j[k] : k) * stride;
        const double* t1 = T + (size_t)(j ? j[k + 1] : k + 1) * stride;
        const double* t2 = T + (size_t)(j ? j[k + 2] : k + 2) * stride;
        const double* t3 = T + (size_t)(j ? j[k + 3] : k + 3) * stride;
        for (int i = from; i < to; ++i) q[i] += a0 * t0[i] + a1 * t1[i] + (a2 * t2[i] + a3 * t3[i]);
    }
    for (; k < count; ++k) {
        const double a0 = c[k]; const double* t0 = T + (size_t)(j ? j[k] : k) * stride;
        for (int i = from; i < to; ++i) q[i] += a0 * t0[i];
    }
""")
def add_columns(
    n: int,
    count: int,
    list: wp.array(dtype=int),
    at_list: int,
    a: wp.array(dtype=real),
    at_a: int,
    table: wp.array(dtype=real),
    start: int,
    stride: int,
    y: wp.array(dtype=real),
    at: int,
): ...


# y[at : at + n] = x[start : start + n].
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const int from = (int)((long long)n * lane / lanes), to = (int)((long long)n * (lane + 1) / lanes);
    const double* p = x.data + start; double* __restrict q = y.data + at;
    for (int i = from; i < to; ++i) q[i] = p[i];
""")
def take(n: int, x: wp.array(dtype=real), start: int, y: wp.array(dtype=real), at: int): ...


# sum[at + c] = sum_i lines[c][i] x[i] and the sum of their absolute values, `count` lines from `start` on, `n` apart;
# lanes over lines. Eight sums at a time, so none waits for the previous one.
@wp.func_native("""
    const double* s = x.data + at_x;
    for (int c = WP_TILE_THREAD_IDX; c < count; c += WP_TILE_BLOCK_DIM) {
        const double* p = lines.data + start + (size_t)c * n;
        double part[8] = {0, 0, 0, 0, 0, 0, 0, 0}, size[8] = {0, 0, 0, 0, 0, 0, 0, 0}, a = 0.0, b = 0.0;
        int i = 0;
        for (; i + 7 < n; i += 8)
            for (int k = 0; k < 8; ++k) {
                const double term = p[i + k] * s[i + k];
                part[k] += term; size[k] += term < 0.0 ? -term : term;
            }
        for (; i < n; ++i) { const double term = p[i] * s[i]; a += term; b += term < 0.0 ? -term : term; }
        for (int k = 0; k < 8; ++k) { a += part[k]; b += size[k]; }
        sum.data[at + c] = a; sizes.data[at + c] = b;
    }
""")
def weigh_lines(
    n: int,
    count: int,
    lines: wp.array(dtype=real),
    start: int,
    x: wp.array(dtype=real),
    at_x: int,
    sum: wp.array2d(dtype=real),
    sizes: wp.array2d(dtype=real),
    at: int,
): ...


# weight[r] -= by sum_c b[r][c] t[first line of the cell of active[r] + c], t the column of the table from `column` on;
# by one lane.
@wp.func_native("""
    const double* t = table.data + column; const double* b = rows.data + 3 * (size_t)slots;
    for (int r = 0; r < rank; ++r) {
        const int line = active.data[slots + r], first = line - line % components;
        double own = b[3 * r] * t[first];
        if (components == 3) own += b[3 * r + 1] * t[first + 1] + b[3 * r + 2] * t[first + 2];
        weight.data[slots + r] -= by * own;
    }
""")
def take_followed(
    components: int,
    rank: int,
    by: real,
    table: wp.array(dtype=real),
    column: int,
    active: wp.array(dtype=int),
    slots: int,
    rows: wp.array(dtype=real),
    weight: wp.array(dtype=real),
): ...


# x[at + j stride + r] = sum_c b[r][c] T[first line of the cell of active[r] + c][column j], columns list[j], or j
# without a list (at_list < 0); lanes over columns.
@wp.func_native("""
    const double* T = table.data + base;
    for (int j = WP_TILE_THREAD_IDX; j < count; j += WP_TILE_BLOCK_DIM) {
        const double* t = T + (size_t)(at_list < 0 ? j : list.data[at_list + j]) * n;
        double* q = x.data + at + (size_t)j * across;
        for (int r = 0; r < rank; ++r) {
            const int line = active.data[slots + r], first = line - line % components;
            const double* b = rows.data + 3 * (size_t)slots + 3 * r;
            double own = b[0] * t[first];
            if (components == 3) own += b[1] * t[first + 1] + b[2] * t[first + 2];
            q[(size_t)r * along] = own;
        }
    }
""")
def mapped_lines(
    components: int,
    rank: int,
    count: int,
    list: wp.array(dtype=int),
    at_list: int,
    table: wp.array(dtype=real),
    base: int,
    n: int,
    active: wp.array(dtype=int),
    slots: int,
    rows: wp.array(dtype=real),
    x: wp.array(dtype=real),
    at: int,
    along: int,
    across: int,
): ...


# Columns of a matrix of `rank` lines, `most` apart, times their units; lanes over columns.
@wp.func_native("""
    for (int j = WP_TILE_THREAD_IDX; j < rank; j += WP_TILE_BLOCK_DIM) {
        double* q = factor.data + at + (size_t)j * most;
        const double by = units.data[2 * (slots + j) + 1];
        for (int i = 0; i < rank; ++i) q[i] *= by;
    }
""")
def scale_columns(
    rank: int, most: int, units: wp.array(dtype=real), slots: int, factor: wp.array(dtype=real), at: int
): ...


# Step k of the factors P M = L U of a matrix of `rank` lines stored by columns `most` apart: moves the largest number
# of its column to the diagonal; by one lane.
@wp.func_native("""
    double* A = factor.data + at;
    int best = k;
    for (int i = k + 1; i < rank; ++i)
        if (fabs(A[(size_t)k * most + i]) > fabs(A[(size_t)k * most + best])) best = i;
    pivot.data[slots + k] = best;
    if (best != k)
        for (int j = 0; j < rank; ++j) {
            double* q = A + (size_t)j * most;
            const double x = q[k]; q[k] = q[best]; q[best] = x;
        }
    double* q = A + (size_t)k * most;
    const double by = 1.0 / q[k];
    for (int i = k + 1; i < rank; ++i) q[i] *= by;
""")
def choose_pivot(
    rank: int, k: int, most: int, factor: wp.array(dtype=real), at: int, pivot: wp.array(dtype=int), slots: int
): ...


# Elimination of step k in the columns after k; lanes over columns.
@wp.func_native("""
    double* A = factor.data + at;
    const double* p = A + (size_t)k * most;
    for (int j = k + 1 + WP_TILE_THREAD_IDX; j < rank; j += WP_TILE_BLOCK_DIM) {
        double* __restrict q = A + (size_t)j * most;
        const double f = q[k];
        if (f != 0.0) for (int i = k + 1; i < rank; ++i) q[i] -= f * p[i];
    }
""")
def eliminate(rank: int, k: int, most: int, factor: wp.array(dtype=real), at: int): ...


# x[at : at + rank] <- M^-1 x in the units of M's columns, by columns of the factors; by one lane.
@wp.func_native("""
    const double* A = factor.data + at_factor;
    double* X = x.data + at;
    for (int k = 0; k < rank; ++k) {
        const int p = pivot.data[at + k];
        const double f = X[p]; X[p] = X[k]; X[k] = f;
    }
    for (int k = 0; k < rank; ++k) {
        const double f = X[k]; const double* q = A + (size_t)k * most;
        if (f != 0.0) for (int i = k + 1; i < rank; ++i) X[i] -= f * q[i];
    }
    for (int k = rank - 1; k >= 0; --k) {
        const double* q = A + (size_t)k * most;
        const double f = X[k] / q[k]; X[k] = f;
        if (f != 0.0) for (int i = 0; i < k; ++i) X[i] -= f * q[i];
    }
    for (int k = 0; k < rank; ++k) X[k] *= units.data[2 * (at + k) + 1];
""")
def substitute(
    rank: int,
    most: int,
    factor: wp.array(dtype=real),
    at_factor: int,
    pivot: wp.array(dtype=int),
    units: wp.array(dtype=real),
    x: wp.array(dtype=real),
    at: int,
): ...


# Lines x[at + r n : at + (r + 1) n], r < rank, <- M^-1 of them in the units of M's columns; lanes over segments of
# columns, of which 64 at a time stay in the cache.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const int first = (int)((long long)n * lane / lanes), last = (int)((long long)n * (lane + 1) / lanes);
    const double* A = factor.data + at_factor;
    double* X = x.data + at;
    for (int from = first; from < last; from += 64) {
        const int many = last - from < 64 ? last - from : 64;
        for (int k = 0; k < rank; ++k) {
            const int p = pivot.data[slots + k];
            double* u = X + (size_t)k * n + from; double* v = X + (size_t)p * n + from;
            if (p != k) for (int j = 0; j < many; ++j) { const double f = u[j]; u[j] = v[j]; v[j] = f; }
        }
        for (int k = 0; k < rank; ++k)
            for (int i = k + 1; i < rank; ++i) {
                const double f = A[(size_t)k * most + i];
                const double* u = X + (size_t)k * n + from; double* __restrict v = X + (size_t)i * n + from;
                if (f != 0.0) for (int j = 0; j < many; ++j) v[j] -= f * u[j];
            }
        for (int k = rank - 1; k >= 0; --k) {
            double* u = X + (size_t)k * n + from;
            const double by = 1.0 / A[(size_t)k * most + k];
            for (int j = 0; j < many; ++j) u[j] *= by;
            for (int i = 0; i < k; ++i) {
                const double f = A[(size_t)k * most + i]; double* __restrict v = X + (size_t)i * n + from;
                if (f != 0.0) for (int j = 0; j < many; ++j) v[j] -= f * u[j];
            }
        }
        for (int k = 0; k < rank; ++k) {
            double* u = X + (size_t)k * n + from;
            const double by = units.data[2 * (slots + k) + 1];
            for (int j = 0; j < many; ++j) u[j] *= by;
        }
    }
""")
def substitute_lines(
    rank: int,
    n: int,
    most: int,
    factor: wp.array(dtype=real),
    at_factor: int,
    pivot: wp.array(dtype=int),
    units: wp.array(dtype=real),
    slots: int,
    x: wp.array(dtype=real),
    at: int,
): ...


# Moves columns active[r] of the table to lines r of `left` and sets them to zero; lanes over columns.
@wp.func_native("""
    for (int r = WP_TILE_THREAD_IDX; r < rank; r += WP_TILE_BLOCK_DIM) {
        double* t = table.data + base + (size_t)active.data[slots + r] * n;
        double* __restrict q = left.data + start + (size_t)r * n;
        for (int i = 0; i < n; ++i) { q[i] = t[i]; t[i] = 0.0; }
    }
""")
def take_columns(
    rank: int,
    n: int,
    active: wp.array(dtype=int),
    slots: int,
    table: wp.array(dtype=real),
    base: int,
    left: wp.array(dtype=real),
    start: int,
): ...


# The table of n columns += left right, both of `rank` lines of n numbers; lanes over groups of four columns. Four lines
# of left at a time are used for four columns: 16 products for four numbers read.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const double* A = left.data + start; const double* B = right.data + start; double* T = table.data + at;
    for (int j = 4 * lane; j < n; j += 4 * lanes) {
        const int many = n - j < 4 ? n - j : 4;
        double* __restrict q0 = T + (size_t)j * n; double* __restrict q1 = T + (size_t)(j + 1) * n;
        double* __restrict q2 = T + (size_t)(j + 2) * n; double* __restrict q3 = T + (size_t)(j + 3) * n;
        int r = 0;
        for (; many == 4 && r + 3 < rank; r += 4) {
            const double* x0 = A + (size_t)r * n; const double* x1 = x0 + n;
            const double* x2 = x1 + n; const double* x3 = x2 + n;
            double b[4][4];
            for (int k = 0; k < 4; ++k) for (int c = 0; c < 4; ++c) b[k][c] = B[(size_t)(r + k) * n + j + c];
            for (int i = 0; i < n; ++i) {
                const double a0 = x0[i], a1 = x1[i], a2 = x2[i], a3 = x3[i];
                q0[i] += (b[0][0] * a0 + b[1][0] * a1) + (b[2][0] * a2 + b[3][0] * a3);
                q1[i] += (b[0][1] * a0 + b[1][1] * a1) + (b[2][1] * a2 + b[3][1] * a3);
                q2[i] += (b[0][2] * a0 + b[1][2] * a1) + (b[2][2] * a2 + b[3][2] * a3);
                q3[i] += (b[0][3] * a0 + b[1][3] * a1) + (b[2][3] * a2 + b[3][3] * a3);
            }
        }
        for (; r < rank; ++r) {
            const double* x = A + (size_t)r * n; const double* y = B + (size_t)r * n + j;
            for (int c = 0; c < many; ++c) {
                double* __restrict q = q0 + (size_t)c * n; const double f = y[c];
                for (int i = 0; i < n; ++i) q[i] += f * x[i];
            }
        }
    }
""")
def add_product(
    n: int,
    rank: int,
    left: wp.array(dtype=real),
    right: wp.array(dtype=real),
    start: int,
    table: wp.array(dtype=real),
    at: int,
): ...
