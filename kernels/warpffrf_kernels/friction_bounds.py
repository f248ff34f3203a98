"""Bounds mu p of the cells, p the exact mean of the pressure over a cell: sliding transmits mu times the load.

Around, the hats of three columns have the parts 1/8, 6/8 and 1/8 of a cell; along the meridian, each half of a cell,
half way to the next node, holds 3/4 of its own node and 1/4 of that one.
"""

import warp as wp

from warpffrf_kernels import control as k
from warpffrf_kernels.friction_geometry import cell_at
from warpffrf_kernels.model import Model
from warpffrf_kernels.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def mean_in_row(
    model: Model,
    s: int,
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    w: int,
    pair: int,
    column: int,
    row: int,
    rows: int,
) -> real:
    """Mean over the height of a cell of the pressure at a column of the window: linear between the nodes."""
    if column < 0 or column >= model.window_columns:
        return real(0.0)
    m = column * rows + row
    middle = real(0.0)
    if active[w, pair, m] != 0:
        middle = pressure[w, pair, m]
    z0 = model.surface_z_start[s]
    total = real(0.0)
    length = real(0.0)
    for side in range(2):
        other = row - 1 + 2 * side
        if other >= 0 and other < rows:
            beside = real(0.0)
            n = column * rows + other
            if active[w, pair, n] != 0:
                beside = pressure[w, pair, n]
            half = wp.abs(model.surface_z[z0 + other] - model.surface_z[z0 + row])
            total += half * (real(0.75) * middle + real(0.25) * beside)
            length += half
    return total / length


@wp.func
def cell_bound(
    model: Model, active: wp.array3d(dtype=int), pressure: wp.array3d(dtype=real), w: int, pair: int, m: int
) -> real:
    """Bound mu times the mean pressure of a cell [Pa]: around, a hat function has 1/8, 6/8, 1/8 of its three nodes."""
    A = model.pair_first[pair]
    rows = model.surface_rows[A]
    column = m / rows
    row = m % rows
    mean = real(0.75) * mean_in_row(model, A, active, pressure, w, pair, column, row, rows)
    mean += real(0.125) * mean_in_row(model, A, active, pressure, w, pair, column - 1, row, rows)
    mean += real(0.125) * mean_in_row(model, A, active, pressure, w, pair, column + 1, row, rows)
    return model.pair_friction[pair] * wp.max(mean, real(0.0))


@wp.kernel
def bound_cells(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    window: wp.array3d(dtype=int),
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    cell_area: wp.array3d(dtype=real),
    clip: int,
    bound: wp.array3d(dtype=real),
    traction: wp.array3d(dtype=real),
):
    """Per (world, pair), lanes over cells: the bounds of the present pressures; with `clip` tractions beyond them are
    cut. Friction acts in dynamic steps only: a static state or a start has no slip to speak of."""
    w, pair, lane = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or model.pair_friction[pair] == real(0.0):
        return
    if (clip != 0 and ctl[w, k.MOVED] == 0) or (clip == 0 and ctl[w, k.CHANGES] != 0):
        return
    rows = model.surface_rows[model.pair_first[pair]]
    H = model.half_window
    m = lane
    while m < model.window_columns * rows:
        value = real(0.0)
        o = m / rows - H
        if o >= window[w, pair, 0] and o <= window[w, pair, 1] and ctl[w, k.MODE] == k.DYNAMIC:
            if cell_area[w, pair, m] > real(0.0):
                value = cell_bound(model, active, pressure, w, pair, m)
        bound[w, pair, m] = value
        if clip != 0:
            i = cell_at(rows, m, 0)
            j = cell_at(rows, m, 1)
            size = wp.sqrt(traction[w, pair, i] * traction[w, pair, i] + traction[w, pair, j] * traction[w, pair, j])
            if size > value:
                traction[w, pair, i] = traction[w, pair, i] * value / size
                traction[w, pair, j] = traction[w, pair, j] * value / size
        m += wp.block_dim()
