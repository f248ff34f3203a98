"""Piecewise linear laws on the device, see `warpffrf.model.laws.curves.curve`."""

import warp as wp

from warpffrf_kernels.core.lookup import piece_at
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def piece_of(model: Model, pair: int, column: int, value: real) -> int:
    """Line of the pair's table at or below `value` of a column, at most the last but one."""
    start = model.elements[0].layers.table_start[pair]
    count = model.elements[0].layers.table_count[pair]
    return piece_at(model.elements[0].layers.table, start, count, column, value)


@wp.func
def table_beginning(model: Model, pair: int) -> real:
    """Depth [m] at which the pressure begins."""
    return model.elements[0].layers.table[model.elements[0].layers.table_start[pair], 0]


@wp.func
def table_pressure(model: Model, pair: int, depth: real) -> wp.vec2d:
    """Pressure [Pa] and slope [Pa/m]."""
    i = piece_of(model, pair, 0, depth)
    rise = model.elements[0].layers.table[i + 1, 1] - model.elements[0].layers.table[i, 1]
    slope = rise / (model.elements[0].layers.table[i + 1, 0] - model.elements[0].layers.table[i, 0])
    return wp.vec2d(
        model.elements[0].layers.table[i, 1] + slope * (depth - model.elements[0].layers.table[i, 0]), slope
    )


@wp.func
def table_depth(model: Model, pair: int, p: real) -> real:
    """Depth [m] under p > 0."""
    i = piece_of(model, pair, 1, p)
    run = model.elements[0].layers.table[i + 1, 0] - model.elements[0].layers.table[i, 0]
    rise = model.elements[0].layers.table[i + 1, 1] - model.elements[0].layers.table[i, 1]
    return model.elements[0].layers.table[i, 0] + run / rise * (p - model.elements[0].layers.table[i, 1])


@wp.func
def table_energy(model: Model, pair: int, depth: real) -> real:
    """Energy [J/m^2]."""
    i = piece_of(model, pair, 0, depth)
    at = table_pressure(model, pair, depth)
    mean = real(0.5) * (model.elements[0].layers.table[i, 1] + at[0])
    return model.elements[0].layers.table[i, 2] + mean * (depth - model.elements[0].layers.table[i, 0])
