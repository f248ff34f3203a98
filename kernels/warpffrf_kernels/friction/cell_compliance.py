r"""Compliance of the cells that may carry friction ("cell slots"), with everything else condensed into it.

In the weak slip S_k = area_k s_k and the tractions tau_l, two directions each, rows 2 i + d of slot i:

    G = area_k [D_tt^A]_kl area_l + (area Q o) D_tt^B (area Q o)^T + J sigma^-1 J^T,
    J_k = area_k [Phi_tA, -Q o Phi_tB]_k,      L = [dS/d(rigid), -J sigma^-1 C^T],

as `contact_compliance` does for the pressures: symmetric, and positive definite where the cells are no finer than the
mesh. G stays assembled until the grids move against each other; what the outer coordinates and the pressures answer
(`pressure_answer`) is put to it where cells or the active set of the pressures are new, after that set has settled: the
outer matrix changes by next to nothing within a step. Cells of different pairs feel each other through the outer
coordinates, and not through local modes, which the Newton iteration takes in.
"""

import warp as wp

from warpffrf_kernels.core.access import inout, out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, mat33, real, sync, vec3
from warpffrf_kernels.friction.cell_shares import line_of
from warpffrf_kernels.friction.cells import cell_at
from warpffrf_kernels.friction.pressure_answer import RENEWED
from warpffrf_kernels.normal.contact_compliance import outer_row, short_of
from warpffrf_kernels.surfaces.responses import own_load, place_in_table

wp.set_module_options(MODULE_OPTIONS)

ROUND_OFF = wp.constant(wp.float64(1.0e-14))  # of a cosine: tangents of parallel rollers are parallel up to this


@wp.kernel
def take_cells(
    models: wp.array(dtype=Model),
    bound: wp.array3d(dtype=real),
    ctl: inout(wp.array(dtype=Control)),
    cell_slot_of: inout(wp.array3d(dtype=int)),
    cell_slot: out(wp.array3d(dtype=int)),
):
    """Per world: a slot for each cell under pressure that has none; all are given back first when the grids have
    moved."""
    w = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    capacity = model.window.hats
    if ctl[w].stale != 0:
        ctl[w].cells = 0
        pair = int(0)
        while pair < model.pairs.count:
            m = int(0)
            while m < capacity:
                cell_slot_of[w, pair, m] = -1
                m += 1
            pair += 1
        ctl[w].stale = 0
    count = ctl[w].cells
    ctl[w].fresh_cells = count
    pair = int(0)
    while pair < model.pairs.count:
        if model.pairs.friction[pair] > real(0.0):
            m = int(0)
            while m < capacity:
                if bound[w, pair, m] > real(0.0) and cell_slot_of[w, pair, m] < 0:
                    if count < model.capacity.cells:
                        cell_slot_of[w, pair, m] = count
                        cell_slot[w, count, 0] = pair
                        cell_slot[w, count, 1] = m
                    count += 1
                m += 1
        pair += 1
    if count > ctl[w].fresh_cells:
        ctl[w].factored = 0  # the numbers of the slots are new
    if count > model.capacity.cells:
        ctl[w].failure = ctl[w].failure | short_of(model)
        ctl[w].spare = wp.max(ctl[w].spare, count)
        ctl[w].run = 0
        count = model.capacity.cells
    ctl[w].cells = count


@wp.kernel
def cell_modes(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    center: wp.array3d(dtype=int),
    cell_slot: wp.array3d(dtype=int),
    cell_area: wp.array3d(dtype=real),
    cell_turn: wp.array4d(dtype=real),
    share: wp.array4d(dtype=real),
    share_at: wp.array4d(dtype=int),
    weight: wp.array2d(dtype=real),
    cell_J: inout(wp.array(dtype=real)),
):
    """Per world: gradient J of the weak slip of the fresh slots by the global modes of A, then of B, times the weight
    of the pair."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    slot = ctl[w].fresh_cells
    while slot < ctl[w].cells:
        pair = cell_slot[w, slot, 0]
        m = cell_slot[w, slot, 1]
        A = model.pairs.first[pair]
        B = model.pairs.second[pair]
        rows = model.surfaces.rows[A]
        area = weight[w, pair] * cell_area[w, pair, m]
        modes_a = model.surfaces.modal_count[A]
        start = (w * model.capacity.cells + slot) * 2 * model.pairs.most_modes
        i = lane
        while i < 2 * model.pairs.most_modes:
            cell_J[start + i] = real(0.0)
            i += wp.block_dim()
        sync()
        for d in range(2):
            line = line_of(model, A, center[w, pair, 0] + m / rows - model.window.half, d * rows + m % rows)
            if line >= 0:
                at = model.surfaces.shear_start[A] + line * modes_a
                axpy(modes_a, area, model.surfaces.mode_tangent, at, cell_J, start + d * model.pairs.most_modes)
        if model.surfaces.shear_start[B] >= 0:
            rows_b = model.surfaces.rows[B]
            modes_b = model.surfaces.modal_count[B]
            base = center[w, pair, 1] - model.window.second_half + share_at[w, pair, m, 0]
            c = int(0)
            while c < model.window.share_columns:
                q = int(0)
                while q < model.window.share_rows:
                    part = -area * share[w, pair, m, c * model.window.share_rows + q]
                    if part != real(0.0):
                        for e in range(2):
                            line = line_of(model, B, base + c, e * rows_b + share_at[w, pair, m, 1] + q)
                            if line >= 0:
                                at = model.surfaces.shear_start[B] + line * modes_b
                                for d in range(2):
                                    axpy(
                                        modes_b, part * cell_turn[w, pair, m, 2 * d + e],
                                        model.surfaces.mode_tangent, at,
                                        cell_J, start + d * model.pairs.most_modes + modes_a,
                                    )  # fmt: skip
                    q += 1
                c += 1
        slot += 1


# Rows 2 slot, 2 slot + 1 of G against the slots up to itself, and their mirror. `shift` holds what the two tractions of
# the slot do to the second surface's cells. Native, since it is the inner loop of the assembly.
@wp.func_native("""
    const int cap = 2 * model.capacity.cells, width = model.pairs.most_modes;
    const int SC = model.window.share_columns, SR = model.window.share_rows;
    const int* own = cell_slot.data + ((size_t)w * model.capacity.cells + slot) * 2;
    const int pair = own[0], m = own[1];
    const int A = model.pairs.first.data[pair], B = model.pairs.second.data[pair];
    const int table = model.responses.tangential.data[model.responses.load_start.data[2 * pair]];
    const int rows = model.surfaces.rows.data[A], block = model.responses.source_block.data[table];
    const int reach = model.responses.reach.data[table], wide = model.responses.width.data[table];
    const int rows_b = model.surfaces.rows.data[B], flexible = model.surfaces.shear_start.data[B] >= 0;
    const double* DA = model.responses.number.data + model.responses.start.data[table];
    const double* T = shift.data + (size_t)w * 4 * model.window.nodes;
    const size_t cells = (size_t)(w * model.pairs.count + pair) * model.window.hats;
    const int first_a = model.surfaces.modal_start.data[A], count_a = model.surfaces.modal_count.data[A];
    const int first_b = model.surfaces.modal_start.data[B], count_b = model.surfaces.modal_count.data[B];
    const double* s = receptance.data + (size_t)w * model.modes.count;
    const double* J0 = cell_J.data + ((size_t)w * model.capacity.cells + slot) * 2 * width;
    double* scaled = scratch.data + (size_t)w * 2 * width;
    WP_TILE_SYNC();
    for (int n = WP_TILE_THREAD_IDX; n < count_a + count_b; n += WP_TILE_BLOCK_DIM) {
        const double r = s[n < count_a ? first_a + n : first_b + n - count_a];
        scaled[n] = J0[n] * r; scaled[width + n] = J0[width + n] * r;
    }
    WP_TILE_SYNC();
    const double area = cell_area.data[cells + m];
    const int column = origin + m / rows, row = m % rows;
    for (int j = WP_TILE_THREAD_IDX; j <= slot; j += WP_TILE_BLOCK_DIM) {
        const int* other = cell_slot.data + ((size_t)w * model.capacity.cells + j) * 2;
        double g[2][2] = {{0.0, 0.0}, {0.0, 0.0}};
        if (other[0] == pair) {
            const int mj = other[1], column_j = origin + mj / rows, row_j = mj % rows;
            const int part = ((column_j % block) + block) % block, target = column - (column_j - part) + reach;
            const double area_j = cell_area.data[cells + mj];
            for (int e = 0; e < 2; ++e) for (int d = 0; d < 2; ++d)
                g[d][e] = area * area_j * DA[(((size_t)part * 2 * rows + e * rows + row_j) * wide + target) * 2 * rows
                                             + d * rows + row];
            if (flexible) {
                const double* o = share.data + (cells + mj) * SC * SR;
                const int* at = share_at.data + (cells + mj) * 2;
                const double* turn = cell_turn.data + (cells + mj) * 4;
                for (int d = 0; d < 2; ++d) {
                    const double* t = T + (size_t)d * 2 * model.window.nodes;
                    double v0 = 0.0, v1 = 0.0;
                    for (int c = 0; c < SC; ++c) for (int q = 0; q < SR; ++q) {
                        const double f = o[c * SR + q];
                        if (f == 0.0) continue;
                        const int n = (at[0] + c) * 2 * rows_b + at[1] + q;
                        v0 += f * t[n]; v1 += f * t[n + rows_b];
                    }
                    g[d][0] += area_j * (turn[0] * v0 + turn[1] * v1);
                    g[d][1] += area_j * (turn[2] * v0 + turn[3] * v1);
                }
            }
            const double* Jj = cell_J.data + ((size_t)w * model.capacity.cells + j) * 2 * width;
            for (int d = 0; d < 2; ++d) for (int e = 0; e < 2; ++e) {
                const double *p = scaled + d * width, *q = Jj + e * width;
                double sum[8] = {0.0}; int n = 0; const int all = count_a + count_b;
                for (; n + 7 < all; n += 8) for (int c = 0; c < 8; ++c) sum[c] += p[n + c] * q[n + c];
                double f = 0.0; for (; n < all; ++n) f += p[n] * q[n];
                for (int c = 0; c < 8; ++c) f += sum[c];
                g[d][e] += f;
            }
        }
        double* base = G.data + (size_t)w * cap * cap;
        for (int d = 0; d < 2; ++d) for (int e = 0; e < 2; ++e) {
            base[(size_t)(2 * slot + d) * cap + 2 * j + e] = g[d][e];
            base[(size_t)(2 * j + e) * cap + 2 * slot + d] = g[d][e];
        }
    }
    WP_TILE_SYNC();
""")
def couple_cells(
    model: Model,
    w: int,
    slot: int,
    origin: int,
    cell_slot: wp.array3d(dtype=int),
    cell_area: wp.array3d(dtype=real),
    cell_turn: wp.array4d(dtype=real),
    share: wp.array4d(dtype=real),
    share_at: wp.array4d(dtype=int),
    cell_J: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    shift: wp.array(dtype=real),
    scratch: wp.array(dtype=real),
    G: wp.array3d(dtype=real),
): ...


@wp.func
def shift_second(
    model: Model,
    w: int,
    pair: int,
    m: int,
    lane: int,
    low: int,
    high: int,
    origin_b: int,
    cell_area: wp.array3d(dtype=real),
    cell_turn: wp.array4d(dtype=real),
    share: wp.array4d(dtype=real),
    share_at: wp.array4d(dtype=int),
    shift: wp.array(dtype=real),
):
    """Displacement of the second surface's cells, columns `low` to `high` of its window, under unit tractions on cell m
    in its two directions, (2, 2 node_capacity) flat: area D_tt^B (Q o)^T."""
    rows_b = model.surfaces.rows[model.pairs.second[pair]]
    table = model.responses.tangential[own_load(model, 2 * pair + 1)]
    base = w * 4 * model.window.nodes
    count = (high - low + 1) * 2 * rows_b
    i = lane
    while i < 4 * model.window.nodes:
        shift[base + i] = real(0.0)
        i += wp.block_dim()
    sync()
    c = int(0)
    while c < model.window.share_columns:
        q = int(0)
        while q < model.window.share_rows:
            part = cell_area[w, pair, m] * share[w, pair, m, c * model.window.share_rows + q]
            if part != real(0.0):
                for e in range(2):
                    line = e * rows_b + share_at[w, pair, m, 1] + q
                    at = place_in_table(model, table, origin_b + share_at[w, pair, m, 0] + c, line, origin_b + low)
                    if at >= 0:
                        for d in range(2):
                            turned = cell_turn[w, pair, m, 2 * d + e]
                            if wp.abs(turned) > ROUND_OFF:
                                start = base + d * 2 * model.window.nodes + low * 2 * rows_b
                                axpy(count, part * turned, model.responses.number, at, shift, start)
            q += 1
        c += 1
    sync()


@wp.kernel
def assemble_cells(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    center: wp.array3d(dtype=int),
    second_window: wp.array3d(dtype=int),
    cell_slot: wp.array3d(dtype=int),
    cell_area: wp.array3d(dtype=real),
    cell_turn: wp.array4d(dtype=real),
    share: wp.array4d(dtype=real),
    share_at: wp.array4d(dtype=int),
    cell_J: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    shift: inout(wp.array(dtype=real)),
    scratch: inout(wp.array(dtype=real)),
    G: out(wp.array3d(dtype=real)),
):
    """Per world: rows of the compliance of the fresh slots, without the outer coordinates."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    slot = ctl[w].fresh_cells
    while slot < ctl[w].cells:
        pair = cell_slot[w, slot, 0]
        if model.surfaces.shear_start[model.pairs.second[pair]] >= 0:
            # a cubic reaches beyond what the hats of the window do
            low = wp.max(second_window[w, pair, 0] - model.window.share_columns, 0)
            high = wp.min(second_window[w, pair, 1] + model.window.share_columns, model.window.second_columns - 1)
            origin_b = center[w, pair, 1] - model.window.second_half
            shift_second(
                model, w, pair, cell_slot[w, slot, 1], lane, low, high, origin_b, cell_area, cell_turn, share,
                share_at, shift,
            )  # fmt: skip
        couple_cells(
            model, w, slot, center[w, pair, 0] - model.window.half, cell_slot, cell_area, cell_turn, share, share_at,
            cell_J, receptance, shift, scratch, G,
        )  # fmt: skip
        slot += 1


@wp.kernel
def outer_cells(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    axes: wp.array2d(dtype=mat33),
    r1: wp.array2d(dtype=vec3),
    cell_wrench: wp.array4d(dtype=real),
    weight: wp.array2d(dtype=real),
    cell_slot: wp.array3d(dtype=int),
    cell_J: wp.array(dtype=real),
    C_receptance: wp.array(dtype=real),
    cell_L: out(wp.array3d(dtype=real)),
):
    """Per world: gradient L of the weak slip by the coupled outer columns times the weight of the pair, where there are
    fresh slots."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].changes != 0 or ctl[w].fresh_cells == ctl[w].cells:
        return
    slot = int(0)
    while slot < ctl[w].cells:
        pair = cell_slot[w, slot, 0]
        rows = model.surfaces.rows[model.pairs.first[pair]]
        for d in range(2):
            at = cell_at(rows, cell_slot[w, slot, 1], d)
            f = vec3(cell_wrench[w, pair, at, 0], cell_wrench[w, pair, at, 1], cell_wrench[w, pair, at, 2])
            t = vec3(cell_wrench[w, pair, at, 3], cell_wrench[w, pair, at, 4], cell_wrench[w, pair, at, 5])
            row = 2 * slot + d
            line = w * 2 * model.capacity.cells + row
            outer_row(
                model, w, pair, row, lane, f, t, axes, r1, weight, cell_J, line * model.pairs.most_modes, C_receptance,
                cell_L,
            )  # fmt: skip
        slot += 1


# K[i, first:last] = G[i, first:last] + V_i . L^T and the mirror, lanes over the columns; V_i is gathered once.
# Native for contiguous inner loops like `axpy`; not measured separately.
@wp.func_native("""
    const int cap = G.shape[1], slots = cell_slot.shape[1];
    const int N = model.outer.count, width = model.pairs.coupled_capacity;
    const double* v = V.data + ((size_t)w * cap + i) * N;
    double picked[512];
    int known = -1, count = 0;
    for (int j = first + WP_TILE_THREAD_IDX; j < last; j += WP_TILE_BLOCK_DIM) {
        const int pair = cell_slot.data[((size_t)w * slots + j / 2) * 2];
        if (pair != known) {
            const int* c = model.pairs.coupled.data + (size_t)pair * width;
            known = pair; count = model.pairs.coupled_count.data[pair];
            for (int q = 0; q < count; ++q) picked[q] = v[c[q]];
        }
        const double* l = L.data + ((size_t)w * cap + j) * width;
        double x0 = 0.0, x1 = 0.0, x2 = 0.0, x3 = 0.0; int q = 0;
        for (; q + 3 < count; q += 4) {
            x0 += picked[q] * l[q]; x1 += picked[q + 1] * l[q + 1];
            x2 += picked[q + 2] * l[q + 2]; x3 += picked[q + 3] * l[q + 3];
        }
        for (; q < count; ++q) x0 += picked[q] * l[q];
        const double g = G.data[((size_t)w * cap + i) * cap + j] + (x0 + x1) + (x2 + x3);
        K.data[((size_t)w * cap + i) * cap + j] = g; K.data[((size_t)w * cap + j) * cap + i] = g;
    }
""")
def add_outer(
    model: Model,
    w: int,
    i: int,
    first: int,
    last: int,
    cell_slot: wp.array3d(dtype=int),
    G: wp.array3d(dtype=real),
    L: wp.array3d(dtype=real),
    V: wp.array(dtype=real),
    K: wp.array3d(dtype=real),
): ...


@wp.kernel
def condense_cells(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    cell_slot: wp.array3d(dtype=int),
    G: wp.array3d(dtype=real),
    L: wp.array3d(dtype=real),
    V: wp.array(dtype=real),
    answer_state: wp.array2d(dtype=int),
    K: out(wp.array3d(dtype=real)),
):
    """Per world: G + L V over all slots, L and V with the pressures' answer, where that is new (`pressure_answer`)."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].changes != 0 or answer_state[w, RENEWED] == 0:
        return
    count = 2 * ctl[w].cells
    i = int(0)
    while i < count:
        add_outer(model, w, i, i, count, cell_slot, G, L, V, K)
        i += 1
