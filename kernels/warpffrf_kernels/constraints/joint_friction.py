r"""Dry friction in joints, with stick, and steps without old accelerations.

A joint with friction has one row s (rotation, sliding) or two (a pin with both), spring rows without stiffness whose
multipliers are its friction. With W = diag(weights), v = W s' is the velocity of the surfaces and f = W^-1 lambda the
braking force,

    |f| <= b,    v = 0 where |f| < b (stick),    f = b v/|v| where v != 0 (slip),
    b = preload + mu (radial (|N_1| + |N_2|) + axial |R_z| + spin |M_z|),     N = R_xy/2 +- bending e_z x M,

R and M the reactions of the joint's own rows at the end of the step: all of it is implicit. A regularised law has f = b
v/max(|v|, v_slip) instead and never sticks.

**In the retained system** a sticking row is a constraint, s = s_0, measured from the point where it came to rest, so
that nothing creeps. A slipping row requires f = b n, n = v/|v|, linearised

    df = n db + (b/|v|) (1 - n n^T) dv,        db = mu (...) dlambda of the joint's rows,

which, multiplied by the softness E = (|v|/(b VEL)) (1 - n n^T) + E_n n n^T, becomes a row of the form of springs,

    W C dx - E df + E_n n db = -E (b n - f),

except for C dx along n, which should be absent: with E_n = SOFT times the compliance of the row it is a millionth of
the rest, which is also the relative error of an iteration. The converged solution is exact.

**Choice of the state.** A step of second order uses old accelerations (`motion`), and with them the previous friction.
So a row keeps its state, stick, or slip in its direction, for the whole of an attempt, which is then as smooth as one
without friction. If it cannot persist (|f| > b of a sticking row; a slipping row is moved or ends against its
direction), the attempt is repeated *without old accelerations*: by the implicit Euler method,

    s_1 - s_0 = h v_1 (of coordinates linear in the motion),      v_1 = v_0 + h a_1,

where v_1 = 0 means s_1 = s_0 and f is the mean force of the step. In it the state of a row at the end of the step is
free and found by an active set: a sticking row with |f| > b then slips along f, a slipping row with v.n <= 0 sticks.
The next step uses no old accelerations either, since the mean force of this step is not the friction that follows. The
error of each such step in the motion of a body is up to a h^2/2, and a stop is up to a h^2/2 too early: of second
order, as their number is that of the friction changes. The time of a change is known to h.

**Dissipation.** A step dissipates lambda . (s_1 - s_0), with the mean of lambda_0 and lambda_1 if it slips throughout,
neither of which opposes the slip direction; with lambda_1 in a step without old accelerations, where f.v_1 >= 0 ensures
that it is not negative; and 0 if it sticks.

If sticking joints close a loop, their forces are not determined by the motion. A sticking row has HELD times its
compliance as softness, with the defect s - s_0, which makes the matrix regular and changes no solution: among all
forces the iteration then finds one near that of the previous step.

**Load steps** (`warpffrf_kernels.step.proximal`) are steps without old accelerations, with (s_1 - s_0)/h for the
velocity, h the time in which the loads change. Friction does not act in the first equilibrium of a scene; for its start
in a run in time see `warpffrf.online.start.accelerations`.
"""

import warp as wp

from warpffrf_kernels.bodies.interfaces import compliance, marker_of, side_of
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.ring import SavedJointFriction
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.core.scratch import Residuals, RetainedSystem
from warpffrf_kernels.core.state import JointFrictionState, LoadState

wp.set_module_options(MODULE_OPTIONS)

SOFT = wp.constant(wp.float64(1.0e6))  # of a row's compliance: the relative error of an iteration is its inverse
HELD = wp.constant(wp.float64(1.0e-5))  # of a row's compliance, likewise
# the same for load steps, whose proximal steps allow far more motion of a body than the structure that constrains it
HELD_AT_REST = wp.constant(wp.float64(1.0e-13))
SLACK = wp.constant(wp.float64(1.0e-9))  # of the bound: the remaining force error of Newton's method
NOTHING = wp.constant(wp.float64(1.0e-300))  # keeps fractions finite


@wp.func
def acts(run: Run, w: int) -> bool:
    """Whether the evaluation is part of a step; gamma is 0 if the host evaluates a single state."""
    return run.ctl[w].mode == k.LOADING or (run.ctl[w].mode == k.DYNAMIC and run.clk[w].retained.gamma > real(0.0))


@wp.func
def slip_rate(run: Run, w: int, row: int, residuals: Residuals, loads: LoadState) -> real:
    """Rate of a row; in a load step its mean over the step."""
    if run.ctl[w].mode == k.LOADING:
        return (residuals.coordinate[w, row] - loads.stretch[w, row]) / run.clk[w].h
    return loads.drive_rate[w, 1, row]


@wp.func
def rate_slope(run: Run, w: int) -> real:
    """d(rate)/d(coordinate)."""
    if run.ctl[w].mode == k.LOADING:
        return real(1.0) / run.clk[w].h
    return run.clk[w].retained.vel


@wp.func
def force_of(wrench: wp.array3d(dtype=real), w: int, row: int) -> vec3:
    return vec3(wrench[w, row, 0], wrench[w, row, 1], wrench[w, row, 2])


@wp.func
def torque_of(wrench: wp.array3d(dtype=real), w: int, row: int) -> vec3:
    return vec3(wrench[w, row, 3], wrench[w, row, 4], wrench[w, row, 5])


@wp.func
def axis_of(model: Model, w: int, e: int, row_wrench: wp.array3d(dtype=real)) -> vec3:
    """Axis of the joint, world."""
    row = model.elements[0].joint_frictions.start[e]
    if model.rows.kind[row] == k.TRANSLATION:
        return force_of(row_wrench, w, row)
    return wp.normalize(torque_of(row_wrench, w, row))


@wp.func
def reaction(model: Model, w: int, e: int, lam: wp.array2d(dtype=real), row_wrench: wp.array3d(dtype=real)):
    """R and M of the joint on its second body."""
    R = vec3(real(0.0))
    M = vec3(real(0.0))
    at = model.elements[0].joint_frictions.held_start[e]
    while at < model.elements[0].joint_frictions.held_start[e + 1]:
        row = model.elements[0].joint_frictions.held[at]
        R -= lam[w, row] * force_of(row_wrench, w, row)
        M -= lam[w, row] * torque_of(row_wrench, w, row)
        at += 1
    return R, M


@wp.func
def bound_of(model: Model, e: int, axis: vec3, R: vec3, M: vec3) -> real:
    across = real(0.5) * (R - wp.dot(R, axis) * axis)
    couple = model.elements[0].joint_frictions.bending[e] * wp.cross(axis, M)
    load = model.elements[0].joint_frictions.radial[e] * (wp.length(across + couple) + wp.length(across - couple))
    load += model.elements[0].joint_frictions.axial[e] * wp.abs(wp.dot(R, axis))
    load += model.elements[0].joint_frictions.spin[e] * wp.abs(wp.dot(M, axis))
    return model.elements[0].joint_frictions.preload[e] + model.elements[0].joint_frictions.coefficient[e] * load


@wp.func
def bound_slope(model: Model, e: int, axis: vec3, R: vec3, M: vec3, dR: vec3, dM: vec3) -> real:
    """Change of the bound with R and M."""
    bending = model.elements[0].joint_frictions.bending[e]
    across = real(0.5) * (R - wp.dot(R, axis) * axis)
    couple = bending * wp.cross(axis, M)
    along = real(0.5) * (dR - wp.dot(dR, axis) * axis)
    turned = bending * wp.cross(axis, dM)
    first = wp.normalize(across + couple)
    second = wp.normalize(across - couple)
    slope = model.elements[0].joint_frictions.radial[e] * (
        wp.dot(first, along + turned) + wp.dot(second, along - turned)
    )
    slope += model.elements[0].joint_frictions.axial[e] * wp.sign(wp.dot(R, axis)) * wp.dot(dR, axis)
    slope += model.elements[0].joint_frictions.spin[e] * wp.sign(wp.dot(M, axis)) * wp.dot(dM, axis)
    return model.elements[0].joint_frictions.coefficient[e] * slope


@wp.func
def row_compliance(model: Model, run: Run, w: int, row: int, residuals: Residuals) -> real:
    """Approximate displacement of a row's coordinate per unit of its force in a step, for free bodies; modes that are
    retained unknowns, whose receptance is 0, contribute by their own inertia and stiffness."""
    total = compliance(model, w, row, row, residuals)
    for side in range(2):
        b = side_of(model, row, side)
        if b >= 0:
            d = model.bodies.dense_start[b]
            while d < model.bodies.dense_start[b] + model.bodies.dense_count[b]:
                m = model.dense.mode[d]
                c = residuals.C_modal[(w * model.rows.count + row) * model.modes.count + m]
                damping = run.clk[w].retained.vel * model.modes.damping[m]
                total += c * c / (run.clk[w].retained.acc + damping + model.modes.stiffness[m])
                d += 1
    for side in range(2):
        b = model.markers.body[marker_of(model, row, side)]
        if b >= 0:
            for i in range(3):
                f = residuals.C[w, row, 6 * b + i]
                t = residuals.C[w, row, 6 * b + 3 + i]
                total += f * f / (model.bodies.mass[b] * run.clk[w].retained.acc)
                total += t * t / (model.bodies.inertia[b][i, i] * run.clk[w].retained.acc)
    return total


@kernel
def rub(run: Run, loads: LoadState, residuals: Residuals, joints: JointFrictionState):
    """Lanes over joints with friction: stick or slip, and the defects and softness of their rows."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or not acts(run, w):
        return
    e = lane
    while e < model.elements[0].joint_frictions.count:
        n = model.elements[0].joint_frictions.size[e]
        first = model.elements[0].joint_frictions.start[e]
        slow = model.elements[0].joint_frictions.slip_velocity[e]
        R, M = reaction(model, w, e, loads.lam, residuals.row_wrench)
        bound = bound_of(model, e, axis_of(model, w, e, residuals.row_wrench), R, M)
        residuals.slip_bound[w, e] = bound
        v = wp.vec2d(real(0.0), real(0.0))
        f = wp.vec2d(real(0.0), real(0.0))
        yields = NOTHING
        for r in range(n):
            weight = model.elements[0].joint_frictions.weight[e, r]
            row = first + r
            v[r] = weight * slip_rate(run, w, row, residuals, loads)
            f[r] = loads.lam[w, row] / weight
            soft = weight * weight * row_compliance(model, run, w, row, residuals)
            yields = wp.max(yields, soft)
            if run.ctl[w].iteration == 0:
                residuals.slip_anchor[w, e, r] = joints.stuck_at[w, e, r]
                if joints.slipping[w, e] != 0:
                    residuals.slip_anchor[w, e, r] = loads.stretch[w, row]
        way = wp.vec2d(residuals.slip_way[w, e, 0], residuals.slip_way[w, e, 1])
        branch = residuals.slip_branch[w, e]
        if slow > real(0.0):
            branch = int(1)
            way = v / wp.max(wp.length(v), slow)
        elif run.ctl[w].iteration == 0:
            branch = joints.slipping[w, e]
            way = wp.normalize(f)
            if wp.length(f) == real(0.0):
                way = wp.normalize(v)
            if wp.length(way) == real(0.0):
                branch = int(0)
        elif run.ctl[w].restart != 0 and branch == 0 and wp.length(f) > bound * (real(1.0) + SLACK):
            branch = int(1)
            way = wp.normalize(f)
            run.ctl[w].friction_changed = 1
        elif run.ctl[w].restart != 0 and branch != 0 and wp.dot(way, v) <= real(0.0):
            branch = int(0)
            run.ctl[w].friction_changed = 1
        elif branch != 0 and n == 2 and wp.dot(way, v) > real(0.0):
            way = wp.normalize(v)
        residuals.slip_branch[w, e] = branch
        along = SOFT * yields
        across = along
        if branch != 0 and bound > real(0.0):
            across = wp.min(along, wp.max(wp.length(v), slow) / (bound * rate_slope(run, w)))
        if wp.length(v) < slow:
            along = across
        residuals.slip_way[w, e, 0] = way[0]
        residuals.slip_way[w, e, 1] = way[1]
        residuals.slip_softness[w, e, 0] = along
        residuals.slip_softness[w, e, 1] = across
        missing = bound * way - f
        lead = (along - across) * wp.dot(way, missing)
        for r in range(n):
            row = first + r
            weight = model.elements[0].joint_frictions.weight[e, r]
            if branch == 0:
                residuals.defect[w, row] = residuals.coordinate[w, row] - residuals.slip_anchor[w, e, r]
                held = HELD
                if run.ctl[w].mode == k.LOADING:
                    held = HELD_AT_REST
                residuals.softness[w, row] = held * yields / (weight * weight)
            else:
                residuals.defect[w, row] = (across * missing[r] + lead * way[r]) / weight
                residuals.softness[w, row] = (across + (along - across) * way[r] * way[r]) / (weight * weight)
        e += wp.block_dim()


@kernel
def renew(run: Run):
    """Per world: renews the retained matrix if stick has become slip, or slip stick, since it was assembled."""
    w = wp.tid()
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or run.ctl[w].friction_changed == 0:
        return
    run.ctl[w].refresh = 1
    run.ctl[w].friction_changed = 0


@kernel
def couple_friction(run: Run, loads: LoadState, residuals: Residuals, system: RetainedSystem):
    """Lanes over joints with friction: coupling of their rows with each other and with the rows of the normal load, in
    the retained matrix."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or run.ctl[w].refresh == 0 or not acts(run, w):
        return
    e = lane
    while e < model.elements[0].joint_frictions.count:
        n = model.elements[0].joint_frictions.size[e]
        at = model.retained.row_offset + model.elements[0].joint_frictions.start[e]
        along = residuals.slip_softness[w, e, 0]
        across = residuals.slip_softness[w, e, 1]
        if residuals.slip_branch[w, e] != 0:
            if n == 2:
                both = model.elements[0].joint_frictions.weight[e, 0] * model.elements[0].joint_frictions.weight[e, 1]
                shear = (along - across) * residuals.slip_way[w, e, 0] * residuals.slip_way[w, e, 1] / both
                system.tangent[w, at, at + 1] = system.tangent[w, at, at + 1] - shear
                system.tangent[w, at + 1, at] = system.tangent[w, at + 1, at] - shear
            axis = axis_of(model, w, e, residuals.row_wrench)
            R, M = reaction(model, w, e, loads.lam, residuals.row_wrench)
            i = model.elements[0].joint_frictions.held_start[e]
            while i < model.elements[0].joint_frictions.held_start[e + 1]:
                row = model.elements[0].joint_frictions.held[i]
                dR = -force_of(residuals.row_wrench, w, row)
                dM = -torque_of(residuals.row_wrench, w, row)
                slope = bound_slope(model, e, axis, R, M, dR, dM)
                column = model.retained.row_offset + row
                for r in range(n):
                    entry = along * residuals.slip_way[w, e, r] * slope / model.elements[0].joint_frictions.weight[e, r]
                    system.tangent[w, at + r, column] = system.tangent[w, at + r, column] + entry
                i += 1
        e += wp.block_dim()


@kernel
def end_slips(run: Run, loads: LoadState, residuals: Residuals, joints: JointFrictionState):
    """Per world: dissipation of each joint in the attempt, and whether the state of one could not persist."""
    w = wp.tid()
    model = run.models[w]
    if run.ctl[w].attempt == 0:
        return
    run.ctl[w].friction_changed = 0
    e = int(0)
    while e < model.elements[0].joint_frictions.count:
        residuals.slip_loss[w, e] = real(0.0)
        if acts(run, w):
            held = real(0.0)
            moved = real(0.0)
            before = real(0.0)
            after = real(0.0)
            kept = real(0.0)
            for r in range(model.elements[0].joint_frictions.size[e]):
                row = model.elements[0].joint_frictions.start[e] + r
                weight = model.elements[0].joint_frictions.weight[e, r]
                step = residuals.coordinate[w, row] - loads.stretch[w, row]
                held += loads.lam[w, row] * loads.lam[w, row] / (weight * weight)
                before += loads.lam0[w, row] * step
                after += loads.lam[w, row] * step
                kept += loads.lam0[w, row] * loads.lam[w, row] / (weight * weight)
                rate = slip_rate(run, w, row, residuals, loads)
                moved += residuals.slip_way[w, e, r] * weight * rate
            loss = real(0.5) * (before + after)
            if run.ctl[w].restart != 0:
                loss = after
            residuals.slip_loss[w, e] = wp.max(loss, real(0.0))
            branch = residuals.slip_branch[w, e]
            if model.elements[0].joint_frictions.slip_velocity[e] == real(0.0):
                if run.ctl[w].restart != 0:
                    if branch != joints.slipping[w, e] or (branch != 0 and kept < real(0.0)):
                        run.ctl[w].friction_changed = 1
                elif branch == 0:
                    if wp.sqrt(held) > residuals.slip_bound[w, e] * (real(1.0) + SLACK):
                        run.ctl[w].friction_changed = 1
                elif moved <= real(0.0) or after < real(0.0) or before < real(0.0):
                    run.ctl[w].friction_changed = 1
        e += 1


@kernel
def keep_slips(run: Run, residuals: Residuals, joints: JointFrictionState):
    """Lanes over joints with friction: stores the result of an accepted attempt."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].commit == 0 or not acts(run, w):
        return
    e = lane
    while e < model.elements[0].joint_frictions.count:
        joints.slipping[w, e] = residuals.slip_branch[w, e]
        for r in range(model.elements[0].joint_frictions.size[e]):
            joints.stuck_at[w, e, r] = residuals.slip_anchor[w, e, r]
        e += wp.block_dim()


@kernel
def record_slips(
    run: Run, loads: LoadState, joints: JointFrictionState, residuals: Residuals, saved: SavedJointFriction
):
    """Lanes over joints with friction. A law without stick is recorded as sticking below its slip velocity."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].record == 0:
        return
    at = run.ctl[w].saved % saved.saved_slipping.shape[1]
    e = lane
    while e < model.elements[0].joint_frictions.count:
        v = wp.vec2d(real(0.0), real(0.0))
        f = wp.vec2d(real(0.0), real(0.0))
        for r in range(model.elements[0].joint_frictions.size[e]):
            row = model.elements[0].joint_frictions.start[e] + r
            v[r] = model.elements[0].joint_frictions.weight[e, r] * loads.drive_rate[w, 0, row]
            f[r] = -loads.lam[w, row] / model.elements[0].joint_frictions.weight[e, r]
        state = joints.slipping[w, e]
        if wp.length(v) < model.elements[0].joint_frictions.slip_velocity[e]:
            state = int(0)
        saved.saved_slipping[w, at, e] = state
        for r in range(2):
            saved.saved_surface_velocity[w, at, e, r] = v[r]
            saved.saved_surface_traction[w, at, e, r] = f[r]
        saved.saved_slip_bound[w, at, e] = residuals.slip_bound[w, e]
        saved.saved_slip_power[w, at, e] = real(0.0)
        if run.clk[w].done_step > real(0.0):
            saved.saved_slip_power[w, at, e] = residuals.slip_loss[w, e] / run.clk[w].done_step
        e += wp.block_dim()
