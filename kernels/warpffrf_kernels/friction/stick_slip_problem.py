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
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync, vec3, weighted
from warpffrf_kernels.friction.cell_forces import creep_softness
from warpffrf_kernels.friction.cell_shares import on_shares
from warpffrf_kernels.friction.cells import cell_at
from warpffrf_kernels.friction.pressure_answer import OPEN
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
    model = models[0]
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    first = w * model.modes.count
    n = lane
    while n < model.modes.count:
        modal_drive[first + n] = -modal_residual[w, n]
        n += wp.block_dim()
    sync()
    push_by_slots(model, ctl, w, slot_hat, active, pressure, base, weight, J, modal_drive)


# Line `row` of L times the entries of z in its columns.
@wp.func_native("""
    const int* c = model.pairs.coupled.data + (size_t)pair * model.pairs.coupled_capacity;
    const double* l = L.data + ((size_t)w * 2 * model.capacity.cells + row) * model.pairs.coupled_capacity;
    const double* v = z.data + (size_t)w * model.outer.count;
    double sum = 0.0;
    for (int i = 0; i < model.pairs.coupled_count.data[pair]; ++i) sum += l[i] * v[c[i]];
    return sum;
""")
def gathered(model: Model, w: int, pair: int, row: int, L: wp.array3d(dtype=real), z: wp.array(dtype=real)) -> real: ...


# right -= K x over the first n lines, lanes over the lines; contiguous runs, as `dot`.
@wp.func_native("""
    const int cap = 2 * model.capacity.cells;
    const double* v = x.data + (size_t)w * cap;
    for (int i = WP_TILE_THREAD_IDX; i < n; i += WP_TILE_BLOCK_DIM) {
        const double* a = K.data + ((size_t)w * cap + i) * cap; double s[8] = {0.0}, sum = 0.0; int j = 0;
        for (; j + 7 < n; j += 8) for (int c = 0; c < 8; ++c) s[c] += a[j + c] * v[j + c];
        for (; j < n; ++j) sum += a[j] * v[j];
        for (int c = 0; c < 8; ++c) sum += s[c];
        right.data[(size_t)w * cap + i] -= sum;
    }
""")
def subtract_product(
    model: Model,
    w: int,
    n: int,
    K: wp.array3d(dtype=real),
    x: wp.array2d(dtype=real),
    right: wp.array2d(dtype=real),
): ...


@wp.kernel
def pose_tractions(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    cell_slot: wp.array3d(dtype=int),
    weight: wp.array2d(dtype=real),
    cell_area: wp.array3d(dtype=real),
    traction: wp.array3d(dtype=real),
    traction_base: wp.array3d(dtype=real),
    slip: wp.array3d(dtype=real),
    cell_turn: wp.array4d(dtype=real),
    share: wp.array4d(dtype=real),
    share_at: wp.array4d(dtype=int),
    first_shift: wp.array(dtype=real),
    second_shift: wp.array(dtype=real),
    K: wp.array3d(dtype=real),
    L: wp.array3d(dtype=real),
    J: wp.array(dtype=real),
    receptance: wp.array(dtype=real),
    modal_drive: wp.array(dtype=real),
    z: wp.array(dtype=real),
    base: inout(wp.array2d(dtype=real)),
    right: inout(wp.array2d(dtype=real)),
    tau: out(wp.array2d(dtype=real)),
):
    """Per world: right-hand side r_0 = S + dS(ds) + L z + J sigma^-1 (modal drive) - K tau_base, and first guess of all
    slots. dS: by the local modes under the change of the pressures, of which the shifts are."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    count = ctl[w].cells
    i = lane
    while i < count:
        pair = cell_slot[w, i, 0]
        m = cell_slot[w, i, 1]
        rows = model.surfaces.rows[model.pairs.first[pair]]
        area = cell_area[w, pair, m]
        scale = weight[w, pair]
        second = vec3(real(0.0), real(0.0), real(0.0))
        if model.surfaces.shear_start[model.pairs.second[pair]] >= 0:
            second = on_shares(model, w, pair, m, cell_turn, share, share_at, second_shift)
        for d in range(2):
            row = 2 * i + d
            at = cell_at(rows, m, d)
            base[w, row] = scale * traction_base[w, pair, at]
            tau[w, row] = scale * traction[w, pair, at]
            moved = first_shift[(w * model.pairs.count + pair) * 2 * model.window.hats + at] - second[d]
            value = scale * area * (slip[w, pair, at] + moved) + gathered(model, w, pair, row, L, z)
            line = (w * model.capacity.cells + i) * 2 * model.pairs.most_modes + d * model.pairs.most_modes
            for side in range(2):
                surface = surface_of(model, pair, side)
                modes = w * model.modes.count + model.surfaces.modal_start[surface]
                n = model.surfaces.modal_count[surface]
                value += weighted(n, J, line, receptance, modes, modal_drive, modes)
                line += n
            right[w, row] = value
        i += wp.block_dim()
    sync()
    subtract_product(model, w, 2 * count, K, base, right)


@wp.kernel
def limit_tractions(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    cell_slot: wp.array3d(dtype=int),
    weight: wp.array2d(dtype=real),
    cell_area: wp.array3d(dtype=real),
    bound: wp.array3d(dtype=real),
    late: wp.array3d(dtype=real),
    answer_state: wp.array2d(dtype=int),
    radius: out(wp.array2d(dtype=real)),
    softness: out(wp.array2d(dtype=real)),
):
    """Per world: discs and softness of all slots, with the bounds of the pressures as they are in this round."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].changes != 0 or answer_state[w, OPEN] == 0:
        return
    i = lane
    while i < ctl[w].cells:
        pair = cell_slot[w, i, 0]
        m = cell_slot[w, i, 1]
        b = bound[w, pair, m]
        radius[w, i] = weight[w, pair] * b
        softness[w, i] = real(0.0)
        if b > real(0.0):
            softness[w, i] = cell_area[w, pair, m] * (creep_softness(model, clk, w, pair, b) + late[w, pair, m])
        i += wp.block_dim()


@wp.kernel
def take_tractions(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    cell_slot: wp.array3d(dtype=int),
    weight: wp.array2d(dtype=real),
    tau: wp.array2d(dtype=real),
    base: wp.array2d(dtype=real),
    V: wp.array(dtype=real),
    z: changed(wp.array(dtype=real)),
    traction: out(wp.array3d(dtype=real)),
):
    """Per world: the tractions found, and the outer increments with them and with the pressures' answer."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    N = model.outer.count
    i = int(0)
    while i < 2 * ctl[w].cells:
        pair = cell_slot[w, i / 2, 0]
        m = cell_slot[w, i / 2, 1]
        if lane == 0:
            rows = model.surfaces.rows[model.pairs.first[pair]]
            traction[w, pair, cell_at(rows, m, i % 2)] = tau[w, i] / weight[w, pair]
        change = tau[w, i] - base[w, i]
        if change != real(0.0):
            axpy(N, change, V, (w * 2 * model.capacity.cells + i) * N, z, w * N)
        i += 1


@wp.kernel
def push_modes(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    cell_slot: wp.array3d(dtype=int),
    tau: wp.array2d(dtype=real),
    base: wp.array2d(dtype=real),
    J: wp.array(dtype=real),
    receptance: wp.array2d(dtype=real),
    push: inout(wp.array(dtype=real)),
    modal_step: changed(wp.array(dtype=real)),
):
    """Per world: adds the increments of the global modes by the change of the tractions (those without inertia terms;
    the others are outer coordinates)."""
    w, lane = wp.tid()
    model = models[0]
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    first = w * model.modes.count
    n = lane
    while n < model.modes.count:
        push[first + n] = real(0.0)
        n += wp.block_dim()
    sync()
    i = int(0)
    while i < 2 * ctl[w].cells:
        change = tau[w, i] - base[w, i]
        if change != real(0.0):
            pair = cell_slot[w, i / 2, 0]
            start = (w * model.capacity.cells + i / 2) * 2 * model.pairs.most_modes + (i % 2) * model.pairs.most_modes
            for side in range(2):
                surface = surface_of(model, pair, side)
                modes = model.surfaces.modal_count[surface]
                axpy(modes, change, J, start, push, first + model.surfaces.modal_start[surface])
                start += modes
        i += 1
    sync()
    n = lane
    while n < model.modes.count:
        if model.modes.dense_of[n] < 0:
            modal_step[first + n] = modal_step[first + n] + receptance[w, n] * push[first + n]
        n += wp.block_dim()
