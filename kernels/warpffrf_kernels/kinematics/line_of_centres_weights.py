"""Weak gaps along the line of centres: from the points sampled by `line_of_centres.sample` to the nodes of A's grid.

With Gauss points x_k of A's cells, weights w_k [m^2], shape functions psi_i of A, and psi^B interpolated at the point
of B opposite x_k (grid column, row),

    g_i = sum_k w_k psi_i g(x_k),                 area_i = sum_k w_k psi_i,
    f_i = sum_k w_k psi_i (wrench of its station), l_i[node] = sum_k w_k psi_i psi^B_node(x_k),

weak gap, area, gradient, and the stencil: the load of B's nodes due to a unit nodal pressure of A. At fixed phases the
gap is linear in the distance d of the axes, and `shift` adds sum_k w_k psi_i (d - d where it was sampled).
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import LINE_OF_CENTRES, PATCH, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


# Weak gap, area, gradient and stencil of one node: the sum over the Gauss points of its (up to) four cells. Measured
# against the same loop in Warp's Python: `weigh` 17.3 -> 4.9 us of a step of 141 us.
@wp.func_native("""
    const int NT = model.quadrature.theta_points, NZ = model.quadrature.z_points;
    const int NS = (rows - 1) * NZ, most = (model.window.rows - 1) * NZ;
    const int SC = model.window.stencil_columns, SR = model.window.stencil_rows;
    const size_t p0 = (size_t)(w * model.pairs.count + pair);
    const size_t grid_node = p0 * model.window.grid_nodes + m;
    const int column = m / rows, row = m % rows;
    const int s0 = (row > 0 ? row - 1 : 0) * model.quadrature.z_points;
    const int s1 = (row + 1 < rows ? row + 1 : rows - 1) * model.quadrature.z_points;
    const double* g = point_gap.data + p0 * (model.window.columns + 1) * NT * most;
    const double* place = point_place.data + p0 * (model.window.columns + 1) * NT * most * 2;
    const double* st = station.data + p0 * most * 11;
    const double* sw = station_wrench.data + p0 * most * 6;
    double* l = stencil.data + grid_node * SC * SR;
    double* f = wrench.data + grid_node * 6;
    for (int e = 0; e < SC * SR; ++e) l[e] = 0.0;
    for (int c = 0; c < 6; ++c) f[c] = 0.0;
    double total = 0.0, size = 0.0, lowest_c = 1e300, lowest_r = 1e300;
    for (int t = 0; t < 2 * NT; ++t) for (int s = s0; s < s1; ++s) {
        const double* q = place + (size_t)((column * NT + t) * NS + s) * 2;
        if (q[0] < lowest_c) lowest_c = q[0];
        if (q[1] < lowest_r) lowest_r = q[1];
    }
    const int oc = (int)::floor(lowest_c);
    const int orow = lowest_r < rows_b - 2 ? (int)::floor(lowest_r) : rows_b - 2;  // beyond B's end: its last cell
    int beyond = 0;
    for (int s = s0; s < s1; ++s) {
        const int zc = s / model.quadrature.z_points;
        const double zeta = model.quadrature.z_abscissa.data[s - zc * model.quadrature.z_points];
        const double wz = (zc == row ? 1.0 - zeta : zeta) * st[s * 11 + 6] * pitch;
        double node_weight = 0.0;
        for (int t = 0; t < 2 * NT; ++t) {
            const double x = model.quadrature.theta_abscissa.data[t % NT];
            const double q = (t < NT ? x : 1.0 - x) * model.quadrature.theta_weight.data[t % NT] * wz;
            const int p = (column * NT + t) * NS + s;
            total += q * g[p]; node_weight += q;
            const double cf = ::floor(place[2 * p]), rf0 = ::floor(place[2 * p + 1]), last = rows_b - 2;
            const double rf = rf0 > last ? last : rf0, u = place[2 * p] - cf, v = place[2 * p + 1] - rf;
            const int ci = (int)cf - oc, ri = (int)rf - orow;
            if (ci < 0 || ci + 1 >= SC || ri < 0 || ri + 1 >= SR) { beyond = 1; continue; }
            double* d = l + ci * SR + ri;
            d[0] += q * (1.0 - u) * (1.0 - v); d[1] += q * (1.0 - u) * v;
            d[SR] += q * u * (1.0 - v); d[SR + 1] += q * u * v;
        }
        size += node_weight;
        for (int c = 0; c < 6; ++c) f[c] += node_weight * sw[s * 6 + c];
    }
    weak_gap.data[grid_node] = total; area.data[grid_node] = size;
    stencil_at.data[2 * grid_node] = oc - origin; stencil_at.data[2 * grid_node + 1] = orow;
    return beyond;
""")
def sum_node(
    model: Model,
    w: int,
    pair: int,
    m: int,
    rows: int,
    rows_b: int,
    origin: int,
    pitch: real,
    station: wp.array4d(dtype=real),
    station_wrench: wp.array4d(dtype=real),
    point_gap: wp.array3d(dtype=real),
    point_place: wp.array4d(dtype=real),
    weak_gap: wp.array3d(dtype=real),
    area: wp.array3d(dtype=real),
    wrench: wp.array4d(dtype=real),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
) -> int: ...


@wp.func
def keep_node(model: Model, w: int, pair: int, m: int, rows: int, beyond: int, geometry: ContactGeometry, run: Run):
    """Area 0 for a node beyond the end of an arc, or so far around the bodies that no part of the second window is
    opposite, or whose opposite points spread beyond its stencil (`beyond`). One that overlaps there may be needed: the
    attempt fails."""
    A = model.pairs.first[pair]
    absolute = geometry.center[w, pair, 0] + m / rows - model.window.half
    if model.surfaces.periodic[A] == 0 and (absolute < 0 or absolute >= model.surfaces.columns[A]):
        geometry.area[w, pair, m] = real(0.0)
    reached = geometry.stencil_at[w, pair, m, 0]
    if reached < 0 or reached + model.window.stencil_columns > model.window.second_columns or beyond != 0:
        if geometry.area[w, pair, m] > real(0.0) and geometry.weak_gap[w, pair, m] <= real(0.0):
            run.ctl[w].failure = run.ctl[w].failure | k.STENCIL
        geometry.area[w, pair, m] = real(0.0)


@kernel
def weigh(run: Run, geometry: ContactGeometry):
    """Per (world, pair), lanes over nodes of the window: weak undeformed gap, area, gradient, and stencil on B.

    Area 0 marks a node that does not exist (beyond the end of an arc) or has no opposite surface.
    """
    w, pair, lane = wp.tid()
    model = run.models[w]
    if (
        run.ctl[w].run == 0
        or run.ctl[w].moved == 0
        or geometry.center[w, pair, 2] != 0
        or model.pairs.family[pair] != LINE_OF_CENTRES
    ):
        return
    if model.points.count[pair] != 0:
        return
    A = model.pairs.first[pair]
    rows = model.surfaces.rows[A]
    rows_b = model.surfaces.rows[model.pairs.second[pair]]
    H = model.window.half
    m = (geometry.window[w, pair, 0] + H) * rows + lane
    end = (geometry.window[w, pair, 1] + H + 1) * rows
    while m < end:
        beyond = sum_node(
            model, w, pair, m, rows, rows_b, geometry.center[w, pair, 1] - model.window.second_half,
            model.surfaces.pitch[A], geometry.station, geometry.station_wrench, geometry.point_gap,
            geometry.point_place, geometry.weak_gap, geometry.area, geometry.wrench, geometry.stencil,
            geometry.stencil_at,
        )  # fmt: skip
        keep_node(model, w, pair, m, rows, beyond, geometry, run)
        m += wp.block_dim()


@kernel
def shift(run: Run, geometry: ContactGeometry):
    """Per (world, pair), lanes over nodes: the sampled weak gaps at the current distance of the axes, and their
    gradient.
    """
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    if model.pairs.family[pair] == LINE_OF_CENTRES and model.points.count[pair] != 0:
        return
    if model.pairs.family[pair] == PATCH:
        return
    A = model.pairs.first[pair]
    rows = model.surfaces.rows[A]
    frozen = geometry.center[w, pair, 2]
    m = (geometry.window[w, pair, 0] + model.window.half) * rows + lane
    while m < (geometry.window[w, pair, 1] + model.window.half + 1) * rows:
        value = geometry.weak_gap[w, pair, m]
        if frozen != 0 and geometry.area[w, pair, m] > real(0.0):
            row = m % rows
            for i in range(6):
                geometry.wrench[w, pair, m, i] = real(0.0)
            s = wp.max(row - 1, 0) * model.quadrature.z_points
            while s < wp.min(row + 1, rows - 1) * model.quadrature.z_points:
                zc = s / model.quadrature.z_points
                psi = model.quadrature.z_abscissa[s - zc * model.quadrature.z_points]
                if zc == row:
                    psi = real(1.0) - psi
                q = (
                    psi * geometry.station[w, pair, s, 6] * model.surfaces.pitch[A]
                )  # the circumferential integral of a shape function is the pitch
                value += q * (geometry.station[w, pair, s, 0] - geometry.station[w, pair, s, 8])
                for i in range(6):
                    geometry.wrench[w, pair, m, i] = (
                        geometry.wrench[w, pair, m, i] + q * geometry.station_wrench[w, pair, s, i]
                    )
                s += 1
        geometry.shifted_gap[w, pair, m] = value
        m += wp.block_dim()
