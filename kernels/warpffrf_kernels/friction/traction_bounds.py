r"""Bounds mu p of the cells, and how far a cell resists that the patch has reached during the step.

**Bound.** A hat's pressure is tent-shaped, a cell's traction constant. With f_i the coefficient of the hat of a node,
times the part of the hat that faces the second surface, the mean of the tents over the cell of a node is, in one
direction with neighbours equally far, (f_- + 6 f_0 + f_+)/8. The bound goes half the way from the node to that mean,

    b_i = mu (f_i + sum_j c_ij (f_j - f_i)),      c_ij A_i = c_ji A_j,      c = 1/16 where cells are alike,

an exchange between neighbours along both directions, which keeps the sum of f_i A_i: sliding transmits mu times the
load. A cell beside the last hat under pressure thereby has a small bound. At the node alone the bound of the outermost
cells jumps as the patch moves against the grid, and the loss of a loading cycle, made in the outermost cells, is up to
ten per cent low; at the mean it is as much high.
"""

import warp as wp

from warpffrf_kernels.core.access import inout, out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.integration import is_whole
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.friction.cells import cell_at, rubs_on_grid

wp.set_module_options(MODULE_OPTIONS)

SPREAD = wp.constant(wp.float64(1.0 / 16.0))  # c of like neighbours: half of the 1/8 of the mean over the cell


@wp.func
def pressed(
    model: Model,
    w: int,
    pair: int,
    m: int,
    low: int,
    high: int,
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    cell_area: wp.array3d(dtype=real),
    area: wp.array3d(dtype=real),
) -> real:
    """Pressure of the hat of cell m times its facing part [Pa]; -1 where there is no cell of the window that faces the
    second surface."""
    if m < low or m > high:
        return real(-1.0)
    if not (cell_area[w, pair, m] > real(0.0) and area[w, pair, m] > real(0.0)):
        return real(-1.0)
    if active[w, pair, m] == 0:
        return real(0.0)
    return wp.max(pressure[w, pair, m], real(0.0)) * area[w, pair, m] / cell_area[w, pair, m]


@wp.func
def exchanged(model: Model, z0: int, rows: int, row: int, other: int) -> real:
    """c of neighbouring rows: SPREAD h g/A_row, h their distance, g the mean area of both per length of cell."""
    h = wp.abs(model.surfaces.z[z0 + other] - model.surfaces.z[z0 + row])
    g = real(0.0)
    for i in range(2):
        r = row
        if i == 1:
            r = other
        span = real(0.5) * (model.surfaces.z[z0 + wp.min(r + 1, rows - 1)] - model.surfaces.z[z0 + wp.max(r - 1, 0)])
        g += real(0.5) * model.surfaces.cell_area[z0 + r] / span
    return SPREAD * h * g / model.surfaces.cell_area[z0 + row]


@wp.kernel
def bound_cells(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    window: wp.array3d(dtype=int),
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    cell_area: wp.array3d(dtype=real),
    area: wp.array3d(dtype=real),
    clip: int,
    bound: out(wp.array3d(dtype=real)),
    traction: inout(wp.array3d(dtype=real)),
):
    """Per (world, pair), lanes over cells: the bounds [Pa] of the present pressures; with `clip` tractions beyond them
    are cut. Friction acts in steps in time and load steps: a first equilibrium or a start has no slip to speak of."""
    w, pair, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or not rubs_on_grid(model, pair):
        return
    if (clip != 0 and ctl[w].moved == 0) or (clip == 0 and ctl[w].changes != 0):
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    z0 = model.surfaces.z_start[model.pairs.first[pair]]
    H = model.window.half
    low = (window[w, pair, 0] + H) * rows
    high = (window[w, pair, 1] + H + 1) * rows - 1
    m = lane
    while m < model.window.columns * rows:
        value = real(0.0)
        here = pressed(model, w, pair, m, low, high, active, pressure, cell_area, area)
        if here >= real(0.0) and is_whole(ctl, w):
            value = here
            for side in range(2):
                step = 2 * side - 1
                there = pressed(model, w, pair, m + step * rows, low, high, active, pressure, cell_area, area)
                if there >= real(0.0):
                    value += SPREAD * (there - here)
                row = m % rows + step
                if row >= 0 and row < rows:
                    there = pressed(model, w, pair, m + step, low, high, active, pressure, cell_area, area)
                    if there >= real(0.0):
                        value += exchanged(model, z0, rows, m % rows, row) * (there - here)
            value = model.pairs.friction[pair] * value
        bound[w, pair, m] = value
        if clip != 0:
            i = cell_at(rows, m, 0)
            j = cell_at(rows, m, 1)
            size = wp.sqrt(traction[w, pair, i] * traction[w, pair, i] + traction[w, pair, j] * traction[w, pair, j])
            if size > value:
                traction[w, pair, i] = traction[w, pair, i] * value / size
                traction[w, pair, j] = traction[w, pair, j] * value / size
        m += wp.block_dim()
