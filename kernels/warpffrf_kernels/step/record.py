"""Saving of an accepted step: a row of each array of the ring (`warpffrf.online.arrays.ring`).

Rows are written if the decision has set `record`. Bodies, modes and rows of joints are handled here, pairs in
`normal.contact_record` and `friction.history`; `close_row` counts the rows.
"""

import warp as wp

from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.ring import SavedBooks, SavedMotion
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS
from warpffrf_kernels.core.scratch import Residuals
from warpffrf_kernels.core.state import LoadState, MotionState

wp.set_module_options(MODULE_OPTIONS)


@kernel
def record_motion(run: Run, state: MotionState, loads: LoadState, residuals: Residuals, saved: SavedMotion):
    """Per world, lanes over bodies, modes and rows. A row exerts on its second body -lambda times its direction."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].record == 0:
        return
    at = run.ctl[w].saved % saved.saved_r.shape[1]
    b = lane
    while b < model.bodies.count:
        saved.saved_r[w, at, b] = state.r[w, b]
        saved.saved_p[w, at, b] = state.p[w, b]
        saved.saved_v[w, at, b] = state.v[w, b]
        saved.saved_omega[w, at, b] = state.omega[w, b]
        saved.saved_v_rate[w, at, b] = state.v_rate[w, b]
        saved.saved_omega_rate[w, at, b] = state.omega_rate[w, b]
        b += wp.block_dim()
    n = lane
    while n < model.modes.count:
        saved.saved_q[w, at, n] = state.q[w, n]
        saved.saved_qd[w, at, n] = state.qd[w, n]
        saved.saved_qd_rate[w, at, n] = state.qd_rate[w, n]
        n += wp.block_dim()
    row = lane
    while row < model.rows.count:
        saved.saved_coordinate[w, at, row] = residuals.coordinate[w, row]
        for i in range(6):
            saved.saved_row_wrench[w, at, row, i] = -loads.lam[w, row] * residuals.row_wrench[w, row, i]
        row += wp.block_dim()


@kernel
def close_row(run: Run, saved: SavedBooks):
    """Per world: time, step, counts and energies of the row written by the other kernels; starts the next row."""
    w = wp.tid()
    if run.ctl[w].record == 0:
        return
    at = run.ctl[w].saved % saved.saved_time.shape[1]
    saved.saved_time[w, at] = run.clk[w].time
    saved.saved_step[w, at] = run.clk[w].done_step
    saved.saved_iterations[w, at] = run.ctl[w].pending
    saved.saved_solves[w, at] = run.ctl[w].pending_solves
    for line in range(run.energy.shape[2]):
        saved.saved_energy[w, at, line] = run.energy[w, 0, line]
    run.ctl[w].pending = 0
    run.ctl[w].pending_solves = 0
    run.ctl[w].saved = run.ctl[w].saved + 1
