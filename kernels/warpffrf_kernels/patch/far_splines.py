"""Quadratic splines of a surface's far field on the device, and their compliance S.

Between two ends splines are defined on knots; around a full revolution those of column j begin 1.5 columns before it.
See `warpffrf.model.half_space`.
"""

import warp as wp

from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3

wp.set_module_options(MODULE_OPTIONS)

TAPS = 3  # splines that are nonzero at a point, in each direction


@wp.struct
class Taps:
    """In one direction: the first spline that is nonzero at a point, and the values of it and the next two."""

    first: int
    value: vec3


@wp.func
def cardinal_taps(x: real) -> Taps:
    """At the column x of a full revolution."""
    j = wp.floor(x + real(0.5))
    d = x - j
    out = Taps()
    out.first = int(j) - 1
    low = real(0.5) - d
    high = real(0.5) + d
    out.value = vec3(real(0.5) * low * low, real(0.75) - d * d, real(0.5) * high * high)
    return out


@wp.func
def knot_taps(knots: wp.array(dtype=real), start: int, count: int, x: real) -> Taps:
    """At x, for `count` splines on knots from `start` on; the outermost parabolas are continued beyond the ends. Two
    splines are linear."""
    out = Taps()
    if count < TAPS:
        u = (x - knots[start]) / (knots[start + 2] - knots[start])
        out.value = vec3(real(1.0) - u, u, real(0.0))
        return out
    i = int(2)
    while i < count - 1 and x >= knots[start + i + 1]:
        i += 1
    t = start + i
    span = knots[t + 1] - knots[t]
    up = knots[t + 1] - x
    down = x - knots[t]
    first = up * up / ((knots[t + 1] - knots[t - 1]) * span)
    last = down * down / ((knots[t + 2] - knots[t]) * span)
    out.first = i - 2
    out.value = vec3(first, real(1.0) - first - last, last)
    return out


@wp.func
def column_taps(model: Model, elements: Elements, s: int, column: real) -> Taps:
    """Around surface `s` at a `column` counted over full revolutions, or between two ends."""
    if model.surfaces.turn[s] > 0:
        return cardinal_taps(column)
    f = elements.patches.far_of[s]
    return knot_taps(elements.patches.knot, elements.patches.column_knots[f], model.surfaces.columns[s], column)


@wp.func
def row_taps(model: Model, elements: Elements, s: int, z: real) -> Taps:
    """Along the meridian of surface `s` at z [m]."""
    f = elements.patches.far_of[s]
    return knot_taps(elements.patches.knot, elements.patches.row_knots[f], model.surfaces.rows[s], z)


@wp.func
def turned_column(model: Model, s: int, column: int) -> int:
    """Column of the grid for a column counted over full revolutions; -1 outside the grid."""
    turn = model.surfaces.turn[s]
    c = column
    if turn > 0:
        c = ((column % turn) + turn) % turn
    if c < 0 or c >= model.surfaces.columns[s]:
        return -1
    return c


@wp.func
def beside_block(
    model: Model, elements: Elements, table: int, rows: int, source_rows: int, target: int, source: int
) -> int:
    """Start of a table between two columns of the grids of two patches in `beside`, (row of the target, row of the
    source), with a stride of the source's sector between rows."""
    c = elements.patches.table_target[table]
    c_source = elements.patches.table_source[table]
    sectors = elements.patches.table_sectors[table]
    lag = (target / c - source / c_source + sectors) % sectors
    line = lag * c * rows + (target % c) * rows
    return elements.patches.table_start[table] + line * c_source * source_rows + (source % c_source) * source_rows
