"""What is saved of an accepted step: one row of the ring, whose layout `warpffrf.online.history.record` reads."""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.access import inout, out
from warpffrf_kernels.core.control import Clock, Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, quat, real, vec3
from warpffrf_kernels.kinematics.line_of_centres import slope_at

wp.set_module_options(MODULE_OPTIONS)


@wp.kernel
def sum_second(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    r1: wp.array2d(dtype=vec3),
    axes: wp.array2d(dtype=mat33),
    second_load: wp.array3d(dtype=real),
    second_wrench: out(wp.array3d(dtype=real)),
):
    """Per (world, pair of family 0): the wrench that the hat forces on the second surface sum to there (about A's
    centre of mass).

    The force of a node acts at B's axis, at the node's axial position z, along the line of centres of the section there
    (`line_of_centres`). Hats reproduce linear functions, so force and moment agree with those of the first side to
    round-off where the wrench of a unit force is linear in z: for parallel axes. On skewed ones the moment about the
    common normal goes with z^2, which hats between rows h apart take h^2/6 too large in the mean; what is left of the
    force is of the order of the angle squared.
    """
    w, pair = wp.tid()
    model = models[0]
    if ctl[w].record == 0 or model.pairs.family[pair] != 0:
        return
    A = model.pairs.first[pair]
    B = model.pairs.second[pair]
    body_a = model.surfaces.body[A]
    body_b = model.surfaces.body[B]
    rows_b = model.surfaces.rows[B]
    frame_a = axes[w, body_a] * model.surfaces.frame[A]
    frame_b = axes[w, body_b] * model.surfaces.frame[B]
    e_A = vec3(frame_a[0, 2], frame_a[1, 2], frame_a[2, 2])
    e_B = vec3(frame_b[0, 2], frame_b[1, 2], frame_b[2, 2])
    cosine = wp.dot(e_A, e_B)
    arm_a = axes[w, body_a] * model.surfaces.origin[A]
    between = (r1[w, body_b] - r1[w, body_a]) + axes[w, body_b] * model.surfaces.origin[B]
    force = vec3(real(0.0), real(0.0), real(0.0))
    moment = vec3(real(0.0), real(0.0), real(0.0))
    row = int(0)
    while row < rows_b:
        load = real(0.0)
        column = int(0)
        while column < model.window.second_columns:
            load += second_load[w, pair, column * rows_b + row]
            column += 1
        if load != real(0.0):
            z = model.surfaces.z[model.surfaces.z_start[B] + row]
            b = between + z * e_B
            v = b - arm_a
            c = wp.normalize(v - wp.dot(v, e_A) * e_A)
            f = c + e_A * ((slope_at(model.surfaces.crown[B], z) - wp.dot(c, e_B)) / cosine)
            force += load * f
            moment += load * wp.cross(b, f)
        row += 1
    for i in range(3):
        second_wrench[w, pair, i] = force[i]
        second_wrench[w, pair, 3 + i] = moment[i]


@wp.kernel
def record(
    models: wp.array(dtype=Model),
    clk: wp.array(dtype=Clock),
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
    center: wp.array3d(dtype=int),
    station: wp.array4d(dtype=real),
    active: wp.array3d(dtype=int),
    pair_wrench: wp.array3d(dtype=real),
    second_wrench: wp.array3d(dtype=real),
    pressure: wp.array3d(dtype=real),
    second_load: wp.array3d(dtype=real),
    energy: wp.array3d(dtype=real),
    ctl: inout(wp.array(dtype=Control)),
    ring: out(wp.array3d(dtype=real)),
):
    """Per world: one row of the ring. Layout: `warpffrf.online.history.record`."""
    w = wp.tid()
    model = models[0]
    if ctl[w].record == 0:
        return
    at = ctl[w].saved % ring.shape[1]
    ctl[w].saved = ctl[w].saved + 1
    ring[w, at, 0] = clk[w].time
    ring[w, at, 1] = clk[w].done_step
    ring[w, at, 2] = real(ctl[w].pending)
    ring[w, at, 3] = real(ctl[w].pending_solves)
    ctl[w].pending = 0
    ctl[w].pending_solves = 0
    for line in range(k.LINES):
        ring[w, at, 4 + line] = energy[w, 0, line]
    o = int(4 + k.LINES)
    b = int(0)
    while b < model.bodies.count:
        for i in range(3):
            ring[w, at, o + i] = r[w, b][i]
            ring[w, at, o + 7 + i] = v[w, b][i]
            ring[w, at, o + 10 + i] = omega[w, b][i]
            ring[w, at, o + 13 + i] = v_rate[w, b][i]
            ring[w, at, o + 16 + i] = omega_rate[w, b][i]
        for i in range(4):
            ring[w, at, o + 3 + i] = p[w, b][i]
        o += 19
        b += 1
    n = int(0)
    while n < model.modes.count:
        ring[w, at, o + n] = q[w, n]
        ring[w, at, o + model.modes.count + n] = qd[w, n]
        ring[w, at, o + 2 * model.modes.count + n] = qd_rate[w, n]
        n += 1
    o += 3 * model.modes.count
    row = int(0)
    while row < model.rows.count:
        ring[w, at, o] = coordinate[w, row]
        for i in range(6):
            ring[w, at, o + 1 + i] = -lam[w, row] * row_wrench[w, row, i]
        o += 7
        row += 1
    pair = int(0)
    while pair < model.pairs.count:
        last = (model.surfaces.rows[model.pairs.first[pair]] - 1) * model.quadrature.z_points - 1
        ring[w, at, o] = real(center[w, pair, 0])
        ring[w, at, o + 1] = real(center[w, pair, 1])
        ring[w, at, o + 2] = real(0.5) * (station[w, pair, 0, 1] + station[w, pair, last, 1])
        ring[w, at, o + 3] = real(0.5) * (station[w, pair, 0, 0] + station[w, pair, last, 0])
        for i in range(6):
            ring[w, at, o + 4 + i] = pair_wrench[w, pair, i]
            ring[w, at, o + 10 + i] = second_wrench[w, pair, i]
        o += 16
        number = int(0)
        m = int(0)
        while m < model.window.hats:
            value = real(0.0)
            if active[w, pair, m] != 0:
                value = pressure[w, pair, m]
                number += 1
            ring[w, at, o + m] = value
            m += 1
        o += model.window.hats
        ring[w, at, o] = real(number)
        o += 1
        m = int(0)
        while m < model.window.nodes:
            ring[w, at, o + m] = second_load[w, pair, m]
            m += 1
        o += model.window.nodes
        pair += 1
