r"""Tractions of the cells: simultaneous stick-slip solution of all cells, for given bounds.

With r(tau) = r_0 + K tau the weak slips due to the tractions, K symmetric positive definite (`cell_compliance`) and all
other unknowns condensed, Coulomb's law in every cell i reads

    |tau_i| <= b_i,     r_i = 0 where |tau_i| < b_i,     r_i = -lambda_i tau_i, lambda_i >= 0 where |tau_i| = b_i,

the conditions of the strictly convex problem min f = tau.K tau/2 + r_0.tau over discs: its solution exists and is
unique (Panagiotopoulos; Kalker's tangential problem). The regularised law adds `area h v_slip/b_i` to the diagonal, a
cell that the patch has reached during the step its softness (`bounds`).

**Newton.** With y_i = tau_i - r_i/c (c the stiffness of the cell's own block) a cell sticks if |y_i| <= b_i and is free
in both directions. A sliding cell is put on its circle, tau = b d + alpha t with d = y/|y| and t across it, and keeps
the free coordinate alpha: t.r + lambda alpha = 0 with lambda = -r.d/b, so the reduced matrix stays symmetric positive
definite. The system is solved by the factors of blocks (`friction.reduced_system`), or for large patches by conjugate
gradients with products over strips (`strip_system`), loosely while cells change their states.

**Guard.** Cells may slide to and fro from step to step. After PATIENCE steps that do not halve the defect, the
tractions are kept in their discs, and each step is shortened to where f is least along it. Discs are convex, so the
chord to the projected end of the step stays inside; r is linear along it, so no further product is needed:

    s = -r(0).dtau / (r(1) - r(0)).dtau,      at most 1.

If f does not fall along a step, one of the projected gradient, P(tau - r/c), takes its place. Near the solution s = 1
and the steps are Newton's. Where the bodies move so easily that the projection upsets their balance, the steps become
short; after GUARDED of them an interior-point method comes near (`friction.interior_point`), and Newton goes on.

A solution reduces the defect that it begins with to a FRACTION: the retained iteration around it, which renews bounds
and slips, reduces its own error less. The last ones, which begin with a small defect, go to the end.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import PatchScratch, RollingScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells, FrictionSolve, SlipSpeedSolve, StripSolve
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, dot, real, sync
from warpffrf_kernels.core.scratch import ImpulsiveContact, Residuals, RetainedSystem
from warpffrf_kernels.friction.cell_blocks import COUNT, FREE, add_slips, first_line
from warpffrf_kernels.friction.cells import rubs_on_patch
from warpffrf_kernels.friction.friction_cone import CHANGED, JUMPED, sort_cells
from warpffrf_kernels.friction.interior_point import (
    CENTRED,
    LENGTH,
    MU,
    STEPS,
    WITHIN,
    begin_inside,
    fill_inside,
    go_inside,
    order_inside,
    pose_inside,
    spread_order,
)
from warpffrf_kernels.friction.pressure_response import RENEWED
from warpffrf_kernels.friction.reduced_system import (
    CHANGED_ONES,
    EVERY,
    border_reduced,
    factor_pair,
    solve_reduced,
    step_by_blocks,
)
from warpffrf_kernels.linear.retained_solve import held_motions
from warpffrf_kernels.linear.sparse_factor import Pattern
from warpffrf_kernels.patch.spline_tables import real_side
from warpffrf_kernels.rolling.shear import STRIPS_AROUND, shear_line
from warpffrf_kernels.rolling.spline_tables import table_along, trace_along
from warpffrf_kernels.rolling.strip_products import add_all, soft_at
from warpffrf_kernels.rolling.strip_system import iterate, prepare, step_on_strips
from warpffrf_kernels.rolling.system import soften_splines

wp.set_module_options(MODULE_OPTIONS)

SETTLED = wp.constant(wp.float64(1.0e-11))
FRACTION = wp.constant(wp.float64(1.0e-3))
LATE = wp.constant(wp.float64(1.0e-3))  # unless this is small: the retained iteration is near its end
SLOW = wp.constant(wp.float64(0.1))  # of the previous defect: an old factor that leaves more is recomputed
CLOSE = wp.constant(wp.float64(1.0e-2))  # defect below which cells are expected to keep their states
COARSE = wp.constant(wp.float64(0.01))  # reduction of a system while cells change their states,
CAREFUL = wp.constant(wp.float64(1.0e-3))  # when the guard is near the end: the least loaded cells decide
LEAST = wp.constant(wp.float64(1.0e-12))  # reduction, at most
FINER = wp.constant(wp.float64(0.3))  # of what the present defect needs
STALLED = wp.constant(wp.float64(0.5))  # of the least defect: a step that leaves more has stalled
PATIENCE = wp.constant(3)  # stalled steps before the guard
GUARDED = wp.constant(12)  # steps with it before the interior-point method
TURNS = wp.constant(4)  # of all this
INSIDE = wp.constant(wp.float64(1.0e-3))  # reduction of a system of the interior-point method
NEAR = wp.constant(wp.float64(1.0e-6))  # of the largest bound: where it ends the first time


@wp.func
def add_compliance(
    model: Model, w: int, lane: int, part: real, cells: FrictionCells, patch: PatchScratch, rolling: RollingScratch,
    tangential: FrictionSolve, strips: StripSolve, D: wp.array(dtype=real), L: wp.array(dtype=real),
    M: wp.array(dtype=real), x: wp.array(dtype=real), y: wp.array(dtype=real),
):  # fmt: skip
    """y += part K x over the lines of all pairs, by strips or with the blocks D."""
    if model.elements[0].rolling.strips != 0:
        add_all(model, w, lane, part, cells, patch, rolling, tangential, strips, x, y)
    else:
        add_slips(model, w, lane, part, tangential, D, L, M, x, y)


@wp.func
def add_soft(
    model: Model, w: int, lane: int, cells: FrictionCells, patch: PatchScratch, rolling: RollingScratch,
    tangential: FrictionSolve, slopes: SlipSpeedSolve, strips: StripSolve, softness: wp.array(dtype=real),
    x: wp.array(dtype=real),
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
    add_compliance(
        model, w, lane, real(1.0), cells, patch, rolling, tangential, strips, slopes.speed_D, slopes.speed_L,
        slopes.speed_M, x, tangential.cell_slip,
    )  # fmt: skip


@wp.func
def find_slips(
    model: Model, w: int, lane: int, cells: FrictionCells, patch: PatchScratch, rolling: RollingScratch,
    tangential: FrictionSolve, slopes: SlipSpeedSolve, strips: StripSolve, softness: wp.array(dtype=real),
):  # fmt: skip
    """r of the tractions."""
    all = model.pairs.count * 2 * model.capacity.cells
    line = lane
    while line < all:
        tangential.cell_slip[w * all + line] = slopes.speed_right[w * all + line]
        line += wp.block_dim()
    sync()
    add_soft(model, w, lane, cells, patch, rolling, tangential, slopes, strips, softness, slopes.speed_tau)


# Tractions of a pair to the nearest points of their discs; `by_gradient`: of those a step along the slips away from
# `start`. Lanes over the slots.
@wp.func_native("""
    const size_t here = (size_t)w * model.pairs.count + pair; const int cap = model.capacity.cells;
    const double *x = start.data + here * 2 * cap, *r = slip.data + here * 2 * cap, *b = radius.data + here * cap;
    const double *k = diagonal.data + here * cap * 3, *soft = softness.data + here * cap;
    double* out = tau.data + here * 2 * cap;
    WP_TILE_SYNC();
    for (int i = WP_TILE_THREAD_IDX; i < count; i += WP_TILE_BLOCK_DIM) {
        double* y = out + 2 * i;
        if (by_gradient) {
            const double c = 0.5 * (k[3 * i] + k[3 * i + 2]) + soft[i];
            y[0] = x[2 * i] - r[2 * i] / c; y[1] = x[2 * i + 1] - r[2 * i + 1] / c;
        }
        const double size = ::sqrt(y[0] * y[0] + y[1] * y[1]);
        if (size > b[i]) { y[0] *= b[i] / size; y[1] *= b[i] / size; }
    }
    WP_TILE_SYNC();
""")
def confine_pair(
    model: Model,
    w: int,
    pair: int,
    count: int,
    by_gradient: int,
    diagonal: wp.array(dtype=real),
    radius: wp.array(dtype=real),
    softness: wp.array(dtype=real),
    start: wp.array(dtype=real),
    slip: wp.array(dtype=real),
    tau: wp.array(dtype=real),
): ...


@wp.func
def keep_start(model: Model, w: int, lane: int, tangential: FrictionSolve, slopes: SlipSpeedSolve):
    """The tractions and slips from which a step begins."""
    all = model.pairs.count * 2 * model.capacity.cells
    line = lane
    while line < all:
        tangential.cell_start[w * all + line] = slopes.speed_tau[w * all + line]
        tangential.cell_start_slip[w * all + line] = tangential.cell_slip[w * all + line]
        line += wp.block_dim()
    sync()


@wp.func
def confine(
    model: Model, w: int, by_gradient: int, tangential: FrictionSolve, slopes: SlipSpeedSolve,
    radius: wp.array(dtype=real), softness: wp.array(dtype=real),
):  # fmt: skip
    """The tractions of all pairs to the nearest points of their discs."""
    pair = int(0)
    while pair < model.pairs.count:
        confine_pair(
            model, w, pair, tangential.cell_block[w, pair, COUNT], by_gradient, slopes.speed_diagonal, radius, softness,
            tangential.cell_start, tangential.cell_start_slip, slopes.speed_tau,
        )  # fmt: skip
        pair += 1


@wp.func(inline=False)
def shorten(
    model: Model, w: int, lane: int, by_gradient: int, cells: FrictionCells, patch: PatchScratch,
    rolling: RollingScratch, tangential: FrictionSolve, slopes: SlipSpeedSolve, strips: StripSolve,
    radius: wp.array(dtype=real), softness: wp.array(dtype=real),
) -> int:  # fmt: skip
    """The step of the tractions from `cell_start` on, in their discs, to where f is least along it, and the slips
    there; by_gradient: of the projected gradient instead. Returns 0 if f does not fall."""
    confine(model, w, by_gradient, tangential, slopes, radius, softness)
    find_slips(model, w, lane, cells, patch, rolling, tangential, slopes, strips, softness)
    falls = real(0.0)
    rises = real(0.0)
    pair = int(0)
    while pair < model.pairs.count:
        at = first_line(model, w, pair)
        n = 2 * tangential.cell_block[w, pair, COUNT]
        line = at + lane
        while line < at + n:
            tangential.cell_jump[line] = slopes.speed_tau[line] - tangential.cell_start[line]
            line += wp.block_dim()
        sync()
        falls -= dot(n, tangential.cell_start_slip, at, tangential.cell_jump, at)
        rises += dot(n, tangential.cell_slip, at, tangential.cell_jump, at)
        pair += 1
    if not (falls > real(0.0)):
        return 0
    part = real(1.0)
    if rises > real(0.0):
        part = falls / (falls + rises)
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        line = first_line(model, w, pair) + lane
        end = first_line(model, w, pair) + 2 * tangential.cell_block[w, pair, COUNT]
        while line < end:
            slip = tangential.cell_start_slip[line]
            slopes.speed_tau[line] = tangential.cell_start[line] + part * tangential.cell_jump[line]
            tangential.cell_slip[line] = slip + part * (tangential.cell_slip[line] - slip)
            line += wp.block_dim()
        pair += 1
    sync()
    return 1


@wp.func(inline=False)
def come_near(
    model: Model, p: Pattern, w: int, lane: int, held: int, near: real, cells: FrictionCells, patch: PatchScratch,
    rolling: RollingScratch, tangential: FrictionSolve, slopes: SlipSpeedSolve, strips: StripSolve,
    system: RetainedSystem, radius: wp.array(dtype=real), softness: wp.array(dtype=real),
) -> int:  # fmt: skip
    """Tractions near the solution by the interior-point method, to the defect `near`, or until round-off in its
    barriers makes a system indefinite; returns the number of steps, -1 if the first system is."""
    pair = int(0)
    while pair < model.pairs.count:
        begin_inside(
            model, w, pair, tangential.cell_block[w, pair, COUNT], slopes.speed_diagonal, slopes.speed_right, radius,
            slopes.speed_tau, tangential.cell_slip, tangential.cell_slope,
        )  # fmt: skip
        pair += 1
    n = int(0)
    defect = real(1.0)
    while n < STEPS and defect > near:
        sync()
        if lane == 0:
            tangential.cell_inside[w, MU] = real(0.0)
            tangential.cell_inside[w, LENGTH] = real(1.0)
        sync()
        all = int(0)
        pair = int(0)
        while pair < model.pairs.count:
            m = order_inside(
                model, w, pair, tangential.cell_block[w, pair, COUNT], radius, slopes.speed_tau, tangential.cell_slope,
                tangential.cell_order, tangential.cell_inside,
            )  # fmt: skip
            if lane == 0:
                tangential.cell_block[w, pair, FREE] = m
            all += m
            pair += 1
        sync()
        mu = CENTRED * real(2.0) * tangential.cell_inside[w, MU] / wp.max(real(all), real(1.0))
        pair = int(0)
        while pair < model.pairs.count:
            pose_inside(
                model, w, pair, tangential.cell_block[w, pair, FREE], mu, radius, slopes.speed_tau,
                tangential.cell_slip, tangential.cell_order, tangential.cell_solution,
            )  # fmt: skip
            pair += 1
        bad = int(0)
        if model.elements[0].rolling.strips != 0:
            prepare(model, p, w, lane, 1, patch, tangential, slopes, strips, radius, softness)
            pair = int(0)
            while pair < model.pairs.count:
                spread_order(
                    model, w, pair, tangential.cell_block[w, pair, COUNT], tangential.cell_block[w, pair, FREE], 0,
                    tangential.cell_order, tangential.cell_solution, strips.strip_residual,
                )  # fmt: skip
                pair += 1
            if iterate(model, p, w, lane, 1, INSIDE, held, cells, patch, rolling, tangential, strips, system) < 0:
                bad = 1
            pair = int(0)
            while pair < model.pairs.count:
                spread_order(
                    model, w, pair, tangential.cell_block[w, pair, COUNT], tangential.cell_block[w, pair, FREE], 1,
                    tangential.cell_order, tangential.cell_solution, strips.strip_change,
                )  # fmt: skip
                pair += 1
        else:
            pair = int(0)
            while pair < model.pairs.count:
                fill_inside(
                    model, w, pair, tangential.cell_block[w, pair, FREE], slopes.speed_D, slopes.speed_L, radius,
                    softness, slopes.speed_tau, tangential.cell_slope, tangential.cell_order, tangential.cell_U,
                    tangential.cell_W,
                )  # fmt: skip
                pair += 1
            pair = int(0)
            while pair < model.pairs.count:
                bad += factor_pair(model, w, pair, tangential.cell_block[w, pair, FREE], tangential)
                pair += 1
            border_reduced(model, p, w, tangential, slopes)
            bad += solve_reduced(model, p, w, lane, 1, held, tangential, system)
        if bad != 0 and n == 0:
            return -1
        if bad != 0:
            return n
        for move in range(2):
            pair = int(0)
            while pair < model.pairs.count:
                go_inside(
                    model, w, pair, tangential.cell_block[w, pair, FREE], mu, WITHIN, move, radius,
                    tangential.cell_order, tangential.cell_solution, slopes.speed_tau, tangential.cell_slope,
                    tangential.cell_inside,
                )  # fmt: skip
                pair += 1
        find_slips(model, w, lane, cells, patch, rolling, tangential, slopes, strips, softness)
        defect = sort_cells(model, w, lane, 0, tangential, slopes, radius, softness)
        n += 1
    return n


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
    add_compliance(
        run.models[w], w, lane, real(-1.0), cells, patch, rolling, tangential, strips, tangential.cell_D,
        tangential.cell_bordered, tangential.friction_receptance, tangential.cell_base, tangential.cell_right,
    )  # fmt: skip


@wp.func
def wanted(model: Model, defect: real) -> real:
    """Defect at which a solution ends: not far from the end of the retained iteration, or where the tangents of bounds
    that depend on slip speeds need all slips (`slip_speed`), at once."""
    pair = int(0)
    while pair < model.pairs.count and model.elements[0].slip_speeds.pieces[pair] == 0:
        pair += 1
    if pair < model.pairs.count or defect < LATE:
        return SETTLED
    return FRACTION * defect


@kernel
def solve_tractions(
    run: Run, system: RetainedSystem, cells: FrictionCells, patch: PatchScratch, rolling: RollingScratch,
    tangential: FrictionSolve, slopes: SlipSpeedSolve, strips: StripSolve, patterns: wp.array(dtype=Pattern),
    radius: wp.array(dtype=real), softness: wp.array(dtype=real),
):  # fmt: skip
    """Per world: the tractions tau of all slots, from an initial guess, for r = right + K tau + softness tau and discs
    of `radius`. If the problem does not converge, the attempt fails.

    The factors of the last solution are reused as long as no cell changes its state and each step reduces the defect
    to a tenth: within a step of time the matrix hardly changes.
    """
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0:
        return
    held = held_motions(run.ctl, w, system.hold_count)
    factored = run.ctl[w].factored
    find_slips(model, w, lane, cells, patch, rolling, tangential, slopes, strips, softness)
    defect = sort_cells(model, w, lane, 1, tangential, slopes, radius, softness)
    settled = wanted(model, defect)
    least = defect
    before = real(0.0)
    stalled = int(0)
    guarded = int(0)  # steps with the guard
    turn = int(0)
    bad = int(0)
    while defect > settled and turn < TURNS and bad == 0:
        if guarded > GUARDED:
            near = NEAR
            if turn > 0:
                near = wp.min(settled, NEAR)
            turn += 1
            stalled = -GUARDED
            guarded = int(0)
            steps = come_near(
                model, patterns[0], w, lane, held, near, cells, patch, rolling, tangential, slopes, strips, system,
                radius, softness,
            )  # fmt: skip
            if steps < 0:
                bad = 1
            factored = 0
            if lane == 0:
                if model.elements[0].rolling.strips != 0:
                    strips.strip_ready[w] = 0
                run.ctl[w].solves = run.ctl[w].solves + steps
            sync()
            defect = sort_cells(model, w, lane, 0, tangential, slopes, radius, softness)
            least = defect
        else:
            keep_start(model, w, lane, tangential, slopes)
            if stalled == PATIENCE and guarded == 0:
                guarded = int(1)
                confine(model, w, 0, tangential, slopes, radius, softness)
                find_slips(model, w, lane, cells, patch, rolling, tangential, slopes, strips, softness)
                defect = sort_cells(model, w, lane, 0, tangential, slopes, radius, softness)
                keep_start(model, w, lane, tangential, slopes)
            if tangential.cell_outcome[w, JUMPED] != real(0.0):
                add_soft(
                    model, w, lane, cells, patch, rolling, tangential, slopes, strips, softness, tangential.cell_jump
                )
            changed = tangential.cell_outcome[w, CHANGED] != real(0.0)
            if model.elements[0].rolling.strips != 0:
                reduction = wp.max(FINER * settled / defect, LEAST)
                if defect > CLOSE or (changed and guarded == 0):
                    reduction = wp.max(reduction, COARSE)
                elif changed:
                    reduction = wp.max(reduction, CAREFUL)
                bad += step_on_strips(
                    model, patterns[0], w, lane, reduction, held, cells, patch, rolling, tangential, slopes, strips,
                    system, radius, softness,
                )  # fmt: skip
            else:
                renew = int(0)
                if changed:
                    renew = CHANGED_ONES
                if factored == 0 or (before > real(0.0) and defect > SLOW * before and not changed):
                    renew = EVERY
                bad += step_by_blocks(
                    model, patterns[0], w, lane, renew, held, tangential, slopes, system, radius, softness
                )
                factored = 1 - wp.min(bad, 1)
            before = defect
            if bad == 0 and guarded == 0:
                find_slips(model, w, lane, cells, patch, rolling, tangential, slopes, strips, softness)
            elif bad == 0:
                fell = shorten(model, w, lane, 0, cells, patch, rolling, tangential, slopes, strips, radius, softness)
                if fell == 0:
                    fell = shorten(
                        model, w, lane, 1, cells, patch, rolling, tangential, slopes, strips, radius, softness
                    )
                guarded += 1
                if fell == 0:  # round-off
                    guarded = GUARDED + 1
            defect = sort_cells(model, w, lane, 0, tangential, slopes, radius, softness)
            if defect > STALLED * least:
                stalled += 1
            least = wp.min(least, defect)
            if lane == 0:
                run.ctl[w].solves = run.ctl[w].solves + 1
    if lane == 0:
        run.ctl[w].factored = factored
        if bad != 0:
            run.ctl[w].failure = run.ctl[w].failure | k.INDEFINITE
        elif not (defect <= settled):  # or not a number
            run.ctl[w].failure = run.ctl[w].failure | k.TRACTIONS
