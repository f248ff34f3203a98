r"""Tangential displacement of the cells by the modes of both bodies, and the effect of tractions on gaps and bodies.

With the cell forces f_k = area_k tau_k on the first body and their shares on the cells of the second, f^B = -o^T Q^T f
(o: part of the cell on a cell of the second grid, Q: tangents of the second surface in those of the first),

    u_A = Phi_tA q + D_tt^A f - (M D_nt^A)^T s,        u_B = Phi_tB q + D_tt^B f^B - D_nt^B^T l s,
    e_k = u_A - Q o u_B,        slip of the step    s_k = rigid_k + e_k - e_k(before),

s pressures, l the stencils of the pressures on the second surface. e(before) is fixed to the first body's material.
The tractions open the weak gap by -(M D_nt^A f)_i - l_i D_nt^B f^B (the coupling of unlike materials, and of bodies
that are not half-spaces). All operators are applied to the present loads, never computed with the solver's matrix.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactFields, ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, dot, real, sync, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.core.state import ContactState, FrictionState
from warpffrf_kernels.friction.cell_shares import line_of, on_shares
from warpffrf_kernels.friction.cells import cell_at, rubs_on_grid
from warpffrf_kernels.surfaces.fields import add_fields, clear_field
from warpffrf_kernels.surfaces.responses import loaded_by_others

wp.set_module_options(MODULE_OPTIONS)


@kernel
def force_cells(
    run: Run, geometry: ContactGeometry, cells: FrictionCells, friction: FrictionState,
    first_force: wp.array3d(dtype=real),
):  # fmt: skip
    """Per (world, pair): forces of the tractions on the first surface's cells, and their shares on the second's
    [N]."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not rubs_on_grid(model, pair):
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    rows_b = model.surfaces.rows[model.pairs.second[pair]]
    i = lane
    while i < 2 * model.window.nodes:
        cells.second_force[w, pair, i] = real(0.0)
        i += wp.block_dim()
    i = (geometry.window[w, pair, 0] + model.window.half) * 2 * rows + lane
    while i < (geometry.window[w, pair, 1] + model.window.half + 1) * 2 * rows:
        area = cells.cell_area[w, pair, (i / (2 * rows)) * rows + i % rows]
        first_force[w, pair, i] = area * friction.traction[w, pair, i]
        i += wp.block_dim()
    sync()
    if lane != 0 or model.surfaces.shear_start[model.pairs.second[pair]] < 0:
        return
    m = (geometry.window[w, pair, 0] + model.window.half) * rows
    while m < (geometry.window[w, pair, 1] + model.window.half + 1) * rows:
        f_1 = cells.cell_area[w, pair, m] * friction.traction[w, pair, cell_at(rows, m, 0)]
        f_2 = cells.cell_area[w, pair, m] * friction.traction[w, pair, cell_at(rows, m, 1)]
        if f_1 != real(0.0) or f_2 != real(0.0):
            g_1 = -(cells.cell_turn[w, pair, m, 0] * f_1 + cells.cell_turn[w, pair, m, 2] * f_2)
            g_2 = -(cells.cell_turn[w, pair, m, 1] * f_1 + cells.cell_turn[w, pair, m, 3] * f_2)
            c = int(0)
            while c < model.window.share_columns:
                q = int(0)
                while q < model.window.share_rows:
                    part = cells.share[w, pair, m, c * model.window.share_rows + q]
                    if part != real(0.0):
                        e = (cells.share_at[w, pair, m, 0] + c) * 2 * rows_b + cells.share_at[w, pair, m, 1] + q
                        cells.second_force[w, pair, e] = cells.second_force[w, pair, e] + part * g_1
                        cells.second_force[w, pair, e + rows_b] = cells.second_force[w, pair, e + rows_b] + part * g_2
                    q += 1
                c += 1
        m += 1


@wp.func
def second_low(model: Model, w: int, pair: int, second_window: wp.array3d(dtype=int)) -> int:
    """First column of the second window that the shares of the cells reach: a cubic reaches further than nodes do."""
    return wp.max(second_window[w, pair, 0] - model.window.share_columns, 0)


@wp.func
def second_high(model: Model, w: int, pair: int, second_window: wp.array3d(dtype=int)) -> int:
    """The last one."""
    return wp.min(second_window[w, pair, 1] + model.window.share_columns, model.window.second_columns - 1)


@kernel
def push_gaps(run: Run, geometry: ContactGeometry, cells: FrictionCells, second_force: wp.array(dtype=real)):
    """Per (world, pair), with and without friction of its own: the displacements by the local modes with which the
    tractions of all pairs on its bodies open its gaps, as in `contact_fields.local_fields`."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    base = (w * model.pairs.count + pair) * model.window.grid_nodes
    base_b = (w * model.pairs.count + pair) * model.window.nodes
    clear_field(lane, model.window.grid_nodes, base, cells.first_push)
    clear_field(lane, model.window.nodes, base_b, cells.second_push)
    low = geometry.window[w, pair, 0] + model.window.half
    columns = geometry.window[w, pair, 1] - geometry.window[w, pair, 0] + 1
    start = base + low * model.surfaces.rows[model.pairs.first[pair]]
    add_fields(
        model, w, 2 * pair, low, columns, model.responses.rubbed, real(-1.0), 2, geometry, cells.first_force,
        second_force, start, cells.first_push,
    )  # fmt: skip
    low = geometry.second_window[w, pair, 0]
    columns = geometry.second_window[w, pair, 1] - low + 1
    start = base_b + low * model.surfaces.rows[model.pairs.second[pair]]
    add_fields(
        model, w, 2 * pair + 1, low, columns, model.responses.rubbed, real(-1.0), 2, geometry, cells.first_force,
        second_force, start, cells.second_push,
    )  # fmt: skip


@kernel
def add_push(run: Run, cells: FrictionCells, fields: ContactFields):
    """Per (world, pair): adds the result of `push_gaps` to the displacements by the pressures."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or (not rubs_on_grid(model, pair) and not loaded_by_others(model, pair)):
        return
    at = w * model.pairs.count + pair
    axpy(
        model.window.grid_nodes, real(1.0), cells.first_push, at * model.window.grid_nodes, fields.first_local,
        at * model.window.grid_nodes,
    )  # fmt: skip
    axpy(
        model.window.nodes, real(1.0), cells.second_push, at * model.window.nodes, fields.second_local,
        at * model.window.nodes,
    )  # fmt: skip
    sync()


@kernel
def press_cells(
    run: Run, geometry: ContactGeometry, cells: FrictionCells, pressure: wp.array(dtype=real),
    second_load: wp.array(dtype=real), of_state: int,
):  # fmt: skip
    """Per (world, pair): tangential displacements of both surfaces' cells by the pressures (0 where inactive) of all
    pairs on the two bodies and by their loads on second surfaces."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or not rubs_on_grid(model, pair):
        return
    if (of_state != 0 and run.ctl[w].moved == 0) or (of_state == 0 and run.ctl[w].changes != 0):
        return
    base = (w * model.pairs.count + pair) * 2 * model.window.grid_nodes
    base_b = (w * model.pairs.count + pair) * 2 * model.window.nodes
    clear_field(lane, 2 * model.window.grid_nodes, base, cells.first_shift)
    clear_field(lane, 2 * model.window.nodes, base_b, cells.second_shift)
    low = geometry.window[w, pair, 0] + model.window.half
    columns = geometry.window[w, pair, 1] - geometry.window[w, pair, 0] + 1
    start = base + 2 * low * model.surfaces.rows[model.pairs.first[pair]]
    add_fields(
        model, w, 2 * pair, low, columns, model.responses.pressed, real(-1.0), 1, geometry, pressure, second_load,
        start, cells.first_shift,
    )  # fmt: skip
    if model.surfaces.shear_start[model.pairs.second[pair]] >= 0:
        low = second_low(model, w, pair, geometry.second_window)
        columns = second_high(model, w, pair, geometry.second_window) - low + 1
        start = base_b + 2 * low * model.surfaces.rows[model.pairs.second[pair]]
        add_fields(
            model, w, 2 * pair + 1, low, columns, model.responses.pressed, real(-1.0), 1, geometry, pressure,
            second_load, start, cells.second_shift,
        )  # fmt: skip


@kernel
def shift_slips(run: Run, geometry: ContactGeometry, cells: FrictionCells):
    """Per (world, pair), lanes over cells: change of their slips by the local modes, for changes of the pressures
    [m]."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or not rubs_on_grid(model, pair):
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    flexible = model.surfaces.shear_start[model.pairs.second[pair]] >= 0
    base = (w * model.pairs.count + pair) * 2 * model.window.grid_nodes
    m = (geometry.window[w, pair, 0] + model.window.half) * rows + lane
    while m < (geometry.window[w, pair, 1] + model.window.half + 1) * rows:
        second = vec3(real(0.0), real(0.0), real(0.0))
        if flexible:
            second = on_shares(model, w, pair, m, cells, cells.second_shift)
        for d in range(2):
            at = cell_at(rows, m, d)
            cells.pressed_slip[w, pair, at] = cells.first_shift[base + at] - second[d]
        m += wp.block_dim()


@kernel
def rub_cells(run: Run, geometry: ContactGeometry, cells: FrictionCells, second_force: wp.array(dtype=real)):
    """Per (world, pair): adds the tangential displacement of both surfaces by the tractions of all pairs on them."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or not rubs_on_grid(model, pair) or run.ctl[w].moved == 0:
        return
    low = geometry.window[w, pair, 0] + model.window.half
    columns = geometry.window[w, pair, 1] - geometry.window[w, pair, 0] + 1
    at = (w * model.pairs.count + pair) * 2
    start = at * model.window.grid_nodes + 2 * low * model.surfaces.rows[model.pairs.first[pair]]
    add_fields(
        model, w, 2 * pair, low, columns, model.responses.tangential, real(1.0), 2, geometry, cells.first_force,
        second_force, start, cells.first_shift,
    )  # fmt: skip
    if model.surfaces.shear_start[model.pairs.second[pair]] >= 0:
        low = second_low(model, w, pair, geometry.second_window)
        columns = second_high(model, w, pair, geometry.second_window) - low + 1
        start = at * model.window.nodes + 2 * low * model.surfaces.rows[model.pairs.second[pair]]
        add_fields(
            model, w, 2 * pair + 1, low, columns, model.responses.tangential, real(1.0), 2, geometry, cells.first_force,
            second_force, start, cells.second_shift,
        )  # fmt: skip


@kernel
def displace_cells(run: Run, geometry: ContactGeometry, rubbing: FrictionCells, trial: Trial):
    """Per (world, pair), lanes over the cells: difference e of the tangential displacements of both bodies [m], by the
    local modes alone and in total; the shifts are those of `press_cells` and `rub_cells`."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or not rubs_on_grid(model, pair) or run.ctl[w].moved == 0:
        return
    A = model.pairs.first[pair]
    B = model.pairs.second[pair]
    rows = model.surfaces.rows[A]
    rows_b = model.surfaces.rows[B]
    H = model.window.half
    first = geometry.window[w, pair, 0] + H
    cells = (geometry.window[w, pair, 1] + H - first + 1) * rows
    origin = geometry.center[w, pair, 0] - H
    origin_b = geometry.center[w, pair, 1] - model.window.second_half
    base = (w * model.pairs.count + pair) * 2 * model.window.grid_nodes
    base_b = (w * model.pairs.count + pair) * 2 * model.window.nodes
    flexible = model.surfaces.shear_start[B] >= 0
    if flexible:
        low = second_low(model, w, pair, geometry.second_window)
        high = second_high(model, w, pair, geometry.second_window)
        modes_b = model.surfaces.modal_count[B]
        i = 2 * low * rows_b + lane
        while i < 2 * (high + 1) * rows_b:
            value = real(0.0)
            line = line_of(model, B, origin_b + i / (2 * rows_b), i % (2 * rows_b))
            if line >= 0:
                at = model.surfaces.shear_start[B] + line * modes_b
                start_b = w * model.modes.count + model.surfaces.modal_start[B]
                value = dot(modes_b, model.surfaces.mode_tangent, at, trial.q1, start_b)
            rubbing.second_modal[base_b + i] = value
            i += wp.block_dim()
    sync()
    modes_a = model.surfaces.modal_count[A]
    start_a = w * model.modes.count + model.surfaces.modal_start[A]
    m = first * rows + lane
    while m < first * rows + cells:
        i_1 = cell_at(rows, m, 0)
        i_2 = cell_at(rows, m, 1)
        u_1 = rubbing.first_shift[base + i_1]
        u_2 = rubbing.first_shift[base + i_2]
        q_1 = real(0.0)
        q_2 = real(0.0)
        line = line_of(model, A, origin + m / rows, m % rows)
        if line >= 0:
            q_1 = dot(
                modes_a, model.surfaces.mode_tangent, model.surfaces.shear_start[A] + line * modes_a, trial.q1, start_a
            )
            q_2 = dot(
                modes_a, model.surfaces.mode_tangent, model.surfaces.shear_start[A] + (line + rows) * modes_a, trial.q1,
                start_a,
            )  # fmt: skip
        if flexible and rubbing.cell_area[w, pair, m] > real(0.0):
            u = on_shares(model, w, pair, m, rubbing, rubbing.second_shift)
            q = on_shares(model, w, pair, m, rubbing, rubbing.second_modal)
            u_1 -= u[0]
            u_2 -= u[1]
            q_1 -= q[0]
            q_2 -= q[1]
        rubbing.elastic_local[w, pair, i_1] = u_1
        rubbing.elastic_local[w, pair, i_2] = u_2
        rubbing.elastic[w, pair, i_1] = u_1 + q_1
        rubbing.elastic[w, pair, i_2] = u_2 + q_2
        m += wp.block_dim()


@kernel
def change_pressures(
    run: Run, geometry: ContactGeometry, contact: ContactState, fields: ContactFields, cells: FrictionCells
):
    """Per (world, pair): change of the pressures in the solution, and the corresponding loads on the second
    surface."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0:
        return
    if not rubs_on_grid(model, pair) and not loaded_by_others(model, pair):
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    rows_b = model.surfaces.rows[model.pairs.second[pair]]
    i = lane
    while i < model.window.nodes:
        cells.load_change[w, pair, i] = real(0.0)
        i += wp.block_dim()
    sync()
    if lane != 0:
        return
    m = (geometry.window[w, pair, 0] + model.window.half) * rows
    while m < (geometry.window[w, pair, 1] + model.window.half + 1) * rows:
        change = -fields.base[w, pair, m]
        if contact.active[w, pair, m] != 0:
            change += contact.pressure[w, pair, m]
        cells.pressure_change[w, pair, m] = change
        c = int(0)
        while change != real(0.0) and c < model.window.stencil_columns:
            q = int(0)
            while q < model.window.stencil_rows:
                part = geometry.stencil[w, pair, m, c * model.window.stencil_rows + q]
                if part != real(0.0):
                    e = (geometry.stencil_at[w, pair, m, 0] + c) * rows_b + geometry.stencil_at[w, pair, m, 1] + q
                    cells.load_change[w, pair, e] = cells.load_change[w, pair, e] + part * change
                q += 1
            c += 1
        m += 1
