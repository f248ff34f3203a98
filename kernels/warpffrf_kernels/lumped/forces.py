r"""Forces of lumped contacts: normal force at each point, its friction, and their tangent in the retained matrix.

At a point x with normal n of the second body, gap g and approach a = -g (`places`)

    force on the first body       F n + f,      F = P(a) (1 + chi a_dot) >= 0,      f . n = 0,      |f| <= mu F,

the opposite on the second, at the same x: action equals reaction, in force and moment.

**Friction with stick** is a spring between the two surfaces with the tangential stiffness of the patch, k = kappa P'(a)
(kappa = k_t/k_n, Mindlin), which yields at the bound. With s the slip of body 1 relative to body 2 over the step,

    f_tr = c T f_0 - k s_t,      f = f_tr where |f_tr| <= mu F, else mu F f_tr/|f_tr|.

T rotates the force of the last step with the contact: about the old normal by the mean spin of the bodies, then by the
smallest rotation that maps the old normal to the new one. c = min(1, k/k_0): if the normal force decreases the spring
keeps its stretch, and if it increases its force. Either loses energy: 1/2 f^2/k never grows by a change of the normal
force, unlike that of a spring with f = k times stretch in loading (Elata and Berryman 1996). So

    energy   1/2 f^2/k,      dissipated   (1/2 f_0^2/k_0 - 1/2 (c f_0)^2/k) + f_m (|f_tr| - |f|)/k   >= 0,

f_m = max(0, (T f_0 . e + |f|)/2) with e along f: the mean force of the step times the irreversible slip. With f alone
the error for a bound that changes during slip would be of first order in the step. For c = 1 this is exactly the work
of the mean force minus the change of the energy.

The slip is that of the material points of the bodies at the contact, s = D_1 - D_2 with D = dr + psi x (mean lever), dr
and psi the increments of the step. A rolling body has D = 0: the levers are those of the contact point, which moves
along.

**Regularised friction** f = -mu F v_t/max(|v_t|, v_slip), v the slip velocity at the end of the step; beyond v_slip mu
may depend on |v_t| (a traction curve).

**The first iteration** of a step ignores the bound, and solves for the slip of a contact that sticks, or creeps. The
bound is then checked at that slip. From a slip of the wrong sign Newton's method would alternate: with a force that
saturates at +-mu F and a stiffness k far above the inertia of the step, m/h^2, the slope is that inertia on either
side. So an iteration after which slip has reversed ignores the bound again. Friction beyond its bound is a residual
(`balance`): the result of such an iteration is never accepted.

**Slopes of equilibria.** The tangent of a^n leads an element that unloads to a (1 - 1/n), never to zero. But the last
iteration has balanced the forces F_x that it expected, -> 0 of that element. So the slopes of a contact, of all its
laminae, are reduced or raised in common to those of the chord from F to the expected sum: with p = max(F_x, 0)/F and
the exponent m = a sum(dF/da)/F of the contact, a the largest approach, by (1 - p)/(m (1 - p^(1/m))). An element without
a load then arrives in one step, and as F_x approaches F the chord becomes the tangent: convergence remains quadratic.

In static steps there is no slip, and f is zero. dF and df for a small motion follow from those of `places`.
"""

import warp as wp

from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.cone import at_bound, change_at_bound
from warpffrf_kernels.core.contact_scratch import LumpedContacts
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.lookup import piece_at
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.rotation import matrix
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.core.state import LumpedState, MotionState
from warpffrf_kernels.lumped.approach_laws import push_of
from warpffrf_kernels.lumped.bounces import bounce_of
from warpffrf_kernels.lumped.places import Side, Touch, nearest_of_lamina, nearest_points, side_in_world

wp.set_module_options(MODULE_OPTIONS)

# --- regimes of friction
NONE = wp.constant(0)
STICKS = wp.constant(1)
SLIPS = wp.constant(2)
CREEPS = wp.constant(3)  # regularised, below v_slip
RUBS = wp.constant(4)  # regularised, above

# --- energy dissipated in a step, J, and power at its end, W
DAMPED = wp.constant(0)
RUBBED = wp.constant(1)
GAINED = wp.constant(2)  # energy gained by the integrator at the point, J, and ...
AT_HAND = wp.constant(3)  # ... energy of a point that bounces, J, else 0: see `bounces`


@wp.struct
class Load:
    """The force of a point on the first body, and the quantities of its tangent."""

    touch: Touch
    force: real  # F
    by_approach: real  # dF/da
    by_rate: real  # dF/da_dot
    expected: real  # F by the linearisation of the last iteration of an equilibrium, 0 if it was open
    regime: int
    friction: vec3  # f
    trial: vec3  # f_tr
    shear: real  # k
    shear_bend: real  # dk/da
    turned: vec3  # T f_0
    spun: vec3  # f_0 after the spin about the old normal
    kept: real  # c
    kept_bend: real  # dc/da
    slip: vec3  # s, with its part along n
    velocity: vec3  # v_1 - v_2 at the point


@wp.struct
class Motion:
    """Motion of a body, in the world: velocity of its centre of mass, angular velocity, increments of the step."""

    v: vec3
    omega: vec3
    move: vec3
    turn: vec3
    lever: vec3  # from its centre of mass to the point, mean of the step
    share: real  # weight of the end of the step in it
    turn_by_turn: mat33  # d(turn) and, in the world, d(psi) with respect to a rotation about the body's axes
    psi_by_turn: mat33


@wp.func
def motion_of(side: Side, w: int, x: vec3, before: vec3, known: int, state: MotionState, trial: Trial) -> Motion:
    """For the body of a surface; `before`: the point at the end of the last step, if `known`."""
    out = Motion()
    b = side.body
    if b < 0:
        return out
    A = matrix(state.p[w, b])
    out.v = trial.v1[w, b]
    out.omega = side.A * trial.omega1[w, b]
    out.move = trial.dx[w, b]
    out.turn = A * trial.psi[w, b]
    out.lever = x - side.r
    out.share = real(1.0)
    if known != 0:
        out.lever = real(0.5) * (out.lever + before - state.r[w, b])
        out.share = real(0.5)
    out.turn_by_turn = A * trial.psi_inverse[w, b]
    out.psi_by_turn = side.A * trial.psi_inverse[w, b]
    return out


@wp.func
def beyond_creep(model: Model, contact: int, speed: real) -> wp.vec2d:
    """mu and dmu/dv [s/m] at a slip speed [m/s] of a law without stick, above the regularised range."""
    count = model.elements[0].lumped.slip_count[contact]
    if count == 0:
        return wp.vec2d(model.elements[0].lumped.friction[contact], real(0.0))
    # the last piece has no end
    first = model.elements[0].lumped.slip_start[contact]
    i = first + count - 1
    if speed < model.elements[0].lumped.slip_piece[i, 0]:
        i = piece_at(model.elements[0].lumped.slip_piece, first, count, 0, speed)
    x = speed - model.elements[0].lumped.slip_piece[i, 0]
    b = model.elements[0].lumped.slip_piece[i, 2]
    c = model.elements[0].lumped.slip_piece[i, 3]
    d = model.elements[0].lumped.slip_piece[i, 4]
    value = model.elements[0].lumped.slip_piece[i, 1] + x * (b + x * (c + x * d))
    return wp.vec2d(value, b + x * (real(2.0) * c + real(3.0) * x * d))


@wp.func
def tangential(n: vec3, a: vec3) -> vec3:
    return a - wp.dot(n, a) * n


@wp.func
def turned_with(old: vec3, n: vec3, f: vec3) -> vec3:
    """f, perpendicular to the unit vector `old`, rotated by the smallest rotation that maps `old` to n."""
    q = real(1.0) + wp.dot(old, n)
    if q <= real(0.0):
        return vec3(real(0.0))
    return f - (wp.dot(n, f) / q) * (n + old)


@wp.func
def touch_of(model: Model, place: int, first: Side, second: Side) -> Touch:
    if model.elements[0].lumped.lamina[place] != 0:
        t = nearest_of_lamina(model, first, second, model.elements[0].lumped.z[place])
        t.gap = t.gap + model.elements[0].lumped.drop[place]
        return t
    return nearest_points(model, first, second)


@kernel
def find_forces(
    run: Run, state: MotionState, trial: Trial, lumped: LumpedState, lumps: LumpedContacts,
    lumped_load: wp.array2d(dtype=Load),
):  # fmt: skip
    """Per world, lanes over points: the contact point at the trial state, the force there, and its energies."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0:
        return
    place = lane
    while place < model.elements[0].lumped.places:
        contact = model.elements[0].lumped.contact[place]
        first = side_in_world(model, w, model.elements[0].lumped.first[contact], trial)
        second = side_in_world(model, w, model.elements[0].lumped.second[contact], trial)
        out = Load()
        out.touch = touch_of(model, place, first, second)
        n = out.touch.n
        x = out.touch.x
        known = int(0)
        if lumped.lumped_force[w, 0, place] > real(0.0):
            known = int(1)
        before = lumped.lumped_at[w, 0, place]
        one = motion_of(first, w, x, before, known, state, trial)
        two = motion_of(second, w, x, before, known, state, trial)
        out.velocity = one.v + wp.cross(one.omega, x - first.r) - two.v - wp.cross(two.omega, x - second.r)
        approach = -out.touch.gap
        rate = -wp.dot(n, out.velocity)
        push = push_of(model, contact, model.elements[0].lumped.share[place], approach)
        factor = real(1.0) + model.elements[0].lumped.damping[contact] * rate
        if factor > real(0.0):
            out.force = push.force * factor
            out.by_approach = push.slope * factor
            out.by_rate = push.force * model.elements[0].lumped.damping[contact]
        if (run.ctl[w].mode == k.STATIC or run.ctl[w].mode == k.LOADING) and run.ctl[w].iteration > 0:
            if lumped_load[w, place].force > real(0.0):
                moved = approach + lumped_load[w, place].touch.gap
                out.expected = lumped_load[w, place].force + lumped_load[w, place].by_approach * moved
        mu = model.elements[0].lumped.friction[contact]
        creep = model.elements[0].lumped.slip_velocity[contact]
        rubbed = real(0.0)
        rub_power = real(0.0)
        held = real(0.0)
        old_energy = real(0.0)
        dynamic = run.ctl[w].mode != k.STATIC
        bounded = (run.ctl[w].mode != k.DYNAMIC and run.ctl[w].mode != k.LOADING) or run.ctl[w].iteration > 0
        if mu > real(0.0) and creep == real(0.0) and dynamic:
            out.shear = model.elements[0].lumped.shear[contact] * push.slope
            out.shear_bend = model.elements[0].lumped.shear[contact] * push.bend
            out.kept = real(1.0)
            stiff = lumped.lumped_shear[w, 0, place]
            if known != 0 and stiff > real(0.0):
                f = lumped.lumped_friction[w, 0, place]
                old = lumped.lumped_normal[w, 0, place]
                old_energy = real(0.5) * wp.dot(f, f) / stiff
                angle = real(0.5) * wp.dot(old, one.turn + two.turn)
                out.spun = wp.cos(angle) * f + wp.sin(angle) * wp.cross(old, f)
                out.turned = turned_with(old, n, out.spun)
                if out.shear < stiff:
                    out.kept = out.shear / stiff
                    out.kept_bend = out.shear_bend / stiff
            if out.force > real(0.0):
                out.slip = one.move + wp.cross(one.turn, one.lever) - two.move - wp.cross(two.turn, two.lever)
                base = out.kept * out.turned
                out.trial = base - out.shear * tangential(n, out.slip)
                out.friction = out.trial
                out.regime = STICKS
                size = wp.length(out.trial)
                last = lumped_load[w, place]
                if run.ctl[w].iteration > 1 and last.regime == SLIPS and wp.dot(last.friction, out.trial) < real(0.0):
                    bounded = False
                if bounded and size > mu * out.force:
                    out.regime = SLIPS
                    out.friction = at_bound(out.trial, mu * out.force)
                    mean = real(0.5) * (wp.dot(out.turned, out.trial) / size + mu * out.force)
                    rubbed = wp.max(mean, real(0.0)) * (size - mu * out.force) / out.shear
                held = real(0.5) * wp.dot(out.friction, out.friction) / out.shear
                old_energy -= real(0.5) * wp.dot(base, base) / out.shear
            rubbed += wp.max(old_energy, real(0.0))
        if mu > real(0.0) and creep > real(0.0) and dynamic and out.force > real(0.0):
            v = tangential(n, out.velocity)
            speed = wp.length(v)
            out.regime = CREEPS
            least = creep
            if bounded and speed > creep:
                out.regime = RUBS
                least = speed
                mu = beyond_creep(model, contact, speed)[0]
            out.friction = (-mu * out.force / least) * v
            rub_power = -wp.dot(out.friction, v)
        damp_power = (out.force - push.force) * rate
        half = real(0.5) * run.clk[w].h
        if run.ctl[w].mode == k.LOADING:  # there are no velocities
            half = real(0.0)
        lumps.lumped_taken[w, place, DAMPED] = half * (lumped.lumped_power[w, 0, place, DAMPED] + damp_power)
        lumps.lumped_taken[w, place, RUBBED] = rubbed + half * (lumped.lumped_power[w, 0, place, RUBBED] + rub_power)
        lumps.lumped_taken[w, place, GAINED] = real(0.0)
        lumps.lumped_taken[w, place, AT_HAND] = real(0.0)
        lumped.lumped_gained[w, 1, place] = lumped.lumped_gained[w, 0, place]
        was = lumped.lumped_approach[w, 0, place]
        if run.ctl[w].mode == k.DYNAMIC and wp.max(was, approach) > real(0.0):
            had = push_of(model, contact, model.elements[0].lumped.share[place], was)
            b = bounce_of(model, first, second, x, n, had, push, approach - was, rate, run.clk[w].h)
            lumps.lumped_taken[w, place, GAINED] = b[0]
            lumps.lumped_taken[w, place, AT_HAND] = b[2] * b[1]
            lumped.lumped_gained[w, 1, place] = wp.max(lumped.lumped_gained[w, 0, place] + b[0], -b[1])
        lumped.lumped_approach[w, 1, place] = approach
        lumped.lumped_power[w, 1, place, DAMPED] = damp_power
        lumped.lumped_power[w, 1, place, RUBBED] = rub_power
        lumped.lumped_energy[w, 1, place] = push.energy + held
        lumped.lumped_force[w, 1, place] = out.force
        lumped.lumped_friction[w, 1, place] = out.friction
        lumped.lumped_normal[w, 1, place] = n
        lumped.lumped_at[w, 1, place] = x
        lumped.lumped_shear[w, 1, place] = real(0.0)
        if out.force > real(0.0):
            lumped.lumped_shear[w, 1, place] = out.shear
        lumped_load[w, place] = out
        place += wp.block_dim()


@wp.struct
class Answer:
    """Change of a contact point due to a small motion: its shift, that of its normal, and the change of the force on
    the first body, of its normal part, and of the angular velocity of the first body relative to the second."""

    x: vec3
    n: vec3
    f: vec3
    force: real
    turning: vec3


@wp.func
def answer_to(
    model: Model, contact: int, old_normal: vec3, load: Load, side: Side, own: Motion, sign: real, spin: vec3,
    turn: vec3, coordinate: int, vel: real,
) -> Answer:  # fmt: skip
    """For a unit of a coordinate of the body of `side`: 0 to 2 translation, 3 to 5 rotation, own axes. sign: 1 of the
    first body, -1 of the second; spin: angular velocity of the first relative to the second; turn: difference of their
    rotations in the step, each times its `share`."""
    zero = vec3(real(0.0))
    unit = zero
    unit[coordinate % 3] = real(1.0)
    # motion of the body by the coordinate, and of both bodies at the contact point
    dr = zero
    phi = zero
    dturn = zero
    domega = zero
    if coordinate < 3:
        dr = unit
    else:
        phi = side.A * unit
        dturn = own.turn_by_turn * unit
        domega = vel * (own.psi_by_turn * unit) + wp.cross(phi, own.omega)
    x = load.touch.x
    n = load.touch.n
    u = dr + wp.cross(phi, x - side.r)
    u1 = u
    u2 = zero
    if sign < real(0.0):
        u1 = zero
        u2 = u
    # shift of the contact point and change of the normal
    shift = load.touch.Y * (sign * wp.cross(phi, n) + load.touch.H * (u2 - u1))
    ds = u1 + shift + (load.touch.between * wp.dot(n, u2 - u1)) * n
    dn = load.touch.H * (ds - u2)
    if sign < real(0.0):
        dn += wp.cross(phi, n)
    # approach, its rate and the normal force
    da = wp.dot(n, u2 - u1)
    dv = sign * (vel * dr + wp.cross(domega, x - side.r) - wp.cross(own.omega, dr))
    dv += wp.cross(spin, ds)
    drate = -wp.dot(dn, load.velocity) - wp.dot(n, dv)
    dF = load.by_approach * da + load.by_rate * drate
    out = Answer()
    out.x = ds
    out.n = dn
    out.f = dF * n + load.force * dn
    out.force = dF
    out.turning = sign * domega
    mu = model.elements[0].lumped.friction[contact]
    # friction with stick: change of the slip, of the rotated old force, and of the trial force
    if load.regime == STICKS or load.regime == SLIPS:
        dslip = sign * (dr + wp.cross(dturn, own.lever) - own.share * wp.cross(own.turn, dr))
        dslip += wp.cross(turn, ds)
        dtang = tangential(n, dslip) - wp.dot(n, load.slip) * dn - wp.dot(dn, load.slip) * n
        dangle = real(0.5) * wp.dot(old_normal, dturn)
        dspun = dangle * wp.cross(old_normal, load.spun)
        q = real(1.0) + wp.dot(old_normal, n)
        dturned = zero
        if q > real(0.0):
            along = wp.dot(n, load.spun)
            dalong = wp.dot(dn, load.spun) + wp.dot(n, dspun)
            dturned = dspun - (along / q) * dn
            dturned -= (dalong / q - along * wp.dot(old_normal, dn) / (q * q)) * (n + old_normal)
        dtrial = load.kept * dturned + (load.kept_bend * da) * load.turned
        dtrial -= load.shear * dtang + (load.shear_bend * da) * tangential(n, load.slip)
        if load.regime == STICKS:
            out.f += dtrial
        else:
            out.f += change_at_bound(load.trial, mu * load.force, dtrial, mu * dF)
    # regularised friction
    if load.regime == CREEPS or load.regime == RUBS:
        creep = model.elements[0].lumped.slip_velocity[contact]
        v = tangential(n, load.velocity)
        dtang = tangential(n, dv) - wp.dot(n, load.velocity) * dn - wp.dot(dn, load.velocity) * n
        if load.regime == CREEPS:
            out.f -= (mu / creep) * (dF * v + load.force * dtang)
        else:
            speed = wp.length(v)
            bound = beyond_creep(model, contact, speed)
            change = bound[0] * dF + bound[1] * load.force * wp.dot(v, dtang) / speed
            out.f -= change_at_bound(v, bound[0] * load.force, dtang, change)
    return out
