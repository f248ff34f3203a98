"""What is saved of an accepted step: a row of each array of the ring (`warpffrf.online.arrays.ring`).

Rows are written where the decision has set `record`. Bodies, modes and rows of joints are here, pairs in
`normal.contact_record` and `friction.history`; `close_row` counts the rows.
"""

import warp as wp

from warpffrf_kernels.core.access import inout, out
from warpffrf_kernels.core.control import Clock, Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, quat, real, vec3

wp.set_module_options(MODULE_OPTIONS)


@wp.kernel
def record_motion(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    r: wp.array2d(dtype=vec3),
    p: wp.array2d(dtype=quat),
    v: wp.array2d(dtype=vec3),
    omega: wp.array2d(dtype=vec3),
    v_rate: wp.array2d(dtype=vec3),
    omega_rate: wp.array2d(dtype=vec3),
    q: wp.array2d(dtype=real),
    qd: wp.array2d(dtype=real),
    qd_rate: wp.array2d(dtype=real),
    lam: wp.array2d(dtype=real),
    coordinate: wp.array2d(dtype=real),
    row_wrench: wp.array3d(dtype=real),
    saved_r: out(wp.array3d(dtype=vec3)),
    saved_p: out(wp.array3d(dtype=quat)),
    saved_v: out(wp.array3d(dtype=vec3)),
    saved_omega: out(wp.array3d(dtype=vec3)),
    saved_v_rate: out(wp.array3d(dtype=vec3)),
    saved_omega_rate: out(wp.array3d(dtype=vec3)),
    saved_q: out(wp.array3d(dtype=real)),
    saved_qd: out(wp.array3d(dtype=real)),
    saved_qd_rate: out(wp.array3d(dtype=real)),
    saved_coordinate: out(wp.array3d(dtype=real)),
    saved_row_wrench: out(wp.array4d(dtype=real)),
):
    """Per world, lanes over bodies, modes and rows. A row exerts on its second body -lambda times its direction."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].record == 0:
        return
    at = ctl[w].saved % saved_r.shape[1]
    b = lane
    while b < model.bodies.count:
        saved_r[w, at, b] = r[w, b]
        saved_p[w, at, b] = p[w, b]
        saved_v[w, at, b] = v[w, b]
        saved_omega[w, at, b] = omega[w, b]
        saved_v_rate[w, at, b] = v_rate[w, b]
        saved_omega_rate[w, at, b] = omega_rate[w, b]
        b += wp.block_dim()
    n = lane
    while n < model.modes.count:
        saved_q[w, at, n] = q[w, n]
        saved_qd[w, at, n] = qd[w, n]
        saved_qd_rate[w, at, n] = qd_rate[w, n]
        n += wp.block_dim()
    row = lane
    while row < model.rows.count:
        saved_coordinate[w, at, row] = coordinate[w, row]
        for i in range(6):
            saved_row_wrench[w, at, row, i] = -lam[w, row] * row_wrench[w, row, i]
        row += wp.block_dim()


@wp.kernel
def close_row(
    clk: wp.array(dtype=Clock),
    energy: wp.array3d(dtype=real),
    ctl: inout(wp.array(dtype=Control)),
    saved_time: out(wp.array2d(dtype=real)),
    saved_step: out(wp.array2d(dtype=real)),
    saved_iterations: out(wp.array2d(dtype=int)),
    saved_solves: out(wp.array2d(dtype=int)),
    saved_energy: out(wp.array3d(dtype=real)),
):
    """Per world: time, step, counts and energies of the row that the others have written; the next one begins."""
    w = wp.tid()
    if ctl[w].record == 0:
        return
    at = ctl[w].saved % saved_time.shape[1]
    saved_time[w, at] = clk[w].time
    saved_step[w, at] = clk[w].done_step
    saved_iterations[w, at] = ctl[w].pending
    saved_solves[w, at] = ctl[w].pending_solves
    for line in range(energy.shape[2]):
        saved_energy[w, at, line] = energy[w, 0, line]
    ctl[w].pending = 0
    ctl[w].pending_solves = 0
    ctl[w].saved = ctl[w].saved + 1
