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
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, sync
from warpffrf_kernels.core.scratch import ImpulsiveContact, Residuals, RetainedSystem
from warpffrf_kernels.friction.cell_blocks import COUNT, first_line
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
from warpffrf_kernels.linear.retained_solve import held_motions
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.patch.spline_tables import real_side
from warpffrf_kernels.rolling.cell_frames import move_framed, pose_framed
from warpffrf_kernels.rolling.shear import STRIPS_AROUND, shear_line
from warpffrf_kernels.rolling.spline_tables import table_along, trace_along
from warpffrf_kernels.rolling.strip_products import add_all, soft_at
from warpffrf_kernels.rolling.strip_system import frames_are_good, iterate, prepare
from warpffrf_kernels.rolling.system import soften_splines

wp.set_module_options(MODULE_OPTIONS)

SETTLED = wp.constant(wp.float64(1.0e-11))  # of the largest bound: below the tolerance of the retained iteration
COARSE = wp.constant(wp.float64(0.05))  # reduction of a system while cells change their states
LEAST = wp.constant(wp.float64(1.0e-12))  # reduction, at most
FINER = wp.constant(wp.float64(0.3))  # of what the present defect needs
NEWTON = wp.constant(14)  # steps of Newton before it comes near by the interior-point method
TRIES = wp.constant(4)  # of these
INSIDE = wp.constant(wp.float64(1.0e-3))  # reduction of a system of the interior-point method
NEAR = wp.constant(wp.float64(1.0e-6))  # of the largest bound: where it ends


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
        elif not (defect <= SETTLED):  # or not a number
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
