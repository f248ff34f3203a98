"""Contact within the step: active set, pressures, and increments of the modes.

With `base` the pressures of the present state, `opened` its weak gaps and r, r_m its residuals including all contact
forces, the linearised system of `retained` reads, for the change ds of the pressures on the active set and the retained
increments z,

    A z - L^T ds = rhs,        L z + G ds = b,        b = -(opened - J sigma^-1 r_m),

L, J, `opened` and ds are multiplied by the weight of their pair (`impulsive_contact`), which is 1 if the pair is not
impulsive. G has a block for each pair, symmetric positive definite: U^T U. The nodes of each pair are eliminated
separately,

    W = U^-T L,    y = U^-T b,    (A + sum W^T W) z = rhs + sum W^T y,    ds = U^-1 (y - W z),

so pairs are coupled only in the sparse retained system, at a cost proportional to their number (`pair_elimination`).
Pressures that leave the set change by -base, which is moved to the right-hand sides.

Large patches have no matrix G, and G has blocks F between pairs that condensed or local modes of a body couple: for
these the elimination is the preconditioner of an iteration (`pressure_solve`).

All quantities are increments from the present state, so G, L, J and A may be those of a position a small fraction of a
column away (a modified Newton step, exact at its fixed point), and large forces in balance do not cancel in the
increments.

The set is then corrected (pressure not positive: out; linearised weak gap negative: in) and the solution is repeated
with frozen retained coordinates until the set has converged: a primal-dual active set method for the linearised
problem.
"""

import warp as wp

from warpffrf_kernels.bodies.interfaces import modal_line, side_of
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import ContactFields, ContactGeometry, ContactSolve
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.lanes import most, total
from warpffrf_kernels.core.model import PATCH, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync, vec3
from warpffrf_kernels.core.scratch import ImpulsiveContact, Residuals, RetainedSystem, Trial
from warpffrf_kernels.core.state import ContactState
from warpffrf_kernels.kinematics.line_of_centres import GUARD
from warpffrf_kernels.normal.contact_fields import local_gap, on_stencil
from warpffrf_kernels.normal.pair_forces import surface_of

wp.set_module_options(MODULE_OPTIONS)

GAP_TOLERANCE = wp.constant(wp.float64(1.0e-14))  # of the scene's length: a mean gap of round-off size does not close


@wp.func
def change_of(w: int, slot: int, normal: ContactSolve, contact: ContactState, fields: ContactFields) -> real:
    """Pressure of a slot minus that of the state at the start of the step."""
    pair = normal.slot_node[w, slot, 0]
    m = normal.slot_node[w, slot, 1]
    change = -fields.base[w, pair, m]
    if contact.active[w, pair, m] != 0:
        change += contact.pressure[w, pair, m]
    return change


@wp.func
def push_by_slots(
    model: Model, run: Run, w: int, normal: ContactSolve, contact: ContactState, fields: ContactFields,
    impulses: ImpulsiveContact, push: wp.array(dtype=real),
):  # fmt: skip
    """Adds J^T ds, the weighted load of the changes of all slots on the global modes, to `push` (W times modes)."""
    slot = int(0)
    while slot < run.ctl[w].slots:
        pair = normal.slot_node[w, slot, 0]
        change = impulses.weight[w, pair] * change_of(w, slot, normal, contact, fields)
        if change != real(0.0):
            start = (w * model.capacity.slots + slot) * model.pairs.most_modes
            for side in range(2):
                surface = surface_of(model, pair, side)
                modes = model.surfaces.modal_count[surface]
                axpy(modes, change, normal.J, start, push, w * model.modes.count + model.surfaces.modal_start[surface])
                start += modes
        slot += 1


@kernel
def modal_increments(
    run: Run, contact: ContactState, normal: ContactSolve, impulses: ImpulsiveContact, fields: ContactFields,
    residuals: Residuals, system: RetainedSystem, receptance: wp.array2d(dtype=real),
):  # fmt: skip
    """Per world, lanes over modes: increment sigma^-1 (-r_m - C_m^T dlam + J^T ds)."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    first = w * model.modes.count
    n = lane
    while n < model.modes.count:
        system.modal_step[first + n] = -residuals.modal_residual[w, n]
        n += wp.block_dim()
    sync()
    push_by_slots(model, run, w, normal, contact, fields, impulses, system.modal_step)
    row = int(0)
    while row < model.rows.count:
        for side in range(2):
            b = side_of(model, row, side)
            if b >= 0:
                pull = -system.z[w * model.retained.count + model.retained.row_offset + row]
                at = first + model.bodies.modal_start[b]
                axpy(
                    model.bodies.global_count[b], pull, residuals.C_modal, modal_line(model, w, row, b),
                    system.modal_step, at,
                )  # fmt: skip
        row += 1
    sync()
    n = lane
    while n < model.modes.count:
        system.modal_step[first + n] = receptance[w, n] * system.modal_step[first + n]
        if model.modes.dense_of[n] >= 0:
            system.modal_step[first + n] = system.z[
                w * model.retained.count + 6 * model.bodies.count + model.modes.dense_of[n]
            ]
        n += wp.block_dim()


@kernel
def correct_set(
    run: Run,
    trial: Trial,
    geometry: ContactGeometry,
    fields: ContactFields,
    system: RetainedSystem,
    contact: ContactState,
):
    """Per (world, pair), lanes over nodes of the window: the corrected active set, written to `proposed`."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    A = model.pairs.first[pair]
    body_a = model.surfaces.body[A]
    body_b = model.surfaces.body[model.pairs.second[pair]]
    rows = model.surfaces.rows[A]
    rows_b = model.surfaces.rows[model.pairs.second[pair]]
    H = model.window.half
    # motion of A relative to B at A's centre of mass
    a = w * model.retained.count + 6 * body_a
    move = vec3(system.z[a], system.z[a + 1], system.z[a + 2])
    spin = trial.axes[w, body_a] * vec3(system.z[a + 3], system.z[a + 4], system.z[a + 5])
    if body_b >= 0:
        b = w * model.retained.count + 6 * body_b
        turn_b = trial.axes[w, body_b] * vec3(system.z[b + 3], system.z[b + 4], system.z[b + 5])
        move -= vec3(system.z[b], system.z[b + 1], system.z[b + 2]) + wp.cross(
            turn_b, trial.r1[w, body_a] - trial.r1[w, body_b]
        )
        spin -= turn_b
    m = (geometry.window[w, pair, 0] + H) * rows + lane
    while m < (geometry.window[w, pair, 1] + H + 1) * rows:
        new = int(0)
        if contact.active[w, pair, m] != 0:
            if contact.pressure[w, pair, m] > real(0.0):
                new = int(1)
        elif geometry.area[w, pair, m] > real(0.0):
            f = vec3(geometry.wrench[w, pair, m, 0], geometry.wrench[w, pair, m, 1], geometry.wrench[w, pair, m, 2])
            t = vec3(geometry.wrench[w, pair, m, 3], geometry.wrench[w, pair, m, 4], geometry.wrench[w, pair, m, 5])
            value = fields.gap[w, pair, m] + wp.dot(f, move) + wp.dot(t, spin) - fields.first_step[w, pair, m]
            if model.pairs.family[pair] != PATCH:
                value -= on_stencil(model, w, pair, m, rows_b, geometry, fields.second_step)
            value += local_gap(model, w, pair, m, geometry, fields)
            if value < -GAP_TOLERANCE * model.length * geometry.area[w, pair, m]:
                new = int(1)
        fields.proposed[w, pair, m] = new
        m += wp.block_dim()


@wp.func
def first_change(w: int, pair: int, m: int, end: int, contact: ContactState, fields: ContactFields) -> int:
    """First node from m to `end` whose proposed state differs, `end` if none does; all lanes must call."""
    found = end
    while m < end:
        if fields.proposed[w, pair, m] != contact.active[w, pair, m]:
            found = wp.min(found, m)
        m += wp.block_dim()
    return -int(most(real(-found)))


@kernel
def accept_set(run: Run, geometry: ContactGeometry, fields: ContactFields, contact: ContactState):
    """Per world, lanes over nodes: adopts the corrected set, counts the changes, widens a window whose limits its patch
    has reached, checks the guards.

    The pressures of nodes that leave are set to zero. After `max_inner` solutions of one linearisation only the first
    node on the wrong side changes (Murty's least index, which cannot cycle if G is positive definite).
    """
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    H = model.window.half
    only_first = run.ctl[w].inner >= model.limits.max_inner
    changes = int(0)
    number = int(0)
    pair = int(0)
    while pair < model.pairs.count:
        A = model.pairs.first[pair]
        rows = model.surfaces.rows[A]
        left = geometry.window[w, pair, 0]
        right = geometry.window[w, pair, 1]
        m = (left + H) * rows + lane
        end = (right + H + 1) * rows
        only = int(-1)  # the node that may change; -1: all
        if only_first:
            only = end
            if changes == 0:
                only = first_change(w, pair, m, end, contact, fields)
        low = H + 1
        high = -H - 1
        changed = int(0)
        closed = int(0)
        while m < end:
            if fields.proposed[w, pair, m] != contact.active[w, pair, m] and (only < 0 or m == only):
                changed += 1
                contact.active[w, pair, m] = fields.proposed[w, pair, m]
                if fields.proposed[w, pair, m] == 0:
                    contact.pressure[w, pair, m] = real(0.0)
            if contact.active[w, pair, m] != 0:
                closed += 1
                o = m / rows - H
                low = wp.min(low, o)
                high = wp.max(high, o)
            m += wp.block_dim()
        changes += int(total(real(changed)))
        number += int(total(real(closed)))
        low = -int(most(real(-low)))
        high = int(most(real(high)))
        if low <= high and model.pairs.family[pair] != PATCH:  # a patch grows by its width
            if low < left + GUARD and left > -H:
                changes += 1
                if lane == 0:
                    geometry.window[w, pair, 0] = wp.max(low - GUARD - 1, -H)
                    run.ctl[w].reassemble = 1
            if high > right - GUARD and right < H:
                changes += 1
                if lane == 0:
                    geometry.window[w, pair, 1] = wp.min(high + GUARD + 1, H)
                    run.ctl[w].reassemble = 1
            if changes == 0 and lane == 0:
                if low < -H + GUARD and goes_on(model, A, geometry.center[w, pair, 0] - H - 1):
                    overflow(model, run.ctl, w, rows)
                if high > H - GUARD and goes_on(model, A, geometry.center[w, pair, 0] + H + 1):
                    overflow(model, run.ctl, w, rows)
                if model.surfaces.periodic[A] == 0:
                    if (
                        geometry.center[w, pair, 0] + low <= 0
                        or geometry.center[w, pair, 0] + high >= model.surfaces.columns[A] - 1
                    ):
                        run.ctl[w].edge = 1
        pair += 1
    if lane == 0:
        run.ctl[w].changes = changes
        run.ctl[w].active = number


@wp.func
def goes_on(model: Model, surface: int, column: int) -> bool:
    return model.surfaces.periodic[surface] != 0 or (column >= 0 and column < model.surfaces.columns[surface])


@wp.func
def overflow(model: Model, ctl: wp.array(dtype=Control), w: int, rows: int):
    ctl[w].failure = ctl[w].failure | k.CAPACITY
    ctl[w].spare = wp.max(ctl[w].spare, 2 * model.window.columns * rows)
