"""The problem of stick and slip of a Newton iteration posed, and its solution given back to bodies and modes.

With the pressures just solved for, and their answer to the tractions in K (`pressure_answer`), the weak slips of all
cell slots are r_0 + K tau, where

    r_0 = S + dS(ds) + L z + J sigma^-1 (-r_m + J_n^T ds) - K tau_base:

S the slip of the present state, dS what the change ds of the pressures does to it through the local modes, z the outer
increments with those pressures, r_m the residual of the global modes and J_n the gradient of the gaps by them. Slips,
tractions and discs are times the weight of their pair here (`impulsive_contact`), as L, J and J_n are.
"""

import warp as wp

from warpffrf_kernels.core.access import changed, inout, out
from warpffrf_kernels.core.control import Clock, Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync, weighted
from warpffrf_kernels.friction.cell_blocks import COUNT, add_slips, borders_of, first_line
from warpffrf_kernels.friction.cell_forces import creep_softness
from warpffrf_kernels.friction.cells import cell_at
from warpffrf_kernels.friction.pressure_answer import OPEN
from warpffrf_kernels.linear.block_elimination import follow_columns
from warpffrf_kernels.normal.contact_solve import push_by_slots
from warpffrf_kernels.normal.pair_forces import surface_of

wp.set_module_options(MODULE_OPTIONS)


@wp.kernel
def drive_modes(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    active: wp.array3d(dtype=int),
    slot_hat: wp.array3d(dtype=int),
    weight: wp.array2d(dtype=real),
    J: wp.array(dtype=real),
    pressure: wp.array3d(dtype=real),
    base: wp.array3d(dtype=real),
    modal_residual: wp.array2d(dtype=real),
    modal_drive: inout(wp.array(dtype=real)),
):
    """Per world: what pushes the global modes after the solve of the pressures, -r_m + J^T ds."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    first = w * model.modes.count
    n = lane
    while n < model.modes.count:
        modal_drive[first + n] = -modal_residual[w, n]
        n += wp.block_dim()
    sync()
    push_by_slots(model, ctl, w, slot_hat, active, pressure, base, weight, J, modal_drive)


@wp.kernel
def pose_tractions(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    cell_block: wp.array3d(dtype=int),
    cell_slot: wp.array3d(dtype=int),
    weight: wp.array2d(dtype=real),
    cell_area: wp.array3d(dtype=real),
    traction: wp.array3d(dtype=real),
    traction_base: wp.array3d(dtype=real),
    slip: wp.array3d(dtype=real),
    pressed_slip: wp.array3d(dtype=real),
    L: wp.array(dtype=real),
    J: wp.array(dtype=real),
    receptance: wp.array(dtype=real),
    modal_drive: wp.array(dtype=real),
    z: wp.array(dtype=real),
    base: out(wp.array(dtype=real)),
    right: inout(wp.array(dtype=real)),
    tau: out(wp.array(dtype=real)),
):
    """Per (world, pair): right-hand side S + dS(ds) + L z + J sigma^-1 (modal drive), and first guess of all slots.
    pressed_slip: by the local modes under the change of the pressures."""
    w, pair, lane = wp.tid()
    model = models[w]
    count = cell_block[w, pair, COUNT]
    if ctl[w].run == 0 or ctl[w].changes != 0 or count == 0:
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    scale = weight[w, pair]
    start = first_line(model, w, pair)
    i = lane
    while i < count:
        m = cell_slot[w, pair, i]
        area = cell_area[w, pair, m]
        for d in range(2):
            line = start + 2 * i + d
            at = cell_at(rows, m, d)
            base[line] = scale * traction_base[w, pair, at]
            tau[line] = scale * traction[w, pair, at]
            value = scale * area * (slip[w, pair, at] + pressed_slip[w, pair, at])
            by_mode = line * model.pairs.most_modes
            for side in range(2):
                surface = surface_of(model, pair, side)
                modes = w * model.modes.count + model.surfaces.modal_start[surface]
                n = model.surfaces.modal_count[surface]
                value += weighted(n, J, by_mode, receptance, modes, modal_drive, modes)
                by_mode += n
            right[line] = value
        i += wp.block_dim()
    sync()
    follow_columns(model, w, pair, 2 * count, real(1.0), L, borders_of(model, w, pair), z, right, start)


@wp.kernel
def take_off_base(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    cell_block: wp.array3d(dtype=int),
    D: wp.array(dtype=real),
    L: wp.array(dtype=real),
    M: wp.array(dtype=real),
    base: wp.array(dtype=real),
    push: inout(wp.array(dtype=real)),
    turned: inout(wp.array(dtype=real)),
    right: inout(wp.array(dtype=real)),
):
    """Per world: the right-hand side less K tau_base."""
    w, lane = wp.tid()
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    add_slips(models[w], w, lane, real(-1.0), cell_block, D, L, M, base, push, turned, right)


@wp.kernel
def limit_tractions(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    cell_block: wp.array3d(dtype=int),
    cell_slot: wp.array3d(dtype=int),
    weight: wp.array2d(dtype=real),
    cell_area: wp.array3d(dtype=real),
    bound: wp.array3d(dtype=real),
    late: wp.array3d(dtype=real),
    answer_state: wp.array2d(dtype=int),
    radius: out(wp.array3d(dtype=real)),
    softness: out(wp.array3d(dtype=real)),
):
    """Per (world, pair): discs and softness of all slots, with the bounds of the pressures as they are in this
    round."""
    w, pair, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].changes != 0 or answer_state[w, OPEN] == 0:
        return
    i = lane
    while i < cell_block[w, pair, COUNT]:
        m = cell_slot[w, pair, i]
        b = bound[w, pair, m]
        radius[w, pair, i] = weight[w, pair] * b
        softness[w, pair, i] = real(0.0)
        if b > real(0.0):
            soft = creep_softness(model, clk, w, pair, b) + late[w, pair, m]
            softness[w, pair, i] = cell_area[w, pair, m] * soft
        i += wp.block_dim()


@wp.kernel
def take_tractions(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    cell_block: wp.array3d(dtype=int),
    cell_slot: wp.array3d(dtype=int),
    weight: wp.array2d(dtype=real),
    tau: wp.array(dtype=real),
    z_change: wp.array(dtype=real),
    z: changed(wp.array(dtype=real)),
    traction: out(wp.array3d(dtype=real)),
):
    """Per world: the tractions found, and the outer increments with them and with the pressures' answer."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    axpy(model.outer.count, real(1.0), z_change, w * model.outer.count, z, w * model.outer.count)
    pair = int(0)
    while pair < model.pairs.count:
        rows = model.surfaces.rows[model.pairs.first[pair]]
        line = lane
        while line < 2 * cell_block[w, pair, COUNT]:
            value = tau[first_line(model, w, pair) + line] / weight[w, pair]
            traction[w, pair, cell_at(rows, cell_slot[w, pair, line / 2], line % 2)] = value
            line += wp.block_dim()
        pair += 1


@wp.kernel
def push_modes(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    cell_block: wp.array3d(dtype=int),
    moved: wp.array(dtype=real),
    J: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    push: inout(wp.array(dtype=real)),
    modal_step: changed(wp.array(dtype=real)),
):
    """Per world: adds the increments of the global modes by the change of the tractions (those without inertia terms;
    the others are outer coordinates)."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    first = w * model.modes.count
    n = lane
    while n < model.modes.count:
        push[first + n] = real(0.0)
        n += wp.block_dim()
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        line = first_line(model, w, pair)
        end = line + 2 * cell_block[w, pair, COUNT]
        while line < end:
            if moved[line] != real(0.0):
                start = line * model.pairs.most_modes
                for side in range(2):
                    surface = surface_of(model, pair, side)
                    modes = model.surfaces.modal_count[surface]
                    axpy(modes, moved[line], J, start, push, first + model.surfaces.modal_start[surface])
                    start += modes
            line += 1
        pair += 1
    sync()
    n = lane
    while n < model.modes.count:
        if model.modes.dense_of[n] < 0:
            modal_step[first + n] = modal_step[first + n] + receptance[w, n] * push[first + n]
        n += wp.block_dim()
