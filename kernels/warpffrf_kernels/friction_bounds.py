"""Bounds mu p of the cells, p the pressure at the centre of a cell: the coefficient of the hat of the same node.

Hats and cells of a node have the same area; where the second surface ends, a hat presses with the part that faces it,
and the bound has the same part: sliding transmits mu times the load. The mean of the pressure over
a cell does so too, but reaches half a cell beyond the patch: Carter's force is then 7 % high at eight cells in a
half-width, where the centre leaves 2 %.
"""

import warp as wp

from warpffrf_kernels import control as k
from warpffrf_kernels.friction_geometry import cell_at
from warpffrf_kernels.model import Model
from warpffrf_kernels.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


@wp.kernel
def bound_cells(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    window: wp.array3d(dtype=int),
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    cell_area: wp.array3d(dtype=real),
    area: wp.array3d(dtype=real),
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
            if cell_area[w, pair, m] > real(0.0) and active[w, pair, m] != 0:
                facing = area[w, pair, m] / cell_area[w, pair, m]
                value = model.pair_friction[pair] * facing * wp.max(pressure[w, pair, m], real(0.0))
        bound[w, pair, m] = value
        if clip != 0:
            i = cell_at(rows, m, 0)
            j = cell_at(rows, m, 1)
            size = wp.sqrt(traction[w, pair, i] * traction[w, pair, i] + traction[w, pair, j] * traction[w, pair, j])
            if size > value:
                traction[w, pair, i] = traction[w, pair, i] * value / size
                traction[w, pair, j] = traction[w, pair, j] * value / size
        m += wp.block_dim()
