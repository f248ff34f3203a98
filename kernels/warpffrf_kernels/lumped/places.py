r"""Closest points of two rigid surfaces, and their motion with the two bodies.

A surface is defined by its signed distance d(x), positive in the free space, whose gradient is the unit normal n at the
foot of x and whose Hessian H (zero along n) is the curvature of the surface through x (`surfaces.surface`). No chart is
used, so that poles of a ball and other chart singularities are harmless.

**Closest points.** The sum d_1 + d_2 is stationary where n_1 + n_2 = 0: x lies on the common normal, along which the
sum is constant. Its value is the gap g, the distance of separated surfaces, minus the depth of overlapping ones. It is
a minimum across the normal for surfaces with a single contact point, the Hessian H_1 + H_2 there the relative
curvature; Newton's method, with eigenvalues kept positive and steps that must not increase the sum, finds it from the
foot of one surface's centre on the other, the better of both. x is placed half-way, d_1 = d_2.

**A lamina** of a roller is the circle x = c + R e_r(theta) about the roller's axis at an axial position z, R = R(z).
Its gap is the minimum of d_2 over the circle, where n_2 . e_theta = 0.

**Motions.** For small motions of the bodies that displace x by u_i = dr_i + phi_i x (x - r_i) and rotate by phi_i, and
n = n_2 (= -n_1 of points), the gap changes by

    dg = n . (u_1 - u_2)

in both cases, as x is stationary: a force F against -g acts with F n on body 1 and -F n on body 2 at the same point x,
has the potential int F, and balances in force and moment. The contact point itself moves by

    dx = u_1 + Y [(phi_1 - phi_2) x n + H_2 (u_2 - u_1)] (+ n n . (u_2 - u_1)/2 of points),
    dn = phi_2 x n + H_2 (dx - u_2),

Y the inverse of the relative curvature across the normal (of points), or R/(R e_theta . H_2 e_theta - n . e_r) along
e_theta (of laminae). A ball of radius R on a plane: H_2 = 0, Y = R, dx = u_1 + R phi_1 x n: the point stays below the
centre. If the relative curvature vanishes in a direction (two parallel cylinders) the point is not determined there,
and does not move in that direction relative to body 1.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3
from warpffrf_kernels.core.scratch import Trial
from warpffrf_kernels.lumped.form import depth_at, form_bend, formed_normal
from warpffrf_kernels.surfaces.smooth import profile_of, smooth_distance, smooth_expansion, smooth_foot
from warpffrf_kernels.surfaces.surface import axes_of, origin_of

wp.set_module_options(MODULE_OPTIONS)

STEPS = wp.constant(40)  # of Newton's method; four or five suffice from the foot of a ball's or a roller's centre
HALVINGS = wp.constant(30)  # of a step that would increase the sum of the distances
ARRIVED = wp.constant(wp.float64(1.0e-15))  # sine between the normals: the error of the gap is its square
NEAR = wp.constant(wp.float64(1.0e-8))  # of it: the next step, whose error is about its square, is the last
# of the sum of the distances, over the size of the surfaces: a smaller increase in a step is round-off
ROUND_OFF = wp.constant(wp.float64(1.0e-15))
# of a step, if a surface has a form, whose slopes are of first order: the allowed increase of the sum, their square
SLOPES = wp.constant(wp.float64(1.0e-5))
FLAT = wp.constant(wp.float64(1.0e-7))  # of the larger curvature: a smaller relative curvature counts as zero
# of the radius: for a centre this close to the other's axis the direction is undefined
CENTRED = wp.constant(wp.float64(1.0e-9))
OFF_CENTRE = wp.constant(wp.float64(1.0e-3))  # of the radius: offset used for such a centre


@wp.struct
class Side:
    """A surface in the world: its number, axes e_0, e_1, e_a in columns, origin; of its body axes and centre of
    mass."""

    surface: int
    body: int
    Q: mat33
    o: vec3
    A: mat33
    r: vec3


@wp.struct
class Touch:
    """A contact point: x, the normal n of the second surface, H_2 and Y of the module docstring, the gap g; `between`:
    1 if x is half-way."""

    x: vec3
    n: vec3
    H: mat33
    Y: mat33
    gap: real
    between: real


@wp.func
def side_in_world(model: Model, w: int, s: int, trial: Trial) -> Side:
    out = Side()
    out.surface = s
    out.body = model.surfaces.body[s]
    out.A = axes_of(trial.axes, w, out.body)
    out.r = origin_of(trial.r1, w, out.body)
    out.Q = out.A * model.surfaces.frame[s]
    out.o = out.r + out.A * model.surfaces.origin[s]
    return out


@wp.func
def distance_at(model: Model, side: Side, x: vec3) -> real:
    y = wp.transpose(side.Q) * (x - side.o)
    d = smooth_distance(model, side.surface, y)
    if model.elements[0].lumped.form_count[side.surface] != 0:
        d += depth_at(model, side.surface, y)[0]
    return d


@wp.func
def normal_at(model: Model, side: Side, x: vec3) -> vec3:
    y = wp.transpose(side.Q) * (x - side.o)
    n = smooth_foot(model, side.surface, y).normal
    if model.elements[0].lumped.form_count[side.surface] != 0:
        n = formed_normal(model, side.surface, y, n)
    return side.Q * n


@wp.func
def is_ball(model: Model, s: int) -> int:
    """1 for a sphere or a cup: an arc about a point of the axis."""
    ball = model.surfaces.crown[s] == model.surfaces.radius[s] and model.surfaces.planar[s] == 0
    if ball and model.surfaces.tangent[s] == real(0.0) and model.surfaces.table_count[s] == 0:
        return 1
    return 0


@wp.func
def expansion_at(model: Model, side: Side, x: vec3):
    """`distance_at`, `normal_at` and the Hessian of the distance, 1/m; of a ball also at its poles, where the chart is
    singular."""
    y = wp.transpose(side.Q) * (x - side.o)
    s = side.surface
    d, n, H = smooth_expansion(model, s, y)
    if is_ball(model, s) != 0:
        h = wp.length(y)
        if h > real(0.0):
            e = y / h
            H = (model.surfaces.side[s] / h) * (wp.identity(n=3, dtype=real) - wp.outer(e, e))
    if model.elements[0].lumped.form_count[s] != 0:
        d += depth_at(model, s, y)[0]
        n = formed_normal(model, s, y, n)
        H = H + form_bend(model, s, y)
    return d, side.Q * n, side.Q * H * wp.transpose(side.Q)


@wp.func
def off_axis(model: Model, side: Side, x: vec3) -> vec3:
    """x, moved off the axis of the surface if it lies on it: the closest point is undefined there."""
    if model.surfaces.planar[side.surface] != 0:
        return x
    y = wp.transpose(side.Q) * (x - side.o)
    R = model.surfaces.radius[side.surface]
    if y[0] * y[0] + y[1] * y[1] > CENTRED * CENTRED * R * R:
        return x
    return x + side.Q * vec3(OFF_CENTRE * R, real(0.0), real(0.0))


@wp.func
def foot_of_middle(model: Model, one: Side, other: Side) -> vec3:
    """Initial point: the foot on `other` of the centre of `one`, moved to the surface of `one`."""
    c = off_axis(model, other, one.o)
    n = normal_at(model, other, c)
    if is_ball(model, one.surface) != 0 and model.surfaces.side[one.surface] > real(0.0):
        return c - model.surfaces.radius[one.surface] * n  # its own point on the common normal
    return c - distance_at(model, other, c) * n


@wp.func
def across(n: vec3):
    """Two unit vectors perpendicular to n and each other."""
    e = vec3(real(1.0), real(0.0), real(0.0))
    if wp.abs(n[0]) > wp.abs(n[1]):
        e = vec3(real(0.0), real(1.0), real(0.0))
    t = wp.normalize(wp.cross(n, e))
    return t, wp.cross(n, t)


@wp.func
def inverse_across(H: mat33, n: vec3, clipped: int) -> mat33:
    """Inverse of H across n. `clipped`: eigenvalues made positive, at least FLAT of the largest, as a descent requires;
    else directions without curvature have the inverse 0."""
    t, s = across(n)
    a = wp.dot(t, H * t)
    b = wp.dot(t, H * s)
    c = wp.dot(s, H * s)
    half = real(0.5) * (a - c)
    root = wp.sqrt(half * half + b * b)
    mean = real(0.5) * (a + c)
    large = mean + root
    small = mean - root
    e = t  # of the larger eigenvalue
    if root > real(0.0):
        if half >= real(0.0):
            e = wp.normalize((half + root) * t + b * s)
        else:
            e = wp.normalize(b * t + (root - half) * s)
    f = wp.cross(n, e)
    top = wp.max(wp.abs(large), wp.abs(small))
    if top == real(0.0):
        return mat33()
    if clipped != 0:
        large = wp.max(wp.abs(large), FLAT * top)
        small = wp.max(wp.abs(small), FLAT * top)
        return wp.outer(e, e) / large + wp.outer(f, f) / small
    out = mat33()
    if wp.abs(large) > FLAT * top:
        out = out + wp.outer(e, e) / large
    if wp.abs(small) > FLAT * top:
        out = out + wp.outer(f, f) / small
    return out


@wp.func
def nearest_points(model: Model, first: Side, second: Side) -> Touch:
    """The common normal of two surfaces with a single contact point."""
    x = foot_of_middle(model, first, second)
    if model.surfaces.planar[first.surface] != 0:
        x = foot_of_middle(model, second, first)
    elif model.surfaces.planar[second.surface] == 0:
        other = foot_of_middle(model, second, first)
        here = distance_at(model, first, x) + distance_at(model, second, x)
        if distance_at(model, first, other) + distance_at(model, second, other) < here:
            x = other
    d1, n1, H1 = expansion_at(model, first, x)
    d2, n2, H2 = expansion_at(model, second, x)
    size = model.surfaces.radius[first.surface] + model.surfaces.radius[second.surface]
    slopes = real(0.0)
    if model.elements[0].lumped.form_count[first.surface] != 0:
        slopes = SLOPES
    if model.elements[0].lumped.form_count[second.surface] != 0:
        slopes = SLOPES
    step = int(0)
    while step < STEPS:
        m = wp.normalize(n2 - n1)
        slope = n1 + n2
        move = real(0.5) * (d1 - d2) * m
        if wp.length(slope) > ARRIVED:
            move -= inverse_across(H1 + H2, m, 1) * slope
        halving = int(0)
        if wp.length(slope) <= NEAR:
            step = STEPS
            halving = HALVINGS
            x += move
        while halving < HALVINGS:
            y = x + move
            sum = distance_at(model, first, y) + distance_at(model, second, y)
            if sum <= d1 + d2 + ROUND_OFF * size + slopes * wp.length(move):
                x = y
                halving = HALVINGS
            else:
                move = real(0.5) * move
                halving += 1
                if halving == HALVINGS:
                    step = STEPS
        d1, n1, H1 = expansion_at(model, first, x)
        d2, n2, H2 = expansion_at(model, second, x)
        step += 1
    out = Touch()
    out.x = x
    out.n = wp.normalize(n2 - n1)
    out.H = H2
    out.Y = inverse_across(H1 + H2, out.n, 0)
    out.gap = d1 + d2
    out.between = real(0.5)
    return out


@wp.func
def nearest_of_lamina(model: Model, roller: Side, second: Side, z: real) -> Touch:
    """The point of the circle about the roller's axis at z [m] that is deepest in the second surface."""
    e_a = vec3(roller.Q[0, 2], roller.Q[1, 2], roller.Q[2, 2])
    R = profile_of(model, roller.surface, z)[0]
    c = roller.o + z * e_a
    n = normal_at(model, second, off_axis(model, second, c))
    e_r = -wp.normalize(n - wp.dot(n, e_a) * e_a)
    e_t = wp.cross(e_a, e_r)
    x = c + R * e_r
    d, n, H = expansion_at(model, second, x)
    curved = R * wp.dot(e_t, H * e_t) - wp.dot(n, e_r)  # of d_2 over the circle, over R
    step = int(0)
    while step < STEPS and wp.abs(wp.dot(n, e_t)) > ARRIVED:
        turn = wp.clamp(-wp.dot(n, e_t) / wp.max(wp.abs(curved), FLAT), real(-0.5), real(0.5))
        if wp.abs(wp.dot(n, e_t)) <= NEAR:
            step = STEPS
        else:
            halving = int(0)
            while halving < HALVINGS:
                r = wp.cos(turn) * e_r + wp.sin(turn) * e_t
                if distance_at(model, second, c + R * r) <= d + ROUND_OFF * R:
                    halving = HALVINGS
                else:
                    turn = real(0.5) * turn
                    halving += 1
                    if halving == HALVINGS:
                        step = STEPS
        e_r = wp.normalize(wp.cos(turn) * e_r + wp.sin(turn) * e_t)
        e_t = wp.cross(e_a, e_r)
        x = c + R * e_r
        d, n, H = expansion_at(model, second, x)
        curved = R * wp.dot(e_t, H * e_t) - wp.dot(n, e_r)
        step += 1
    out = Touch()
    out.x = x
    out.n = n
    out.H = H
    if wp.abs(curved) > FLAT:
        out.Y = (R / curved) * wp.outer(e_t, e_t)
    out.gap = d
    out.between = real(0.0)
    return out
