"""The cells of a patch: gaps and wrenches at their centres, and the values of both bodies' splines there.

A cell is treated like a node: with the area A_i of the true surface and its centre x_i

    weak gap A_i d_B(x_i),    wrench of a unit pressure A_i f(x_i),    load of spline b of side s: A_i P^s_b(x_i),

f that of `contact_wrench`, d_B the signed distance from B's true surface. Pressures and gaps at centres converge with
the second power of the cell size, as constant pressures do.

**Helical rows.** Where A is helical the line of contact is inclined to its sections: it crosses the flank, over many
widths of the patch. Each row is therefore centred on the nearest point of its own section, from which strips are
counted. Lines of contact of meshing involutes are generators of the surface (`surfaces.helical`), straight, and at
right angles to the curves of the sections: with lengths of rows along the generator, sqrt(1 + (tau q)^2) of those along
the axis, cells are rectangles in the tangent plane as those of other patches. In the chart of arc length u and z, which
has the ends of the flank as lines, a generator has du/dz = -tau rho, rho = c.n, which changes by tau q per z on an
involute; the search starts there.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import ContactGeometry, PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.kinematics.closest_point import BEYOND, View, has_cells, settle, view_of, wrap_column
from warpffrf_kernels.kinematics.contact_wrench import Held, held_section, held_sphere, is_sphere, point_wrench
from warpffrf_kernels.patch.far_splines import TAPS, Taps, column_taps, row_taps
from warpffrf_kernels.surfaces.height import height_at
from warpffrf_kernels.surfaces.helical import rotated, twist_of
from warpffrf_kernels.surfaces.smooth import radius_of, slope_of
from warpffrf_kernels.surfaces.surface import EXTRUDED, HEIGHT, PLANE, Section, axes_of, foot_of, section_at

wp.set_module_options(MODULE_OPTIONS)

ROW_COLUMNS = wp.constant(4)  # of `patch_place`, from here on: column of A in the middle of each row


@wp.func
def row_place(elements: Elements, pair: int, row: int, patch_place: wp.array3d(dtype=real), w: int) -> wp.vec2d:
    """z [m] and length along z [m] of a row."""
    at = elements.patches.row_start[pair] + row
    z = elements.patches.row_z[at]
    length = elements.patches.row_length[at]
    if elements.patches.follows[pair] != 0:
        width = patch_place[w, pair, 2]
        z = patch_place[w, pair, 1] + width * z
        length = width * length
    return wp.vec2d(z, length)


@wp.func
def row_column(model: Model, A: int, B: int, view: View, column: real, middle: real, z: real) -> real:
    """Column of A in the middle of the row at z, from that of the patch at `middle` [m]."""
    twist = twist_of(model, A)
    if model.surfaces.planar[A] != EXTRUDED or twist == real(0.0):
        return column
    at = section_at(model, A, model.surfaces.theta[A] + column * model.surfaces.pitch[A])
    t = wp.normalize(at.slope)
    q = -wp.dot(at.point, t)
    rho = at.point[0] * t[1] - at.point[1] * t[0]
    way = twist * (z - middle)
    shift = -way * (rho + real(0.5) * way * q)
    start = wp.clamp(column + shift / model.surfaces.pitch[A], real(0.0), real(model.surfaces.columns[A] - 1))
    return settle(model, A, B, view, start, z)


@wp.struct
class Row:
    """Data common to all cells of a row: z [m], R [m] and area per strip width [m] of A there, its splines along the
    meridian, and the frame of the contact (`contact_wrench`)."""

    z: real
    radius: real
    length: real
    along: Taps
    held: Held


@kernel
def hold_rows(
    run: Run, trial: Trial, geometry: ContactGeometry, patch: PatchScratch, patch_row: wp.array3d(dtype=Row)
):  # fmt: skip
    """Per (world, pair of family 2), lanes over rows: data common to their cells; and the contact frame of a
    sphere."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not has_cells(model, w, pair, geometry):
        return
    elements = model.elements[0]
    A = elements.patches.first[pair]
    B = elements.patches.second[pair]
    view = view_of(model, w, pair, trial)
    ball = is_sphere(model, A)
    if ball and lane == 0:
        patch.patch_ball[w, pair] = held_sphere(model, B, view.at, view.turn)
    last = model.surfaces.z_start[A] + model.surfaces.rows[A] - 1
    row = lane
    while row < model.surfaces.rows[model.pairs.first[pair]]:
        place = row_place(elements, pair, row, patch.patch_place, w)
        found = Row()
        found.z = place[0]
        found.radius = radius_of(model, A, found.z)
        slope = slope_of(model, A, found.z)
        column = row_column(model, A, B, view, patch.patch_place[w, pair, 0], patch.patch_place[w, pair, 1], found.z)
        if model.surfaces.planar[A] == EXTRUDED:
            at = section_at(model, A, model.surfaces.theta[A] + column * model.surfaces.pitch[A])
            slope = twist_of(model, A) * wp.dot(at.point, wp.normalize(at.slope))
        patch.patch_place[w, pair, ROW_COLUMNS + row] = column
        found.length = found.radius * place[1] * wp.sqrt(real(1.0) + slope * slope)
        if found.z < model.surfaces.z[model.surfaces.z_start[A]] or found.z > model.surfaces.z[last]:
            found.length = real(0.0)
        if elements.patches.far_of[A] >= 0:
            found.along = row_taps(model, elements, A, found.z)
        if model.surfaces.planar[A] != PLANE and model.surfaces.planar[A] != HEIGHT and not ball:
            found.held = held_section(model, A, B, view.at, view.turn, column, found.z)
        patch_row[w, pair, row] = found
        row += wp.block_dim()


@wp.func
def place_splines(
    around: Taps, along: Taps, area: real, at: int, far_at: wp.array(dtype=int), far_weight: wp.array(dtype=real)
):
    """Loads on the splines of a surface due to a unit pressure on a cell; entry `at` of all pairs and sides."""
    far_at[2 * at] = around.first
    far_at[2 * at + 1] = along.first
    for i in range(3):
        part = area * around.value[i]
        for j in range(3):
            far_weight[9 * at + 3 * i + j] = part * along.value[j]


@kernel
def sample_cells(
    run: Run, trial: Trial, geometry: ContactGeometry, patch: PatchScratch, patch_row: wp.array3d(dtype=Row),
    weak_gap: wp.array(dtype=real), area: wp.array(dtype=real), wrench: wp.array(dtype=real),
    more_wrench: wp.array(dtype=real), far_at: wp.array(dtype=int), far_weight: wp.array(dtype=real),
):  # fmt: skip
    """Per (world, pair of family 2), lanes over cells: weak gap, area (0 without an opposite surface), wrench, loads on
    splines."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not has_cells(model, w, pair, geometry):
        return
    elements = model.elements[0]
    A = elements.patches.first[pair]
    B = elements.patches.second[pair]
    view = view_of(model, w, pair, trial)
    back = wp.transpose(view.turn)
    arm_a = wp.transpose(model.surfaces.frame[A]) * model.surfaces.origin[A]
    turn = axes_of(trial.axes, w, model.surfaces.body[A]) * model.surfaces.frame[A]
    columns = elements.patches.columns[pair]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    radius = radius_of(model, A, patch.patch_place[w, pair, 1])
    strip = (
        real(2.0) * patch.patch_place[w, pair, 2] / (real(columns) * radius * model.surfaces.pitch[A])
    )  # columns of A
    last_b = model.surfaces.z_start[B] + model.surfaces.rows[B] - 1
    first = (w * model.pairs.count + pair) * model.window.grid_nodes
    twist = real(0.0)
    if model.surfaces.planar[A] == EXTRUDED:
        twist = twist_of(model, A)
    x_a = real(BEYOND)
    theta = real(0.0)
    cosine = real(0.0)
    sine = real(0.0)
    curve = Section()
    around = Taps()
    m = lane
    while m < columns * rows:
        column = m / rows
        x = patch.patch_place[w, pair, ROW_COLUMNS + m - column * rows]
        x += (real(column) - real(0.5) * real(columns - 1)) * strip
        if x != x_a:  # a lane of a CPU processes the cells of a strip consecutively
            x_a = x
            theta = model.surfaces.theta[A] + x_a * model.surfaces.pitch[A]
            if model.surfaces.planar[A] == EXTRUDED:
                curve = section_at(model, A, theta)
            else:
                cosine = wp.cos(theta)
                sine = wp.sin(theta)
            if elements.patches.far_of[A] >= 0:
                around = column_taps(model, elements, A, x_a)
        row = patch_row[w, pair, m - column * rows]
        size = strip * model.surfaces.pitch[A] * row.length
        at = vec3(row.radius * cosine, row.radius * sine, row.z)
        way = vec3(-at[1], at[0], real(0.0))
        if model.surfaces.planar[A] == EXTRUDED:
            at = rotated(vec3(curve.point[0], curve.point[1], row.z), twist * row.z)
            way = rotated(vec3(curve.slope[0], curve.slope[1], real(0.0)), twist * row.z)
        elif model.surfaces.planar[A] == HEIGHT:
            place = height_at(model, A, theta, row.z)
            at = vec3(place.value, theta, row.z)
            size *= wp.sqrt(real(1.0) + wp.dot(place.slope, place.slope))
        elif model.surfaces.planar[A] != 0:
            at = vec3(real(0.0), theta, row.z)
        foot = foot_of(model, B, view.at + view.turn * at)
        x_b = (foot.theta - model.surfaces.theta[B]) / model.surfaces.pitch[B]
        x_b = wrap_column(model, B, x_b, patch.patch_place[w, pair, 3])
        if model.surfaces.periodic[A] == 0 and (x_a < real(0.0) or x_a > real(model.surfaces.columns[A] - 1)):
            size = real(0.0)
        if model.surfaces.rigid[B] == 0:
            if foot.z < model.surfaces.z[model.surfaces.z_start[B]] or foot.z > model.surfaces.z[last_b]:
                size = real(0.0)
            if model.surfaces.periodic[B] == 0 and (x_b < real(0.0) or x_b > real(model.surfaces.columns[B] - 1)):
                size = real(0.0)
        unit = point_wrench(model, A, at, way, back * foot.normal, row.held, patch.patch_ball[w, pair])
        force = turn * unit.force
        moment = turn * (unit.moment + wp.cross(arm_a, unit.force))
        more_force = turn * unit.more_force
        more_moment = turn * (unit.more_moment + wp.cross(arm_a, unit.more_force))
        cell = first + m
        weak_gap[cell] = size * foot.distance
        area[cell] = size
        for i in range(3):
            wrench[6 * cell + i] = size * force[i]
            wrench[6 * cell + 3 + i] = size * moment[i]
            more_wrench[6 * cell + i] = size * more_force[i]
            more_wrench[6 * cell + 3 + i] = size * more_moment[i]
        if elements.patches.far_of[A] >= 0:
            place_splines(around, row.along, size, cell + first, far_at, far_weight)
        if elements.patches.far_of[B] >= 0:
            place_splines(
                column_taps(model, elements, B, x_b), row_taps(model, elements, B, foot.z), size,
                cell + first + model.window.grid_nodes, far_at, far_weight,
            )  # fmt: skip
        m += wp.block_dim()


@kernel
def open_far_windows(run: Run, geometry: ContactGeometry, patch: PatchScratch):
    """Per (world, pair of family 2): first column and number of columns of the splines under the cells, by side. A
    patch that covers more of them than the capacity ends the attempt."""
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not has_cells(model, w, pair, geometry):
        return
    elements = model.elements[0]
    cells = elements.patches.columns[pair] * model.surfaces.rows[model.pairs.first[pair]]
    for side in range(2):
        s = elements.patches.first[pair]
        if side == 1:
            s = elements.patches.second[pair]
        low = int(0)
        high = int(-1)
        if elements.patches.far_of[s] >= 0:
            low = patch.far_at[w, pair, side * model.window.grid_nodes, 0]
            high = low
            m = int(0)
            while m < cells:
                at = patch.far_at[w, pair, side * model.window.grid_nodes + m, 0]
                low = wp.min(low, at)
                high = wp.max(high, at)
                m += 1
            high += TAPS - 1
            most = elements.patches.far_nodes / model.surfaces.rows[s]
            if high - low + 1 > most:
                run.ctl[w].failure = run.ctl[w].failure | k.CAPACITY
                high = low + most - 1
                m = int(0)
                while m < cells:
                    at = side * model.window.grid_nodes + m
                    patch.far_at[w, pair, at, 0] = wp.min(patch.far_at[w, pair, at, 0], high - TAPS + 1)
                    m += 1
        patch.far_window[w, pair, side, 0] = low
        patch.far_window[w, pair, side, 1] = high - low + 1
