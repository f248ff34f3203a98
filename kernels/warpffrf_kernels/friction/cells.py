r"""Friction cells in the window of a pair: positions, areas, and rigid-body slip.

A cell (j, k) surrounds the node (j, k) of the first surface's grid. The tangential traction tau (2,) on the first body
is constant on it, with components along (e_theta, t_z) there. Numbers of a cell and direction d are stored at
column*2*rows + d*rows + row, so the columns of a window are one contiguous run.

Rigid slip of a step. Let y_k(t) be the point of the second true surface opposite the centre x_k of a cell, along the
common normal c of the pair (that of its force at the end of the last step; along the normal of the first surface if one
of the two is an inside form),
and (theta, z) its coordinates in the chart of the second surface. Sticking material keeps its opposite point, so the
step's slip of the first surface relative to the second is the path of y_k over the second body's *material*,

    s_k = R_B (theta(t1) - theta(t0)) e_theta^B + (z(t1) - z(t0)) (R_B' e_r + e_a),

arc lengths of the undeformed surfaces: for two rollers (Omega_A R_A - Omega_B R_B) h to all orders in the angle, since
the opposite point has the same coordinate across c. Both points are computed from the two poses of the step, so a cell
that enters the patch has the creep of the *whole* step, as Carter's solution requires.

Directions of the tractions are (e_theta, t_z) projected onto the plane normal to c if both forms are convex: that is
the tangent plane of the deformed surfaces, which contains all of a patch. In gross slip, friction is then mu times the
normal force and perpendicular to it, for any width and position of the patch. Inside forms are conformal, and their
tractions follow the surface.

The traction acts half way between the two true surfaces; its wrench on the first body, per unit traction, is also the
gradient of the weak slip `S_k = area_k s_k` with respect to a motion of the first body relative to the second.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionCells
from warpffrf_kernels.core.model import PATCH, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.core.state import FrictionState, MotionState
from warpffrf_kernels.kinematics.line_of_centres import wrap
from warpffrf_kernels.surfaces.helical import twist_of
from warpffrf_kernels.surfaces.responses import own_load, place_in_table
from warpffrf_kernels.surfaces.smooth import Foot, period_of, radius_of, slope_of
from warpffrf_kernels.surfaces.surface import (
    EXTRUDED,
    HEIGHT,
    around_of,
    axes_of,
    foot_of,
    local_normal,
    local_point,
    origin_of,
)

wp.set_module_options(MODULE_OPTIONS)

STEEPEST = wp.constant(wp.float64(0.1))  # cosine between c and the second normal: cells beyond are far from any patch
# columns that the grids may move relative to each other before the compliance of the cells is reassembled: it changes
# by about this fraction, and is used as a tangent only
PHASE_TOLERANCE = wp.constant(wp.float64(1.0e-2))


@wp.func
def rubs_on_grid(model: Model, pair: int) -> bool:
    """Whether a pair has friction on cells of the first surface's grid, fixed to its material."""
    return model.pairs.friction[pair] > real(0.0) and model.pairs.family[pair] != PATCH


@wp.func
def rubs_on_patch(model: Model, pair: int) -> bool:
    """Whether a pair has friction on contact-fixed cells (package `rolling`)."""
    return model.pairs.friction[pair] > real(0.0) and model.pairs.family[pair] == PATCH


@wp.func
def cell_at(rows: int, m: int, d: int) -> int:
    """Index of cell m, direction d in tangential arrays, see the module docstring."""
    return (m / rows) * 2 * rows + d * rows + m % rows


@wp.func
def opposite(model: Model, B: int, origin: vec3, frame: mat33, x: vec3, c: vec3) -> vec3:
    """Chart coordinates (theta, z) on surface B opposite the world point x along c, and the gap along c."""
    local = wp.transpose(frame) * (x - origin)
    along = wp.transpose(frame) * c
    gap = real(0.0)
    near = Foot()
    n = int(0)
    while n < 2:  # one call of `foot_of` in the code: of several, each would be a copy of the whole model
        near = foot_of(model, B, local + gap * along)
        if n == 0:
            gap = near.distance / wp.max(-wp.dot(along, near.normal), STEEPEST)
        n += 1
    return vec3(near.theta, near.z, gap)


@kernel
def open_cells(
    run: Run, geometry: ContactGeometry, cells: FrictionCells, friction: FrictionState,
    friction_offset: wp.array2d(dtype=real),
):  # fmt: skip
    """Per (world, pair): moves the tractions of the last attempt to the present window (as `open_window` does with the
    pressures); decides whether the compliance of the cells is reassembled."""
    w, pair = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not rubs_on_grid(model, pair):
        return
    moved = real(0.0)
    for i in range(4):
        moved = wp.max(moved, wp.abs(geometry.phase[w, pair, 4 + i] - cells.cell_phase[w, pair, i]))
    if run.ctl[w].iteration == 0 or run.ctl[w].recenter != 0 or not (moved < PHASE_TOLERANCE):
        run.ctl[w].stale = 1
        for i in range(4):
            cells.cell_phase[w, pair, i] = geometry.phase[w, pair, 4 + i]
    rows = model.surfaces.rows[model.pairs.first[pair]]
    offset = real(0.5) * (geometry.phase[w, pair, 4] + geometry.phase[w, pair, 6]) - real(geometry.center[w, pair, 0])
    shift = int(wp.floor(offset - friction_offset[w, pair] + real(0.5))) * 2 * rows
    if shift == 0:
        return
    friction_offset[w, pair] = offset
    size = model.window.columns * 2 * rows
    n = int(0)
    while n < size:
        to = n
        if shift > 0:
            to = size - 1 - n
        source = to - shift
        value = real(0.0)
        if source >= 0 and source < size:
            value = friction.traction[w, pair, source]
            if not wp.isfinite(value):  # left by a rejected attempt
                value = real(0.0)
        friction.traction[w, pair, to] = value
        n += 1


@wp.struct
class Sight:
    """Both surfaces of a pair at the start and the end of a step: origins and axes of their frames, and the common
    normal; `inside` is 1 if one of the two is an inside form."""

    at_a: vec3
    at_b: vec3
    turn_a: mat33
    turn_b: mat33
    at_a0: vec3
    at_b0: vec3
    turn_a0: mat33
    turn_b0: mat33
    origin: vec3  # of the first body
    normal: vec3
    inside: int


@wp.struct
class Place:
    """A cell: its position on the second surface (theta, z), components of that surface's tangents in those of the
    first, its own tangents u_1, u_2, the arm of its tractions about the first body's origin, and its rigid slip."""

    theta: real
    z: real
    turn: wp.vec4d
    u_1: vec3
    u_2: vec3
    arm: vec3
    slip_1: real
    slip_2: real


@wp.func
def look(
    model: Model, w: int, A: int, B: int, state: MotionState, trial: Trial, known: vec3, theta: real, z: real
) -> Sight:
    """The surfaces A and B of a pair; `known`: the common normal, zero before the first contact; then that of A at
    (theta, z) is used."""
    a = model.surfaces.body[A]
    b = model.surfaces.body[B]
    axes_a = axes_of(trial.axes, w, a)
    axes_b = axes_of(trial.axes, w, b)
    before_a = wp.identity(n=3, dtype=real)
    before_b = wp.identity(n=3, dtype=real)
    if a >= 0:
        before_a = wp.quat_to_matrix(state.p[w, a])
    if b >= 0:
        before_b = wp.quat_to_matrix(state.p[w, b])
    s = Sight()
    s.origin = origin_of(trial.r1, w, a)
    s.turn_a = axes_a * model.surfaces.frame[A]
    s.turn_b = axes_b * model.surfaces.frame[B]
    s.at_a = s.origin + axes_a * model.surfaces.origin[A]
    s.at_b = origin_of(trial.r1, w, b) + axes_b * model.surfaces.origin[B]
    s.turn_a0 = before_a * model.surfaces.frame[A]
    s.turn_b0 = before_b * model.surfaces.frame[B]
    s.at_a0 = origin_of(state.r, w, a) + before_a * model.surfaces.origin[A]
    s.at_b0 = origin_of(state.r, w, b) + before_b * model.surfaces.origin[B]
    if model.surfaces.side[A] < real(0.0) or model.surfaces.side[B] < real(0.0):
        s.inside = int(1)
    s.normal = known
    if wp.length(known) == real(0.0):
        s.normal = s.turn_a * local_normal(model, A, theta, z)
    return s


@wp.func
def find_cell(model: Model, A: int, B: int, s: Sight, theta: real, z: real) -> Place:
    """The cell whose centre is the point (theta, z) of surface A."""
    point = local_point(model, A, theta, z)
    n = local_normal(model, A, theta, z)
    t_1 = around_of(n)
    t_2 = wp.cross(n, t_1)
    x = s.at_a + s.turn_a * point
    c = s.normal
    c_0 = c
    if s.inside != 0:
        c = s.turn_a * n
        c_0 = s.turn_a0 * n
    origin = s.at_b0
    frame = s.turn_b0
    y = s.at_a0 + s.turn_a0 * point
    along_c = c_0
    now = vec3()
    then = vec3()
    i = int(0)
    while i < 2:  # at the start of the step, then at its end
        then = now
        now = opposite(model, B, origin, frame, y, along_c)
        origin = s.at_b
        frame = s.turn_b
        y = x
        along_c = c
        i += 1
    n_b = local_normal(model, B, now[0], now[1])
    around = around_of(n_b)
    grown = now[0] - then[0]
    R = real(1.0)
    along = vec3(real(0.0), real(0.0), real(1.0))
    period = period_of(model, B)
    if period > real(0.0):
        grown = wrap(grown, period, real(0.0))
    if model.surfaces.planar[B] == 0:
        R = radius_of(model, B, now[1])
        slope = slope_of(model, B, now[1])
        along = vec3(slope * wp.cos(now[0]), slope * wp.sin(now[0]), real(1.0))
    if model.surfaces.planar[B] == EXTRUDED:
        own = local_point(model, B, now[0], now[1])
        along = vec3(-twist_of(model, B) * own[1], twist_of(model, B) * own[0], real(1.0))
    if model.surfaces.planar[B] == HEIGHT:
        R = wp.sqrt(n_b[0] * n_b[0] + n_b[1] * n_b[1]) / n_b[0]
        along[0] = -n_b[2] / n_b[0]
    slip = s.turn_b * (model.surfaces.side[B] * R * grown * around + (now[1] - then[1]) * along)
    u_1 = s.turn_a * t_1
    u_2 = s.turn_a * t_2
    if s.inside == 0:  # the line of centres is the normal of the deformed surfaces
        u_1 = wp.normalize(u_1 - wp.dot(u_1, c) * c)
        u_2 = wp.normalize(wp.cross(wp.sign(wp.dot(s.turn_a * n, c)) * c, u_1))
    v_1 = s.turn_b * around
    v_2 = s.turn_b * wp.cross(n_b, around)
    found = Place()
    found.theta = now[0]
    found.z = now[1]
    # the second surface's tangents span the same plane up to the angle between the normals, an error of 1 - cos of it
    found.turn = wp.vec4d(wp.dot(u_1, v_1), wp.dot(u_1, v_2), wp.dot(u_2, v_1), wp.dot(u_2, v_2))
    found.u_1 = u_1
    found.u_2 = u_2
    found.arm = x + real(0.5) * now[2] * c - s.origin
    found.slip_1 = wp.dot(u_1, slip)
    found.slip_2 = wp.dot(u_2, slip)
    return found


@wp.func
def keep_cell(w: int, pair: int, rows: int, m: int, area: real, found: Place, cells: FrictionCells):
    """Stores the data common to all cells: area, rotation, wrench per unit traction, rigid slip."""
    cells.cell_area[w, pair, m] = area
    for i in range(4):
        cells.cell_turn[w, pair, m, i] = found.turn[i]
    cells.rigid_slip[w, pair, cell_at(rows, m, 0)] = found.slip_1
    cells.rigid_slip[w, pair, cell_at(rows, m, 1)] = found.slip_2
    first = wp.cross(found.arm, found.u_1)
    second = wp.cross(found.arm, found.u_2)
    for i in range(3):
        cells.cell_wrench[w, pair, cell_at(rows, m, 0), i] = area * found.u_1[i]
        cells.cell_wrench[w, pair, cell_at(rows, m, 0), 3 + i] = area * first[i]
        cells.cell_wrench[w, pair, cell_at(rows, m, 1), i] = area * found.u_2[i]
        cells.cell_wrench[w, pair, cell_at(rows, m, 1), 3 + i] = area * second[i]


@kernel
def place_cells(
    run: Run, geometry: ContactGeometry, state: MotionState, trial: Trial, friction: FrictionState, cells: FrictionCells
):
    """Per (world, pair), lanes over the cells of the window: area, opposite grid point (column, row coordinate) on the
    second surface, components of its tangents in those of the first, wrench per unit traction, displacement by a unit
    traction of their own, and rigid slip."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not rubs_on_grid(model, pair):
        return
    A = model.pairs.first[pair]
    B = model.pairs.second[pair]
    rows = model.surfaces.rows[A]
    H = model.window.half
    middle = model.surfaces.theta[A] + real(geometry.center[w, pair, 0]) * model.surfaces.pitch[A]
    z = model.surfaces.z[model.surfaces.z_start[A] + rows / 2]
    s = look(model, w, A, B, state, trial, friction.contact_normal[w, pair], middle, z)
    table = model.responses.tangential[own_load(model, 2 * pair)]
    m = (geometry.window[w, pair, 0] + H) * rows + lane
    while m < (geometry.window[w, pair, 1] + H + 1) * rows:
        column = geometry.center[w, pair, 0] + m / rows - H
        row = m % rows
        area = model.surfaces.cell_area[model.surfaces.z_start[A] + row]
        if model.surfaces.periodic[A] == 0 and (column < 0 or column >= model.surfaces.columns[A]):
            area = real(0.0)
        theta = model.surfaces.theta[A] + real(column) * model.surfaces.pitch[A]
        found = find_cell(model, A, B, s, theta, model.surfaces.z[model.surfaces.z_start[A] + row])
        keep_cell(w, pair, rows, m, area, found, cells)
        cells.cell_own[w, pair, m] = area * model.responses.number[place_in_table(model, table, 0, row, 0) + row]
        cells.cell_place[w, pair, m, 0] = (found.theta - model.surfaces.theta[B]) / model.surfaces.pitch[B]
        cells.cell_place[w, pair, m, 1] = found.z
        m += wp.block_dim()
