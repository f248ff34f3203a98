r"""The half-space between two patches of one surface: weak displacement of a row of cells due to one of another patch.

Patches are narrow compared with their distance d, so the displacement u per force is that between the centres of
strips, and of rows, whose lengths along the meridian are L:

    K_rr' = L_r L_r' u(d; z_r, z_r'),      weak gap of a cell of row r: w sum_r' K_rr' w' sum_c p'_cr',

w, w' the widths of strips of both. u is tabulated for the surface over ln d and both z, with cubic interpolation in ln
d and linear interpolation in z.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry, PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.kinematics.closest_point import has_cells
from warpffrf_kernels.kinematics.line_of_centres import wrap
from warpffrf_kernels.patch.cells import row_place
from warpffrf_kernels.patch.far_splines import beside_block, turned_column
from warpffrf_kernels.patch.near import cubic_shares
from warpffrf_kernels.patch.spline_tables import real_side
from warpffrf_kernels.surfaces.smooth import radius_of

wp.set_module_options(MODULE_OPTIONS)

ROWS = 21  # values of z in a table, evenly spaced over the width
LEVEL = 0.12  # of ln d, between levels: the error of cubic interpolation is 1e-5 of 1/d
HEIGHTS = wp.constant(ROWS)
STEP = wp.constant(wp.float64(LEVEL))


@wp.func
def force_displacement(elements: Elements, table: int, d: real, z: real, source: real) -> real:
    """u [m/N] at z [m] of a force at `source` [m], d [m] away along the circle; zero beyond the table."""
    levels = elements.patches.between_levels[table]
    x = wp.max((wp.log(d) - elements.patches.between_first[table]) / STEP, real(0.0))
    if x > real(levels - 2):
        return real(0.0)
    first = wp.clamp(int(wp.floor(x)) - 1, 0, levels - 4)
    c = cubic_shares(x - real(first))
    pitch = (elements.patches.between_high[table] - elements.patches.between_low[table]) / real(HEIGHTS - 1)
    a = wp.clamp((z - elements.patches.between_low[table]) / pitch, real(0.0), real(HEIGHTS - 1))
    b = wp.clamp((source - elements.patches.between_low[table]) / pitch, real(0.0), real(HEIGHTS - 1))
    i = wp.min(int(wp.floor(a)), HEIGHTS - 2)
    j = wp.min(int(wp.floor(b)), HEIGHTS - 2)
    a = a - real(i)
    b = b - real(j)
    start = elements.patches.between_start[table] + (first * HEIGHTS + i) * HEIGHTS + j
    total = real(0.0)
    for level in range(4):
        at = start + level * HEIGHTS * HEIGHTS
        low = (real(1.0) - b) * elements.patches.between[at] + b * elements.patches.between[at + 1]
        at += HEIGHTS
        high = (real(1.0) - b) * elements.patches.between[at] + b * elements.patches.between[at + 1]
        total += c[level] * ((real(1.0) - a) * low + a * high)
    return total


@wp.func
def way_between(
    model: Model,
    w: int,
    s: int,
    z: real,
    pair: int,
    side: int,
    other: int,
    there: int,
    patch_place: wp.array3d(dtype=real),
) -> real:
    """d [m] along the circle of surface `s` at `z` between the centres of two patches, the shorter way round."""
    columns = patch_place[w, pair, 3 * side] - patch_place[w, other, 3 * there]
    if model.surfaces.turn[s] > 0:
        columns = wrap(columns, real(model.surfaces.turn[s]), real(0.0))
    return wp.abs(columns) * model.surfaces.pitch[s] * radius_of(model, s, z)


@kernel
def lay_between(run: Run, geometry: ContactGeometry, patch: PatchScratch):
    """Per (world, pair of family 2), lanes over entries: K of its rows due to those of all neighbouring patches, and
    where the blocks between their columns of splines begin in `beside`; -1 outside a grid."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not has_cells(model, w, pair, geometry):
        return
    elements = model.elements[0]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    for side in range(2):
        e = elements.patches.beside_start[2 * pair + side]
        while e < elements.patches.beside_start[2 * pair + side + 1]:
            table = elements.patches.beside_between[e]
            other = elements.patches.beside_side[e] / 2
            there = elements.patches.beside_side[e] % 2
            s = real_side(elements, pair, side)
            r = real_side(elements, other, there)
            wide = elements.patches.far_columns_most
            columns = patch.far_window[w, other, there, 1]
            n = lane
            while n < patch.far_window[w, pair, side, 1] * columns:
                facing = turned_column(model, s, patch.far_window[w, pair, side, 0] + n / columns)
                loading = turned_column(model, r, patch.far_window[w, other, there, 0] + n % columns)
                at = int(-1)
                if facing >= 0 and loading >= 0:
                    at = beside_block(
                        model, elements, elements.patches.beside_table[e], model.surfaces.rows[s],
                        model.surfaces.rows[r], facing, loading,
                    )  # fmt: skip
                patch.beside_at[w, e, n / columns * wide + n % columns] = at
                n += wp.block_dim()
            if table >= 0:
                lines = model.surfaces.rows[model.pairs.first[other]]
                middle = real(0.5) * (elements.patches.between_low[table] + elements.patches.between_high[table])
                d = way_between(model, w, s, middle, pair, side, other, there, patch.patch_place)
                n = lane
                while n < rows * lines:
                    target = row_place(elements, pair, n / lines, patch.patch_place, w)
                    source = row_place(elements, other, n % lines, patch.patch_place, w)
                    z = elements.patches.row_sign[2 * pair + side] * target[0]
                    z += elements.patches.row_offset[2 * pair + side]
                    z_source = elements.patches.row_sign[2 * other + there] * source[0]
                    z_source += elements.patches.row_offset[2 * other + there]
                    u = force_displacement(elements, table, d, z, z_source)
                    patch.patch_between[w, e, n] = target[1] * source[1] * u
                    n += wp.block_dim()
            e += 1


# Adds the weak displacement of the cells by the half-space due to pressures at places of neighbouring patches: K of
# their rows times the sums of these, and the widths of strips of both. Lanes over rows.
@wp.func_native("""
    const int rows = model.surfaces.rows.data[model.pairs.first.data[pair]], places = elements.patches.places;
    const int columns = elements.patches.columns.data[pair], wide = patch_place.shape[2];
    const size_t first = (size_t)w * model.pairs.count, size = patch_between.shape[2];
    const int begin = elements.patches.beside_start.data[2 * pair];
    const int end = elements.patches.beside_start.data[2 * pair + 2];
    double* const u = value.data + (first + pair) * model.window.grid_nodes;
    const double own = 2.0 * patch_place.data[(first + pair) * wide + 2] / columns;
    WP_TILE_SYNC();
    for (int e = begin; e < end; ++e) {
        if (elements.patches.beside_between.data[e] < 0) continue;
        const int other = elements.patches.beside_side.data[e] / 2, its = elements.patches.columns.data[other];
        const int lines = model.surfaces.rows.data[model.pairs.first.data[other]], line = (lines + 7) / 8 * 8;
        const double widths = own * 2.0 * patch_place.data[(first + other) * wide + 2] / its;
        const double* const q = pressure.data + (first + other) * places;
        const double* const K = patch_between.data + ((size_t)w * patch_between.shape[1] + e) * size;
        for (int k = 0; k < lines; ++k) {
            double load = 0.0;
            for (int c = 0; c < its; ++c) load += q[c * line + k];
            if (load == 0.0) continue;
            for (int r = WP_TILE_THREAD_IDX; r < rows; r += WP_TILE_BLOCK_DIM) {
                const double shift = widths * K[r * lines + k] * load;
                for (int c = 0; c < columns; ++c) u[c * rows + r] += shift;
            }
        }
    }
    WP_TILE_SYNC();
""")
def add_half_space(
    model: Model,
    elements: Elements,
    w: int,
    pair: int,
    patch_between: wp.array3d(dtype=real),
    patch_place: wp.array3d(dtype=real),
    pressure: wp.array(dtype=real),
    value: wp.array(dtype=real),
): ...
