"""Weak gaps along the line of centres: at points of A's cells, located station by station.

Point p of the pair's list lies in every strip between two columns, at the fraction x_p of a column, on one of the
stations s(p), with its weight w_p [m^2]: all Gauss points, or a third of them that was chosen offline
(`warpffrf.offline.contact.cubature`). With psi_i the shape functions of A, x_p or 1 - x_p in the two strips on both
sides of a node, times psi(zeta_p), and psi^B those of B at the opposite point (column, row),

    g_i = sum_p w_p psi_i g(x_p),                  area_i = sum_p w_p psi_i,
    f_i = sum_p w_p psi_i (wrench of its station), l_i[node] = sum_p w_p psi_i psi^B_node(x_p),

weak gap, area, gradient, and the stencil: the load of B's nodes due to a unit nodal pressure of A.

The nodes of a row share its points' weights, as the sum of x_p and 1 - x_p over both strips is one: at frozen phases,
where only the distance d of the axes changes, a weak gap changes by sum_p psi(zeta_p) w_p (d_s - d_s as sampled), and
the gradient is that of the row.

The angle on B's side is computed from that of the strip's column by the series of the arc sine, since the angle between
neighbouring points is less than a column: SMALL keeps its remainder below round-off.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import LINE_OF_CENTRES, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.kinematics.line_of_centres import SERIES

wp.set_module_options(MODULE_OPTIONS)

SMALL = wp.constant(wp.float64(0.02))  # sine of an angle: its ninth power times 0.03 is 1e-17


# Gaps and opposite positions of the points of one strip, whose column is rotated by xi from the first station's line of
# centres. Native: in Warp's Python the indices of `station` alone cost more than the geometry.
@wp.func_native("""
    const int start = model.points.start.data[pair], count = model.points.count.data[pair];
    const int most = (model.window.rows - 1) * model.quadrature.z_points;
    const size_t room = (size_t)(model.window.columns + 1) * model.points.most;
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
def sample(run: Run, geometry: ContactGeometry):
    """Per (world, pair), lanes over strips of the window: gap, column and row of the opposite point."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if (
        run.ctl[w].run == 0
        or run.ctl[w].moved == 0
        or model.pairs.family[pair] != LINE_OF_CENTRES
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


# Weak gap, area, gradient and stencil of one node: the sum over the points of its (up to) four cells.
@wp.func_native("""
    const int start = model.points.start.data[pair], count = model.points.count.data[pair];
    const int most = (model.window.rows - 1) * model.quadrature.z_points;
    const int room = (model.window.columns + 1) * model.points.most;
    const int SC = model.window.stencil_columns, SR = model.window.stencil_rows;
    const size_t p0 = (size_t)(w * model.pairs.count + pair);
    const size_t grid_node = p0 * model.window.grid_nodes + m;
    const int column = m / rows, row = m % rows;
    const int* begin = model.points.row_at.data + model.points.row_start.data[pair];
    const int from = begin[row > 0 ? row - 1 : 0], to = begin[row + 1 < rows ? row + 1 : rows - 1];
    const double* g = point_gap.data + p0 * room;
    const double* place = point_place.data + p0 * room * 2;
    const double* st = station.data + p0 * most * 11;
    double* l = stencil.data + grid_node * SC * SR;
    for (int e = 0; e < SC * SR; ++e) l[e] = 0.0;
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
def sum_node(
    model: Model,
    w: int,
    pair: int,
    m: int,
    rows: int,
    rows_b: int,
    origin: int,
    station: wp.array4d(dtype=real),
    point_gap: wp.array3d(dtype=real),
    point_place: wp.array4d(dtype=real),
    weak_gap: wp.array3d(dtype=real),
    area: wp.array3d(dtype=real),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
) -> int: ...


@wp.func
def keep_node(
    model: Model, w: int, pair: int, m: int, rows: int, beyond: int, weak_gap: real, geometry: ContactGeometry, run: Run
):
    """Area 0, and no load on B, for a node beyond the end of an arc, or so far around the bodies that no part of the
    second window is opposite, or whose opposite points spread beyond its stencil (`beyond`). One that overlaps there
    may be needed: the attempt fails."""
    A = model.pairs.first[pair]
    absolute = geometry.center[w, pair, 0] + m / rows - model.window.half
    off_end = model.surfaces.periodic[A] == 0 and (absolute < 0 or absolute >= model.surfaces.columns[A])
    reached = geometry.stencil_at[w, pair, m, 0]
    lost = reached < 0 or reached + model.window.stencil_columns > model.window.second_columns or beyond != 0
    if not (off_end or lost):
        return
    if not off_end and geometry.area[w, pair, m] > real(0.0) and weak_gap <= real(0.0):
        run.ctl[w].failure = run.ctl[w].failure | k.STENCIL
    geometry.area[w, pair, m] = real(0.0)
    geometry.stencil_at[w, pair, m, 0] = model.window.second_half
    geometry.stencil_at[w, pair, m, 1] = 0
    for e in range(model.window.stencil_columns * model.window.stencil_rows):
        geometry.stencil[w, pair, m, e] = real(0.0)


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
        or model.pairs.family[pair] != LINE_OF_CENTRES
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
        beyond = sum_node(
            model, w, pair, m, rows, rows_b, geometry.center[w, pair, 1] - model.window.second_half, geometry.station,
            geometry.point_gap, geometry.point_place, geometry.weak_gap, geometry.area, geometry.stencil,
            geometry.stencil_at,
        )  # fmt: skip
        keep_node(model, w, pair, m, rows, beyond, geometry.weak_gap[w, pair, m], geometry, run)
        m += wp.block_dim()


# Weak gaps of a row of nodes, moved from the sampled distance of the axes to the present one, and the wrench of all of
# them. Lanes over the columns from `first` to `last`.
@wp.func_native("""
    const int start = model.points.start.data[pair], most = (model.window.rows - 1) * model.quadrature.z_points;
    const size_t p0 = (size_t)(w * model.pairs.count + pair), nodes = p0 * model.window.grid_nodes;
    const int* begin = model.points.row_at.data + model.points.row_start.data[pair];
    const int from = begin[row > 0 ? row - 1 : 0], to = begin[row + 1 < rows ? row + 1 : rows - 1];
    const double *st = station.data + p0 * most * 11, *sw = station_wrench.data + p0 * most * 6;
    double moved = 0.0, f[6] = {0.0};
    for (int p = from; p < to; ++p) {
        const int at = start + p, s = model.points.station.data[at];
        if (st[s * 11 + 6] == 0.0) continue;
        const double zeta = model.points.zeta.data[at];
        const double q = model.points.weight.data[at] * (model.points.row.data[at] == row ? 1.0 - zeta : zeta);
        moved += q * (st[s * 11] - st[s * 11 + 8]);
        for (int c = 0; c < 6; ++c) f[c] += q * sw[s * 6 + c];
    }
    for (int column = first + WP_TILE_THREAD_IDX; column <= last; column += WP_TILE_BLOCK_DIM) {
        const size_t m = nodes + (size_t)column * rows + row;
        double* out = wrench.data + m * 6;
        for (int c = 0; c < 6; ++c) out[c] = f[c];
        shifted_gap.data[m] = weak_gap.data[m] + moved;
    }
""")
def shift_row(
    model: Model,
    w: int,
    pair: int,
    row: int,
    rows: int,
    first: int,
    last: int,
    station: wp.array4d(dtype=real),
    station_wrench: wp.array4d(dtype=real),
    weak_gap: wp.array3d(dtype=real),
    shifted_gap: wp.array3d(dtype=real),
    wrench: wp.array4d(dtype=real),
): ...


@kernel
def shift(run: Run, geometry: ContactGeometry):
    """Per (world, pair), lanes over the columns of the window: weak gaps at the current distance of the axes, and their
    gradient, which the nodes of a row share."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or model.pairs.family[pair] != LINE_OF_CENTRES:
        return
    rows = model.surfaces.rows[model.pairs.first[pair]]
    first = geometry.window[w, pair, 0] + model.window.half
    last = geometry.window[w, pair, 1] + model.window.half
    row = int(0)
    while row < rows:
        shift_row(
            model, w, pair, row, rows, first, last, geometry.station, geometry.station_wrench, geometry.weak_gap,
            geometry.shifted_gap, geometry.wrench,
        )  # fmt: skip
        row += 1
