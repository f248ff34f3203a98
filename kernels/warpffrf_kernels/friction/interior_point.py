"""Tractions near the solution of the stick-slip problem (`stick_slip_solve`), from any start.

On a body that rotates freely, which all tractions move together, by 1e4 times as much as they displace each other,
Newton's method alternates between all cells sliding one way and all sliding the other. With
c_i = (b_i^2 - |tau_i|^2)/2 > 0 and lambda_i > 0, a Newton step of

    r + lambda tau = 0,      lambda_i c_i = mu,      (K + lambda + (lambda/c) tau tau^T) dtau = -r - (mu/c) tau,

mu a tenth of the mean of lambda c, is limited to the point at which a cell would leave its disc, or its lambda become
negative; about ten of them suffice (the primal-dual method of convex programs).
"""

import warp as wp

from warpffrf_kernels.core.friction_scratch import FrictionSolve, SlipSpeedSolve
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.core.scratch import RetainedSystem
from warpffrf_kernels.friction.cell_blocks import COUNT, FREE
from warpffrf_kernels.friction.friction_cone import find_slips, sort_cells
from warpffrf_kernels.friction.reduced_system import factor_reduced, solve_reduced
from warpffrf_kernels.linear.sparse_factor import Pattern

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


# The block of a step over both lines of all loaded cells of a pair, and their lines of L. Returns their number, and
# adds to the sum of lambda c.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = 2 * model.capacity.cells;
    const int width = model.pairs.coupled_capacity, coupled = model.pairs.coupled_count.data[pair];
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const double *A = D.data + here * cap * cap, *x = tau.data + here * cap, *b = radius.data + here * cap / 2;
    const double *soft = softness.data + here * cap / 2, *lambda = slope.data + here * cap / 2;
    int* list = order.data + here * cap;
    double* U = work.data + here * cap * cap;
    int m = 0; double sum = 0.0;
    for (int i = 0; i < count; ++i) if (b[i] > 0.0) {  // every lane counts for itself, in the same order
        if (lane == 0) { list[m] = 2 * i; list[m + 1] = 2 * i + 1; }
        sum += lambda[i] * 0.5 * (b[i] * b[i] - x[2 * i] * x[2 * i] - x[2 * i + 1] * x[2 * i + 1]);
        m += 2;
    }
    WP_TILE_SYNC();
    if (lane == 0) inside.data[(size_t)w * 2] += sum;
    for (int u = lane; u < m; u += lanes) {
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
    return m;
""")
def fill_inside(
    model: Model,
    w: int,
    pair: int,
    count: int,
    D: wp.array(dtype=real),
    L: wp.array(dtype=real),
    radius: wp.array(dtype=real),
    softness: wp.array(dtype=real),
    tau: wp.array(dtype=real),
    slope: wp.array(dtype=real),
    order: wp.array(dtype=int),
    work: wp.array(dtype=real),
    W: wp.array(dtype=real),
    inside: wp.array2d(dtype=real),
) -> int: ...


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


@wp.func
def come_near(
    model: Model, p: Pattern, w: int, lane: int, wanted: real, held: int, tangential: FrictionSolve,
    slopes: SlipSpeedSolve, radius: wp.array(dtype=real), softness: wp.array(dtype=real), system: RetainedSystem,
) -> int:  # fmt: skip
    """Tractions near the solution, up to a defect of `wanted`; returns the number of steps."""
    pair = int(0)
    while pair < model.pairs.count:
        begin_inside(
            model, w, pair, tangential.cell_block[w, pair, COUNT], slopes.speed_diagonal, slopes.speed_right, radius,
            slopes.speed_tau, tangential.cell_slip, tangential.cell_slope,
        )  # fmt: skip
        pair += 1
    n = int(0)
    defect = real(1.0)
    bad = int(0)
    while n < STEPS and defect > wanted and bad == 0:
        sync()
        if lane == 0:
            tangential.cell_inside[w, MU] = real(0.0)
            tangential.cell_inside[w, LENGTH] = real(1.0)
        sync()
        all = int(0)
        pair = int(0)
        while pair < model.pairs.count:
            m = fill_inside(
                model, w, pair, tangential.cell_block[w, pair, COUNT], slopes.speed_D, slopes.speed_L, radius, softness,
                slopes.speed_tau, tangential.cell_slope, tangential.cell_order, tangential.cell_U, tangential.cell_W,
                tangential.cell_inside,
            )  # fmt: skip
            if lane == 0:
                tangential.cell_block[w, pair, FREE] = m
            all += m
            pair += 1
        sync()
        n += 1
        mu = CENTRED * real(2.0) * tangential.cell_inside[w, MU] / wp.max(real(all), real(1.0))
        bad = factor_reduced(model, p, w, tangential, slopes)
        pair = int(0)
        while pair < model.pairs.count:
            pose_inside(
                model, w, pair, tangential.cell_block[w, pair, FREE], mu, radius, slopes.speed_tau,
                tangential.cell_slip, tangential.cell_order, tangential.cell_solution,
            )  # fmt: skip
            pair += 1
        bad += solve_reduced(model, p, w, lane, 1, held, tangential, system)
        if bad == 0:
            for move in range(2):
                pair = int(0)
                while pair < model.pairs.count:
                    go_inside(
                        model, w, pair, tangential.cell_block[w, pair, FREE], mu, WITHIN, move, radius,
                        tangential.cell_order, tangential.cell_solution, slopes.speed_tau, tangential.cell_slope,
                        tangential.cell_inside,
                    )  # fmt: skip
                    pair += 1
            find_slips(model, w, lane, tangential, slopes, softness)
            defect = sort_cells(model, w, lane, tangential, slopes, radius, softness)
    return n
