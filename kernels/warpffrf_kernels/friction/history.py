"""End of an attempt for friction: history carried with the material, and what a record shows of it.

The elastic slip e of all cells of the window is kept with the grid column of the window's centre: the next step finds
its material again by the difference of the columns. Records: power -tau.S/h, rigid creep velocity at the cell nearest
to the patch's centre, mean velocity of the two surfaces through the patch, and the most columns that the patch advanced
in a step since the last record (`patch_advance`).
"""

import warp as wp

from warpffrf_kernels.core.access import changed, inout, out
from warpffrf_kernels.core.control import Clock, Control
from warpffrf_kernels.core.integration import is_whole
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.friction.cells import cell_at, rubs_on_grid
from warpffrf_kernels.surfaces.surface import radius_of

wp.set_module_options(MODULE_OPTIONS)


@wp.kernel
def keep_slips(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    history_phase: wp.array2d(dtype=real),
    advanced: wp.array2d(dtype=real),
    center: wp.array3d(dtype=int),
    window: wp.array3d(dtype=int),
    elastic: wp.array3d(dtype=real),
    rigid_slip: wp.array3d(dtype=real),
    friction_work: wp.array3d(dtype=real),
    normal_wrench: wp.array3d(dtype=real),
    elastic_before: out(wp.array3d(dtype=real)),
    history_center: out(wp.array2d(dtype=int)),
    contact_normal: out(wp.array2d(dtype=vec3)),
    friction_record: out(wp.array3d(dtype=real)),
):
    """Per (world, pair), lanes over cells: the history of an accepted step. friction_record: power, creep (2), rolling
    velocity."""
    w, pair, lane = wp.tid()
    model = models[w]
    if ctl[w].attempt == 0 or ctl[w].accept == 0 or not rubs_on_grid(model, pair):
        return
    i = lane
    A = model.pairs.first[pair]
    rows = model.surfaces.rows[A]
    H = model.window.half
    # columns beyond the window looked at have no displacement computed: they repeat its outermost column
    low = window[w, pair, 0] + H
    high = window[w, pair, 1] + H
    while i < 2 * rows * model.window.columns:
        column = wp.clamp(i / (2 * rows), low, high)
        elastic_before[w, pair, i] = elastic[w, pair, column * 2 * rows + i % (2 * rows)]
        i += wp.block_dim()
    if lane == 0:
        h = clk[w].done_step
        at = history_phase[w, pair]
        history_center[w, pair] = center[w, pair, 0]
        force = vec3(normal_wrench[w, pair, 0], normal_wrench[w, pair, 1], normal_wrench[w, pair, 2])
        contact_normal[w, pair] = vec3(real(0.0), real(0.0), real(0.0))
        if wp.length(force) > real(0.0):
            contact_normal[w, pair] = -wp.normalize(force)
        row = rows / 2
        m = wp.clamp(int(wp.floor(at + real(0.5))) - center[w, pair, 0] + H, low, high) * rows + row
        for c in range(4):
            friction_record[w, pair, c] = real(0.0)
        if is_whole(ctl, w) and h > real(0.0):
            creep = rigid_slip[w, pair, cell_at(rows, m, 0)] / h
            z = model.surfaces.z[model.surfaces.z_start[A] + row]
            # material of the first surface runs against the columns that the patch advances
            through = -advanced[w, pair] * model.surfaces.pitch[A] * radius_of(model, A, z) * model.surfaces.side[A] / h
            friction_record[w, pair, 0] = -friction_work[w, pair, 0] / h
            friction_record[w, pair, 1] = creep
            friction_record[w, pair, 2] = rigid_slip[w, pair, cell_at(rows, m, 1)] / h
            friction_record[w, pair, 3] = through - real(0.5) * creep


@wp.kernel
def add_friction_second(
    ctl: wp.array(dtype=Control),
    pair_wrench: wp.array3d(dtype=real),
    normal_wrench: wp.array3d(dtype=real),
    second_wrench: changed(wp.array3d(dtype=real)),
):
    """Per (world, pair): tractions act on the second body along the same lines, so that their wrench there is the
    opposite."""
    w, pair = wp.tid()
    if ctl[w].record == 0:
        return
    for c in range(6):
        second_wrench[w, pair, c] -= pair_wrench[w, pair, c] - normal_wrench[w, pair, c]


@wp.kernel
def record_friction(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    clk: wp.array(dtype=Clock),
    traction: wp.array3d(dtype=real),
    slip: wp.array3d(dtype=real),
    bound: wp.array3d(dtype=real),
    cell_state: wp.array3d(dtype=int),
    friction_record: wp.array3d(dtype=real),
    most_advanced: inout(wp.array2d(dtype=real)),
    saved_traction: out(wp.array4d(dtype=real)),
    saved_slip_velocity: out(wp.array4d(dtype=real)),
    saved_cell_state: out(wp.array4d(dtype=int)),
    saved_friction: out(wp.array4d(dtype=real)),
    saved_advanced: out(wp.array3d(dtype=real)),
):
    """Per (world, pair), lanes over cells. The most columns that the patch advanced are counted anew from here."""
    w, pair, lane = wp.tid()
    model = models[w]
    if ctl[w].record == 0:
        return
    at = ctl[w].saved % saved_advanced.shape[1]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    h = clk[w].done_step
    m = lane
    while m < model.window.hats:
        loaded = m < model.window.columns * rows and model.pairs.friction[pair] > real(0.0)
        loaded = loaded and bound[w, pair, m] > real(0.0) and is_whole(ctl, w)
        for d in range(2):
            i = cell_at(rows, m, d)
            stress = real(0.0)
            speed = real(0.0)
            if loaded and h > real(0.0):
                stress = traction[w, pair, i]
                speed = slip[w, pair, i] / h
            saved_traction[w, at, pair, 2 * m + d] = stress
            saved_slip_velocity[w, at, pair, 2 * m + d] = speed
        state = int(0)
        if loaded:
            state = cell_state[w, pair, m]
        saved_cell_state[w, at, pair, m] = state
        m += wp.block_dim()
    if lane == 0:
        for c in range(4):
            saved_friction[w, at, pair, c] = friction_record[w, pair, c]
        saved_advanced[w, at, pair] = most_advanced[w, pair]
        most_advanced[w, pair] = real(0.0)
