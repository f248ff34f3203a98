"""Rows of the local compliance G between pairs that load the same surface, through its local modes.

Where a surface s serves the pairs of two hats i and j, with psi^s the load of a hat on it,

    G_ij += psi_j^s . (D_s psi_i^s),

exactly, with all nodes of both stencils: a load counted at the middle of its hat makes G indefinite where the patches
of two pairs lie within some columns of each other. D_s psi_i^s is laid out once a hat over the window of the other
pair, by the tables of `shared_surface`, and read by all hats of that pair.
"""

import warp as wp

from warpffrf_kernels.core.access import changed, inout
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync
from warpffrf_kernels.normal.contact_compliance import place_in_table
from warpffrf_kernels.surfaces.neighbours import first_column, nearest_turn

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def table_between(model: Model, reads: int, loads: int) -> int:
    """Where the table begins of what surface number `reads` sees of loads on number `loads`, the same surface."""
    n = model.shared.start[reads]
    while model.shared.neighbour[n] != loads:
        n += 1
    return model.shared.table[n]


@wp.func
def lay_out(
    model: Model,
    w: int,
    pair: int,
    m: int,
    surface: int,
    reads: int,
    low: int,
    columns: int,
    center: wp.array3d(dtype=int),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    start: int,
    field: wp.array(dtype=real),
):
    """Adds to `field`, `columns` of the window of surface number `reads` from `low` on, what hat m of `pair` displaces
    by its load on `surface`."""
    rows = model.surfaces.rows[surface]
    target = first_column(model, w, reads, center) + low
    middle = target + columns / 2
    table = table_between(model, reads, surface)
    origin = first_column(model, w, surface, center)
    if surface % 2 == 0:
        at = place_in_table(model, surface, nearest_turn(model, surface, origin + m / rows, middle), m % rows, target)
        if at >= 0:
            axpy(columns * rows, real(1.0), model.shared.compliance, table + at, field, start)
    else:
        e = int(0)
        while e < model.window.stencil_columns * model.window.stencil_rows:
            weight = stencil[w, pair, m, e]
            if weight != real(0.0):
                column = origin + stencil_at[w, pair, m, 0] + e / model.window.stencil_rows
                row = stencil_at[w, pair, m, 1] + e % model.window.stencil_rows
                at = place_in_table(model, surface, nearest_turn(model, surface, column, middle), row, target)
                if at >= 0:
                    axpy(columns * rows, weight, model.shared.compliance, table + at, field, start)
            e += 1


@wp.kernel
def assemble_shared(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    center: wp.array3d(dtype=int),
    second_window: wp.array3d(dtype=int),
    slot_hat: wp.array3d(dtype=int),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    weight: wp.array2d(dtype=real),
    field: inout(wp.array(dtype=real)),
    G: changed(wp.array3d(dtype=real)),
):
    """Per world: adds the shared surfaces to the rows of G of the fresh slots."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0:
        return
    start = w * wp.max(model.window.hats, model.window.nodes)
    slot = ctl[w].fresh
    while slot < ctl[w].slots:
        pair = slot_hat[w, slot, 0]
        m = slot_hat[w, slot, 1]
        for side in range(2):
            surface = 2 * pair + side
            n = model.shared.start[surface]
            while n < model.shared.start[surface + 1]:
                reads = model.shared.neighbour[n]
                other = reads / 2
                ratio = wp.min(weight[w, pair], weight[w, other]) / wp.max(weight[w, pair], weight[w, other])
                rows = model.surfaces.rows[reads]
                low = int(0)
                columns = model.window.columns
                if reads % 2 != 0:
                    low = second_window[w, other, 0]
                    columns = second_window[w, other, 1] - low + 1
                i = lane
                while i < columns * rows:
                    field[start + i] = real(0.0)
                    i += wp.block_dim()
                sync()
                lay_out(
                    model, w, pair, m, surface, reads, low, columns, center, stencil, stencil_at, start, field
                )  # fmt: skip
                sync()
                j = lane
                while j < slot:
                    if slot_hat[w, j, 0] == other:
                        hat = slot_hat[w, j, 1]
                        g = real(0.0)
                        if reads % 2 == 0:
                            g = field[start + hat]
                        else:
                            e = int(0)
                            while e < model.window.stencil_columns * model.window.stencil_rows:
                                part = stencil[w, other, hat, e]
                                if part != real(0.0):
                                    column = stencil_at[w, other, hat, 0] + e / model.window.stencil_rows - low
                                    row = stencil_at[w, other, hat, 1] + e % model.window.stencil_rows
                                    if column >= 0 and column < columns:
                                        g += part * field[start + column * rows + row]
                                e += 1
                        g = g * ratio
                        G[w, slot, j] = G[w, slot, j] + g
                        G[w, j, slot] = G[w, j, slot] + g
                    j += wp.block_dim()
                sync()
                n += 1
        slot += 1
