"""Displacement of the contact surfaces of a body due to loads on them, by its local modes: tables and loading pairs.

Local modes belong to a body, not to a pair. With f_s the loads on surface s, of all pairs that load it, a surface t of
the same body is displaced by

    u_t = sum over s of D_ts f_s,

with t among the s. A *side* of a pair, 2 pair + side, is its contact with one surface; the *loads on* a side are those
of all sides on its body, its own first. Each is a table of `model.responses`: (column of the block, source line, target
column + reach, target line), contiguous over the targets' columns. The first side of a pair is loaded and evaluated
weakly (by nodal pressures, psi = M p), a second one by nodal loads, which the tables contain: M D M, M D, D M and D.
Columns count over full revolutions, so a source is shifted by whole revolutions to be nearest to the target; on a full
revolution the tables hold half of it to either side.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def floor_divide(a: int, b: int) -> int:
    """The largest integer not above a/b, b > 0."""
    return (a - (((a % b) + b) % b)) / b


@wp.func
def entry(model: Model, table: int, part: int, line: int, column: int) -> int:
    """Index, in `responses.number`, of the displacement at column `column`, line 0, of a table by line `line` of column
    `part` of the block. Targets of following lines and columns follow contiguously."""
    at = part * model.responses.source_lines[table] + line
    place = at * model.responses.width[table] + column + model.responses.reach[table]
    return model.responses.start[table] + place * model.responses.target_lines[table]


@wp.func
def place_in_table(model: Model, table: int, source: int, line: int, target: int) -> int:
    """`entry` for the displacement of grid column `target` by the nearby grid column `source`, of a pair's own load:
    columns of both count over the same revolutions. -1 if the source does not exist."""
    block = model.responses.source_block[table]
    if model.responses.source_turn[table] == 0 and (source < 0 or source >= block):
        return -1
    number = floor_divide(source, block)
    return entry(model, table, source - number * block, line, target - number * model.responses.target_block[table])


@wp.func
def place_of_load(model: Model, table: int, source: int, line: int, target: int, middle: int) -> int:
    """`place_in_table` of any load on the body: the source is shifted by whole revolutions to be nearest to the target
    column `middle`."""
    block = model.responses.source_block[table]
    turn = model.responses.source_turn[table]
    round = model.responses.target_block[table]
    if turn == 0:
        if source < 0 or source >= block:
            return -1
        if round == 0:
            return entry(model, table, source, line, target)
        return entry(model, table, source, line, target - floor_divide(middle, round) * round)
    if round == 0:
        return entry(model, table, source - floor_divide(source, turn) * turn, line, target)
    there = floor_divide(middle * block, round)
    away = (((source - there) % turn) + turn) % turn
    if 2 * away > turn:
        away -= turn
    return place_in_table(model, table, there + away, line, target)


@wp.func
def first_column(model: Model, w: int, side: int, center: wp.array3d(dtype=int)) -> int:
    """First grid column of the window of a side."""
    if side % 2 == 0:
        return center[w, side / 2, 0] - model.window.half
    return center[w, side / 2, 1] - model.window.second_half


@wp.func
def loaded_by_others(model: Model, pair: int) -> bool:
    """Whether other sides load the bodies of a pair, through their local modes."""
    for i in range(2):
        side = 2 * pair + i
        if model.responses.load_start[side + 1] - model.responses.load_start[side] > 1:
            return True
    return False


@wp.func
def load_of(model: Model, reads: int, loads: int) -> int:
    """Index of the load of side `loads` among the loads on side `reads`, on the same body."""
    n = model.responses.load_start[reads]
    while model.responses.load_side[n] != loads:
        n += 1
    return n


@wp.func
def own_load(model: Model, side: int) -> int:
    """The first of the loads on a side: its own."""
    return model.responses.load_start[side]
