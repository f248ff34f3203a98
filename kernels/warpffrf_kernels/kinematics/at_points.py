"""Weak gaps at points fixed in the grid of the first surface, for surfaces of any shape.

The points x_k lie on A's true surface, at fixed positions in the cells of A's grid: a rule per column (fractions of
column and row, weights w_k in m^2), Gauss points in every cell or fewer chosen offline. With d_B the signed distance
from B's true surface and psi_i A's shape functions

    g_i = sum_k w_k psi_i(x_k) d_B(x_k),          l_i[node] = sum_k w_k psi_i(x_k) psi^B_node(foot of x_k on B),

weak gap and load of B's nodes due to a unit nodal pressure. A unit nodal pressure also exerts

    F_i = sum_k w_k psi_i f_k,         M_i = sum_k w_k psi_i m_k         on A, the opposite at the same points on B,

f_k, m_k the wrench of a unit pressure at x_k: its direction is grad d_B, the normal of B at the foot, minus the part
that would rotate either body about its own axis (`contact_wrench`). Action equals reaction exactly, and F_i, M_i are
the gradient of g_i with respect to the motion of A relative to B, so that the contact returns the stored energy, also
if a patch slides over an edge. The change of its energy when the patch moves over A's grid is the grid defect of the
ledger.

Points whose foot lies outside B's grid have no opposite point and are excluded from gap, area, force and load: a patch
that runs off an edge ends there. A rigid B has no edges, no grid and no load.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactFields, ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import AT_POINTS, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.core.state import ContactState
from warpffrf_kernels.kinematics.closest_point import view_of, wrap_column
from warpffrf_kernels.kinematics.contact_wrench import Held, point_wrench
from warpffrf_kernels.kinematics.line_of_centres import row_below
from warpffrf_kernels.kinematics.line_of_centres_points import keep_node
from warpffrf_kernels.surfaces.smooth import CENTRE, meridian_of
from warpffrf_kernels.surfaces.surface import EXTRUDED, axes_of, curved_foot, section_at

wp.set_module_options(MODULE_OPTIONS)

# values of a point: gap, column and row on B, weight; force and moment about A's centre of mass, in A's surface frame,
# as used by the linear systems, and the additional part of the true ones (`contact_wrench`)
LINE = 16


@kernel
def sample_points(run: Run, trial: Trial, geometry: ContactGeometry, held: wp.array3d(dtype=Held)):
    """Per (world, pair of family 1), lanes over points of the window: gap, position on B's grid, weight (0 where B
    ends), and the wrench of a unit pressure."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or model.pairs.family[pair] != AT_POINTS:
        return
    A = model.pairs.first[pair]
    B = model.pairs.second[pair]
    view = view_of(model, w, pair, trial)
    arm_a = wp.transpose(model.surfaces.frame[A]) * model.surfaces.origin[A]
    planar = model.surfaces.planar[A]
    pitch = model.surfaces.pitch[A]
    start = model.points.start[pair]
    count = model.points.count[pair]
    first = geometry.window[w, pair, 0] + model.window.half
    strips = geometry.window[w, pair, 1] + model.window.half + 2 - first
    rigid = model.surfaces.rigid[B]
    planar_b = model.surfaces.planar[B]
    side_b = model.surfaces.side[B]
    z0 = model.surfaces.z_start[B]
    rows_b = model.surfaces.rows[B]
    low = model.surfaces.z[z0]
    high = model.surfaces.z[z0 + rows_b - 1]
    last = real(model.surfaces.columns[B])
    middle = real(geometry.center[w, pair, 1])
    known = int(-1)
    cosine = real(1.0)
    sine = real(0.0)
    e = lane
    while e < strips * count:
        strip = first + e / count
        p = e % count
        if strip != known:  # angle of the first column of the strip
            known = strip
            column = geometry.center[w, pair, 0] + strip - model.window.half - 1
            angle = model.surfaces.theta[A] + real(column) * pitch
            sine = angle
            if planar == 0:
                sine = wp.sin(angle)
                cosine = wp.cos(angle)
        c = model.points.cosine[start + p]
        s = model.points.sine[start + p]
        z = model.points.z[start + p]
        x = vec3(real(0.0), sine + s, z)
        if planar == 0:
            R = model.points.radius[start + p]
            u = cosine * c - sine * s
            v = sine * c + cosine * s
            x = vec3(R * u, R * v, z)
        way = vec3(-x[1], x[0], real(0.0))
        if planar == EXTRUDED:
            curve = section_at(model, A, sine + s)
            x = vec3(curve.point[0], curve.point[1], z)
            way = vec3(curve.slope[0], curve.slope[1], real(0.0))
        weight = model.points.weight[start + p]
        y = view.at + view.turn * x
        g = y[0]
        foot_theta = y[1]
        foot_z = y[2]
        f = vec3(real(1.0), real(0.0), real(0.0))
        if planar_b == EXTRUDED:
            near = curved_foot(model, B, y)
            g = near.distance
            foot_theta = near.theta
            f = near.normal
        if planar_b == 0:
            rho = wp.sqrt(y[0] * y[0] + y[1] * y[1])
            foot = meridian_of(model, B, rho, y[2])
            g = side_b * foot[1]
            foot_z = foot[0]
            scale = side_b * foot[2] / wp.max(rho, CENTRE)
            f = vec3(scale * y[0], scale * y[1], side_b * foot[3])
        f = wp.transpose(view.turn) * f
        unit = point_wrench(model, A, x, way, f, held[w, pair, p], geometry.held_ball[w, pair])
        m = unit.moment + wp.cross(arm_a, unit.force)
        more = unit.more_moment + wp.cross(arm_a, unit.more_force)
        column_b = real(0.0)
        row_b = real(0.0)
        if rigid == 0:
            if planar_b == 0:
                foot_theta = wp.atan2(y[1], y[0])
            column_b = (foot_theta - model.surfaces.theta[B]) / model.surfaces.pitch[B]
            column_b = wrap_column(model, B, column_b, middle)
            if model.surfaces.periodic[B] == 0 and (column_b < real(-1.0) or column_b > last):
                weight = real(0.0)
            if foot_z < low or foot_z > high:
                weight = real(0.0)
            row = row_below(model, B, foot_z)
            below = model.surfaces.z[z0 + row]
            row_b = real(row) + (foot_z - below) / (model.surfaces.z[z0 + row + 1] - below)
            row_b = wp.clamp(row_b, real(0.0), real(rows_b - 1))
        i = (strip * count + p) * LINE
        geometry.point_line[w, pair, i] = g
        geometry.point_line[w, pair, i + 1] = column_b
        geometry.point_line[w, pair, i + 2] = row_b
        geometry.point_line[w, pair, i + 3] = weight
        for axis in range(3):
            geometry.point_line[w, pair, i + 4 + axis] = unit.force[axis]
            geometry.point_line[w, pair, i + 7 + axis] = m[axis]
            geometry.point_line[w, pair, i + 10 + axis] = unit.more_force[axis]
            geometry.point_line[w, pair, i + 13 + axis] = more[axis]
        e += wp.block_dim()


# Weak gap, area, wrench and stencil of one node: the sum over the points of its (up to) four cells. Returns 1 if the
# stencil cannot hold all of B's nodes. Native like `line_of_centres_points.sum_node`.
@wp.func_native("""
    const int start = model.points.start.data[pair], count = model.points.count.data[pair];
    const int SC = model.window.stencil_columns, SR = model.window.stencil_rows;
    const size_t p0 = (size_t)(w * model.pairs.count + pair);
    const size_t grid_node = p0 * model.window.grid_nodes + m;
    const int column = m / rows, row = m % rows;
    const int* begin = model.points.row_at.data + model.points.row_start.data[pair];
    const int from = begin[row > 0 ? row - 1 : 0], to = begin[row + 1 < rows ? row + 1 : rows - 1];
    const double* line = point_line.data + p0 * (model.window.columns + 1) * model.points.most * 16;
    double* l = stencil.data + grid_node * SC * SR;
    double* f = wrench.data + grid_node * 6;
    double* more = more_wrench.data + grid_node * 6;
    for (int e = 0; e < SC * SR; ++e) l[e] = 0.0;
    double sum[12] = {0.0};
    double total = 0.0, size = 0.0, lowest_c = 1e300, lowest_r = 1e300;
    for (int t = 0; t < 2; ++t) for (int p = from; p < to; ++p) {
        const double* q = line + (size_t)((column + t) * count + p) * 16;
        if (q[3] == 0.0) continue;
        const double x = model.points.x.data[start + p], zeta = model.points.zeta.data[start + p];
        const double psi = q[3] * (t ? 1.0 - x : x) * (model.points.row.data[start + p] == row ? 1.0 - zeta : zeta);
        total += psi * q[0]; size += psi;
        for (int c = 0; c < 12; ++c) sum[c] += psi * q[4 + c];
        if (q[1] < lowest_c) lowest_c = q[1];
        if (q[2] < lowest_r) lowest_r = q[2];
    }
    weak_gap.data[grid_node] = total; area.data[grid_node] = size;
    for (int i = 0; i < 3; ++i) for (int c = 0; c < 2; ++c) {
        const double* v = sum + 3 * c;
        f[3 * c + i] = turn.data[i][0] * v[0] + turn.data[i][1] * v[1] + turn.data[i][2] * v[2];
        more[3 * c + i] = turn.data[i][0] * v[6] + turn.data[i][1] * v[7] + turn.data[i][2] * v[8];
    }
    stencil_at.data[2 * grid_node] = model.window.second_half; stencil_at.data[2 * grid_node + 1] = 0;
    if (rigid || size == 0.0) return 0;
    const int oc = (int)::floor(lowest_c), last = rows_b - 2;
    const int orow = (int)::floor(lowest_r) > last ? last : (int)::floor(lowest_r);
    int beyond = 0;
    for (int t = 0; t < 2; ++t) for (int p = from; p < to; ++p) {
        const double* q = line + (size_t)((column + t) * count + p) * 16;
        if (q[3] == 0.0) continue;
        const double x = model.points.x.data[start + p], zeta = model.points.zeta.data[start + p];
        const double psi = q[3] * (t ? 1.0 - x : x) * (model.points.row.data[start + p] == row ? 1.0 - zeta : zeta);
        const double cf = ::floor(q[1]), rf0 = ::floor(q[2]), rf = rf0 > last ? last : rf0;
        const double u = q[1] - cf, v = q[2] - rf;
        const int ci = (int)cf - oc, ri = (int)rf - orow;
        if (ci < 0 || ci + 1 >= SC || ri < 0 || ri + 1 >= SR) { beyond = 1; continue; }
        double* d = l + ci * SR + ri;
        d[0] += psi * (1.0 - u) * (1.0 - v); d[1] += psi * (1.0 - u) * v;
        d[SR] += psi * u * (1.0 - v); d[SR + 1] += psi * u * v;
    }
    stencil_at.data[2 * grid_node] = oc - origin; stencil_at.data[2 * grid_node + 1] = orow;
    return beyond;
""")
def sum_points(
    model: Model,
    w: int,
    pair: int,
    m: int,
    rows: int,
    rows_b: int,
    rigid: int,
    origin: int,
    turn: mat33,
    point_line: wp.array3d(dtype=real),
    weak_gap: wp.array3d(dtype=real),
    area: wp.array3d(dtype=real),
    wrench: wp.array4d(dtype=real),
    more_wrench: wp.array4d(dtype=real),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
) -> int: ...


@kernel
def weigh_points(run: Run, trial: Trial, geometry: ContactGeometry):
    """Per (world, pair of family 1), lanes over nodes of the window: as `line_of_centres_points.weigh` for the other
    family."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or model.pairs.family[pair] != AT_POINTS:
        return
    A = model.pairs.first[pair]
    B = model.pairs.second[pair]
    rows = model.surfaces.rows[A]
    H = model.window.half
    origin = geometry.center[w, pair, 1] - model.window.second_half
    turn = axes_of(trial.axes, w, model.surfaces.body[A]) * model.surfaces.frame[A]
    m = (geometry.window[w, pair, 0] + H) * rows + lane
    end = (geometry.window[w, pair, 1] + H + 1) * rows
    while m < end:
        beyond = sum_points(
            model, w, pair, m, rows, model.surfaces.rows[B], model.surfaces.rigid[B], origin, turn, geometry.point_line,
            geometry.shifted_gap, geometry.area, geometry.wrench, geometry.more_wrench, geometry.stencil,
            geometry.stencil_at,
        )  # fmt: skip
        keep_node(model, w, pair, m, rows, beyond, geometry.shifted_gap[w, pair, m], geometry, run)
        m += wp.block_dim()


@kernel
def sum_points_second(run: Run, trial: Trial, geometry: ContactGeometry, contact: ContactState, fields: ContactFields):
    """Per (world, pair of family 1): force on B and its moment about A's centre of mass, from the pressure at every
    point."""
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].record == 0 or model.pairs.family[pair] != AT_POINTS:
        return
    A = model.pairs.first[pair]
    rows = model.surfaces.rows[A]
    start = model.points.start[pair]
    count = model.points.count[pair]
    force = vec3(real(0.0), real(0.0), real(0.0))
    moment = vec3(real(0.0), real(0.0), real(0.0))
    strip = geometry.window[w, pair, 0] + model.window.half
    end = geometry.window[w, pair, 1] + model.window.half + 1
    while strip <= end:
        p = int(0)
        while p < count:
            i = (strip * count + p) * LINE
            x = model.points.x[start + p]
            zeta = model.points.zeta[start + p]
            load = real(0.0)
            for corner in range(4):
                column = strip - 1 + corner / 2
                m = column * rows + model.points.row[start + p] + corner % 2
                if column >= 0 and column < model.window.columns:
                    if contact.active[w, pair, m] != 0:
                        psi = real(1.0) - x
                        if corner / 2 == 1:
                            psi = x
                        if corner % 2 == 1:
                            psi = psi * zeta
                        else:
                            psi = psi * (real(1.0) - zeta)
                        load += psi * contact.pressure[w, pair, m]
            if load != real(0.0):
                load *= geometry.point_line[w, pair, i + 3]
                for axis in range(3):
                    j = i + 4 + axis
                    force[axis] += load * (geometry.point_line[w, pair, j] + geometry.point_line[w, pair, j + 6])
                    moment[axis] += load * (geometry.point_line[w, pair, j + 3] + geometry.point_line[w, pair, j + 9])
            p += 1
        strip += 1
    turn = axes_of(trial.axes, w, model.surfaces.body[A]) * model.surfaces.frame[A]
    force = turn * force
    moment = turn * moment
    for c in range(3):
        fields.second_wrench[w, pair, c] = -force[c]
        fields.second_wrench[w, pair, 3 + c] = -moment[c]
