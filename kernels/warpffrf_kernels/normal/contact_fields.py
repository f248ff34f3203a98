"""Displacement fields on the contact windows, and their contribution to the gaps.

A weak gap has three parts: the undeformed gap (`line_of_centres`), the global modes (`modal_fields`) and the local
modes (`local_fields`). Displacements by the local modes are never computed with the matrix G: the compliance tables are
applied to the present loads, so the residual is that of the present position of the grids.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactFields, ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.lanes import most, totals, values
from warpffrf_kernels.core.model import LINE_OF_CENTRES, PATCH, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, dot, real, sync
from warpffrf_kernels.core.scratch import Residuals
from warpffrf_kernels.core.state import ContactState
from warpffrf_kernels.normal.contact_compliance import node_of
from warpffrf_kernels.normal.pair_forces import modal_line
from warpffrf_kernels.surfaces.fields import add_fields, clear_field

wp.set_module_options(MODULE_OPTIONS)

# of the scene's length: smaller penetrations do not tighten the gap tolerance, which would otherwise reach round-off
SHALLOW = wp.constant(wp.float64(1.0e-5))


@kernel
def set_second_window(run: Run, geometry: ContactGeometry, contact: ContactState):
    """Per (world, pair): columns of the second grid within reach of the nodes of the window. Nodes without an opposite
    surface leave the active set, because their stencils may lie outside that grid's window."""
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    on_nodes = int(model.pairs.family[pair] != PATCH)
    low = model.window.second_columns - 1
    high = int(0)
    m = (geometry.window[w, pair, 0] + model.window.half) * rows
    while m < (geometry.window[w, pair, 1] + model.window.half + 1) * rows:
        if geometry.area[w, pair, m] > real(0.0):
            if on_nodes != 0:
                low = wp.min(low, geometry.stencil_at[w, pair, m, 0])
                high = wp.max(high, geometry.stencil_at[w, pair, m, 0] + model.window.stencil_columns - 1)
        else:
            contact.active[w, pair, m] = 0
            contact.pressure[w, pair, m] = real(0.0)
        m += 1
    geometry.second_window[w, pair, 0] = wp.min(low, high)
    geometry.second_window[w, pair, 1] = high


@kernel
def modal_fields(
    run: Run, geometry: ContactGeometry, amplitude: wp.array(dtype=real), of_state: int,
    first_field: wp.array3d(dtype=real), second_field: wp.array(dtype=real),
):  # fmt: skip
    """Per (world, pair), lanes over nodes of A and of B: weak displacement (M Phi_A q)_i and displacement (Phi_B q) by
    the modes.
    """
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or (of_state != 0 and run.ctl[w].moved == 0) or model.pairs.family[pair] == PATCH:
        return
    A = model.pairs.first[pair]
    B = model.pairs.second[pair]
    rows = model.surfaces.rows[A]
    first = model.surfaces.modal_start[A]
    modes = model.surfaces.modal_count[A]
    first += w * model.modes.count
    m = (geometry.window[w, pair, 0] + model.window.half) * rows + lane
    while m < (geometry.window[w, pair, 1] + model.window.half + 1) * rows:
        column = m / rows
        node = node_of(model, A, geometry.center[w, pair, 0] + column - model.window.half, m - column * rows)
        value = real(0.0)
        if node >= 0:
            value = dot(
                modes, model.surfaces.mode_moment, model.surfaces.mode_start[A] + node * modes, amplitude, first
            )
        first_field[w, pair, m] = value
        m += wp.block_dim()
    rows = model.surfaces.rows[B]
    first = model.surfaces.modal_start[B]
    modes = model.surfaces.modal_count[B]
    first += w * model.modes.count
    m = geometry.second_window[w, pair, 0] * rows + lane
    while m < (geometry.second_window[w, pair, 1] + 1) * rows:
        column = m / rows
        node = node_of(model, B, geometry.center[w, pair, 1] + column - model.window.second_half, m - column * rows)
        value = real(0.0)
        if node >= 0:
            value = dot(
                modes, model.surfaces.mode_normal, model.surfaces.mode_start[B] + node * modes, amplitude, first
            )
        second_field[(w * model.pairs.count + pair) * model.window.nodes + m] = value
        m += wp.block_dim()


@wp.func
def on_stencil(
    model: Model, w: int, pair: int, m: int, rows: int, geometry: ContactGeometry, field: wp.array(dtype=real)
) -> real:
    """l_i . field, with the field given on the window of the second grid."""
    base = (w * model.pairs.count + pair) * model.window.nodes
    total = real(0.0)
    c = int(0)
    while c < model.window.stencil_columns:
        r = int(0)
        while r < model.window.stencil_rows:
            row = geometry.stencil_at[w, pair, m, 1] + r
            if row < rows:
                weight = geometry.stencil[w, pair, m, c * model.window.stencil_rows + r]
                total += weight * field[base + (geometry.stencil_at[w, pair, m, 0] + c) * rows + row]
            r += 1
        c += 1
    return total


@wp.func
def local_gap(model: Model, w: int, pair: int, m: int, geometry: ContactGeometry, fields: ContactFields) -> real:
    """Opening of a weak gap by the local modes of both bodies."""
    at = w * model.pairs.count + pair
    value = fields.first_local[at * model.window.grid_nodes + m]
    if model.pairs.family[pair] == PATCH:
        return value
    rows_b = model.surfaces.rows[model.pairs.second[pair]]
    return value + on_stencil(model, w, pair, m, rows_b, geometry, fields.second_local)


@kernel
def close_gaps(run: Run, geometry: ContactGeometry, fields: ContactFields, contact: ContactState):
    """Per (world, pair), lanes over nodes: weak gaps of the present state and the pressures they belong to.

    gap = weak_gap - M Phi_A q - l . Phi_B q includes the deformation by the global modes; opened also that by the local
    modes under the present pressures. These are stored as `base`, the reference of the changes in the solution.
    """
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    rows_b = model.surfaces.rows[model.pairs.second[pair]]
    m = lane
    while m < model.window.grid_nodes:
        fields.base[w, pair, m] = real(0.0)
        if contact.active[w, pair, m] != 0:
            fields.base[w, pair, m] = contact.pressure[w, pair, m]
        m += wp.block_dim()
    m = (geometry.window[w, pair, 0] + model.window.half) * rows + lane
    while m < (geometry.window[w, pair, 1] + model.window.half + 1) * rows:
        value = geometry.shifted_gap[w, pair, m]
        if geometry.area[w, pair, m] > real(0.0):
            value -= fields.first_field[w, pair, m]
            if model.pairs.family[pair] != PATCH:
                value -= on_stencil(model, w, pair, m, rows_b, geometry, fields.second_field)
        fields.gap[w, pair, m] = value
        fields.opened[w, pair, m] = value + local_gap(model, w, pair, m, geometry, fields)
        m += wp.block_dim()


@kernel
def load_second(run: Run, geometry: ContactGeometry, contact: ContactState, fields: ContactFields):
    """Per (world, pair): loads on B's nodes due to the present pressures [N]."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0:
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    rows_b = model.surfaces.rows[model.pairs.second[pair]]
    base_b = (w * model.pairs.count + pair) * model.window.nodes
    i = lane
    while i < model.window.nodes:
        fields.second_load[base_b + i] = real(0.0)
        i += wp.block_dim()
    sync()
    if lane != 0 or model.pairs.family[pair] == PATCH:
        return
    m = (geometry.window[w, pair, 0] + model.window.half) * rows
    while m < (geometry.window[w, pair, 1] + model.window.half + 1) * rows:
        if contact.active[w, pair, m] != 0:
            c = int(0)
            while c < model.window.stencil_columns:
                r = int(0)
                while r < model.window.stencil_rows:
                    weight = geometry.stencil[w, pair, m, c * model.window.stencil_rows + r]
                    if weight != real(0.0):
                        e = (
                            base_b
                            + (geometry.stencil_at[w, pair, m, 0] + c) * rows_b
                            + geometry.stencil_at[w, pair, m, 1]
                            + r
                        )
                        fields.second_load[e] = fields.second_load[e] + weight * contact.pressure[w, pair, m]
                    r += 1
                c += 1
        m += 1


@kernel
def local_fields(run: Run, geometry: ContactGeometry, fields: ContactFields, pressure: wp.array(dtype=real)):
    """Per (world, pair): displacements by the local modes due to the loads of all pairs on the two bodies: weak at A's
    nodes, nodal on B, both positive if they open the gap. pressure: 0 where inactive."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or model.pairs.family[pair] == PATCH:
        return
    base = (w * model.pairs.count + pair) * model.window.grid_nodes
    base_b = (w * model.pairs.count + pair) * model.window.nodes
    clear_field(lane, model.window.grid_nodes, base, fields.first_local)
    clear_field(lane, model.window.nodes, base_b, fields.second_local)
    low = geometry.window[w, pair, 0] + model.window.half
    columns = geometry.window[w, pair, 1] - geometry.window[w, pair, 0] + 1
    start = base + low * model.surfaces.rows[model.pairs.first[pair]]
    add_fields(
        model, w, 2 * pair, low, columns, model.responses.normal, real(1.0), 1, geometry, pressure, fields.second_load,
        start, fields.first_local,
    )  # fmt: skip
    low = geometry.second_window[w, pair, 0]
    columns = geometry.second_window[w, pair, 1] - low + 1
    start = base_b + low * model.surfaces.rows[model.pairs.second[pair]]
    add_fields(
        model, w, 2 * pair + 1, low, columns, model.responses.normal, real(1.0), 1, geometry, pressure,
        fields.second_load, start, fields.second_local,
    )  # fmt: skip


@kernel
def load_modes(
    run: Run, geometry: ContactGeometry, contact: ContactState, fields: ContactFields,
    pair_modal: wp.array(dtype=real),
):  # fmt: skip
    """Per (world, pair): load of the contact pressures on the modes of A, then of B, at the present position of the
    grids."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or model.pairs.family[pair] == PATCH:
        return
    trial = modal_line(model, w, pair)
    i = lane
    while i < model.pairs.most_modes:
        pair_modal[trial + i] = real(0.0)
        i += wp.block_dim()
    sync()
    A = model.pairs.first[pair]
    rows = model.surfaces.rows[A]
    modes_a = model.surfaces.modal_count[A]
    m = (geometry.window[w, pair, 0] + model.window.half) * rows
    while m < (geometry.window[w, pair, 1] + model.window.half + 1) * rows:
        if contact.active[w, pair, m] != 0:
            column = m / rows
            node = node_of(model, A, geometry.center[w, pair, 0] + column - model.window.half, m - column * rows)
            if node >= 0:
                at = model.surfaces.mode_start[A] + node * modes_a
                axpy(modes_a, -contact.pressure[w, pair, m], model.surfaces.mode_moment, at, pair_modal, trial)
        m += 1
    B = model.pairs.second[pair]
    rows = model.surfaces.rows[B]
    modes = model.surfaces.modal_count[B]
    base = (w * model.pairs.count + pair) * model.window.nodes
    i = geometry.second_window[w, pair, 0] * rows
    while i < (geometry.second_window[w, pair, 1] + 1) * rows:
        f = fields.second_load[base + i]
        if f != real(0.0):
            column = i / rows
            node = node_of(model, B, geometry.center[w, pair, 1] + column - model.window.second_half, i - column * rows)
            if node >= 0:
                at = model.surfaces.mode_start[B] + node * modes
                axpy(modes, -f, model.surfaces.mode_normal, at, pair_modal, trial + modes_a)
        i += 1


@kernel
def sum_contact(
    run: Run, geometry: ContactGeometry, contact: ContactState, fields: ContactFields, residuals: Residuals
):
    """Lanes over nodes: contact wrench on A of every pair, its contact energy s.G.s/2, and the largest residual gap of
    active nodes (as a fraction of the penetration, and the penetration)."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    worst = real(0.0)
    depth = real(0.0)
    pair = int(0)
    while pair < model.pairs.count:
        found = values(real(0.0))  # wrench and energy
        rows = model.surfaces.rows[model.pairs.first[pair]]
        m = (geometry.window[w, pair, 0] + model.window.half) * rows + lane
        while m < (geometry.window[w, pair, 1] + model.window.half + 1) * rows:
            if contact.active[w, pair, m] != 0 and geometry.area[w, pair, m] > real(0.0):
                s = contact.pressure[w, pair, m]
                for i in range(6):
                    whole = geometry.wrench[w, pair, m, i]
                    if model.pairs.family[pair] != LINE_OF_CENTRES:
                        whole += geometry.more_wrench[w, pair, m, i]
                    found[i] += s * whole
                found[6] += real(0.5) * s * (fields.opened[w, pair, m] - fields.gap[w, pair, m])
                worst = wp.max(worst, wp.abs(fields.opened[w, pair, m]) / geometry.area[w, pair, m])
                depth = wp.max(depth, wp.abs(fields.gap[w, pair, m]) / geometry.area[w, pair, m])
            m += wp.block_dim()
        found = totals(found)
        if lane == 0:
            for i in range(6):
                geometry.pair_wrench[w, pair, i] = found[i]
            contact.pair_energy[w, pair, 1] = found[6]
        pair += 1
    worst = most(worst)
    depth = most(depth)
    if lane != 0:
        return
    residuals.gap_defect[w, 0] = real(0.0)
    residuals.gap_defect[w, 1] = real(0.0)
    if depth > real(0.0):
        residuals.gap_defect[w, 1] = wp.max(depth, SHALLOW * model.length)
        residuals.gap_defect[w, 0] = worst / residuals.gap_defect[w, 1]
