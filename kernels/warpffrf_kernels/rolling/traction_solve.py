r"""Tractions of patches of cells by products over strips: stick and slip of all cells at once, without a matrix.

The problem is that of `friction.stick_slip_solve`, r = r_0 + K tau in discs, K = D + L M L^T (`friction.cell_blocks`).
A product with D is the half-spaces by strips (`strips`), far fields and condensed modes by their splines,

    D = H_tt + P (S_tt + Phi_t sigma^-1 Phi_t^T) P^T of A + Q (the same of B) Q^T.

Each step of the semismooth Newton method, and of the interior-point method that comes near where that does not
converge, is a system P_f (K + Lambda) P_f x = rhs in the free coordinates (`cell_frames`). It is solved by conjugate
gradients. The preconditioner is that of the constrained system with D replaced by the inverse of P_f S W S P_f, W that
of the half-spaces alone: with Z = P_f S W S P_f L and B = M^-1,

    g = P_f S W S P_f rho - Z zeta,      (B + L^T Z) zeta = Z^T rho,

so that M L^T g = zeta: the retained increments follow without M, and the number of iterations depends neither on soft
motions nor on how many pairs there are. B + L^T Z is sparse (`friction.reduced_system`).

Tractions begin at those of the last evaluation, sets at what these make of the slips. An iteration takes two products;
a system about ten to twenty iterations.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import PatchScratch, RollingScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells, FrictionSolve, SlipSpeedSolve, StripSolve
from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, dot, real, sync
from warpffrf_kernels.core.scratch import ImpulsiveContact, Residuals, RetainedSystem
from warpffrf_kernels.friction.cell_blocks import COUNT, borders_of, first_line, move_retained, square_at
from warpffrf_kernels.friction.cells import rubs_on_patch
from warpffrf_kernels.friction.friction_cone import CHANGED, JUMPED, sort_cells
from warpffrf_kernels.friction.interior_point import (
    CENTRED,
    LENGTH,
    MU,
    STEPS,
    WITHIN,
    begin_inside,
    go_inside,
    pose_inside,
)
from warpffrf_kernels.friction.pressure_response import RENEWED
from warpffrf_kernels.linear.block_elimination import follow_columns, push_columns
from warpffrf_kernels.linear.retained_solve import held_motions, solve
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.normal.pair_elimination import add_borders
from warpffrf_kernels.patch.spline_tables import real_side
from warpffrf_kernels.rolling.cell_frames import (
    frame_cells,
    frames_hold,
    load_splines_of,
    move_framed,
    place_cells,
    place_scaled,
    pose_framed,
    read_splines_of,
    restrict,
    soften_side,
    take_cells,
    take_scaled,
)
from warpffrf_kernels.rolling.shear import STRIPS_AROUND, shear_line
from warpffrf_kernels.rolling.spline_tables import half_along, table_along, trace_along
from warpffrf_kernels.rolling.strips import inverse_at, multiply_half_spaces, multiply_inverse
from warpffrf_kernels.rolling.system import soften_splines
from warpffrf_kernels.surfaces.fields import clear_field

wp.set_module_options(MODULE_OPTIONS)

SETTLED = wp.constant(wp.float64(1.0e-11))  # of the largest bound: below the tolerance of the retained iteration
COARSE = wp.constant(wp.float64(0.05))  # reduction of a system while cells change their states
LEAST = wp.constant(wp.float64(1.0e-12))  # reduction, at most
FINER = wp.constant(wp.float64(0.3))  # of what the present defect needs
MOST = wp.constant(200)  # iterations of a system
NEWTON = wp.constant(14)  # steps of Newton before it comes near by the interior-point method
TRIES = wp.constant(4)  # of these
INSIDE = wp.constant(wp.float64(1.0e-3))  # reduction of a system of the interior-point method
TURNED = wp.constant(wp.float64(0.99999))  # cosine: frames of cells that slide in other directions are made anew
LIES = wp.constant(wp.float64(0.02))  # of the diagonal of a system: likewise, where lambda has changed
NEAR = wp.constant(wp.float64(1.0e-6))  # of the largest bound: where it ends


@wp.func
def soft_at(model: Model, elements: Elements, w: int, pair: int, side: int) -> int:
    """Start of the softened splines of a side, lines of 2 far_nodes."""
    nodes = elements.patches.far_nodes
    return ((w * model.pairs.count + pair) * 2 + side) * 4 * nodes * nodes


@wp.func
def add_product(
    model: Model, elements: Elements, w: int, pair: int, part: real, cells: FrictionCells, patch: PatchScratch,
    rolling: RollingScratch, tangential: FrictionSolve, strips: StripSolve, x: wp.array(dtype=real),
    y: wp.array(dtype=real),
):  # fmt: skip
    """y += part D x over the lines of a pair."""
    count = tangential.cell_block[w, pair, COUNT]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    place_cells(model, elements, w, pair, count, rows, tangential.cell_slot, x, strips.strip_place)
    multiply_half_spaces(model, elements, w, pair, strips)
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


@wp.func
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


@wp.func
def add_soft(
    model: Model, w: int, lane: int, cells: FrictionCells, patch: PatchScratch, rolling: RollingScratch,
    tangential: FrictionSolve, strips: StripSolve, softness: wp.array(dtype=real), x: wp.array(dtype=real),
):  # fmt: skip
    """cell_slip += (K + softness) x."""
    pair = int(0)
    while pair < model.pairs.count:
        line = first_line(model, w, pair) + lane
        end = first_line(model, w, pair) + 2 * tangential.cell_block[w, pair, COUNT]
        while line < end:
            tangential.cell_slip[line] = tangential.cell_slip[line] + softness[line / 2] * x[line]
            line += wp.block_dim()
        pair += 1
    sync()
    add_all(model, w, lane, real(1.0), cells, patch, rolling, tangential, strips, x, tangential.cell_slip)


@wp.func
def find_slips(
    model: Model, w: int, lane: int, cells: FrictionCells, patch: PatchScratch, rolling: RollingScratch,
    tangential: FrictionSolve, strips: StripSolve, softness: wp.array(dtype=real),
):  # fmt: skip
    """r of the tractions."""
    all = model.pairs.count * 2 * model.capacity.cells
    line = lane
    while line < all:
        tangential.cell_slip[w * all + line] = tangential.cell_right[w * all + line]
        line += wp.block_dim()
    sync()
    add_soft(model, w, lane, cells, patch, rolling, tangential, strips, softness, tangential.cell_tau)


@wp.func
def judge(
    model: Model, w: int, lane: int, cells: FrictionCells, patch: PatchScratch, rolling: RollingScratch,
    tangential: FrictionSolve, slopes: SlipSpeedSolve, strips: StripSolve, radius: wp.array(dtype=real),
    softness: wp.array(dtype=real),
) -> real:  # fmt: skip
    """Slips, kinds of the cells, and the slips after sliding cells have been moved to their circles. Returns the defect
    of the tractions, as a fraction of the largest bound."""
    find_slips(model, w, lane, cells, patch, rolling, tangential, strips, softness)
    defect = sort_cells(model, w, lane, tangential, slopes, radius, softness)
    if tangential.cell_outcome[w, JUMPED] != real(0.0):
        add_soft(model, w, lane, cells, patch, rolling, tangential, strips, softness, tangential.cell_jump)
    return defect


@wp.func
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


# Whether a column of L is not zero; n lines.
@wp.func_native("""
    for (int i = 0; i < n; ++i) if (L.data[at + (size_t)i * width] != 0.0) return 1;  // every lane for itself
    return 0;
""")
def is_loaded(n: int, width: int, L: wp.array(dtype=real), at: int) -> int: ...


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
                model, w, pair, count, model.surfaces.rows[model.pairs.first[pair]], TURNED, LIES,
                wp.pow(W, -elements.patches.near_power[pair]), elements.rolling.inverse,
                inverse_at(model, elements, pair, W), tangential.cell_slot, tangential.cell_sliding,
                tangential.cell_direction, tangential.cell_curvature, softness, strips.strip_frame,
            )  # fmt: skip
        pair += 1
    return good


# square = L^T Z of n lines of `count` columns, made symmetric to the last bit. Lanes over its lines.
@wp.func_native("""
    const double *a = L.data + at, *b = Z.data + at;
    double* s = square.data + at_square;
    WP_TILE_SYNC();
    for (int c = WP_TILE_THREAD_IDX; c < count; c += WP_TILE_BLOCK_DIM) {
        double* __restrict line = s + (size_t)c * width;
        for (int q = 0; q <= c; ++q) line[q] = 0.0;
        for (int i = 0; i < n; ++i) {
            const double f = b[(size_t)i * width + c];
            const double* l = a + (size_t)i * width;
            for (int q = 0; q <= c; ++q) line[q] += f * l[q];
        }
    }
    WP_TILE_SYNC();
    for (int c = WP_TILE_THREAD_IDX; c < count; c += WP_TILE_BLOCK_DIM)
        for (int q = c + 1; q < count; ++q) s[(size_t)c * width + q] = s[(size_t)q * width + c];
    WP_TILE_SYNC();
""")
def product_of_borders(
    n: int,
    width: int,
    count: int,
    at: int,
    L: wp.array(dtype=real),
    Z: wp.array(dtype=real),
    at_square: int,
    square: wp.array(dtype=real),
): ...


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


@wp.func
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
                    restrict(model, w, pair, count, 1, strips.strip_frame, strips.strip_direction, strips.strip_image)
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


@wp.func
def come_near(
    model: Model, p: Pattern, w: int, lane: int, held: int, cells: FrictionCells, patch: PatchScratch,
    rolling: RollingScratch, tangential: FrictionSolve, slopes: SlipSpeedSolve, strips: StripSolve,
    system: RetainedSystem, radius: wp.array(dtype=real), softness: wp.array(dtype=real),
) -> int:  # fmt: skip
    """Tractions near the solution, as `interior_point.come_near`; returns the number of iterations, -1 if a system is
    not definite."""
    pair = int(0)
    while pair < model.pairs.count:
        begin_inside(
            model, w, pair, tangential.cell_block[w, pair, COUNT], tangential.cell_diagonal, tangential.cell_right,
            radius, tangential.cell_tau, tangential.cell_slip, tangential.cell_slope,
        )  # fmt: skip
        pair += 1
    n = int(0)
    total = int(0)
    defect = real(1.0)
    while n < STEPS and defect > NEAR:
        sync()
        if lane == 0:
            tangential.cell_inside[w, MU] = real(0.0)
            tangential.cell_inside[w, LENGTH] = real(1.0)
        sync()
        all = int(0)
        pair = int(0)
        while pair < model.pairs.count:
            all += order_inside(
                model, w, pair, tangential.cell_block[w, pair, COUNT], radius, tangential.cell_tau,
                tangential.cell_slope, tangential.cell_order, tangential.cell_inside,
            )  # fmt: skip
            pair += 1
        sync()
        mu = CENTRED * real(2.0) * tangential.cell_inside[w, MU] / wp.max(real(all), real(1.0))
        prepare(model, p, w, lane, 1, patch, tangential, slopes, strips, radius, softness)
        pair = int(0)
        while pair < model.pairs.count:
            loaded = loaded_of(model, w, pair, tangential.cell_block[w, pair, COUNT], radius)
            pose_inside(
                model, w, pair, loaded, mu, radius, tangential.cell_tau, tangential.cell_slip, tangential.cell_order,
                tangential.cell_solution,
            )  # fmt: skip
            spread_order(
                model, w, pair, tangential.cell_block[w, pair, COUNT], loaded, 0, tangential.cell_order,
                tangential.cell_solution, strips.strip_residual,
            )  # fmt: skip
            pair += 1
        found = iterate(model, p, w, lane, 1, INSIDE, held, cells, patch, rolling, tangential, strips, system)
        if found < 0:
            return -1
        total += found
        pair = int(0)
        while pair < model.pairs.count:
            spread_order(
                model, w, pair, tangential.cell_block[w, pair, COUNT],
                loaded_of(model, w, pair, tangential.cell_block[w, pair, COUNT], radius), 1, tangential.cell_order,
                tangential.cell_solution, strips.strip_change,
            )  # fmt: skip
            pair += 1
        for move in range(2):
            pair = int(0)
            while pair < model.pairs.count:
                go_inside(
                    model, w, pair, loaded_of(model, w, pair, tangential.cell_block[w, pair, COUNT], radius), mu,
                    WITHIN, move, radius, tangential.cell_order, tangential.cell_solution, tangential.cell_tau,
                    tangential.cell_slope, tangential.cell_inside,
                )  # fmt: skip
                pair += 1
        find_slips(model, w, lane, cells, patch, rolling, tangential, strips, softness)
        defect = sort_cells(model, w, lane, tangential, slopes, radius, softness)
        n += 1
    return total


@wp.func
def loaded_of(model: Model, w: int, pair: int, count: int, radius: wp.array(dtype=real)) -> int:
    """Lines of the loaded cells of a pair."""
    loaded = int(0)
    i = int(0)
    while i < count:
        if radius[(w * model.pairs.count + pair) * model.capacity.cells + i] > real(0.0):
            loaded += 2
        i += 1
    return loaded


# Lines of the loaded cells of a pair, and the sum of their lambda c. Returns their number.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = model.capacity.cells;
    const double *x = tau.data + here * 2 * cap, *b = radius.data + here * cap, *lambda = slope.data + here * cap;
    int* list = order.data + here * 2 * cap;
    int m = 0; double sum = 0.0;
    for (int i = 0; i < count; ++i) if (b[i] > 0.0) {  // every lane counts for itself, in the same order
        if (WP_TILE_THREAD_IDX == 0) { list[m] = 2 * i; list[m + 1] = 2 * i + 1; }
        sum += lambda[i] * 0.5 * (b[i] * b[i] - x[2 * i] * x[2 * i] - x[2 * i + 1] * x[2 * i + 1]);
        m += 2;
    }
    WP_TILE_SYNC();
    if (WP_TILE_THREAD_IDX == 0) inside.data[(size_t)w * 2] += sum;
    return m;
""")
def order_inside(
    model: Model,
    w: int,
    pair: int,
    count: int,
    radius: wp.array(dtype=real),
    tau: wp.array(dtype=real),
    slope: wp.array(dtype=real),
    order: wp.array(dtype=int),
    inside: wp.array2d(dtype=real),
) -> int: ...


# By line <- by order, zero elsewhere; `back`: by order <- by line.
@wp.func_native("""
    const size_t at = ((size_t)w * model.pairs.count + pair) * 2 * model.capacity.cells;
    const int* list = order.data + at;
    WP_TILE_SYNC();
    if (!back) for (int l = WP_TILE_THREAD_IDX; l < 2 * count; l += WP_TILE_BLOCK_DIM) lines.data[at + l] = 0.0;
    WP_TILE_SYNC();
    for (int u = WP_TILE_THREAD_IDX; u < m; u += WP_TILE_BLOCK_DIM) {
        if (back) ordered.data[at + u] = lines.data[at + list[u]]; else lines.data[at + list[u]] = ordered.data[at + u];
    }
    WP_TILE_SYNC();
""")
def spread_order(
    model: Model,
    w: int,
    pair: int,
    count: int,
    m: int,
    back: int,
    order: wp.array(dtype=int),
    ordered: wp.array(dtype=real),
    lines: wp.array(dtype=real),
): ...


@kernel
def soften_patches(
    run: Run, tangential: FrictionSolve, patch: PatchScratch, rolling: RollingScratch, strips: StripSolve,
    impulses: ImpulsiveContact, residuals: Residuals,
):  # fmt: skip
    """Per (world, pair): S_tt and the condensed modes of both sides, and the own compliance of each cell."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or not rubs_on_patch(model, pair):
        return
    elements = model.elements[0]
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            soften_splines(
                model, elements, w, s, patch.far_window[w, pair, side, 1] * model.surfaces.rows[s],
                impulses.weight[w, pair], table_along(model, elements, w, pair, side, 0),
                trace_along(model, elements, w, pair, side), soft_at(model, elements, w, pair, side),
                rolling.rub_table, rolling.rub_trace, residuals.receptance, rolling.rub_soft,
            )  # fmt: skip
    if lane == 0 and tangential.answer_state[w, RENEWED] != 0:
        strips.strip_ready[w] = 0
    rows = model.surfaces.rows[model.pairs.first[pair]]
    rings = elements.rolling.ring_rows[pair]
    line = shear_line(rows, rings)
    kind = (elements.patches.columns[pair] + STRIPS_AROUND) * rows * line
    start = (w * model.pairs.count + pair) * elements.rolling.shear_numbers
    i = lane
    while i < tangential.cell_block[w, pair, COUNT]:
        row = tangential.cell_slot[w, pair, i] % rows
        at = start + row * line + rings + row
        own = ((w * model.pairs.count + pair) * model.capacity.cells + i) * 3
        tangential.cell_diagonal[own] = rolling.shear_near[at]
        tangential.cell_diagonal[own + 1] = real(0.0)
        tangential.cell_diagonal[own + 2] = rolling.shear_near[at + kind]
        i += wp.block_dim()


@kernel
def take_off_base(
    run: Run, cells: FrictionCells, patch: PatchScratch, rolling: RollingScratch, tangential: FrictionSolve,
    strips: StripSolve,
):  # fmt: skip
    """Per world: subtracts K tau_base from the right-hand side."""
    w, lane = wp.tid()
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0:
        return
    add_all(
        run.models[w], w, lane, real(-1.0), cells, patch, rolling, tangential, strips, tangential.cell_base,
        tangential.cell_right,
    )  # fmt: skip


@kernel
def solve_on_strips(
    run: Run, system: RetainedSystem, cells: FrictionCells, patch: PatchScratch, rolling: RollingScratch,
    tangential: FrictionSolve, slopes: SlipSpeedSolve, strips: StripSolve, patterns: wp.array(dtype=Pattern),
    radius: wp.array(dtype=real), softness: wp.array(dtype=real),
):  # fmt: skip
    """Per world: the tractions of all slots, from an initial guess, in discs of `radius`. If the problem does not
    converge, the attempt fails."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0:
        return
    held = held_motions(run.ctl, w, system.hold_count)
    defect = judge(model, w, lane, cells, patch, rolling, tangential, slopes, strips, radius, softness)
    n = int(0)
    bad = int(0)
    while defect > SETTLED and n < NEWTON * TRIES and bad == 0:
        if n > 0 and n % NEWTON == 0:
            if (
                come_near(
                    model,
                    patterns[0],
                    w,
                    lane,
                    held,
                    cells,
                    patch,
                    rolling,
                    tangential,
                    slopes,
                    strips,
                    system,
                    radius,
                    softness,
                )
                < 0
            ):
                bad = 1
            if lane == 0:
                strips.strip_ready[w] = 0
            defect = judge(model, w, lane, cells, patch, rolling, tangential, slopes, strips, radius, softness)
        renew = int(0)
        if strips.strip_ready[w] == 0 or frames_are_good(model, w, patch, tangential, strips, softness) == 0:
            renew = 1
            prepare(model, patterns[0], w, lane, 0, patch, tangential, slopes, strips, radius, softness)
        sync()
        if lane == 0:
            strips.strip_ready[w] = 1
        pair = int(0)
        while pair < model.pairs.count:
            pose_framed(
                model, w, pair, tangential.cell_block[w, pair, COUNT], tangential.cell_direction,
                tangential.cell_sliding, tangential.cell_slip, strips.strip_frame, strips.strip_residual,
            )  # fmt: skip
            pair += 1
        reduction = wp.max(FINER * SETTLED / defect, LEAST)
        if n == 0 or tangential.cell_outcome[w, CHANGED] != real(0.0):
            reduction = wp.max(reduction, COARSE)
        mark_states(model, w, lane, tangential)
        found = iterate(
            model, patterns[0], w, lane, renew, reduction, held, cells, patch, rolling, tangential, strips, system
        )
        if found < 0:
            bad = 1
        else:
            pair = int(0)
            while pair < model.pairs.count:
                move_framed(
                    model, w, pair, tangential.cell_block[w, pair, COUNT], radius, tangential.cell_direction,
                    tangential.cell_sliding, strips.strip_frame, strips.strip_change, tangential.cell_tau,
                )  # fmt: skip
                pair += 1
            defect = judge(model, w, lane, cells, patch, rolling, tangential, slopes, strips, radius, softness)
        n += 1
        if lane == 0:
            run.ctl[w].solves = run.ctl[w].solves + 1
    if lane == 0:
        if bad != 0:
            run.ctl[w].failure = run.ctl[w].failure | k.INDEFINITE
        elif defect > SETTLED:
            run.ctl[w].failure = run.ctl[w].failure | k.CYCLING


@wp.func
def mark_states(model: Model, w: int, lane: int, tangential: FrictionSolve):
    """The present kinds of the cells are those of the system."""
    cap = model.capacity.cells
    pair = int(0)
    while pair < model.pairs.count:
        start = (w * model.pairs.count + pair) * 2 * cap
        i = lane
        while i < tangential.cell_block[w, pair, COUNT]:
            tangential.cell_sliding[start + cap + i] = tangential.cell_sliding[start + i]
            i += wp.block_dim()
        pair += 1
    sync()
