"""Rows of the local compliance G on the cells of patches, and the opening of their gaps by the modes.

    G_ij = near_ij + sum over sides of (A P)_i (S + Phi sigma^-1 Phi^T) (A P)_j^T + layer A_i delta_ij,

as in `contact_compliance` and `contact_assembly` for nodes; Phi, the modes on the splines, times the weight of the
pair. The displacement of the splines due to a cell is read by all preceding cells at once, place by place
(`spline_tables`).

Residuals are never computed with G (`fields`). If rows are not kept from step to step (`compliance_reuse`), they are
computed anew in every attempt, and when W has changed within one; the opening by the modes is recomputed with the
retained matrix.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry, ContactSolve, PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import PATCH, Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.core.scratch import ImpulsiveContact
from warpffrf_kernels.normal.compliance_reuse import OLDER
from warpffrf_kernels.normal.lagged import lags
from warpffrf_kernels.patch.between import strip_width
from warpffrf_kernels.patch.far_splines import beside_block, turned_column
from warpffrf_kernels.patch.fields import rows_of
from warpffrf_kernels.patch.spline_tables import line_of, real_side, trace_at

wp.set_module_options(MODULE_OPTIONS)

WHOLE = wp.constant(1)  # of `far_answered`: displacement of the splines due to unit pressures, and load on the modes
LOADS = wp.constant(2)  # loads on the modes only


# Displacement of the splines of one side due to a unit pressure at each place, by S + Phi sigma^-1 Phi^T, line by line,
# unless only `loads` are requested, and the loads of all places on the modes. Strips that load the same columns of
# splines are treated together. Native for contiguous inner loops along places.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM, nodes = elements.patches.far_nodes;
    const int columns = elements.patches.columns.data[pair], stride = elements.patches.places;
    const int rows = model.surfaces.rows.data[s], modes = model.surfaces.modal_count.data[s];
    const size_t p = ((size_t)w * model.pairs.count + pair) * 2 + side;
    const int count = far_window.data[2 * p + 1] * rows;
    const int* const strip = far_strip.data + 2 * p * model.window.columns;
    const double* const table = far_table.data + p * nodes * nodes;
    const double* const trace = far_trace.data + trace_start;
    const double* const share = far_share.data + p * nodes * stride;
    const double* const own = receptance.data + (size_t)w * model.modes.count + model.surfaces.modal_start.data[s];
    double* const soft = far_soft.data + p * nodes;
    double* const answer = far_answer.data + p * nodes * stride;
    double* const gradient = far_gradient.data + (p / 2 * model.pairs.most_modes + first_mode) * stride;
    for (int n = loads ? count : 0; n < count + modes; ++n) {
        if (n < count) {
            for (int k = lane; k < count; k += lanes) soft[k] = table[(size_t)n * nodes + k];
            for (int m = 0; m < modes; ++m) {
                const double* const t = trace + (size_t)m * nodes;
                const double f = weight * weight * own[m] * t[n];
                for (int k = lane; k < count; k += lanes) soft[k] += f * t[k];
            }
        }
        WP_TILE_SYNC();
        const double* const f = n < count ? soft : trace + (size_t)(n - count) * nodes;
        double* const out = n < count ? answer + (size_t)n * stride : gradient + (size_t)(n - count) * stride;
        for (int c = 0, end = 1; c < columns; c = end) {
            const int* const here = strip + 2 * c;
            for (end = c + 1; end < columns && strip[2 * end] == here[0] && strip[2 * end + 1] == here[1];) ++end;
            const int high = (here[0] + here[1]) * rows;
            for (int e = c * line + lane; e < end * line; e += lanes) out[e] = 0.0;
            int k = here[0] * rows;
            for (; k + 3 < high; k += 4) {
                const double f0 = f[k], f1 = f[k + 1], f2 = f[k + 2], f3 = f[k + 3];
                const double* const x = share + (size_t)k * stride;
                for (int e = c * line + lane; e < end * line; e += lanes)
                    out[e] += f0 * x[e] + f1 * x[stride + e] + f2 * x[2 * stride + e] + f3 * x[3 * stride + e];
            }
            for (; k < high; ++k)
                for (int e = c * line + lane; e < end * line; e += lanes)
                    out[e] += f[k] * share[(size_t)k * stride + e];
        }
        WP_TILE_SYNC();
    }
""")
def answer_side(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    side: int,
    s: int,
    line: int,
    weight: real,
    trace_start: int,
    first_mode: int,
    loads: int,
    far_window: wp.array4d(dtype=int),
    far_strip: wp.array4d(dtype=int),
    far_share: wp.array(dtype=real),
    far_table: wp.array(dtype=real),
    far_trace: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    far_soft: wp.array(dtype=real),
    far_answer: wp.array(dtype=real),
    far_gradient: wp.array(dtype=real),
): ...


@kernel
def answer_splines(run: Run, patch: PatchScratch, impulses: ImpulsiveContact, normal: ContactSolve):
    """Per (world, pair of family 2), if the splines have been recomputed: loads of unit pressures on the modes and, if
    slots are new, displacement of the splines of both sides."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or model.pairs.family[pair] != PATCH:
        return
    wanted = int(WHOLE)
    if normal.lasting[w, OLDER] != 0:
        if run.ctl[w].refresh == 0 or run.ctl[w].moved == 0:
            return
        wanted = int(LOADS)
    elif run.ctl[w].fresh == run.ctl[w].slots:
        return
    if patch.far_answered[w, pair] == WHOLE or patch.far_answered[w, pair] == wanted:
        return
    elements = model.elements[0]
    first_mode = int(0)
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            answer_side(
                model, elements, w, pair, side, s, line_of(model.surfaces.rows[model.pairs.first[pair]]),
                impulses.weight[w, pair], trace_at(model, elements, w, pair, side), first_mode, int(wanted == LOADS),
                patch.far_window, patch.far_strip, patch.far_share, patch.far_table, patch.far_trace,
                impulses.contact_receptance, patch.far_soft, patch.far_answer, patch.far_gradient,
            )  # fmt: skip
        first_mode += model.surfaces.modal_count[model.pairs.first[pair]]
    sync()
    if lane == 0:
        patch.far_answered[w, pair] = wanted


# Row `slot` of G, of the cell at place `at`, for the slots of its pair up to itself: computed over the places of all
# strips with cells among them, then gathered.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM, line = (rows + 7) / 8 * 8;
    const int column = at / line, row = at % line;
    const int stride = elements.patches.places, nodes = elements.patches.far_nodes, cap = model.capacity.slots;
    const size_t p = ((size_t)w * model.pairs.count + pair) * 2;
    const int* const slots = slot_node.data + (size_t)w * cap * 2;
    const int* const place = slot_place.data + (size_t)w * cap;
    const double* const near = patch_near.data + p / 2 * patch_near.shape[2] + (size_t)row * line;
    double* const g = far_line.data + (size_t)w * stride;
    double* const out = G.data + ((size_t)w * cap + slot) * cap;
    const int last = slot_reach.data[(size_t)w * cap + slot] / line + 1;
    for (int c = 0; c < last; ++c) {
        const double* const t = near + (size_t)(c < column ? column - c : c - column) * rows * line;
        for (int e = lane; e < line; e += lanes) g[c * line + e] = t[e];
    }
    WP_TILE_SYNC();
    for (int side = 0; side < 2; ++side) {
        const int lines = side ? second_rows : first_rows;
        const int* const strip = far_strip.data + 2 * (p + side) * model.window.columns;
        const double* const u = far_answer.data + (p + side) * nodes * stride + at;
        const double* const share = far_share.data + (p + side) * nodes * stride;
        for (int c = 0, end = 1; lines && c < last; c = end) {
            const int* const here = strip + 2 * c;
            for (end = c + 1; end < last && strip[2 * end] == here[0] && strip[2 * end + 1] == here[1];) ++end;
            const int high = (strip[2 * c] + strip[2 * c + 1]) * lines;
            int k = strip[2 * c] * lines;
            for (; k + 7 < high; k += 8) {
                const double* const f = u + (size_t)k * stride;
                const double* const x = share + (size_t)k * stride;
                const double* const y = x + 4 * stride;
                const double f0 = f[0], f1 = f[stride], f2 = f[2 * stride], f3 = f[3 * stride];
                const double f4 = f[4 * stride], f5 = f[5 * stride], f6 = f[6 * stride], f7 = f[7 * stride];
                for (int e = c * line + lane; e < end * line; e += lanes)
                    g[e] += ((f0 * x[e] + f1 * x[stride + e]) + (f2 * x[2 * stride + e] + f3 * x[3 * stride + e]))
                        + ((f4 * y[e] + f5 * y[stride + e]) + (f6 * y[2 * stride + e] + f7 * y[3 * stride + e]));
            }
            for (; k + 3 < high; k += 4) {
                const double* const f = u + (size_t)k * stride;
                const double* const x = share + (size_t)k * stride;
                const double f0 = f[0], f1 = f[stride], f2 = f[2 * stride], f3 = f[3 * stride];
                for (int e = c * line + lane; e < end * line; e += lanes)
                    g[e] += f0 * x[e] + f1 * x[stride + e] + f2 * x[2 * stride + e] + f3 * x[3 * stride + e];
            }
            for (; k < high; ++k)
                for (int e = c * line + lane; e < end * line; e += lanes)
                    g[e] += u[(size_t)k * stride] * share[(size_t)k * stride + e];
        }
        WP_TILE_SYNC();
    }
    for (int i = lane; i <= slot; i += lanes)
        if (slots[2 * i] == pair) out[i] = g[place[i]] + (i == slot ? yielded : 0.0);
    WP_TILE_SYNC();
""")
def lay_row(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    slot: int,
    at: int,
    rows: int,
    first_rows: int,
    second_rows: int,
    yielded: real,
    slot_node: wp.array3d(dtype=int),
    slot_place: wp.array2d(dtype=int),
    slot_reach: wp.array2d(dtype=int),
    patch_near: wp.array3d(dtype=real),
    far_strip: wp.array4d(dtype=int),
    far_share: wp.array(dtype=real),
    far_answer: wp.array(dtype=real),
    far_line: wp.array2d(dtype=real),
    G: wp.array3d(dtype=real),
): ...


# The line of J of a slot: minus `weight` times the loads of its cell, at place `at`, on the modes.
@wp.func_native("""
    const int modes = model.pairs.most_modes, stride = elements.patches.places;
    const size_t p = (size_t)w * model.pairs.count + pair;
    const double* const gradient = far_gradient.data + p * modes * stride + at;
    double* const j = J.data + ((size_t)w * model.capacity.slots + slot) * modes;
    for (int m = WP_TILE_THREAD_IDX; m < modes; m += WP_TILE_BLOCK_DIM) j[m] = -weight * gradient[(size_t)m * stride];
""")
def lay_line(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    slot: int,
    at: int,
    weight: real,
    far_gradient: wp.array(dtype=real),
    J: wp.array(dtype=real),
): ...


# The mirror of rows `fresh` to `slots` of G within patches, eight at a time, because columns are far apart in memory.
# Lanes over the columns of these rows.
@wp.func_native("""
    const int cap = model.capacity.slots;
    const int* const pair = slot_node.data + (size_t)w * cap * 2;
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
    model: Model,
    w: int,
    fresh: int,
    slots: int,
    patch: int,
    slot_node: wp.array3d(dtype=int),
    G: wp.array3d(dtype=real),
): ...


@kernel
def assemble_cells(
    run: Run, normal: ContactSolve, geometry: ContactGeometry, patch: PatchScratch, impulses: ImpulsiveContact
):
    """Per world, for slots of patches: the gradient of the weak gap with respect to the modes of A, then of B, times
    the weight of the pair, if they are new or of an earlier attempt; and new rows of G within their pairs."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    elements = model.elements[0]
    slot = run.ctl[w].fresh
    while slot < run.ctl[w].slots and lane == 0:
        pair = normal.slot_node[w, slot, 0]
        if model.pairs.family[pair] == PATCH:
            rows = model.surfaces.rows[model.pairs.first[pair]]
            m = normal.slot_node[w, slot, 1]
            place = m / rows * line_of(rows) + m % rows
            patch.slot_place[w, slot] = place
            other = slot - 1
            while other >= 0 and normal.slot_node[w, wp.max(other, 0), 0] != pair:
                other -= 1
            if other >= 0:
                place = wp.max(place, patch.slot_reach[w, other])
            patch.slot_reach[w, slot] = place
        slot += 1
    sync()
    slot = run.ctl[w].fresh
    while slot < run.ctl[w].slots:
        pair = normal.slot_node[w, slot, 0]
        if model.pairs.family[pair] == PATCH:
            lay_row(
                model, elements, w, pair, slot, patch.slot_place[w, slot], model.surfaces.rows[model.pairs.first[pair]],
                rows_of(model, elements, pair, 0), rows_of(model, elements, pair, 1),
                elements.patches.layer[pair] * geometry.area[w, pair, normal.slot_node[w, slot, 1]], normal.slot_node,
                patch.slot_place, patch.slot_reach, patch.patch_near, patch.far_strip, patch.far_share,
                patch.far_answer, patch.far_line, normal.G,
            )  # fmt: skip
        slot += 1
    slot = run.ctl[w].fresh
    if normal.lasting[w, OLDER] != 0 and run.ctl[w].refresh != 0 and run.ctl[w].moved != 0:
        slot = int(0)
    while slot < run.ctl[w].slots:
        pair = normal.slot_node[w, slot, 0]
        if model.pairs.family[pair] == PATCH:
            rows = model.surfaces.rows[model.pairs.first[pair]]
            m = normal.slot_node[w, slot, 1]
            lay_line(
                model, elements, w, pair, slot, m / rows * line_of(rows) + m % rows, impulses.weight[w, pair],
                patch.far_gradient, normal.J,
            )  # fmt: skip
        slot += 1
    mirror_within(model, w, run.ctl[w].fresh, run.ctl[w].slots, PATCH, normal.slot_node, normal.G)


@kernel
def assemble_patches_beside(run: Run, normal: ContactSolve, patch: PatchScratch, impulses: ImpulsiveContact):
    """Per world, lanes over splines, then slots: opening of the gaps of cells by cells of another patch on the same
    body, through its local modes and, on one surface, the half-space."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or lags(model, run.ctl, w):
        return
    elements = model.elements[0]
    base = w * elements.patches.far_nodes
    slot = run.ctl[w].fresh
    while slot < run.ctl[w].slots:
        pair = normal.slot_node[w, slot, 0]
        m = normal.slot_node[w, slot, 1]
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
                at = side * model.window.grid_nodes + m
                ratio = impulses.weight[w, pair] / impulses.weight[w, other]
                n = lane
                while n < patch.far_window[w, other, there, 1] * lines:
                    source = turned_column(model, r, patch.far_window[w, other, there, 0] + n / lines)
                    value = real(0.0)
                    for i in range(3):
                        target = turned_column(model, s, patch.far_at[w, pair, at, 0] + i)
                        if source >= 0 and target >= 0:
                            block = beside_block(model, elements, table, rows, lines, target, source) + n % lines
                            j = int(0)
                            while j < wp.min(rows, 3):
                                line = block + (patch.far_at[w, pair, at, 1] + j) * stride
                                value += patch.far_weight[w, pair, at, 3 * i + j] * elements.patches.beside[line]
                                j += 1
                    patch.far_beside[base + n] = value
                    n += wp.block_dim()
                sync()
                q = lane
                while q < slot:
                    if normal.slot_node[w, q, 0] == other:
                        seen = there * model.window.grid_nodes + normal.slot_node[w, q, 1]
                        first = (patch.far_at[w, other, seen, 0] - patch.far_window[w, other, there, 0]) * lines
                        first += base + patch.far_at[w, other, seen, 1]
                        value = real(0.0)
                        for i in range(3):
                            j = int(0)
                            while j < wp.min(lines, 3):
                                value += (
                                    patch.far_weight[w, other, seen, 3 * i + j]
                                    * patch.far_beside[first + i * lines + j]
                                )
                                j += 1
                        if elements.patches.beside_between[e] >= 0:
                            own = m % model.surfaces.rows[model.pairs.first[pair]]
                            its = model.surfaces.rows[model.pairs.first[other]]
                            strips = strip_width(elements, w, pair, patch.patch_place)
                            strips *= strip_width(elements, w, other, patch.patch_place)
                            value += strips * patch.patch_between[w, e, own * its + normal.slot_node[w, q, 1] % its]
                        normal.G[w, slot, q] = normal.G[w, slot, q] + value * ratio
                        normal.G[w, q, slot] = normal.G[w, q, slot] + value / ratio
                    q += wp.block_dim()
                sync()
                e += 1
        slot += 1
