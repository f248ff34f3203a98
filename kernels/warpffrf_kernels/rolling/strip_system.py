r"""Steps of Newton's method for the tractions of large patches (`traction_solve`), by products over strips.

A step is a system P_f (K + Lambda) P_f x = rhs in the free coordinates (`cell_frames`), solved by conjugate gradients.
The preconditioner is that of the constrained system with D replaced by the inverse of P_f S W S P_f, W that of the
half-spaces alone: with Z = P_f S W S P_f L and B = M^-1,

    g = P_f S W S P_f rho - Z zeta,      (B + L^T Z) zeta = Z^T rho,

so that M L^T g = zeta: the retained increments follow without M, and the number of iterations depends neither on soft
motions nor on how many pairs there are. B + L^T Z is sparse (`friction.reduced_system`).
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import PatchScratch, RollingScratch
from warpffrf_kernels.core.friction_scratch import FrictionCells, FrictionSolve, SlipSpeedSolve, StripSolve
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, dot, real, sync
from warpffrf_kernels.core.scratch import RetainedSystem
from warpffrf_kernels.friction.cell_blocks import COUNT, borders_of, first_line, square_at
from warpffrf_kernels.linear.block_elimination import follow_columns, is_loaded, product_of_borders, push_columns
from warpffrf_kernels.linear.retained_solve import solve
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.normal.pair_elimination import add_borders
from warpffrf_kernels.rolling.cell_frames import (
    frame_cells,
    frames_hold,
    move_framed,
    place_scaled,
    pose_framed,
    restrict,
    take_scaled,
)
from warpffrf_kernels.rolling.strip_products import add_product
from warpffrf_kernels.rolling.strips import inverse_at, multiply_inverse
from warpffrf_kernels.surfaces.fields import clear_field

wp.set_module_options(MODULE_OPTIONS)

MOST = wp.constant(200)  # iterations of a system
DIRECTION = wp.constant(wp.float64(0.99999))  # cosine: at a larger change of a slip direction frames are computed again
STIFFNESS = wp.constant(wp.float64(0.02))  # of the diagonal of a system: likewise, at a larger change of lambda


@wp.func
def frames_are_good(
    model: Model, w: int, patch: PatchScratch, tangential: FrictionSolve, strips: StripSolve,
    softness: wp.array(dtype=real),
) -> int:  # fmt: skip
    """Whether the frames of all pairs still hold for Newton's method."""
    elements = model.elements[0]
    good = int(1)
    pair = int(0)
    while pair < model.pairs.count and good != 0:
        count = tangential.cell_block[w, pair, COUNT]
        if count > 0:
            W = patch.patch_place[w, pair, 2]
            good = frames_hold(
                model, w, pair, count, model.surfaces.rows[model.pairs.first[pair]], DIRECTION, STIFFNESS,
                wp.pow(W, -elements.patches.near_power[pair]), elements.rolling.inverse,
                inverse_at(model, elements, pair, W), tangential.cell_slot, tangential.cell_sliding,
                tangential.cell_direction, tangential.cell_curvature, softness, strips.strip_frame,
            )  # fmt: skip
        pair += 1
    return good


@wp.func(inline=False)
def prepare(
    model: Model, p: Pattern, w: int, lane: int, by_slope: int, patch: PatchScratch, tangential: FrictionSolve,
    slopes: SlipSpeedSolve, strips: StripSolve, radius: wp.array(dtype=real), softness: wp.array(dtype=real),
):  # fmt: skip
    """Frames of all cells, Z in `cell_W`, and B + L^T Z in `cell_retained`."""
    elements = model.elements[0]
    width = model.pairs.coupled_capacity
    places = elements.patches.places
    pair = int(0)
    while pair < model.pairs.count:
        count = tangential.cell_block[w, pair, COUNT]
        if count > 0:
            rows = model.surfaces.rows[model.pairs.first[pair]]
            W = patch.patch_place[w, pair, 2]
            frame_cells(
                model, w, pair, count, rows, by_slope, wp.pow(W, -elements.patches.near_power[pair]),
                elements.rolling.inverse, inverse_at(model, elements, pair, W), tangential.cell_slot,
                tangential.cell_sliding, tangential.cell_direction, tangential.cell_curvature, tangential.cell_slope,
                tangential.cell_tau, radius, softness, strips.strip_frame,
            )  # fmt: skip
            at = borders_of(model, w, pair)
            c = int(0)
            while c < model.pairs.coupled_count[pair]:
                loaded = is_loaded(2 * count, width, tangential.cell_bordered, at + c)
                place_scaled(
                    model, elements, w, pair, count, rows, tangential.cell_slot, strips.strip_frame,
                    tangential.cell_bordered, at + c, width, strips.strip_place,
                )  # fmt: skip
                if loaded != 0:
                    multiply_inverse(model, elements, w, pair, W, strips)
                else:
                    clear_field(lane, 2 * places, (w * model.pairs.count + pair) * 2 * places, strips.strip_out)
                    sync()
                take_scaled(
                    model, elements, w, pair, count, rows, tangential.cell_slot, strips.strip_frame, strips.strip_out,
                    tangential.cell_W, at + c, width,
                )  # fmt: skip
                c += 1
            product_of_borders(
                2 * count, width, model.pairs.coupled_count[pair], at, tangential.cell_bordered, tangential.cell_W,
                square_at(model, w, pair), tangential.cell_square,
            )  # fmt: skip
        pair += 1
    add_borders(
        model, p, w, slopes.speed_bordered, tangential.cell_block, tangential.cell_square, tangential.cell_retained
    )


@wp.func
def precondition(
    model: Model, p: Pattern, w: int, lane: int, renew: int, held: int, patch: PatchScratch,
    tangential: FrictionSolve, strips: StripSolve, system: RetainedSystem,
) -> int:  # fmt: skip
    """strip_step = preconditioned strip_residual, and its retained increments in `cell_moved_retained`; 1 if the
    retained matrix is singular."""
    elements = model.elements[0]
    i = lane
    while i < model.retained.count:
        tangential.cell_load[w * model.retained.count + i] = real(0.0)
        i += wp.block_dim()
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        count = tangential.cell_block[w, pair, COUNT]
        if count > 0:
            rows = model.surfaces.rows[model.pairs.first[pair]]
            line = first_line(model, w, pair)
            place_scaled(
                model, elements, w, pair, count, rows, tangential.cell_slot, strips.strip_frame, strips.strip_residual,
                line, 1, strips.strip_place,
            )  # fmt: skip
            multiply_inverse(model, elements, w, pair, patch.patch_place[w, pair, 2], strips)
            take_scaled(
                model, elements, w, pair, count, rows, tangential.cell_slot, strips.strip_frame, strips.strip_out,
                strips.strip_step, line, 1,
            )  # fmt: skip
            push_columns(
                model, w, pair, 2 * count, tangential.cell_W, borders_of(model, w, pair), strips.strip_residual, line,
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
        n = 2 * tangential.cell_block[w, pair, COUNT]
        if n > 0:
            follow_columns(
                model, w, pair, n, real(-1.0), tangential.cell_W, borders_of(model, w, pair),
                tangential.cell_moved_retained, strips.strip_step, first_line(model, w, pair),
            )  # fmt: skip
        pair += 1
    return bad


@wp.func(inline=False)
def iterate(
    model: Model, p: Pattern, w: int, lane: int, fresh: int, reduction: real, held: int, cells: FrictionCells,
    patch: PatchScratch, rolling: RollingScratch, tangential: FrictionSolve, strips: StripSolve,
    system: RetainedSystem,
) -> int:  # fmt: skip
    """strip_change: the solution of a prepared system for the right-hand side `strip_residual`, to a reduction of its
    residual in the norm of the preconditioner. Returns the number of iterations, -1 if it is not definite."""
    N = model.retained.count
    all = model.pairs.count * 2 * model.capacity.cells
    line = lane
    while line < all:
        strips.strip_change[w * all + line] = real(0.0)
        strips.strip_direction[w * all + line] = real(0.0)
        line += wp.block_dim()
    i = lane
    while i < N:
        strips.strip_retained[w * N + i] = real(0.0)
        i += wp.block_dim()
    sync()
    n = int(0)
    first = real(0.0)
    before = real(0.0)
    done = int(0)
    while done == 0:
        renew = int(0)
        if n == 0:
            renew = fresh
        if precondition(model, p, w, lane, renew, held, patch, tangential, strips, system) != 0:
            return -1
        size = real(0.0)
        pair = int(0)
        while pair < model.pairs.count:
            at = first_line(model, w, pair)
            size += dot(2 * tangential.cell_block[w, pair, COUNT], strips.strip_residual, at, strips.strip_step, at)
            pair += 1
        if n == 0:
            first = size
        if size <= reduction * reduction * first or n == MOST:
            done = 1
        elif not (size > real(0.0)):
            return -1
        else:
            beta = real(0.0)
            if n > 0:
                beta = size / before
            before = size
            sync()
            pair = int(0)
            while pair < model.pairs.count:
                line = first_line(model, w, pair) + lane
                end = first_line(model, w, pair) + 2 * tangential.cell_block[w, pair, COUNT]
                while line < end:
                    strips.strip_direction[line] = strips.strip_step[line] + beta * strips.strip_direction[line]
                    strips.strip_image[line] = real(0.0)
                    line += wp.block_dim()
                pair += 1
            i = lane
            while i < N:
                strips.strip_retained[w * N + i] = (
                    tangential.cell_moved_retained[w * N + i] + beta * strips.strip_retained[w * N + i]
                )
                i += wp.block_dim()
            sync()
            curved = real(0.0)
            pair = int(0)
            while pair < model.pairs.count:
                count = tangential.cell_block[w, pair, COUNT]
                if count > 0:
                    at = first_line(model, w, pair)
                    add_product(
                        model, model.elements[0], w, pair, real(1.0), cells, patch, rolling, tangential, strips,
                        strips.strip_direction, strips.strip_image,
                    )  # fmt: skip
                    follow_columns(
                        model, w, pair, 2 * count, real(1.0), tangential.cell_bordered, borders_of(model, w, pair),
                        strips.strip_retained, strips.strip_image, at,
                    )  # fmt: skip
                    restrict(model, w, pair, count, strips.strip_frame, strips.strip_direction, strips.strip_image)
                    curved += dot(2 * count, strips.strip_direction, at, strips.strip_image, at)
                pair += 1
            if not (curved > real(0.0)):
                return -1
            length = size / curved
            sync()
            pair = int(0)
            while pair < model.pairs.count:
                line = first_line(model, w, pair) + lane
                end = first_line(model, w, pair) + 2 * tangential.cell_block[w, pair, COUNT]
                while line < end:
                    strips.strip_change[line] = strips.strip_change[line] + length * strips.strip_direction[line]
                    strips.strip_residual[line] = strips.strip_residual[line] - length * strips.strip_image[line]
                    line += wp.block_dim()
                pair += 1
            sync()
            n += 1
    return n


@wp.func(inline=False)
def step_on_strips(
    model: Model, p: Pattern, w: int, lane: int, reduction: real, held: int, cells: FrictionCells, patch: PatchScratch,
    rolling: RollingScratch, tangential: FrictionSolve, slopes: SlipSpeedSolve, strips: StripSolve,
    system: RetainedSystem, radius: wp.array(dtype=real), softness: wp.array(dtype=real),
) -> int:  # fmt: skip
    """A step of Newton's method from the slips and kinds of the cells on. 1 if the system is not definite."""
    renew = int(0)
    if strips.strip_ready[w] == 0 or frames_are_good(model, w, patch, tangential, strips, softness) == 0:
        renew = 1
        prepare(model, p, w, lane, 0, patch, tangential, slopes, strips, radius, softness)
    sync()
    if lane == 0:
        strips.strip_ready[w] = 1
    cap = model.capacity.cells
    pair = int(0)
    while pair < model.pairs.count:
        pose_framed(
            model, w, pair, tangential.cell_block[w, pair, COUNT], tangential.cell_direction, tangential.cell_sliding,
            tangential.cell_slip, strips.strip_frame, strips.strip_residual,
        )  # fmt: skip
        start = (w * model.pairs.count + pair) * 2 * cap
        i = lane
        while i < tangential.cell_block[w, pair, COUNT]:
            tangential.cell_sliding[start + cap + i] = tangential.cell_sliding[start + i]  # kinds of this system
            i += wp.block_dim()
        pair += 1
    sync()
    if iterate(model, p, w, lane, renew, reduction, held, cells, patch, rolling, tangential, strips, system) < 0:
        return 1
    pair = int(0)
    while pair < model.pairs.count:
        move_framed(
            model, w, pair, tangential.cell_block[w, pair, COUNT], radius, tangential.cell_direction,
            tangential.cell_sliding, strips.strip_frame, strips.strip_change, tangential.cell_tau,
        )  # fmt: skip
        pair += 1
    return 0
