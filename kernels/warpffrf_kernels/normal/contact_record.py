"""What is saved of a pair: wrenches on both bodies, pressures, and loads on the second surface."""

import warp as wp

from warpffrf_kernels.core.access import out
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import LINE_OF_CENTRES, Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3
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
    model = models[w]
    if ctl[w].record == 0 or model.pairs.family[pair] != LINE_OF_CENTRES:
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
def record_pairs(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    center: wp.array3d(dtype=int),
    station: wp.array4d(dtype=real),
    active: wp.array3d(dtype=int),
    pair_wrench: wp.array3d(dtype=real),
    second_wrench: wp.array3d(dtype=real),
    pressure: wp.array3d(dtype=real),
    second_load: wp.array3d(dtype=real),
    saved_center: out(wp.array4d(dtype=int)),
    saved_column: out(wp.array3d(dtype=real)),
    saved_distance: out(wp.array3d(dtype=real)),
    saved_pair_wrench: out(wp.array4d(dtype=real)),
    saved_second_wrench: out(wp.array4d(dtype=real)),
    saved_pressure: out(wp.array4d(dtype=real)),
    saved_active: out(wp.array3d(dtype=int)),
    saved_second_load: out(wp.array4d(dtype=real)),
):
    """Per (world, pair), lanes over places: column and distance are means over both ends of the line of centres."""
    w, pair, lane = wp.tid()
    model = models[w]
    if ctl[w].record == 0:
        return
    at = ctl[w].saved % saved_active.shape[1]
    m = lane
    while m < model.window.hats:
        value = real(0.0)
        if active[w, pair, m] != 0:
            value = pressure[w, pair, m]
        saved_pressure[w, at, pair, m] = value
        m += wp.block_dim()
    m = lane
    while m < model.window.nodes:
        saved_second_load[w, at, pair, m] = second_load[w, pair, m]
        m += wp.block_dim()
    if lane == 0:
        last = (model.surfaces.rows[model.pairs.first[pair]] - 1) * model.quadrature.z_points - 1
        saved_center[w, at, pair, 0] = center[w, pair, 0]
        saved_center[w, at, pair, 1] = center[w, pair, 1]
        saved_column[w, at, pair] = real(0.5) * (station[w, pair, 0, 1] + station[w, pair, last, 1])
        saved_distance[w, at, pair] = real(0.5) * (station[w, pair, 0, 0] + station[w, pair, last, 0])
        for i in range(6):
            saved_pair_wrench[w, at, pair, i] = pair_wrench[w, pair, i]
            saved_second_wrench[w, at, pair, i] = second_wrench[w, pair, i]
        number = int(0)
        m = int(0)
        while m < model.window.hats:
            if active[w, pair, m] != 0:
                number += 1
            m += 1
        saved_active[w, at, pair] = number
