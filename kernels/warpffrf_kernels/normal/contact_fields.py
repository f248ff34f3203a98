"""Displacement fields on the contact windows, and what they make of the gaps.

Three parts open or close a weak gap: the undeformed gap (`line_of_centres`), the global modes (`modal_fields`) and the
local modes (`local_fields`). Displacements by the local modes are never read off the matrix G: the compliance tables
are applied to the present loads, so that the residual is that of the present position of the grids.
"""

import warp as wp

from warpffrf_kernels.core.access import inout, out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import LINE_OF_CENTRES, PATCH, Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, dot, real, sync
from warpffrf_kernels.normal.contact_compliance import node_of
from warpffrf_kernels.normal.pair_forces import modal_line
from warpffrf_kernels.surfaces.fields import add_fields, clear_field

wp.set_module_options(MODULE_OPTIONS)

# of the scene's length: smaller penetrations do not tighten the tolerance of gaps, or it would be that of round-off
SHALLOW = wp.constant(wp.float64(1.0e-5))


@wp.kernel
def set_second_window(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    window: wp.array3d(dtype=int),
    area: wp.array3d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    active: out(wp.array3d(dtype=int)),
    pressure: out(wp.array3d(dtype=real)),
    second_window: out(wp.array3d(dtype=int)),
):
    """Per (world, pair): columns of the second grid that the hats of the window reach; hats that face nothing leave the
    active set, since their stencils may lie beyond that grid's window."""
    w, pair = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    on_hats = int(model.pairs.family[pair] != PATCH)
    low = model.window.second_columns - 1
    high = int(0)
    m = (window[w, pair, 0] + model.window.half) * rows
    while m < (window[w, pair, 1] + model.window.half + 1) * rows:
        if area[w, pair, m] > real(0.0):
            if on_hats != 0:
                low = wp.min(low, stencil_at[w, pair, m, 0])
                high = wp.max(high, stencil_at[w, pair, m, 0] + model.window.stencil_columns - 1)
        else:
            active[w, pair, m] = 0
            pressure[w, pair, m] = real(0.0)
        m += 1
    second_window[w, pair, 0] = wp.min(low, high)
    second_window[w, pair, 1] = high


@wp.kernel
def modal_fields(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    center: wp.array3d(dtype=int),
    window: wp.array3d(dtype=int),
    second_window: wp.array3d(dtype=int),
    amplitude: wp.array(dtype=real),
    of_state: int,
    first_field: out(wp.array3d(dtype=real)),
    second_field: out(wp.array(dtype=real)),
):
    """Per (world, pair), lanes over hats of A and nodes of B: weak displacement (M Phi_A q)_i and displacement
    (Phi_B q) by the modes.
    """
    w, pair, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or (of_state != 0 and ctl[w].moved == 0) or model.pairs.family[pair] == PATCH:
        return
    A = model.pairs.first[pair]
    B = model.pairs.second[pair]
    rows = model.surfaces.rows[A]
    first = model.surfaces.modal_start[A]
    modes = model.surfaces.modal_count[A]
    first += w * model.modes.count
    m = (window[w, pair, 0] + model.window.half) * rows + lane
    while m < (window[w, pair, 1] + model.window.half + 1) * rows:
        column = m / rows
        node = node_of(model, A, center[w, pair, 0] + column - model.window.half, m - column * rows)
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
    m = second_window[w, pair, 0] * rows + lane
    while m < (second_window[w, pair, 1] + 1) * rows:
        column = m / rows
        node = node_of(model, B, center[w, pair, 1] + column - model.window.second_half, m - column * rows)
        value = real(0.0)
        if node >= 0:
            value = dot(
                modes, model.surfaces.mode_normal, model.surfaces.mode_start[B] + node * modes, amplitude, first
            )
        second_field[(w * model.pairs.count + pair) * model.window.nodes + m] = value
        m += wp.block_dim()


@wp.func
def on_stencil(
    model: Model,
    w: int,
    pair: int,
    m: int,
    rows: int,
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    field: wp.array(dtype=real),
) -> real:
    """l_i . field, the field given on the window of the second grid."""
    base = (w * model.pairs.count + pair) * model.window.nodes
    total = real(0.0)
    c = int(0)
    while c < model.window.stencil_columns:
        r = int(0)
        while r < model.window.stencil_rows:
            row = stencil_at[w, pair, m, 1] + r
            if row < rows:
                weight = stencil[w, pair, m, c * model.window.stencil_rows + r]
                total += weight * field[base + (stencil_at[w, pair, m, 0] + c) * rows + row]
            r += 1
        c += 1
    return total


@wp.func
def local_gap(
    model: Model,
    w: int,
    pair: int,
    m: int,
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    first_local: wp.array(dtype=real),
    second_local: wp.array(dtype=real),
) -> real:
    """Opening of a weak gap by the local modes of both bodies."""
    at = w * model.pairs.count + pair
    value = first_local[at * model.window.hats + m]
    if model.pairs.family[pair] == PATCH:
        return value
    rows_b = model.surfaces.rows[model.pairs.second[pair]]
    return value + on_stencil(model, w, pair, m, rows_b, stencil, stencil_at, second_local)


@wp.kernel
def close_gaps(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    window: wp.array3d(dtype=int),
    weak_gap: wp.array3d(dtype=real),
    area: wp.array3d(dtype=real),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    first_field: wp.array3d(dtype=real),
    second_field: wp.array(dtype=real),
    first_local: wp.array(dtype=real),
    second_local: wp.array(dtype=real),
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    gap: out(wp.array3d(dtype=real)),
    opened: out(wp.array3d(dtype=real)),
    base: out(wp.array3d(dtype=real)),
):
    """Per (world, pair), lanes over hats: weak gaps of the present state and the pressures they belong to.

    gap = weak_gap - M Phi_A q - l . Phi_B q has the deformation by the global modes, opened also that by the local ones
    under the present pressures, which are kept as `base`: what the solve changes is counted from there.
    """
    w, pair, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    rows_b = model.surfaces.rows[model.pairs.second[pair]]
    m = lane
    while m < model.window.hats:
        base[w, pair, m] = real(0.0)
        if active[w, pair, m] != 0:
            base[w, pair, m] = pressure[w, pair, m]
        m += wp.block_dim()
    m = (window[w, pair, 0] + model.window.half) * rows + lane
    while m < (window[w, pair, 1] + model.window.half + 1) * rows:
        value = weak_gap[w, pair, m]
        if area[w, pair, m] > real(0.0):
            value -= first_field[w, pair, m]
            if model.pairs.family[pair] != PATCH:
                value -= on_stencil(model, w, pair, m, rows_b, stencil, stencil_at, second_field)
        gap[w, pair, m] = value
        opened[w, pair, m] = value + local_gap(model, w, pair, m, stencil, stencil_at, first_local, second_local)
        m += wp.block_dim()


@wp.kernel
def load_second(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    window: wp.array3d(dtype=int),
    active: wp.array3d(dtype=int),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
    pressure: wp.array3d(dtype=real),
    second_load: inout(wp.array(dtype=real)),
):
    """Per (world, pair): loads of B's hats under the present pressures [N]."""
    w, pair, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0:
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    rows_b = model.surfaces.rows[model.pairs.second[pair]]
    base_b = (w * model.pairs.count + pair) * model.window.nodes
    i = lane
    while i < model.window.nodes:
        second_load[base_b + i] = real(0.0)
        i += wp.block_dim()
    sync()
    if lane != 0 or model.pairs.family[pair] == PATCH:
        return
    m = (window[w, pair, 0] + model.window.half) * rows
    while m < (window[w, pair, 1] + model.window.half + 1) * rows:
        if active[w, pair, m] != 0:
            c = int(0)
            while c < model.window.stencil_columns:
                r = int(0)
                while r < model.window.stencil_rows:
                    weight = stencil[w, pair, m, c * model.window.stencil_rows + r]
                    if weight != real(0.0):
                        e = base_b + (stencil_at[w, pair, m, 0] + c) * rows_b + stencil_at[w, pair, m, 1] + r
                        second_load[e] = second_load[e] + weight * pressure[w, pair, m]
                    r += 1
                c += 1
        m += 1


@wp.kernel
def local_fields(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    center: wp.array3d(dtype=int),
    window: wp.array3d(dtype=int),
    second_window: wp.array3d(dtype=int),
    pressure: wp.array(dtype=real),
    second_load: wp.array(dtype=real),
    first_local: inout(wp.array(dtype=real)),
    second_local: inout(wp.array(dtype=real)),
):
    """Per (world, pair): displacements by the local modes under the loads of all pairs on the two bodies: weak ones on
    A's hats, nodal ones on B, both opening the gap. pressure: 0 where inactive."""
    w, pair, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or model.pairs.family[pair] == PATCH:
        return
    base = (w * model.pairs.count + pair) * model.window.hats
    base_b = (w * model.pairs.count + pair) * model.window.nodes
    clear_field(lane, model.window.hats, base, first_local)
    clear_field(lane, model.window.nodes, base_b, second_local)
    low = window[w, pair, 0] + model.window.half
    columns = window[w, pair, 1] - window[w, pair, 0] + 1
    start = base + low * model.surfaces.rows[model.pairs.first[pair]]
    add_fields(
        model, w, 2 * pair, low, columns, model.responses.normal, real(1.0), 1, center, window, second_window,
        pressure, second_load, start, first_local,
    )  # fmt: skip
    low = second_window[w, pair, 0]
    columns = second_window[w, pair, 1] - low + 1
    start = base_b + low * model.surfaces.rows[model.pairs.second[pair]]
    add_fields(
        model, w, 2 * pair + 1, low, columns, model.responses.normal, real(1.0), 1, center, window, second_window,
        pressure, second_load, start, second_local,
    )  # fmt: skip


@wp.kernel
def load_modes(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    center: wp.array3d(dtype=int),
    window: wp.array3d(dtype=int),
    second_window: wp.array3d(dtype=int),
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    second_load: wp.array(dtype=real),
    pair_modal: inout(wp.array(dtype=real)),
):
    """Per (world, pair): load of the contact pressures on the modes of A, then of B, at the present position of the
    grids."""
    w, pair, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0 or model.pairs.family[pair] == PATCH:
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
    m = (window[w, pair, 0] + model.window.half) * rows
    while m < (window[w, pair, 1] + model.window.half + 1) * rows:
        if active[w, pair, m] != 0:
            column = m / rows
            node = node_of(model, A, center[w, pair, 0] + column - model.window.half, m - column * rows)
            if node >= 0:
                at = model.surfaces.mode_start[A] + node * modes_a
                axpy(modes_a, -pressure[w, pair, m], model.surfaces.mode_moment, at, pair_modal, trial)
        m += 1
    B = model.pairs.second[pair]
    rows = model.surfaces.rows[B]
    modes = model.surfaces.modal_count[B]
    base = (w * model.pairs.count + pair) * model.window.nodes
    i = second_window[w, pair, 0] * rows
    while i < (second_window[w, pair, 1] + 1) * rows:
        f = second_load[base + i]
        if f != real(0.0):
            column = i / rows
            node = node_of(model, B, center[w, pair, 1] + column - model.window.second_half, i - column * rows)
            if node >= 0:
                at = model.surfaces.mode_start[B] + node * modes
                axpy(modes, -f, model.surfaces.mode_normal, at, pair_modal, trial + modes_a)
        i += 1


@wp.kernel
def sum_contact(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    window: wp.array3d(dtype=int),
    active: wp.array3d(dtype=int),
    area: wp.array3d(dtype=real),
    wrench: wp.array4d(dtype=real),
    gap: wp.array3d(dtype=real),
    opened: wp.array3d(dtype=real),
    more_wrench: wp.array4d(dtype=real),
    pressure: wp.array3d(dtype=real),
    pair_wrench: inout(wp.array3d(dtype=real)),
    gap_defect: inout(wp.array2d(dtype=real)),
    pair_energy: out(wp.array3d(dtype=real)),
):
    """Per world: contact wrench on A of every pair, its contact energy s.G.s/2, and what active gaps are left open (a
    fraction of the penetration, and the penetration)."""
    w = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].moved == 0:
        return
    worst = real(0.0)
    depth = real(0.0)
    pair = int(0)
    while pair < model.pairs.count:
        energy = real(0.0)
        for i in range(6):
            pair_wrench[w, pair, i] = real(0.0)
        rows = model.surfaces.rows[model.pairs.first[pair]]
        m = (window[w, pair, 0] + model.window.half) * rows
        while m < (window[w, pair, 1] + model.window.half + 1) * rows:
            if active[w, pair, m] != 0 and area[w, pair, m] > real(0.0):
                s = pressure[w, pair, m]
                for i in range(6):
                    whole = wrench[w, pair, m, i]
                    if model.pairs.family[pair] != LINE_OF_CENTRES:
                        whole += more_wrench[w, pair, m, i]
                    pair_wrench[w, pair, i] = pair_wrench[w, pair, i] + s * whole
                energy += real(0.5) * s * (opened[w, pair, m] - gap[w, pair, m])
                worst = wp.max(worst, wp.abs(opened[w, pair, m]) / area[w, pair, m])
                depth = wp.max(depth, wp.abs(gap[w, pair, m]) / area[w, pair, m])
            m += 1
        pair_energy[w, pair, 1] = energy
        pair += 1
    gap_defect[w, 0] = real(0.0)
    gap_defect[w, 1] = real(0.0)
    if depth > real(0.0):
        gap_defect[w, 1] = wp.max(depth, SHALLOW * model.length)
        gap_defect[w, 0] = worst / gap_defect[w, 1]
