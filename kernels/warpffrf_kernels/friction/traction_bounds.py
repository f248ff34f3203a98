r"""Bounds mu p of the cells, and the resistance of cells that the patch has reached during the step.

**Bound.** The pressure of a node is tent-shaped, the traction of a cell constant. With f_i the coefficient of the node,
times the part of its shape function that faces the second surface, the mean of the tents over the cell of a node is, in
one direction with equally spaced neighbours, (f_- + 6 f_0 + f_+)/8. The bound is half way between the node and that
mean,

    b_i = mu (f_i + sum_j c_ij (f_j - f_i)),      c_ij A_i = c_ji A_j,      c = 1/16 for equal cells,

an exchange between neighbours along both directions, which keeps the sum of f_i A_i: in sliding, mu times the load is
transmitted. A cell next to the last node under pressure thereby has a small bound. With the value at the node, the
bound of the outermost cells jumps as the patch moves relative to the grid, and the loss of a loading cycle, which
occurs in the outermost cells, is up to ten per cent low; with the mean it is as much too high.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells
from warpffrf_kernels.core.integration import is_whole
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.state import ContactState, FrictionState
from warpffrf_kernels.friction.cells import cell_at, rubs_on_grid

wp.set_module_options(MODULE_OPTIONS)

SPREAD = wp.constant(wp.float64(1.0 / 16.0))  # c of equal neighbours: half of the 1/8 of the mean over the cell


@wp.func
def pressed(
    model: Model, w: int, pair: int, m: int, low: int, high: int, contact: ContactState, cells: FrictionCells,
    geometry: ContactGeometry,
) -> real:  # fmt: skip
    """Pressure of the node of cell m times its facing part [Pa]; -1 if no cell of the window there faces the second
    surface."""
    if m < low or m > high:
        return real(-1.0)
    if not (cells.cell_area[w, pair, m] > real(0.0) and geometry.area[w, pair, m] > real(0.0)):
        return real(-1.0)
    if contact.active[w, pair, m] == 0:
        return real(0.0)
    return wp.max(contact.pressure[w, pair, m], real(0.0)) * geometry.area[w, pair, m] / cells.cell_area[w, pair, m]


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


@kernel
def bound_cells(
    run: Run, geometry: ContactGeometry, contact: ContactState, cells: FrictionCells, friction: FrictionState, clip: int
):
    """Per (world, pair), lanes over cells: the bounds [Pa] of the present pressures; with `clip`, tractions are cut to
    them. Friction acts in time steps and load steps: a first equilibrium or a start has no significant slip."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or not rubs_on_grid(model, pair):
        return
    if (clip != 0 and run.ctl[w].moved == 0) or (clip == 0 and run.ctl[w].changes != 0):
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    z0 = model.surfaces.z_start[model.pairs.first[pair]]
    H = model.window.half
    low = (geometry.window[w, pair, 0] + H) * rows
    high = (geometry.window[w, pair, 1] + H + 1) * rows - 1
    m = lane
    while m < model.window.columns * rows:
        value = real(0.0)
        here = pressed(model, w, pair, m, low, high, contact, cells, geometry)
        if here >= real(0.0) and is_whole(run.ctl, w):
            value = here
            for side in range(2):
                step = 2 * side - 1
                there = pressed(model, w, pair, m + step * rows, low, high, contact, cells, geometry)
                if there >= real(0.0):
                    value += SPREAD * (there - here)
                row = m % rows + step
                if row >= 0 and row < rows:
                    there = pressed(model, w, pair, m + step, low, high, contact, cells, geometry)
                    if there >= real(0.0):
                        value += exchanged(model, z0, rows, m % rows, row) * (there - here)
            value = model.pairs.friction[pair] * value
        cells.bound[w, pair, m] = value
        if clip != 0:
            i = cell_at(rows, m, 0)
            j = cell_at(rows, m, 1)
            size = wp.sqrt(
                friction.traction[w, pair, i] * friction.traction[w, pair, i]
                + friction.traction[w, pair, j] * friction.traction[w, pair, j]
            )
            if size > value:
                friction.traction[w, pair, i] = friction.traction[w, pair, i] * value / size
                friction.traction[w, pair, j] = friction.traction[w, pair, j] * value / size
        m += wp.block_dim()
