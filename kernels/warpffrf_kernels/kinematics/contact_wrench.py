"""The wrench of a pressure at points, free of torque about the axes of both bodies.

Pressure acts along the gradient of the gap g = d_B(x), n = grad d_B, the normal of B at the foot of the point x on A.
With u = tau + w x (x - O) the motion of A relative to B (translation of the point O of A's axis, rotation w), the gap
of a point fixed in A's material changes by n.u, which is a force n at x: a line through B's axis, but offset from A's
by the angle between the two normals. That torque about A's axis is not physical: A is a body of revolution, its
rotation about its axis moves only its grid. As on the line of centres (`line_of_centres`) the position on the grid is
therefore a parameter of the contact energy, and a point is fixed in the frame of the *contact*: the closest point, at
the angle theta* of A's section through the point, moves with the bodies, and the point moves over A's material with it,

    dg = n.u + (dg/dtheta) dtheta*(u),      dg/dtheta = n.(R e_theta) = q, the moment of n at x about A's axis.

theta* is the root of h = n.e_theta, evaluated at x*, the angle of the overall closest point in the point's section.
With H = dn/dx, the derivative of the normal there,

    dtheta*(u) = -[(H u*).e_theta + n.(w x e_theta)]/(R e_theta.H e_theta - n.e_r),      u* = tau + w x (x* - O).

Rotation of A about its axis gives dtheta* = -1 and dg = 0. Rotation of B about its axis leaves d_B unchanged: n.u = 0
at every point, and h too, as H (e_B x y) = e_B x n: dg = 0. Both hold for any x*. The unit pressure at x exerts on A

    the force n + q D_f,      the moment about O  (x - O) x n + q D_m,      D_f = -H e_theta/N,
    D_m = -((x* - O) x H e_theta + e_theta x n)/N,      N = R e_theta.H e_theta - n.e_r,

and the opposite on B, at the same point: action equals reaction, and the torque about either axis vanishes identically.
Parallel cylinders: H = e_theta e_theta/rho_B, D_f = -e_theta/|c|, c the vector from axis to axis, and the force is

    n - e_theta (n.e_theta) R/|c| = c/|c| cos(angle of n to c):      along the line of centres.

Against a plane H = 0: the force is n, its moment about A's axis is left out. A *plane* and a *height* as A have no
axis: their wrench is that of n at x.

An *extruded curve* x(theta) has x' and x'' in the place of R e_theta and -R e_r,

    q = n.x',      D_f = -H x'/N,      D_m = -(x* x H x' + x' x n)/N,      N = x'.H x' + n.x'',

N the relative curvature of the two surfaces. The whole torque about its axis remains: that of its rotation on the gap.

The rotation of a *sphere* about any line through its centre O moves only its grid. The direction of its closest point
from the centre is e = -n(O), de = -(H tau - w x n), and the frame of the contact rotates by -w - e x H tau, minus the
part about e that must not arise from B's rotation about its own axis. With q = (x - O) x n the unit pressure exerts

    the force n - H (q x e) + (q.e) (e.e_B)/rho e_phi      at the centre, and no moment about it,

rho the distance of O from B's axis e_B, e_phi the circumferential direction around that axis.

**Conformal surfaces.** A pin in its bore has |c| = R_B - R_A: the line of centres rotates by a degree for a motion of a
few microns, and the force rotates with it. The wrench above includes this, but its linearisation at fixed pressures
does not. If N (for a sphere 1/(R |H|)) is below HUGGING, the linear systems use n.u for the gradient of the gap, with
only A's own rotation removed, D_f = 0 and D_m = -e_A, under which pressures move from one side of the patch to the
other as the pin moves; the forces are those above in any case.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.model import AT_POINTS, Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.kinematics.closest_point import BEYOND, view_of
from warpffrf_kernels.surfaces.helical import rotated, twist_of
from warpffrf_kernels.surfaces.surface import (
    EXTRUDED,
    HEIGHT,
    PLANE,
    foot_of,
    gradient_slope_of,
    local_point,
    section_at,
)

wp.set_module_options(MODULE_OPTIONS)

HUGGING = wp.constant(wp.float64(0.05))  # distance of the axes over A's radius, of parallel cylinders
COAXIAL = wp.constant(wp.float64(1.0e-9))  # the same: n.e_theta is then round-off, and no part is removed


@wp.func
def is_sphere(model: Model, s: int) -> bool:
    """Ball or cup, whose centre is the origin of its frame."""
    plain = (
        model.surfaces.planar[s] == 0 and model.surfaces.table_count[s] == 0 and model.surfaces.tangent[s] == real(0.0)
    )
    return plain and model.surfaces.crown[s] == model.surfaces.radius[s]


@wp.struct
class Held:
    """Rotation of the contact frame about A's axis due to a motion of A relative to B, of one section: D_f and D_m of
    the module docstring, in A's surface frame; `hugs`: 1 if the linear systems omit D_f."""

    by_move: vec3
    by_turn: vec3
    hugs: int


@wp.func
def held_section(model: Model, A: int, B: int, at: vec3, turn: mat33, column: real, z: real) -> Held:
    """For the section z of A, seen from B as `at + turn x`; `column` of the closest point."""
    theta = model.surfaces.theta[A] + column * model.surfaces.pitch[A]
    x = local_point(model, A, theta, z)
    way = vec3(-x[1], x[0], real(0.0))  # dx/dtheta, and its derivative
    bend = vec3(-x[0], -x[1], real(0.0))
    least = real(0.0)
    if model.surfaces.planar[A] == EXTRUDED:
        curve = section_at(model, A, theta)
        angle = twist_of(model, A) * z
        way = rotated(vec3(curve.slope[0], curve.slope[1], real(0.0)), angle)
        bend = rotated(vec3(curve.bend[0], curve.bend[1], real(0.0)), angle)
        least = COAXIAL / model.length
    y = at + turn * x
    back = wp.transpose(turn)
    n = back * foot_of(model, B, y).normal
    bent = back * (gradient_slope_of(model, B, y) * (turn * way))
    N = wp.dot(way, bent) + wp.dot(n, bend)
    own = wp.length(bend)
    out = Held()
    if wp.abs(N) < wp.max(COAXIAL * own, least):
        return out
    out.by_move = -bent / N
    out.by_turn = -(wp.cross(x, bent) + wp.cross(way, n)) / N
    if model.surfaces.planar[A] == 0:
        out.by_turn[2] = real(-1.0)
    if wp.abs(N) < HUGGING * own:
        out.hugs = 1
    return out


@wp.func
def held_sphere(model: Model, B: int, at: vec3, turn: mat33) -> mat33:
    """Matrix that maps q to the force in addition to n, for a sphere A whose centre is `at` in B's frame."""
    back = wp.transpose(turn)
    e = -(back * foot_of(model, B, at).normal)
    force = back * gradient_slope_of(model, B, at) * turn * wp.skew(e)
    rho = wp.sqrt(at[0] * at[0] + at[1] * at[1])
    if model.surfaces.planar[B] == 0 and rho > real(0.0):
        around = back * vec3(-at[1] / rho, at[0] / rho, real(0.0))
        axis = back * vec3(real(0.0), real(0.0), real(1.0))
        force += wp.dot(e, axis) / rho * wp.outer(around, e)
    return force


@kernel
def hold_contact_frame(run: Run, trial: Trial, geometry: ContactGeometry, held: wp.array3d(dtype=Held)):
    """Per (world, pair of family 1), lanes over the points of a column: the contact frame in each one's section, and
    that of a sphere."""
    w, pair, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].moved == 0 or model.pairs.family[pair] != AT_POINTS:
        return
    A = model.pairs.first[pair]
    B = model.pairs.second[pair]
    if model.surfaces.planar[A] == PLANE:
        return
    view = view_of(model, w, pair, trial)
    if is_sphere(model, A):
        if lane == 0:
            geometry.held_ball[w, pair] = held_sphere(model, B, view.at, view.turn)
        return
    p = lane
    known = real(BEYOND)
    section = Held()
    while p < model.points.count[pair]:
        z = model.points.z[model.points.start[pair] + p]
        if z != known:
            known = z
            section = held_section(model, A, B, view.at, view.turn, geometry.nearest[w, pair, 0], z)
        held[w, pair, p] = section
        p += wp.block_dim()


@wp.struct
class Wrench:
    """Wrench of a unit pressure at a point: force and moment about the origin of A's surface frame, in it, as used by
    the linear systems, and the additional part of the true ones."""

    force: vec3
    moment: vec3
    more_force: vec3
    more_moment: vec3


@wp.func
def point_wrench(model: Model, A: int, x: vec3, way: vec3, n: vec3, section: Held, ball: mat33) -> Wrench:
    """For the point x of A with the normal n of B, both in A's surface frame; `way`: dx/dtheta, of no use on a
    plane."""
    out = Wrench()
    out.force = n
    out.moment = wp.cross(x, n)
    if model.surfaces.planar[A] == PLANE or model.surfaces.planar[A] == HEIGHT:
        return out
    if is_sphere(model, A):
        more = ball * out.moment
        out.moment = vec3(real(0.0), real(0.0), real(0.0))
        if model.surfaces.radius[A] * wp.sqrt(wp.ddot(ball, ball)) * HUGGING > real(1.0):
            out.more_force = more
        else:
            out.force += more
        return out
    q = wp.dot(n, way)
    if section.hugs != 0:
        out.more_force = q * section.by_move
        out.more_moment = q * section.by_turn
        if model.surfaces.planar[A] == 0:
            out.moment[2] = real(0.0)
            out.more_moment[2] = real(0.0)
    else:
        out.force += q * section.by_move
        out.moment += q * section.by_turn
    return out
