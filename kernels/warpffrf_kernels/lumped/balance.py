"""What lumped contacts add to the system of retained coordinates, and what a step stores of them.

Forces at their points (`forces`) and moments that resist rolling and pivoting (`moments`) act on both bodies, equal and
opposite; the matrix has their changes with a unit of each rigid coordinate of both.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.ring import SavedLumped
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, sync, vec3
from warpffrf_kernels.core.scratch import Residuals, RetainedSystem, Trial
from warpffrf_kernels.core.state import LumpedState, MotionState
from warpffrf_kernels.lumped.forces import Load, answer_to, motion_of, tangential
from warpffrf_kernels.lumped.moments import Moment, change_of
from warpffrf_kernels.lumped.places import side_in_world

wp.set_module_options(MODULE_OPTIONS)

EXPECTED = wp.constant(wp.float64(1.0e-4))  # of the force: a force this close to the expected one has the law's slope
MOST_EXPECTED = wp.constant(wp.float64(1.0e12))  # of the force, so that slopes stay finite


@kernel
def push_lumped(
    run: Run, trial: Trial, residuals: Residuals, lumped: LumpedState, lumped_load: wp.array2d(dtype=Load),
    lumped_moment: wp.array2d(dtype=Moment),
):  # fmt: skip
    """Per world, lanes over bodies: subtract the forces and moments of all points from their residuals."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    place = int(0)
    while place < model.elements[0].lumped.places:
        if lumped.lumped_force[w, 1, place] > real(0.0):
            load = lumped_load[w, place]
            contact = model.elements[0].lumped.contact[place]
            f = load.force * load.touch.n + load.friction
            resisting = model.elements[0].lumped.moment[place]
            M = vec3(real(0.0))
            if resisting >= 0:
                M = lumped_moment[w, resisting].total
            for side in range(2):
                s = model.elements[0].lumped.first[contact]
                if side == 1:
                    s = model.elements[0].lumped.second[contact]
                    f = -f
                    M = -M
                b = model.surfaces.body[s]
                if b >= 0 and b % wp.block_dim() == lane:
                    moment = wp.transpose(trial.axes[w, b]) * (wp.cross(load.touch.x - trial.r1[w, b], f) + M)
                    for c in range(3):
                        residuals.residual[w, 6 * b + c] = residuals.residual[w, 6 * b + c] - f[c]
                        residuals.residual[w, 6 * b + 3 + c] = residuals.residual[w, 6 * b + 3 + c] - moment[c]
        place += 1


@wp.func
def add_column(
    w: int, body: int, column: int, A: mat33, dr: vec3, phi: vec3, d: vec3, dx: vec3, f: vec3, df: vec3, M: vec3,
    dM: vec3, tangent: wp.array3d(dtype=real),
):  # fmt: skip
    """Adds the change of the residual of a body to a column: -f at d from its centre of mass, which moves by dr while
    the point moves by dx and the body rotates by phi, and the moment -M."""
    change = wp.cross(dx - dr, f) + wp.cross(d, df) + dM
    moment = wp.transpose(A) * (change + wp.cross(wp.cross(d, f) + M, phi))
    row = 6 * body
    for i in range(3):
        tangent[w, row + i, column] = tangent[w, row + i, column] - df[i]
        tangent[w, row + 3 + i, column] = tangent[w, row + 3 + i, column] - moment[i]


@wp.func
def slope_share(model: Model, w: int, first: int, lumped_load: wp.array2d(dtype=Load)) -> real:
    """Slope towards the expected force of a contact, over its tangent; `first`: its first point. See `forces`."""
    contact = model.elements[0].lumped.contact[first]
    force = real(0.0)
    expected = real(0.0)
    slope = real(0.0)
    approach = real(0.0)
    place = first
    inside = int(1)
    while inside != 0:
        force += lumped_load[w, place].force
        expected += lumped_load[w, place].expected
        slope += lumped_load[w, place].by_approach
        approach = wp.max(approach, -lumped_load[w, place].touch.gap)
        place += 1
        inside = int(0)
        if place < model.elements[0].lumped.places:
            if model.elements[0].lumped.contact[place] == contact:
                inside = int(1)
    if force == real(0.0) or expected == real(0.0) or model.elements[0].lumped.table_count[contact] != 0:
        return real(1.0)
    part = wp.clamp(expected / force, real(0.0), MOST_EXPECTED)
    if wp.abs(part - real(1.0)) <= EXPECTED:
        return real(1.0)
    power = slope * approach / force
    return (real(1.0) - part) / (power * (real(1.0) - wp.pow(part, real(1.0) / power)))


@wp.func
def take_slope(
    model: Model, w: int, first: int, lumped: LumpedState, lumped_load: wp.array2d(dtype=Load)
):  # fmt: skip
    """Slopes of the points of a contact, from its `first` on, towards the expected force."""
    share = slope_share(model, w, first, lumped_load)
    contact = model.elements[0].lumped.contact[first]
    place = first
    while place < model.elements[0].lumped.places and model.elements[0].lumped.contact[place] == contact:
        if lumped.lumped_force[w, 1, place] > real(0.0):
            lumped_load[w, place].by_approach = share * lumped_load[w, place].by_approach
        place += 1


@wp.func
def has_column(model: Model, surface: int, lane: int) -> bool:
    """Whether one of the six columns of the body of a surface is a lane's."""
    b = model.surfaces.body[surface]
    return b >= 0 and (lane - 6 * b % wp.block_dim() + wp.block_dim()) % wp.block_dim() < wp.min(6, wp.block_dim())


@kernel
def stiffen_lumped(
    run: Run, state: MotionState, trial: Trial, lumped: LumpedState, system: RetainedSystem,
    lumped_load: wp.array2d(dtype=Load), lumped_moment: wp.array2d(dtype=Moment),
):  # fmt: skip
    """Per world, lanes over columns: add the tangent of the forces and moments of all points in contact to the retained
    matrix."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or run.ctl[w].refresh == 0:
        return
    vel = run.clk[w].retained.vel
    place = lane
    while place < model.elements[0].lumped.places:
        if place == 0 or model.elements[0].lumped.contact[place] != model.elements[0].lumped.contact[place - 1]:
            take_slope(model, w, place, lumped, lumped_load)
        place += wp.block_dim()
    sync()
    place = int(0)
    while place < model.elements[0].lumped.places:
        contact = model.elements[0].lumped.contact[place]
        own_columns = has_column(model, model.elements[0].lumped.first[contact], lane)
        own_columns = own_columns or has_column(model, model.elements[0].lumped.second[contact], lane)
        if own_columns and lumped.lumped_force[w, 1, place] > real(0.0):
            load = lumped_load[w, place]
            first = side_in_world(model, w, model.elements[0].lumped.first[contact], trial)
            second = side_in_world(model, w, model.elements[0].lumped.second[contact], trial)
            known = int(0)
            if lumped.lumped_force[w, 0, place] > real(0.0):
                known = int(1)
            x = load.touch.x
            before = lumped.lumped_at[w, 0, place]
            one = motion_of(first, w, x, before, known, state, trial)
            two = motion_of(second, w, x, before, known, state, trial)
            f = load.force * load.touch.n + load.friction
            old_normal = lumped.lumped_normal[w, 0, place]
            resisting = model.elements[0].lumped.moment[place]
            resistance = Moment()
            if resisting >= 0:
                resistance = lumped_moment[w, resisting]
            spin = one.omega - two.omega
            turn = one.share * one.turn - two.share * two.turn
            for moves in range(2):
                side = first
                own = one
                sign = real(1.0)
                if moves == 1:
                    side = second
                    own = two
                    sign = real(-1.0)
                coordinate = int(0)
                while side.body >= 0 and coordinate < 6:
                    column = 6 * side.body + coordinate
                    if column % wp.block_dim() != lane:
                        coordinate += 1
                        continue
                    by = answer_to(model, contact, old_normal, load, side, own, sign, spin, turn, coordinate, vel)
                    dM = vec3(real(0.0))
                    if resisting >= 0 and run.ctl[w].mode != k.STATIC:
                        dM = change_of(model, resisting, load, resistance, by.force, by.n, by.turning)
                    dr = vec3(real(0.0))
                    phi = vec3(real(0.0))
                    if coordinate < 3:
                        dr[coordinate] = real(1.0)
                    else:
                        phi = vec3(side.A[0, coordinate - 3], side.A[1, coordinate - 3], side.A[2, coordinate - 3])
                    on_first = real(0.5) * (real(1.0) + sign)
                    on_second = real(0.5) * (real(1.0) - sign)
                    if first.body >= 0:
                        add_column(
                            w, first.body, column, first.A, on_first * dr, on_first * phi, x - first.r, by.x, f, by.f,
                            resistance.total, dM, system.tangent,
                        )  # fmt: skip
                    if second.body >= 0:
                        add_column(
                            w, second.body, column, second.A, on_second * dr, on_second * phi, x - second.r, by.x, -f,
                            -by.f, -resistance.total, -dM, system.tangent,
                        )  # fmt: skip
                    coordinate += 1
        place += 1


@kernel
def keep_lumped(run: Run, lumped: LumpedState):
    """Per world, lanes over points: the trial state becomes the accepted one; the tiny step of PROJECT is not
    stored."""
    w, lane = wp.tid()
    if run.ctl[w].accept == 0 or run.ctl[w].mode == k.PROJECT:
        return
    place = lane
    while place < lumped.lumped_force.shape[2]:
        lumped.lumped_force[w, 0, place] = lumped.lumped_force[w, 1, place]
        lumped.lumped_friction[w, 0, place] = lumped.lumped_friction[w, 1, place]
        lumped.lumped_normal[w, 0, place] = lumped.lumped_normal[w, 1, place]
        lumped.lumped_at[w, 0, place] = lumped.lumped_at[w, 1, place]
        lumped.lumped_shear[w, 0, place] = lumped.lumped_shear[w, 1, place]
        lumped.lumped_energy[w, 0, place] = lumped.lumped_energy[w, 1, place]
        lumped.lumped_approach[w, 0, place] = lumped.lumped_approach[w, 1, place]
        lumped.lumped_gained[w, 0, place] = lumped.lumped_gained[w, 1, place]
        for i in range(2):
            lumped.lumped_power[w, 0, place, i] = lumped.lumped_power[w, 1, place, i]
        place += wp.block_dim()


@kernel
def record_lumped(run: Run, saved: SavedLumped, lumped_load: wp.array2d(dtype=Load)):
    """Per world, lanes over points: NUMBERS of the accepted state."""
    w, lane = wp.tid()
    if run.ctl[w].record == 0:
        return
    at = run.ctl[w].saved % saved.saved_lumped.shape[1]
    place = lane
    while place < saved.saved_lumped.shape[2]:
        load = lumped_load[w, place]
        f = load.force * load.touch.n + load.friction
        v = tangential(load.touch.n, load.velocity)
        for i in range(3):
            saved.saved_lumped[w, at, place, i] = load.touch.x[i]
            saved.saved_lumped[w, at, place, 3 + i] = f[i]
            saved.saved_lumped[w, at, place, 6 + i] = load.friction[i]
            saved.saved_lumped[w, at, place, 9 + i] = v[i]
        saved.saved_lumped[w, at, place, 12] = -load.touch.gap
        saved.saved_lumped[w, at, place, 13] = load.force
        place += wp.block_dim()


@kernel
def record_moments(run: Run, saved: SavedLumped, lumped_moment: wp.array2d(dtype=Moment)):
    """Per (world, point with moments): the moment on the first body of the accepted state."""
    w, i = wp.tid()
    if run.ctl[w].record == 0:
        return
    saved.saved_lumped_moment[w, run.ctl[w].saved % saved.saved_lumped_moment.shape[1], i] = lumped_moment[w, i].total
