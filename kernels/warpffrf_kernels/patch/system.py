"""Rows of the local compliance G on the cells of patches, and how the modes open them.

    G_ij = near_ij + sum over sides of (A P)_i S (A P)_j^T + layer A_i delta_ij + J_i sigma^-1 J_j^T,

J_i = -(A P Phi)_i of both bodies; as `contact_compliance` and `contact_assembly` do for hats. The response S (A P)_j^T
of a cell on the splines under the patch is kept for the rows that follow.

Residuals are never read off G (`fields`), so that rows may be those of a patch that has moved a little since: they are
made anew when it has moved by `place.MOVED`, and when an iteration has not settled.
"""

import warp as wp

from warpffrf_kernels.core.access import changed, inout, out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import PATCH, Elements, Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.patch.far_splines import beside_block, turned_column
from warpffrf_kernels.patch.fields import real_side

wp.set_module_options(MODULE_OPTIONS)


# What a unit pressure on cell `m` displaces of the splines under one side of the patch, `columns` of them from `first`
# on, into `far_response` from `start` on; and minus `weight` times its load on the modes, added to J from `line` on.
# Native for contiguous inner loops over rows and modes. S is symmetric: the lines of the loaded splines are read.
@wp.func_native("""
    const size_t p0 = (size_t)w * model.pairs.count + pair;
    const size_t at = p0 * 2 * model.window.hats + (size_t)side * model.window.hats + m;
    const double* const q = far_weight.data + at * 9;
    const int rows = model.surfaces.rows.data[s], turn = model.surfaces.turn.data[s];
    const int all = model.surfaces.columns.data[s], modes = model.surfaces.modal_count.data[s];
    const int block = elements.patches.far_columns.data[f], sectors = elements.patches.far_sectors.data[f];
    const int lines = block * rows, taps = rows < 3 ? rows : 3, row = far_at.data[2 * at + 1];
    const double* const S = elements.patches.far.data + elements.patches.far_start.data[f];
    const double* const phi = elements.patches.mode.data + elements.patches.mode_start.data[f];
    double* const u = far_response.data + start;
    double* const j = J.data + line;
    for (int n = WP_TILE_THREAD_IDX; n < columns * rows; n += WP_TILE_BLOCK_DIM) u[n] = 0.0;
    WP_TILE_SYNC();
    for (int a = 0; a < 3; ++a) {
        int source = far_at.data[2 * at] + a;
        if (turn > 0) source = ((source % turn) + turn) % turn;
        if (source < 0 || source >= all) continue;
        const double* const value = q + 3 * a;
        for (int b = 0; b < taps; ++b) {
            const double load = weight * value[b];
            const double* const line_of = phi + (size_t)(source * rows + row + b) * modes;
            for (int n = WP_TILE_THREAD_IDX; n < modes; n += WP_TILE_BLOCK_DIM) j[n] -= load * line_of[n];
        }
        for (int c = 0; c < columns; ++c) {
            int target = first + c;
            if (turn > 0) target = ((target % turn) + turn) % turn;
            if (target < 0 || target >= all) continue;
            const int lag = (source / block - target / block + sectors) % sectors;
            const double* const line_of =
                S + ((size_t)lag * lines + (source % block) * rows + row) * lines + (target % block) * rows;
            double* const v = u + c * rows;
            if (taps == 3) {
                for (int n = WP_TILE_THREAD_IDX; n < rows; n += WP_TILE_BLOCK_DIM)
                    v[n] += value[0] * line_of[n] + value[1] * line_of[lines + n] + value[2] * line_of[2 * lines + n];
            } else {
                for (int n = WP_TILE_THREAD_IDX; n < rows; n += WP_TILE_BLOCK_DIM)
                    v[n] += value[0] * line_of[n] + value[1] * line_of[lines + n];
            }
        }
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
    f: int,
    first: int,
    columns: int,
    weight: real,
    start: int,
    line: int,
    far_at: wp.array4d(dtype=int),
    far_weight: wp.array4d(dtype=real),
    far_response: wp.array(dtype=real),
    J: wp.array(dtype=real),
): ...


@wp.kernel
def respond_cells(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    slot_hat: wp.array3d(dtype=int),
    far_at: wp.array4d(dtype=int),
    far_weight: wp.array4d(dtype=real),
    far_window: wp.array4d(dtype=int),
    weight: wp.array2d(dtype=real),
    far_response: inout(wp.array(dtype=real)),
    J: inout(wp.array(dtype=real)),
):
    """Per world: of the fresh slots of patches the displacement of the splines under a unit pressure, side by side, and
    the gradient of the weak gap by the modes of A, then of B, times the weight of the pair."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0:
        return
    elements = model.elements[0]
    slot = ctl[w].fresh
    while slot < ctl[w].slots:
        pair = slot_hat[w, slot, 0]
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
                    start = ((w * model.capacity.slots + slot) * 2 + side) * elements.patches.far_nodes
                    respond_cell(
                        model, elements, w, pair, side, slot_hat[w, slot, 1], s, elements.patches.far_of[s],
                        far_window[w, pair, side, 0], far_window[w, pair, side, 1], weight[w, pair], start, line,
                        far_at, far_weight, far_response, J,
                    )  # fmt: skip
                line += model.surfaces.modal_count[model.pairs.first[pair]]
        slot += 1


# Row `slot` of G against the slots of its pair up to itself, and its mirror, lanes over columns. Native like
# `contact_assembly.couple`.
@wp.func_native("""
    const size_t p0 = (size_t)w * model.pairs.count + pair;
    const int cap = model.capacity.slots, width = model.pairs.most_modes, hats = model.window.hats;
    const int* const slots = slot_hat.data + (size_t)w * cap * 2;
    const int m = slots[2 * slot + 1], column = m / rows, row = m % rows;
    const double* const near = patch_near.data + p0 * numbers + (size_t)row * rows;
    const double* const own = J.data + ((size_t)w * cap + slot) * width;
    const double* const s = receptance.data + (size_t)w * model.modes.count;
    const double* const u = far_response.data + ((size_t)w * cap + slot) * 2 * nodes;
    for (int j = WP_TILE_THREAD_IDX; j <= slot; j += WP_TILE_BLOCK_DIM) {
        if (slots[2 * j] != pair) continue;
        const int other = slots[2 * j + 1], c = other / rows, d = c < column ? column - c : c - column;
        double g = near[(size_t)d * rows * rows + other - c * rows];
        if (other == m) g += yielded;
        for (int side = 0; side < 2; ++side) {
            const int lines = side ? second_rows : first_rows;
            if (lines == 0) continue;
            const size_t at = p0 * 2 * hats + (size_t)side * hats + other;
            const int first = far_window.data[(p0 * 2 + side) * 2];
            const int* const start = far_at.data + 2 * at;
            const double* v = u + (size_t)side * nodes + (start[0] - first) * lines + start[1];
            const double* q = far_weight.data + at * 9;
            if (lines > 2) {
                for (int a = 0; a < 3; ++a, q += 3, v += lines) g += q[0] * v[0] + q[1] * v[1] + q[2] * v[2];
            } else {
                for (int a = 0; a < 3; ++a, q += 3, v += lines) g += q[0] * v[0] + q[1] * v[1];
            }
        }
        const double* const there = J.data + ((size_t)w * cap + j) * width;
        double even = 0.0, odd = 0.0; int n = 0;
        for (; n + 1 < modes_a; n += 2) {
            even += own[n] * s[first_a + n] * there[n]; odd += own[n + 1] * s[first_a + n + 1] * there[n + 1];
        }
        if (n < modes_a) even += own[n] * s[first_a + n] * there[n];
        for (n = 0; n + 1 < modes_b; n += 2) {
            even += own[modes_a + n] * s[first_b + n] * there[modes_a + n];
            odd += own[modes_a + n + 1] * s[first_b + n + 1] * there[modes_a + n + 1];
        }
        if (n < modes_b) even += own[modes_a + n] * s[first_b + n] * there[modes_a + n];
        g += even + odd;
        G.data[((size_t)w * cap + slot) * cap + j] = g; G.data[((size_t)w * cap + j) * cap + slot] = g;
    }
""")
def couple_cells(
    model: Model,
    w: int,
    pair: int,
    slot: int,
    rows: int,
    first_rows: int,
    second_rows: int,
    nodes: int,
    numbers: int,
    modes_a: int,
    modes_b: int,
    first_a: int,
    first_b: int,
    yielded: real,
    slot_hat: wp.array3d(dtype=int),
    patch_near: wp.array3d(dtype=real),
    far_at: wp.array4d(dtype=int),
    far_weight: wp.array4d(dtype=real),
    far_window: wp.array4d(dtype=int),
    far_response: wp.array(dtype=real),
    J: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    G: wp.array3d(dtype=real),
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
    far_response: wp.array(dtype=real),
    J: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    G: out(wp.array3d(dtype=real)),
):
    """Per world: rows of G of the fresh slots of patches, within their pairs."""
    w, _lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0:
        return
    elements = model.elements[0]
    slot = ctl[w].fresh
    while slot < ctl[w].slots:
        pair = slot_hat[w, slot, 0]
        if model.pairs.family[pair] == PATCH:
            P = model.pairs.first[pair]
            Q = model.pairs.second[pair]
            first_rows = int(0)
            second_rows = int(0)
            if real_side(elements, pair, 0) >= 0:
                first_rows = model.surfaces.rows[elements.patches.first[pair]]
            if real_side(elements, pair, 1) >= 0:
                second_rows = model.surfaces.rows[elements.patches.second[pair]]
            yielded = elements.patches.layer[pair] * area[w, pair, slot_hat[w, slot, 1]]
            couple_cells(
                model, w, pair, slot, model.surfaces.rows[P], first_rows, second_rows, elements.patches.far_nodes,
                patch_near.shape[2], model.surfaces.modal_count[P], model.surfaces.modal_count[Q],
                model.surfaces.modal_start[P], model.surfaces.modal_start[Q], yielded, slot_hat, patch_near, far_at,
                far_weight, far_window, far_response, J, receptance, G,
            )  # fmt: skip
        slot += 1


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
