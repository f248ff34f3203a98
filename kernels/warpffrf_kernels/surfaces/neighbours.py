"""Which surfaces serve several pairs, and where the windows of these lie on one grid."""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def has_neighbours(model: Model, pair: int) -> bool:
    """Whether either surface of the pair serves another pair too."""
    return model.shared.start[2 * pair] < model.shared.start[2 * pair + 2]


@wp.func
def nearest_turn(model: Model, surface: int, column: int, middle: int) -> int:
    """The grid column `column` of a full turn, counted so that it is nearest to `middle`."""
    turn = model.surfaces.turn[surface]
    if turn == 0:
        return column
    away = (((column - middle) % turn) + turn) % turn
    if 2 * away > turn:
        away -= turn
    return middle + away


@wp.func
def first_column(model: Model, w: int, surface: int, center: wp.array3d(dtype=int)) -> int:
    """Column of the grid at which the window of a pair begins on its surface `surface`."""
    pair = surface / 2
    if surface % 2 == 0:
        return center[w, pair, 0] - model.window.half
    return center[w, pair, 1] - model.window.second_half
