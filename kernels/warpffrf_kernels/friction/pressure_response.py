r"""Response of the pressures and the retained coordinates to a change of the tractions.

With ds the change of the pressures of the active set, dtau that of the tractions and dz that of the retained
coordinates, G, L, A of the gaps (`contact_solve`), K, L_t of the weak slips (`cell_compliance`), a linearised step is
    opened + G ds + N^T dtau + L dz = 0,     r + N ds + K dtau + L_t dz in the law of friction,
    A dz = L^T ds + L_t^T dtau,

    N^T = -M D_nt^A area - l D_nt^B (area Q o)^T + J_n sigma^-1 J^T.

Pressures are solved first, tractions with these. If the pressures were held fixed, each iteration would undo the effect
of the last tractions on the gaps, and leave N^T K^-1 N G^-1 of an error, however short the step: if all cells stick,
beta^2 for half-spaces with Dundurs' constant beta; 0.24 to 0.33 for rollers on a rigid plane, growing with the
refinement along the axis; and nearly all if little but the contact supports a body. The response is therefore
condensed, pair by pair, with the present active set: with U^T U = G, W = U^-T L and U^T Y = N^T,

    ds = -U^-1 (Y dtau + W dz),      L' = L_t - Y^T W,      (A + W^T W) dz = L'^T dtau,

    r + K' dtau,      K' = D + L' M L'^T,      D = K - Y^T Y,      M = (A + W^T W)^-1,

a Schur complement of a positive semidefinite matrix, hence positive semidefinite. D has a block for each pair
(`cell_blocks`); M is computed in `friction_receptance`.

On contact-fixed cells (`rolling`) Y, whose cost grows with the third power of their number, is omitted from K
(`answering`), so K is kept from step to step. There the pressures follow the change of the tractions, N^T dtau by the
fields themselves (`take_gaps`), and the resulting change of the slips is left to the next iteration.

The bounds follow that response as well, which leaves a fraction mu N^T G^-1 of an error: once in an iteration, and
where this leaves more than a tenth of what the iteration before has left, in rounds of tractions and bounds with the
same matrices. They converge if friction has a unique solution, and cost little if no cell changes its state.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import (
    ContactFields,
    ContactGeometry,
    ContactSolve,
    PatchScratch,
    RollingScratch,
)
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells, FrictionSolve
from warpffrf_kernels.core.lanes import most
from warpffrf_kernels.core.model import PATCH, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, dot, real, sync
from warpffrf_kernels.core.scratch import ImpulsiveContact, Residuals, RetainedSystem
from warpffrf_kernels.core.state import ContactState
from warpffrf_kernels.friction.cell_blocks import COUNT, FRESH, borders_of, first_line, is_fresh
from warpffrf_kernels.friction.cell_compliance import scale_modes
from warpffrf_kernels.friction.cell_shares import add_on_shares
from warpffrf_kernels.friction.cells import cell_at, rubs_on_grid, rubs_on_patch
from warpffrf_kernels.friction.tangential_fields import second_high, second_low
from warpffrf_kernels.linear.block_elimination import add_lines, forward_lines, push_columns
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.normal.pair_elimination import COUNT as SLOTS
from warpffrf_kernels.normal.pair_elimination import LEFT_START, START, block_at
from warpffrf_kernels.normal.pressure_solve import solve_system
from warpffrf_kernels.surfaces.fields import clear_field
from warpffrf_kernels.surfaces.responses import own_load, place_in_table

wp.set_module_options(MODULE_OPTIONS)


ACTIVE = wp.constant(0)  # columns of `answer_state`: active slots for which Y was computed
RENEWED = wp.constant(1)  # 1 if Y is new in this iteration
OPEN = wp.constant(2)  # 1 while the bounds do not follow the pressures yet
ROUND = wp.constant(3)  # rounds of tractions and bounds in this iteration
FALL = wp.constant(wp.float64(0.1))  # of the last round of the iteration before: less change, and a round is the last
NEGLIGIBLE = wp.constant(wp.float64(1.0e-10))  # of the largest pressure: a tenth of the convergence tolerance of a step
ROUGH = wp.constant(wp.float64(1.0e-2))  # reduction of a system, without the coupling of pairs by local modes: the
# rest is left to the next iteration
ROUNDS = wp.constant(20)  # of an iteration: each leaves half of the change, for friction close to its limits


@wp.func
def node_of(model: Model, w: int, slot: int, slot_node: wp.array3d(dtype=int)) -> int:
    """The node of a slot, numbered over all pairs."""
    return slot_node[w, slot, 0] * model.window.grid_nodes + slot_node[w, slot, 1]


@wp.func
def answering(model: Model, pair: int, slots: int) -> int:
    """Lines of Y of a pair with `slots` active slots."""
    if rubs_on_patch(model, pair):
        return 0
    return slots


@wp.func
def is_new(model: Model, w: int, n: int, tangential: FrictionSolve, normal: ContactSolve) -> bool:
    """Whether there are new cells, or the active set is not the one for which Y was computed."""
    if n != tangential.answer_state[w, ACTIVE] or is_fresh(model, w, tangential.cell_block):
        return True
    a = int(0)
    while a < n and node_of(model, w, normal.order[w, a], normal.slot_node) == tangential.answer_node[w, a]:
        a += 1
    return a < n


@kernel
def open_answer(run: Run, normal: ContactSolve, tangential: FrictionSolve):
    """Per world, lanes over slots: whether Y is recomputed, for the active slots in the order of the last solution."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0:
        return
    n = normal.block[w, 0, LEFT_START]  # the preceding places are those of active slots
    # the pressures' G differs in every attempt, and with it Y and the gradients with respect to the bodies' motion
    renewed = run.ctl[w].iteration == 0 or is_new(model, w, n, tangential, normal)
    # so does the retained matrix with which the receptance of tractions is condensed, if it is inverted again
    renewed = renewed or run.ctl[w].refresh != 0
    sync()
    if lane == 0:
        tangential.answer_state[w, ACTIVE] = n
        tangential.answer_state[w, RENEWED] = int(renewed)
        tangential.answer_state[w, OPEN] = 1
        tangential.answer_state[w, ROUND] = 0
    a = lane
    while renewed and a < n:
        tangential.answer_node[w, a] = node_of(model, w, normal.order[w, a], normal.slot_node)
        a += wp.block_dim()


@wp.func
def couple_near(
    model: Model, w: int, pair: int, a: int, m: int, lane: int, tangential: FrictionSolve, cells: int,
    geometry: ContactGeometry, rubbing: FrictionCells,
):  # fmt: skip
    """Adds the part of the local modes to line `a` of Y: slips of the cells due to a unit pressure at node m, as in
    `tangential_fields.press_cells`."""
    B = model.pairs.second[pair]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    flexible = model.surfaces.shear_start[B] >= 0
    start = (w * model.pairs.count + pair) * 2 * model.window.nodes
    if flexible:
        rows_b = model.surfaces.rows[B]
        table_b = model.responses.pressed[own_load(model, 2 * pair + 1)]
        origin_b = geometry.center[w, pair, 1] - model.window.second_half
        low = second_low(model, w, pair, geometry.second_window)
        wide = 2 * (second_high(model, w, pair, geometry.second_window) - low + 1) * rows_b
        run = start + 2 * low * rows_b
        clear_field(lane, wide, run, rubbing.second_shift)
        e = int(0)
        while e < model.window.stencil_columns * model.window.stencil_rows:
            part = geometry.stencil[w, pair, m, e]
            if part != real(0.0):
                column = origin_b + geometry.stencil_at[w, pair, m, 0] + e / model.window.stencil_rows
                row = geometry.stencil_at[w, pair, m, 1] + e % model.window.stencil_rows
                at = place_in_table(model, table_b, column, row, origin_b + low)
                if at >= 0:
                    axpy(wide, -part, model.responses.number, at, rubbing.second_shift, run)
            e += 1
        sync()
    line = (w * model.capacity.slots + a) * 2 * model.capacity.cells
    origin = geometry.center[w, pair, 0] - model.window.half
    table = model.responses.pressed[own_load(model, 2 * pair)]
    at = place_in_table(model, table, origin + m / rows, m % rows, origin)
    i = lane
    while at >= 0 and i < 2 * cells:
        n = tangential.cell_slot[w, pair, i / 2]
        tangential.cell_Y[line + i] = (
            tangential.cell_Y[line + i]
            - rubbing.cell_area[w, pair, n] * model.responses.number[at + cell_at(rows, n, i % 2)]
        )
        i += wp.block_dim()
    sync()
    if flexible:
        add_on_shares(
            model, w, pair, cells, real(-1.0), tangential.cell_slot, rubbing.cell_area, rubbing.cell_turn,
            rubbing.share, rubbing.share_at, rubbing.second_shift, start, tangential.cell_Y, line,
        )  # fmt: skip


@kernel
def answer_by_modes(
    run: Run, normal: ContactSolve, tangential: FrictionSolve, residuals: Residuals, cell_JT: wp.array(dtype=real)
):
    """Per (world, pair): the part of the global modes in N^T, a line per active slot over the lines of the pair's
    cells."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    cells = tangential.cell_block[w, pair, COUNT]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or tangential.answer_state[w, RENEWED] == 0 or cells == 0:
        return
    lines = 2 * model.capacity.cells
    width = model.pairs.most_modes
    scaled = (w * model.pairs.count + pair) * 2 * width
    by_mode = (w * model.pairs.count + pair) * width * lines
    a = normal.block[w, pair, START]
    while a < normal.block[w, pair, START] + answering(model, pair, normal.block[w, pair, SLOTS]):
        slot = normal.order[w, a]
        line = (w * model.capacity.slots + a) * lines
        clear_field(lane, 2 * cells, line, tangential.cell_Y)
        modes = scale_modes(
            model, w, pair, lane, normal.J, (w * model.capacity.slots + slot) * width, residuals, tangential, scaled
        )
        add_lines(modes, 2 * cells, tangential.cell_scaled, scaled, cell_JT, by_mode, lines, tangential.cell_Y, line)
        a += 1


@kernel
def answer_on_grid(
    run: Run, geometry: ContactGeometry, normal: ContactSolve, tangential: FrictionSolve, rubbing: FrictionCells
):
    """Per (world, pair with cells on the grid): adds the part of the local modes to N^T."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    cells = tangential.cell_block[w, pair, COUNT]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or tangential.answer_state[w, RENEWED] == 0 or cells == 0:
        return
    if not rubs_on_grid(model, pair):
        return
    a = normal.block[w, pair, START]
    while a < normal.block[w, pair, START] + normal.block[w, pair, SLOTS]:
        couple_near(
            model, w, pair, a, normal.slot_node[w, normal.order[w, a], 1], lane, tangential, cells, geometry, rubbing
        )
        a += 1


@kernel
def reduce_answer(run: Run, normal: ContactSolve, tangential: FrictionSolve):
    """Per (world, pair): Y = U^-T N^T; reused while cells and the active set are unchanged."""
    w, pair, _lane = wp.tid()
    model = run.models[w]
    cells = tangential.cell_block[w, pair, COUNT]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or tangential.answer_state[w, RENEWED] == 0 or cells == 0:
        return
    start = normal.block[w, pair, START]
    lines = 2 * model.capacity.cells
    at = (w * model.capacity.slots + start) * lines
    n = answering(model, pair, normal.block[w, pair, SLOTS])
    forward_lines(
        normal.factor, block_at(model, w, start), model.capacity.slots, n, tangential.cell_Y, at, lines, 2 * cells
    )


# D = G - Y^T Y of a pair, `lines` lines; the upper triangle and its mirror, lanes over the columns.
@wp.func_native("""
    const int cap = 2 * model.capacity.cells, lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const size_t at = ((size_t)w * model.pairs.count + pair) * cap * cap;
    const double* y0 = Y.data + ((size_t)w * model.capacity.slots + start) * cap;
    double* D0 = D.data + at;
    for (int i = 0; i < lines; ++i) {
        double* __restrict x = D0 + (size_t)i * cap; int k = 0;
        const double* g = G.data + at + (size_t)i * cap;
        for (int j = i + lane; j < lines; j += lanes) x[j] = g[j];
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
        for (int j = i + 1 + lane; j < lines; j += lanes) D0[(size_t)j * cap + i] = D0[(size_t)i * cap + j];
    WP_TILE_SYNC();
""")
def subtract_answer(
    model: Model,
    w: int,
    pair: int,
    start: int,
    n: int,
    lines: int,
    Y: wp.array(dtype=real),
    G: wp.array(dtype=real),
    D: wp.array(dtype=real),
): ...


# L' = L - Y^T W over the coupled columns of a pair, `lines` lines. Lanes over the columns.
@wp.func_native("""
    const int cap = model.capacity.slots, width = model.pairs.coupled_capacity, stride = 2 * model.capacity.cells;
    const int count = model.pairs.coupled_count.data[pair], lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM;
    const size_t at = ((size_t)w * model.pairs.count + pair) * stride * width;
    const double* w0 = W.data + ((size_t)w * cap + start) * width;
    for (int i = 0; i < lines; ++i) {
        double* __restrict x = bordered.data + at + (size_t)i * width;
        const double* l = L.data + at + (size_t)i * width;
        const double* y = Y.data + ((size_t)w * cap + start) * stride + i;
        for (int c = lane; c < count; c += lanes) x[c] = l[c];
        int k = 0;
        for (; k + 3 < n; k += 4) {
            const double *a = w0 + (size_t)k * width, *b = a + width, *d = b + width, *e = d + width;
            const double* p = y + (size_t)k * stride;
            const double m0 = p[0], m1 = p[stride], m2 = p[2 * stride], m3 = p[3 * stride];
            for (int c = lane; c < count; c += lanes) x[c] -= m0 * a[c] + m1 * b[c] + m2 * d[c] + m3 * e[c];
        }
        for (; k < n; ++k) { const double* a = w0 + (size_t)k * width; const double m = y[(size_t)k * stride];
            for (int c = lane; c < count; c += lanes) x[c] -= m * a[c]; }
    }
    WP_TILE_SYNC();
""")
def border_lines(
    model: Model,
    w: int,
    pair: int,
    start: int,
    n: int,
    lines: int,
    L: wp.array(dtype=real),
    Y: wp.array(dtype=real),
    W: wp.array(dtype=real),
    bordered: wp.array(dtype=real),
): ...


@kernel
def condense_answer(run: Run, normal: ContactSolve, tangential: FrictionSolve):
    """Per (world, pair): D and L', if Y is new."""
    w, pair, _lane = wp.tid()
    model = run.models[w]
    lines = 2 * tangential.cell_block[w, pair, COUNT]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or tangential.answer_state[w, RENEWED] == 0 or lines == 0:
        return
    start = normal.block[w, pair, START]
    n = answering(model, pair, normal.block[w, pair, SLOTS])
    fresh = tangential.cell_block[w, pair, FRESH] < tangential.cell_block[w, pair, COUNT]
    if model.elements[0].rolling.strips == 0 and (n > 0 or fresh):  # else D is G
        subtract_answer(model, w, pair, start, n, lines, tangential.cell_Y, tangential.cell_G, tangential.cell_D)
    border_lines(
        model, w, pair, start, n, lines, tangential.cell_L, tangential.cell_Y, normal.W, tangential.cell_bordered
    )


# step = -Y dtau of the n lines of a pair from `start` on. Lanes over the lines.
@wp.func_native("""
    const int cap = model.capacity.slots, stride = 2 * model.capacity.cells;
    const double* t = change.data + ((size_t)w * model.pairs.count + pair) * stride;
    double* x = step.data + (size_t)w * cap + start;
    WP_TILE_SYNC();
    for (int i = WP_TILE_THREAD_IDX; i < n; i += WP_TILE_BLOCK_DIM) {
        const double* y = Y.data + ((size_t)w * cap + start + i) * stride;
        double s[8] = {0.0}, sum = 0.0; int j = 0;
        for (; j + 7 < used; j += 8) for (int c = 0; c < 8; ++c) s[c] += y[j + c] * t[j + c];
        for (; j < used; ++j) sum += y[j] * t[j];
        for (int c = 0; c < 8; ++c) sum += s[c];
        x[i] = -sum;
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
    Y: wp.array(dtype=real),
    change: wp.array(dtype=real),
    step: wp.array(dtype=real),
): ...


@wp.func
def take_gaps(
    model: Model, w: int, pair: int, lane: int, start: int, n: int, cells: int, normal: ContactSolve,
    rolling: RollingScratch, tangential: FrictionSolve, residuals: Residuals,
):  # fmt: skip
    """answer_right = -N^T dtau of the n active slots of a pair on contact-fixed cells: by far fields and half-spaces
    `gap_change`, and by the condensed modes."""
    width = model.pairs.most_modes
    scaled = (w * model.pairs.count + pair) * 2 * width
    m = lane
    while m < width:
        value = real(0.0)
        line = first_line(model, w, pair)
        while line < first_line(model, w, pair) + 2 * cells:
            value += tangential.cell_J[line * width + m] * tangential.answer_moved[line]
            line += 1
        tangential.cell_scaled[scaled + width + m] = value
        m += wp.block_dim()
    sync()
    modes = scale_modes(model, w, pair, lane, tangential.cell_scaled, scaled + width, residuals, tangential, scaled)
    a = lane
    while a < n:
        slot = normal.order[w, start + a]
        value = rolling.gap_change[
            (w * model.pairs.count + pair) * model.window.grid_nodes + normal.slot_node[w, slot, 1]
        ]
        value += dot(modes, tangential.cell_scaled, scaled, normal.J, (w * model.capacity.slots + slot) * width)
        tangential.answer_right[w * model.capacity.slots + start + a] = -value
        a += wp.block_dim()
    sync()


# y = U^T x of n numbers. Lanes over the numbers.
@wp.func_native("""
    for (int j = WP_TILE_THREAD_IDX; j < n; j += WP_TILE_BLOCK_DIM) {
        double sum = 0.0;
        for (int i = 0; i <= j; ++i) sum += U.data[at + (size_t)i * stride + j] * x.data[at_x + i];
        y.data[at_x + j] = sum;
    }
    WP_TILE_SYNC();
""")
def times_transposed(
    U: wp.array(dtype=real), at: int, stride: int, n: int, x: wp.array(dtype=real), at_x: int, y: wp.array(dtype=real)
): ...


@kernel
def pose_answer(
    run: Run, normal: ContactSolve, tangential: FrictionSolve, rolling: RollingScratch, residuals: Residuals
):
    """Per world: right-hand sides of the response to the tractions of this round, -N^T dtau of the gaps and
    L_t^T dtau of the retained coordinates."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or tangential.answer_state[w, OPEN] == 0:
        return
    slots = w * model.capacity.slots
    i = lane
    while i < model.retained.count:
        tangential.answer_rhs[w * model.retained.count + i] = real(0.0)
        i += wp.block_dim()
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        at = first_line(model, w, pair)
        cells = tangential.cell_block[w, pair, COUNT]
        line = at + lane
        while line < at + 2 * cells:
            tangential.answer_moved[line] = tangential.cell_tau[line] - tangential.cell_base[line]
            line += wp.block_dim()
        sync()
        push_columns(
            model, w, pair, 2 * cells, tangential.cell_L, borders_of(model, w, pair), tangential.answer_moved, at,
            tangential.answer_rhs,
        )  # fmt: skip
        start = normal.block[w, pair, START]
        n = normal.block[w, pair, SLOTS]
        if rubs_on_patch(model, pair):
            take_gaps(model, w, pair, lane, start, n, cells, normal, rolling, tangential, residuals)
        elif model.pairs.family[pair] != PATCH:
            answer_to(
                model, w, pair, start, n, 2 * cells, tangential.cell_Y, tangential.answer_moved,
                tangential.answer_step,
            )  # fmt: skip
            times_transposed(
                normal.factor, block_at(model, w, start), model.capacity.slots, n, tangential.answer_step,
                slots + start, tangential.answer_right,
            )  # fmt: skip
        else:
            a = lane
            while a < n:
                tangential.answer_right[slots + start + a] = real(0.0)
                a += wp.block_dim()
            sync()
        pair += 1


@kernel
def press_with_tractions(
    run: Run, normal: ContactSolve, tangential: FrictionSolve, impulses: ImpulsiveContact, fields: ContactFields,
    geometry: ContactGeometry, patch: PatchScratch, system: RetainedSystem, contact: ContactState,
    patterns: wp.array(dtype=Pattern), solution: wp.array2d(dtype=real),
):  # fmt: skip
    """Per world: the pressures with their response to the tractions of this round, none below zero, and whether the
    bounds follow them in another round. change: the largest of the last round; answer_z: retained increments."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or tangential.answer_state[w, OPEN] == 0:
        return
    slots = w * model.capacity.slots
    solve_system(
        model, patterns[0], w, lane, 0, 0, 0, normal, patch, geometry, impulses, system, tangential.answer_right,
        tangential.answer_rhs, tangential.answer_step, tangential.answer_z, ROUGH,
    )  # fmt: skip
    sync()
    if lane != 0:
        return
    n = tangential.answer_state[w, ACTIVE]
    most = real(0.0)
    largest = real(0.0)
    a = int(0)
    while a < n:
        slot = normal.order[w, a]
        pair = normal.slot_node[w, slot, 0]
        m = normal.slot_node[w, slot, 1]
        value = wp.max(
            fields.base[w, pair, m] + (solution[w, a] + tangential.answer_step[slots + a]) / impulses.weight[w, pair],
            real(0.0),
        )
        most = wp.max(most, wp.abs(value - contact.pressure[w, pair, m]))
        largest = wp.max(largest, value)
        contact.pressure[w, pair, m] = value
        a += 1
    rounds = tangential.answer_state[w, ROUND] + 1
    tangential.answer_state[w, ROUND] = rounds
    settled = run.ctl[w].iteration == 0 or most <= NEGLIGIBLE * largest or most <= FALL * tangential.answer_change[w, 0]
    if settled or rounds == ROUNDS or run.ctl[w].failure != 0:
        tangential.answer_state[w, OPEN] = 0
        tangential.answer_change[w, 0] = most


@kernel
def count_rounds(run: Run, tangential: FrictionSolve):
    """Lanes over all worlds: whether the bounds of any world still follow its pressures."""
    one, lane = wp.tid()
    open_worlds = real(0.0)
    w = lane
    while w < run.ctl.shape[0]:
        if run.ctl[w].run != 0 and run.ctl[w].changes == 0:
            open_worlds = wp.max(open_worlds, real(tangential.answer_state[w, OPEN]))
        w += wp.block_dim()
    open_worlds = most(open_worlds)
    if lane == 0:
        run.rubbing[0] = int(open_worlds)
