"""Systems of the free coordinates of all pairs' cells, solved by blocks.

With D^ and L^ the lines of D and L (`cell_blocks`) reduced to the free coordinates of each pair, and B = M^-1,

    D^ x + L^ z = y,      B z = L^^T x   =>   W = U^-T L^,  (B + sum W^T W) z = sum W^T U^-T y,  x = U^-1 (U^-T y - W z)

with U^T U = D^. B + sum W^T W has the pattern of the outer matrix, and is factored as that.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.friction.cell_blocks import COUNT, FREE, block_of, borders_of, first_line, square_at
from warpffrf_kernels.linear import block_elimination
from warpffrf_kernels.linear.outer_solve import solve
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.normal.pair_elimination import add_borders

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def factor_reduced(
    model: Model,
    p: Pattern,
    w: int,
    cell_block: wp.array3d(dtype=int),
    bordered: wp.array3d(dtype=real),
    D: wp.array(dtype=real),
    W: wp.array(dtype=real),
    square: wp.array(dtype=real),
    outer: wp.array3d(dtype=real),
) -> int:
    """U in place of D^, W in place of L^, and `outer` = `bordered` + sum W^T W; 1 where a block is not definite."""
    stride = 2 * model.capacity.cells
    width = model.pairs.coupled_capacity
    bad = int(0)
    pair = int(0)
    while pair < model.pairs.count:
        if cell_block[w, pair, COUNT] > 0:
            m = cell_block[w, pair, FREE]
            coupled = model.pairs.coupled_count[pair]
            at = borders_of(model, w, pair)
            bad += block_elimination.factor(D, block_of(model, w, pair), stride, m)
            block_elimination.forward_lines(D, block_of(model, w, pair), stride, m, W, at, width, coupled)
            block_elimination.square_of(m, W, at, width, coupled, square, square_at(model, w, pair))
        pair += 1
    add_borders(model, p, w, bordered, cell_block, square, outer)
    return bad


@wp.func
def solve_reduced(
    model: Model,
    p: Pattern,
    w: int,
    lane: int,
    renew: int,
    held: int,
    cell_block: wp.array3d(dtype=int),
    U: wp.array(dtype=real),
    W: wp.array(dtype=real),
    outer: wp.array3d(dtype=real),
    hold: wp.array3d(dtype=real),
    scaling: wp.array2d(dtype=real),
    pivots: wp.array2d(dtype=int),
    factor: wp.array(dtype=real),
    vector: wp.array(dtype=real),
    lines: wp.array(dtype=real),
    fallback: wp.array2d(dtype=int),
    work: wp.array3d(dtype=real),
    inverse_transposed: wp.array(dtype=real),
    push: wp.array(dtype=real),
    turned: wp.array(dtype=real),
    x: wp.array(dtype=real),
) -> int:
    """x <- solution for the right-hand side x; `renew`: of new factors. 1 where the outer matrix is singular."""
    stride = 2 * model.capacity.cells
    i = lane
    while i < model.outer.count:
        push[w * model.outer.count + i] = real(0.0)
        i += wp.block_dim()
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        if cell_block[w, pair, COUNT] > 0:
            m = cell_block[w, pair, FREE]
            line = first_line(model, w, pair)
            block_elimination.forward(U, block_of(model, w, pair), stride, m, x, line)
            block_elimination.push_columns(model, w, pair, m, W, borders_of(model, w, pair), x, line, push)
        pair += 1
    bad = solve(
        model, p, w, lane, renew, outer, push, hold, held, scaling, pivots, factor, vector, lines, fallback, work,
        inverse_transposed, turned,
    )  # fmt: skip
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        if cell_block[w, pair, COUNT] > 0:
            m = cell_block[w, pair, FREE]
            line = first_line(model, w, pair)
            block_elimination.follow_columns(
                model, w, pair, m, real(-1.0), W, borders_of(model, w, pair), turned, x, line
            )  # fmt: skip
            block_elimination.backward(U, block_of(model, w, pair), stride, m, x, line)
        pair += 1
    return bad
