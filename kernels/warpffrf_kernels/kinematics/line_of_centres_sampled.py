"""Reduced quadrature with parallel-axes kinematics: weak gaps of `line_of_centres` at few points.

A pair with few points is located and measured as with all points, station by station along the line of centres; only
the points in the circumferential direction differ. Point p of the pair's list is at the fraction x_p of a column on one
of the stations s(p), with its own weight w_p [m^2]: a list chosen by `warpffrf.offline.contact.cubature`, of which a
third of the points replaces all of them. A point contributes to the strips on both sides of a node,

    g_i = sum over the two strips, sum_p w_p psi_i(x_p) g(x_p),       psi_i = x_p or 1 - x_p, times psi(zeta_p).

The nodes of a row share its points' weights, as the sum of x_p and 1 - x_p over both strips is one: at frozen phases,
where only the distance d of the axes changes, a weak gap changes by sum_p psi(zeta_p) w_p (d_s - d_s as sampled), as
there.

The angle on B's side is computed from that of the strip's column by the series of the arc sine, since the angle between
neighbouring points is less than a column: SMALL keeps its remainder below round-off.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import LINE_OF_CENTRES, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.kinematics.line_of_centres import SERIES
from warpffrf_kernels.kinematics.line_of_centres_weights import keep_node

wp.set_module_options(MODULE_OPTIONS)

SMALL = wp.constant(wp.float64(0.02))  # sine of an angle: its ninth power times 0.03 is 1e-17


@wp.func
def looks_at_few(model: Model, pair: int) -> bool:
    """Whether the pair is evaluated along the line of centres at a list of points."""
    return model.pairs.family[pair] == LINE_OF_CENTRES and model.points.count[pair] != 0


# Gaps and opposite positions of the points of one strip, whose column is rotated by xi from the first station's line of
# centres. Native: in Warp's Python the indices of `station` alone cost more than the geometry.
@wp.func_native("""
    const int start = model.points.start.data[pair], count = model.points.count.data[pair];
    const int most = (model.window.rows - 1) * model.quadrature.z_points;
    const size_t room = (size_t)(model.window.columns + 1) * model.quadrature.theta_points * most;
    const size_t p0 = (size_t)(w * model.pairs.count + pair);
    const double* st = station.data + p0 * most * 11;
    double* gap = point_gap.data + p0 * room + (size_t)strip * count;
    double* place = point_place.data + (p0 * room + (size_t)strip * count) * 2;
    const double* z = model.surfaces.z.data + model.surfaces.z_start.data[B];
    const double pitch = model.surfaces.pitch.data[A], per_column = 1.0 / model.surfaces.pitch.data[B];
    const double radius_b = model.surfaces.radius.data[B], crown_b = model.surfaces.crown.data[B];
    const double squared = crown_b * crown_b;
    const int last = model.surfaces.rows.data[B] - 2;
    const double sine_0 = ::sin(xi), cosine_0 = ::cos(xi), x_0 = st[1];
    const double R_0 = crown_b == 0.0 ? radius_b : radius_b - (crown_b - ::sqrt(squared - st[3] * st[3]));
    const double y_0 = model.surfaces.radius.data[A] * sine_0, left = R_0 * R_0 - y_0 * y_0;
    const double h_0 = left > 0.0 ? ::sqrt(left) : 0.0, angle_0 = ::atan2(y_0, h_0);
    int row = 0;
    for (int p = 0; p < count; ++p) {
        const int at = start + p;
        const double* t = st + model.points.station.data[at] * 11;
        const double c = model.points.cosine.data[at], s = model.points.sine.data[at], d = (x_0 - t[1]) * pitch;
        double sine = sine_0 * c + cosine_0 * s, cosine = cosine_0 * c - sine_0 * s;
        if (d != 0.0) {  // stations differ little: by series where these are exact
            const bool far = d > series || d < -series;
            const double e = far ? ::sin(d) : d, f = far ? ::cos(d) : 1.0 - 0.5 * d * d, turned = sine * f + cosine * e;
            cosine = cosine * f - sine * e;
            sine = turned;
        }
        const double R = model.points.radius.data[at], y = R * sine;
        double R_b = crown_b == 0.0 ? radius_b : radius_b - (crown_b - ::sqrt(squared - t[3] * t[3]));
        double rest = R_b * R_b - y * y, h = rest > 0.0 ? ::sqrt(rest) : 0.0;
        const double axial = t[3] + y * t[4] - h * t[5];
        if (crown_b != 0.0) {
            R_b = radius_b - (crown_b - ::sqrt(squared - axial * axial));
            rest = R_b * R_b - y * y;
            h = rest > 0.0 ? ::sqrt(rest) : 0.0;
        }
        const double sine_b = (y * h_0 - h * y_0) / (R_b * R_0), q = sine_b * sine_b;  // of the angle from the column
        double angle = angle_0 + sine_b * (1.0 + q * (1.0 / 6.0 + q * (0.075 + q * 0.044642857142857144)));
        if (sine_b > small || sine_b < -small) angle = ::atan2(y, h);
        while (row > 0 && axial < z[row]) --row;
        while (row < last && axial >= z[row + 1]) ++row;
        double v = row + (axial - z[row]) / (z[row + 1] - z[row]);
        gap[p] = t[0] - h - R * cosine;
        place[2 * p] = t[2] + t[7] * angle * per_column;
        place[2 * p + 1] = v < 0.0 ? 0.0 : (v > last + 1.0 ? last + 1.0 : v);
    }
""")
def sample_strip(
    model: Model,
    w: int,
    pair: int,
    A: int,
    B: int,
    strip: int,
    xi: real,
    series: real,
    small: real,
    station: wp.array4d(dtype=real),
    point_gap: wp.array3d(dtype=real),
    point_place: wp.array4d(dtype=real),
): ...


@kernel
def sample_few(run: Run, geometry: ContactGeometry):
    """Per (world, pair of few points), lanes over strips of the window: gap, column and row of the opposite point."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if (
        run.ctl[w].run == 0
        or run.ctl[w].moved == 0
        or not looks_at_few(model, pair)
        or geometry.center[w, pair, 2] != 0
    ):
        return
    A = model.pairs.first[pair]
    B = model.pairs.second[pair]
    x_0 = geometry.station[w, pair, 0, 1]
    strip = geometry.window[w, pair, 0] + model.window.half + lane
    end = geometry.window[w, pair, 1] + model.window.half + 2
    while strip < end:
        column = real(geometry.center[w, pair, 0] + strip - model.window.half - 1)
        xi = (column - x_0) * model.surfaces.pitch[A]
        sample_strip(
            model, w, pair, A, B, strip, xi, SERIES, SMALL, geometry.station, geometry.point_gap, geometry.point_place
        )
        strip += wp.block_dim()


# Weak gap, area, gradient and stencil of one node, as `line_of_centres_weights.sum_node`: the sum over the points of
# its cells.
@wp.func_native("""
    const int start = model.points.start.data[pair], count = model.points.count.data[pair];
    const int most = (model.window.rows - 1) * model.quadrature.z_points;
    const int room = (model.window.columns + 1) * model.quadrature.theta_points * most;
    const int SC = model.window.stencil_columns, SR = model.window.stencil_rows;
    const size_t p0 = (size_t)(w * model.pairs.count + pair);
    const size_t grid_node = p0 * model.window.grid_nodes + m;
    const int column = m / rows, row = m % rows;
    const int* begin = model.points.row_at.data + model.points.row_start.data[pair];
    const int from = begin[row > 0 ? row - 1 : 0], to = begin[row + 1 < rows ? row + 1 : rows - 1];
    const double* g = point_gap.data + p0 * room;
    const double* place = point_place.data + p0 * room * 2;
    const double* st = station.data + p0 * most * 11;
    const double* sw = station_wrench.data + p0 * most * 6;
    double* l = stencil.data + grid_node * SC * SR;
    double* f = wrench.data + grid_node * 6;
    for (int e = 0; e < SC * SR; ++e) l[e] = 0.0;
    for (int c = 0; c < 6; ++c) f[c] = 0.0;
    double total = 0.0, size = 0.0, lowest_c = 1e300, lowest_r = 1e300;
    for (int t = 0; t < 2; ++t) for (int p = from; p < to; ++p) {
        const double* q = place + (size_t)((column + t) * count + p) * 2;
        if (q[0] < lowest_c) lowest_c = q[0];
        if (q[1] < lowest_r) lowest_r = q[1];
    }
    const int oc = (int)::floor(lowest_c), last = rows_b - 2;
    const int orow = lowest_r < last ? (int)::floor(lowest_r) : last;  // beyond B's end: its last cell
    int beyond = 0;
    for (int p = from; p < to; ++p) {
        const int at = start + p, s = model.points.station.data[at];
        if (st[s * 11 + 6] == 0.0) continue;
        const double x = model.points.x.data[at], zeta = model.points.zeta.data[at];
        const double wz = model.points.weight.data[at] * (model.points.row.data[at] == row ? 1.0 - zeta : zeta);
        size += wz;
        for (int c = 0; c < 6; ++c) f[c] += wz * sw[s * 6 + c];
        for (int t = 0; t < 2; ++t) {
            const size_t i = (size_t)((column + t) * count + p);
            const double q = wz * (t ? 1.0 - x : x);
            total += q * g[i];
            const double cf = ::floor(place[2 * i]), rf0 = ::floor(place[2 * i + 1]);
            const double rf = rf0 > last ? last : rf0, u = place[2 * i] - cf, v = place[2 * i + 1] - rf;
            const int ci = (int)cf - oc, ri = (int)rf - orow;
            if (ci < 0 || ci + 1 >= SC || ri < 0 || ri + 1 >= SR) { beyond = 1; continue; }
            double* d = l + ci * SR + ri;
            d[0] += q * (1.0 - u) * (1.0 - v); d[1] += q * (1.0 - u) * v;
            d[SR] += q * u * (1.0 - v); d[SR + 1] += q * u * v;
        }
    }
    weak_gap.data[grid_node] = total; area.data[grid_node] = size;
    stencil_at.data[2 * grid_node] = oc - origin; stencil_at.data[2 * grid_node + 1] = orow;
    return beyond;
""")
def sum_few(
    model: Model,
    w: int,
    pair: int,
    m: int,
    rows: int,
    rows_b: int,
    origin: int,
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


@kernel
def weigh_few(run: Run, geometry: ContactGeometry):
    """Per (world, pair of few points), lanes over nodes of the window: as `line_of_centres_weights.weigh` with all
    points."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if (
        run.ctl[w].run == 0
        or run.ctl[w].moved == 0
        or not looks_at_few(model, pair)
        or geometry.center[w, pair, 2] != 0
    ):
        return
    A = model.pairs.first[pair]
    rows = model.surfaces.rows[A]
    rows_b = model.surfaces.rows[model.pairs.second[pair]]
    H = model.window.half
    m = (geometry.window[w, pair, 0] + H) * rows + lane
    end = (geometry.window[w, pair, 1] + H + 1) * rows
    while m < end:
        beyond = sum_few(
            model, w, pair, m, rows, rows_b, geometry.center[w, pair, 1] - model.window.second_half, geometry.station,
            geometry.station_wrench, geometry.point_gap, geometry.point_place, geometry.weak_gap, geometry.area,
            geometry.wrench, geometry.stencil, geometry.stencil_at,
        )  # fmt: skip
        keep_node(model, w, pair, m, rows, beyond, geometry, run)
        m += wp.block_dim()


@kernel
def shift_few(run: Run, geometry: ContactGeometry):
    """Per (world, pair of few points), lanes over nodes: weak gaps at the current distance of the axes, and their
    gradient."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not looks_at_few(model, pair):
        return
    A = model.pairs.first[pair]
    rows = model.surfaces.rows[A]
    start = model.points.start[pair]
    begin = model.points.row_start[pair]
    frozen = geometry.center[w, pair, 2]
    m = (geometry.window[w, pair, 0] + model.window.half) * rows + lane
    while m < (geometry.window[w, pair, 1] + model.window.half + 1) * rows:
        value = geometry.weak_gap[w, pair, m]
        if frozen != 0 and geometry.area[w, pair, m] > real(0.0):
            row = m % rows
            for i in range(6):
                geometry.wrench[w, pair, m, i] = real(0.0)
            p = start + model.points.row_at[begin + wp.max(row - 1, 0)]
            end = start + model.points.row_at[begin + wp.min(row + 1, rows - 1)]
            while p < end:
                s = model.points.station[p]
                if geometry.station[w, pair, s, 6] != real(0.0):
                    psi = model.points.zeta[p]
                    if model.points.row[p] == row:
                        psi = real(1.0) - psi
                    q = psi * model.points.weight[p]
                    value += q * (geometry.station[w, pair, s, 0] - geometry.station[w, pair, s, 8])
                    for i in range(6):
                        geometry.wrench[w, pair, m, i] = (
                            geometry.wrench[w, pair, m, i] + q * geometry.station_wrench[w, pair, s, i]
                        )
                p += 1
        geometry.shifted_gap[w, pair, m] = value
        m += wp.block_dim()
