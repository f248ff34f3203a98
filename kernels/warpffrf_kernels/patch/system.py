r"""Matrix of the pressures of a small patch, whose elimination costs less than an iteration (`pressure_solve`).

    G_ij = near_ij + sum over sides of (A P)_i (S + Phi sigma^-1 Phi^T) (A P)_j^T + layer A_i delta_ij,

as in `contact_compliance` for nodes; Phi, the modes on the splines, times the weight of the pair. The displacement of
the splines due to a cell is read by all preceding cells at once, place by place (`spline_tables`). near, by distance in
strips and both rows, is the inverse transform of the blocks of `patch.strips`.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry, ContactSolve, PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import PATCH, Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.core.scratch import ImpulsiveContact
from warpffrf_kernels.kinematics.closest_point import has_cells
from warpffrf_kernels.patch.fields import rows_of
from warpffrf_kernels.patch.modal_rows import weigh_loads
from warpffrf_kernels.patch.spline_tables import line_of, real_side, trace_at
from warpffrf_kernels.patch.strips import spectrum_at

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def has_matrix(model: Model, pair: int) -> bool:
    """Whether a pair is a patch with a matrix."""
    return model.pairs.family[pair] == PATCH and model.pairs.matrix[pair] != 0


# near[d, r, r'] = sum_k weight_k cos(pi k d / columns) M_k, r' filled up. Lanes over the numbers of a distance.
@wp.func_native("""
    const int line = (rows + 7) / 8 * 8, size = rows * line;
    const double* const M = spectrum.data + start;
    double* const out = patch_near.data + ((size_t)w * model.pairs.count + pair) * patch_near.shape[2];
    for (int d = 0; d < columns; ++d) for (int e = WP_TILE_THREAD_IDX; e < size; e += WP_TILE_BLOCK_DIM)
        out[(size_t)d * size + e] = 0.0;
    for (int d = 0; d < columns; ++d) for (int k = 0; k <= columns; ++k) {
        const double f = (k == 0 || k == columns ? 0.5 : 1.0) / columns * ::cos(3.14159265358979324 * k * d / columns);
        const double* const m = M + (size_t)k * line * line;
        for (int e = WP_TILE_THREAD_IDX; e < size; e += WP_TILE_BLOCK_DIM) out[(size_t)d * size + e] += f * m[e];
    }
    WP_TILE_SYNC();
    const double* const length = elements.patches.row_length.data + elements.patches.row_start.data[pair];
    if (ends != 0.0) for (int d = 0; d < columns; ++d)
        for (int e = WP_TILE_THREAD_IDX; e < size; e += WP_TILE_BLOCK_DIM)
            if (e % line < rows) out[(size_t)d * size + e] += ends * length[e / line] * length[e % line];
    WP_TILE_SYNC();
""")
def find_near(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    rows: int,
    columns: int,
    ends: real,
    start: int,
    spectrum: wp.array(dtype=real),
    patch_near: wp.array3d(dtype=real),
): ...


# Displacement of spline n of one side due to unit loads on its splines, a line of S + Phi sigma^-1 Phi^T.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM, nodes = elements.patches.far_nodes;
    const size_t p = ((size_t)w * model.pairs.count + pair) * 2 + side;
    const double* const table = far_table.data + (p * nodes + n) * nodes;
    const double* const own = receptance.data + (size_t)w * model.modes.count + model.surfaces.modal_start.data[s];
    double* const soft = far_soft.data + p * nodes;
    WP_TILE_SYNC();
    for (int k = lane; k < count; k += lanes) soft[k] = table[k];
    for (int m = 0; m < model.surfaces.modal_count.data[s]; ++m) {
        const double* const t = far_trace.data + trace_start + (size_t)m * nodes;
        const double f = weight * weight * own[m] * t[n];
        for (int k = lane; k < count; k += lanes) soft[k] += f * t[k];
    }
    WP_TILE_SYNC();
""")
def soften_line(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    side: int,
    s: int,
    n: int,
    count: int,
    weight: real,
    trace_start: int,
    far_table: wp.array(dtype=real),
    far_trace: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    far_soft: wp.array(dtype=real),
): ...


@kernel
def answer_splines(run: Run, geometry: ContactGeometry, patch: PatchScratch, impulses: ImpulsiveContact):
    """Per (world, pair of family 2 with a matrix), if slots are new: near field, and displacement of the splines of
    both sides due to unit pressures."""
    w, pair, _lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].fresh == run.ctl[w].slots or not has_matrix(model, pair):
        return
    if not has_cells(model, w, pair, geometry):
        return
    elements = model.elements[0]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    find_near(
        model, elements, w, pair, rows, elements.patches.columns[pair], patch.patch_ends[w, pair],
        spectrum_at(model, elements, w, pair), patch.patch_spectrum, patch.patch_near,
    )  # fmt: skip
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            own = model.surfaces.rows[s]
            count = patch.far_window[w, pair, side, 1] * own
            start = ((w * model.pairs.count + pair) * 2 + side) * elements.patches.far_nodes
            for n in range(count):
                soften_line(
                    model, elements, w, pair, side, s, n, count, impulses.weight[w, pair],
                    trace_at(model, elements, w, pair, side), patch.far_table, patch.far_trace,
                    impulses.contact_receptance, patch.far_soft,
                )  # fmt: skip
                weigh_loads(
                    model, elements, w, pair, side, own, line_of(rows), patch.far_soft, start, patch.far_strip,
                    patch.far_share, patch.far_answer, (start + n) * elements.patches.places,
                )  # fmt: skip


# Row `slot` of G, of the cell at place `at`, for the slots of its pair up to itself: computed over the places of all
# strips with cells among them, then gathered.
@wp.func_native("""
    const int lane = WP_TILE_THREAD_IDX, lanes = WP_TILE_BLOCK_DIM, line = (rows + 7) / 8 * 8;
    const int column = at / line, row = at % line;
    const int stride = elements.patches.places, nodes = elements.patches.far_nodes, cap = model.capacity.slots;
    const size_t p = ((size_t)w * model.pairs.count + pair) * 2;
    const int* const slots = slot_node.data + (size_t)w * cap * 2;
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
        if (slots[2 * i] == pair) {
            const int m = slots[2 * i + 1];
            out[i] = g[m / rows * line + m % rows] + (i == slot ? yielded : 0.0);
        }
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
    slot_reach: wp.array2d(dtype=int),
    patch_near: wp.array3d(dtype=real),
    far_strip: wp.array4d(dtype=int),
    far_share: wp.array(dtype=real),
    far_answer: wp.array(dtype=real),
    far_line: wp.array2d(dtype=real),
    G: wp.array3d(dtype=real),
): ...


# The mirror of rows `fresh` to `slots` of G within patches, eight at a time, because columns are far apart in memory.
# Lanes over the columns of these rows.
@wp.func_native("""
    const int cap = model.capacity.slots;
    const int* const pair = slot_node.data + (size_t)w * cap * 2;
    const int *family = model.pairs.family.data, *matrix = model.pairs.matrix.data;
    double* const g = G.data + (size_t)w * cap * cap;
    for (int s = fresh; s < slots; s += 8) {
        const int end = s + 8 < slots ? s + 8 : slots;
        for (int j = WP_TILE_THREAD_IDX; j < end - 1; j += WP_TILE_BLOCK_DIM) {
            if (family[pair[2 * j]] != 2 || !matrix[pair[2 * j]]) continue;  // PATCH
            for (int i = j < s ? s : j + 1; i < end; ++i)
                if (pair[2 * i] == pair[2 * j]) g[(size_t)j * cap + i] = g[(size_t)i * cap + j];
        }
    }
""")
def mirror_within(
    model: Model, w: int, fresh: int, slots: int, slot_node: wp.array3d(dtype=int), G: wp.array3d(dtype=real)
): ...


@kernel
def assemble_cells(run: Run, normal: ContactSolve, geometry: ContactGeometry, patch: PatchScratch):
    """Per world: new rows of G of patches with a matrix, within their pairs."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    elements = model.elements[0]
    pair = lane
    while pair < model.pairs.count:  # the last place of a pair, of its slots so far
        reach = int(-1)
        slot = int(0)
        while slot < run.ctl[w].slots:
            if normal.slot_node[w, slot, 0] == pair:
                rows = model.surfaces.rows[model.pairs.first[pair]]
                m = normal.slot_node[w, slot, 1]
                reach = wp.max(reach, m / rows * line_of(rows) + m % rows)
                patch.slot_reach[w, slot] = reach
            slot += 1
        pair += wp.block_dim()
    sync()
    slot = run.ctl[w].fresh
    while slot < run.ctl[w].slots:
        pair = normal.slot_node[w, slot, 0]
        if has_matrix(model, pair):
            rows = model.surfaces.rows[model.pairs.first[pair]]
            m = normal.slot_node[w, slot, 1]
            lay_row(
                model, elements, w, pair, slot, m / rows * line_of(rows) + m % rows, rows,
                rows_of(model, elements, pair, 0), rows_of(model, elements, pair, 1),
                elements.patches.layer[pair] * geometry.area[w, pair, m], normal.slot_node, patch.slot_reach,
                patch.patch_near, patch.far_strip, patch.far_share, patch.far_answer, patch.far_line, normal.G,
            )  # fmt: skip
        slot += 1
    mirror_within(model, w, run.ctl[w].fresh, run.ctl[w].slots, normal.slot_node, normal.G)
