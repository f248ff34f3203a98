"""Rows of the local compliance G = Psi^T (C_A + C_B) Psi at the active nodes, each in a slot and assembled once.

With the nodal compliance D of each surface (`u = D f`, both nodal) and the stencil l_j, the load on the second surface
due to a unit pressure at node j of the first:

    G_ij = (M D_A M)_ij + l_i . (D_B l_j) + J_i sigma^-1 J_j^T,      J_i = [-(M Phi_A)_i, -l_i Phi_B].

The last term condenses the global modes: their tangent sigma is diagonal (`receptance` = 1/sigma), so it costs modes x
slots^2 / 2. `M D_A M` is precomputed; `T_j = D_B l_j` is stored, because it also gives the displacement of the second
surface at every node of the window. A slot stays assembled until the grids move relative to each other, so a changed
active set costs only the assembly of the added nodes.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import ContactGeometry, ContactSolve
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.lanes import before, share, total
from warpffrf_kernels.core.model import PATCH, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, dot, real, sync, vec3
from warpffrf_kernels.core.scratch import ImpulsiveContact, RetainedSystem, Trial
from warpffrf_kernels.core.state import ContactState
from warpffrf_kernels.normal.compliance_reuse import AGE, BEGUN, COUNT, OLDER, PATIENCE, REST, RESTS, ROWS
from warpffrf_kernels.surfaces.responses import own_load, place_in_table

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def short_of(model: Model) -> int:
    """Failure of an attempt that runs out of slots: the host's memory, if the capacities of the contacts allow more;
    otherwise these capacities, and a smaller step, whose iterations do not overshoot, may succeed."""
    if model.capacity.slots < model.capacity.slot_limit:
        return int(k.ROOM)
    return int(k.CAPACITY)


@wp.func
def lacks_rows(model: Model, w: int, lane: int, contact: ContactState, normal: ContactSolve) -> bool:
    """Whether an active node has no slot; all lanes must call."""
    lacking = real(0.0)
    pair = int(0)
    while pair < model.pairs.count:
        m = lane
        while m < model.window.grid_nodes:
            if contact.active[w, pair, m] != 0 and normal.slot_of[w, pair, m] < 0:
                lacking = real(1.0)
            m += wp.block_dim()
        pair += 1
    return total(lacking) > real(0.0)


@wp.func
def new_nodes(
    model: Model, w: int, pair: int, first: int, end: int, contact: ContactState, normal: ContactSolve
) -> int:
    """Active nodes without a slot among those of a lane; with one lane, 0: none comes before it."""
    count = int(0)
    m = first
    while m < end and wp.block_dim() > 1:
        if contact.active[w, pair, m] != 0 and normal.slot_of[w, pair, m] < 0:
            count += 1
        m += 1
    return count


@wp.func
def free_cells(w: int, pair: int, first: int, end: int, geometry: ContactGeometry, normal: ContactSolve) -> int:
    """Cells of a patch without a slot among those of a lane; with one lane, 0: none comes before it."""
    count = int(0)
    m = first
    while m < end and wp.block_dim() > 1:
        if normal.slot_of[w, pair, m] < 0 and geometry.area[w, pair, m] > real(0.0):
            count += 1
        m += 1
    return count


@kernel
def take_slots(run: Run, contact: ContactState, geometry: ContactGeometry, normal: ContactSolve):
    """Per world, lanes over nodes: assigns a slot to each active node without one. All slots are released first if the
    grids have moved, or if rows of an earlier attempt are not accurate enough. If rows are kept from step to step, all
    cells of a patch then receive a slot, as far as the capacity allows, because cells at its edge become active and
    inactive.
    """
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    nodes = model.window.grid_nodes
    anew = run.ctl[w].reassemble
    unfit = bool(False)  # rows of an earlier attempt
    if normal.lasting[w, OLDER] != 0:
        unfit = run.ctl[w].iteration >= PATIENCE or lacks_rows(model, w, lane, contact, normal)
    if unfit:
        anew = 1
    spare = int(anew != 0 and run.ctl[w].mode == k.DYNAMIC and model.elements[0].patches.lasting != 0)
    begun = run.ctl[w].slots
    if anew != 0:
        begun = 0
    count = begun
    sync()
    if anew != 0:
        pair = int(0)
        while pair < model.pairs.count:
            m = lane
            while m < nodes:
                normal.slot_of[w, pair, m] = -1
                m += wp.block_dim()
            if lane == 0:
                for i in range(4):
                    geometry.phase[w, pair, i] = geometry.phase[w, pair, 4 + i]
                for i in range(2):
                    geometry.phase[w, pair, 8 + i] = geometry.phase[w, pair, 10 + i]
            pair += 1
    sync()
    number = int(0)
    first = share(nodes, lane)
    end = share(nodes, lane + 1)
    pair = int(0)
    while pair < model.pairs.count:
        at = count + before(new_nodes(model, w, pair, first, end, contact, normal))
        start = at
        m = first
        while m < end:
            if contact.active[w, pair, m] != 0:
                number += 1
                if normal.slot_of[w, pair, m] < 0:
                    if at < model.capacity.slots:
                        normal.slot_of[w, pair, m] = at
                        normal.slot_node[w, at, 0] = pair
                        normal.slot_node[w, at, 1] = m
                    at += 1
            m += 1
        count += int(total(real(at - start)))
        pair += 1
    number = int(total(real(number)))
    pair = int(0)
    while pair < model.pairs.count and spare != 0:
        cells = model.elements[0].patches.columns[pair] * model.surfaces.rows[model.pairs.first[pair]]
        end = share(cells, lane + 1)
        at = count + before(free_cells(w, pair, share(cells, lane), end, geometry, normal))
        start = at
        m = share(cells, lane)
        while m < end and at < model.capacity.slots:
            if normal.slot_of[w, pair, m] < 0 and geometry.area[w, pair, m] > real(0.0):
                normal.slot_of[w, pair, m] = at
                normal.slot_node[w, at, 0] = pair
                normal.slot_node[w, at, 1] = m
                at += 1
            m += 1
        count += int(total(real(wp.max(at - start, 0))))
        pair += 1
    if lane == 0:
        if unfit and normal.lasting[w, AGE] <= 1:
            normal.lasting[w, RESTS] = REST
        normal.lasting[w, BEGUN] = 0
        if anew != 0:
            normal.lasting[w, OLDER] = 0
            normal.lasting[w, ROWS] = 1
            normal.lasting[w, AGE] = 0
            run.ctl[w].reassemble = 0
            run.ctl[w].recenter = 0
        run.ctl[w].fresh = begun
        if run.ctl[w].reweighed != 0:
            run.ctl[w].fresh = 0
            run.ctl[w].reweighed = 0
        if count > model.capacity.slots:
            run.ctl[w].failure = run.ctl[w].failure | short_of(model)
            run.ctl[w].spare = wp.max(run.ctl[w].spare, count)
            run.ctl[w].run = 0
            count = model.capacity.slots
        run.ctl[w].slots = count
        run.ctl[w].active = number
        normal.lasting[w, COUNT] = count


@wp.func
def respond_to(
    model: Model, w: int, pair: int, m: int, first: int, count: int, geometry: ContactGeometry, normal: ContactSolve,
    start: int,
):  # fmt: skip
    """Adds D_B l of node m to `count` numbers of T from `start` on, column `first` of the second window."""
    if model.surfaces.rigid[model.pairs.second[pair]] != 0:
        return
    table = model.responses.normal[own_load(model, 2 * pair + 1)]
    origin = geometry.center[w, pair, 1] - model.window.second_half
    c = int(0)
    while c < model.window.stencil_columns:
        r = int(0)
        while r < model.window.stencil_rows:
            weight = geometry.stencil[w, pair, m, c * model.window.stencil_rows + r]
            if weight != real(0.0):
                at = place_in_table(
                    model, table, origin + geometry.stencil_at[w, pair, m, 0] + c,
                    geometry.stencil_at[w, pair, m, 1] + r, origin + first,
                )  # fmt: skip
                if at >= 0:
                    axpy(count, weight, model.responses.number, at, normal.T, start)
            r += 1
        c += 1


@kernel
def respond(run: Run, geometry: ContactGeometry, normal: ContactSolve):
    """Per world: T_j = D_B l_j of the new slots at the nodes of the second window."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    slot = run.ctl[w].fresh
    while slot < run.ctl[w].slots:
        pair = normal.slot_node[w, slot, 0]
        if model.pairs.family[pair] == PATCH:
            slot += 1
            continue
        m = normal.slot_node[w, slot, 1]
        B = model.pairs.second[pair]
        rows = model.surfaces.rows[B]
        first = geometry.second_window[w, pair, 0]
        count = (geometry.second_window[w, pair, 1] - first + 1) * rows
        start = (w * model.capacity.slots + slot) * model.window.nodes + first * rows
        i = lane
        while i < count:
            normal.T[start + i] = real(0.0)
            i += wp.block_dim()
        sync()
        respond_to(model, w, pair, m, first, count, geometry, normal, start)
        slot += 1


@wp.func
def node_of(model: Model, surface: int, column: int, row: int) -> int:
    """Flat grid node of a column counted over full revolutions; -1 outside the grid."""
    turn = model.surfaces.turn[surface]
    c = column
    if turn > 0:
        c = ((column % turn) + turn) % turn
    if c < 0 or c >= model.surfaces.columns[surface]:
        return -1
    return c * model.surfaces.rows[surface] + row


@kernel
def modal_rows(run: Run, geometry: ContactGeometry, normal: ContactSolve, impulses: ImpulsiveContact):
    """Per world: gradient of the weak gap of the new slots with respect to the global modes of A, then of B, times the
    weight of the pair."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    slot = run.ctl[w].fresh
    while slot < run.ctl[w].slots:
        pair = normal.slot_node[w, slot, 0]
        if model.pairs.family[pair] == PATCH:
            slot += 1
            continue
        m = normal.slot_node[w, slot, 1]
        A = model.pairs.first[pair]
        B = model.pairs.second[pair]
        modes_a = model.surfaces.modal_count[A]
        modes_b = model.surfaces.modal_count[B]
        start = (w * model.capacity.slots + slot) * model.pairs.most_modes
        i = lane
        while i < modes_a + modes_b:
            normal.J[start + i] = real(0.0)
            i += wp.block_dim()
        sync()
        column = m / model.surfaces.rows[A]
        node = node_of(
            model, A, geometry.center[w, pair, 0] + column - model.window.half, m - column * model.surfaces.rows[A]
        )
        if node >= 0:
            at = model.surfaces.mode_start[A] + node * modes_a
            axpy(modes_a, -impulses.weight[w, pair], model.surfaces.mode_moment, at, normal.J, start)
        base = geometry.center[w, pair, 1] - model.window.second_half + geometry.stencil_at[w, pair, m, 0]
        c = int(0)
        while c < model.window.stencil_columns:
            r = int(0)
            while r < model.window.stencil_rows:
                part = impulses.weight[w, pair] * geometry.stencil[w, pair, m, c * model.window.stencil_rows + r]
                if part != real(0.0):
                    node = node_of(model, B, base + c, geometry.stencil_at[w, pair, m, 1] + r)
                    if node >= 0:
                        at = model.surfaces.mode_start[B] + node * modes_b
                        axpy(modes_b, -part, model.surfaces.mode_normal, at, normal.J, start + modes_a)
                r += 1
            c += 1
        slot += 1


@wp.func
def retained_row(
    model: Model, w: int, pair: int, lane: int, f: vec3, t: vec3, trial: Trial, impulses: ImpulsiveContact,
    J: wp.array(dtype=real), start: int, system: RetainedSystem, line: int, L: wp.array(dtype=real),
):  # fmt: skip
    """Line of L that begins at `line`, [d/d(rigid), -J sigma^-1 C_modal^T] over the columns in `coupled` of the pair,
    for a quantity with gradient (f, t) with respect to the motion of A relative to B, and J (from `start`) with respect
    to the modes, times the weight of the pair, which J already contains."""
    A = model.surfaces.body[model.pairs.first[pair]]
    B = model.surfaces.body[model.pairs.second[pair]]
    if lane == 0:
        push = impulses.weight[w, pair] * f
        turn = impulses.weight[w, pair] * t
        t_a = wp.transpose(trial.axes[w, A]) * turn
        for i in range(3):
            L[line + i] = push[i]
            L[line + 3 + i] = t_a[i]
            L[line + 6 + i] = real(0.0)  # the ground is fixed
            L[line + 9 + i] = real(0.0)
        if B >= 0:
            t_b = wp.transpose(trial.axes[w, B]) * (turn + wp.cross(trial.r1[w, A] - trial.r1[w, B], push))
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
        if column < model.retained.row_offset:  # a mode that is not condensed
            mode = model.dense.mode[column - 6 * model.bodies.count]
            at = mode - first_a
            if at < 0 or at >= count_a:
                at = count_a + mode - first_b
            L[line + c] = J[start + at]
        else:
            at = (w * model.rows.count + column - model.retained.row_offset) * model.modes.count
            value = -dot(model.bodies.global_count[A], J, start, system.C_receptance, at + first_a)
            if B >= 0:
                value -= dot(model.bodies.global_count[B], J, start + count_a, system.C_receptance, at + first_b)
            L[line + c] = value
        c += wp.block_dim()


@kernel
def retained_rows(
    run: Run, trial: Trial, geometry: ContactGeometry, impulses: ImpulsiveContact, normal: ContactSolve,
    system: RetainedSystem, L: wp.array(dtype=real),
):  # fmt: skip
    """Per world: gradient L of the gap with respect to the retained coordinates times the weight of the pair
    (`retained_row`); for all slots if the retained matrix is new, otherwise for the new ones."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    slot = run.ctl[w].fresh
    if run.ctl[w].refresh != 0 and run.ctl[w].moved != 0:
        slot = int(0)
    while slot < run.ctl[w].slots:
        pair = normal.slot_node[w, slot, 0]
        m = normal.slot_node[w, slot, 1]
        f = vec3(geometry.wrench[w, pair, m, 0], geometry.wrench[w, pair, m, 1], geometry.wrench[w, pair, m, 2])
        t = vec3(geometry.wrench[w, pair, m, 3], geometry.wrench[w, pair, m, 4], geometry.wrench[w, pair, m, 5])
        start = (w * model.capacity.slots + slot) * model.pairs.most_modes
        line = (w * model.capacity.slots + slot) * model.pairs.coupled_capacity
        retained_row(model, w, pair, lane, f, t, trial, impulses, normal.J, start, system, line, L)
        slot += 1
