"""Systems of the free coordinates of all pairs' cells, solved by blocks.

With D^ and L^ the lines of D and L (`cell_blocks`) reduced to the free coordinates of each pair, and B = M^-1,

    D^ x + L^ z = y,      B z = L^^T x   =>   W = U^-T L^,  (B + sum W^T W) z = sum W^T U^-T y,  x = U^-1 (U^-T y - W z)

with U^T U = D^. B + sum W^T W has the pattern of the retained matrix, and is factorised like it.
"""

import warp as wp

from warpffrf_kernels.core.friction_scratch import FrictionSolve, SlipSpeedSolve
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.core.scratch import RetainedSystem
from warpffrf_kernels.friction.cell_blocks import COUNT, FREE, block_of, borders_of, first_line, square_at
from warpffrf_kernels.linear import block_elimination
from warpffrf_kernels.linear.retained_solve import solve
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.normal.pair_elimination import add_borders

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def factor_reduced(model: Model, p: Pattern, w: int, tangential: FrictionSolve, slopes: SlipSpeedSolve) -> int:
    """U replaces D^, W replaces L^, and `retained` = `bordered` + sum W^T W; 1 if a block is not definite."""
    stride = 2 * model.capacity.cells
    width = model.pairs.coupled_capacity
    bad = int(0)
    pair = int(0)
    while pair < model.pairs.count:
        if tangential.cell_block[w, pair, COUNT] > 0:
            m = tangential.cell_block[w, pair, FREE]
            coupled = model.pairs.coupled_count[pair]
            at = borders_of(model, w, pair)
            bad += block_elimination.factor(tangential.cell_U, block_of(model, w, pair), stride, m)
            block_elimination.forward_lines(
                tangential.cell_U, block_of(model, w, pair), stride, m, tangential.cell_W, at, width, coupled
            )
            block_elimination.square_of(
                m, tangential.cell_W, at, width, coupled, tangential.cell_square, square_at(model, w, pair)
            )
        pair += 1
    add_borders(
        model, p, w, slopes.speed_bordered, tangential.cell_block, tangential.cell_square, tangential.cell_retained
    )
    return bad


@wp.func
def solve_reduced(
    model: Model,
    p: Pattern,
    w: int,
    lane: int,
    renew: int,
    held: int,
    tangential: FrictionSolve,
    system: RetainedSystem,
) -> int:
    """x <- solution for the right-hand side x; `renew`: with new factors. 1 if the retained matrix is singular."""
    stride = 2 * model.capacity.cells
    i = lane
    while i < model.retained.count:
        tangential.cell_load[w * model.retained.count + i] = real(0.0)
        i += wp.block_dim()
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        if tangential.cell_block[w, pair, COUNT] > 0:
            m = tangential.cell_block[w, pair, FREE]
            line = first_line(model, w, pair)
            block_elimination.forward(
                tangential.cell_U, block_of(model, w, pair), stride, m, tangential.cell_solution, line
            )
            block_elimination.push_columns(
                model, w, pair, m, tangential.cell_W, borders_of(model, w, pair), tangential.cell_solution, line,
                tangential.cell_load,
            )  # fmt: skip
        pair += 1
    bad = solve(
        model, p, w, lane, renew, tangential.cell_retained, tangential.cell_load, system.hold, held,
        tangential.cell_scaling, tangential.cell_pivots, tangential.cell_factor, tangential.cell_vector,
        tangential.cell_lines, tangential.cell_fallback, tangential.cell_work, tangential.cell_inverse_transposed,
        tangential.cell_moved_retained,
    )  # fmt: skip
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        if tangential.cell_block[w, pair, COUNT] > 0:
            m = tangential.cell_block[w, pair, FREE]
            line = first_line(model, w, pair)
            block_elimination.follow_columns(
                model, w, pair, m, real(-1.0), tangential.cell_W, borders_of(model, w, pair),
                tangential.cell_moved_retained, tangential.cell_solution, line,
            )  # fmt: skip
            block_elimination.backward(
                tangential.cell_U, block_of(model, w, pair), stride, m, tangential.cell_solution, line
            )
        pair += 1
    return bad
