r"""Coefficients of friction that depend on the slip speed: bounds mu(v) p, and their slopes condensed into the cells.

Law (`warpffrf.model.friction`). With w the slip of a cell in the step h, after contact (`entering_cells`), and
v = |w|/h, the bound is mu(v) p. In each round of tractions and bounds it is replaced by a tangent, whose slope is
condensed into K, the compliance of the cells with all other unknowns condensed (`cell_compliance`). With r = area w the
weak slip, b_k and r_k the present bound and slip and s = mu' p/(h area)

    |tau| = b_k + s (|r| - |r_k|)      <=>      |tau'| = b_k - s |r_k|   with   tau' = tau + s r,

since tau is opposite to r. tau' and r obey Coulomb's law with a constant disc, and r = r_0 + K tau gives

    r = r_0' + K' tau',      K' = (K^-1 + s)^-1,      r_0' = (1 + K s)^-1 r_0 = r_0 - K' s r_0,

symmetric, so the same solver applies. A rising law is a damper in parallel with the cells, a falling one a negative
damper: K' is positive definite, and the step has a unique solution, if K^-1 + s is, that is if the resistance of the
structure exceeds the fall of the bound (`slope_condensation`).

Slopes other than the tangent's have the same solution, and rounds converge, more slowly, with any slope that is nowhere
below it: the remaining fraction of an error is (s - mu' p/(h area))/(K^-1 + s), in [0, 1). A cell whose pivot is not
clearly positive therefore takes s = 0. With a falling law the rounds then are monotonic, because less traction is more
slip everywhere, and end at the solution next to the present state; the pair is marked. If the fall is too steep for G
alone, the compliance without retained coordinates, a shorter step does not help: its local part does not depend on h,
and s grows. If tangents do not converge, as at kinks, s is at least the slope of the chord to the slip of the previous
round. It is at most b_k/|r_k|, so the disc does not vanish.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells, FrictionSolve, SlipSpeedSolve
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.scratch import ImpulsiveContact
from warpffrf_kernels.core.state import FrictionState
from warpffrf_kernels.friction.cell_blocks import COUNT as USED
from warpffrf_kernels.friction.cell_blocks import first_line
from warpffrf_kernels.friction.cell_forces import SLIP
from warpffrf_kernels.friction.cells import cell_at
from warpffrf_kernels.friction.pressure_response import OPEN, ROUND, ROUNDS

wp.set_module_options(MODULE_OPTIONS)

ON_DISC = wp.constant(wp.float64(1.0e-9))  # of its radius: residual of the solver for a sliding cell
FOLLOWED = wp.constant(wp.float64(1.0e-6))  # of the largest bound: a round that ends this close to the law is the last
UNIQUE = wp.constant(0)  # marks of a pair: every slip was unique,
SHORTER = wp.constant(1)  # a shorter step would make it unique,
MILDER = wp.constant(2)  # or only a less steep law would
MARK = wp.constant(0)  # columns of steep: mark of the attempt, steps accepted with a mark, the largest mark of these
COUNT = wp.constant(1)
WORST = wp.constant(2)


@wp.func
def coefficient(model: Model, pair: int, speed: real) -> wp.vec2d:
    """mu and dmu/dv [s/m] of a pair at a slip speed [m/s]."""
    low = model.elements[0].slip_speeds.start[pair]
    high = low + model.elements[0].slip_speeds.pieces[pair]
    while high - low > 1:
        middle = (low + high) / 2
        if speed < model.elements[0].slip_speeds.piece[middle, 0]:
            high = middle
        else:
            low = middle
    x = speed - model.elements[0].slip_speeds.piece[low, 0]
    a = model.elements[0].slip_speeds.piece[low, 1]
    b = model.elements[0].slip_speeds.piece[low, 2]
    c = model.elements[0].slip_speeds.piece[low, 3]
    d = model.elements[0].slip_speeds.piece[low, 4]
    return wp.vec2d(a + x * (b + x * (c + x * d)), b + x * (real(2.0) * c + real(3.0) * x * d))


@wp.func
def share_of(model: Model, pair: int, speed: real) -> wp.vec2d:
    """The same, as fractions of the largest coefficient, with which bounds are computed (`traction_bounds`)."""
    return coefficient(model, pair, speed) / model.pairs.friction[pair]


@wp.func
def sliding(rows: int, w: int, pair: int, m: int, cells: FrictionCells, friction: FrictionState) -> wp.vec2d:
    """Slip [m] of a cell in the step, since contact."""
    i = cell_at(rows, m, 0)
    j = cell_at(rows, m, 1)
    return wp.vec2d(
        cells.slip[w, pair, i] + cells.late[w, pair, m] * friction.traction[w, pair, i],
        cells.slip[w, pair, j] + cells.late[w, pair, m] * friction.traction[w, pair, j],
    )


@kernel
def open_attempt(run: Run, cells: FrictionCells):
    """Per (world, pair): clears the mark."""
    w, pair = wp.tid()
    if run.ctl[w].attempt != 0 and run.models[w].elements[0].slip_speeds.pieces[pair] > 0:
        cells.steep[w, pair, MARK] = UNIQUE


@kernel
def follow_slips(run: Run, geometry: ContactGeometry, cells: FrictionCells, friction: FrictionState):
    """Per (world, pair), lanes over cells: bounds mu(v) p of the present slips, from those of the largest mu."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if (
        run.ctl[w].run == 0
        or run.ctl[w].moved == 0
        or model.elements[0].slip_speeds.pieces[pair] == 0
        or run.clk[w].h == real(0.0)
    ):
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    H = model.window.half
    m = (geometry.window[w, pair, 0] + H) * rows + lane
    while m < (geometry.window[w, pair, 1] + H + 1) * rows:
        if cells.bound[w, pair, m] > real(0.0):
            way = wp.length(sliding(rows, w, pair, m, cells, friction))
            cells.bound[w, pair, m] = cells.bound[w, pair, m] * share_of(model, pair, way / run.clk[w].h)[0]
        m += wp.block_dim()


@kernel
def begin_slips(
    run: Run, tangential: FrictionSolve, impulses: ImpulsiveContact, cells: FrictionCells, friction: FrictionState,
    slopes: SlipSpeedSolve,
):  # fmt: skip
    """Per (world, pair), lanes over slots: weak slips r of the present state, 0 for sticking cells."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0:
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    i = lane
    while i < tangential.cell_block[w, pair, USED]:
        m = tangential.cell_slot[w, pair, i]
        scale = real(0.0)
        if cells.cell_state[w, pair, m] == SLIP:
            scale = impulses.weight[w, pair] * cells.cell_area[w, pair, m]
        way = sliding(rows, w, pair, m, cells, friction)
        slopes.speed_slip[w, pair, 2 * i] = scale * way[0]
        slopes.speed_slip[w, pair, 2 * i + 1] = scale * way[1]
        slopes.speed_before[w, pair, i] = real(0.0)
        i += wp.block_dim()


@wp.func
def speed_of(h: real, w: int, pair: int, i: int, scale: real, speed_slip: wp.array3d(dtype=real)) -> real:
    """Slip speed [m/s] of a slot."""
    return wp.length(wp.vec2d(speed_slip[w, pair, 2 * i], speed_slip[w, pair, 2 * i + 1])) / (scale * h)


@kernel
def split_tractions(
    run: Run, tangential: FrictionSolve, impulses: ImpulsiveContact, cells: FrictionCells, slopes: SlipSpeedSolve
):
    """Per world, one lane: tau = tau' - s r with the slips r `found`, and whether the law is far enough from its
    tangents there to require another round."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or tangential.answer_state[w, OPEN] == 0 or lane != 0:
        return
    h = run.clk[w].h
    largest = real(0.0)
    off = real(0.0)
    pair = int(0)
    while pair < model.pairs.count:
        i = int(0)
        while i < tangential.cell_block[w, pair, USED]:
            m = tangential.cell_slot[w, pair, i]
            line = first_line(model, w, pair) + 2 * i
            s = slopes.speed_slope[w, pair, i]
            disc = wp.vec2d(slopes.speed_tau[line], slopes.speed_tau[line + 1])
            scale = impulses.weight[w, pair] * cells.cell_area[w, pair, m]
            slopes.speed_before[w, pair, i] = speed_of(h, w, pair, i, scale, slopes.speed_slip)
            slides = wp.length(disc) > (real(1.0) - ON_DISC) * tangential.cell_radius[w, pair, i]
            for d in range(2):
                r = real(0.0)
                if slides:
                    r = tangential.cell_slip[line + d]
                slopes.speed_slip[w, pair, 2 * i + d] = r
                tangential.cell_tau[line + d] = slopes.speed_tau[line + d] - s * r
            if model.elements[0].slip_speeds.pieces[pair] > 0:
                speed = speed_of(h, w, pair, i, scale, slopes.speed_slip)
                law = impulses.weight[w, pair] * cells.bound[w, pair, m] * share_of(model, pair, speed)[0]
                largest = wp.max(largest, law)
                if slides:
                    off = wp.max(off, wp.abs(tangential.cell_radius[w, pair, i] + s * scale * h * speed - law))
                elif tangential.cell_radius[w, pair, i] > law:
                    off = wp.max(off, wp.length(disc) - law)
            i += 1
        pair += 1
    slopes.speed_again[w, 0] = 0
    if off > FOLLOWED * largest:
        slopes.speed_again[w, 0] = 1


@kernel
def keep_following(run: Run, slopes: SlipSpeedSolve, tangential: FrictionSolve):
    """Per world: requests another round if the bounds do not follow the speeds yet."""
    w = wp.tid()
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or run.ctl[w].failure != 0:
        return
    if slopes.speed_again[w, 0] != 0 and tangential.answer_state[w, ROUND] < ROUNDS:
        tangential.answer_state[w, OPEN] = 1


@kernel
def mark(run: Run, cells: FrictionCells):
    """Per (world, pair): counts the accepted steps in which a marked pair slid, see the module docstring."""
    w, pair = wp.tid()
    if run.ctl[w].attempt == 0 or run.ctl[w].accept == 0 or run.models[w].elements[0].slip_speeds.pieces[pair] == 0:
        return
    if cells.steep[w, pair, MARK] != UNIQUE and cells.friction_work[w, pair, 0] < real(0.0):
        cells.steep[w, pair, COUNT] = cells.steep[w, pair, COUNT] + 1
        cells.steep[w, pair, WORST] = wp.max(cells.steep[w, pair, WORST], cells.steep[w, pair, MARK])
