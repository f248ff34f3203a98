r"""The half-space between two patches of one surface: weak displacement of a row of cells due to one of another patch.

Patches are narrow compared with their distance d, so the displacement u per force is that between the centres of
strips, and of rows, whose lengths along the meridian are L:

    K_rr' = L_r L_r' u(d; z_r, z_r'),      weak gap of a cell of row r: w sum_r' K_rr' w' sum_c p'_cr',

w, w' the widths of strips of both. u is tabulated for the surface over ln d and both z, with cubic interpolation in ln
d and linear interpolation in z.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import ContactFields, PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import PATCH, Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync
from warpffrf_kernels.kinematics.line_of_centres import wrap
from warpffrf_kernels.normal.lagged import PATCHES_ALONE, lags
from warpffrf_kernels.patch.cells import row_place
from warpffrf_kernels.patch.fields import add_splines, beside_field, half_of, real_side, rows_of
from warpffrf_kernels.patch.near import cubic_shares
from warpffrf_kernels.patch.spline_tables import line_of
from warpffrf_kernels.surfaces.fields import clear_field
from warpffrf_kernels.surfaces.surface import radius_of

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
def strip_width(elements: Elements, w: int, pair: int, patch_place: wp.array3d(dtype=real)) -> real:
    """Width [m] of the strips of a patch."""
    return real(2.0) * patch_place[w, pair, 2] / real(elements.patches.columns[pair])


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
def lay_between(run: Run, patch: PatchScratch):
    """Per (world, pair of family 2), lanes over entries: K of its rows due to those of all neighbouring patches."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or model.pairs.family[pair] != PATCH:
        return
    elements = model.elements[0]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    for side in range(2):
        e = elements.patches.beside_start[2 * pair + side]
        while e < elements.patches.beside_start[2 * pair + side + 1]:
            table = elements.patches.beside_between[e]
            if table >= 0:
                other = elements.patches.beside_side[e] / 2
                there = elements.patches.beside_side[e] % 2
                lines = model.surfaces.rows[model.pairs.first[other]]
                s = real_side(elements, pair, side)
                middle = real(0.5) * (elements.patches.between_low[table] + elements.patches.between_high[table])
                d = way_between(model, w, s, middle, pair, side, other, there, patch.patch_place)
                n = lane
                while n < rows * lines:
                    target = row_place(elements, pair, n / lines, patch.patch_place, w)
                    source = row_place(elements, other, n % lines, patch.patch_place, w)
                    z = elements.patches.row_sign[2 * pair + side] * target[0]
                    z += elements.patches.row_offset[2 * pair + side]
                    at = elements.patches.row_sign[2 * other + there] * source[0]
                    at += elements.patches.row_offset[2 * other + there]
                    u = force_displacement(elements, table, d, z, at)
                    patch.patch_between[w, e, n] = target[1] * source[1] * u
                    n += wp.block_dim()
            e += 1


@wp.func
def add_half_space(
    model: Model, elements: Elements, w: int, pair: int, lane: int, patch: PatchScratch, value: wp.array(dtype=real)
):
    """Adds the weak displacement of the cells by the half-space due to neighbouring patches. Lanes over rows."""
    rows = model.surfaces.rows[model.pairs.first[pair]]
    row = lane
    while row < rows:
        total = real(0.0)
        e = elements.patches.beside_start[2 * pair]
        while e < elements.patches.beside_start[2 * pair + 2]:
            if elements.patches.beside_between[e] >= 0:
                other = elements.patches.beside_side[e] / 2
                lines = model.surfaces.rows[model.pairs.first[other]]
                strip = strip_width(elements, w, other, patch.patch_place)
                line = int(0)
                while line < lines:
                    load = real(0.0)
                    column = int(0)
                    while column < elements.patches.columns[other]:
                        load += patch.patch_pressure[w, other, column * line_of(lines) + line]
                        column += 1
                    total += patch.patch_between[w, e, row * lines + line] * strip * load
                    line += 1
            e += 1
        total *= strip_width(elements, w, pair, patch.patch_place)
        column = int(0)
        while column < elements.patches.columns[pair]:
            m = (w * model.pairs.count + pair) * model.window.grid_nodes + column * rows + row
            value[m] = value[m] + total
            column += 1
        row += wp.block_dim()


@kernel
def add_between(run: Run, patch: PatchScratch, fields: ContactFields):
    """Per (world, pair of family 2), lanes over rows: weak displacement by the half-space due to the pressures of the
    neighbouring patches."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or model.pairs.family[pair] != PATCH or lags(model, run.ctl, w):
        return
    add_half_space(model, model.elements[0], w, pair, lane, patch, fields.first_local)


@kernel
def keep_beside(run: Run, patch: PatchScratch, fields: ContactFields):
    """Per (world, pair of family 2), lanes over splines, then cells: weak displacement due to the pressures of the
    neighbouring patches at the evaluation, stored for the correction of the set (`normal.lagged`)."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or model.pairs.family[pair] != PATCH:
        return
    if model.pairs.beside != PATCHES_ALONE or run.ctl[w].mode != k.DYNAMIC:
        return
    elements = model.elements[0]
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            rows = model.surfaces.rows[s]
            start = half_of(model, elements, w, pair, side)
            n = lane
            while n < patch.far_window[w, pair, side, 1] * rows:
                patch.far_others[start + n] = beside_field(model, elements, w, pair, side, rows, n, patch)
                if lags(model, run.ctl, w):
                    patch.far_field[start + n] = patch.far_field[start + n] + patch.far_others[start + n]
                n += wp.block_dim()
    first = (w * model.pairs.count + pair) * model.window.grid_nodes
    clear_field(lane, model.window.grid_nodes, first, patch.beside_local)
    sync()
    add_splines(
        model, elements, w, pair, model.surfaces.rows[model.pairs.first[pair]], rows_of(model, elements, pair, 0),
        rows_of(model, elements, pair, 1), patch.far_strip, patch.far_share, patch.far_others, patch.beside_local,
    )  # fmt: skip
    sync()
    add_half_space(model, elements, w, pair, lane, patch, patch.beside_local)
    sync()
    if lags(model, run.ctl, w):
        axpy(model.window.grid_nodes, real(1.0), patch.beside_local, first, fields.first_local, first)


@kernel
def add_kept(run: Run, patch: PatchScratch, fields: ContactFields):
    """Per (world, pair of family 2): adds the displacement due to the neighbouring patches at the evaluation."""
    w, pair, _lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or model.pairs.family[pair] != PATCH or not lags(model, run.ctl, w):
        return
    first = (w * model.pairs.count + pair) * model.window.grid_nodes
    axpy(model.window.grid_nodes, real(1.0), patch.beside_local, first, fields.first_local, first)
