r"""Displacements due to tractions on the cells of a patch, and the changes of their slips.

With the cell forces f = area tau on A and -Q^T f on B (Q: tangents of B in those of A), far fields and modes by the
the splines P of `patch.far_splines`,

    u_A = Phi_tA q + P S_tt P^T f - P S_nt^T P^T (area p),      e = u_A - Q u_B + half-spaces (`shear`),

and the gap opens by -P S_nt P^T f of either body and the transpose of the half-spaces' coupling. Material that rotates
with its body by V dt/R moves with its actual radius: outward displacements u_n beyond the half-space, by far field and
modes, carry it (k: curvature of each body in the rolling direction)

    slip += (k_A u_nA - k_B u_nB) V dt,

V dt the path of the material through the patch. The half-space requires no such term: its displacement is a vector in
the frame of the patch, not of the rotating surface. Creepage thus refers to undeformed radii.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactFields, PatchScratch, RollingScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells, FrictionSolve, StripSolve
from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, dot, real, sync
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.core.state import ContactState, FrictionState
from warpffrf_kernels.friction.cell_blocks import COUNT, first_line
from warpffrf_kernels.friction.cells import cell_at, rubs_on_patch
from warpffrf_kernels.friction.pressure_response import OPEN
from warpffrf_kernels.normal.pair_forces import modal_line
from warpffrf_kernels.patch.fields import add_splines, half_of, rows_of, sum_lines
from warpffrf_kernels.patch.spline_tables import line_of, real_side
from warpffrf_kernels.rolling.shear import STRIPS_AROUND, near_along, open_near, shear_line
from warpffrf_kernels.rolling.spline_tables import half_along, load_side, read_side, sum_along, table_along, trace_along
from warpffrf_kernels.rolling.strips import multiply_half_spaces
from warpffrf_kernels.surfaces.fields import clear_field
from warpffrf_kernels.surfaces.height import height_curvature
from warpffrf_kernels.surfaces.smooth import radius_of
from warpffrf_kernels.surfaces.surface import EXTRUDED, HEIGHT, curve_curvature

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def load_sides(model: Model, elements: Elements, w: int, pair: int, patch: PatchScratch, rolling: RollingScratch):
    """Forces on the splines of both sides due to tractions at places."""
    places = elements.patches.places
    here = (w * model.pairs.count + pair) * 4 * places
    rows = model.surfaces.rows[model.pairs.first[pair]]
    for side in range(2):
        s = real_side(elements, pair, side)
        for d in range(2):
            if s >= 0:
                load_side(
                    model, elements, w, pair, side, rows, model.surfaces.rows[s],
                    patch.far_window[w, pair, side, 1] * model.surfaces.rows[s], patch.far_strip, patch.far_share,
                    rolling.place_traction, here + (2 * side + d) * places, rolling.rub_load,
                    half_along(model, elements, w, pair, side, d),
                )  # fmt: skip


@kernel
def load_along(run: Run, friction: FrictionState, cells: FrictionCells, patch: PatchScratch, rolling: RollingScratch):
    """Per (world, pair): tractions on A and on B at places, and the corresponding forces on the splines of both sides
    [N]."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not rubs_on_patch(model, pair):
        return
    elements = model.elements[0]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    line = line_of(rows)
    places = elements.patches.places
    here = (w * model.pairs.count + pair) * 4 * places
    clear_field(lane, 4 * places, here, rolling.place_none)
    e = lane
    while e < elements.patches.columns[pair] * line:
        t_1 = real(0.0)
        t_2 = real(0.0)
        g_1 = real(0.0)
        g_2 = real(0.0)
        if e % line < rows:
            m = (e / line) * rows + e % line
            if cells.cell_area[w, pair, m] > real(0.0):
                t_1 = friction.traction[w, pair, cell_at(rows, m, 0)]
                t_2 = friction.traction[w, pair, cell_at(rows, m, 1)]
                g_1 = -(cells.cell_turn[w, pair, m, 0] * t_1 + cells.cell_turn[w, pair, m, 2] * t_2)
                g_2 = -(cells.cell_turn[w, pair, m, 1] * t_1 + cells.cell_turn[w, pair, m, 3] * t_2)
        rolling.place_traction[here + e] = t_1
        rolling.place_traction[here + places + e] = t_2
        rolling.place_traction[here + 2 * places + e] = g_1
        rolling.place_traction[here + 3 * places + e] = g_2
        e += wp.block_dim()
    sync()
    load_sides(model, elements, w, pair, patch, rolling)


@wp.func
def open_by_tractions(
    model: Model, elements: Elements, w: int, pair: int, lane: int, patch: PatchScratch, rolling: RollingScratch,
    value: wp.array(dtype=real),
):  # fmt: skip
    """Adds to `value` of the cells of a pair the opening of the weak gaps due to tractions at places, whose spline
    loads are `rub_load`."""
    nodes = elements.patches.far_nodes
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            count = patch.far_window[w, pair, side, 1] * model.surfaces.rows[s]
            at = half_of(model, elements, w, pair, side)
            sum_along(
                line_of(count), count, nodes, rolling.rub_load, half_along(model, elements, w, pair, side, 0),
                rolling.rub_table, table_along(model, elements, w, pair, side, 0) + 2 * nodes, rolling.rub_push, at,
            )  # fmt: skip
            n = lane
            while n < line_of(count):
                rolling.rub_push[at + n] = -rolling.rub_push[at + n]
                n += wp.block_dim()
            sync()
    rows = model.surfaces.rows[model.pairs.first[pair]]
    add_splines(
        model, elements, w, pair, rows, rows_of(model, elements, pair, 0), rows_of(model, elements, pair, 1),
        patch.far_strip, patch.far_share, rolling.rub_push, value,
    )  # fmt: skip
    if elements.rolling.coupled[pair] != 0:
        rings = elements.rolling.ring_rows[pair]
        open_near(
            model, elements, w, pair, rows, rings, shear_line(rows, rings), STRIPS_AROUND, rolling.shear_near,
            rolling.place_traction, value, (w * model.pairs.count + pair) * model.window.grid_nodes,
        )  # fmt: skip


@kernel
def open_gaps(run: Run, patch: PatchScratch, rolling: RollingScratch, fields: ContactFields):
    """Per (world, pair), lanes over splines, then cells: adds the opening of the weak gaps due to tractions."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or not rubs_on_patch(model, pair):
        return
    open_by_tractions(model, model.elements[0], w, pair, lane, patch, rolling, fields.first_local)


@kernel
def open_by_change(
    run: Run, tangential: FrictionSolve, cells: FrictionCells, patch: PatchScratch, rolling: RollingScratch
):
    """Per (world, pair), lanes over places, then cells: opening of the weak gaps due to the change of the tractions in
    this round, times the weight of the pair."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if (
        run.ctl[w].run == 0
        or run.ctl[w].changes != 0
        or tangential.answer_state[w, OPEN] == 0
        or not rubs_on_patch(model, pair)
    ):
        return
    elements = model.elements[0]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    line = line_of(rows)
    places = elements.patches.places
    here = w * model.pairs.count + pair
    e = lane
    while e < 4 * places:
        rolling.place_traction[here * 4 * places + e] = real(0.0)
        e += wp.block_dim()
    clear_field(lane, model.window.grid_nodes, here * model.window.grid_nodes, rolling.gap_change)
    sync()
    i = lane
    while i < tangential.cell_block[w, pair, COUNT]:
        m = tangential.cell_slot[w, pair, i]
        at = here * 4 * places + (m / rows) * line + m % rows
        number = first_line(model, w, pair) + 2 * i
        t_1 = tangential.cell_tau[number] - tangential.cell_base[number]
        t_2 = tangential.cell_tau[number + 1] - tangential.cell_base[number + 1]
        rolling.place_traction[at] = t_1
        rolling.place_traction[at + places] = t_2
        rolling.place_traction[at + 2 * places] = -(
            cells.cell_turn[w, pair, m, 0] * t_1 + cells.cell_turn[w, pair, m, 2] * t_2
        )
        rolling.place_traction[at + 3 * places] = -(
            cells.cell_turn[w, pair, m, 1] * t_1 + cells.cell_turn[w, pair, m, 3] * t_2
        )
        i += wp.block_dim()
    sync()
    load_sides(model, elements, w, pair, patch, rolling)
    open_by_tractions(model, elements, w, pair, lane, patch, rolling, rolling.gap_change)


@wp.func
def pressed_along(
    model: Model, elements: Elements, w: int, pair: int, side: int, lane: int, count: int, load: wp.array(dtype=real),
    at_load: int, rolling: RollingScratch,
):  # fmt: skip
    """Adds the tangential displacement due to pressures with spline loads `load` to `field` of a side: -S_nt^T load."""
    nodes = elements.patches.far_nodes
    for d in range(2):
        start = table_along(model, elements, w, pair, side, d) + 2 * nodes
        at = half_along(model, elements, w, pair, side, d)
        n = lane
        while n < count:
            rolling.rub_field[at + n] = rolling.rub_field[at + n] - dot(
                count, load, at_load, rolling.rub_table, start + n * 3 * nodes
            )
            n += wp.block_dim()
    sync()


@wp.func
def curvature_along(model: Model, s: int, column: real, z: real, x: real, y: real) -> real:
    """Curvature [1/m] of surface s at a column and z in the direction (x, y) of its tangents, positive if convex; for a
    tabulated surface that of the neighbouring arc."""
    if model.surfaces.planar[s] == EXTRUDED:
        return x * x * curve_curvature(model, s, model.surfaces.theta[s] + column * model.surfaces.pitch[s])
    if model.surfaces.planar[s] == HEIGHT:
        return height_curvature(model, s, model.surfaces.theta[s] + column * model.surfaces.pitch[s], z, x, y)
    if model.surfaces.planar[s] != 0:
        return real(0.0)
    along = real(0.0)
    if model.surfaces.crown[s] != real(0.0):
        along = real(1.0) / model.surfaces.crown[s]
    return x * x * model.surfaces.side[s] / radius_of(model, s, z) + y * y * along


@kernel
def move_cells(
    run: Run, trial: Trial, patch: PatchScratch, rubbing: FrictionCells, rolling: RollingScratch, strips: StripSolve,
    patch_pressure: wp.array(dtype=real),
):  # fmt: skip
    """Per (world, pair), lanes over splines, then cells: e by local modes, total e [m], and the outward displacements
    over the radii of both bodies, that of A minus that of B."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not rubs_on_patch(model, pair):
        return
    elements = model.elements[0]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    cells = elements.patches.columns[pair] * rows
    grid_nodes = model.window.grid_nodes
    nodes = elements.patches.far_nodes
    here = w * model.pairs.count + pair
    m = lane
    while m < 4 * grid_nodes:
        rolling.weak_shift[here * 4 * grid_nodes + m] = real(0.0)
        rolling.weak_modes[here * 4 * grid_nodes + m] = real(0.0)
        if m < grid_nodes:
            rolling.weak_grown[here * grid_nodes + m] = real(0.0)
        m += wp.block_dim()
    sync()
    # far fields and modes on the splines of each side, then interpolated at the cells
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            own = model.surfaces.rows[s]
            count = patch.far_window[w, pair, side, 1] * own
            loads = half_along(model, elements, w, pair, side, 0)
            for d in range(2):
                at = half_along(model, elements, w, pair, side, d)
                sum_along(
                    line_of(count), count, nodes, rolling.rub_load, loads, rolling.rub_table,
                    table_along(model, elements, w, pair, side, 0) + d * nodes, rolling.rub_field, at,
                )  # fmt: skip
                sum_lines(
                    line_of(count), model.surfaces.modal_count[s], trial.q1,
                    w * model.modes.count + model.surfaces.modal_start[s], rolling.rub_trace,
                    trace_along(model, elements, w, pair, side) + d * nodes, 2 * nodes, rolling.rub_modes, at,
                )  # fmt: skip
            out_at = half_of(model, elements, w, pair, side)
            pressed_along(model, elements, w, pair, side, lane, count, patch.far_load, out_at, rolling)
            q = rubbing.cell_turn[w, pair, (elements.patches.columns[pair] / 2) * rows + rows / 2, 0]
            y = rubbing.cell_turn[w, pair, (elements.patches.columns[pair] / 2) * rows + rows / 2, 1]
            column = patch.patch_place[w, pair, 0]
            curved = curvature_along(model, s, column, patch.patch_place[w, pair, 1], real(1.0), real(0.0))
            if side == 1:
                curved = -curvature_along(model, s, patch.patch_place[w, pair, 3], real(0.0), q, y)
            n = lane
            while n < line_of(count):
                rolling.grown[out_at + n] = curved * (patch.far_modes[out_at + n] - patch.far_field[out_at + n])
                n += wp.block_dim()
            sync()
            for d in range(2):
                at = half_along(model, elements, w, pair, side, d)
                to = (here * 4 + 2 * side + d) * grid_nodes
                read_side(
                    model, elements, w, pair, side, rows, own, patch.far_strip, patch.far_share, rolling.rub_field, at,
                    rolling.weak_shift, to,
                )  # fmt: skip
                read_side(
                    model, elements, w, pair, side, rows, own, patch.far_strip, patch.far_share, rolling.rub_modes, at,
                    rolling.weak_modes, to,
                )  # fmt: skip
    add_splines(
        model, elements, w, pair, rows, rows_of(model, elements, pair, 0), rows_of(model, elements, pair, 1),
        patch.far_strip, patch.far_share, rolling.grown, rolling.weak_grown,
    )  # fmt: skip
    # near field, and the difference of both sides per area
    rings = elements.rolling.ring_rows[pair]
    if elements.rolling.strips == 0:
        near_along(
            model, elements, w, pair, rows, shear_line(rows, rings), STRIPS_AROUND, 0, elements.patches.columns[pair],
            rings, rows, rolling.shear_near, rolling.place_traction, patch_pressure, rolling.near_shift,
            here * 2 * grid_nodes, grid_nodes,
        )  # fmt: skip
    else:
        places = elements.patches.places
        multiply_half_spaces(
            model, elements, w, pair, strips, rolling.place_traction, here * 4 * places, strips.strip_out,
            here * 2 * places,
        )  # fmt: skip
        if elements.rolling.coupled[pair] != 0:
            near_along(
                model, elements, w, pair, rows, shear_line(rows, rings), STRIPS_AROUND, 0,
                elements.patches.columns[pair], rings, rows, rolling.shear_near, rolling.place_none, patch_pressure,
                rolling.near_shift, here * 2 * grid_nodes, grid_nodes,
            )  # fmt: skip
        m = lane
        while m < 2 * cells:
            at = (here * 2 + m / cells) * grid_nodes + m % cells
            value = strips.strip_out[(here * 2 + m / cells) * places + m % cells / rows * line_of(rows) + m % rows]
            if elements.rolling.coupled[pair] != 0:
                value += rolling.near_shift[at]
            rolling.near_shift[at] = value
            m += wp.block_dim()
    sync()
    m = lane
    while m < cells:
        area = rubbing.cell_area[w, pair, m]
        for d in range(2):
            local = real(0.0)
            modes = real(0.0)
            if area > real(0.0):
                local = (
                    rolling.near_shift[(here * 2 + d) * grid_nodes + m]
                    + rolling.weak_shift[(here * 4 + d) * grid_nodes + m]
                )
                modes = rolling.weak_modes[(here * 4 + d) * grid_nodes + m]
                for e in range(2):
                    turned = rubbing.cell_turn[w, pair, m, 2 * d + e]
                    local -= turned * rolling.weak_shift[(here * 4 + 2 + e) * grid_nodes + m]
                    modes -= turned * rolling.weak_modes[(here * 4 + 2 + e) * grid_nodes + m]
                local = local / area
                modes = modes / area
            rubbing.elastic_local[w, pair, cell_at(rows, m, d)] = local
            rubbing.elastic[w, pair, cell_at(rows, m, d)] = local + modes
        m += wp.block_dim()


@kernel
def load_modes_along(run: Run, patch: PatchScratch, rolling: RollingScratch, friction_modal: wp.array(dtype=real)):
    """Per (world, pair), lanes over modes: load of the tractions on the modes of A, then of B."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not rubs_on_patch(model, pair):
        return
    elements = model.elements[0]
    nodes = elements.patches.far_nodes
    trial = modal_line(model, w, pair)
    count_a = model.surfaces.modal_count[model.pairs.first[pair]]
    i = lane
    while i < model.pairs.most_modes:
        side = int(0)
        n = i
        if i >= count_a:
            side = int(1)
            n = i - count_a
        s = real_side(elements, pair, side)
        if s >= 0 and n < model.surfaces.modal_count[s]:
            count = patch.far_window[w, pair, side, 1] * model.surfaces.rows[s]
            line = trace_along(model, elements, w, pair, side) + n * 2 * nodes
            value = real(0.0)
            for d in range(2):
                value += dot(
                    count, rolling.rub_load, half_along(model, elements, w, pair, side, d), rolling.rub_trace,
                    line + d * nodes,
                )  # fmt: skip
            friction_modal[trial + i] = friction_modal[trial + i] + value
        i += wp.block_dim()


@kernel
def press_slips(
    run: Run, contact: ContactState, fields: ContactFields, cells: FrictionCells, patch: PatchScratch,
    rolling: RollingScratch,
):  # fmt: skip
    """Per (world, pair), lanes over places, splines, cells: change of the slips due to the change of the pressures
    [m]."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0 or not rubs_on_patch(model, pair):
        return
    elements = model.elements[0]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    line = line_of(rows)
    places = elements.patches.places
    grid_nodes = model.window.grid_nodes
    here = w * model.pairs.count + pair
    e = lane
    while e < elements.patches.columns[pair] * line:
        value = real(0.0)
        if e % line < rows:
            m = (e / line) * rows + e % line
            value = -fields.base[w, pair, m]
            if contact.active[w, pair, m] != 0:
                value += contact.pressure[w, pair, m]
        rolling.place_change[here * places + e] = value
        e += wp.block_dim()
    clear_field(lane, 4 * grid_nodes, here * 4 * grid_nodes, rolling.weak_shift)
    sync()
    for side in range(2):
        s = real_side(elements, pair, side)
        if s >= 0:
            own = model.surfaces.rows[s]
            count = patch.far_window[w, pair, side, 1] * own
            at = half_of(model, elements, w, pair, side)
            load_side(
                model, elements, w, pair, side, rows, own, count, patch.far_strip, patch.far_share,
                rolling.place_change, here * places, rolling.press_load, at,
            )  # fmt: skip
            for d in range(2):
                n = lane
                while n < line_of(count):
                    rolling.rub_field[half_along(model, elements, w, pair, side, d) + n] = real(0.0)
                    n += wp.block_dim()
            sync()
            pressed_along(model, elements, w, pair, side, lane, count, rolling.press_load, at, rolling)
            for d in range(2):
                read_side(
                    model, elements, w, pair, side, rows, own, patch.far_strip, patch.far_share, rolling.rub_field,
                    half_along(model, elements, w, pair, side, d), rolling.weak_shift,
                        (here * 4 + 2 * side + d) * grid_nodes,
                )  # fmt: skip
    rings = elements.rolling.ring_rows[pair]
    coupled = elements.rolling.coupled[pair]
    if coupled != 0:
        near_along(
            model, elements, w, pair, rows, shear_line(rows, rings), STRIPS_AROUND, 0, elements.patches.columns[pair],
            rings, rows, rolling.shear_near, rolling.place_none, rolling.place_change, rolling.near_shift,
            here * 2 * grid_nodes, grid_nodes,
        )  # fmt: skip
    m = lane
    while m < elements.patches.columns[pair] * rows:
        for d in range(2):
            value = real(0.0)
            if cells.cell_area[w, pair, m] > real(0.0):
                value = rolling.weak_shift[(here * 4 + d) * grid_nodes + m]
                if coupled != 0:
                    value += rolling.near_shift[(here * 2 + d) * grid_nodes + m]
                for e in range(2):
                    value -= (
                        cells.cell_turn[w, pair, m, 2 * d + e] * rolling.weak_shift[(here * 4 + 2 + e) * grid_nodes + m]
                    )
                value = value / cells.cell_area[w, pair, m]
            cells.pressed_slip[w, pair, cell_at(rows, m, d)] = value
        m += wp.block_dim()
