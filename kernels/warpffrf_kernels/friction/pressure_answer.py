r"""How the pressures and the outer coordinates answer to a change of the tractions.

With ds the change of the pressures of the active set, dtau that of the tractions and dz that of the outer coordinates,
G, L, A of the gaps (`contact_solve`), K, L_t of the weak slips (`cell_compliance`), a linearised step is

    opened + G ds + N^T dtau + L dz = 0,     r + N ds + K dtau + L_t dz in the law of friction,
    A dz = L^T ds + L_t^T dtau,

    N^T = -M D_nt^A area - l D_nt^B (area Q o)^T + J_n sigma^-1 J^T.

Pressures are solved for first, tractions with these. Were the pressures held, each iteration would take back what the
tractions of the last one did to the gaps, and leave N^T K^-1 N G^-1 of an error, however short the step: where all
cells stick beta^2 on half-spaces with Dundurs' constant beta, 0.24 to 0.33 on rollers on a rigid plane, the more the
finer they are along the axis, and nearly all where little but the contact holds a body. So this answer is condensed,
pair by pair, with the active set as it is: with U^T U = G, W = U^-T L and U^T Y = N^T,

    ds = -U^-1 (Y dtau + W dz),      L' = L_t - Y^T W,      (A + W^T W) dz = L'^T dtau,

    r + K' dtau,      K' = K - Y^T Y + L' V',      V' = (A + W^T W)^-1 L'^T,

a Schur complement of a positive semidefinite matrix, which is one.

The bounds follow that answer too: tractions and bounds are solved for in turn, in rounds, with the same matrices. Each
leaves some mu N^T G^-1 of an error, which converges where friction has one solution, and costs next to nothing where
nobody changes sides.
"""

import warp as wp

from warpffrf_kernels.core.access import changed, inout, out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync, vec3
from warpffrf_kernels.friction.cell_shares import on_shares
from warpffrf_kernels.friction.cells import cell_at
from warpffrf_kernels.linear.outer_solve import solve
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.normal.pair_elimination import COUNT as SLOTS
from warpffrf_kernels.normal.pair_elimination import LEFT_START, START
from warpffrf_kernels.surfaces.responses import own_load, place_in_table

wp.set_module_options(MODULE_OPTIONS)


COUNT = wp.constant(0)  # active slots that Y was made for
RENEWED = wp.constant(1)  # 1 where Y is new in this iteration
OPEN = wp.constant(2)  # 1 while the bounds do not follow the pressures yet
ROUND = wp.constant(3)  # rounds of tractions and bounds in this iteration
SAME = wp.constant(wp.float64(1.0e-3))  # of the first answer: a round that changes the pressures by less is the last
ROUND_OFF = wp.constant(wp.float64(1.0e-14))  # of the largest pressure
ROUNDS = wp.constant(20)  # of an iteration: a half of the change left by each, for friction close to its limits


@wp.func
def hat_of(model: Model, w: int, slot: int, slot_hat: wp.array3d(dtype=int)) -> int:
    """The hat of a slot, numbered over all pairs."""
    return slot_hat[w, slot, 0] * model.window.hats + slot_hat[w, slot, 1]


@wp.func
def is_new(
    model: Model,
    w: int,
    n: int,
    ctl: wp.array(dtype=Control),
    order: wp.array2d(dtype=int),
    slot_hat: wp.array3d(dtype=int),
    answer_hat: wp.array2d(dtype=int),
    answer_state: wp.array2d(dtype=int),
) -> int:
    """1 where there are fresh cells, or the active set is not the one that Y was made for."""
    if ctl[w].fresh_cells != ctl[w].cells or n != answer_state[w, COUNT]:
        return 1
    a = int(0)
    while a < n:
        if hat_of(model, w, order[w, a], slot_hat) != answer_hat[w, a]:
            return 1
        a += 1
    return 0


# Line `a` of Y, from N^T: of active slot `slot` against the two lines of each cell, the part of the modes that are
# condensed; 0 for cells of other pairs. Lanes over the cells.
@wp.func_native("""
    const int cells = model.capacity.cells, width = model.pairs.most_modes;
    const int cap = model.capacity.slots;
    const int pair = slot_hat.data[((size_t)w * cap + slot) * 2];
    const double* Ji = J.data + ((size_t)w * cap + slot) * width;
    const double* s = receptance.data + (size_t)w * model.modes.count;
    double* scaled = scratch.data + (size_t)w * 2 * width;
    int all = 0;
    WP_TILE_SYNC();
    for (int side = 0; side < 2; ++side) {
        const int surface = (side ? model.pairs.second : model.pairs.first).data[pair];
        const int first = model.surfaces.modal_start.data[surface];
        const int count = model.surfaces.modal_count.data[surface];
        for (int n = WP_TILE_THREAD_IDX; n < count; n += WP_TILE_BLOCK_DIM)
            scaled[all + n] = Ji[all + n] * s[first + n];
        all += count;
    }
    WP_TILE_SYNC();
    double* y = Y.data + ((size_t)w * cap + a) * 2 * cells;
    for (int j = WP_TILE_THREAD_IDX; j < 2 * count; j += WP_TILE_BLOCK_DIM) {
        const int same = cell_slot.data[((size_t)w * cells + j / 2) * 2] == pair;
        const double* Jj = cell_J.data + ((size_t)w * 2 * cells + j) * width;
        double sum = 0.0;
        for (int n = 0; same && n < all; ++n) sum += scaled[n] * Jj[n];
        y[j] = sum;
    }
    WP_TILE_SYNC();
""")
def couple_modes(
    model: Model,
    w: int,
    a: int,
    slot: int,
    count: int,
    slot_hat: wp.array3d(dtype=int),
    cell_slot: wp.array3d(dtype=int),
    J: wp.array(dtype=real),
    cell_J: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    scratch: wp.array(dtype=real),
    Y: wp.array3d(dtype=real),
): ...


@wp.func
def couple_near(
    model: Model,
    w: int,
    a: int,
    slot: int,
    lane: int,
    slot_hat: wp.array3d(dtype=int),
    cell_slot: wp.array3d(dtype=int),
    cells: int,
    center: wp.array3d(dtype=int),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    cell_area: wp.array3d(dtype=real),
    cell_turn: wp.array4d(dtype=real),
    share: wp.array4d(dtype=real),
    share_at: wp.array4d(dtype=int),
    shift: wp.array(dtype=real),
    Y: wp.array3d(dtype=real),
):
    """Adds to line `a` of Y the part of the local modes: slips of the cells under a unit pressure on active slot
    `slot`, as `tangential_fields.press_cells` has them."""
    pair = slot_hat[w, slot, 0]
    m = slot_hat[w, slot, 1]
    B = model.pairs.second[pair]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    flexible = model.surfaces.shear_start[B] >= 0
    start = (w * model.pairs.count + pair) * 2 * model.window.nodes
    if flexible:
        rows_b = model.surfaces.rows[B]
        table_b = model.responses.pressed[own_load(model, 2 * pair + 1)]
        origin_b = center[w, pair, 1] - model.window.second_half
        wide = 2 * model.window.second_columns * rows_b
        i = lane
        while i < wide:
            shift[start + i] = real(0.0)
            i += wp.block_dim()
        sync()
        e = int(0)
        while e < model.window.stencil_columns * model.window.stencil_rows:
            part = stencil[w, pair, m, e]
            if part != real(0.0):
                column = origin_b + stencil_at[w, pair, m, 0] + e / model.window.stencil_rows
                row = stencil_at[w, pair, m, 1] + e % model.window.stencil_rows
                at = place_in_table(model, table_b, column, row, origin_b)
                if at >= 0:
                    axpy(wide, -part, model.responses.number, at, shift, start)
            e += 1
        sync()
    origin = center[w, pair, 0] - model.window.half
    table = model.responses.pressed[own_load(model, 2 * pair)]
    at = place_in_table(model, table, origin + m / rows, m % rows, origin)
    j = lane
    while j < cells:
        if cell_slot[w, j, 0] == pair:
            n = cell_slot[w, j, 1]
            second = vec3(real(0.0), real(0.0), real(0.0))
            if flexible:
                second = on_shares(model, w, pair, n, cell_turn, share, share_at, shift)
            for d in range(2):
                value = -second[d]
                if at >= 0:
                    value -= model.responses.number[at + cell_at(rows, n, d)]
                Y[w, a, 2 * j + d] = Y[w, a, 2 * j + d] + cell_area[w, pair, n] * value
        j += wp.block_dim()
    sync()


# Y = U^-T N^T in place of N^T, of the n lines of a pair from `start` on, lanes over the columns; U as
# `contact_solve.factor_block` left it.
@wp.func_native("""
    const int cap = model.capacity.slots, width = 2 * model.capacity.cells;
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const double* U = factor.data + ((size_t)w * cap + start) * cap + start;
    double* y0 = Y.data + ((size_t)w * cap + start) * width;
    for (int i = 0; i < n; ++i) {
        double* __restrict x = y0 + (size_t)i * width; int j = 0;
        for (; j + 3 < i; j += 4) {
            const double m0 = U[(size_t)j * cap + i], m1 = U[(size_t)(j + 1) * cap + i];
            const double m2 = U[(size_t)(j + 2) * cap + i], m3 = U[(size_t)(j + 3) * cap + i];
            const double *a = y0 + (size_t)j * width, *b = a + width, *c = b + width, *d = c + width;
            for (int q = lane; q < lines; q += lanes) x[q] -= m0 * a[q] + m1 * b[q] + m2 * c[q] + m3 * d[q];
        }
        for (; j < i; ++j) { const double m = U[(size_t)j * cap + i]; const double* a = y0 + (size_t)j * width;
            for (int q = lane; q < lines; q += lanes) x[q] -= m * a[q]; }
        const double scale = 1.0 / U[(size_t)i * cap + i];
        for (int q = lane; q < lines; q += lanes) x[q] *= scale;
    }
    WP_TILE_SYNC();
""")
def eliminate(
    model: Model, w: int, start: int, n: int, lines: int, factor: wp.array3d(dtype=real), Y: wp.array3d(dtype=real)
): ...


# K - Y^T Y over the first lines, the upper triangle and its mirror, lanes over the columns.
@wp.func_native("""
    const int cap = 2 * model.capacity.cells, lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const double* y0 = Y.data + (size_t)w * model.capacity.slots * cap;
    double* K0 = K.data + (size_t)w * cap * cap;
    for (int i = 0; i < lines; ++i) {
        double* __restrict x = K0 + (size_t)i * cap; int k = 0;
        for (; k + 3 < n; k += 4) {
            const double *a = y0 + (size_t)k * cap, *b = a + cap, *c = b + cap, *d = c + cap;
            const double m0 = a[i], m1 = b[i], m2 = c[i], m3 = d[i];
            for (int j = i + lane; j < lines; j += lanes) x[j] -= m0 * a[j] + m1 * b[j] + m2 * c[j] + m3 * d[j];
        }
        for (; k < n; ++k) { const double* a = y0 + (size_t)k * cap; const double m = a[i];
            for (int j = i + lane; j < lines; j += lanes) x[j] -= m * a[j]; }
    }
    WP_TILE_SYNC();
    for (int i = 0; i < lines; ++i)
        for (int j = i + 1 + lane; j < lines; j += lanes) K0[(size_t)j * cap + i] = K0[(size_t)i * cap + j];
    WP_TILE_SYNC();
""")
def subtract_answer(model: Model, w: int, n: int, lines: int, Y: wp.array3d(dtype=real), K: wp.array3d(dtype=real)): ...


@wp.kernel
def answer_tractions(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    center: wp.array3d(dtype=int),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    slot_hat: wp.array3d(dtype=int),
    order: wp.array2d(dtype=int),
    block: wp.array3d(dtype=int),
    factor: wp.array3d(dtype=real),
    J: wp.array(dtype=real),
    cell_slot: wp.array3d(dtype=int),
    cell_area: wp.array3d(dtype=real),
    cell_turn: wp.array4d(dtype=real),
    share: wp.array4d(dtype=real),
    share_at: wp.array4d(dtype=int),
    cell_J: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    shift: inout(wp.array(dtype=real)),
    scratch: inout(wp.array(dtype=real)),
    Y: inout(wp.array3d(dtype=real)),
    answer_hat: inout(wp.array2d(dtype=int)),
    answer_state: inout(wp.array2d(dtype=int)),
):
    """Per world: Y, a line per active slot in the order of the last solve; kept while cells and the active set stay."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    n = block[w, 0, LEFT_START]  # the places before are those of active slots
    renewed = is_new(model, w, n, ctl, order, slot_hat, answer_hat, answer_state)
    sync()
    if lane == 0:
        answer_state[w, COUNT] = n
        answer_state[w, RENEWED] = renewed
        answer_state[w, OPEN] = 1
        answer_state[w, ROUND] = 0
    if renewed == 0:
        return
    cells = ctl[w].cells
    a = int(0)
    while a < n:
        slot = order[w, a]
        if lane == 0:
            answer_hat[w, a] = hat_of(model, w, slot, slot_hat)
        couple_modes(model, w, a, slot, cells, slot_hat, cell_slot, J, cell_J, receptance, scratch, Y)
        if model.pairs.friction[slot_hat[w, slot, 0]] > real(0.0):
            couple_near(
                model, w, a, slot, lane, slot_hat, cell_slot, cells, center, stencil, stencil_at, cell_area,
                cell_turn, share, share_at, shift, Y,
            )  # fmt: skip
        a += 1
    pair = int(0)
    while pair < model.pairs.count:
        eliminate(model, w, block[w, pair, START], block[w, pair, SLOTS], 2 * cells, factor, Y)
        pair += 1


# L' = L - Y^T W of line `line` of a cell, over the coupled columns of its pair. Lanes over the columns.
@wp.func_native("""
    const int cap = model.capacity.slots, width = model.pairs.coupled_capacity, lines = 2 * model.capacity.cells;
    const int count = model.pairs.coupled_count.data[pair];
    double* __restrict x = bordered.data + ((size_t)w * lines + line) * width;
    const double* l = L.data + ((size_t)w * lines + line) * width;
    for (int c = WP_TILE_THREAD_IDX; c < count; c += WP_TILE_BLOCK_DIM) x[c] = l[c];
    for (int i = start; i < start + n; ++i) {
        const double y = Y.data[((size_t)w * cap + i) * lines + line];
        const double* b = W.data + ((size_t)w * cap + i) * width;
        for (int c = WP_TILE_THREAD_IDX; c < count; c += WP_TILE_BLOCK_DIM) x[c] -= y * b[c];
    }
    WP_TILE_SYNC();
""")
def border_line(
    model: Model,
    w: int,
    pair: int,
    line: int,
    start: int,
    n: int,
    L: wp.array3d(dtype=real),
    Y: wp.array3d(dtype=real),
    W: wp.array3d(dtype=real),
    bordered: wp.array3d(dtype=real),
): ...


@wp.kernel
def border_cells(
    models: wp.array(dtype=Model),
    patterns: wp.array(dtype=Pattern),
    ctl: wp.array(dtype=Control),
    cell_slot: wp.array3d(dtype=int),
    block: wp.array3d(dtype=int),
    answer_state: wp.array2d(dtype=int),
    L: wp.array3d(dtype=real),
    Y: wp.array3d(dtype=real),
    W: wp.array3d(dtype=real),
    matrix: wp.array3d(dtype=real),
    hold: wp.array3d(dtype=real),
    scaling: inout(wp.array2d(dtype=real)),
    pivots: inout(wp.array2d(dtype=int)),
    factor: inout(wp.array(dtype=real)),
    vector: inout(wp.array(dtype=real)),
    lines: inout(wp.array(dtype=real)),
    fallback: inout(wp.array2d(dtype=int)),
    work: inout(wp.array3d(dtype=real)),
    inverse_transposed: inout(wp.array(dtype=real)),
    right: inout(wp.array(dtype=real)),
    column: inout(wp.array(dtype=real)),
    mobility: inout(wp.array(dtype=real)),
    bordered: inout(wp.array3d(dtype=real)),
    V: inout(wp.array(dtype=real)),
):
    """Per world: L' and V' of all lines of cells, where Y is new. mobility: columns of (A + W^T W)^-1."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].changes != 0 or answer_state[w, RENEWED] == 0:
        return
    N = model.outer.count
    i = lane
    while i < N:
        right[w * N + i] = real(0.0)
        i += wp.block_dim()
    c = int(0)
    while c < N:
        sync()
        if lane == 0:
            right[w * N + c] = real(1.0)
        sync()
        solve(
            model, patterns[0], w, lane, 0, matrix, right, hold, 0, scaling, pivots, factor, vector, lines, fallback,
            work, inverse_transposed, column,
        )  # fmt: skip
        sync()
        i = lane
        while i < N:
            mobility[(w * N + c) * N + i] = column[w * N + i]
            i += wp.block_dim()
        if lane == 0:
            right[w * N + c] = real(0.0)
        c += 1
    sync()
    line = int(0)
    while line < 2 * ctl[w].cells:
        pair = cell_slot[w, line / 2, 0]
        border_line(model, w, pair, line, block[w, pair, START], block[w, pair, SLOTS], L, Y, W, bordered)
        begin = (w * 2 * model.capacity.cells + line) * N
        i = lane
        while i < N:
            V[begin + i] = real(0.0)
            i += wp.block_dim()
        sync()
        c = int(0)
        while c < model.pairs.coupled_count[pair]:
            axpy(N, bordered[w, line, c], mobility, (w * N + model.pairs.coupled[pair, c]) * N, V, begin)
            c += 1
        line += 1


@wp.kernel
def condense_answer(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    Y: wp.array3d(dtype=real),
    answer_state: wp.array2d(dtype=int),
    K: changed(wp.array3d(dtype=real)),
):
    """Per world: K - Y^T Y where Y is new."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].changes != 0 or answer_state[w, RENEWED] == 0:
        return
    subtract_answer(model, w, answer_state[w, COUNT], 2 * ctl[w].cells, Y, K)


# step = -U^-1 (Y dtau + W dz) of the n lines of a pair from `start` on, dz = V dtau. Lanes over the lines, then of one.
@wp.func_native("""
    const int cap = model.capacity.slots, lines = 2 * model.capacity.cells, wide = model.pairs.coupled_capacity;
    const double* U = factor.data + ((size_t)w * cap + start) * cap + start;
    const double *t = tau.data + (size_t)w * lines, *t0 = base.data + (size_t)w * lines;
    const double* dz = z_change.data + (size_t)w * model.outer.count;
    const int *column = model.pairs.coupled.data + (size_t)pair * wide, count = model.pairs.coupled_count.data[pair];
    double* x = step.data + (size_t)w * cap + start;
    WP_TILE_SYNC();
    for (int i = WP_TILE_THREAD_IDX; i < n; i += WP_TILE_BLOCK_DIM) {
        const double* y = Y.data + ((size_t)w * cap + start + i) * lines;
        const double* b = W.data + ((size_t)w * cap + start + i) * wide;
        double s[8] = {0.0}, sum = 0.0; int j = 0;
        for (; j + 7 < used; j += 8) for (int c = 0; c < 8; ++c) s[c] += y[j + c] * (t[j + c] - t0[j + c]);
        for (; j < used; ++j) sum += y[j] * (t[j] - t0[j]);
        for (int c = 0; c < 8; ++c) sum += s[c];
        for (int c = 0; c < count; ++c) sum += b[c] * dz[column[c]];
        x[i] = -sum;
    }
    WP_TILE_SYNC();
    if (WP_TILE_THREAD_IDX == 0) for (int i = n - 1; i >= 0; --i) {
        const double* u = U + (size_t)i * cap; double sum = x[i];
        for (int j = i + 1; j < n; ++j) sum -= u[j] * x[j];
        x[i] = sum / u[i];
    }
    WP_TILE_SYNC();
""")
def answer_to(
    model: Model,
    w: int,
    pair: int,
    start: int,
    n: int,
    used: int,
    factor: wp.array3d(dtype=real),
    Y: wp.array3d(dtype=real),
    W: wp.array3d(dtype=real),
    z_change: wp.array(dtype=real),
    tau: wp.array2d(dtype=real),
    base: wp.array2d(dtype=real),
    step: wp.array2d(dtype=real),
): ...


@wp.kernel
def press_with_tractions(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    slot_hat: wp.array3d(dtype=int),
    order: wp.array2d(dtype=int),
    block: wp.array3d(dtype=int),
    factor: wp.array3d(dtype=real),
    solution: wp.array2d(dtype=real),
    Y: wp.array3d(dtype=real),
    W: wp.array3d(dtype=real),
    V: wp.array(dtype=real),
    weight: wp.array2d(dtype=real),
    tau: wp.array2d(dtype=real),
    tau_base: wp.array2d(dtype=real),
    base: wp.array3d(dtype=real),
    z_change: inout(wp.array(dtype=real)),
    step: inout(wp.array2d(dtype=real)),
    pressure: inout(wp.array3d(dtype=real)),
    change: inout(wp.array2d(dtype=real)),
    answer_state: inout(wp.array2d(dtype=int)),
):
    """Per world: the pressures with their answer to the tractions found in this round, none below zero, and whether the
    bounds are to follow them in another one. change: of the largest in the first round."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].changes != 0 or answer_state[w, OPEN] == 0:
        return
    n = answer_state[w, COUNT]
    N = model.outer.count
    i = lane
    while i < N:
        z_change[w * N + i] = real(0.0)
        i += wp.block_dim()
    sync()
    i = int(0)
    while i < 2 * ctl[w].cells:
        moved = tau[w, i] - tau_base[w, i]
        if moved != real(0.0):
            axpy(N, moved, V, (w * 2 * model.capacity.cells + i) * N, z_change, w * N)
        i += 1
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        answer_to(
            model, w, pair, block[w, pair, START], block[w, pair, SLOTS], 2 * ctl[w].cells, factor, Y, W, z_change,
            tau, tau_base, step,
        )  # fmt: skip
        pair += 1
    if lane != 0:
        return
    most = real(0.0)
    largest = real(0.0)
    a = int(0)
    while a < n:
        slot = order[w, a]
        pair = slot_hat[w, slot, 0]
        m = slot_hat[w, slot, 1]
        value = wp.max(base[w, pair, m] + (solution[w, a] + step[w, a]) / weight[w, pair], real(0.0))
        most = wp.max(most, wp.abs(value - pressure[w, pair, m]))
        largest = wp.max(largest, value)
        pressure[w, pair, m] = value
        a += 1
    rounds = answer_state[w, ROUND] + 1
    answer_state[w, ROUND] = rounds
    if rounds == 1:
        change[w, 0] = most
    settled = most <= wp.max(SAME * change[w, 0], ROUND_OFF * largest) and rounds > 1
    if settled or most == real(0.0) or rounds == ROUNDS or ctl[w].failure != 0:
        answer_state[w, OPEN] = 0


@wp.kernel
def count_rounds(ctl: wp.array(dtype=Control), answer_state: wp.array2d(dtype=int), again: out(wp.array(dtype=int))):
    """One thread: do the bounds of any world still follow its pressures?"""
    open_worlds = int(0)
    w = int(0)
    while w < ctl.shape[0]:
        if ctl[w].run != 0 and ctl[w].changes == 0:
            open_worlds += answer_state[w, OPEN]
        w += 1
    again[0] = open_worlds
