"""Tables of the tangential part of the far field under a patch for contiguous sums, as in `patch.spline_tables`.

For one side, with the splines of its far window in lines of `far_nodes`, directions 0 and 1 of the surface:

    table[d', n'] = (S_tt[d n, d' n'] over d and n, then S_nt[n, d' n'] over n): displacement along and outward of all
                    splines due to a unit force along d' on spline n'
    trace[mode]   = (direction, spline): displacement of the mode along the surface
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import PatchScratch, RollingScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.friction.cells import rubs_on_patch
from warpffrf_kernels.patch.spline_tables import real_side

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def half_along(model: Model, elements: Elements, w: int, pair: int, side: int, d: int) -> int:
    """Start of the numbers of the splines of a side and direction."""
    return (((w * model.pairs.count + pair) * 2 + side) * 2 + d) * elements.patches.far_nodes


@wp.func
def table_along(model: Model, elements: Elements, w: int, pair: int, side: int, d: int) -> int:
    """Start of the table of forces of a side along direction d, lines of 3 far_nodes."""
    return half_along(model, elements, w, pair, side, d) * 3 * elements.patches.far_nodes


@wp.func
def trace_along(model: Model, elements: Elements, w: int, pair: int, side: int) -> int:
    """Start of the modes of a side, lines of 2 far_nodes: those of B follow those of A."""
    line = (w * model.pairs.count + pair) * model.pairs.most_modes
    if side == 1:
        line += model.surfaces.modal_count[model.pairs.first[pair]]
    return line * 2 * elements.patches.far_nodes


# Table and modes of one side, `count` columns of splines from `first` on. Lanes over splines.
@wp.func_native("""
    const int rows = model.surfaces.rows.data[s], turn = model.surfaces.turn.data[s];
    const int all = model.surfaces.columns.data[s], modes = model.surfaces.modal_count.data[s];
    const int block = elements.patches.far_columns.data[f], sectors = elements.patches.far_sectors.data[f];
    const int nodes = elements.patches.far_nodes, lines = block * rows;
    const double* const tt = elements.rolling.sheared.data + elements.rolling.sheared_start.data[f];
    const double* const nt = elements.rolling.turned.data + elements.rolling.turned_start.data[f];
    const double* const phi = elements.rolling.tangent.data + elements.rolling.tangent_start.data[f];
    for (int e = WP_TILE_THREAD_IDX; e < 2 * nodes; e += WP_TILE_BLOCK_DIM) {
        const int d = e / nodes, n = e % nodes;
        int source = first + n / rows;
        if (turn > 0) source = ((source % turn) + turn) % turn;
        const bool there = n < count * rows && source >= 0 && source < all;
        for (int i = 0; i < modes; ++i)
            rub_trace.data[trace + (size_t)i * 2 * nodes + e] = there
                ? phi[(((size_t)d * all + source) * rows + n % rows) * modes + i] : 0.0;
        double* const out = rub_table.data + start + (size_t)e * 3 * nodes;
        for (int i = 0; i < 3 * nodes; ++i) out[i] = 0.0;
        for (int c = 0; there && c < count; ++c) {
            int target = first + c;
            if (turn > 0) target = ((target % turn) + turn) % turn;
            if (target < 0 || target >= all) continue;
            const int lag = (target / block - source / block + sectors) % sectors;
            const size_t from = (size_t)d * lines + (source % block) * rows + n % rows;
            for (int r = 0; r < rows; ++r) {
                const size_t to = (size_t)(target % block) * rows + r;
                for (int k = 0; k < 2; ++k) {
                    const size_t line = (size_t)lag * 2 * lines + k * lines + to;
                    out[(size_t)k * nodes + c * rows + r] = tt[line * 2 * lines + from];
                }
                out[2 * (size_t)nodes + c * rows + r] = nt[((size_t)lag * lines + to) * 2 * lines + from];
            }
        }
    }
""")
def table_side_along(
    model: Model,
    elements: Elements,
    s: int,
    f: int,
    first: int,
    count: int,
    start: int,
    trace: int,
    rub_table: wp.array(dtype=real),
    rub_trace: wp.array(dtype=real),
): ...


@kernel
def lay_splines_along(run: Run, patch: PatchScratch, rolling: RollingScratch):
    """Per (world, pair): the tables of both sides if the window of splines has changed."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not rubs_on_patch(model, pair):
        return
    elements = model.elements[0]
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            first = patch.far_window[w, pair, side, 0]
            count = patch.far_window[w, pair, side, 1]
            same = int(0)
            if rolling.rub_laid[w, pair, side, 0] == first and rolling.rub_laid[w, pair, side, 1] == count:
                same = int(1)
            sync()
            if same == 0:
                table_side_along(
                    model, elements, s, elements.patches.far_of[s], first, count,
                    table_along(model, elements, w, pair, side, 0), trace_along(model, elements, w, pair, side),
                    rolling.rub_table, rolling.rub_trace,
                )  # fmt: skip
                if lane == 0:
                    rolling.rub_laid[w, pair, side, 0] = first
                    rolling.rub_laid[w, pair, side, 1] = count
            sync()


# load[n] = sum over places of share[n] times q, for the splines of one side.
@wp.func_native("""
    const int line = (lines + 7) / 8 * 8, columns = elements.patches.columns.data[pair];
    const int stride = elements.patches.places, nodes = elements.patches.far_nodes;
    const size_t p = ((size_t)w * model.pairs.count + pair) * 2 + side;
    const int* const strip = far_strip.data + 2 * p * model.window.columns;
    const double* const value = q.data + at_q;
    for (int n = WP_TILE_THREAD_IDX; n < nodes; n += WP_TILE_BLOCK_DIM) {
        const double* const x = far_share.data + (p * nodes + n) * stride;
        double sum[8] = {0.0};
        for (int c = 0; c < columns && n < count; ++c) {
            const int column = n / rows - strip[2 * c];
            if (column < 0 || column >= strip[2 * c + 1]) continue;
            for (int e = c * line; e < (c + 1) * line; e += 8)
                for (int i = 0; i < 8; ++i) sum[i] += x[e + i] * value[e + i];
        }
        load.data[at + n] = ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
    }
    WP_TILE_SYNC();
""")
def load_side(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    side: int,
    lines: int,
    rows: int,
    count: int,
    far_strip: wp.array4d(dtype=int),
    far_share: wp.array(dtype=real),
    q: wp.array(dtype=real),
    at_q: int,
    load: wp.array(dtype=real),
    at: int,
): ...


# value[at + m] = sum over the splines of one side of field times their load by cell m.
@wp.func_native("""
    const int B = WP_TILE_BLOCK_DIM > 1 ? 1 : 8, line = (lines + 7) / 8 * 8;
    const int columns = elements.patches.columns.data[pair];
    const int stride = elements.patches.places, nodes = elements.patches.far_nodes;
    const size_t p = ((size_t)w * model.pairs.count + pair) * 2 + side;
    const int* const strips = far_strip.data + 2 * p * model.window.columns;
    const double* const u = field.data + at_field;
    double* const x = value.data + at;
    for (int e = B * WP_TILE_THREAD_IDX; e < columns * line; e += B * WP_TILE_BLOCK_DIM) {
        const int c = e / line, r = e % line;
        const double* const share = far_share.data + p * nodes * stride + e;
        double sum[8] = {0.0};
        for (int n = strips[2 * c] * rows; n < (strips[2 * c] + strips[2 * c + 1]) * rows; ++n)
            for (int i = 0; i < B; ++i) sum[i] += u[n] * share[(size_t)n * stride + i];
        for (int i = 0; i < B && r + i < lines; ++i) x[c * lines + r + i] = sum[i];
    }
    WP_TILE_SYNC();
""")
def read_side(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    side: int,
    lines: int,
    rows: int,
    far_strip: wp.array4d(dtype=int),
    far_share: wp.array(dtype=real),
    field: wp.array(dtype=real),
    at_field: int,
    value: wp.array(dtype=real),
    at: int,
): ...


# out[at : at + n] = sum of `count` lines of the table of each direction, each times its force, from `start` on.
@wp.func_native("""
    const int B = WP_TILE_BLOCK_DIM > 1 ? 1 : 8;
    const size_t stride = 3 * (size_t)nodes;
    for (int e = B * WP_TILE_THREAD_IDX; e < n; e += B * WP_TILE_BLOCK_DIM) {
        double sum[8] = {0.0};
        for (int d = 0; d < 2; ++d) {
            const double* const from = table.data + start + d * nodes * stride + e;
            const double* const f = load.data + at_load + d * nodes;
            for (int k = 0; k < count; ++k)
                for (int i = 0; i < B; ++i) sum[i] += f[k] * from[k * stride + i];
        }
        for (int i = 0; i < B; ++i) out.data[at + e + i] = sum[i];
    }
    WP_TILE_SYNC();
""")
def sum_along(
    n: int,
    count: int,
    nodes: int,
    load: wp.array(dtype=real),
    at_load: int,
    table: wp.array(dtype=real),
    start: int,
    out: wp.array(dtype=real),
    at: int,
): ...
