"""Displacement of a side due to all loads on it: the sum over the loads of `responses`, in all directions.

Loads of a pair are stored in two arrays, those of its first side per node or cell of the first window, those of its
second side per node of the second, in one direction or two (column by column, the rows of one direction before the
other's).
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync
from warpffrf_kernels.surfaces.responses import first_column, place_of_load

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def clear_field(lane: int, count: int, start: int, field: wp.array(dtype=real)):
    i = lane
    while i < count:
        field[start + i] = real(0.0)
        i += wp.block_dim()
    sync()


@wp.func
def add_fields(
    model: Model, w: int, side: int, low: int, columns: int, tables: wp.array(dtype=int), sign: real, directions: int,
    geometry: ContactGeometry, first_load: wp.array(dtype=real), second_load: wp.array(dtype=real), start: int,
    field: wp.array(dtype=real),
):  # fmt: skip
    """Adds to `field` (from `start`, the columns from `low` on of the side's window) the displacement due to all loads
    on the side, in `directions` (1 or 2), times `sign`. tables: of the loads on all sides, -1 where there is none; they
    define the directions of displacement."""
    target = first_column(model, w, side, geometry.center) + low
    middle = target + columns / 2
    n = model.responses.load_start[side]
    while n < model.responses.load_start[side + 1]:
        other = model.responses.load_side[n]
        pair = other / 2
        table = tables[n]
        if table >= 0:
            count = columns * model.responses.target_lines[table]
            lines = model.responses.source_lines[table]
            origin = first_column(model, w, other, geometry.center)
            i = int(0)
            end = int(0)
            base = int(0)
            if other % 2 == 0:
                base = (w * model.pairs.count + pair) * directions * model.window.grid_nodes
                i = (geometry.window[w, pair, 0] + model.window.half) * lines
                end = (geometry.window[w, pair, 1] + model.window.half + 1) * lines
            else:
                base = (w * model.pairs.count + pair) * directions * model.window.nodes
                reach = (directions - 1) * model.window.share_columns  # shares of cells extend beyond those of nodes
                i = wp.max(geometry.second_window[w, pair, 0] - reach, 0) * lines
                end = wp.min(geometry.second_window[w, pair, 1] + reach + 1, model.window.second_columns) * lines
            along = model.responses.width[table] * model.responses.target_lines[table]  # from one line to the next
            while i < end:
                at = place_of_load(model, table, origin + i / lines, 0, target, middle)
                line = int(0)
                while line < lines:
                    load = real(0.0)
                    if other % 2 == 0:
                        load = first_load[base + i]
                    else:
                        load = second_load[base + i]
                    if load != real(0.0) and at >= 0:
                        axpy(count, sign * load, model.responses.number, at + line * along, field, start)
                    line += 1
                    i += 1
        n += 1
