"""End of an attempt for friction: history fixed to the material, and recorded quantities.

The elastic slip e of all cells of the window is stored with the grid column of the window's centre: the next step finds
its material again by the difference of the columns. Records: power -tau.S/h, rigid creep velocity at the cell nearest
to the patch's centre, mean velocity of the two surfaces through the patch, and the largest advance of the patch in
columns in a step since the last record (`patch_advance`).
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactFields, ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells
from warpffrf_kernels.core.integration import is_whole
from warpffrf_kernels.core.ring import SavedFriction
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.core.state import FrictionState
from warpffrf_kernels.friction.cells import cell_at, rubs_on_grid
from warpffrf_kernels.surfaces.smooth import radius_of

wp.set_module_options(MODULE_OPTIONS)


@kernel
def keep_slips(run: Run, friction: FrictionState, cells: FrictionCells, geometry: ContactGeometry):
    """Per (world, pair), lanes over cells: the history of an accepted step. friction_record: power, creep (2), rolling
    velocity."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].attempt == 0 or run.ctl[w].accept == 0 or not rubs_on_grid(model, pair):
        return
    i = lane
    A = model.pairs.first[pair]
    rows = model.surfaces.rows[A]
    H = model.window.half
    # no displacement is computed for columns beyond the evaluated window: they repeat its outermost column
    low = geometry.window[w, pair, 0] + H
    high = geometry.window[w, pair, 1] + H
    while i < 2 * rows * model.window.columns:
        column = wp.clamp(i / (2 * rows), low, high)
        friction.elastic_before[w, pair, i] = cells.elastic[w, pair, column * 2 * rows + i % (2 * rows)]
        i += wp.block_dim()
    if lane == 0:
        h = run.clk[w].done_step
        at = friction.history_phase[w, pair]
        friction.history_center[w, pair] = geometry.center[w, pair, 0]
        force = vec3(cells.normal_wrench[w, pair, 0], cells.normal_wrench[w, pair, 1], cells.normal_wrench[w, pair, 2])
        friction.contact_normal[w, pair] = vec3(real(0.0), real(0.0), real(0.0))
        if wp.length(force) > real(0.0):
            friction.contact_normal[w, pair] = -wp.normalize(force)
        row = rows / 2
        m = wp.clamp(int(wp.floor(at + real(0.5))) - geometry.center[w, pair, 0] + H, low, high) * rows + row
        for c in range(4):
            cells.friction_record[w, pair, c] = real(0.0)
        if is_whole(run.ctl, w) and h > real(0.0):
            creep = cells.rigid_slip[w, pair, cell_at(rows, m, 0)] / h
            z = model.surfaces.z[model.surfaces.z_start[A] + row]
            # material of the first surface moves opposite to the advance of the patch in columns
            through = (
                -cells.advanced[w, pair] * model.surfaces.pitch[A] * radius_of(model, A, z) * model.surfaces.side[A] / h
            )
            cells.friction_record[w, pair, 0] = -cells.friction_work[w, pair, 0] / h
            cells.friction_record[w, pair, 1] = creep
            cells.friction_record[w, pair, 2] = cells.rigid_slip[w, pair, cell_at(rows, m, 1)] / h
            cells.friction_record[w, pair, 3] = through - real(0.5) * creep


@kernel
def add_friction_second(run: Run, geometry: ContactGeometry, cells: FrictionCells, fields: ContactFields):
    """Per (world, pair): tractions act on the second body along the same lines, so their wrench there is the
    opposite."""
    w, pair = wp.tid()
    if run.ctl[w].record == 0:
        return
    for c in range(6):
        fields.second_wrench[w, pair, c] -= geometry.pair_wrench[w, pair, c] - cells.normal_wrench[w, pair, c]


@kernel
def record_friction(run: Run, friction: FrictionState, cells: FrictionCells, saved: SavedFriction):
    """Per (world, pair), lanes over cells. The largest advance of the patch in columns is reset here."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].record == 0:
        return
    at = run.ctl[w].saved % saved.saved_advanced.shape[1]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    h = run.clk[w].done_step
    m = lane
    while m < model.window.grid_nodes:
        loaded = m < model.window.columns * rows and model.pairs.friction[pair] > real(0.0)
        loaded = loaded and cells.bound[w, pair, m] > real(0.0) and is_whole(run.ctl, w)
        for d in range(2):
            i = cell_at(rows, m, d)
            stress = real(0.0)
            speed = real(0.0)
            if loaded and h > real(0.0):
                stress = friction.traction[w, pair, i]
                speed = cells.slip[w, pair, i] / h
            saved.saved_traction[w, at, pair, 2 * m + d] = stress
            saved.saved_slip_velocity[w, at, pair, 2 * m + d] = speed
        state = int(0)
        if loaded:
            state = cells.cell_state[w, pair, m]
        saved.saved_cell_state[w, at, pair, m] = state
        m += wp.block_dim()
    if lane == 0:
        for c in range(4):
            saved.saved_friction[w, at, pair, c] = cells.friction_record[w, pair, c]
        saved.saved_advanced[w, at, pair] = friction.most_advanced[w, pair]
        friction.most_advanced[w, pair] = real(0.0)
