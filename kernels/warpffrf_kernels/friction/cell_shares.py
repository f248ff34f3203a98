"""Overlap of the cells of the first surface with those of the second.

The mean of a displacement over a cell of the first grid is the difference of its integral between the cell's two ends.
The integral is known at the edges of the second grid's cells. Linear interpolation between them would give the parts of
the overlapping areas, and on grids half a cell apart the second body would be too stiff. A cubic through four edges is
exact for quadratic displacements. Along the meridian, where tractions change little between rows, the parts are the
overlaps. For grids rotated relative to each other, the cell's extents are used (root of the squares of its sides'
projections, exact at right angles). The transposed parts distribute the traction of a cell, so loads and displacements
are conjugate.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.friction.cells import rubs_on_grid
from warpffrf_kernels.kinematics.line_of_centres import wrap
from warpffrf_kernels.normal.contact_compliance import node_of
from warpffrf_kernels.surfaces.smooth import radius_of

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def lower_edge(model: Model, s: int, row: int) -> real:
    """Lower edge of the cells of a row: half way to the next node, or the outermost node."""
    z0 = model.surfaces.z_start[s]
    return real(0.5) * (model.surfaces.z[z0 + wp.max(row - 1, 0)] + model.surfaces.z[z0 + row])


@wp.func
def overlap(low: real, high: real, a: real, b: real) -> real:
    return wp.max(wp.min(high, b) - wp.max(low, a), real(0.0))


@wp.func
def reached(y: real, j: int) -> real:
    """Derivative, with respect to the mean over cell j in [j, j + 1], of the integral up to y: cubic between edges."""
    k_low = int(wp.floor(y))
    f = y - real(k_low)
    above = (f + real(1.0)) * f * (f - real(1.0)) / real(6.0)
    if j > k_low + 1:
        return real(0.0)
    if j == k_low + 1:
        return above
    above -= (f + real(1.0)) * f * (f - real(2.0)) / real(2.0)
    if j == k_low:
        return above
    if j == k_low - 1:
        return above + (f + real(1.0)) * (f - real(1.0)) * (f - real(2.0)) / real(2.0)
    return real(1.0)


@kernel
def spread_cells(run: Run, geometry: ContactGeometry, cells: FrictionCells):
    """Per (world, pair), lanes over cells: the parts of a cell on the cells of the second grid; 0 beyond the second
    window, which only cells far from any patch reach (their nodes would have failed the step, `keep_node`)."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not rubs_on_grid(model, pair):
        return
    A = model.pairs.first[pair]
    B = model.pairs.second[pair]
    if model.surfaces.shear_start[B] < 0:
        return
    rows = model.surfaces.rows[A]
    rows_b = model.surfaces.rows[B]
    z0 = model.surfaces.z_start[A]
    H = model.window.half
    m = (geometry.window[w, pair, 0] + H) * rows + lane
    while m < (geometry.window[w, pair, 1] + H + 1) * rows:
        row = m % rows
        z = model.surfaces.z[z0 + row]
        zb = cells.cell_place[w, pair, m, 1]
        metric = model.surfaces.pitch[B] * radius_of(model, B, zb)
        half_around = real(0.5) * model.surfaces.pitch[A] * radius_of(model, A, z)
        below = lower_edge(model, A, row) - z
        above = real(0.0)
        if row + 1 < rows:
            above = lower_edge(model, A, row + 1) - z
        # the cell's rectangle, rotated by Q: its extents along the second surface's tangents, and its centre
        half_along = real(0.5) * (above - below)
        middle = real(0.5) * (above + below)
        q_1 = cells.cell_turn[w, pair, m, 0]
        q_2 = cells.cell_turn[w, pair, m, 1]
        q_3 = cells.cell_turn[w, pair, m, 2]
        q_4 = cells.cell_turn[w, pair, m, 3]
        x = cells.cell_place[w, pair, m, 0] + model.surfaces.side[B] * q_3 * middle / metric
        if model.surfaces.turn[B] > 0:
            x = wrap(x, real(model.surfaces.turn[B]), real(geometry.center[w, pair, 1]))
        half = wp.sqrt(q_1 * q_1 * half_around * half_around + q_3 * q_3 * half_along * half_along) / metric
        first = int(wp.floor(x - half + real(0.5))) - 1
        reach = wp.sqrt(q_2 * q_2 * half_around * half_around + q_4 * q_4 * half_along * half_along)
        low = zb + q_4 * middle - reach
        high = zb + q_4 * middle + reach
        start = int(0)
        while start + 1 < rows_b and lower_edge(model, B, start + 1) <= low:
            start += 1
        start = wp.max(wp.min(start, rows_b - model.window.share_rows), 0)
        at = first - (geometry.center[w, pair, 1] - model.window.second_half)
        c = int(0)
        while c < model.window.share_columns:
            around = reached(x + half + real(0.5), first + c) - reached(x - half + real(0.5), first + c)
            around = around / (real(2.0) * half)
            q = int(0)
            while q < model.window.share_rows:
                value = real(0.0)
                inside = start + q < rows_b and at + c >= 0 and at + c < model.window.second_columns
                if inside and cells.cell_area[w, pair, m] > real(0.0):
                    top = model.surfaces.z[model.surfaces.z_start[B] + rows_b - 1]
                    if start + q + 1 < rows_b:
                        top = lower_edge(model, B, start + q + 1)
                    value = around * overlap(low, high, lower_edge(model, B, start + q), top) / (high - low)
                cells.share[w, pair, m, c * model.window.share_rows + q] = value
                q += 1
            c += 1
        cells.share_at[w, pair, m, 0] = at
        cells.share_at[w, pair, m, 1] = start
        m += wp.block_dim()


@wp.func
def on_shares(model: Model, w: int, pair: int, m: int, cells: FrictionCells, second: wp.array(dtype=real)) -> vec3:
    """Q o u_B: mean of the second surface's displacement over cell m, along the first one's tangents (two entries)."""
    rows_b = model.surfaces.rows[model.pairs.second[pair]]
    base_b = (w * model.pairs.count + pair) * 2 * model.window.nodes
    v_1 = real(0.0)
    v_2 = real(0.0)
    c = int(0)
    while c < model.window.share_columns:
        at_c = cells.share_at[w, pair, m, 0] + c
        q = int(0)
        while q < model.window.share_rows:
            part = cells.share[w, pair, m, c * model.window.share_rows + q]
            at_r = cells.share_at[w, pair, m, 1] + q
            if part != real(0.0):
                e = base_b + at_c * 2 * rows_b + at_r
                v_1 += part * second[e]
                v_2 += part * second[e + rows_b]
            q += 1
        c += 1
    u_1 = cells.cell_turn[w, pair, m, 0] * v_1 + cells.cell_turn[w, pair, m, 1] * v_2
    u_2 = cells.cell_turn[w, pair, m, 2] * v_1 + cells.cell_turn[w, pair, m, 3] * v_2
    return vec3(u_1, u_2, real(0.0))


# out += part area Q o u_B of the first `count` active cells of a pair, two numbers each, as in `on_shares`; lanes over
# the cells. Native, as the inner loop of two assemblies.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair, cells = here * model.window.grid_nodes;
    const int SC = model.window.share_columns, SR = model.window.share_rows;
    const int rows_b = model.surfaces.rows.data[model.pairs.second.data[pair]];
    const int* mine = cell_slot.data + here * model.capacity.cells;
    const double* u = second.data + at_second; double* x = y.data + at_y;
    WP_TILE_SYNC();
    for (int j = WP_TILE_THREAD_IDX; j < count; j += WP_TILE_BLOCK_DIM) {
        const size_t m = cells + mine[j];
        const double *o = share.data + m * SC * SR, *turn = cell_turn.data + m * 4;
        const int* at = share_at.data + m * 2;
        const double* v = u + (size_t)at[0] * 2 * rows_b + at[1];
        const double f = part * cell_area.data[m];
        double v_1 = 0.0, v_2 = 0.0;
        for (int c = 0; c < SC; ++c) for (int q = 0; q < SR; ++q) {
            const double a = o[c * SR + q];
            if (a == 0.0) continue;
            v_1 += a * v[c * 2 * rows_b + q]; v_2 += a * v[c * 2 * rows_b + rows_b + q];
        }
        x[2 * j] += f * (turn[0] * v_1 + turn[1] * v_2); x[2 * j + 1] += f * (turn[2] * v_1 + turn[3] * v_2);
    }
    WP_TILE_SYNC();
""")
def add_on_shares(
    model: Model,
    w: int,
    pair: int,
    count: int,
    part: real,
    cell_slot: wp.array3d(dtype=int),
    cell_area: wp.array3d(dtype=real),
    cell_turn: wp.array4d(dtype=real),
    share: wp.array4d(dtype=real),
    share_at: wp.array4d(dtype=int),
    second: wp.array(dtype=real),
    at_second: int,
    y: wp.array(dtype=real),
    at_y: int,
): ...


@wp.func
def line_of(model: Model, s: int, column: int, line: int) -> int:
    """Line of `mode_tangent` of a grid column counted over full revolutions; -1 outside the grid."""
    node = node_of(model, s, column, 0)
    if node < 0:
        return -1
    return 2 * node + line
