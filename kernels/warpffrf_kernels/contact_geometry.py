"""Undeformed gap between two bodies of revolution, weak gaps, and their gradient.

Contact frame. Take an axial station z of the first surface A: its axis point `a = O_A + z e_A`, and the point b where
the axis of the second surface B pierces the plane of the section. With `v = b - a`, `d = |v|`, `c = v/d`, `t = e_A x
c`, the point of A at the angle xi from the line of centres is `a + R_A (cos xi c + sin xi t)`. With `y = R_A sin xi`
the gap is measured *along c*:

    g(xi, z) = d - sqrt(R_B^2 - y^2) - R_A cos xi,          R_B at the axial station of the opposite point of B.

(Terms of the order of the tilt squared, from the ellipse that an oblique section of B is, are dropped.) Small xi: d -
R_A - R_B + y^2/2 (1/R_A + 1/R_B), Hertz's gap. The pressure acts along c, so that dg/dd = 1, the weights of forces,
moments and elastic displacements are the same, and the wrench is

    on B: force f at b,  on A: -f at b,          f = N + R_B'/(e_A.e_B) e_A,

N the gradient of d, the second term that of a crowned B's radius (B moved by w is met at an axial station smaller by
w.e_A/(e_A.e_B)): action equals reaction exactly; the line of action meets both axes, so that the torque about either
axle is zero exactly. The gradient is taken at fixed (xi, z): the *material* angles at which the line of centres meets
the two grids (their phases) are parameters, not coordinates, of the contact energy. What its energy changes when a
phase changes is the grid defect of the ledger.

Gradient of d. A displacement field w of B's axis relative to A moves b by w + sigma e_B with e_A.(w + sigma e_B) = 0,
hence `dd = N.w`, `N = c - e_A (c.e_B)/(e_A.e_B)`.

The phases of a step are those of its first evaluation, the predicted state, until an iteration moves the grids by more
than FREEZE: the force ripples by a fraction of a percent a column, so that is below the residual tolerance. At fixed
phases the gap of two cylinders is linear in d, and an evaluation only shifts the weak gaps (`shift`) instead of
sampling them again.

Weak gaps. Hats psi_i of A's grid, Gauss points in every cell: `g_i = int psi_i g dA`; B is interpolated at the point of
B opposite (grid column, row), which gives the stencil `l_i[node] = int psi_i psi^B_node dA`, the load of B's hats under
a unit pressure hat of A.
"""

import math

import warp as wp

from warpffrf_kernels import control as k
from warpffrf_kernels.model import Model
from warpffrf_kernels.scalars import MODULE_OPTIONS, mat33, real, vec3

wp.set_module_options(MODULE_OPTIONS)

PHASE_TOLERANCE = wp.constant(
    wp.float64(1.0e-4)
)  # columns: G changes by about this fraction; as a tangent it may, see contact_solve
SERIES = wp.constant(wp.float64(5.0e-6))  # rad: third-order terms are then below round-off
TWO_PI = wp.constant(wp.float64(2.0 * math.pi))
FREEZE = wp.constant(wp.float64(2.0e-7))  # columns: phases that an iteration changes by less stay, see above
DRIFT = wp.constant(wp.float64(0.75))  # columns off the centre column, beyond which the windows are moved
FARTHEST = wp.constant(wp.float64(1.0e6))  # columns: a phase beyond is that of a state that has left the scene
GUARD = wp.constant(2)  # outermost columns of a full window that must end inactive
MARGIN = wp.constant(3)  # columns looked at beyond the active ones


@wp.func
def radius_at(R: real, crown: real, z: real) -> real:
    if crown == real(0.0):
        return R
    return R - (crown - wp.sqrt(crown * crown - z * z))


@wp.func
def slope_at(crown: real, z: real) -> real:
    if crown == real(0.0):
        return real(0.0)
    return -z / wp.sqrt(crown * crown - z * z)


@wp.func
def wrap(x: real, turn: real, middle: real) -> real:
    """x modulo a full turn, nearest to `middle`."""
    return x - turn * wp.floor((x - middle) / turn + real(0.5))


@wp.kernel
def locate(
    models: wp.array(dtype=Model),
    r1: wp.array2d(dtype=vec3),
    axes: wp.array2d(dtype=mat33),
    ctl: wp.array2d(dtype=int),
    phase: wp.array3d(dtype=real),
    center: wp.array3d(dtype=int),
    station: wp.array4d(dtype=real),
    station_wrench: wp.array4d(dtype=real),
):
    """Per (world, pair): contact frame and grid phases of every axial station.

    station: d, column on A, column on B, axial position on B, t.e_B, c.e_B, weight int dz R_A, sense of B's angle, d
    where the gaps were sampled, columns of this evaluation.
    """
    w, pair = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0 or model.pair_family[pair] != 0:
        return
    A = model.pair_first[pair]
    B = model.pair_second[pair]
    body_a = model.surface_body[A]
    body_b = model.surface_body[B]
    O_A = r1[w, body_a] + axes[w, body_a] * model.surface_origin[A]
    O_B = r1[w, body_b] + axes[w, body_b] * model.surface_origin[B]
    F_A = axes[w, body_a] * model.surface_frame[A]
    F_B = axes[w, body_b] * model.surface_frame[B]
    e_A = vec3(F_A[0, 2], F_A[1, 2], F_A[2, 2])
    e_B = vec3(F_B[0, 2], F_B[1, 2], F_B[2, 2])
    cosine = wp.dot(e_A, e_B)
    turn_a = TWO_PI / model.surface_pitch[A]
    turn_b = TWO_PI / model.surface_pitch[B]
    middle_a = real(0.5) * real(model.surface_columns[A] - 1)
    middle_b = real(0.5) * real(model.surface_columns[B] - 1)
    rows = model.surface_rows[A]
    z0 = model.surface_z_start[A]
    zb0 = model.surface_z_start[B]
    zb_low = model.surface_z[zb0]
    zb_high = model.surface_z[zb0 + model.surface_rows[B] - 1]
    count = (rows - 1) * model.z_points
    column_a = real(0.0)
    column_b = real(0.0)
    largest = real(0.0)
    moved = real(0.0)
    s = int(0)
    while s < count:
        cell = s / model.z_points
        g = s - cell * model.z_points
        low = model.surface_z[z0 + cell]
        dz = model.surface_z[z0 + cell + 1] - low
        z = low + model.z_abscissa[g] * dz
        a = O_A + z * e_A
        axial = wp.dot(e_A, a - O_B) / cosine
        b = O_B + axial * e_B
        v = b - a
        d = wp.length(v)
        c = v / d
        t = wp.cross(e_A, c)
        u = wp.transpose(F_A) * c
        x_a = (wp.atan2(u[1], u[0]) - model.surface_theta[A]) / model.surface_pitch[A]
        u = wp.transpose(F_B) * c
        x_b = (wp.atan2(-u[1], -u[0]) - model.surface_theta[B]) / model.surface_pitch[B]
        if s == 0:
            x_a = wrap(x_a, turn_a, middle_a)
            x_b = wrap(x_b, turn_b, middle_b)
            if ctl[w, k.ITERATION] > 0:  # stay on the branch of the window
                x_a = wrap(x_a, turn_a, real(center[w, pair, 0]))
                x_b = wrap(x_b, turn_b, real(center[w, pair, 1]))
            column_a = x_a
            column_b = x_b
        x_a = wrap(x_a, turn_a, column_a)
        x_b = wrap(x_b, turn_b, column_b)
        N = c - e_A * (wp.dot(c, e_B) / cosine)
        f = N + e_A * (slope_at(model.surface_crown[B], axial) / cosine)
        m = wp.cross(b - r1[w, body_a], f)
        slope = slope_at(model.surface_crown[A], z)
        weight = model.z_weight[g] * dz * radius_at(model.surface_radius[A], model.surface_crown[A], z)
        weight *= wp.sqrt(real(1.0) + slope * slope)
        if axial < zb_low or axial > zb_high:
            weight = real(0.0)  # no opposite surface here
        station[w, pair, s, 0] = d
        moved = wp.max(moved, wp.max(wp.abs(x_a - station[w, pair, s, 1]), wp.abs(x_b - station[w, pair, s, 2])))
        station[w, pair, s, 9] = x_a
        station[w, pair, s, 10] = x_b
        station[w, pair, s, 3] = axial
        station[w, pair, s, 4] = wp.dot(t, e_B)
        station[w, pair, s, 5] = wp.dot(c, e_B)
        station[w, pair, s, 6] = weight
        station[w, pair, s, 7] = -wp.sign(cosine)
        for i in range(3):
            station_wrench[w, pair, s, i] = -f[i]
            station_wrench[w, pair, s, 3 + i] = -m[i]
        if s == 0:
            largest = wp.max(wp.abs(x_a - phase[w, pair, 0]), wp.abs(x_b - phase[w, pair, 1]))
            phase[w, pair, 4] = x_a
            phase[w, pair, 5] = x_b
        if s == count - 1:
            largest = wp.max(largest, wp.max(wp.abs(x_a - phase[w, pair, 2]), wp.abs(x_b - phase[w, pair, 3])))
            phase[w, pair, 6] = x_a
            phase[w, pair, 7] = x_b
        s += 1
    if largest > PHASE_TOLERANCE:
        ctl[w, k.REASSEMBLE] = 1
    mid_a = real(0.5) * (phase[w, pair, 4] + phase[w, pair, 6])
    mid_b = real(0.5) * (phase[w, pair, 5] + phase[w, pair, 7])
    if not (wp.abs(mid_a) < FARTHEST and wp.abs(mid_b) < FARTHEST):  # also where they are not numbers
        ctl[w, k.FAILURE] = ctl[w, k.FAILURE] | k.NOT_FINITE
        ctl[w, k.RUN] = 0
        return
    center[w, pair, 2] = 0
    drift = wp.max(wp.abs(mid_a - real(center[w, pair, 0])), wp.abs(mid_b - real(center[w, pair, 1])))
    if ctl[w, k.ITERATION] == 0 or drift > DRIFT:
        center[w, pair, 0] = int(wp.floor(mid_a + real(0.5)))
        center[w, pair, 1] = int(wp.floor(mid_b + real(0.5)))
        ctl[w, k.REASSEMBLE] = 1
        ctl[w, k.RECENTER] = 1
    elif moved <= FREEZE and ctl[w, k.REASSEMBLE] == 0 and model.surface_crown[B] == real(0.0):
        center[w, pair, 2] = 1
    if center[w, pair, 2] == 0:
        s = int(0)
        while s < count:
            station[w, pair, s, 1] = station[w, pair, s, 9]
            station[w, pair, s, 2] = station[w, pair, s, 10]
            station[w, pair, s, 8] = station[w, pair, s, 0]
            s += 1


@wp.kernel
def open_window(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    phase: wp.array3d(dtype=real),
    touched: wp.array3d(dtype=int),
    center: wp.array3d(dtype=int),
    station: wp.array4d(dtype=real),
    active: wp.array3d(dtype=int),
    pressure: wp.array3d(dtype=real),
    patch_offset: wp.array2d(dtype=real),
    window: wp.array3d(dtype=int),
):
    """Per (world, pair): the active set of the last attempt put where the patch is now, and the columns to look at: the
    active ones, those of `touched` (family 1) and MARGIN more on each side, relative to the centre column.

    A pair whose sampled gaps would only have been shifted (`locate`) is sampled again where another pair had its
    windows laid anew: its own may have grown.
    """
    w, pair = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.RECENTER] == 0:
        return
    rows = model.surface_rows[model.pair_first[pair]]
    H = model.half_window
    if center[w, pair, 2] != 0:
        center[w, pair, 2] = 0
        s = int(0)
        while s < (rows - 1) * model.z_points:
            station[w, pair, s, 8] = station[w, pair, s, 0]
            s += 1
    offset = real(0.5) * (phase[w, pair, 4] + phase[w, pair, 6]) - real(center[w, pair, 0])
    shift = int(wp.floor(offset - patch_offset[w, pair] + real(0.5))) * rows
    patch_offset[w, pair] = offset
    size = model.window_columns * rows
    n = int(0)
    while shift != 0 and n < size:
        to = n
        if shift > 0:
            to = size - 1 - n
        source = to - shift
        active[w, pair, to] = 0
        pressure[w, pair, to] = real(0.0)
        if source >= 0 and source < size:
            active[w, pair, to] = active[w, pair, source]
            pressure[w, pair, to] = pressure[w, pair, source]
        n += 1
    low = int(0)
    high = int(0)
    found = int(0)
    m = int(0)
    while m < model.window_columns * rows:
        if active[w, pair, m] != 0 and not wp.isfinite(pressure[w, pair, m]):  # left by a rejected attempt
            active[w, pair, m] = 0
            pressure[w, pair, m] = real(0.0)
        if active[w, pair, m] != 0:
            o = m / rows - H
            if found == 0:
                low = o
            high = o
            found = int(1)
        m += 1
    if model.pair_family[pair] == 1:
        first = wp.clamp(touched[w, pair, 0] - center[w, pair, 0], -H, H)
        last = wp.clamp(touched[w, pair, 1] - center[w, pair, 0], -H, H)
        if found == 0:
            low = first
            high = last
        low = wp.min(low, first)
        high = wp.max(high, last)
    window[w, pair, 0] = wp.max(low - MARGIN, -H)
    window[w, pair, 1] = wp.min(high + MARGIN, H)


@wp.func
def row_below(model: Model, B: int, z: real) -> int:
    """Row of B's grid at or below z, kept inside the grid."""
    z0 = model.surface_z_start[B]
    last = model.surface_rows[B] - 2
    i = int(0)
    while i < last and z >= model.surface_z[z0 + i + 1]:
        i += 1
    return i


@wp.kernel
def sample(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    center: wp.array3d(dtype=int),
    window: wp.array3d(dtype=int),
    station: wp.array4d(dtype=real),
    point_gap: wp.array3d(dtype=real),
    point_place: wp.array4d(dtype=real),
):
    """Per (world, pair), lanes over points of the window: gap, and grid coordinates (column, row) of the opposite
    point of B.
    """
    w, pair, lane = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0 or center[w, pair, 2] != 0 or model.pair_family[pair] != 0:
        return
    if model.pair_point_count[pair] != 0:  # few points: `contact_few`
        return
    A = model.pair_first[pair]
    B = model.pair_second[pair]
    stations = (model.surface_rows[A] - 1) * model.z_points
    per_cell = model.theta_points * stations
    first = window[w, pair, 0] + model.half_window
    last = window[w, pair, 1] + model.half_window + 1
    R_A = model.surface_radius[A]
    crown_a = model.surface_crown[A]
    crown_b = model.surface_crown[B]
    z0 = model.surface_z_start[A]
    zb0 = model.surface_z_start[B]
    columns = (last + 1 - first) * model.theta_points
    e = lane
    while e < columns:
        cell = first + e / model.theta_points
        g = e % model.theta_points
        x = real(center[w, pair, 0] + cell - model.half_window - 1) + model.theta_abscissa[g]
        # stations differ little: sines and the angle on B are carried from the first one by their series
        x_0 = station[w, pair, 0, 1]
        xi = (x - x_0) * model.surface_pitch[A]
        sine = wp.sin(xi)
        cosine = wp.cos(xi)
        R_B0 = radius_at(model.surface_radius[B], crown_b, station[w, pair, 0, 3])
        y_0 = R_A * sine
        h_0 = wp.sqrt(wp.max(R_B0 * R_B0 - y_0 * y_0, real(0.0)))
        angle_0 = wp.atan2(y_0, h_0)
        s = int(0)
        while s < stations:
            d = (x_0 - station[w, pair, s, 1]) * model.surface_pitch[A]
            si = sine
            co = cosine
            if wp.abs(d) > SERIES:
                si = wp.sin(xi + d)
                co = wp.cos(xi + d)
            elif d != real(0.0):
                si = sine + d * (cosine - real(0.5) * d * sine)
                co = cosine - d * (sine + real(0.5) * d * cosine)
            R = R_A
            if crown_a != real(0.0):
                zc = s / model.z_points
                low = model.surface_z[z0 + zc]
                z = low + model.z_abscissa[s - zc * model.z_points] * (model.surface_z[z0 + zc + 1] - low)
                R = radius_at(R_A, crown_a, z)
            y = R * si
            R_B = radius_at(model.surface_radius[B], crown_b, station[w, pair, s, 3])
            h = wp.sqrt(wp.max(R_B * R_B - y * y, real(0.0)))
            axial = station[w, pair, s, 3] + y * station[w, pair, s, 4] - h * station[w, pair, s, 5]
            if crown_b != real(0.0):
                R_B = radius_at(model.surface_radius[B], crown_b, axial)
                h = wp.sqrt(wp.max(R_B * R_B - y * y, real(0.0)))
            turned = (y * h_0 - h * y_0) / (R_B * R_B0)  # sine of the angle from the first station's point
            angle = angle_0 + turned
            if wp.abs(turned) > SERIES:
                angle = wp.atan2(y, h)
            i = cell * per_cell + g * stations + s
            point_gap[w, pair, i] = station[w, pair, s, 0] - h - R * co
            point_place[w, pair, i, 0] = (
                station[w, pair, s, 2] + station[w, pair, s, 7] * angle / model.surface_pitch[B]
            )
            row = row_below(model, B, axial)
            low = model.surface_z[zb0 + row]
            place = real(row) + (axial - low) / (model.surface_z[zb0 + row + 1] - low)
            point_place[w, pair, i, 1] = wp.clamp(place, real(0.0), real(model.surface_rows[B] - 1))
            s += 1
        e += wp.block_dim()


# Weak gap, area, gradient and stencil of one hat: the sum over the Gauss points of its (up to) four cells.
# Measured against the same loop in Warp's Python: `weigh` 17.3 -> 4.9 us of a step of 141 us.
@wp.func_native("""
    const int NS = (rows - 1) * model.z_points, NT = model.theta_points, most = (model.max_rows - 1) * model.z_points;
    const int SC = model.stencil_columns, SR = model.stencil_rows;
    const size_t p0 = (size_t)(w * model.pair_count + pair);
    const size_t hat = p0 * model.mode_capacity + m;
    const int column = m / rows, row = m % rows;
    const int s0 = (row > 0 ? row - 1 : 0) * model.z_points;
    const int s1 = (row + 1 < rows ? row + 1 : rows - 1) * model.z_points;
    const double* g = point_gap.data + p0 * (model.window_columns + 1) * NT * most;
    const double* place = point_place.data + p0 * (model.window_columns + 1) * NT * most * 2;
    const double* st = station.data + p0 * most * 11;
    const double* sw = station_wrench.data + p0 * most * 6;
    double* l = stencil.data + hat * SC * SR;
    double* f = wrench.data + hat * 6;
    for (int e = 0; e < SC * SR; ++e) l[e] = 0.0;
    for (int c = 0; c < 6; ++c) f[c] = 0.0;
    double total = 0.0, size = 0.0, lowest_c = 1e300, lowest_r = 1e300;
    for (int t = 0; t < 2 * NT; ++t) for (int s = s0; s < s1; ++s) {
        const double* q = place + (size_t)((column * NT + t) * NS + s) * 2;
        if (q[0] < lowest_c) lowest_c = q[0];
        if (q[1] < lowest_r) lowest_r = q[1];
    }
    const int oc = (int)::floor(lowest_c), orow = (int)::floor(lowest_r);
    int beyond = 0;
    for (int s = s0; s < s1; ++s) {
        const int zc = s / model.z_points;
        const double zeta = model.z_abscissa.data[s - zc * model.z_points];
        const double wz = (zc == row ? 1.0 - zeta : zeta) * st[s * 11 + 6] * pitch;
        double hat_weight = 0.0;
        for (int t = 0; t < 2 * NT; ++t) {
            const double x = model.theta_abscissa.data[t % NT];
            const double q = (t < NT ? x : 1.0 - x) * model.theta_weight.data[t % NT] * wz;
            const int p = (column * NT + t) * NS + s;
            total += q * g[p]; hat_weight += q;
            const double cf = ::floor(place[2 * p]), rf0 = ::floor(place[2 * p + 1]), last = rows_b - 2;
            const double rf = rf0 > last ? last : rf0, u = place[2 * p] - cf, v = place[2 * p + 1] - rf;
            const int ci = (int)cf - oc, ri = (int)rf - orow;
            if (ci < 0 || ci + 1 >= SC || ri < 0 || ri + 1 >= SR) { beyond = 1; continue; }
            double* d = l + ci * SR + ri;
            d[0] += q * (1.0 - u) * (1.0 - v); d[1] += q * (1.0 - u) * v;
            d[SR] += q * u * (1.0 - v); d[SR + 1] += q * u * v;
        }
        size += hat_weight;
        for (int c = 0; c < 6; ++c) f[c] += hat_weight * sw[s * 6 + c];
    }
    weak_gap.data[hat] = total; area.data[hat] = size;
    stencil_at.data[2 * hat] = oc - origin; stencil_at.data[2 * hat + 1] = orow;
    return beyond;
""")
def sum_hat(
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
def keep_hat(
    model: Model,
    w: int,
    pair: int,
    m: int,
    rows: int,
    beyond: int,
    center: wp.array3d(dtype=int),
    stencil_at: wp.array4d(dtype=int),
    weak_gap: wp.array3d(dtype=real),
    ctl: wp.array2d(dtype=int),
    area: wp.array3d(dtype=real),
):
    """Area 0 for a hat beyond the end of an arc, or so far round the bodies that nothing of the second window is
    opposite. One that overlaps there, or whose stencil is too small (`beyond`), is needed: the attempt fails."""
    A = model.pair_first[pair]
    absolute = center[w, pair, 0] + m / rows - model.half_window
    if model.surface_periodic[A] == 0 and (absolute < 0 or absolute >= model.surface_columns[A]):
        area[w, pair, m] = real(0.0)
    needed = area[w, pair, m] > real(0.0)
    reached = stencil_at[w, pair, m, 0]
    if reached < 0 or reached + model.stencil_columns > model.second_columns:
        area[w, pair, m] = real(0.0)
        needed = needed and weak_gap[w, pair, m] <= real(0.0)
    elif beyond == 0:
        needed = False
    if needed:
        ctl[w, k.FAILURE] = ctl[w, k.FAILURE] | k.STENCIL


@wp.kernel
def weigh(
    models: wp.array(dtype=Model),
    center: wp.array3d(dtype=int),
    window: wp.array3d(dtype=int),
    station: wp.array4d(dtype=real),
    station_wrench: wp.array4d(dtype=real),
    point_gap: wp.array3d(dtype=real),
    point_place: wp.array4d(dtype=real),
    ctl: wp.array2d(dtype=int),
    weak_gap: wp.array3d(dtype=real),
    area: wp.array3d(dtype=real),
    wrench: wp.array4d(dtype=real),
    stencil: wp.array4d(dtype=real),
    stencil_at: wp.array4d(dtype=int),
):
    """Per (world, pair), lanes over hats of the window: weak undeformed gap, area, gradient, and stencil on B.

    Area 0 marks a hat that does not exist (beyond an arc's end) or faces nothing.
    """
    w, pair, lane = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0 or center[w, pair, 2] != 0 or model.pair_family[pair] != 0:
        return
    if model.pair_point_count[pair] != 0:
        return
    A = model.pair_first[pair]
    rows = model.surface_rows[A]
    rows_b = model.surface_rows[model.pair_second[pair]]
    H = model.half_window
    m = (window[w, pair, 0] + H) * rows + lane
    end = (window[w, pair, 1] + H + 1) * rows
    while m < end:
        beyond = sum_hat(
            model, w, pair, m, rows, rows_b, center[w, pair, 1] - model.second_half_window, model.surface_pitch[A],
            station, station_wrench, point_gap, point_place, weak_gap, area, wrench, stencil, stencil_at,
        )  # fmt: skip
        keep_hat(model, w, pair, m, rows, beyond, center, stencil_at, weak_gap, ctl, area)
        m += wp.block_dim()


@wp.kernel
def shift(
    models: wp.array(dtype=Model),
    ctl: wp.array2d(dtype=int),
    center: wp.array3d(dtype=int),
    window: wp.array3d(dtype=int),
    station: wp.array4d(dtype=real),
    station_wrench: wp.array4d(dtype=real),
    area: wp.array3d(dtype=real),
    weak_gap: wp.array3d(dtype=real),
    wrench: wp.array4d(dtype=real),
    shifted_gap: wp.array3d(dtype=real),
):
    """Per (world, pair), lanes over hats: the sampled weak gaps at the present distance of the axes, and their
    gradient.
    """
    w, pair, lane = wp.tid()
    model = models[0]
    if ctl[w, k.RUN] == 0 or ctl[w, k.MOVED] == 0:
        return
    if model.pair_family[pair] == 0 and model.pair_point_count[pair] != 0:
        return
    A = model.pair_first[pair]
    rows = model.surface_rows[A]
    frozen = center[w, pair, 2]
    m = (window[w, pair, 0] + model.half_window) * rows + lane
    while m < (window[w, pair, 1] + model.half_window + 1) * rows:
        value = weak_gap[w, pair, m]
        if frozen != 0 and area[w, pair, m] > real(0.0):
            row = m % rows
            for i in range(6):
                wrench[w, pair, m, i] = real(0.0)
            s = wp.max(row - 1, 0) * model.z_points
            while s < wp.min(row + 1, rows - 1) * model.z_points:
                zc = s / model.z_points
                psi = model.z_abscissa[s - zc * model.z_points]
                if zc == row:
                    psi = real(1.0) - psi
                q = psi * station[w, pair, s, 6] * model.surface_pitch[A]  # a hat's integral around is the pitch
                value += q * (station[w, pair, s, 0] - station[w, pair, s, 8])
                for i in range(6):
                    wrench[w, pair, m, i] = wrench[w, pair, m, i] + q * station_wrench[w, pair, s, i]
                s += 1
        shifted_gap[w, pair, m] = value
        m += wp.block_dim()
