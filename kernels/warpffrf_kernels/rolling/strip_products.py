r"""Products with the compliance of tractions, K = D + L M L^T (`friction.cell_blocks`), without a matrix.

Half-spaces act by strips (`strips`), far fields and condensed modes by their splines,

    D = H_tt + P (S_tt + Phi_t sigma^-1 Phi_t^T) P^T of A + Q (the same of B) Q^T.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import PatchScratch, RollingScratch
from warpffrf_kernels.core.friction_scratch import FrictionCells, FrictionSolve, StripSolve
from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.friction.cell_blocks import COUNT, borders_of, first_line, move_retained
from warpffrf_kernels.linear.block_elimination import follow_columns
from warpffrf_kernels.patch.spline_tables import real_side
from warpffrf_kernels.rolling.cell_frames import load_splines_of, place_cells, read_splines_of, soften_side, take_cells
from warpffrf_kernels.rolling.spline_tables import half_along
from warpffrf_kernels.rolling.strips import multiply_half_spaces

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def soft_at(model: Model, elements: Elements, w: int, pair: int, side: int) -> int:
    """Start of the softened splines of a side, lines of 2 far_nodes."""
    nodes = elements.patches.far_nodes
    return ((w * model.pairs.count + pair) * 2 + side) * 4 * nodes * nodes


@wp.func(inline=False)
def add_product(
    model: Model, elements: Elements, w: int, pair: int, part: real, cells: FrictionCells, patch: PatchScratch,
    rolling: RollingScratch, tangential: FrictionSolve, strips: StripSolve, x: wp.array(dtype=real),
    y: wp.array(dtype=real),
):  # fmt: skip
    """y += part D x over the lines of a pair."""
    count = tangential.cell_block[w, pair, COUNT]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    place_cells(model, elements, w, pair, count, rows, tangential.cell_slot, x, strips.strip_place)
    at = (w * model.pairs.count + pair) * 2 * elements.patches.places
    multiply_half_spaces(model, elements, w, pair, strips, strips.strip_place, at, strips.strip_out, at)
    take_cells(model, elements, w, pair, count, rows, part, tangential.cell_slot, strips.strip_out, y)
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            own = model.surfaces.rows[s]
            at = half_along(model, elements, w, pair, side, 0)
            load_splines_of(
                model, elements, w, pair, side, count, own, patch.far_at, patch.far_weight, patch.far_window,
                tangential.cell_slot, cells.cell_turn, x, rolling.rub_load, at,
            )  # fmt: skip
            soften_side(
                patch.far_window[w, pair, side, 1] * own, elements.patches.far_nodes, rolling.rub_load, at,
                rolling.rub_soft, soft_at(model, elements, w, pair, side), rolling.rub_field, at,
            )  # fmt: skip
            read_splines_of(
                model, elements, w, pair, side, count, own, part, patch.far_at, patch.far_weight, patch.far_window,
                tangential.cell_slot, cells.cell_turn, rolling.rub_field, at, y,
            )  # fmt: skip


@wp.func(inline=False)
def add_all(
    model: Model, w: int, lane: int, part: real, cells: FrictionCells, patch: PatchScratch, rolling: RollingScratch,
    tangential: FrictionSolve, strips: StripSolve, x: wp.array(dtype=real), y: wp.array(dtype=real),
):  # fmt: skip
    """y += part K x over the lines of all pairs."""
    move_retained(
        model, w, lane, tangential, tangential.cell_bordered, tangential.friction_receptance, x,
        tangential.cell_moved_retained,
    )  # fmt: skip
    pair = int(0)
    while pair < model.pairs.count:
        n = 2 * tangential.cell_block[w, pair, COUNT]
        if n > 0:
            add_product(model, model.elements[0], w, pair, part, cells, patch, rolling, tangential, strips, x, y)
            follow_columns(
                model, w, pair, n, part, tangential.cell_bordered, borders_of(model, w, pair),
                tangential.cell_moved_retained, y, first_line(model, w, pair),
            )  # fmt: skip
        pair += 1
