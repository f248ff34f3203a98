r"""Coefficients of friction that depend on the slip speed: bounds mu(v) p, and their slopes condensed into the cells.

Law (`warpffrf.model.friction`). With w the slip of a cell in the step h, after its touch (`entering_cells`), and
v = |w|/h, the bound is mu(v) p. In each round of tractions and bounds it is replaced by a tangent, whose slope is
condensed into K, the compliance of the cells with everything else condensed (`cell_compliance`). With r = area w the
weak slip, b_k and r_k bound and slip at hand and s = mu' p/(h area)

    |tau| = b_k + s (|r| - |r_k|)      <=>      |tau'| = b_k - s |r_k|   with   tau' = tau + s r,

as tau points against r. tau' and r obey Coulomb's law with a constant disc, and r = r_0 + K tau gives

    r = r_0' + K' tau',      K' = (K^-1 + s)^-1,      r_0' = (1 + K s)^-1 r_0 = r_0 - K' s r_0,

symmetric, so that the same solver takes them. A rise is a damper beside the cells, a fall a negative one: K' is
positive definite, and the step has one solution, where K^-1 + s is, that is where what holds the cells resists more
than the bound falls (`slope_condensation`).

Other slopes than the tangent's have the same solution, and rounds converge, more slowly, with any that is nowhere below
it: what is left of an error is (s - mu' p/(h area))/(K^-1 + s) of it, in [0, 1). So a cell whose pivot is not clearly
positive takes s = 0. With a fall the rounds then go one way only, as less traction is more slip everywhere, and end at
the solution next to the state at hand; the pair is marked. Where the fall is too steep for G alone, the compliance
without outer coordinates, a shorter step is no cure: its local part does not change with h, and s grows. Where tangents
do not settle, as at kinks, s is at least the slope of the chord to the slip of the round before. It is at most
b_k/|r_k|, so that the disc does not vanish.
"""

import warp as wp

from warpffrf_kernels.core.access import changed, inout, out
from warpffrf_kernels.core.control import Clock, Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.friction.cell_blocks import COUNT as USED
from warpffrf_kernels.friction.cell_blocks import first_line
from warpffrf_kernels.friction.cell_forces import SLIP
from warpffrf_kernels.friction.cells import cell_at
from warpffrf_kernels.friction.pressure_answer import OPEN, ROUND, ROUNDS

wp.set_module_options(MODULE_OPTIONS)

ON_DISC = wp.constant(wp.float64(1.0e-9))  # of its radius: what the solver leaves of a cell that slides
FOLLOWED = wp.constant(wp.float64(1.0e-6))  # of the largest bound: a round that ends so near the law is the last
UNIQUE = wp.constant(0)  # marks of a pair: every slip was the only one,
SHORTER = wp.constant(1)  # a shorter step would make it so,
MILDER = wp.constant(2)  # or a milder fall alone
MARK = wp.constant(0)  # columns of steep: mark of the attempt, steps accepted with a mark, the largest of them
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
    """The same, as parts of the largest coefficient, with which bounds are made (`traction_bounds`)."""
    return coefficient(model, pair, speed) / model.pairs.friction[pair]


@wp.func
def sliding(
    rows: int,
    w: int,
    pair: int,
    m: int,
    slip: wp.array3d(dtype=real),
    late: wp.array3d(dtype=real),
    traction: wp.array3d(dtype=real),
) -> wp.vec2d:
    """Slip [m] of a cell in the step, since its touch."""
    i = cell_at(rows, m, 0)
    j = cell_at(rows, m, 1)
    return wp.vec2d(
        slip[w, pair, i] + late[w, pair, m] * traction[w, pair, i],
        slip[w, pair, j] + late[w, pair, m] * traction[w, pair, j],
    )


@wp.kernel
def open_attempt(models: wp.array(dtype=Model), ctl: wp.array(dtype=Control), steep: out(wp.array3d(dtype=int))):
    """Per (world, pair): no mark yet."""
    w, pair = wp.tid()
    if ctl[w].attempt != 0 and models[w].elements[0].slip_speeds.pieces[pair] > 0:
        steep[w, pair, MARK] = UNIQUE


@wp.kernel
def follow_slips(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    window: wp.array3d(dtype=int),
    slip: wp.array3d(dtype=real),
    late: wp.array3d(dtype=real),
    traction: wp.array3d(dtype=real),
    bound: changed(wp.array3d(dtype=real)),
):
    """Per (world, pair), lanes over cells: bounds mu(v) p of the slips at hand, from those of the largest mu."""
    w, pair, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0 or model.elements[0].slip_speeds.pieces[pair] == 0 or clk[w].h == real(0.0):
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    H = model.window.half
    m = (window[w, pair, 0] + H) * rows + lane
    while m < (window[w, pair, 1] + H + 1) * rows:
        if bound[w, pair, m] > real(0.0):
            way = wp.length(sliding(rows, w, pair, m, slip, late, traction))
            bound[w, pair, m] = bound[w, pair, m] * share_of(model, pair, way / clk[w].h)[0]
        m += wp.block_dim()


@wp.kernel
def begin_slips(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    cell_block: wp.array3d(dtype=int),
    cell_slot: wp.array3d(dtype=int),
    weight: wp.array2d(dtype=real),
    cell_area: wp.array3d(dtype=real),
    cell_state: wp.array3d(dtype=int),
    late: wp.array3d(dtype=real),
    slip: wp.array3d(dtype=real),
    traction: wp.array3d(dtype=real),
    speed_slip: out(wp.array3d(dtype=real)),
    speed_before: out(wp.array3d(dtype=real)),
):
    """Per (world, pair), lanes over slots: weak slips r of the state at hand, 0 of what sticks in it."""
    w, pair, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    i = lane
    while i < cell_block[w, pair, USED]:
        m = cell_slot[w, pair, i]
        scale = real(0.0)
        if cell_state[w, pair, m] == SLIP:
            scale = weight[w, pair] * cell_area[w, pair, m]
        way = sliding(rows, w, pair, m, slip, late, traction)
        speed_slip[w, pair, 2 * i] = scale * way[0]
        speed_slip[w, pair, 2 * i + 1] = scale * way[1]
        speed_before[w, pair, i] = real(0.0)
        i += wp.block_dim()


@wp.func
def speed_of(h: real, w: int, pair: int, i: int, scale: real, speed_slip: wp.array3d(dtype=real)) -> real:
    """Slip speed [m/s] of a slot."""
    return wp.length(wp.vec2d(speed_slip[w, pair, 2 * i], speed_slip[w, pair, 2 * i + 1])) / (scale * h)


@wp.kernel
def split_tractions(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    cell_block: wp.array3d(dtype=int),
    cell_slot: wp.array3d(dtype=int),
    weight: wp.array2d(dtype=real),
    cell_area: wp.array3d(dtype=real),
    bound: wp.array3d(dtype=real),
    radius: wp.array3d(dtype=real),
    found: wp.array(dtype=real),
    speed_tau: wp.array(dtype=real),
    speed_slope: wp.array3d(dtype=real),
    answer_state: wp.array2d(dtype=int),
    speed_slip: inout(wp.array3d(dtype=real)),
    tau: out(wp.array(dtype=real)),
    speed_before: out(wp.array3d(dtype=real)),
    speed_again: out(wp.array2d(dtype=int)),
):
    """Per world, one lane: tau = tau' - s r with the slips r `found`, and whether the law is far enough from its
    tangents there to ask for another round."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].changes != 0 or answer_state[w, OPEN] == 0 or lane != 0:
        return
    h = clk[w].h
    largest = real(0.0)
    off = real(0.0)
    pair = int(0)
    while pair < model.pairs.count:
        i = int(0)
        while i < cell_block[w, pair, USED]:
            m = cell_slot[w, pair, i]
            line = first_line(model, w, pair) + 2 * i
            s = speed_slope[w, pair, i]
            disc = wp.vec2d(speed_tau[line], speed_tau[line + 1])
            scale = weight[w, pair] * cell_area[w, pair, m]
            speed_before[w, pair, i] = speed_of(h, w, pair, i, scale, speed_slip)
            slides = wp.length(disc) > (real(1.0) - ON_DISC) * radius[w, pair, i]
            for d in range(2):
                r = real(0.0)
                if slides:
                    r = found[line + d]
                speed_slip[w, pair, 2 * i + d] = r
                tau[line + d] = speed_tau[line + d] - s * r
            if model.elements[0].slip_speeds.pieces[pair] > 0:
                speed = speed_of(h, w, pair, i, scale, speed_slip)
                law = weight[w, pair] * bound[w, pair, m] * share_of(model, pair, speed)[0]
                largest = wp.max(largest, law)
                if slides:
                    off = wp.max(off, wp.abs(radius[w, pair, i] + s * scale * h * speed - law))
                elif radius[w, pair, i] > law:
                    off = wp.max(off, wp.length(disc) - law)
            i += 1
        pair += 1
    speed_again[w, 0] = 0
    if off > FOLLOWED * largest:
        speed_again[w, 0] = 1


@wp.kernel
def keep_following(
    ctl: wp.array(dtype=Control), speed_again: wp.array2d(dtype=int), answer_state: changed(wp.array2d(dtype=int))
):
    """Per world: another round where the bounds do not follow the speeds yet."""
    w = wp.tid()
    if ctl[w].run == 0 or ctl[w].changes != 0 or ctl[w].failure != 0:
        return
    if speed_again[w, 0] != 0 and answer_state[w, ROUND] < ROUNDS:
        answer_state[w, OPEN] = 1


@wp.kernel
def mark(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    friction_work: wp.array3d(dtype=real),
    steep: inout(wp.array3d(dtype=int)),
):
    """Per (world, pair): counts the accepted steps in which a pair slid that was marked, see the module docstring."""
    w, pair = wp.tid()
    if ctl[w].attempt == 0 or ctl[w].accept == 0 or models[w].elements[0].slip_speeds.pieces[pair] == 0:
        return
    if steep[w, pair, MARK] != UNIQUE and friction_work[w, pair, 0] < real(0.0):
        steep[w, pair, COUNT] = steep[w, pair, COUNT] + 1
        steep[w, pair, WORST] = wp.max(steep[w, pair, WORST], steep[w, pair, MARK])
