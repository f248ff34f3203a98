"""Tables of the splines under a patch for contiguous sums: loads by all cells, compliance S, and the modes on them.

Cells are stored at *places*: strip by strip, the rows of a strip padded with zeros to a multiple of LINE. For one side,
with the splines of its far window (column, row) in lines of `far_nodes`:

    share[n, place]   load of spline n due to a unit pressure: strip by strip, only where the strip's cells load at all
    table[n, n']      S
    trace[mode, n]    normal displacement of the mode

so sums over splines run along places or along splines, LINE numbers at a time, which a CPU vectorises.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry, PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.kinematics.closest_point import has_cells

wp.set_module_options(MODULE_OPTIONS)

LINE = 8  # maximum number of values in a vector register


@wp.func
def real_side(elements: Elements, pair: int, side: int) -> int:
    """The meshed surface that a side of a pair loads; -1 if it is rigid."""
    s = elements.patches.first[pair]
    if side == 1:
        s = elements.patches.second[pair]
    if elements.patches.far_of[s] < 0:
        return -1
    return s


@wp.func
def line_of(rows: int) -> int:
    """Places of a strip with `rows` cells."""
    return (rows + LINE - 1) / LINE * LINE


# Shares of the splines of one side, `lines` cells per strip, and the columns of splines that each strip loads: the
# first, counted from that of the window, and their number. Lanes over strips.
@wp.func_native("""
    const int rows = model.surfaces.rows.data[s], taps = rows < 3 ? rows : 3, grid_nodes = model.window.grid_nodes;
    const int stride = elements.patches.places, line = (lines + 7) / 8 * 8;
    const int columns = elements.patches.columns.data[pair];
    const size_t p = ((size_t)w * model.pairs.count + pair) * 2 + side;
    const int* const at = far_at.data + 2 * p * grid_nodes;
    const double* const q = far_weight.data + 9 * p * grid_nodes;
    const int first = far_window.data[2 * p];
    int* const strip = far_strip.data + 2 * p * model.window.columns;
    double* const share = far_share.data + p * elements.patches.far_nodes * stride;
    for (int c = WP_TILE_THREAD_IDX; c < columns; c += WP_TILE_BLOCK_DIM) {
        int low = at[2 * c * lines], high = low;
        for (int m = c * lines; m < (c + 1) * lines; ++m) {
            if (at[2 * m] < low) low = at[2 * m];
            if (at[2 * m] > high) high = at[2 * m];
        }
        strip[2 * c] = low - first; strip[2 * c + 1] = high - low + 3;
        for (int n = (low - first) * rows; n < (high - first + 3) * rows; ++n)
            for (int r = 0; r < line; ++r) share[(size_t)n * stride + c * line + r] = 0.0;
        for (int m = c * lines; m < (c + 1) * lines; ++m) {
            const size_t n = (size_t)(at[2 * m] - first) * rows + at[2 * m + 1];
            double* const x = share + n * stride + c * line + m - c * lines;
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < taps; ++b) x[(size_t)(a * rows + b) * stride] = q[9 * m + 3 * a + b];
        }
    }
""")
def share_side(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    side: int,
    s: int,
    lines: int,
    far_at: wp.array4d(dtype=int),
    far_weight: wp.array4d(dtype=real),
    far_window: wp.array4d(dtype=int),
    far_strip: wp.array4d(dtype=int),
    far_share: wp.array(dtype=real),
): ...


# S and the modes on the splines of one side, `count` columns from `first` on. S is symmetric; the sources of a line are
# read. Lanes over splines.
@wp.func_native("""
    const int rows = model.surfaces.rows.data[s], turn = model.surfaces.turn.data[s];
    const int all = model.surfaces.columns.data[s], modes = model.surfaces.modal_count.data[s];
    const int block = elements.patches.far_columns.data[f], sectors = elements.patches.far_sectors.data[f];
    const int nodes = elements.patches.far_nodes, used = (count * rows + 7) / 8 * 8, lines = block * rows;
    const double* const S = elements.patches.far.data + elements.patches.far_start.data[f];
    const double* const phi = elements.patches.mode.data + elements.patches.mode_start.data[f];
    for (int n = WP_TILE_THREAD_IDX; n < used; n += WP_TILE_BLOCK_DIM) {
        int source = first + n / rows;
        if (turn > 0) source = ((source % turn) + turn) % turn;
        const bool there = n < count * rows && source >= 0 && source < all;
        double* const out = far_table.data + start + (size_t)n * nodes;
        for (int i = 0; i < used; ++i) out[i] = 0.0;
        const double* const own = phi + (size_t)(there ? source * rows + n % rows : 0) * modes;
        for (int i = 0; i < modes; ++i) far_trace.data[trace + (size_t)i * nodes + n] = there ? own[i] : 0.0;
        for (int c = 0; there && c < count; ++c) {
            int target = first + c;
            if (turn > 0) target = ((target % turn) + turn) % turn;
            if (target < 0 || target >= all) continue;
            const int lag = (source / block - target / block + sectors) % sectors;
            const double* const from =
                S + ((size_t)lag * lines + (source % block) * rows + n % rows) * lines + (target % block) * rows;
            for (int r = 0; r < rows; ++r) out[c * rows + r] = from[r];
        }
    }
""")
def table_side(
    model: Model,
    elements: Elements,
    s: int,
    f: int,
    first: int,
    count: int,
    start: int,
    trace: int,
    far_table: wp.array(dtype=real),
    far_trace: wp.array(dtype=real),
): ...


@wp.func
def table_at(model: Model, elements: Elements, w: int, pair: int, side: int) -> int:
    """Start of S of a side."""
    nodes = elements.patches.far_nodes
    return ((w * model.pairs.count + pair) * 2 + side) * nodes * nodes


@wp.func
def trace_at(model: Model, elements: Elements, w: int, pair: int, side: int) -> int:
    """Start of the modes of a side: those of B follow those of A."""
    line = (w * model.pairs.count + pair) * model.pairs.most_modes
    if side == 1:
        line += model.surfaces.modal_count[model.pairs.first[pair]]
    return line * elements.patches.far_nodes


@kernel
def lay_splines(run: Run, geometry: ContactGeometry, patch: PatchScratch):
    """Per (world, pair of family 2): shares of the splines of both sides; S and the modes on them if the window of
    splines has changed."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not has_cells(model, w, pair, geometry):
        return
    elements = model.elements[0]
    lines = model.surfaces.rows[model.pairs.first[pair]]
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            share_side(
                model, elements, w, pair, side, s, lines, patch.far_at, patch.far_weight, patch.far_window,
                patch.far_strip, patch.far_share,
            )  # fmt: skip
            first = patch.far_window[w, pair, side, 0]
            count = patch.far_window[w, pair, side, 1]
            same = int(0)
            if patch.far_laid[w, pair, side, 0] == first and patch.far_laid[w, pair, side, 1] == count:
                same = int(1)
            sync()
            if same == 0:
                table_side(
                    model, elements, s, elements.patches.far_of[s], first, count,
                    table_at(model, elements, w, pair, side), trace_at(model, elements, w, pair, side), patch.far_table,
                    patch.far_trace,
                )  # fmt: skip
                if lane == 0:
                    patch.far_laid[w, pair, side, 0] = first
                    patch.far_laid[w, pair, side, 1] = count
