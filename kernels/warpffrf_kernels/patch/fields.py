"""Opening of the gaps of cells by global modes and local displacement of both bodies, and loads of the cells.

Spline values of a pair are stored in two halves, one per side, (columns of the far window, rows): loads P^T A p [N],
their displacement S times the loads, and that of the modes. A cell interpolates displacements with the weights of its
loads (`spline_tables`).
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactFields, ContactGeometry, PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import PATCH, Elements, Model
from warpffrf_kernels.core.ring import SavedContact
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, dot, real
from warpffrf_kernels.core.scratch import Residuals, Trial
from warpffrf_kernels.core.state import ContactState
from warpffrf_kernels.kinematics.closest_point import has_cells, least_place, length_of, may_reach, scan, view_of
from warpffrf_kernels.normal.pair_forces import modal_line
from warpffrf_kernels.patch.between import add_half_space
from warpffrf_kernels.patch.place import extent_of
from warpffrf_kernels.patch.spline_tables import line_of, real_side, table_at, trace_at
from warpffrf_kernels.patch.strips import multiply_pressures
from warpffrf_kernels.surfaces.fields import clear_field

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def half_of(model: Model, elements: Elements, w: int, pair: int, side: int) -> int:
    """Start of the spline values of a side."""
    return ((w * model.pairs.count + pair) * 2 + side) * elements.patches.far_nodes


@wp.func
def rows_of(model: Model, elements: Elements, pair: int, side: int) -> int:
    """Rows of splines of a side; 0 if it is rigid."""
    s = real_side(elements, pair, side)
    if s < 0:
        return 0
    return model.surfaces.rows[s]


# out += sum of the values `field` of the splines of both sides at each cell of the pair, with `lines` cells per strip,
# first_rows and second_rows splines per column. Native for contiguous inner loops, as all sums here.
@wp.func_native("""
    const int B = WP_TILE_BLOCK_DIM > 1 ? 1 : 8, line = (lines + 7) / 8 * 8;
    const int columns = elements.patches.columns.data[pair];
    const int stride = elements.patches.places, nodes = elements.patches.far_nodes;
    const size_t p = ((size_t)w * model.pairs.count + pair) * 2;
    double* const x = value.data + p / 2 * model.window.grid_nodes;
    for (int e = B * WP_TILE_THREAD_IDX; e < columns * line; e += B * WP_TILE_BLOCK_DIM) {
        const int c = e / line, r = e % line;
        double sum[8] = {0.0};
        for (int side = 0; side < 2; ++side) {
            const int rows = side ? second_rows : first_rows;
            const int* const strip = far_strip.data + 2 * ((p + side) * model.window.columns + c);
            const double* const u = field.data + (p + side) * nodes;
            const double* const share = far_share.data + (p + side) * nodes * stride + e;
            for (int n = rows ? strip[0] * rows : 0; n < (rows ? strip[0] + strip[1] : 0) * rows; ++n)
                for (int i = 0; i < B; ++i) sum[i] += u[n] * share[(size_t)n * stride + i];
        }
        for (int i = 0; i < B && r + i < lines; ++i) x[c * lines + r + i] += sum[i];
    }
    WP_TILE_SYNC();
""")
def add_splines(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    lines: int,
    first_rows: int,
    second_rows: int,
    far_strip: wp.array4d(dtype=int),
    far_share: wp.array(dtype=real),
    field: wp.array(dtype=real),
    value: wp.array(dtype=real),
): ...


# out[at : at + n] = sum of `count` lines of x, each times its value of f, LINE numbers at a time.
@wp.func_native("""
    const int B = WP_TILE_BLOCK_DIM > 1 ? 1 : 8;
    const double* const factor = f.data + at_f;
    for (int e = B * WP_TILE_THREAD_IDX; e < n; e += B * WP_TILE_BLOCK_DIM) {
        const double* const from = x.data + start + e;
        double sum[8] = {0.0};
        for (int k = 0; k < count; ++k)
            for (int i = 0; i < B; ++i) sum[i] += factor[k] * from[(size_t)k * stride + i];
        for (int i = 0; i < B; ++i) out.data[at + e + i] = sum[i];
    }
    WP_TILE_SYNC();
""")
def sum_lines(
    n: int,
    count: int,
    f: wp.array(dtype=real),
    at_f: int,
    x: wp.array(dtype=real),
    start: int,
    stride: int,
    out: wp.array(dtype=real),
    at: int,
): ...


@kernel
def modal_cells(
    run: Run, geometry: ContactGeometry, patch: PatchScratch, amplitude: wp.array(dtype=real), of_state: int,
    first_field: wp.array(dtype=real),
):  # fmt: skip
    """Per (world, pair of family 2), lanes over splines, then cells: weak displacement by the global modes of both
    bodies."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or (of_state != 0 and run.ctl[w].moved == 0) or not has_cells(model, w, pair, geometry):
        return
    elements = model.elements[0]
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            sum_lines(
                line_of(patch.far_window[w, pair, side, 1] * model.surfaces.rows[s]), model.surfaces.modal_count[s],
                amplitude, w * model.modes.count + model.surfaces.modal_start[s], patch.far_trace,
                trace_at(model, elements, w, pair, side), elements.patches.far_nodes, patch.far_modes,
                half_of(model, elements, w, pair, side),
            )  # fmt: skip
    rows = model.surfaces.rows[model.pairs.first[pair]]
    clear_field(
        lane,
        elements.patches.columns[pair] * rows,
        (w * model.pairs.count + pair) * model.window.grid_nodes,
        first_field,
    )
    add_splines(
        model, elements, w, pair, rows, rows_of(model, elements, pair, 0), rows_of(model, elements, pair, 1),
        patch.far_strip, patch.far_share, patch.far_modes, first_field,
    )  # fmt: skip


# Loads on the splines of both sides due to pressures q at places.
@wp.func_native("""
    const int line = (lines + 7) / 8 * 8, columns = elements.patches.columns.data[pair];
    const int stride = elements.patches.places, nodes = elements.patches.far_nodes;
    const size_t p = ((size_t)w * model.pairs.count + pair) * 2;
    const double* const q = pressure.data + p / 2 * stride;
    WP_TILE_SYNC();
    for (int side = 0; side < 2; ++side) {
        const int rows = side ? second_rows : first_rows;
        const int* const strip = far_strip.data + 2 * (p + side) * model.window.columns;
        double* const load = far_load.data + (p + side) * nodes;
        for (int n = WP_TILE_THREAD_IDX; n < far_window.data[2 * (p + side) + 1] * rows; n += WP_TILE_BLOCK_DIM) {
            const double* const x = far_share.data + ((p + side) * nodes + n) * stride;
            double sum[8] = {0.0};
            for (int c = 0; c < columns; ++c) {
                const int column = n / rows - strip[2 * c];
                if (column < 0 || column >= strip[2 * c + 1]) continue;
                for (int e = c * line; e < (c + 1) * line; e += 8)
                    for (int i = 0; i < 8; ++i) sum[i] += x[e + i] * q[e + i];
            }
            load[n] = ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
        }
    }
    WP_TILE_SYNC();
""")
def sum_loads(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    lines: int,
    first_rows: int,
    second_rows: int,
    pressure: wp.array(dtype=real),
    far_window: wp.array4d(dtype=int),
    far_strip: wp.array4d(dtype=int),
    far_share: wp.array(dtype=real),
    far_load: wp.array(dtype=real),
): ...


# Pressures of the active cells at places, 0 at others.
@wp.func_native("""
    const int line = (lines + 7) / 8 * 8, columns = elements.patches.columns.data[pair];
    const size_t here = (size_t)w * model.pairs.count + pair;
    const double* const given = pressure.data + here * model.window.grid_nodes;
    const int* const on = active.data + here * model.window.grid_nodes;
    double* const q = placed.data + here * elements.patches.places;
    for (int e = WP_TILE_THREAD_IDX; e < columns * line; e += WP_TILE_BLOCK_DIM) {
        const int m = e / line * lines + e % line;
        q[e] = e % line < lines && on[m] != 0 ? given[m] : 0.0;
    }
""")
def place_pressures(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    lines: int,
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    placed: wp.array(dtype=real),
): ...


@wp.func
def load_patch(
    model: Model, elements: Elements, w: int, pair: int, patch: PatchScratch, pressure: wp.array(dtype=real),
    load: wp.array(dtype=real),
):  # fmt: skip
    """Loads on the splines of both sides [N] due to pressures at places."""
    sum_loads(
        model, elements, w, pair, model.surfaces.rows[model.pairs.first[pair]], rows_of(model, elements, pair, 0),
        rows_of(model, elements, pair, 1), pressure, patch.far_window, patch.far_strip, patch.far_share, load,
    )  # fmt: skip


@kernel
def load_splines(run: Run, contact: ContactState, patch: PatchScratch):
    """Per (world, pair of family 2): the present pressures at places, and loads on the splines of both sides."""
    w, pair, _lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or model.pairs.family[pair] != PATCH:
        return
    elements = model.elements[0]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    place_pressures(model, elements, w, pair, rows, contact.active, contact.pressure, patch.patch_pressure)
    load_patch(model, elements, w, pair, patch, patch.patch_pressure, patch.far_load)


# Weak displacement of the cells of a pair: that by the half-spaces, at places, and those by the layer and by distant
# ends.
@wp.func_native("""
    const int line = (rows + 7) / 8 * 8, columns = elements.patches.columns.data[pair];
    const size_t p = (size_t)w * model.pairs.count + pair;
    const double yielded = elements.patches.layer.data[pair];
    const double* const length = elements.patches.row_length.data + elements.patches.row_start.data[pair];
    const double* const q = pressure.data + p * elements.patches.places;
    const double* const near = placed.data + p * elements.patches.places;
    const double* const size = area.data + p * model.window.grid_nodes;
    double* const u = value.data + p * model.window.grid_nodes;
    double all = 0.0;
    for (int c = 0; ends != 0.0 && c < columns; ++c)
        for (int r = 0; r < rows; ++r) all += length[r] * q[c * line + r];
    for (int c = WP_TILE_THREAD_IDX; c < columns; c += WP_TILE_BLOCK_DIM)
        for (int r = 0; r < rows; ++r) {
            const int m = c * rows + r, e = c * line + r;
            u[m] = !own ? 0.0 : near[e] + yielded * size[m] * q[e] + ends * length[r] * all;
        }
    WP_TILE_SYNC();
""")
def take_near(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    rows: int,
    own: int,
    ends: real,
    pressure: wp.array(dtype=real),
    placed: wp.array(dtype=real),
    area: wp.array3d(dtype=real),
    value: wp.array(dtype=real),
): ...


# field += displacements of the splines of a side, `rows` in each column, by the far fields of the neighbouring patches,
# due to the loads on theirs; up to 32 rows at a time, whose sums are kept in eight parts. Lanes over the columns.
@wp.func_native("""
    const size_t p = (size_t)w * model.pairs.count * 2, own = p + 2 * pair + side;
    const int count = far_window.data[2 * own + 1], nodes = elements.patches.far_nodes;
    const int begin = elements.patches.beside_start.data[2 * pair + side];
    const int end = elements.patches.beside_start.data[2 * pair + side + 1];
    const int wide = elements.patches.far_columns_most;
    WP_TILE_SYNC();
    for (int d = WP_TILE_THREAD_IDX; d < count; d += WP_TILE_BLOCK_DIM) for (int first = 0; first < rows; first += 32) {
        const int high = first + 32 < rows ? 32 : rows - first;
        double sum[32][8], rest[32];
        for (int k = 0; k < high; ++k) { rest[k] = 0.0; for (int v = 0; v < 8; ++v) sum[k][v] = 0.0; }
        for (int e = begin; e < end; ++e) {
            const int other = elements.patches.beside_side.data[e], table = elements.patches.beside_table.data[e];
            const int r = (other % 2 ? elements.patches.second : elements.patches.first).data[other / 2];
            const int lines = model.surfaces.rows.data[r], stride = elements.patches.table_source.data[table] * lines;
            const int columns = far_window.data[2 * (p + other) + 1];
            const int* const at = beside_at.data + (((size_t)w * beside_at.shape[1] + e) * wide + d) * wide;
            for (int c = 0; c < columns; ++c) {
                const double* const f = load.data + (p + other) * nodes + (size_t)c * lines;
                bool loaded = false;
                for (int i = 0; i < lines; ++i) loaded |= f[i] != 0.0;
                if (!loaded || at[c] < 0) continue;
                const double* const block = elements.patches.beside.data + at[c] + (size_t)first * stride;
                for (int k = 0; k < high; ++k) {
                    const double* const x = block + (size_t)k * stride;
                    int i = 0;
                    for (; i + 7 < lines; i += 8) for (int v = 0; v < 8; ++v) sum[k][v] += x[i + v] * f[i + v];
                    if (i + 3 < lines) { for (int v = 0; v < 4; ++v) sum[k][v] += x[i + v] * f[i + v]; i += 4; }
                    for (; i < lines; ++i) rest[k] += x[i] * f[i];
                }
            }
        }
        for (int k = 0; k < high; ++k) {
            const double* const s = sum[k];
            field.data[own * nodes + (size_t)d * rows + first + k] +=
                ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7])) + rest[k];
        }
    }
    WP_TILE_SYNC();
""")
def add_beside(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    side: int,
    rows: int,
    far_window: wp.array4d(dtype=int),
    beside_at: wp.array3d(dtype=int),
    load: wp.array(dtype=real),
    field: wp.array(dtype=real),
): ...


@wp.func
def displace_patch(
    model: Model, elements: Elements, w: int, pair: int, own: int, beside: int, patch: PatchScratch,
    geometry: ContactGeometry,
    pressure: wp.array(dtype=real), load: wp.array(dtype=real), field: wp.array(dtype=real),
    placed: wp.array(dtype=real), value: wp.array(dtype=real),
):  # fmt: skip
    """Weak displacement `value` of the cells of a pair by both bodies due to pressures at places and the loads on
    splines: `own` ones, and those `beside`, of other pairs."""
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            rows = model.surfaces.rows[s]
            start = half_of(model, elements, w, pair, side)
            count = patch.far_window[w, pair, side, 1] * rows
            sum_lines(
                line_of(count), count * own, load, start, patch.far_table, table_at(model, elements, w, pair, side),
                elements.patches.far_nodes, field, start,
            )  # fmt: skip
            if beside != 0:
                add_beside(model, elements, w, pair, side, rows, patch.far_window, patch.beside_at, load, field)
    rows = model.surfaces.rows[model.pairs.first[pair]]
    if own != 0:
        multiply_pressures(model, elements, w, pair, patch, pressure, placed)
    take_near(model, elements, w, pair, rows, own, patch.patch_ends[w, pair], pressure, placed, geometry.area, value)
    add_splines(
        model, elements, w, pair, rows, rows_of(model, elements, pair, 0), rows_of(model, elements, pair, 1),
        patch.far_strip, patch.far_share, field, value,
    )  # fmt: skip
    if beside != 0:
        add_half_space(model, elements, w, pair, patch.patch_between, patch.patch_place, pressure, value)


@kernel
def local_cells(run: Run, patch: PatchScratch, geometry: ContactGeometry, fields: ContactFields):
    """Per (world, pair of family 2), lanes over splines, then cells: weak displacement of both bodies, near field and
    far field, due to the present pressures."""
    w, pair, _lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or not has_cells(model, w, pair, geometry):
        return
    displace_patch(
        model, model.elements[0], w, pair, 1, int(model.elements[0].patches.touching > 0), patch, geometry,
        patch.patch_pressure, patch.far_load, patch.far_field, patch.patch_shift, fields.first_local,
    )  # fmt: skip


@kernel
def load_modes(run: Run, patch: PatchScratch, pair_modal: wp.array(dtype=real)):
    """Per (world, pair of family 2), lanes over modes: load of the contact pressures on the modes of A, then of B."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or model.pairs.family[pair] != PATCH:
        return
    elements = model.elements[0]
    trial = modal_line(model, w, pair)
    count_a = model.surfaces.modal_count[model.pairs.first[pair]]
    i = lane
    while i < model.pairs.most_modes:
        side = int(0)
        n = i
        if i >= count_a:
            side = int(1)
            n = i - count_a
        s = real_side(elements, pair, side)
        value = real(0.0)
        if s >= 0 and n < model.surfaces.modal_count[s]:
            line = trace_at(model, elements, w, pair, side) + n * elements.patches.far_nodes
            count = patch.far_window[w, pair, side, 1] * model.surfaces.rows[s]
            value = -dot(count, patch.far_load, half_of(model, elements, w, pair, side), patch.far_trace, line)
        pair_modal[trial + i] = value
        i += wp.block_dim()


@kernel
def guard_patches(
    run: Run, geometry: ContactGeometry, contact: ContactState, patch: PatchScratch, residuals: Residuals
):  # fmt: skip
    """Per world: a patch that has reached the outermost strips is not balanced, because W has to grow."""
    w = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    elements = model.elements[0]
    pair = int(0)
    while pair < model.pairs.count:
        if has_cells(model, w, pair, geometry):
            width = patch.patch_place[w, pair, 2]
            rows = model.surfaces.rows[model.pairs.first[pair]]
            found = extent_of(elements, w, pair, rows, width, contact)
            if found.reaches != 0 and width < elements.patches.most_width[pair]:
                residuals.gap_defect[w, 0] = wp.max(residuals.gap_defect[w, 0], real(1.0))
        pair += 1


@kernel
def measure_patches(run: Run, trial: Trial, geometry: ContactGeometry):
    """Per (world, pair of family 2), if a state is recorded: smallest undeformed gap, at most the length of A's curve,
    and nearest column, stored where `record` reads them."""
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].record == 0 or model.pairs.family[pair] != PATCH:
        return
    elements = model.elements[0]
    A = elements.patches.first[pair]
    B = elements.patches.second[pair]
    view = view_of(model, w, pair, trial)
    gap = length_of(model, A)
    if has_cells(model, w, pair, geometry):
        place = least_place(model, A, B, view, geometry.nearest[w, pair, 0], geometry.nearest[w, pair, 1])
        gap = place[0]
    elif may_reach(model, A, B, view, gap):
        gap = wp.min(scan(model, w, pair, A, B, view, geometry), gap)
    rows = model.surfaces.rows[model.pairs.first[pair]]
    for end in range(2):
        s = end * ((rows - 1) * model.quadrature.z_points - 1)
        geometry.station[w, pair, s, 0] = gap
        geometry.station[w, pair, s, 1] = geometry.nearest[w, pair, 0]


@kernel
def record_patches(run: Run, patch: PatchScratch, saved: SavedContact):
    """Per (world, pair): position of the patch of family 2, and its half-width."""
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].record == 0:
        return
    at = run.ctl[w].saved % saved.saved_patch.shape[1]
    i = int(0)
    while i < saved.saved_patch.shape[3]:
        value = real(0.0)
        if model.pairs.family[pair] == PATCH:
            value = patch.patch_place[w, pair, i]
        saved.saved_patch[w, at, pair, i] = value
        i += 1


@kernel
def sum_patches_second(run: Run, contact: ContactState, geometry: ContactGeometry, fields: ContactFields):
    """Per (world, pair of family 2): force on B and its moment about A's centre of mass."""
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].record == 0 or model.pairs.family[pair] != PATCH:
        return
    elements = model.elements[0]
    cells = elements.patches.columns[pair] * model.surfaces.rows[model.pairs.first[pair]]
    for i in range(6):
        total = real(0.0)
        m = int(0)
        while m < cells:
            if contact.active[w, pair, m] != 0:
                total -= contact.pressure[w, pair, m] * (
                    geometry.wrench[w, pair, m, i] + geometry.more_wrench[w, pair, m, i]
                )
            m += 1
        fields.second_wrench[w, pair, i] = total
