"""Closest points of two surfaces of any shape, for the pairs whose gaps are evaluated at points (`at_points`).

With x_A(theta, z) a point of A's true surface and d_B the signed distance from B's, the gap is g = d_B(x_A). In a
section z of A its minima with respect to the angle (for a plane, the position) are roots of

    dg/dtheta = grad d_B . dx_A/dtheta.

A step begins with a scan of the whole surface: in three sections every minimum among SCAN angles is refined by secants,
the first over half a column, and a secant that leaves the bracket is replaced by bisection. (With secants over half a
column only, a point where the curvature changes over less would be left by its error, which is of the order of SETTLED
and another one in each iteration of a step.) From the smallest of them the closest point is found by Newton's method on
the chart, with finite differences of the gradient for the second derivatives; directions without curvature of the gap
are regularised by REGULAR, and steps end at the edges of A's grid. (Its gap is recorded as the approach.) Within a
step the point is tracked by secants in its section. A constant gap (plane on plane) leaves the point in the middle.

The point is the centre of the window, with or without contact: for a separated pair it is the point of the next
contact, to a fraction of a column. It is also the *phase* of A's grid; the opposite point on B, its row, and the shift
of B's columns along A's width are those of B's. Other minima that overlap (a second patch) are kept inside the window
too (`touched`). A pair whose first grid is an arc of no more columns than the window uses the whole arc, and its window
never moves.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import AT_POINTS, PATCH, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.kinematics.line_of_centres import DRIFT, FARTHEST, PHASE_TOLERANCE, row_below, wrap
from warpffrf_kernels.surfaces.height import height_at
from warpffrf_kernels.surfaces.helical import rotated, twist_of
from warpffrf_kernels.surfaces.smooth import DIAGONAL, period_of, profile_of, radius_of, smooth_distance
from warpffrf_kernels.surfaces.surface import (
    EXTRUDED,
    HEIGHT,
    axes_of,
    curved_foot,
    foot_of,
    local_point,
    origin_of,
    past_end,
    section_at,
)

wp.set_module_options(MODULE_OPTIONS)

SCAN = wp.constant(24)  # angles of the scan, 15 degrees apart: brackets the one minimum of a convex section
SECTIONS = wp.constant(3)  # both ends and the middle
# of the scene's length: gaps that differ by less are equal, the middle one is taken
TIE = wp.constant(wp.float64(1.0e-11))
TWISTED = wp.constant(6)  # sections of twisted curves in which they are looked for
SECANTS = wp.constant(40)  # as many bisections of 15 degrees reach 1e-11; secants take five
SETTLED = wp.constant(wp.float64(1.0e-9))  # columns, of a step by a secant between two places of the iteration
CLOSE = wp.constant(wp.float64(1.0e-12))  # columns: a secant between places that are closer is round-off
LOOKS = wp.constant(33)  # sections of the initial search for the smallest gap: a wheel's flange, root and tread
STEPS = wp.constant(12)  # of Newton's method from there
HALVINGS = wp.constant(6)
EDGE_STEP = wp.constant(wp.float64(1.0e-3))  # of A's width: step of the differences along it
REGULAR = wp.constant(wp.float64(1.0e-6))  # of the current curvature, and of 1/width
FLAT = wp.constant(wp.float64(1.0e-12))  # of the scene's length per column: a smaller change of slope is round-off
BEYOND = wp.constant(wp.float64(1.0e300))  # m: the gap beyond the end of an arc
NOWHERE = wp.constant(-(2**30))  # column of a missing point
MOST_OVERLAPS = wp.constant(12)  # overlapping minima of the gap, in all sections: two surfaces of revolution have two
Columns = wp.types.vector(length=12, dtype=wp.float64)


@wp.struct
class View:
    """A's surface frame relative to B's: a point x of A is at `at + turn x` there."""

    at: vec3
    turn: mat33


@wp.func
def view_of(model: Model, w: int, pair: int, trial: Trial) -> View:
    A = model.pairs.first[pair]
    B = model.pairs.second[pair]
    body_a = model.surfaces.body[A]
    body_b = model.surfaces.body[B]
    turn_a = axes_of(trial.axes, w, body_a)
    turn_b = axes_of(trial.axes, w, body_b)
    # the difference of the centres of mass first: positions may be large against the bodies
    between = origin_of(trial.r1, w, body_a) - origin_of(trial.r1, w, body_b)
    between += turn_a * model.surfaces.origin[A] - turn_b * model.surfaces.origin[B]
    to_b = wp.transpose(turn_b * model.surfaces.frame[B])
    view = View()
    view.at = to_b * between
    view.turn = to_b * (turn_a * model.surfaces.frame[A])
    return view


@wp.func
def wrap_column(model: Model, s: int, column: real, middle: real) -> real:
    """A column of a surface that closes around, nearest to `middle`; unchanged of others."""
    period = period_of(model, s)
    if period == real(0.0):
        return column
    return wrap(column, period / model.surfaces.pitch[s], middle)


@wp.func
def gap_at(model: Model, A: int, B: int, view: View, theta: real, z: real) -> real:
    """g [m] at chart coordinates of A. More than a column beyond the ends of the grid on an extruded curve, over which
    patches run, there is no material along its tangents: then the distance from there."""
    x = view.at + view.turn * local_point(model, A, theta, z)
    if model.surfaces.planar[B] < EXTRUDED:
        return smooth_distance(model, B, x)
    foot = curved_foot(model, B, x)
    if model.surfaces.rigid[B] != 0 or model.surfaces.periodic[B] != 0 or model.surfaces.planar[B] == HEIGHT:
        return foot.distance
    if past_end(model, B, foot.theta) != real(0.0):  # the distance is that of the end already
        return foot.distance
    last = real(model.surfaces.columns[B] - 1)
    column = (foot.theta - model.surfaces.theta[B]) / model.surfaces.pitch[B]
    column = wrap_column(model, B, column, real(0.5) * last)
    beyond = model.surfaces.pitch[B] * (wp.max(-column, column - last) - real(1.0))
    if beyond > real(0.0):
        return wp.sqrt(foot.distance * foot.distance + beyond * beyond)
    return foot.distance


@wp.func
def slopes(model: Model, A: int, B: int, view: View, column: real, z: real) -> wp.vec2d:
    """dg/dtheta and dg/dz at a column and axial position of A."""
    theta = model.surfaces.theta[A] + column * model.surfaces.pitch[A]
    x = vec3(real(0.0), theta, z)
    around = vec3(real(0.0), real(1.0), real(0.0))
    along = vec3(real(0.0), real(0.0), real(1.0))
    if model.surfaces.planar[A] == EXTRUDED:
        at = section_at(model, A, theta)
        twist = twist_of(model, A)
        x = rotated(vec3(at.point[0], at.point[1], z), twist * z)
        around = rotated(vec3(at.slope[0], at.slope[1], real(0.0)), twist * z)
        along = vec3(-twist * x[1], twist * x[0], real(1.0))
    elif model.surfaces.planar[A] == HEIGHT:
        place = height_at(model, A, theta, z)
        x = vec3(place.value, theta, z)
        around = vec3(place.slope[0], real(1.0), real(0.0))
        along = vec3(place.slope[1], real(0.0), real(1.0))
    elif model.surfaces.planar[A] == 0:
        profile = profile_of(model, A, z)
        x = vec3(profile[0] * wp.cos(theta), profile[0] * wp.sin(theta), z)
        around = vec3(-x[1], x[0], real(0.0))
        along = vec3(profile[1] * wp.cos(theta), profile[1] * wp.sin(theta), real(1.0))
    gradient = wp.transpose(view.turn) * foot_of(model, B, view.at + view.turn * x).normal
    return wp.vec2d(wp.dot(gradient, around), wp.dot(gradient, along))


@wp.func
def section_of(model: Model, A: int, section: int) -> real:
    """z of a section: the middle first."""
    z0 = model.surfaces.z_start[A]
    low = model.surfaces.z[z0]
    high = model.surfaces.z[z0 + model.surfaces.rows[A] - 1]
    if section == 1:
        return low
    if section == 2:
        return high
    return real(0.5) * (low + high)


@wp.func
def spacing_of(model: Model, A: int) -> real:
    """Columns between two angles of the scan."""
    angles = int(SCAN)
    if model.surfaces.periodic[A] != 0:
        return real(model.surfaces.columns[A]) / real(angles)
    return real(model.surfaces.columns[A] - 1) / real(angles - 1)


@wp.func
def settle(model: Model, A: int, B: int, view: View, start: real, z: real) -> real:
    """Column of A nearest to the column `start` where the gap of the section z has a minimum."""
    pitch = model.surfaces.pitch[A]
    flat = FLAT * model.length
    last = real(model.surfaces.columns[A] - 1)
    around = model.surfaces.periodic[A] != 0
    farthest = wp.max(spacing_of(model, A), real(1.0))  # columns per step
    low = real(-1.0e300)  # the bracket: the gap decreases at one end and increases at the other
    high = real(1.0e300)
    before_x = start + real(0.5)  # the first secant is over half a column
    before = real(0.0)
    x = before_x
    step = int(-1)
    while step < SECANTS:
        slope = slopes(model, A, B, view, x, z)[0]
        to = start
        if step >= 0:
            to = x
            turn = (slope - before) / (x - before_x)
            if wp.abs(slope) * pitch > flat or real(0.5) * turn * pitch > flat:
                if slope > real(0.0):
                    high = x
                else:
                    low = x
                to = x - wp.sign(slope) * farthest
                if real(0.5) * turn * pitch > flat:
                    to = x + wp.clamp(-slope / turn, -farthest, farthest)
                if to < low or to > high:
                    to = real(0.5) * (low + high)
            if not around:
                to = wp.clamp(to, real(0.0), last)
        step += 1
        if wp.abs(to - x) <= CLOSE or (step > 1 and wp.abs(to - x) <= SETTLED):
            step = SECANTS
        before_x = x
        before = slope
        x = to
    return x


@wp.func
def least_place(model: Model, A: int, B: int, view: View, column: real, z_start: real) -> vec3:
    """Smallest gap [m] about a column and axial position of A, over the extent of A's grid, and its column and z."""
    pitch = model.surfaces.pitch[A]
    low = model.surfaces.z[model.surfaces.z_start[A]]
    high = model.surfaces.z[model.surfaces.z_start[A] + model.surfaces.rows[A] - 1]
    z = z_start
    theta = model.surfaces.theta[A] + column * pitch
    best = gap_at(model, A, B, view, theta, z)
    looks = int(LOOKS)
    between = (high - low) / real(looks - 1)
    i = int(0)
    while i < looks:
        at = low + (high - low) * real(i) / real(looks - 1)
        g = gap_at(model, A, B, view, theta, at)
        if g < best - TIE * model.length:
            best = g
            z = at
        i += 1
    x = column
    step = int(0)
    while step < STEPS:
        R = radius_of(model, A, z)
        dz = EDGE_STEP * (high - low)
        if z + dz > high:
            dz = -dz
        here = wp.vec2d(real(0.0), real(0.0))
        by_x = wp.vec2d(real(0.0), real(0.0))
        by_z = wp.vec2d(real(0.0), real(0.0))
        part = int(0)
        while part < 3:
            x_part = x
            z_part = z
            if part == 1:
                x_part += real(0.5)
            if part == 2:
                z_part += dz
            found = slopes(model, A, B, view, x_part, z_part) / R
            if part == 0:
                here = found
            elif part == 1:
                by_x = found
            else:
                by_z = found
            part += 1
        # gradient and second derivatives by arc length around and by z
        h_aa = (by_x[0] - here[0]) / (real(0.5) * pitch * R)
        h_zz = (by_z[1] - here[1]) * R / dz
        h_az = (by_z[0] - here[0]) / dz
        least = REGULAR * (wp.abs(h_aa) + wp.abs(h_zz)) + REGULAR / (high - low)
        if h_zz < least:  # concave along z: a step along each direction by itself
            h_az = real(0.0)
        h_aa = wp.max(h_aa, least)
        h_zz = wp.max(h_zz, least)
        bound = real(0.9) * wp.sqrt(h_aa * h_zz)
        h_az = wp.clamp(h_az, -bound, bound)
        g_a = here[0]
        g_z = here[1] * R
        if (z <= low and g_z > real(0.0)) or (z >= high and g_z < real(0.0)):
            g_z = real(0.0)
            h_az = real(0.0)
        determinant = h_aa * h_zz - h_az * h_az
        move_a = -(h_zz * g_a - h_az * g_z) / determinant
        move_z = -(h_aa * g_z - h_az * g_a) / determinant
        share = real(1.0)
        tries = int(0)
        while tries < HALVINGS:
            x_to = x + share * wp.clamp(move_a / (R * pitch), -real(8.0), real(8.0))
            if model.surfaces.periodic[A] == 0:
                x_to = wp.clamp(x_to, real(0.0), real(model.surfaces.columns[A] - 1))
            z_to = wp.clamp(z + share * wp.clamp(move_z, -between, between), low, high)
            g = gap_at(model, A, B, view, model.surfaces.theta[A] + x_to * pitch, z_to)
            tries += 1
            share *= real(0.5)
            if g < best:
                best = g
                x = x_to
                z = z_to
                tries = HALVINGS + 1
        step += 1
        if tries == HALVINGS:
            step = STEPS
    return vec3(best, x, z)


@wp.func
def scan(model: Model, w: int, pair: int, A: int, B: int, view: View, geometry: ContactGeometry) -> real:
    """Scan: the closest point, and the columns of other minima that overlap. Returns the smallest gap [m]."""
    around = model.surfaces.periodic[A] != 0
    spacing = spacing_of(model, A)
    pitch = model.surfaces.pitch[A]
    theta = model.surfaces.theta[A]
    x_at = real(0.5) * real(model.surfaces.columns[A] - 1)
    z_at = section_of(model, A, 0)
    first = real(0.0)
    if around:
        first = x_at - spacing * real(SCAN / 2)
    best = gap_at(model, A, B, view, theta + x_at * pitch, z_at)
    overlaps = Columns()
    count = int(0)
    section = int(0)
    while section < SECTIONS:
        z = section_of(model, A, section)
        before = BEYOND
        here = BEYOND
        if around:
            before = gap_at(model, A, B, view, theta + (first - spacing) * pitch, z)
        i = int(0)
        while i <= SCAN:
            after = BEYOND
            if around or i < SCAN:
                after = gap_at(model, A, B, view, theta + (first + spacing * real(i)) * pitch, z)
            if i > 0:
                if here < before - TIE * model.length and here <= after + TIE * model.length:
                    x = settle(model, A, B, view, first + spacing * real(i - 1), z)
                    g = gap_at(model, A, B, view, theta + x * pitch, z)
                    if g < best - TIE * model.length:
                        best = g
                        x_at = x
                        z_at = z
                    if g < real(0.0) and count < MOST_OVERLAPS:
                        overlaps[count] = x
                        count += 1
                before = here
            here = after
            i += 1
        section += 1
    place = least_place(model, A, B, view, x_at, z_at)
    x_at = place[1]
    low = int(NOWHERE)
    high = int(NOWHERE)
    i = int(0)
    while i < count:
        away = overlaps[i] - x_at
        if around:
            away = wrap_column(model, A, away, real(0.0))
        column = int(wp.floor(x_at + away + real(0.5)))
        if low == NOWHERE:
            low = column
            high = column
        low = wp.min(low, column)
        high = wp.max(high, column)
        i += 1
    geometry.nearest[w, pair, 0] = x_at
    geometry.nearest[w, pair, 1] = place[2]
    geometry.touched[w, pair, 0] = low
    geometry.touched[w, pair, 1] = high
    return place[0]


@wp.func
def has_cells(model: Model, w: int, pair: int, geometry: ContactGeometry) -> bool:
    """Whether a pair is of family 2, and its surfaces are within reach of each other."""
    return model.pairs.family[pair] == PATCH and geometry.window[w, pair, 0] <= geometry.window[w, pair, 1]


@wp.func
def length_of(model: Model, A: int) -> real:
    """Length [m] of the grid of an extruded surface along its curve; of others none."""
    if model.surfaces.planar[A] != EXTRUDED:
        return BEYOND
    return real(model.surfaces.columns[A] - 1 + model.surfaces.periodic[A]) * model.surfaces.pitch[A]


@wp.func
def may_reach(model: Model, A: int, B: int, view: View, reach: real) -> bool:
    """Whether the curve of an extruded A may be nearer to B than `reach` [m] somewhere; true of other kinds.

    The gap changes along a way by no more than its length, and over a width dz by no more than dz times the
    inclination i of the axes and, where the curves are twisted, the twists times the distances from both axes: a place
    with the gap g has none nearer than `reach` within g - reach - i dz. Twisted ones are looked at in several
    sections. A gap far outside B's lattice is overestimated by up to sqrt(2): the foot is that of the nearest place of
    the lattice.
    """
    if model.surfaces.planar[A] != EXTRUDED:
        return True
    low = model.surfaces.z[model.surfaces.z_start[A]]
    high = model.surfaces.z[model.surfaces.z_start[A] + model.surfaces.rows[A] - 1]
    twist_a = wp.abs(twist_of(model, A))
    twist_b = real(0.0)
    inclination = real(1.0)
    if model.surfaces.planar[B] == EXTRUDED:
        inclination = wp.sqrt(view.turn[0, 2] * view.turn[0, 2] + view.turn[1, 2] * view.turn[1, 2])
        twist_b = wp.abs(twist_of(model, B))
    sections = int(1)
    if twist_a + twist_b > real(0.0):
        sections = int(TWISTED)
    dz = real(0.5) * (high - low) / real(sections)
    end = length_of(model, A)
    free = end
    section = int(0)
    while free > end / real(SCAN) and section < sections:
        z = low + dz * real(2 * section + 1)
        u = real(0.0)
        while free > end / real(SCAN) and u < end:
            x = local_point(model, A, model.surfaces.theta[A] + u, z)
            y = view.at + view.turn * x
            change = inclination + twist_a * wp.sqrt(x[0] * x[0] + x[1] * x[1])
            change += twist_b * wp.sqrt(y[0] * y[0] + y[1] * y[1])
            free = DIAGONAL * gap_at(model, A, B, view, model.surfaces.theta[A] + u, z) - reach - change * dz
            u += free
        section += 1
    return free <= end / real(SCAN)


@kernel
def locate_points(run: Run, trial: Trial, geometry: ContactGeometry):
    """Per (world, pair of family 1): closest point, phases, centre columns; `line_of_centres.locate` for the others.

    phase: column on A and B twice (as of the first and last station there), current then new; then B's row and the
    columns by which B's chart rotates along A's width, current then new. nearest: column of A, z [m]. touched: lowest
    and highest column of the minima of the gap that overlap, NOWHERE without.
    """
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or model.pairs.family[pair] != AT_POINTS:
        return
    A = model.pairs.first[pair]
    B = model.pairs.second[pair]
    view = view_of(model, w, pair, trial)
    columns = model.surfaces.columns[A]
    whole = model.surfaces.periodic[A] == 0 and columns <= model.window.columns
    if run.ctl[w].iteration == 0:
        scan(model, w, pair, A, B, view, geometry)
    z = geometry.nearest[w, pair, 1]
    x = settle(model, A, B, view, geometry.nearest[w, pair, 0], z)
    geometry.nearest[w, pair, 0] = x
    x_a = x
    if whole:
        x_a = real((columns - 1) / 2)
    theta = model.surfaces.theta[A] + x_a * model.surfaces.pitch[A]
    x_b = real(0.0)
    row_b = real(0.0)
    turned = real(0.0)
    if model.surfaces.rigid[B] == 0:
        foot = foot_of(model, B, view.at + view.turn * local_point(model, A, theta, z))
        x_b = (foot.theta - model.surfaces.theta[B]) / model.surfaces.pitch[B]
        end = model.surfaces.z[model.surfaces.z_start[A] + model.surfaces.rows[A] - 1]
        if z > real(0.5) * (end + model.surfaces.z[model.surfaces.z_start[A]]):
            end = model.surfaces.z[model.surfaces.z_start[A]]
        other = foot_of(model, B, view.at + view.turn * local_point(model, A, theta, end))
        turned = (other.theta - foot.theta) / model.surfaces.pitch[B]
        middle = real(0.5) * real(model.surfaces.columns[B] - 1)
        if run.ctl[w].iteration > 0:  # stay on the branch of the window
            middle = real(geometry.center[w, pair, 1])
        x_b = wrap_column(model, B, x_b, middle)
        turned = wrap_column(model, B, turned, real(0.0))
        row = row_below(model, B, foot.z)
        z0 = model.surfaces.z_start[B] + row
        row_b = real(row) + (foot.z - model.surfaces.z[z0]) / (model.surfaces.z[z0 + 1] - model.surfaces.z[z0])
    if not (wp.abs(x_a) < FARTHEST and wp.abs(x_b) < FARTHEST):  # also if they are NaN
        run.ctl[w].failure = run.ctl[w].failure | k.NOT_FINITE
        run.ctl[w].run = 0
        return
    largest = wp.max(wp.abs(x_a - geometry.phase[w, pair, 0]), wp.abs(x_b - geometry.phase[w, pair, 1]))
    largest = wp.max(
        largest, wp.max(wp.abs(row_b - geometry.phase[w, pair, 8]), wp.abs(turned - geometry.phase[w, pair, 9]))
    )
    if largest > PHASE_TOLERANCE:
        run.ctl[w].reassemble = 1
    for i in range(2):
        geometry.phase[w, pair, 4 + 2 * i] = x_a
        geometry.phase[w, pair, 5 + 2 * i] = x_b
    geometry.phase[w, pair, 10] = row_b
    geometry.phase[w, pair, 11] = turned
    geometry.center[w, pair, 2] = 0
    drift = wp.max(wp.abs(x_a - real(geometry.center[w, pair, 0])), wp.abs(x_b - real(geometry.center[w, pair, 1])))
    if run.ctl[w].iteration == 0 or drift > DRIFT:
        geometry.center[w, pair, 0] = int(wp.floor(x_a + real(0.5)))
        geometry.center[w, pair, 1] = int(wp.floor(x_b + real(0.5)))
        run.ctl[w].reassemble = 1
        run.ctl[w].recenter = 1


@kernel
def measure_approach(run: Run, trial: Trial, geometry: ContactGeometry):
    """Per (world, pair of family 1), if a state is recorded: smallest undeformed gap and nearest column, stored where
    `record` reads distance and column of the first and the last station of the other pairs."""
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].record == 0 or model.pairs.family[pair] != AT_POINTS:
        return
    A = model.pairs.first[pair]
    view = view_of(model, w, pair, trial)
    place = least_place(
        model, A, model.pairs.second[pair], view, geometry.nearest[w, pair, 0], geometry.nearest[w, pair, 1]
    )
    for end in range(2):
        s = end * ((model.surfaces.rows[A] - 1) * model.quadrature.z_points - 1)
        geometry.station[w, pair, s, 0] = place[0]
        geometry.station[w, pair, s, 1] = geometry.nearest[w, pair, 0]
