"""Formulation of the stick-slip problem of a Newton iteration, and transfer of its solution to bodies and modes.

With the pressures just solved for, and their response to the tractions in K (`pressure_response`), the weak slips of
all cell slots are r_0 + K tau, with

    r_0 = S + dS(ds) + L z + J sigma^-1 (-r_m + J_n^T ds) - K tau_base:

S the slip of the present state, dS its change through the local modes due to the change ds of the pressures, z the
retained increments with those pressures, r_m the residual of the global modes and J_n the gradient of the gaps with
respect to them. Slips, tractions and discs are multiplied by the weight of their pair here (`impulsive_contact`), as
are L, J and J_n.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactFields, ContactSolve
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells, FrictionSolve
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync, weighted
from warpffrf_kernels.core.scratch import ImpulsiveContact, Residuals, RetainedSystem
from warpffrf_kernels.core.state import ContactState, FrictionState
from warpffrf_kernels.friction.cell_blocks import COUNT, borders_of, first_line
from warpffrf_kernels.friction.cell_forces import creep_softness
from warpffrf_kernels.friction.cells import cell_at
from warpffrf_kernels.friction.pressure_response import OPEN
from warpffrf_kernels.linear.block_elimination import follow_columns
from warpffrf_kernels.normal.contact_solve import push_by_slots
from warpffrf_kernels.normal.pair_forces import surface_of

wp.set_module_options(MODULE_OPTIONS)


@kernel
def drive_modes(
    run: Run, contact: ContactState, normal: ContactSolve, impulses: ImpulsiveContact, fields: ContactFields,
    residuals: Residuals, tangential: FrictionSolve,
):  # fmt: skip
    """Per world: load on the global modes after the solution of the pressures, -r_m + J^T ds."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0:
        return
    first = w * model.modes.count
    n = lane
    while n < model.modes.count:
        tangential.modal_drive[first + n] = -residuals.modal_residual[w, n]
        n += wp.block_dim()
    sync()
    push_by_slots(model, run, w, normal, contact, fields, impulses, tangential.modal_drive)


@kernel
def pose_tractions(
    run: Run, tangential: FrictionSolve, impulses: ImpulsiveContact, cells: FrictionCells, friction: FrictionState,
    residuals: Residuals, system: RetainedSystem,
):  # fmt: skip
    """Per (world, pair): right-hand side S + dS(ds) + L z + J sigma^-1 (modal drive), and initial guess of all slots.
    pressed_slip: slip by the local modes due to the change of the pressures."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    count = tangential.cell_block[w, pair, COUNT]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or count == 0:
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    scale = impulses.weight[w, pair]
    start = first_line(model, w, pair)
    i = lane
    while i < count:
        m = tangential.cell_slot[w, pair, i]
        area = cells.cell_area[w, pair, m]
        for d in range(2):
            line = start + 2 * i + d
            at = cell_at(rows, m, d)
            tangential.cell_base[line] = scale * cells.traction_base[w, pair, at]
            tangential.cell_tau[line] = scale * friction.traction[w, pair, at]
            value = scale * area * (cells.slip[w, pair, at] + cells.pressed_slip[w, pair, at])
            by_mode = line * model.pairs.most_modes
            for side in range(2):
                surface = surface_of(model, pair, side)
                modes = w * model.modes.count + model.surfaces.modal_start[surface]
                n = model.surfaces.modal_count[surface]
                value += weighted(
                    n, tangential.cell_J, by_mode, residuals.receptance, modes, tangential.modal_drive, modes
                )
                by_mode += n
            tangential.cell_right[line] = value
        i += wp.block_dim()
    sync()
    follow_columns(
        model, w, pair, 2 * count, real(1.0), tangential.cell_L, borders_of(model, w, pair), system.z,
        tangential.cell_right, start,
    )  # fmt: skip


@kernel
def limit_tractions(run: Run, tangential: FrictionSolve, impulses: ImpulsiveContact, cells: FrictionCells):
    """Per (world, pair): discs and softness of all slots, with the bounds of the pressures in this round."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or tangential.answer_state[w, OPEN] == 0:
        return
    i = lane
    while i < tangential.cell_block[w, pair, COUNT]:
        m = tangential.cell_slot[w, pair, i]
        b = cells.bound[w, pair, m]
        tangential.cell_radius[w, pair, i] = impulses.weight[w, pair] * b
        tangential.cell_softness[w, pair, i] = real(0.0)
        if b > real(0.0):
            soft = creep_softness(model, run.clk, w, pair, b) + cells.late[w, pair, m]
            tangential.cell_softness[w, pair, i] = cells.cell_area[w, pair, m] * soft
        i += wp.block_dim()


@kernel
def take_tractions(
    run: Run, tangential: FrictionSolve, impulses: ImpulsiveContact, system: RetainedSystem, friction: FrictionState
):
    """Per world: the tractions found, and the retained increments with them and with the pressures' response."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0:
        return
    axpy(
        model.retained.count,
        real(1.0),
        tangential.answer_z,
        w * model.retained.count,
        system.z,
        w * model.retained.count,
    )
    pair = int(0)
    while pair < model.pairs.count:
        rows = model.surfaces.rows[model.pairs.first[pair]]
        line = lane
        while line < 2 * tangential.cell_block[w, pair, COUNT]:
            value = tangential.cell_tau[first_line(model, w, pair) + line] / impulses.weight[w, pair]
            friction.traction[w, pair, cell_at(rows, tangential.cell_slot[w, pair, line / 2], line % 2)] = value
            line += wp.block_dim()
        pair += 1


@kernel
def push_modes(run: Run, tangential: FrictionSolve, system: RetainedSystem, receptance: wp.array2d(dtype=real)):
    """Per world: adds the increments of the global modes due to the change of the tractions (modes without inertia
    terms; the others are retained coordinates)."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0:
        return
    first = w * model.modes.count
    n = lane
    while n < model.modes.count:
        tangential.cell_push[first + n] = real(0.0)
        n += wp.block_dim()
    sync()
    pair = int(0)
    while pair < model.pairs.count:
        line = first_line(model, w, pair)
        end = line + 2 * tangential.cell_block[w, pair, COUNT]
        while line < end:
            if tangential.answer_moved[line] != real(0.0):
                start = line * model.pairs.most_modes
                for side in range(2):
                    surface = surface_of(model, pair, side)
                    modes = model.surfaces.modal_count[surface]
                    axpy(
                        modes, tangential.answer_moved[line], tangential.cell_J, start, tangential.cell_push,
                        first + model.surfaces.modal_start[surface],
                    )  # fmt: skip
                    start += modes
            line += 1
        pair += 1
    sync()
    n = lane
    while n < model.modes.count:
        if model.modes.dense_of[n] < 0:
            system.modal_step[first + n] = (
                system.modal_step[first + n] + receptance[w, n] * tangential.cell_push[first + n]
            )
        n += wp.block_dim()
