"""Contact inside the step: active set, pressures, and what the outer coordinates and modes make of them.

With `base` the pressures of the present state, `opened` its weak gaps and r, r_m its residuals with all contact forces
in, the linearised system of `outer` reads, for the change ds of the pressures on the active set and the outer
increments z,

    A z - L^T ds = rhs,        L z + G ds = b,        b = -(opened - J sigma^-1 r_m),

L and J times the weight of their pair (`impulsive_contact`), 1 where it is not impulsive, `opened` and ds too. G has a
block for each pair, symmetric positive definite: U^T U. The hats of each pair are eliminated on their own,

    W = U^-T L,    y = U^-T b,    (A + sum W^T W) z = rhs + sum W^T y,    ds = U^-1 (y - W z),

so that pairs meet in the sparse outer system alone, at the cost of their number. Pressures that leave the set change by
-base, which goes to the right-hand sides.

Where condensed or local modes of a body answer to several pairs, G has blocks F between these too. With M the system
without them, which the elimination solves, (M + F) ds = b is solved by conjugate gradients with M as preconditioner: F
is small beside M where patches lie apart.

Everything is counted from the present state, so that G, L, J and A may be those of a position a small fraction of a
column away (a modified Newton step, exact at its fixed point), and so that large forces in balance do not cancel in the
increments.

The set is then corrected (pressure not positive: out; linearised weak gap negative: in) and the solve repeated with the
outer coordinates frozen until the set has settled: a primal-dual active set method on the linearised problem.
"""

import warp as wp

from warpffrf_kernels.bodies.interfaces import modal_line, side_of
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import changed, inout, out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, dot, mat33, real, sync, vec3, weighted
from warpffrf_kernels.kinematics.line_of_centres import GUARD
from warpffrf_kernels.linear.outer_solve import held_motions, solve
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.normal.contact_fields import local_gap, on_stencil
from warpffrf_kernels.normal.pair_forces import surface_of

wp.set_module_options(MODULE_OPTIONS)

GAP_TOLERANCE = wp.constant(wp.float64(1.0e-14))  # of the scene's length: a mean gap of round-off size does not close


@wp.func
def change_of(
    w: int,
    slot: int,
    slot_hat: wp.array3d(dtype=int),
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    base: wp.array3d(dtype=real),
) -> real:
    """Pressure of a slot less that of the state the step starts from."""
    pair = slot_hat[w, slot, 0]
    m = slot_hat[w, slot, 1]
    change = -base[w, pair, m]
    if active[w, pair, m] != 0:
        change += pressure[w, pair, m]
    return change


START = wp.constant(0)  # columns of `block`: where the active slots of a pair begin in `order`
COUNT = wp.constant(1)  # how many they are
LEFT_START = wp.constant(2)  # the same of those that have left the set
LEFT_COUNT = wp.constant(3)
EXACT = wp.constant(wp.float64(1.0e-16))  # of the energy of the first correction: where the gradients end
GRADIENTS = wp.constant(100)  # steps of them at most


@wp.kernel
def order_slots(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    active: wp.array3d(dtype=int),
    base: wp.array3d(dtype=real),
    slot_hat: wp.array3d(dtype=int),
    order: out(wp.array2d(dtype=int)),
    block: out(wp.array3d(dtype=int)),
):
    """Per world: the active slots, pair by pair, then those that have left the set."""
    w = wp.tid()
    model = models[0]
    if ctl[w].run == 0:
        return
    pair = int(0)
    while pair < model.pairs.count:
        block[w, pair, COUNT] = 0
        block[w, pair, LEFT_COUNT] = 0
        pair += 1
    slot = int(0)
    while slot < ctl[w].slots:
        pair = slot_hat[w, slot, 0]
        m = slot_hat[w, slot, 1]
        if active[w, pair, m] != 0:
            block[w, pair, COUNT] = block[w, pair, COUNT] + 1
        elif base[w, pair, m] != real(0.0):
            block[w, pair, LEFT_COUNT] = block[w, pair, LEFT_COUNT] + 1
        slot += 1
    at = int(0)
    for kind in range(2):
        pair = int(0)
        while pair < model.pairs.count:
            block[w, pair, 2 * kind + START] = at
            at += block[w, pair, 2 * kind + COUNT]
            block[w, pair, 2 * kind + COUNT] = 0
            pair += 1
    slot = int(0)
    while slot < ctl[w].slots:
        pair = slot_hat[w, slot, 0]
        m = slot_hat[w, slot, 1]
        kind = int(-1)
        if active[w, pair, m] != 0:
            kind = int(0)
        elif base[w, pair, m] != real(0.0):
            kind = int(1)
        if kind >= 0:
            n = block[w, pair, 2 * kind + COUNT]
            order[w, block[w, pair, 2 * kind + START] + n] = slot
            block[w, pair, 2 * kind + COUNT] = n + 1
        slot += 1


# Gathers the block of G of n slots from place `start` of `order` on and factors it, in the lines and columns of these
# places. Returns 1 if it is not definite. Native for contiguous inner loops like `axpy`; not measured separately.
@wp.func_native("""
    const int cap = model.capacity.slots, L = WP_TILE_THREAD_IDX, NL = WP_TILE_BLOCK_DIM;
    double* U = factor.data + ((size_t)w * cap + start) * cap + start;
    const int* list = order.data + (size_t)w * cap + start;
    for (int i = 0; i < n; ++i) {
        const double* g = G.data + ((size_t)w * cap + list[i]) * cap;
        for (int j = i + L; j < n; j += NL) U[(size_t)i * cap + j] = g[list[j]];
    }
    WP_TILE_SYNC();
    int bad = 0;
    for (int p = 0; p < n; p += 4) {
        const int kb = n - p < 4 ? n - p : 4;
        for (int q = 0; q < kb; ++q) {
            double* u = U + (size_t)(p + q) * cap;
            double pivot = u[p + q];
            WP_TILE_SYNC();
            if (!(pivot > 0.0)) { bad = 1; pivot = 1.0; }
            const double root = ::sqrt(pivot), scale = 1.0 / root;
            for (int j = p + q + L; j < n; j += NL) u[j] = j == p + q ? root : u[j] * scale;
            WP_TILE_SYNC();
            for (int r = q + 1; r < kb; ++r) { double* x = U + (size_t)(p + r) * cap; const double m = u[p + r];
                for (int j = p + r + L; j < n; j += NL) x[j] -= m * u[j]; }
            WP_TILE_SYNC();
        }
        if (kb == 4) {
            const double *u0 = U + (size_t)p * cap, *u1 = u0 + cap, *u2 = u1 + cap, *u3 = u2 + cap;
            for (int i = p + 4; i < n; ++i) { double* __restrict x = U + (size_t)i * cap;
                const double m0 = u0[i], m1 = u1[i], m2 = u2[i], m3 = u3[i];
                for (int j = i + L; j < n; j += NL) x[j] -= m0 * u0[j] + m1 * u1[j] + m2 * u2[j] + m3 * u3[j]; }
        }
        WP_TILE_SYNC();
    }
    return bad;
""")
def factor_block(
    model: Model,
    w: int,
    start: int,
    n: int,
    G: wp.array3d(dtype=real),
    order: wp.array2d(dtype=int),
    factor: wp.array3d(dtype=real),
) -> int: ...


# W = U^-T L of the n places from `start` on, over the coupled columns of their pair, and W^T W. Lanes over the columns.
@wp.func_native("""
    const int cap = model.capacity.slots, width = model.pairs.coupled_capacity;
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM, count = model.pairs.coupled_count.data[pair];
    const double* U = factor.data + ((size_t)w * cap + start) * cap + start;
    const int* list = order.data + (size_t)w * cap + start;
    double* w0 = W.data + ((size_t)w * cap + start) * width;
    double* s0 = square.data + ((size_t)w * model.pairs.count + pair) * width * width;
    for (int i = 0; i < n; ++i) {
        double* __restrict x = w0 + (size_t)i * width;
        const double* l = L.data + ((size_t)w * cap + list[i]) * width;
        for (int c = lane; c < count; c += lanes) x[c] = l[c];
        int j = 0;
        for (; j + 3 < i; j += 4) {
            const double m0 = U[(size_t)j * cap + i], m1 = U[(size_t)(j + 1) * cap + i];
            const double m2 = U[(size_t)(j + 2) * cap + i], m3 = U[(size_t)(j + 3) * cap + i];
            const double *a = w0 + (size_t)j * width, *b = a + width, *c = b + width, *d = c + width;
            for (int q = lane; q < count; q += lanes) x[q] -= m0 * a[q] + m1 * b[q] + m2 * c[q] + m3 * d[q];
        }
        for (; j < i; ++j) { const double m = U[(size_t)j * cap + i]; const double* a = w0 + (size_t)j * width;
            for (int q = lane; q < count; q += lanes) x[q] -= m * a[q]; }
        const double scale = 1.0 / U[(size_t)i * cap + i];
        for (int q = lane; q < count; q += lanes) x[q] *= scale;
    }
    WP_TILE_SYNC();
    for (int c = 0; c < count; ++c) {
        double* __restrict s = s0 + (size_t)c * width; int i = 0;
        for (int q = lane; q < count; q += lanes) s[q] = 0.0;
        for (; i + 3 < n; i += 4) {
            const double *a = w0 + (size_t)i * width, *b = a + width, *d = b + width, *e = d + width;
            const double m0 = a[c], m1 = b[c], m2 = d[c], m3 = e[c];
            for (int q = lane; q < count; q += lanes) s[q] += m0 * a[q] + m1 * b[q] + m2 * d[q] + m3 * e[q];
        }
        for (; i < n; ++i) { const double* a = w0 + (size_t)i * width; const double m = a[c];
            for (int q = lane; q < count; q += lanes) s[q] += m * a[q]; }
    }
    WP_TILE_SYNC();
""")
def border_block(
    model: Model,
    w: int,
    pair: int,
    start: int,
    n: int,
    order: wp.array2d(dtype=int),
    factor: wp.array3d(dtype=real),
    L: wp.array3d(dtype=real),
    W: wp.array3d(dtype=real),
    square: wp.array4d(dtype=real),
): ...


@wp.kernel
def eliminate_pairs(
    models: wp.array(dtype=Model),
    G: wp.array3d(dtype=real),
    L: wp.array3d(dtype=real),
    order: wp.array2d(dtype=int),
    block: wp.array3d(dtype=int),
    ctl: inout(wp.array(dtype=Control)),
    factor: inout(wp.array3d(dtype=real)),
    W: inout(wp.array3d(dtype=real)),
    square: inout(wp.array4d(dtype=real)),
):
    """Per (world, pair): U, W and W^T W of the active hats."""
    w, pair, lane = wp.tid()
    model = models[0]
    n = block[w, pair, COUNT]
    if ctl[w].run == 0 or n == 0:
        return
    start = block[w, pair, START]
    bad = factor_block(model, w, start, n, G, order, factor)
    if bad != 0 and lane == 0:
        ctl[w].failure = ctl[w].failure | k.INDEFINITE
    border_block(model, w, pair, start, n, order, factor, L, W, square)


# Of n places from `start` on: x <- U^-T x, then right += W^T x.
@wp.func_native("""
    const int cap = model.capacity.slots, width = model.pairs.coupled_capacity;
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM, count = model.pairs.coupled_count.data[pair];
    const double* U = factor.data + ((size_t)w * cap + start) * cap + start;
    double* x = solution.data + at + start;
    const int* column = model.pairs.coupled.data + (size_t)pair * width;
    WP_TILE_SYNC();
    for (int i = 0; i < n; ++i) {
        const double* u = U + (size_t)i * cap; const double y = x[i] / u[i];
        WP_TILE_SYNC();
        if (lane == 0) x[i] = y;
        for (int j = i + 1 + lane; j < n; j += lanes) x[j] -= u[j] * y;
        WP_TILE_SYNC();
    }
    for (int c = 0; c < count; ++c) if (lane == c % lanes) {  // columns may be named twice, by a pair with the ground
        double sum = 0.0;
        for (int i = 0; i < n; ++i) sum += W.data[((size_t)w * cap + start + i) * width + c] * x[i];
        if (sum != 0.0) right.data[(size_t)w * model.outer.count + column[c]] += sum;
    }
    WP_TILE_SYNC();
""")
def go_forward(
    model: Model,
    w: int,
    pair: int,
    start: int,
    n: int,
    factor: wp.array3d(dtype=real),
    W: wp.array3d(dtype=real),
    solution: wp.array(dtype=real),
    at: int,
    right: wp.array(dtype=real),
): ...


# Of n places from `start` on: x <- U^-1 (x - W z).
@wp.func_native("""
    const int cap = model.capacity.slots, width = model.pairs.coupled_capacity;
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM, count = model.pairs.coupled_count.data[pair];
    const double* U = factor.data + ((size_t)w * cap + start) * cap + start;
    double* x = solution.data + at + start;
    const int* column = model.pairs.coupled.data + (size_t)pair * width;
    for (int i = lane; i < n; i += lanes) {
        const double* b = W.data + ((size_t)w * cap + start + i) * width; double sum = 0.0;
        for (int c = 0; c < count; ++c) sum += b[c] * z.data[(size_t)w * model.outer.count + column[c]];
        x[i] -= sum;
    }
    WP_TILE_SYNC();
    if (lane == 0) for (int i = n - 1; i >= 0; --i) {
        const double* u = U + (size_t)i * cap; double sum = x[i];
        for (int j = i + 1; j < n; ++j) sum -= u[j] * x[j];
        x[i] = sum / u[i];
    }
    WP_TILE_SYNC();
""")
def go_back(
    model: Model,
    w: int,
    pair: int,
    start: int,
    n: int,
    factor: wp.array3d(dtype=real),
    W: wp.array3d(dtype=real),
    z: wp.array(dtype=real),
    solution: wp.array(dtype=real),
    at: int,
): ...


# A + sum W^T W, entries of the pattern.
@wp.func_native("""
    const int N = model.outer.count, width = model.pairs.coupled_capacity;
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const double* A = tangent.data + (size_t)w * N * N;
    double* a = bordered.data + (size_t)w * N * N;
    for (int i = lane; i < N; i += lanes)
        for (int e = p.entry_start.data[i]; e < p.entry_start.data[i + 1]; ++e) {
            const size_t at = (size_t)i * N + p.entry_column.data[e];
            a[at] = A[at];
        }
    WP_TILE_SYNC();
    for (int pair = 0; pair < model.pairs.count; ++pair) {
        if (block.data[((size_t)w * model.pairs.count + pair) * 4 + 1] == 0) continue;
        const int count = model.pairs.coupled_count.data[pair];
        const int* column = model.pairs.coupled.data + (size_t)pair * width;
        const double* s = square.data + ((size_t)w * model.pairs.count + pair) * width * width;
        for (int c = 0; c < count; ++c)
            for (int d = lane; d < count; d += lanes) {
                const double value = s[(size_t)c * width + d];
                if (value != 0.0) a[(size_t)column[c] * N + column[d]] += value;
            }
        WP_TILE_SYNC();
    }
""")
def add_borders(
    model: Model,
    p: Pattern,
    w: int,
    tangent: wp.array3d(dtype=real),
    block: wp.array3d(dtype=int),
    square: wp.array4d(dtype=real),
    bordered: wp.array3d(dtype=real),
): ...


# y += F x over the first n places: what the pressures of each pair displace on the others. Lanes over the places.
@wp.func_native("""
    const int cap = model.capacity.slots, *list = order.data + (size_t)w * cap;
    const double* x = krylov.data + start; double* y = krylov.data + end;
    WP_TILE_SYNC();
    for (int pair = 0; pair < model.pairs.count; ++pair) {
        const int* b = block.data + ((size_t)w * model.pairs.count + pair) * 4;
        for (int i = b[0] + WP_TILE_THREAD_IDX; i < b[0] + b[1]; i += WP_TILE_BLOCK_DIM) {
            const double* g = G.data + ((size_t)w * cap + list[i]) * cap; double sum = 0.0;
            for (int j = 0; j < b[0]; ++j) sum += g[list[j]] * x[j];
            for (int j = b[0] + b[1]; j < n; ++j) sum += g[list[j]] * x[j];
            y[i] += sum;
        }
    }
    WP_TILE_SYNC();
""")
def add_between(
    model: Model,
    w: int,
    n: int,
    G: wp.array3d(dtype=real),
    order: wp.array2d(dtype=int),
    block: wp.array3d(dtype=int),
    krylov: wp.array(dtype=real),
    start: int,
    end: int,
): ...


@wp.kernel
def pose_pressures(
    models: wp.array(dtype=Model),
    patterns: wp.array(dtype=Pattern),
    ctl: wp.array(dtype=Control),
    tangent: wp.array3d(dtype=real),
    rhs: wp.array2d(dtype=real),
    opened: wp.array3d(dtype=real),
    base: wp.array3d(dtype=real),
    slot_hat: wp.array3d(dtype=int),
    order: wp.array2d(dtype=int),
    block: wp.array3d(dtype=int),
    square: wp.array4d(dtype=real),
    G: wp.array3d(dtype=real),
    weight: wp.array2d(dtype=real),
    J: wp.array(dtype=real),
    L: wp.array3d(dtype=real),
    receptance: wp.array(dtype=real),
    modal_residual: wp.array(dtype=real),
    bordered: inout(wp.array3d(dtype=real)),
    bordered_rhs: out(wp.array2d(dtype=real)),
    right: out(wp.array2d(dtype=real)),
):
    """Per world: A + sum W^T W, and both right-hand sides with what leaves the active set."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0:
        return
    add_borders(model, patterns[0], w, tangent, block, square, bordered)
    i = lane
    while i < model.outer.count:
        bordered_rhs[w, i] = rhs[w, i]
        i += wp.block_dim()
    sync()
    last = model.pairs.count - 1
    first_left = block[w, 0, LEFT_START]
    lefts = block[w, last, LEFT_START] + block[w, last, LEFT_COUNT] - first_left
    i = lane
    while i < first_left:  # the places before are those of active slots
        a = order[w, i]
        pair = slot_hat[w, a, 0]
        total = -weight[w, pair] * opened[w, pair, slot_hat[w, a, 1]]
        e = int(0)
        while e < lefts:
            slot = order[w, first_left + e]
            other = slot_hat[w, slot, 0]
            if other == pair or model.pairs.beside != 0:
                total += G[w, a, slot] * weight[w, other] * base[w, other, slot_hat[w, slot, 1]]
            e += 1
        line = (w * model.capacity.slots + a) * model.pairs.most_modes
        for side in range(2):
            surface = surface_of(model, pair, side)
            modes = w * model.modes.count + model.surfaces.modal_start[surface]
            n = model.surfaces.modal_count[surface]
            total += weighted(n, J, line, receptance, modes, modal_residual, modes)
            line += n
        right[w, i] = total
        i += wp.block_dim()
    if lane != 0:
        return
    e = int(0)
    while e < lefts:
        slot = order[w, first_left + e]
        pair = slot_hat[w, slot, 0]
        change = -weight[w, pair] * base[w, pair, slot_hat[w, slot, 1]]
        c = int(0)
        while c < model.pairs.coupled_count[pair]:
            column = model.pairs.coupled[pair, c]
            bordered_rhs[w, column] = bordered_rhs[w, column] + change * L[w, slot, c]
            c += 1
        e += 1


@wp.kernel
def solve_pressures(
    models: wp.array(dtype=Model),
    patterns: wp.array(dtype=Pattern),
    base: wp.array3d(dtype=real),
    slot_hat: wp.array3d(dtype=int),
    order: wp.array2d(dtype=int),
    block: wp.array3d(dtype=int),
    weight: wp.array2d(dtype=real),
    U: wp.array3d(dtype=real),
    W: wp.array3d(dtype=real),
    bordered: wp.array3d(dtype=real),
    hold: wp.array3d(dtype=real),
    hold_count: wp.array(dtype=int),
    right: wp.array2d(dtype=real),
    ctl: inout(wp.array(dtype=Control)),
    bordered_rhs: changed(wp.array(dtype=real)),
    scaling: inout(wp.array2d(dtype=real)),
    pivots: inout(wp.array2d(dtype=int)),
    factor: inout(wp.array(dtype=real)),
    vector: inout(wp.array(dtype=real)),
    lines: inout(wp.array(dtype=real)),
    fallback: inout(wp.array2d(dtype=int)),
    work: inout(wp.array3d(dtype=real)),
    inverse_transposed: inout(wp.array(dtype=real)),
    solution: inout(wp.array(dtype=real)),
    z: inout(wp.array(dtype=real)),
    pressure: out(wp.array3d(dtype=real)),
):
    """Per world: the outer increments, and pressures of the active set, without what pairs do to each other by local
    modes."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0:
        return
    at = w * model.capacity.slots
    count = block[w, 0, LEFT_START]
    i = lane
    while i < count:
        solution[at + i] = right[w, i]
        i += wp.block_dim()
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        go_forward(model, w, pair, block[w, pair, START], block[w, pair, COUNT], U, W, solution, at, bordered_rhs)
        pair += 1
    held = held_motions(ctl, w, hold_count)
    bad = solve(
        model, patterns[0], w, lane, 1, bordered, bordered_rhs, hold, held, scaling, pivots, factor, vector, lines,
        fallback, work, inverse_transposed, z,
    )  # fmt: skip
    if bad != 0 and lane == 0:
        ctl[w].failure = ctl[w].failure | k.SINGULAR
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        go_back(model, w, pair, block[w, pair, START], block[w, pair, COUNT], U, W, z, solution, at)
        pair += 1
    i = lane
    while i < count:
        pair = slot_hat[w, order[w, i], 0]
        m = slot_hat[w, order[w, i], 1]
        pressure[w, pair, m] = base[w, pair, m] + solution[at + i] / weight[w, pair]
        i += wp.block_dim()


@wp.func
def inner(n: int, x: wp.array(dtype=real), a: int, b: int) -> real:
    """x[a:] . x[b:] of n numbers, the same in every lane."""
    total = dot(n, x, a, x, b)
    sync()
    return total


@wp.kernel
def solve_between(
    models: wp.array(dtype=Model),
    patterns: wp.array(dtype=Pattern),
    ctl: wp.array(dtype=Control),
    base: wp.array3d(dtype=real),
    slot_hat: wp.array3d(dtype=int),
    order: wp.array2d(dtype=int),
    block: wp.array3d(dtype=int),
    weight: wp.array2d(dtype=real),
    G: wp.array3d(dtype=real),
    U: wp.array3d(dtype=real),
    W: wp.array3d(dtype=real),
    bordered: wp.array3d(dtype=real),
    hold: wp.array3d(dtype=real),
    scaling: inout(wp.array2d(dtype=real)),
    pivots: inout(wp.array2d(dtype=int)),
    factor: inout(wp.array(dtype=real)),
    vector: inout(wp.array(dtype=real)),
    lines: inout(wp.array(dtype=real)),
    fallback: inout(wp.array2d(dtype=int)),
    work: inout(wp.array3d(dtype=real)),
    inverse_transposed: inout(wp.array(dtype=real)),
    krylov: inout(wp.array(dtype=real)),
    krylov_rhs: inout(wp.array(dtype=real)),
    krylov_z: inout(wp.array(dtype=real)),
    krylov_path: inout(wp.array(dtype=real)),
    solution: changed(wp.array(dtype=real)),
    z: changed(wp.array(dtype=real)),
    pressure: out(wp.array3d(dtype=real)),
):
    """Per world: outer increments and pressures with what pairs do to each other by local modes, by conjugate gradients
    from the solution without."""
    w, lane = wp.tid()
    model = models[0]
    count = block[w, 0, LEFT_START]
    if ctl[w].run == 0 or count == 0:
        return
    cap = model.capacity.slots
    N = model.outer.count
    at = w * cap
    residual = w * 4 * cap  # r, M^-1 r, the direction p and M p
    answer = residual + cap
    path = residual + 2 * cap
    image = residual + 3 * cap
    i = lane
    while i < count:
        krylov[residual + i] = real(0.0)
        krylov[path + i] = -solution[at + i]
        krylov[image + i] = real(0.0)
        i += wp.block_dim()
    i = lane
    while i < N:
        krylov_path[w * N + i] = real(0.0)
        i += wp.block_dim()
    add_between(model, w, count, G, order, block, krylov, path, residual)  # r = -F x
    reference = real(0.0)
    before = real(0.0)
    step = int(0)
    while step < GRADIENTS:
        i = lane
        while i < count:
            krylov[answer + i] = krylov[residual + i]
            i += wp.block_dim()
        i = lane
        while i < N:
            krylov_rhs[w * N + i] = real(0.0)
            i += wp.block_dim()
        sync()
        pair = int(0)
        while pair < model.pairs.count:
            go_forward(model, w, pair, block[w, pair, START], block[w, pair, COUNT], U, W, krylov, answer, krylov_rhs)
            pair += 1
        solve(
            model, patterns[0], w, lane, 0, bordered, krylov_rhs, hold, 0, scaling, pivots, factor, vector, lines,
            fallback, work, inverse_transposed, krylov_z,
        )  # fmt: skip
        sync()
        pair = int(0)
        while pair < model.pairs.count:
            go_back(
                model, w, pair, block[w, pair, START], block[w, pair, COUNT], U, W, krylov_z, krylov, answer
            )  # fmt: skip
            pair += 1
        product = inner(count, krylov, residual, answer)
        if step == 0:
            reference = product
        if not (product > EXACT * reference):
            break
        share = real(0.0)
        if step > 0:
            share = product / before
        before = product
        i = lane
        while i < count:
            if step == 0:
                krylov[path + i] = real(0.0)
            krylov[path + i] = krylov[answer + i] + share * krylov[path + i]
            krylov[image + i] = krylov[residual + i] + share * krylov[image + i]
            i += wp.block_dim()
        i = lane
        while i < N:
            krylov_path[w * N + i] = krylov_z[w * N + i] + share * krylov_path[w * N + i]
            i += wp.block_dim()
        sync()
        # the image by M is carried along, that by F is added for the step and taken off again
        i = lane
        while i < count:
            krylov[answer + i] = krylov[image + i]
            i += wp.block_dim()
        sync()
        add_between(model, w, count, G, order, block, krylov, path, answer)
        length = product / inner(count, krylov, path, answer)
        i = lane
        while i < count:
            solution[at + i] = solution[at + i] + length * krylov[path + i]
            krylov[residual + i] = krylov[residual + i] - length * krylov[answer + i]
            i += wp.block_dim()
        i = lane
        while i < N:
            z[w * N + i] = z[w * N + i] + length * krylov_path[w * N + i]
            i += wp.block_dim()
        sync()
        step += 1
    i = lane
    while i < count:
        pair = slot_hat[w, order[w, i], 0]
        m = slot_hat[w, order[w, i], 1]
        pressure[w, pair, m] = base[w, pair, m] + solution[at + i] / weight[w, pair]
        i += wp.block_dim()


@wp.func
def push_by_slots(
    model: Model,
    ctl: wp.array(dtype=Control),
    w: int,
    slot_hat: wp.array3d(dtype=int),
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    base: wp.array3d(dtype=real),
    weight: wp.array2d(dtype=real),
    J: wp.array(dtype=real),
    push: wp.array(dtype=real),
):
    """Adds J^T ds, the weighted changes of all slots on the global modes, to `push` (W times modes)."""
    slot = int(0)
    while slot < ctl[w].slots:
        pair = slot_hat[w, slot, 0]
        change = weight[w, pair] * change_of(w, slot, slot_hat, active, pressure, base)
        if change != real(0.0):
            start = (w * model.capacity.slots + slot) * model.pairs.most_modes
            for side in range(2):
                surface = surface_of(model, pair, side)
                modes = model.surfaces.modal_count[surface]
                axpy(modes, change, J, start, push, w * model.modes.count + model.surfaces.modal_start[surface])
                start += modes
        slot += 1


@wp.kernel
def modal_increments(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    active: wp.array3d(dtype=int),
    slot_hat: wp.array3d(dtype=int),
    weight: wp.array2d(dtype=real),
    J: wp.array(dtype=real),
    pressure: wp.array3d(dtype=real),
    base: wp.array3d(dtype=real),
    C_modal: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    modal_residual: wp.array2d(dtype=real),
    z: wp.array(dtype=real),
    modal_step: inout(wp.array(dtype=real)),
):
    """Per world, lanes over modes: increment sigma^-1 (-r_m - C_m^T dlam + J^T ds)."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0:
        return
    first = w * model.modes.count
    n = lane
    while n < model.modes.count:
        modal_step[first + n] = -modal_residual[w, n]
        n += wp.block_dim()
    sync()
    push_by_slots(model, ctl, w, slot_hat, active, pressure, base, weight, J, modal_step)
    row = int(0)
    while row < model.rows.count:
        for side in range(2):
            b = side_of(model, row, side)
            if b >= 0:
                pull = -z[w * model.outer.count + model.outer.row_offset + row]
                at = first + model.bodies.modal_start[b]
                axpy(model.bodies.global_count[b], pull, C_modal, modal_line(model, w, row, b), modal_step, at)
        row += 1
    sync()
    n = lane
    while n < model.modes.count:
        modal_step[first + n] = receptance[w, n] * modal_step[first + n]
        if model.modes.dense_of[n] >= 0:
            modal_step[first + n] = z[w * model.outer.count + 6 * model.bodies.count + model.modes.dense_of[n]]
        n += wp.block_dim()


@wp.kernel
def correct_set(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    axes: wp.array2d(dtype=mat33),
    r1: wp.array2d(dtype=vec3),
    window: wp.array3d(dtype=int),
    area: wp.array3d(dtype=real),
    wrench: wp.array4d(dtype=real),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    gap: wp.array3d(dtype=real),
    first_step: wp.array3d(dtype=real),
    second_step: wp.array(dtype=real),
    first_local: wp.array(dtype=real),
    second_local: wp.array(dtype=real),
    z: wp.array(dtype=real),
    pressure: wp.array3d(dtype=real),
    active: wp.array3d(dtype=int),
    proposed: out(wp.array3d(dtype=int)),
):
    """Per (world, pair), lanes over hats of the window: the corrected active set, written to `proposed`."""
    w, pair, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0:
        return
    A = model.pairs.first[pair]
    body_a = model.surfaces.body[A]
    body_b = model.surfaces.body[model.pairs.second[pair]]
    rows = model.surfaces.rows[A]
    rows_b = model.surfaces.rows[model.pairs.second[pair]]
    H = model.window.half
    # motion of A relative to B at A's centre of mass
    a = w * model.outer.count + 6 * body_a
    move = vec3(z[a], z[a + 1], z[a + 2])
    spin = axes[w, body_a] * vec3(z[a + 3], z[a + 4], z[a + 5])
    if body_b >= 0:
        b = w * model.outer.count + 6 * body_b
        turn_b = axes[w, body_b] * vec3(z[b + 3], z[b + 4], z[b + 5])
        move -= vec3(z[b], z[b + 1], z[b + 2]) + wp.cross(turn_b, r1[w, body_a] - r1[w, body_b])
        spin -= turn_b
    m = (window[w, pair, 0] + H) * rows + lane
    while m < (window[w, pair, 1] + H + 1) * rows:
        new = int(0)
        if active[w, pair, m] != 0:
            if pressure[w, pair, m] > real(0.0):
                new = int(1)
        elif area[w, pair, m] > real(0.0):
            f = vec3(wrench[w, pair, m, 0], wrench[w, pair, m, 1], wrench[w, pair, m, 2])
            t = vec3(wrench[w, pair, m, 3], wrench[w, pair, m, 4], wrench[w, pair, m, 5])
            value = gap[w, pair, m] + wp.dot(f, move) + wp.dot(t, spin) - first_step[w, pair, m]
            value -= on_stencil(model, w, pair, m, rows_b, stencil, stencil_at, second_step)
            value += local_gap(model, w, pair, m, stencil, stencil_at, first_local, second_local)
            if value < -GAP_TOLERANCE * model.length * area[w, pair, m]:
                new = int(1)
        proposed[w, pair, m] = new
        m += wp.block_dim()


@wp.kernel
def accept_set(
    models: wp.array(dtype=Model),
    center: wp.array3d(dtype=int),
    proposed: wp.array3d(dtype=int),
    ctl: inout(wp.array(dtype=Control)),
    active: inout(wp.array3d(dtype=int)),
    pressure: out(wp.array3d(dtype=real)),
    window: changed(wp.array3d(dtype=int)),
):
    """Per world: take over the corrected set, count the changes, widen a window that its patch has reached, check the
    guards.

    The pressures of hats that leave are zeroed. After `max_inner` solves of one linearisation only the first hat that
    is on the wrong side changes it (Murty's least index, which cannot cycle where G is positive definite).
    """
    w = wp.tid()
    model = models[0]
    if ctl[w].run == 0:
        return
    H = model.window.half
    changes = int(0)
    number = int(0)
    pair = int(0)
    while pair < model.pairs.count:
        A = model.pairs.first[pair]
        rows = model.surfaces.rows[A]
        low = H + 1
        high = -H - 1
        m = (window[w, pair, 0] + H) * rows
        while m < (window[w, pair, 1] + H + 1) * rows:
            if proposed[w, pair, m] != active[w, pair, m] and (changes == 0 or ctl[w].inner < model.limits.max_inner):
                changes += 1
                active[w, pair, m] = proposed[w, pair, m]
                if proposed[w, pair, m] == 0:
                    pressure[w, pair, m] = real(0.0)
            if active[w, pair, m] != 0:
                number += 1
                o = m / rows - H
                low = wp.min(low, o)
                high = wp.max(high, o)
            m += 1
        if low <= high:
            if low < window[w, pair, 0] + GUARD and window[w, pair, 0] > -H:
                window[w, pair, 0] = wp.max(low - GUARD - 1, -H)
                changes += 1
                ctl[w].reassemble = 1
            if high > window[w, pair, 1] - GUARD and window[w, pair, 1] < H:
                window[w, pair, 1] = wp.min(high + GUARD + 1, H)
                changes += 1
                ctl[w].reassemble = 1
            if changes == 0:
                if low < -H + GUARD and goes_on(model, A, center[w, pair, 0] - H - 1):
                    overflow(model, ctl, w, rows)
                if high > H - GUARD and goes_on(model, A, center[w, pair, 0] + H + 1):
                    overflow(model, ctl, w, rows)
                if model.surfaces.periodic[A] == 0:
                    if center[w, pair, 0] + low <= 0 or center[w, pair, 0] + high >= model.surfaces.columns[A] - 1:
                        ctl[w].edge = 1
        pair += 1
    ctl[w].changes = changes
    ctl[w].active = number


@wp.func
def goes_on(model: Model, surface: int, column: int) -> bool:
    return model.surfaces.periodic[surface] != 0 or (column >= 0 and column < model.surfaces.columns[surface])


@wp.func
def overflow(model: Model, ctl: wp.array(dtype=Control), w: int, rows: int):
    ctl[w].failure = ctl[w].failure | k.CAPACITY
    ctl[w].spare = wp.max(ctl[w].spare, 2 * model.window.columns * rows)
