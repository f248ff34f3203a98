"""Rows of the local compliance G = Psi^T (C_A + C_B) Psi on the hats in play, each in a slot, assembled once each.

With the hat compliance D of each surface (`u = D f`, both in hats) and the stencil l_j, the load of the second surface
under a unit pressure hat j of the first:

    G_ij = (M D_A M)_ij + l_i . (D_B l_j) + J_i sigma^-1 J_j^T,      J_i = [-(M Phi_A)_i, -l_i Phi_B].

The last term condenses the global modes: their tangent sigma is diagonal (`receptance` = 1/sigma), so it costs modes x
slots^2 / 2. `M D_A M` is precomputed; `T_j = D_B l_j` is kept, because it also gives the displacement of the second
surface at every node of the window. A slot stays assembled until the grids move against each other, so an active set
that changes pays for the change only.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import inout, out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import PATCH, Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, dot, mat33, real, sync, vec3
from warpffrf_kernels.normal.lagged import ends_lag
from warpffrf_kernels.normal.lasting import AGE, BEGUN, COUNT, OLDER, PATIENCE, REST, RESTS, ROWS
from warpffrf_kernels.surfaces.responses import own_load, place_in_table

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def short_of(model: Model) -> int:
    """What an attempt fails of that runs out of slots: the host's room, where the capacities of the contacts allow
    more, else these: then a smaller step may do, whose iterations do not overshoot."""
    if model.capacity.slots < model.capacity.slot_limit:
        return int(k.ROOM)
    return int(k.CAPACITY)


@wp.func
def lacks_rows(
    model: Model, w: int, active: wp.array3d(dtype=int), slot_of: wp.array3d(dtype=int)
) -> bool:  # fmt: skip
    """Whether an active hat has no slot."""
    lacking = bool(False)
    pair = int(0)
    while pair < model.pairs.count:
        m = int(0)
        while m < model.window.hats:
            if active[w, pair, m] != 0 and slot_of[w, pair, m] < 0:
                lacking = True
            m += 1
        pair += 1
    return lacking


@wp.kernel
def take_slots(
    models: wp.array(dtype=Model),
    active: wp.array3d(dtype=int),
    area: wp.array3d(dtype=real),
    ctl: inout(wp.array(dtype=Control)),
    lasting: inout(wp.array2d(dtype=int)),
    phase: inout(wp.array3d(dtype=real)),
    slot_of: inout(wp.array3d(dtype=int)),
    slot_hat: out(wp.array3d(dtype=int)),
):
    """Per world: a slot for each active hat that has none; all slots are given back first when the grids have
    moved, or where rows of an earlier attempt do not serve. Where rows stand from step to step, all cells of a patch
    take one then, as far as there is room: those at its edge come under pressure and leave it.
    """
    w = wp.tid()
    model = models[w]
    if ctl[w].run == 0:
        return
    capacity = model.window.hats
    spare = int(0)
    if lasting[w, OLDER] != 0 and (ctl[w].iteration >= PATIENCE or lacks_rows(model, w, active, slot_of)):
        ctl[w].reassemble = 1
        if lasting[w, AGE] <= 1:
            lasting[w, RESTS] = REST
    lasting[w, BEGUN] = 0
    if ctl[w].reassemble != 0:
        lasting[w, OLDER] = 0
        lasting[w, ROWS] = 1
        lasting[w, AGE] = 0
        spare = int(ctl[w].mode == k.DYNAMIC and model.elements[0].patches.lasting != 0)
        ctl[w].slots = 0
        pair = int(0)
        while pair < model.pairs.count:
            m = int(0)
            while m < capacity:
                slot_of[w, pair, m] = -1
                m += 1
            for i in range(4):
                phase[w, pair, i] = phase[w, pair, 4 + i]
            for i in range(2):
                phase[w, pair, 8 + i] = phase[w, pair, 10 + i]
            pair += 1
        ctl[w].reassemble = 0
        ctl[w].recenter = 0
    count = ctl[w].slots
    ctl[w].fresh = count
    if ctl[w].reweighed != 0 or ends_lag(model, ctl, w):
        ctl[w].fresh = 0
        ctl[w].reweighed = 0
    number = int(0)
    pair = int(0)
    while pair < model.pairs.count:
        m = int(0)
        while m < capacity:
            if active[w, pair, m] != 0:
                number += 1
                if slot_of[w, pair, m] < 0:
                    if count < model.capacity.slots:
                        slot_of[w, pair, m] = count
                        slot_hat[w, count, 0] = pair
                        slot_hat[w, count, 1] = m
                    count += 1
            m += 1
        pair += 1
    pair = int(0)
    while pair < model.pairs.count and spare != 0:
        m = int(0)
        cells = model.elements[0].patches.columns[pair] * model.surfaces.rows[model.pairs.first[pair]]
        while m < cells and count < model.capacity.slots:
            if slot_of[w, pair, m] < 0 and area[w, pair, m] > real(0.0):
                slot_of[w, pair, m] = count
                slot_hat[w, count, 0] = pair
                slot_hat[w, count, 1] = m
                count += 1
            m += 1
        pair += 1
    if count > model.capacity.slots:
        ctl[w].failure = ctl[w].failure | short_of(model)
        ctl[w].spare = wp.max(ctl[w].spare, count)
        ctl[w].run = 0
        count = model.capacity.slots
    ctl[w].slots = count
    ctl[w].active = number
    lasting[w, COUNT] = count


@wp.func
def respond_to(
    model: Model,
    w: int,
    pair: int,
    m: int,
    first: int,
    count: int,
    center: wp.array3d(dtype=int),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    T: wp.array(dtype=real),
    start: int,
):
    """Adds D_B l of hat m to `count` numbers of T from `start` on, column `first` of the second window."""
    if model.surfaces.rigid[model.pairs.second[pair]] != 0:
        return
    table = model.responses.normal[own_load(model, 2 * pair + 1)]
    origin = center[w, pair, 1] - model.window.second_half
    c = int(0)
    while c < model.window.stencil_columns:
        r = int(0)
        while r < model.window.stencil_rows:
            weight = stencil[w, pair, m, c * model.window.stencil_rows + r]
            if weight != real(0.0):
                at = place_in_table(
                    model, table, origin + stencil_at[w, pair, m, 0] + c, stencil_at[w, pair, m, 1] + r, origin + first
                )
                if at >= 0:
                    axpy(count, weight, model.responses.number, at, T, start)
            r += 1
        c += 1


@wp.kernel
def respond(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    center: wp.array3d(dtype=int),
    second_window: wp.array3d(dtype=int),
    slot_hat: wp.array3d(dtype=int),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    T: inout(wp.array(dtype=real)),
):
    """Per world: T_j = D_B l_j of the fresh slots on the nodes of the second window."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0:
        return
    slot = ctl[w].fresh
    while slot < ctl[w].slots:
        pair = slot_hat[w, slot, 0]
        if model.pairs.family[pair] == PATCH:
            slot += 1
            continue
        m = slot_hat[w, slot, 1]
        B = model.pairs.second[pair]
        rows = model.surfaces.rows[B]
        first = second_window[w, pair, 0]
        count = (second_window[w, pair, 1] - first + 1) * rows
        start = (w * model.capacity.slots + slot) * model.window.nodes + first * rows
        i = lane
        while i < count:
            T[start + i] = real(0.0)
            i += wp.block_dim()
        sync()
        respond_to(model, w, pair, m, first, count, center, stencil, stencil_at, T, start)
        slot += 1


@wp.func
def node_of(model: Model, surface: int, column: int, row: int) -> int:
    """Flat grid node of a column counted over full turns; -1 where the grid has none."""
    turn = model.surfaces.turn[surface]
    c = column
    if turn > 0:
        c = ((column % turn) + turn) % turn
    if c < 0 or c >= model.surfaces.columns[surface]:
        return -1
    return c * model.surfaces.rows[surface] + row


@wp.kernel
def modal_rows(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    center: wp.array3d(dtype=int),
    slot_hat: wp.array3d(dtype=int),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    weight: wp.array2d(dtype=real),
    J: inout(wp.array(dtype=real)),
):
    """Per world: gradient of the weak gap of the fresh slots by the global modes of A, then of B, times the weight of
    the pair."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0:
        return
    slot = ctl[w].fresh
    while slot < ctl[w].slots:
        pair = slot_hat[w, slot, 0]
        if model.pairs.family[pair] == PATCH:
            slot += 1
            continue
        m = slot_hat[w, slot, 1]
        A = model.pairs.first[pair]
        B = model.pairs.second[pair]
        modes_a = model.surfaces.modal_count[A]
        modes_b = model.surfaces.modal_count[B]
        start = (w * model.capacity.slots + slot) * model.pairs.most_modes
        i = lane
        while i < modes_a + modes_b:
            J[start + i] = real(0.0)
            i += wp.block_dim()
        sync()
        column = m / model.surfaces.rows[A]
        node = node_of(model, A, center[w, pair, 0] + column - model.window.half, m - column * model.surfaces.rows[A])
        if node >= 0:
            at = model.surfaces.mode_start[A] + node * modes_a
            axpy(modes_a, -weight[w, pair], model.surfaces.mode_moment, at, J, start)
        base = center[w, pair, 1] - model.window.second_half + stencil_at[w, pair, m, 0]
        c = int(0)
        while c < model.window.stencil_columns:
            r = int(0)
            while r < model.window.stencil_rows:
                part = weight[w, pair] * stencil[w, pair, m, c * model.window.stencil_rows + r]
                if part != real(0.0):
                    node = node_of(model, B, base + c, stencil_at[w, pair, m, 1] + r)
                    if node >= 0:
                        at = model.surfaces.mode_start[B] + node * modes_b
                        axpy(modes_b, -part, model.surfaces.mode_normal, at, J, start + modes_a)
                r += 1
            c += 1
        slot += 1


@wp.func
def outer_row(
    model: Model,
    w: int,
    pair: int,
    lane: int,
    f: vec3,
    t: vec3,
    axes: wp.array2d(dtype=mat33),
    r1: wp.array2d(dtype=vec3),
    weight: wp.array2d(dtype=real),
    J: wp.array(dtype=real),
    start: int,
    C_receptance: wp.array(dtype=real),
    line: int,
    L: wp.array(dtype=real),
):
    """The line of L that begins at `line`, [d/d(rigid), -J sigma^-1 C_modal^T] over the columns in `coupled` of the
    pair: of a quantity with the gradient (f, t) by the motion of A relative to B, and J (from `start`) by the modes,
    times the weight of the pair, which J has already."""
    A = model.surfaces.body[model.pairs.first[pair]]
    B = model.surfaces.body[model.pairs.second[pair]]
    if lane == 0:
        push = weight[w, pair] * f
        turn = weight[w, pair] * t
        t_a = wp.transpose(axes[w, A]) * turn
        for i in range(3):
            L[line + i] = push[i]
            L[line + 3 + i] = t_a[i]
            L[line + 6 + i] = real(0.0)  # the ground does not move
            L[line + 9 + i] = real(0.0)
        if B >= 0:
            t_b = wp.transpose(axes[w, B]) * (turn + wp.cross(r1[w, A] - r1[w, B], push))
            for i in range(3):
                L[line + 6 + i] = -push[i]
                L[line + 9 + i] = -t_b[i]
    first_a = model.surfaces.modal_start[model.pairs.first[pair]]
    count_a = model.surfaces.modal_count[model.pairs.first[pair]]
    first_b = model.surfaces.modal_start[model.pairs.second[pair]]
    count = model.pairs.coupled_count[pair]
    c = 12 + lane
    while c < count:
        column = model.pairs.coupled[pair, c]
        if column < model.outer.row_offset:  # a mode that is not condensed
            mode = model.dense.mode[column - 6 * model.bodies.count]
            at = mode - first_a
            if at < 0 or at >= count_a:
                at = count_a + mode - first_b
            L[line + c] = J[start + at]
        else:
            at = (w * model.rows.count + column - model.outer.row_offset) * model.modes.count
            value = -dot(model.bodies.global_count[A], J, start, C_receptance, at + first_a)
            if B >= 0:
                value -= dot(model.bodies.global_count[B], J, start + count_a, C_receptance, at + first_b)
            L[line + c] = value
        c += wp.block_dim()


@wp.kernel
def outer_rows(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    axes: wp.array2d(dtype=mat33),
    r1: wp.array2d(dtype=vec3),
    wrench: wp.array4d(dtype=real),
    weight: wp.array2d(dtype=real),
    slot_hat: wp.array3d(dtype=int),
    J: wp.array(dtype=real),
    C_receptance: wp.array(dtype=real),
    L: out(wp.array(dtype=real)),
):
    """Per world: gradient L of the gap by the outer coordinates times the weight of the pair (`outer_row`); for all
    slots when the outer matrix is new, else for the fresh ones."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0:
        return
    slot = ctl[w].fresh
    if ctl[w].refresh != 0 and ctl[w].moved != 0:
        slot = int(0)
    while slot < ctl[w].slots:
        pair = slot_hat[w, slot, 0]
        m = slot_hat[w, slot, 1]
        f = vec3(wrench[w, pair, m, 0], wrench[w, pair, m, 1], wrench[w, pair, m, 2])
        t = vec3(wrench[w, pair, m, 3], wrench[w, pair, m, 4], wrench[w, pair, m, 5])
        start = (w * model.capacity.slots + slot) * model.pairs.most_modes
        line = (w * model.capacity.slots + slot) * model.pairs.coupled_capacity
        outer_row(model, w, pair, lane, f, t, axes, r1, weight, J, start, C_receptance, line, L)
        slot += 1
