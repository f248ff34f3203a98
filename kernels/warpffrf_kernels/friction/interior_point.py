"""Tractions near the solution of the stick-slip problem (`rolling.traction_solve`), from any start.

On a body that rotates freely, which all tractions move together, by 1e4 times as much as they displace each other,
Newton's method alternates between all cells sliding one way and all sliding the other. With
c_i = (b_i^2 - |tau_i|^2)/2 > 0 and lambda_i > 0, a Newton step of

    r + lambda tau = 0,      lambda_i c_i = mu,      (K + lambda + (lambda/c) tau tau^T) dtau = -r - (mu/c) tau,

mu a tenth of the mean of lambda c, is limited to the point at which a cell would leave its disc, or its lambda become
negative; about ten of them suffice (the primal-dual method of convex programs).
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)

STEPS = wp.constant(60)  # at most: 10 to 20 are needed
CENTRED = wp.constant(wp.float64(0.1))  # mu, of the mean of lambda c
WITHIN = wp.constant(wp.float64(0.995))  # of the way to the boundary: maximum step
MU = wp.constant(0)  # columns of `inside`: sum of lambda c of all cells,
LENGTH = wp.constant(1)  # length of the step


# Start: zero tractions, the corresponding slips, lambda the slope of the slip.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = model.capacity.cells;
    const double *b = radius.data + here * cap, *k = diagonal.data + here * cap * 3;
    WP_TILE_SYNC();
    for (int i = WP_TILE_THREAD_IDX; i < count; i += WP_TILE_BLOCK_DIM) {
        const size_t p = here * 2 * cap + 2 * i;
        const double r0 = right.data[p], r1 = right.data[p + 1], least = 1e-3 * k[3 * i];
        tau.data[p] = tau.data[p + 1] = 0.0; slip.data[p] = r0; slip.data[p + 1] = r1;
        const double lambda = b[i] > 0.0 ? ::sqrt(r0 * r0 + r1 * r1) / b[i] : 0.0;
        slope.data[here * cap + i] = lambda > least ? lambda : least;
    }
    WP_TILE_SYNC();
""")
def begin_inside(
    model: Model,
    w: int,
    pair: int,
    count: int,
    diagonal: wp.array(dtype=real),
    right: wp.array(dtype=real),
    radius: wp.array(dtype=real),
    tau: wp.array(dtype=real),
    slip: wp.array(dtype=real),
    slope: wp.array(dtype=real),
): ...


# Lines of the loaded cells of a pair, and the sum of their lambda c. Returns their number.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = model.capacity.cells;
    const double *x = tau.data + here * 2 * cap, *b = radius.data + here * cap, *lambda = slope.data + here * cap;
    int* list = order.data + here * 2 * cap;
    int m = 0; double sum = 0.0;
    for (int i = 0; i < count; ++i) if (b[i] > 0.0) {  // every lane counts for itself, in the same order
        if (WP_TILE_THREAD_IDX == 0) { list[m] = 2 * i; list[m + 1] = 2 * i + 1; }
        sum += lambda[i] * 0.5 * (b[i] * b[i] - x[2 * i] * x[2 * i] - x[2 * i + 1] * x[2 * i + 1]);
        m += 2;
    }
    WP_TILE_SYNC();
    if (WP_TILE_THREAD_IDX == 0) inside.data[(size_t)w * 2] += sum;
    return m;
""")
def order_inside(
    model: Model,
    w: int,
    pair: int,
    count: int,
    radius: wp.array(dtype=real),
    tau: wp.array(dtype=real),
    slope: wp.array(dtype=real),
    order: wp.array(dtype=int),
    inside: wp.array2d(dtype=real),
) -> int: ...


# The block of a step over the m lines of all loaded cells of a pair, and their lines of L.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = 2 * model.capacity.cells;
    const int width = model.pairs.coupled_capacity, coupled = model.pairs.coupled_count.data[pair];
    const double *A = D.data + here * cap * cap, *x = tau.data + here * cap, *b = radius.data + here * cap / 2;
    const double *soft = softness.data + here * cap / 2, *lambda = slope.data + here * cap / 2;
    const int* list = order.data + here * cap;
    double* U = work.data + here * cap * cap;
    WP_TILE_SYNC();
    for (int u = WP_TILE_THREAD_IDX; u < m; u += WP_TILE_BLOCK_DIM) {
        const int p = list[u], i = p / 2;
        const double room = 0.5 * (b[i] * b[i] - x[2 * i] * x[2 * i] - x[2 * i + 1] * x[2 * i + 1]);
        double* row = U + (size_t)u * cap;
        for (int v = u; v < m; ++v) row[v] = A[(size_t)p * cap + list[v]];
        row[u] += soft[i] + lambda[i] + lambda[i] / room * x[p] * x[p];
        if (p % 2 == 0) row[u + 1] += lambda[i] / room * x[p] * x[p + 1];
        const double* l = L.data + (here * cap + p) * width; double* border = W.data + (here * cap + u) * width;
        for (int c = 0; c < coupled; ++c) border[c] = l[c];
    }
    WP_TILE_SYNC();
""")
def fill_inside(
    model: Model,
    w: int,
    pair: int,
    m: int,
    D: wp.array(dtype=real),
    L: wp.array(dtype=real),
    radius: wp.array(dtype=real),
    softness: wp.array(dtype=real),
    tau: wp.array(dtype=real),
    slope: wp.array(dtype=real),
    order: wp.array(dtype=int),
    work: wp.array(dtype=real),
    W: wp.array(dtype=real),
): ...


# Right-hand side -r - (mu/c) tau of a pair.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = 2 * model.capacity.cells;
    const double *x = tau.data + here * cap, *r = slip.data + here * cap, *b = radius.data + here * cap / 2;
    const int* list = order.data + here * cap;
    WP_TILE_SYNC();
    for (int u = WP_TILE_THREAD_IDX; u < m; u += WP_TILE_BLOCK_DIM) {
        const int p = list[u], e = p - p % 2, i = p / 2;
        solution.data[here * cap + u] = -r[p] - 2.0 * mu * x[p] / (b[i] * b[i] - x[e] * x[e] - x[e + 1] * x[e + 1]);
    }
    WP_TILE_SYNC();
""")
def pose_inside(
    model: Model,
    w: int,
    pair: int,
    m: int,
    mu: real,
    radius: wp.array(dtype=real),
    tau: wp.array(dtype=real),
    slip: wp.array(dtype=real),
    order: wp.array(dtype=int),
    solution: wp.array(dtype=real),
): ...


# Longest permitted step (`move` 0: shortens `inside`), or the step by that length (1), of a pair; by one lane.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = 2 * model.capacity.cells;
    double *x = tau.data + here * cap, *lambda = slope.data + here * cap / 2;
    double* step = inside.data + (size_t)w * 2 + 1;
    const double *y = solution.data + here * cap, *b = radius.data + here * cap / 2;
    const int* list = order.data + here * cap;
    WP_TILE_SYNC();
    if (WP_TILE_THREAD_IDX == 0) for (int u = 0; u < m; u += 2) {
        const int p = list[u], i = p / 2;
        const double room = 0.5 * (b[i] * b[i] - x[p] * x[p] - x[p + 1] * x[p + 1]);
        const double a = y[u] * y[u] + y[u + 1] * y[u + 1], along = x[p] * y[u] + x[p + 1] * y[u + 1];
        const double rise = (mu - lambda[i] * room + lambda[i] * along) / room;
        if (move == 1) { x[p] += *step * y[u]; x[p + 1] += *step * y[u + 1]; lambda[i] += *step * rise; continue; }
        const double root = ::sqrt(along * along + 2.0 * a * room);  // a s^2/2 + along s = room, without cancelling
        const double most = along > 0.0 ? 2.0 * room / (along + root) : a > 0.0 ? (root - along) / a : 1e30;
        if (within * most < *step) *step = within * most;
        if (-rise * *step > within * lambda[i]) *step = -within * lambda[i] / rise;
    }
    WP_TILE_SYNC();
""")
def go_inside(
    model: Model,
    w: int,
    pair: int,
    m: int,
    mu: real,
    within: real,
    move: int,
    radius: wp.array(dtype=real),
    order: wp.array(dtype=int),
    solution: wp.array(dtype=real),
    tau: wp.array(dtype=real),
    slope: wp.array(dtype=real),
    inside: wp.array2d(dtype=real),
): ...


# By line <- by order, zero elsewhere; `back`: by order <- by line.
@wp.func_native("""
    const size_t at = ((size_t)w * model.pairs.count + pair) * 2 * model.capacity.cells;
    const int* list = order.data + at;
    WP_TILE_SYNC();
    if (!back) for (int l = WP_TILE_THREAD_IDX; l < 2 * count; l += WP_TILE_BLOCK_DIM) lines.data[at + l] = 0.0;
    WP_TILE_SYNC();
    for (int u = WP_TILE_THREAD_IDX; u < m; u += WP_TILE_BLOCK_DIM) {
        if (back) ordered.data[at + u] = lines.data[at + list[u]]; else lines.data[at + list[u]] = ordered.data[at + u];
    }
    WP_TILE_SYNC();
""")
def spread_order(
    model: Model,
    w: int,
    pair: int,
    count: int,
    m: int,
    back: int,
    order: wp.array(dtype=int),
    ordered: wp.array(dtype=real),
    lines: wp.array(dtype=real),
): ...
