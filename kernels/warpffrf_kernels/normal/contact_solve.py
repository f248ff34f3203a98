"""Contact inside the step: active set, pressures, and what the outer coordinates and modes make of them.

With `base` the pressures of the present state, `opened` its weak gaps and r, r_m its residuals with all contact forces
in, the linearised system of `outer` reads, for the change ds of the pressures on the active set and the outer
increments z,

    A z - L^T ds = rhs,        L z + G ds = b,        b = -(opened - J sigma^-1 r_m),

L and J times the weight of their pair (`impulsive_contact`), 1 where it is not impulsive, `opened` and ds too. G has a
block for each pair, symmetric positive definite: U^T U. The hats of each pair are eliminated on their own,

    W = U^-T L,    y = U^-T b,    (A + sum W^T W) z = rhs + sum W^T y,    ds = U^-1 (y - W z),

so that pairs meet in the sparse outer system alone, at the cost of their number
(`pair_elimination`). Pressures that leave the set change by -base, which goes to the right-hand sides.

Where condensed or local modes of a body answer to several pairs, G has blocks F between these too. With M the system
without them, which the elimination solves, (M + F) ds = b is solved by conjugate gradients with M as preconditioner
(`between_pairs`): F is small beside M where patches lie apart.

Everything is counted from the present state, so that G, L, J and A may be those of a position a small fraction of a
column away (a modified Newton step, exact at its fixed point), and so that large forces in balance do not cancel in the
increments.

The set is then corrected (pressure not positive: out; linearised weak gap negative: in) and the solve repeated with the
outer coordinates frozen until the set has settled: a primal-dual active set method on the linearised problem.
"""

import warp as wp

from warpffrf_kernels.bodies.interfaces import modal_line, side_of
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import changed, inout, out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import PATCH, Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, mat33, real, sync, vec3
from warpffrf_kernels.kinematics.line_of_centres import GUARD
from warpffrf_kernels.normal.contact_fields import local_gap, on_stencil
from warpffrf_kernels.normal.pair_forces import surface_of

wp.set_module_options(MODULE_OPTIONS)

GAP_TOLERANCE = wp.constant(wp.float64(1.0e-14))  # of the scene's length: a mean gap of round-off size does not close


@wp.func
def change_of(
    w: int,
    slot: int,
    slot_hat: wp.array3d(dtype=int),
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    base: wp.array3d(dtype=real),
) -> real:
    """Pressure of a slot less that of the state the step starts from."""
    pair = slot_hat[w, slot, 0]
    m = slot_hat[w, slot, 1]
    change = -base[w, pair, m]
    if active[w, pair, m] != 0:
        change += pressure[w, pair, m]
    return change


@wp.func
def push_by_slots(
    model: Model,
    ctl: wp.array(dtype=Control),
    w: int,
    slot_hat: wp.array3d(dtype=int),
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    base: wp.array3d(dtype=real),
    weight: wp.array2d(dtype=real),
    J: wp.array(dtype=real),
    push: wp.array(dtype=real),
):
    """Adds J^T ds, the weighted changes of all slots on the global modes, to `push` (W times modes)."""
    slot = int(0)
    while slot < ctl[w].slots:
        pair = slot_hat[w, slot, 0]
        change = weight[w, pair] * change_of(w, slot, slot_hat, active, pressure, base)
        if change != real(0.0):
            start = (w * model.capacity.slots + slot) * model.pairs.most_modes
            for side in range(2):
                surface = surface_of(model, pair, side)
                modes = model.surfaces.modal_count[surface]
                axpy(modes, change, J, start, push, w * model.modes.count + model.surfaces.modal_start[surface])
                start += modes
        slot += 1


@wp.kernel
def modal_increments(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    active: wp.array3d(dtype=int),
    slot_hat: wp.array3d(dtype=int),
    weight: wp.array2d(dtype=real),
    J: wp.array(dtype=real),
    pressure: wp.array3d(dtype=real),
    base: wp.array3d(dtype=real),
    C_modal: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    modal_residual: wp.array2d(dtype=real),
    z: wp.array(dtype=real),
    modal_step: inout(wp.array(dtype=real)),
):
    """Per world, lanes over modes: increment sigma^-1 (-r_m - C_m^T dlam + J^T ds)."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0:
        return
    first = w * model.modes.count
    n = lane
    while n < model.modes.count:
        modal_step[first + n] = -modal_residual[w, n]
        n += wp.block_dim()
    sync()
    push_by_slots(model, ctl, w, slot_hat, active, pressure, base, weight, J, modal_step)
    row = int(0)
    while row < model.rows.count:
        for side in range(2):
            b = side_of(model, row, side)
            if b >= 0:
                pull = -z[w * model.outer.count + model.outer.row_offset + row]
                at = first + model.bodies.modal_start[b]
                axpy(model.bodies.global_count[b], pull, C_modal, modal_line(model, w, row, b), modal_step, at)
        row += 1
    sync()
    n = lane
    while n < model.modes.count:
        modal_step[first + n] = receptance[w, n] * modal_step[first + n]
        if model.modes.dense_of[n] >= 0:
            modal_step[first + n] = z[w * model.outer.count + 6 * model.bodies.count + model.modes.dense_of[n]]
        n += wp.block_dim()


@wp.kernel
def correct_set(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    axes: wp.array2d(dtype=mat33),
    r1: wp.array2d(dtype=vec3),
    window: wp.array3d(dtype=int),
    area: wp.array3d(dtype=real),
    wrench: wp.array4d(dtype=real),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    gap: wp.array3d(dtype=real),
    first_step: wp.array3d(dtype=real),
    second_step: wp.array(dtype=real),
    first_local: wp.array(dtype=real),
    second_local: wp.array(dtype=real),
    z: wp.array(dtype=real),
    pressure: wp.array3d(dtype=real),
    active: wp.array3d(dtype=int),
    proposed: out(wp.array3d(dtype=int)),
):
    """Per (world, pair), lanes over hats of the window: the corrected active set, written to `proposed`."""
    w, pair, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0:
        return
    A = model.pairs.first[pair]
    body_a = model.surfaces.body[A]
    body_b = model.surfaces.body[model.pairs.second[pair]]
    rows = model.surfaces.rows[A]
    rows_b = model.surfaces.rows[model.pairs.second[pair]]
    H = model.window.half
    # motion of A relative to B at A's centre of mass
    a = w * model.outer.count + 6 * body_a
    move = vec3(z[a], z[a + 1], z[a + 2])
    spin = axes[w, body_a] * vec3(z[a + 3], z[a + 4], z[a + 5])
    if body_b >= 0:
        b = w * model.outer.count + 6 * body_b
        turn_b = axes[w, body_b] * vec3(z[b + 3], z[b + 4], z[b + 5])
        move -= vec3(z[b], z[b + 1], z[b + 2]) + wp.cross(turn_b, r1[w, body_a] - r1[w, body_b])
        spin -= turn_b
    m = (window[w, pair, 0] + H) * rows + lane
    while m < (window[w, pair, 1] + H + 1) * rows:
        new = int(0)
        if active[w, pair, m] != 0:
            if pressure[w, pair, m] > real(0.0):
                new = int(1)
        elif area[w, pair, m] > real(0.0):
            f = vec3(wrench[w, pair, m, 0], wrench[w, pair, m, 1], wrench[w, pair, m, 2])
            t = vec3(wrench[w, pair, m, 3], wrench[w, pair, m, 4], wrench[w, pair, m, 5])
            value = gap[w, pair, m] + wp.dot(f, move) + wp.dot(t, spin) - first_step[w, pair, m]
            if model.pairs.family[pair] != PATCH:
                value -= on_stencil(model, w, pair, m, rows_b, stencil, stencil_at, second_step)
            value += local_gap(model, w, pair, m, stencil, stencil_at, first_local, second_local)
            if value < -GAP_TOLERANCE * model.length * area[w, pair, m]:
                new = int(1)
        proposed[w, pair, m] = new
        m += wp.block_dim()


@wp.kernel
def accept_set(
    models: wp.array(dtype=Model),
    center: wp.array3d(dtype=int),
    proposed: wp.array3d(dtype=int),
    ctl: inout(wp.array(dtype=Control)),
    active: inout(wp.array3d(dtype=int)),
    pressure: out(wp.array3d(dtype=real)),
    window: changed(wp.array3d(dtype=int)),
):
    """Per world: take over the corrected set, count the changes, widen a window that its patch has reached, check the
    guards.

    The pressures of hats that leave are zeroed. After `max_inner` solves of one linearisation only the first hat that
    is on the wrong side changes it (Murty's least index, which cannot cycle where G is positive definite).
    """
    w = wp.tid()
    model = models[w]
    if ctl[w].run == 0:
        return
    H = model.window.half
    changes = int(0)
    number = int(0)
    pair = int(0)
    while pair < model.pairs.count:
        A = model.pairs.first[pair]
        rows = model.surfaces.rows[A]
        low = H + 1
        high = -H - 1
        m = (window[w, pair, 0] + H) * rows
        while m < (window[w, pair, 1] + H + 1) * rows:
            if proposed[w, pair, m] != active[w, pair, m] and (changes == 0 or ctl[w].inner < model.limits.max_inner):
                changes += 1
                active[w, pair, m] = proposed[w, pair, m]
                if proposed[w, pair, m] == 0:
                    pressure[w, pair, m] = real(0.0)
            if active[w, pair, m] != 0:
                number += 1
                o = m / rows - H
                low = wp.min(low, o)
                high = wp.max(high, o)
            m += 1
        if low <= high and model.pairs.family[pair] != PATCH:  # a patch grows by its width
            if low < window[w, pair, 0] + GUARD and window[w, pair, 0] > -H:
                window[w, pair, 0] = wp.max(low - GUARD - 1, -H)
                changes += 1
                ctl[w].reassemble = 1
            if high > window[w, pair, 1] - GUARD and window[w, pair, 1] < H:
                window[w, pair, 1] = wp.min(high + GUARD + 1, H)
                changes += 1
                ctl[w].reassemble = 1
            if changes == 0:
                if low < -H + GUARD and goes_on(model, A, center[w, pair, 0] - H - 1):
                    overflow(model, ctl, w, rows)
                if high > H - GUARD and goes_on(model, A, center[w, pair, 0] + H + 1):
                    overflow(model, ctl, w, rows)
                if model.surfaces.periodic[A] == 0:
                    if center[w, pair, 0] + low <= 0 or center[w, pair, 0] + high >= model.surfaces.columns[A] - 1:
                        ctl[w].edge = 1
        pair += 1
    ctl[w].changes = changes
    ctl[w].active = number


@wp.func
def goes_on(model: Model, surface: int, column: int) -> bool:
    return model.surfaces.periodic[surface] != 0 or (column >= 0 and column < model.surfaces.columns[surface])


@wp.func
def overflow(model: Model, ctl: wp.array(dtype=Control), w: int, rows: int):
    ctl[w].failure = ctl[w].failure | k.CAPACITY
    ctl[w].spare = wp.max(ctl[w].spare, 2 * model.window.columns * rows)
