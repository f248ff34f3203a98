"""What loads on the contact surfaces of a body displace on them, by its local modes: tables, and where pairs load whom.

Local modes belong to a body, not to a pair. With f_s the loads on surface s, of all pairs that load it, a surface t of
the same body is displaced by

    u_t = sum over s of D_ts f_s,

itself among the s. A *side* of a pair, 2 pair + side, is where it loads a surface; the *loads on* a side are those of
all sides on its body, its own first. Each is a table of `model.responses`: (column of the block, source line, target
column + reach, target line), of which the run over the targets' columns is contiguous. The first side of a pair is
loaded and read weakly (by pressure hats, psi = M p), a second one by nodes, which the tables contain: M D M, M D, D M
and D. Columns count over full turns, so a source is moved by whole turns to where it is nearest to what is read; on a
turn the tables hold half of it to either side.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def floor_divide(a: int, b: int) -> int:
    """The largest whole number not above a/b, b > 0."""
    return (a - (((a % b) + b) % b)) / b


@wp.func
def entry(model: Model, table: int, part: int, line: int, column: int) -> int:
    """Place, in `responses.number`, of the displacement at column `column`, line 0, of a table by line `line` of column
    `part` of the block. Targets of following lines and columns follow contiguously."""
    at = part * model.responses.source_lines[table] + line
    place = at * model.responses.width[table] + column + model.responses.reach[table]
    return model.responses.start[table] + place * model.responses.target_lines[table]


@wp.func
def place_in_table(model: Model, table: int, source: int, line: int, target: int) -> int:
    """`entry` of what grid column `target` sees of grid column `source` near by, of a pair's own load: columns of both
    count over the same turns. -1 where the source does not exist."""
    block = model.responses.source_block[table]
    if model.responses.source_turn[table] == 0 and (source < 0 or source >= block):
        return -1
    number = floor_divide(source, block)
    return entry(model, table, source - number * block, line, target - number * model.responses.target_block[table])


@wp.func
def place_of_load(model: Model, table: int, source: int, line: int, target: int, middle: int) -> int:
    """`place_in_table` of any load on the body: the source is moved by whole turns to where it is nearest to the target
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
    """Column of the grid at which the window of a side begins."""
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
    """Which of the loads on side `reads` is that of side `loads`, on the same body."""
    n = model.responses.load_start[reads]
    while model.responses.load_side[n] != loads:
        n += 1
    return n


@wp.func
def own_load(model: Model, side: int) -> int:
    """The first of the loads on a side: its own."""
    return model.responses.load_start[side]
