"""Saved quantities of a pair: wrenches on both bodies, pressures, and loads on the second surface."""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactFields, ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.lanes import total
from warpffrf_kernels.core.model import LINE_OF_CENTRES
from warpffrf_kernels.core.ring import SavedContact
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.core.state import ContactState
from warpffrf_kernels.kinematics.line_of_centres import slope_at

wp.set_module_options(MODULE_OPTIONS)


@kernel
def sum_second(run: Run, trial: Trial, fields: ContactFields, second_load: wp.array3d(dtype=real)):
    """Per (world, pair of family 0): resultant wrench of the nodal forces on the second surface (about A's centre of
    mass).

    The force of a node acts at B's axis, at the node's axial position z, along the line of centres of the section there
    (`line_of_centres`). Bilinear shape functions reproduce linear functions, so force and moment agree with those of
    the first side to round-off if the wrench of a unit force is linear in z, i.e. for parallel axes. For skewed axes
    the moment about the common normal varies with z^2, which the shape functions of rows h apart overestimate by h^2/6
    on average; the residual force is of the order of the angle squared.
    """
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].record == 0 or model.pairs.family[pair] != LINE_OF_CENTRES:
        return
    A = model.pairs.first[pair]
    B = model.pairs.second[pair]
    body_a = model.surfaces.body[A]
    body_b = model.surfaces.body[B]
    rows_b = model.surfaces.rows[B]
    frame_a = trial.axes[w, body_a] * model.surfaces.frame[A]
    frame_b = trial.axes[w, body_b] * model.surfaces.frame[B]
    e_A = vec3(frame_a[0, 2], frame_a[1, 2], frame_a[2, 2])
    e_B = vec3(frame_b[0, 2], frame_b[1, 2], frame_b[2, 2])
    cosine = wp.dot(e_A, e_B)
    arm_a = trial.axes[w, body_a] * model.surfaces.origin[A]
    between = (trial.r1[w, body_b] - trial.r1[w, body_a]) + trial.axes[w, body_b] * model.surfaces.origin[B]
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
        fields.second_wrench[w, pair, i] = force[i]
        fields.second_wrench[w, pair, 3 + i] = moment[i]


@kernel
def record_pairs(
    run: Run, geometry: ContactGeometry, contact: ContactState, fields: ContactFields, saved: SavedContact,
    second_load: wp.array3d(dtype=real),
):  # fmt: skip
    """Per (world, pair), lanes over nodes: column and distance are means over both ends of the line of centres."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].record == 0:
        return
    at = run.ctl[w].saved % saved.saved_active.shape[1]
    number = real(0.0)
    m = lane
    while m < model.window.grid_nodes:
        value = real(0.0)
        if contact.active[w, pair, m] != 0:
            number += real(1.0)
            value = contact.pressure[w, pair, m]
        saved.saved_pressure[w, at, pair, m] = value
        m += wp.block_dim()
    m = lane
    while m < model.window.nodes:
        saved.saved_second_load[w, at, pair, m] = second_load[w, pair, m]
        m += wp.block_dim()
    number = total(number)
    if lane == 0:
        last = (model.surfaces.rows[model.pairs.first[pair]] - 1) * model.quadrature.z_points - 1
        saved.saved_center[w, at, pair, 0] = geometry.center[w, pair, 0]
        saved.saved_center[w, at, pair, 1] = geometry.center[w, pair, 1]
        saved.saved_column[w, at, pair] = real(0.5) * (
            geometry.station[w, pair, 0, 1] + geometry.station[w, pair, last, 1]
        )
        saved.saved_distance[w, at, pair] = real(0.5) * (
            geometry.station[w, pair, 0, 0] + geometry.station[w, pair, last, 0]
        )
        for i in range(6):
            saved.saved_pair_wrench[w, at, pair, i] = geometry.pair_wrench[w, pair, i]
            saved.saved_second_wrench[w, at, pair, i] = fields.second_wrench[w, pair, i]
        saved.saved_active[w, at, pair] = int(number)
