r"""The tableau of a group of laps: what all its dependent numbers are of the independent ones.

With s the forces of all cells, y what they and the motion z of the bodies make of gaps and slips, f what they do to
this motion,

    y = G s + J z + y_0,      f = J^T s,            begins as      (y, f) = T (s, z) + const,   T = [[G, J], [J^T, 0]].

A cell that changes its state has other independent numbers u', v' of its old ones, u' = a u + b v, v' = c u + d v
(`forms`). With M = a + b T_aa, T_aa its own block, x all others,

    u  = M^-1 (u' - b T_ax u_x),
    T'_xx = T_xx - T_xa M^-1 b T_ax,    T'_xa = T_xa M^-1,    T'_aa = H = (c + d T_aa) M^-1,    T'_ax = (d - H b) T_ax:

a change of the rank of b: three where a cell opens or closes, one between stick and slip. It is kept aside as T = table
+ left right, so that a change costs no more than the columns and lines it needs; those of the cell itself are written
into the table, where `left` and `right` have nothing from then on. When MOST_RANK is reached it is added to the table,
at the speed of a product of matrices. The table is kept by columns.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, sync
from warpffrf_kernels.laps.forms import Four

wp.set_module_options(MODULE_OPTIONS)

MOST_RANK = 64


# --- where numbers of a group stand


@wp.func
def cells_of(model: Model, group: int) -> int:
    return model.elements[0].laps[0].cell_start[group + 1] - model.elements[0].laps[0].cell_start[group]


@wp.func
def columns_of(model: Model, group: int) -> int:
    """Coordinates z of the motion."""
    return model.elements[0].laps[0].column_start[group + 1] - model.elements[0].laps[0].column_start[group]


@wp.func
def unknowns_of(model: Model, group: int) -> int:
    return model.elements[0].laps[0].components[group] * cells_of(model, group)


@wp.func
def line_at(model: Model, w: int, group: int) -> int:
    """Where what each line of the tableau has one of begins, flat."""
    total = model.elements[0].laps[0].line_start[model.elements[0].laps[0].count]
    return w * total + model.elements[0].laps[0].line_start[group]


@wp.func
def lines_of(model: Model, group: int) -> int:
    return model.elements[0].laps[0].line_start[group + 1] - model.elements[0].laps[0].line_start[group]


@wp.func
def table_at(model: Model, w: int, group: int) -> int:
    total = model.elements[0].laps[0].table_start[model.elements[0].laps[0].count]
    return w * total + model.elements[0].laps[0].table_start[group]


# --- loops over contiguous numbers, lanes over stretches of lines


# y[at : at + n] += sum_k a[k] column list[k] of the table from `start` on, columns `stride` apart.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const int from = (int)((long long)n * lane / lanes), to = (int)((long long)n * (lane + 1) / lanes);
    double* __restrict q = y.data + at; const double* T = table.data + start; const double* c = a.data + at_a;
    const int* j = list.data + at_list;
    int k = 0;
    for (; k + 3 < count; k += 4) {
        const double a0 = c[k], a1 = c[k + 1], a2 = c[k + 2], a3 = c[k + 3];
        const double* t0 = T + (size_t)j[k] * stride; const double* t1 = T + (size_t)j[k + 1] * stride;
        const double* t2 = T + (size_t)j[k + 2] * stride; const double* t3 = T + (size_t)j[k + 3] * stride;
        for (int i = from; i < to; ++i) q[i] += a0 * t0[i] + a1 * t1[i] + (a2 * t2[i] + a3 * t3[i]);
    }
    for (; k < count; ++k) {
        const double a0 = c[k]; const double* t0 = T + (size_t)j[k] * stride;
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


# y[at : at + n] += sum_k a[k] line k, `count` lines from `start` on, `stride` apart.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const int from = (int)((long long)n * lane / lanes), to = (int)((long long)n * (lane + 1) / lanes);
    double* __restrict q = y.data + at; const double* T = lines.data + start; const double* c = a.data + at_a;
    int k = 0;
    for (; k + 3 < count; k += 4) {
        const double a0 = c[k], a1 = c[k + 1], a2 = c[k + 2], a3 = c[k + 3];
        const double* t0 = T + (size_t)k * stride; const double* t1 = t0 + stride;
        const double* t2 = t1 + stride; const double* t3 = t2 + stride;
        for (int i = from; i < to; ++i) q[i] += a0 * t0[i] + a1 * t1[i] + (a2 * t2[i] + a3 * t3[i]);
    }
    for (; k < count; ++k) {
        const double a0 = c[k]; const double* t0 = T + (size_t)k * stride;
        for (int i = from; i < to; ++i) q[i] += a0 * t0[i];
    }
""")
def add_lines(
    n: int,
    count: int,
    a: wp.array(dtype=real),
    at_a: int,
    lines: wp.array(dtype=real),
    start: int,
    stride: int,
    y: wp.array(dtype=real),
    at: int,
): ...


# weight[r] = sum_k a[k] right[r][list[k]], lanes over r.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    for (int r = lane; r < rank; r += lanes) {
        const double* x = right.data + start + (size_t)r * stride;
        double sum = 0.0;
        for (int k = 0; k < count; ++k) sum += a.data[at_a + k] * x[list.data[at_list + k]];
        weight.data[at + r] = sum;
    }
""")
def weigh_columns(
    rank: int,
    count: int,
    list: wp.array(dtype=int),
    at_list: int,
    a: wp.array(dtype=real),
    at_a: int,
    right: wp.array(dtype=real),
    start: int,
    stride: int,
    weight: wp.array(dtype=real),
    at: int,
): ...


# y[at + i] = x[start + stride i], i < n: a line of the table, or with stride 1 a column.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const int from = (int)((long long)n * lane / lanes), to = (int)((long long)n * (lane + 1) / lanes);
    const double* p = x.data + start; double* __restrict q = y.data + at;
    for (int i = from; i < to; ++i) q[i] = p[(size_t)i * stride];
""")
def take(n: int, x: wp.array(dtype=real), start: int, stride: int, y: wp.array(dtype=real), at: int): ...


# x[start + stride i] = y[at + i].
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const int from = (int)((long long)n * lane / lanes), to = (int)((long long)n * (lane + 1) / lanes);
    double* __restrict p = x.data + start; const double* q = y.data + at;
    for (int i = from; i < to; ++i) p[(size_t)i * stride] = q[i];
""")
def put(n: int, x: wp.array(dtype=real), start: int, stride: int, y: wp.array(dtype=real), at: int): ...


# y[at : at + n] = a0 x0 + a1 x1 + a2 x2 of `count` lines from `start` on, `stride` apart, three or the first alone.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const int from = (int)((long long)n * lane / lanes), to = (int)((long long)n * (lane + 1) / lanes);
    const double* x0 = x.data + start; const double* x1 = x0 + stride; const double* x2 = x1 + stride;
    double* __restrict q = y.data + at;
    if (count == 3) for (int i = from; i < to; ++i) q[i] = a0 * x0[i] + a1 * x1[i] + a2 * x2[i];
    else for (int i = from; i < to; ++i) q[i] = a0 * x0[i];
""")
def combine(
    n: int,
    count: int,
    a0: real,
    a1: real,
    a2: real,
    x: wp.array(dtype=real),
    start: int,
    stride: int,
    y: wp.array(dtype=real),
    at: int,
): ...


# The table of n columns += left right, both of `rank` lines of n numbers; lanes over fours of columns. Four lines of
# left at a time serve four columns: 16 products for four numbers read.
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


# --- the tableau as a whole


@wp.func
def own_block(components: int, a: int, n: int, strips: int, column: wp.array(dtype=real)) -> mat33:
    """T_aa of fetched columns; of cells without friction its one number, the rest of them alone."""
    block = wp.identity(n=3, dtype=real)
    for j in range(3):
        for i in range(3):
            if i < components and j < components:
                block[i, j] = column[strips + j * n + a + i]
    return block


@wp.func
def fetch(
    components: int,
    a: int,
    n: int,
    base: int,
    strips: int,
    updates: int,
    rank: int,
    table: wp.array(dtype=real),
    left: wp.array(dtype=real),
    right: wp.array(dtype=real),
    weight: wp.array(dtype=real),
    weights: int,
    column: wp.array(dtype=real),
    line: wp.array(dtype=real),
):
    """Columns and lines of a cell, its first at `a`, of table + left right."""
    j = int(0)
    while j < components:
        take(n, table, base + (a + j) * n, 1, column, strips + j * n)
        take(rank, right, updates + a + j, n, weight, weights)
        sync()
        add_lines(n, rank, weight, weights, left, updates, n, column, strips + j * n)
        take(n, table, base + a + j, n, line, strips + j * n)
        sync()
        take(rank, left, updates + a + j, n, weight, weights)
        sync()
        add_lines(n, rank, weight, weights, right, updates, n, line, strips + j * n)
        sync()
        j += 1


@wp.func
def biggest_of_line(A: mat33, i: int) -> real:
    return wp.max(wp.abs(A[i, 0]), wp.max(wp.abs(A[i, 1]), wp.abs(A[i, 2])))


@wp.func
def biggest_of_column(A: mat33, j: int) -> real:
    return wp.max(wp.abs(A[0, j]), wp.max(wp.abs(A[1, j]), wp.abs(A[2, j])))


@wp.func
def exchange(
    components: int,
    a: int,
    n: int,
    map: Four,
    base: int,
    strips: int,
    updates: int,
    rank: int,
    table: wp.array(dtype=real),
    left: wp.array(dtype=real),
    right: wp.array(dtype=real),
    weight: wp.array(dtype=real),
    weights: int,
    column: wp.array(dtype=real),
    line: wp.array(dtype=real),
) -> int:
    """The independent numbers of a cell become others, u' = a u + b v, v' = c u + d v; returns the rank after it."""
    fetch(
        components, a, n, base, strips, updates, rank, table, left, right, weight, weights, column, line
    )  # fmt: skip
    own = own_block(components, a, n, strips, column)
    M = wp.inverse(map.a + map.b * own)
    P = M * map.b
    H = (map.c + map.d * own) * M
    lane_free = rank
    if rank + components > MOST_RANK:
        add_product(n, rank, left, right, updates, table, base)
        sync()
        lane_free = int(0)
    N = map.d - H * map.b
    added = int(0)
    lines_in = int(0)  # lines and columns of b that are not zero: P = M^-1 b has the rank of the fewer
    columns_in = int(0)
    for i in range(3):
        if i < components:
            lines_in += wp.where(biggest_of_line(map.b, i) > real(0.0), 1, 0)
            columns_in += wp.where(biggest_of_column(map.b, i) > real(0.0), 1, 0)
    for i in range(3):
        at = updates + (lane_free + added) * n
        if i < components and lines_in <= columns_in and biggest_of_line(map.b, i) > real(0.0):
            combine(n, components, M[0, i], M[1, i], M[2, i], column, strips, n, left, at)
            combine(n, components, -map.b[i, 0], -map.b[i, 1], -map.b[i, 2], line, strips, n, right, at)
            added += 1
        elif i < components and lines_in > columns_in and biggest_of_column(map.b, i) > real(0.0):
            combine(n, components, P[0, i], P[1, i], P[2, i], column, strips, n, left, at)
            combine(n, 1, real(-1.0), real(0.0), real(0.0), line, strips + i * n, n, right, at)
            added += 1
    sync()
    j = int(0)
    while j < components:  # what the cell itself has of them stands in the table
        take_zero(components, a, lane_free + added, n, j, left, right, updates)
        combine(n, components, M[0, j], M[1, j], M[2, j], column, strips, n, table, base + (a + j) * n)
        j += 1
    sync()
    j = int(0)
    while j < components:
        combine(n, components, N[j, 0], N[j, 1], N[j, 2], line, strips, n, column, strips)
        sync()
        put(n, table, base + a + j, n, column, strips)
        sync()
        j += 1
    j = int(0)
    while j < components:
        i = int(0)
        while i < components:
            table[base + (a + j) * n + a + i] = H[i, j]
            i += 1
        j += 1
    sync()
    return lane_free + added


# left[r][a + j] = right[r][a + j] = 0 for all lines r.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    for (int r = lane; r < rank; r += lanes) {
        left.data[start + (size_t)r * n + a + j] = 0.0;
        right.data[start + (size_t)r * n + a + j] = 0.0;
    }
""")
def take_zero(
    components: int,
    a: int,
    rank: int,
    n: int,
    j: int,
    left: wp.array(dtype=real),
    right: wp.array(dtype=real),
    start: int,
): ...
