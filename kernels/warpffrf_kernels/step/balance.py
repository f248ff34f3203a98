"""Convergence of the Newton loop: residuals as fractions of the current forces and lengths.

A torque is measured by the equivalent force at the body's radius of gyration. Round-off of sums of large cancelling
terms (accelerations from increments, point forces as of a bolt, joint forces on the modes) does not prevent
convergence.
"""

import warp as wp

from warpffrf_kernels.bodies.interfaces import marker_of
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.declaration import kernel_in_place
from warpffrf_kernels.core.film_scratch import FilmScratch
from warpffrf_kernels.core.lanes import most, mosts, total, values
from warpffrf_kernels.core.matched_scratch import MatchedScratch
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3
from warpffrf_kernels.core.scratch import Residuals, Trial
from warpffrf_kernels.core.state import ContactState, LoadState, LumpedState

wp.set_module_options(MODULE_OPTIONS)

# Residual below which the matrix of the last iteration is reused: within an attempt it mostly changes by less than
# 1e-4, which is the error of a solve with it.
REFRESH_ABOVE = wp.constant(wp.float64(1.0e-5))
SLOW = wp.constant(wp.float64(0.1))  # of the previous residual: above it the matrix is not reused
# of the coordinates: lower bound of the scale of joint defects, or round-off would exceed the tolerance
SHORT = wp.constant(wp.float64(1.0e-5))
# of accelerations, times the residual tolerance: a few digits above machine precision
ROUND_OFF = wp.constant(wp.float64(1.0e-6))
# of point forces, and of a joint's force on the modes: round-off of their sums over the tolerance
CANCELLED = wp.constant(wp.float64(1.0e-5))
# of the forces of cells on a body or a mode, which may cancel: cells are stiff, and round-off of positions is visible
CELLS = wp.constant(wp.float64(0.1))
# of the force that moves a body by the scene's length in a step: below round-off where no force acts
NO_FORCE = wp.constant(wp.float64(1.0e-29))
STILL = wp.constant(wp.float64(1.0e-11))  # of the increments of a load step, and ...
ROUNDED = wp.constant(wp.float64(1.0e-15))  # ... of the coordinates: smaller motion between rounds counts as rest
CLOSER = wp.constant(wp.float64(100.0))  # joint interface forces converge more tightly, as other forces finally do
NONE = wp.constant(wp.float64(1.0e-300))  # keeps fractions finite where bodies have almost no mass


@wp.func
def gyration_of(J: mat33, mass: real) -> real:
    """Mean radius of gyration: a torque is measured by the equivalent force at it, also for a slender body."""
    return wp.sqrt(wp.trace(J) / (real(3.0) * mass))


@wp.func
def arm_of(model: Model, row: int) -> real:
    """1 for a row that is a length, the length of the scene [m] for an angle: converts between them."""
    kind = model.rows.kind[row]
    if kind == k.TRANSLATION or kind == k.DISTANCE:
        return real(1.0)
    if kind == k.BUSHING:
        along = vec3(model.rows.vector[row, 0], model.rows.vector[row, 1], model.rows.vector[row, 2])
        if wp.length(along) > real(0.0):
            return real(1.0)
    return model.length


@wp.func
def inertia_left(
    model: Model, w: int, lane: int, acc: real, extent: real, scale: real, modal_scale: real, trial: Trial
) -> real:
    """Largest inertia force of a proximal step, of bodies over `scale`, of modes over `modal_scale`, excluding motion
    below round-off: `STILL` of the increments of the load step, or `ROUNDED` of `extent` [m]. Lanes over bodies and
    modes."""
    longest = real(0.0)
    b = lane
    while b < model.bodies.count:
        gyration = gyration_of(model.bodies.inertia[b], model.bodies.mass[b])
        longest = wp.max(longest, wp.length(trial.dx[w, b]) + gyration * wp.length(trial.psi[w, b]))
        b += wp.block_dim()
    still = acc * wp.max(STILL * most(longest), ROUNDED * extent)
    left = real(0.0)
    b = lane
    while b < model.bodies.count:
        J = model.bodies.inertia[b]
        m = model.bodies.mass[b]
        gyration = gyration_of(J, m)
        if wp.length(trial.v1_rate[w, b]) > still:
            left = wp.max(left, m * wp.length(trial.v1_rate[w, b]) / scale)
        if gyration * wp.length(trial.omega1_rate[w, b]) > still:
            left = wp.max(left, wp.length(J * trial.omega1_rate[w, b]) / (gyration * scale))
        b += wp.block_dim()
    longest = real(0.0)
    n = lane
    while n < model.modes.count:
        longest = wp.max(longest, wp.abs(trial.dq[w, n]))
        n += wp.block_dim()
    longest = most(longest)
    n = lane
    while n < model.modes.count:
        if wp.abs(trial.qd1_rate[w, n]) > acc * STILL * longest:
            left = wp.max(left, wp.abs(trial.qd1_rate[w, n]) / modal_scale)
        n += wp.block_dim()
    return most(left)


@wp.func
def matched_stiffness_of(
    model: Model, w: int, group: int, column: int, matched_stiffness: wp.array(dtype=real)
) -> real:
    """-T_zz of a motion coordinate of a group of joint interfaces, from the tangent of the last iteration."""
    first = model.elements[0].matched[0].column_start[group]
    columns = model.elements[0].matched[0].column_start[group + 1] - first
    square = w * model.elements[0].matched[0].square_start[model.elements[0].matched[0].count]
    square += model.elements[0].matched[0].square_start[group]
    return wp.max(-matched_stiffness[square + (column - first) * (columns + 1)], real(0.0))


@wp.func
def stiffest_place(model: Model, w: int, group: int, matched_stiffness: wp.array(dtype=real)) -> real:
    """Largest K_tt of the joint interfaces of a group [N/m]; 0 if none has a second body or the ground."""
    stiffest = real(0.0)
    contact = model.elements[0].matched[0].matched_start[group]
    while contact < model.elements[0].matched[0].matched_start[group + 1]:
        at = model.elements[0].matched[0].rigid_column[contact]
        if at >= 0:
            for i in range(3):
                stiffest = wp.max(stiffest, matched_stiffness_of(model, w, group, at + i, matched_stiffness))
        contact += 1
    return stiffest


@wp.func
def settle(run: Run, residuals: Residuals, model: Model, w: int, worst: real, sum: real, switching: bool):
    """By one lane: whether the iteration of a world continues, and with which matrix."""
    residuals.residual_history[w, wp.min(run.ctl[w].iteration, residuals.residual_history.shape[1] - 1)] = worst
    if not wp.isfinite(worst + sum):
        run.ctl[w].failure = run.ctl[w].failure | k.NOT_FINITE
        run.ctl[w].run = 0
        return
    run.ctl[w].refresh = 0
    if worst > REFRESH_ABOVE or switching:
        run.ctl[w].refresh = 1
    elif (
        run.ctl[w].iteration > 1
        and worst
        > SLOW * residuals.residual_history[w, wp.min(run.ctl[w].iteration, residuals.residual_history.shape[1]) - 1]
    ):
        run.ctl[w].refresh = 1
    done = worst <= model.limits.residual_tolerance and not switching
    if done and (run.ctl[w].reassemble == 0 or model.pairs.count == 0):
        run.ctl[w].run = 0
    elif run.ctl[w].iteration >= model.limits.max_iterations * (1 + run.ctl[w].round):
        run.ctl[w].failure = run.ctl[w].failure | k.NOT_CONVERGED
        run.ctl[w].run = 0


@kernel_in_place
def balance(
    run: Run, trial: Trial, loads: LoadState, residuals: Residuals, geometry: ContactGeometry, pairs: ContactState,
    lumped: LumpedState, oil: FilmScratch, tableau: MatchedScratch, q1: wp.array2d(dtype=real),
):  # fmt: skip
    """Convergence check, lanes over the parts of each kind. Residual forces with contact, row defects, spring laws,
    open gaps under pressure and flows of films, all as fractions.

    The scale of forces is the largest of weight, inertia and gyroscopic force, multiplier and contact force; that of
    modal forces is the largest contact load, of all pairs and of each, elastic and inertia force; that of lengths is
    the penetration if there is contact, else the length of the scene (`gap_defect`: open gaps as a fraction,
    penetration). Load steps include the forces at their start: one that ends without forces retains the round-off of
    those.
    """
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or run.ctl[w].iteration == 0:
        return
    acc = run.clk[w].retained.acc
    scale = NONE
    modal_scale = NONE
    extent = model.length
    residual = real(0.0)  # largest unbalanced force [N]
    apart = real(0.0)  # largest defect of a joint [m]
    open_load = real(0.0)  # largest unbalanced load of a mode
    worst = real(0.0)  # of what is a fraction already
    sum = real(0.0)  # a maximum drops NaN, a sum keeps it
    loading = run.ctl[w].mode == k.LOADING
    b = lane
    while b < model.bodies.count:
        m = model.bodies.mass[b]
        J = model.bodies.inertia[b]
        # a torque is measured by the equivalent force at the radius of gyration
        gyration = gyration_of(J, m)
        nothing = NO_FORCE * acc * model.length
        scale = wp.max(scale, m * nothing)
        modal_scale = wp.max(modal_scale, wp.sqrt(m) * nothing)
        scale = wp.max(scale, m * (wp.length(model.gravity) + wp.length(trial.v1_rate[w, b])))
        turning = wp.length(J * trial.omega1_rate[w, b]) + wp.length(
            wp.cross(trial.omega1[w, b], J * trial.omega1[w, b])
        )
        scale = wp.max(scale, turning / gyration)
        # accelerations are differences of increments: smaller values are round-off
        travel = wp.length(trial.dx[w, b]) + gyration * wp.length(trial.psi[w, b])
        scale = wp.max(scale, ROUND_OFF * acc * m * travel)
        for c in range(3):
            scale = wp.max(scale, wp.abs(loads.load[w, 1, 6 * b + c]))
            scale = wp.max(scale, wp.abs(loads.load[w, 1, 6 * b + 3 + c]) / gyration)
            if loading:
                scale = wp.max(scale, wp.abs(loads.load[w, 0, 6 * b + c]))
                scale = wp.max(scale, wp.abs(loads.load[w, 0, 6 * b + 3 + c]) / gyration)
        extent = wp.max(extent, wp.length(trial.r1[w, b]))
        f = vec3(residuals.residual[w, 6 * b], residuals.residual[w, 6 * b + 1], residuals.residual[w, 6 * b + 2])
        t = vec3(residuals.residual[w, 6 * b + 3], residuals.residual[w, 6 * b + 4], residuals.residual[w, 6 * b + 5])
        residual = wp.max(residual, wp.max(wp.length(f), wp.length(t) / gyration))
        sum += wp.length(f) + wp.length(t)
        b += wp.block_dim()
    i = lane
    # forces that cancel on a body, such as those of a bolt, leave round-off
    while i < model.external[0].forces.count:
        force = wp.length(loads.applied[w, 1, i])
        scale = wp.max(scale, CANCELLED * force)
        interface = model.external[0].forces.interface[i]
        if interface >= 0:
            pull = real(0.0)
            for c in range(3):
                pull += force * model.interfaces.reach[interface, c]
            modal_scale = wp.max(modal_scale, CANCELLED * pull)
        i += wp.block_dim()
    row = lane
    while row < model.rows.count:
        size = wp.abs(loads.lam[w, row])
        if loading:
            size = wp.max(size, wp.abs(loads.lam0[w, row]))
        if model.rows.kind[row] == k.TRANSLATION or model.rows.kind[row] == k.DISTANCE:
            scale = wp.max(scale, size)
        elif model.rows.rigid[row] == 0:  # a torsional spring, a bushing: force, and torque at the radius of gyration
            f = vec3(residuals.row_wrench[w, row, 0], residuals.row_wrench[w, row, 1], residuals.row_wrench[w, row, 2])
            t = vec3(residuals.row_wrench[w, row, 3], residuals.row_wrench[w, row, 4], residuals.row_wrench[w, row, 5])
            scale = wp.max(scale, size * wp.length(f))
            for side in range(2):
                b = model.markers.body[marker_of(model, row, side)]
                if b >= 0:
                    gyration = gyration_of(model.bodies.inertia[b], model.bodies.mass[b])
                    scale = wp.max(scale, size * wp.length(t) / gyration)
        if residuals.softness[w, row] == real(0.0):
            apart = wp.max(apart, wp.abs(residuals.defect[w, row]) * arm_of(model, row))
        sum += residuals.defect[w, row]
        for side in range(2):  # forces of joints that cancel on the modes leave round-off
            interface = model.markers.interface[marker_of(model, row, side)]
            if interface >= 0:
                pull = real(0.0)
                for c in range(6):
                    pull += wp.abs(residuals.row_pull[w, 2 * row + side, c]) * model.interfaces.reach[interface, c]
                modal_scale = wp.max(modal_scale, CANCELLED * wp.abs(loads.lam[w, row]) * pull)
        row += wp.block_dim()
    pair = lane
    while pair < model.pairs.count:
        f = vec3(geometry.pair_wrench[w, pair, 0], geometry.pair_wrench[w, pair, 1], geometry.pair_wrench[w, pair, 2])
        scale = wp.max(scale, wp.length(f))
        if loading:
            f = vec3(pairs.pair_force[w, pair, 0, 0], pairs.pair_force[w, pair, 0, 1], pairs.pair_force[w, pair, 0, 2])
            scale = wp.max(scale, wp.length(f))
        pair += wp.block_dim()
    place = lane
    while place < model.elements[0].lumped.places:
        contact = model.elements[0].lumped.contact[place]
        if model.elements[0].lumped.slip_velocity[contact] == real(0.0):  # beyond its bound, see `lumped.forces`
            bound = model.elements[0].lumped.friction[contact] * lumped.lumped_force[w, 1, place]
            residual = wp.max(residual, wp.length(lumped.lumped_friction[w, 1, place]) - bound)
        scale = wp.max(scale, lumped.lumped_force[w, 1, place])
        if loading:
            scale = wp.max(scale, lumped.lumped_force[w, 0, place])
        place += wp.block_dim()
    switching = real(0.0)  # of films whose active set has changed, or whose increment was reduced
    film = lane
    while film < model.elements[0].films[0].count:
        scale = wp.max(
            scale, wp.length(vec3(oil.film_sums[w, film, 0], oil.film_sums[w, film, 1], oil.film_sums[w, film, 2]))
        )
        worst = wp.max(worst, oil.film_off[w, film])
        sum += oil.film_off[w, film]
        switching += real(oil.film_changed[w, film])
        film += wp.block_dim()
    contact = lane
    while contact < model.elements[0].matched[0].matched:
        c = model.elements[0].matched[0].rigid_column[contact]
        if c >= 0:
            scale = wp.max(
                scale,
                wp.length(
                    vec3(tableau.matched_push[w, c], tableau.matched_push[w, c + 1], tableau.matched_push[w, c + 2])
                ),
            )
            for i in range(3):
                scale = wp.max(scale, CELLS * tableau.matched_sum[w, c + i])
        contact += wp.block_dim()
    shallow = model.length  # least depth of the joint interfaces that are pressed
    stiffest = real(0.0)
    stiffest_mode = real(0.0)  # geometric mean with the stiffness of its group
    contact = int(0)
    while contact < model.elements[0].matched[0].count:  # few; lanes over the motion coordinates of each
        if tableau.matched_depth[w, contact] > real(0.0):
            shallow = wp.min(shallow, tableau.matched_depth[w, contact])
        stiffness = stiffest_place(model, w, contact, tableau.matched_stiffness)
        stiffest = wp.max(stiffest, stiffness)
        n = model.elements[0].matched[0].column_start[contact] + lane
        while n < model.elements[0].matched[0].column_start[contact + 1]:
            if model.elements[0].matched[0].column_mode[n] >= 0:
                mode_stiffness = matched_stiffness_of(model, w, contact, n, tableau.matched_stiffness)
                stiffest_mode = wp.max(stiffest_mode, wp.sqrt(stiffness * mode_stiffness))
                modal_scale = wp.max(
                    modal_scale, wp.max(wp.abs(tableau.matched_push[w, n]), CELLS * tableau.matched_sum[w, n])
                )
            n += wp.block_dim()
        worst = wp.max(worst, CLOSER * tableau.matched_off[w, contact])
        sum += tableau.matched_off[w, contact]
        contact += 1
    n = lane
    while n < model.modes.count:
        modal_scale = wp.max(modal_scale, wp.abs(loads.load_on_modes[w, 1, n]))
        contact_load = loads.modal_load[w, 1, n]
        modal_scale = wp.max(modal_scale, wp.max(wp.abs(contact_load), wp.abs(model.modes.stiffness[n] * q1[w, n])))
        travel = wp.abs(trial.dq[w, n])
        if loading:
            before = wp.abs(model.modes.stiffness[n] * (q1[w, n] - trial.dq[w, n]))
            before = wp.max(before, wp.max(wp.abs(loads.load_on_modes[w, 0, n]), wp.abs(loads.modal_load[w, 0, n])))
            modal_scale = wp.max(modal_scale, before)
        modal_scale = wp.max(modal_scale, wp.max(wp.abs(trial.qd1_rate[w, n]), ROUND_OFF * acc * travel))
        open_load = wp.max(open_load, wp.abs(residuals.modal_residual[w, n]))
        sum += residuals.modal_residual[w, n]
        n += wp.block_dim()
    pair = int(0)
    while pair < model.pairs.count:  # loads of pairs that cancel on the modes leave round-off
        n = lane
        while n < model.pairs.most_modes:
            modal_scale = wp.max(modal_scale, wp.abs(pairs.pair_modal[w, pair, 1, n]))
            n += wp.block_dim()
        pair += 1
    n = lane
    while n < oil.film_modal.shape[1] and model.elements[0].films[0].count > 0:
        modal_scale = wp.max(modal_scale, wp.abs(oil.film_modal[w, n]))
        n += wp.block_dim()
    found = mosts(values(scale, modal_scale, extent, residual, apart, open_load, stiffest_mode, switching))
    extent = found[2]
    off_place = ROUNDED * extent / model.limits.residual_tolerance
    scale = wp.max(found[0], off_place * stiffest)
    modal_scale = wp.max(found[1], off_place * found[6])
    length = model.length
    if residuals.gap_defect[w, 1] > real(0.0):
        length = wp.min(length, wp.max(residuals.gap_defect[w, 1], SHORT * extent))
    if shallow < model.length:
        length = wp.min(length, wp.max(shallow, SHORT * extent))
    row = lane
    while row < model.rows.count:  # a spring's force against its law; a stretch of round-off size is accepted
        if residuals.softness[w, row] != real(0.0):
            arm = arm_of(model, row)
            given = wp.max(scale * wp.abs(residuals.softness[w, row]) * arm, SHORT * extent / arm)
            worst = wp.max(worst, wp.abs(residuals.defect[w, row]) / given)
        row += wp.block_dim()
    worst = most(worst)
    worst = wp.max(wp.max(worst, found[4] / length), wp.max(found[3] / scale, found[5] / modal_scale))
    worst = wp.max(worst, residuals.gap_defect[w, 0])
    sum = total(sum) + residuals.gap_defect[w, 0]
    left = real(0.0)
    if loading:
        left = inertia_left(model, w, lane, acc, extent, scale, modal_scale, trial)
    if lane == 0:
        if loading:
            run.clk[w].force = scale
            run.clk[w].left = left
        settle(run, residuals, model, w, worst, sum, found[7] > real(0.0))
