"""Planes and surfaces of revolution on the device: profiles, charts and signed distances.

Coordinates are components along e_0, e_1, e_a of the surface's frame, measured from its origin. A *plane* has the point
(0, theta, z), theta in metres, and the normal e_0. A *surface of revolution* has the point (R cos theta, R sin theta,
z) with the profile

    R(z) = R_0 + T z - arc(z) - table(z),        arc(z) = sign(Rc) z^2/(|Rc| + sqrt(Rc^2 - z^2)),

the arc in a form free of cancellation for a flat crown; Rc > 0 decreases away from z = 0 (crown, sphere where Rc =
R_0), Rc < 0 increases (a groove around a shaft). The table is piecewise cubic, extrapolated by its first and last
pieces. `side` is 1 if the material is inside (shaft, ball), -1 if it is outside (bore, ring, cup); normals point out of
it:

    n = side (e_r - R' e_a)/sqrt(1 + R'^2),        e_theta = side (-sin theta, cos theta, 0),        e_theta x t_z = n.

Signed distance, positive in the free space: side times that of the point (rho, zeta) of the meridian plane from the
profile, positive away from the axis. With d = rho - R_0 it is

    a straight line (cylinder, cone)   (d - T zeta)/sqrt(1 + T^2),            foot z = (zeta + T d)/(1 + T^2),
    an arc (crown, sphere, groove)     sign(Rc) (d (d + 2 Rc) + zeta^2)/(h + |Rc|), h = sqrt((d + Rc)^2 + zeta^2),
                                       foot z = |Rc| zeta/h,

exactly: the arc's centre lies at radius R_0 - Rc, and (h - |Rc|)(h + |Rc|) is free of cancellation. A hollow arc (side
sign(Rc) = -1) ends 135 degrees from its bottom, 45 degrees beyond the groove of a thrust bearing's washer: for a point
beyond that (sign(Rc) (d + Rc) + |zeta| < 0), or beyond the centre and not near the arc, as of a ball that comes from
outside, the foot is the nearer end. Beyond a half circle R(z) is another branch.
Other profiles require the foot, the root of f(z) = zeta - z + (rho - R) R', by Newton's method; the error of the
distance (rho - R - (zeta - z) R')/sqrt(1 + R'^2) is quadratic in the error of the foot. The gradient of the distance is
the normal n at the foot. It rotates with the point: around the axis by n_rho/rho, along the meridian by kappa/(1 +
kappa d), the curvature of the parallel surface through the point (kappa that of the foot, d the distance).
"""

import math

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3

wp.set_module_options(MODULE_OPTIONS)

FOOT_STEPS = wp.constant(12)  # of Newton's method for a foot; four suffice if the gap is small against the curvature
FOOT_TOLERANCE = wp.constant(wp.float64(1.0e-9))  # of the radius: the error of the distance is its square
STEEPEST = wp.constant(wp.float64(1.0e-6))  # of an arc's radius: minimum height over its ends, where the slope diverges
LEAST_BEND = wp.constant(wp.float64(0.25))  # of 1 + R'^2: lower bound of Newton's slope, also past the evolute
EVOLUTE = wp.constant(wp.float64(1.0e-12))  # of 1 + kappa d: nearer to the evolute the normal is undefined
DEEPEST = wp.constant(wp.float64(1.5))  # of an arc's radius: largest distance from its centre beyond the half circle
DIAGONAL = wp.constant(wp.float64(0.7071067811865476))  # cosine of the 45 degrees by which a hollow arc is longer
CENTRE = wp.constant(wp.float64(1.0e-14))  # m: nearer to an arc's centre the direction is undefined
TWO_PI = wp.constant(wp.float64(2.0 * math.pi))


@wp.func
def table_of(model: Model, s: int, z: real) -> vec3:
    """Drop of the profile table at z [m], its slope and its curvature."""
    count = model.surfaces.table_count[s]
    if count == 0:
        return vec3(real(0.0), real(0.0), real(0.0))
    first = model.surfaces.table_start[s]
    low = int(0)
    high = count
    while high - low > 1:
        middle = (low + high) / 2
        if z >= model.surfaces.table_break[first + middle]:
            low = middle
        else:
            high = middle
    i = first + low
    t = z - model.surfaces.table_break[i]
    c1 = model.surfaces.table_coefficient[i, 1]
    c2 = model.surfaces.table_coefficient[i, 2]
    c3 = model.surfaces.table_coefficient[i, 3]
    slope = c1 + t * (real(2.0) * c2 + t * real(3.0) * c3)
    bend = real(2.0) * c2 + real(6.0) * c3 * t
    value = model.surfaces.table_coefficient[i, 0] + t * (c1 + t * (c2 + t * c3))
    return vec3(value, slope, bend)


@wp.func
def profile_of(model: Model, s: int, z: real) -> vec3:
    """R [m], R' and R'' [1/m] of a surface of revolution at z [m]."""
    value = model.surfaces.radius[s] + model.surfaces.tangent[s] * z
    slope = model.surfaces.tangent[s]
    bend = real(0.0)
    crown = model.surfaces.crown[s]
    if crown != real(0.0):
        a = wp.abs(crown)
        sign = crown / a
        root = wp.sqrt(wp.max(a * a - z * z, STEEPEST * STEEPEST * a * a))
        value -= sign * z * z / (a + root)
        slope -= sign * z / root
        bend -= sign * a * a / (root * root * root)
    if model.surfaces.table_count[s] > 0:
        drop = table_of(model, s, z)
        value -= drop[0]
        slope -= drop[1]
        bend -= drop[2]
    return vec3(value, slope, bend)


@wp.struct
class Foot:
    """Foot of a point: theta (rad, for a plane m) and z [m], the signed distance [m] and its unit gradient."""

    theta: real
    z: real
    distance: real
    normal: vec3


@wp.func
def period_of(model: Model, s: int) -> real:
    """Period of theta: 2 pi, of a closed curve its length [m], 0 without one."""
    if model.surfaces.planar[s] != 0:
        return model.surfaces.curve_length[s]
    return TWO_PI


@wp.func
def radius_of(model: Model, s: int, z: real) -> real:
    """R [m] at z [m]; of a plane 1, so that arc length is radius * theta everywhere."""
    if model.surfaces.planar[s] != 0:
        return real(1.0)
    return profile_of(model, s, z)[0]


@wp.func
def slope_of(model: Model, s: int, z: real) -> real:
    """dR/dz at z [m]; of a plane 0."""
    if model.surfaces.planar[s] != 0:
        return real(0.0)
    return profile_of(model, s, z)[1]


@wp.func
def meridian_of(model: Model, s: int, rho: real, zeta: real) -> wp.vec4d:
    """For a point at radius rho and axial position zeta [m]: z of its foot, the signed distance, positive away from the
    axis, and its gradient with respect to rho and zeta."""
    d = rho - model.surfaces.radius[s]
    crown = model.surfaces.crown[s]
    tangent = model.surfaces.tangent[s]
    one = real(1.0)
    if model.surfaces.table_count[s] == 0:
        if crown == real(0.0):
            square = one + tangent * tangent
            root = wp.sqrt(square)
            return wp.vec4d((zeta + tangent * d) / square, (d - tangent * zeta) / root, one / root, -tangent / root)
        if tangent == real(0.0):
            a = wp.abs(crown)
            sign = crown / a
            h = wp.sqrt((d + crown) * (d + crown) + zeta * zeta)
            distance = sign * (d * (d + real(2.0) * crown) + zeta * zeta) / (h + a)
            side = model.surfaces.side[s]
            off_arc = sign * (d + crown) + wp.abs(zeta) < real(0.0)
            if side * sign < real(0.0) and (off_arc or (sign * (d + crown) < real(0.0) and h > DEEPEST * a)):
                end = DIAGONAL * a
                if zeta < real(0.0):
                    end = -end
                off = d + crown + sign * DIAGONAL * a
                away = wp.sqrt(off * off + (zeta - end) * (zeta - end))
                scale = side / wp.max(away, CENTRE)
                return wp.vec4d(end, side * away, scale * off, scale * (zeta - end))
            if h < CENTRE:
                return wp.vec4d(real(0.0), distance, one, real(0.0))
            return wp.vec4d(a * zeta / h, distance, sign * (d + crown) / h, sign * zeta / h)
    z = zeta
    limit = real(1.0e300)
    if crown != real(0.0):
        limit = wp.abs(crown) * (one - STEEPEST)
        z = wp.clamp(z, -limit, limit)
    p = profile_of(model, s, z)
    step = int(0)
    while step < FOOT_STEPS:
        square = one + p[1] * p[1]
        off = zeta - z + (rho - p[0]) * p[1]
        move = off / wp.max(square - (rho - p[0]) * p[2], LEAST_BEND * square)
        z = wp.clamp(z + move, -limit, limit)
        p = profile_of(model, s, z)
        step += 1
        if wp.abs(move) <= FOOT_TOLERANCE * model.surfaces.radius[s]:
            step = FOOT_STEPS
    root = wp.sqrt(one + p[1] * p[1])
    return wp.vec4d(z, (rho - p[0] - (zeta - z) * p[1]) / root, one / root, -p[1] / root)


@wp.func
def smooth_distance(model: Model, s: int, x: vec3) -> real:
    """Signed distance [m] of x from a plane or a surface of revolution, positive in the free space."""
    if model.surfaces.planar[s] != 0:
        return x[0]
    return model.surfaces.side[s] * meridian_of(model, s, wp.sqrt(x[0] * x[0] + x[1] * x[1]), x[2])[1]


@wp.func
def smooth_foot(model: Model, s: int, x: vec3) -> Foot:
    """The foot of x on a plane or a surface of revolution; on the axis the gradient has no radial part."""
    found = Foot()
    if model.surfaces.planar[s] != 0:
        found.theta = x[1]
        found.z = x[2]
        found.distance = x[0]
        found.normal = vec3(real(1.0), real(0.0), real(0.0))
        return found
    rho = wp.sqrt(x[0] * x[0] + x[1] * x[1])
    foot = meridian_of(model, s, rho, x[2])
    side = model.surfaces.side[s]
    found.theta = wp.atan2(x[1], x[0])
    found.z = foot[0]
    found.distance = side * foot[1]
    scale = real(0.0)
    if not rho < CENTRE:
        scale = side * foot[2] / rho
    found.normal = vec3(scale * x[0], scale * x[1], side * foot[3])
    return found


@wp.func
def smooth_expansion(model: Model, s: int, x: vec3):
    """Of a plane or a surface of revolution: the signed distance, its gradient, and the derivative [1/m] of that by x:
    symmetric, 0 along the normal; no circumferential part on the axis."""
    if model.surfaces.planar[s] != 0:
        return x[0], vec3(real(1.0), real(0.0), real(0.0)), mat33()
    rho = wp.sqrt(x[0] * x[0] + x[1] * x[1])
    foot = meridian_of(model, s, rho, x[2])
    side = model.surfaces.side[s]
    if rho < CENTRE:
        return side * foot[1], vec3(real(0.0), real(0.0), side * foot[3]), mat33()
    radial = vec3(x[0] / rho, x[1] / rho, real(0.0))
    around = vec3(-radial[1], radial[0], real(0.0))
    axial = vec3(real(0.0), real(0.0), real(1.0))
    along = foot[2] * axial - foot[3] * radial
    crown = model.surfaces.crown[s]
    kappa = real(0.0)
    if model.surfaces.table_count[s] == 0 and model.surfaces.tangent[s] == real(0.0):
        if crown != real(0.0):
            kappa = real(1.0) / crown
    else:
        p = profile_of(model, s, foot[0])
        square = real(1.0) + p[1] * p[1]
        kappa = -p[2] / (square * wp.sqrt(square))
    scale = real(1.0) + kappa * foot[1]
    scale = wp.sign(scale) * wp.max(wp.abs(scale), EVOLUTE)
    bend = side * kappa / scale
    H = side * foot[2] / rho * wp.outer(around, around) + bend * wp.outer(along, along)
    return side * foot[1], side * (foot[2] * radial + foot[3] * axial), H
