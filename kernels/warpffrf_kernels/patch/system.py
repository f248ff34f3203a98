"""Rows of the local compliance G on the cells of patches, and how the modes open them.

    G_ij = near_ij + sum over sides of (A P)_i (S + Phi sigma^-1 Phi^T) (A P)_j^T + layer A_i delta_ij,

as `contact_compliance` and `contact_assembly` do for hats; Phi, the modes on the splines, times the weight of the pair.
What a cell displaces of the splines is read by all cells before it at once, place by place (`spline_tables`).

Residuals are never read off G (`fields`). Rows are made anew in every attempt, and when W has changed in one.
"""

import warp as wp

from warpffrf_kernels.core.access import changed, inout
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import PATCH, Elements, Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.patch.far_splines import beside_block, turned_column
from warpffrf_kernels.patch.fields import rows_of
from warpffrf_kernels.patch.spline_tables import line_of, real_side, trace_at

wp.set_module_options(MODULE_OPTIONS)


# Of one side, minus `weight` times the load of cell `m` on the modes, to J from `line` on; and what a unit pressure on
# it displaces of the splines, by S and by the condensed modes, to `far_response`. Native for contiguous inner loops, as
# `lay_row`.
@wp.func_native("""
    const int B = WP_TILE_BLOCK_DIM > 1 ? 1 : 8, nodes = elements.patches.far_nodes;
    const int rows = model.surfaces.rows.data[s], taps = rows < 3 ? rows : 3;
    const int modes = model.surfaces.modal_count.data[s];
    const size_t p = ((size_t)w * model.pairs.count + pair) * 2 + side, at = p * model.window.hats + m;
    const int used = (far_window.data[2 * p + 1] * rows + 7) / 8 * 8;
    const int first = (far_at.data[2 * at] - far_window.data[2 * p]) * rows + far_at.data[2 * at + 1];
    const double* const q = far_weight.data + 9 * at;
    const double* const table = far_table.data + p * nodes * nodes + (size_t)first * nodes;
    const double* const trace = far_trace.data + trace_start;
    const double* const s0 = receptance.data + (size_t)w * model.modes.count + model.surfaces.modal_start.data[s];
    double* const u = far_response.data + (size_t)(2 * w + side) * nodes;
    double* const j = J.data + line;
    for (int k = WP_TILE_THREAD_IDX; k < modes; k += WP_TILE_BLOCK_DIM) {
        const double* const t = trace + (size_t)k * nodes + first;
        double sum = 0.0;
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < taps; ++b) sum += q[3 * a + b] * t[a * rows + b];
        j[k] = -weight * sum;
    }
    WP_TILE_SYNC();
    for (int e = B * WP_TILE_THREAD_IDX; e < used; e += B * WP_TILE_BLOCK_DIM) {
        double sum[8] = {0.0};
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < taps; ++b) {
                const double* const t = table + (size_t)(a * rows + b) * nodes + e;
                for (int i = 0; i < B; ++i) sum[i] += q[3 * a + b] * t[i];
            }
        for (int k = 0; k < modes; ++k) {
            const double f = weight * s0[k] * j[k];
            const double* const t = trace + (size_t)k * nodes + e;
            for (int i = 0; i < B; ++i) sum[i] -= f * t[i];
        }
        for (int i = 0; i < B; ++i) u[e + i] = sum[i];
    }
    WP_TILE_SYNC();
""")
def respond_cell(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    side: int,
    m: int,
    s: int,
    weight: real,
    line: int,
    trace_start: int,
    far_at: wp.array4d(dtype=int),
    far_weight: wp.array4d(dtype=real),
    far_window: wp.array4d(dtype=int),
    far_table: wp.array(dtype=real),
    far_trace: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    far_response: wp.array(dtype=real),
    J: wp.array(dtype=real),
): ...


# Row `slot` of G, of cell `m`, against the slots of its pair up to itself: laid out over the places of all strips that
# these have cells in, then picked.
@wp.func_native("""
    const int B = WP_TILE_BLOCK_DIM > 1 ? 1 : 8, line = (rows + 7) / 8 * 8, column = m / rows, row = m % rows;
    const int stride = elements.patches.places, nodes = elements.patches.far_nodes, cap = model.capacity.slots;
    const size_t p = ((size_t)w * model.pairs.count + pair) * 2;
    const int* const slots = slot_hat.data + (size_t)w * cap * 2;
    const int* const place = slot_place.data + (size_t)w * cap;
    const double* const near = patch_near.data + p / 2 * patch_near.shape[2] + (size_t)row * line;
    double* const g = far_line.data + (size_t)w * stride;
    double* const out = G.data + ((size_t)w * cap + slot) * cap;
    int last = 0;
    for (int j = 0; j <= slot; ++j) if (slots[2 * j] == pair && place[j] > last) last = place[j];
    for (int e = B * WP_TILE_THREAD_IDX; e <= last; e += B * WP_TILE_BLOCK_DIM) {
        const int c = e / line;
        const double* const t = near + (size_t)(c < column ? column - c : c - column) * rows * line + e % line;
        double sum[8] = {0.0};
        for (int i = 0; i < B; ++i) sum[i] = t[i];
        for (int side = 0; side < 2; ++side) {
            const int lines = side ? second_rows : first_rows;
            const int* const strip = far_strip.data + 2 * ((p + side) * model.window.columns + c);
            const double* const u = far_response.data + (size_t)(2 * w + side) * nodes;
            const double* const share = far_share.data + (p + side) * nodes * stride + e;
            for (int n = lines ? strip[0] * lines : 0; n < (lines ? strip[0] + strip[1] : 0) * lines; ++n)
                for (int i = 0; i < B; ++i) sum[i] += u[n] * share[(size_t)n * stride + i];
        }
        for (int i = 0; i < B; ++i) g[e + i] = sum[i];
    }
    WP_TILE_SYNC();
    for (int j = WP_TILE_THREAD_IDX; j <= slot; j += WP_TILE_BLOCK_DIM)
        if (slots[2 * j] == pair) out[j] = g[place[j]] + (j == slot ? yielded : 0.0);
    WP_TILE_SYNC();
""")
def lay_row(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    slot: int,
    m: int,
    rows: int,
    first_rows: int,
    second_rows: int,
    yielded: real,
    slot_hat: wp.array3d(dtype=int),
    slot_place: wp.array2d(dtype=int),
    patch_near: wp.array3d(dtype=real),
    far_strip: wp.array4d(dtype=int),
    far_share: wp.array(dtype=real),
    far_response: wp.array(dtype=real),
    far_line: wp.array2d(dtype=real),
    G: wp.array3d(dtype=real),
): ...


# The mirror of rows `fresh` to `slots` of G within patches, eight at a time, as columns are far apart. Lanes over the
# columns of these rows.
@wp.func_native("""
    const int cap = model.capacity.slots;
    const int* const pair = slot_hat.data + (size_t)w * cap * 2;
    const int* const family = model.pairs.family.data;
    double* const g = G.data + (size_t)w * cap * cap;
    for (int s = fresh; s < slots; s += 8) {
        const int end = s + 8 < slots ? s + 8 : slots;
        for (int j = WP_TILE_THREAD_IDX; j < end - 1; j += WP_TILE_BLOCK_DIM) {
            if (family[pair[2 * j]] != patch) continue;
            for (int i = j < s ? s : j + 1; i < end; ++i)
                if (pair[2 * i] == pair[2 * j]) g[(size_t)j * cap + i] = g[(size_t)i * cap + j];
        }
    }
""")
def mirror_within(
    model: Model, w: int, fresh: int, slots: int, patch: int, slot_hat: wp.array3d(dtype=int), G: wp.array3d(dtype=real)
): ...


@wp.kernel
def assemble_cells(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    slot_hat: wp.array3d(dtype=int),
    area: wp.array3d(dtype=real),
    patch_near: wp.array3d(dtype=real),
    far_at: wp.array4d(dtype=int),
    far_weight: wp.array4d(dtype=real),
    far_window: wp.array4d(dtype=int),
    far_strip: wp.array4d(dtype=int),
    far_share: wp.array(dtype=real),
    far_table: wp.array(dtype=real),
    far_trace: wp.array(dtype=real),
    weight: wp.array2d(dtype=real),
    receptance: wp.array2d(dtype=real),
    slot_place: inout(wp.array2d(dtype=int)),
    far_response: inout(wp.array(dtype=real)),
    far_line: inout(wp.array2d(dtype=real)),
    J: inout(wp.array(dtype=real)),
    G: inout(wp.array3d(dtype=real)),
):
    """Per world: of the fresh slots of patches the gradient of the weak gap by the modes of A, then of B, times the
    weight of the pair; and rows of G within their pairs."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0:
        return
    elements = model.elements[0]
    slot = ctl[w].fresh + lane
    while slot < ctl[w].slots:
        pair = slot_hat[w, slot, 0]
        if model.pairs.family[pair] == PATCH:
            rows = model.surfaces.rows[model.pairs.first[pair]]
            m = slot_hat[w, slot, 1]
            slot_place[w, slot] = m / rows * line_of(rows) + m % rows
        slot += wp.block_dim()
    sync()
    slot = ctl[w].fresh
    while slot < ctl[w].slots:
        pair = slot_hat[w, slot, 0]
        m = slot_hat[w, slot, 1]
        if model.pairs.family[pair] == PATCH:
            line = (w * model.capacity.slots + slot) * model.pairs.most_modes
            i = lane
            while i < model.pairs.most_modes:
                J[line + i] = real(0.0)
                i += wp.block_dim()
            sync()
            for side in range(2):
                s = real_side(elements, pair, side)
                if s >= 0:
                    respond_cell(
                        model, elements, w, pair, side, m, s, weight[w, pair], line,
                        trace_at(model, elements, w, pair, side), far_at, far_weight, far_window, far_table, far_trace,
                        receptance, far_response, J,
                    )  # fmt: skip
                line += model.surfaces.modal_count[model.pairs.first[pair]]
            lay_row(
                model, elements, w, pair, slot, m, model.surfaces.rows[model.pairs.first[pair]],
                rows_of(model, elements, pair, 0), rows_of(model, elements, pair, 1),
                elements.patches.layer[pair] * area[w, pair, m], slot_hat, slot_place, patch_near, far_strip,
                far_share, far_response, far_line, G,
            )  # fmt: skip
        slot += 1
    mirror_within(model, w, ctl[w].fresh, ctl[w].slots, PATCH, slot_hat, G)


@wp.kernel
def assemble_patches_beside(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    slot_hat: wp.array3d(dtype=int),
    far_at: wp.array4d(dtype=int),
    far_weight: wp.array4d(dtype=real),
    far_window: wp.array4d(dtype=int),
    weight: wp.array2d(dtype=real),
    far_beside: inout(wp.array(dtype=real)),
    G: changed(wp.array3d(dtype=real)),
):
    """Per world, lanes over splines, then slots: what cells of one patch add to the gaps of cells of another one on the
    same body, by its local modes."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0:
        return
    elements = model.elements[0]
    base = w * elements.patches.far_nodes
    slot = ctl[w].fresh
    while slot < ctl[w].slots:
        pair = slot_hat[w, slot, 0]
        m = slot_hat[w, slot, 1]
        for side in range(2):
            s = real_side(elements, pair, side)
            e = elements.patches.beside_start[2 * pair + side]
            while model.pairs.family[pair] == PATCH and e < elements.patches.beside_start[2 * pair + side + 1]:
                other = elements.patches.beside_side[e] / 2
                there = elements.patches.beside_side[e] % 2
                r = real_side(elements, other, there)
                rows = model.surfaces.rows[s]
                lines = model.surfaces.rows[r]
                table = elements.patches.beside_table[e]
                stride = elements.patches.table_source[table] * lines
                at = side * model.window.hats + m
                ratio = wp.min(weight[w, pair], weight[w, other]) / wp.max(weight[w, pair], weight[w, other])
                n = lane
                while n < far_window[w, other, there, 1] * lines:
                    source = turned_column(model, r, far_window[w, other, there, 0] + n / lines)
                    value = real(0.0)
                    for i in range(3):
                        target = turned_column(model, s, far_at[w, pair, at, 0] + i)
                        if source >= 0 and target >= 0:
                            block = beside_block(model, elements, table, rows, lines, target, source) + n % lines
                            j = int(0)
                            while j < wp.min(rows, 3):
                                line = block + (far_at[w, pair, at, 1] + j) * stride
                                value += far_weight[w, pair, at, 3 * i + j] * elements.patches.beside[line]
                                j += 1
                    far_beside[base + n] = value
                    n += wp.block_dim()
                sync()
                q = lane
                while q < slot:
                    if slot_hat[w, q, 0] == other:
                        seen = there * model.window.hats + slot_hat[w, q, 1]
                        first = (far_at[w, other, seen, 0] - far_window[w, other, there, 0]) * lines
                        first += base + far_at[w, other, seen, 1]
                        value = real(0.0)
                        for i in range(3):
                            j = int(0)
                            while j < wp.min(lines, 3):
                                value += far_weight[w, other, seen, 3 * i + j] * far_beside[first + i * lines + j]
                                j += 1
                        value = ratio * value
                        G[w, slot, q] = G[w, slot, q] + value
                        G[w, q, slot] = G[w, q, slot] + value
                    q += wp.block_dim()
                sync()
                e += 1
        slot += 1
