"""True contact surfaces on the device: points, normals, charts and signed distances.

Coordinates are components along e_0, e_1, e_a of the surface's frame, measured from its origin. A *plane* has the point
(0, theta, z), theta in metres, and the normal e_0. An *extruded* surface has the point (x(u), y(u), z), u = theta the
arc length of a curve in cubic pieces, the material to its left, and the normal (y', -x', 0)/|c'|; beyond its ends the
chart of an open curve continues along its tangents, while all is free space, at the distance of the end, and so it is
below the depth of its material. The foot of a point is the root of f(u) = (p - c).c' by Newton's method from the piece
that a lattice names, negative in cells below that depth; with d the distance and kappa the curvature the normal rotates
by kappa/(1 + kappa d) along the tangent. A *helical* one is rotated by tau z: see `helical`. *Heights* are in `height`.
A *surface of revolution* has the point (R cos theta, R sin theta, z) with the profile

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
from warpffrf_kernels.surfaces.height import ON_BORDER, Height, bend_of_height, height_at, height_near, height_normal
from warpffrf_kernels.surfaces.helical import helical_slope, lean_of, rotated, twist_of

wp.set_module_options(MODULE_OPTIONS)

FOOT_STEPS = wp.constant(12)  # of Newton's method for a foot; four suffice if the gap is small against the curvature
FOOT_TOLERANCE = wp.constant(wp.float64(1.0e-9))  # of the radius: the error of the distance is its square
STEEPEST = wp.constant(wp.float64(1.0e-6))  # of an arc's radius: minimum height over its ends, where the slope diverges
LEAST_BEND = wp.constant(wp.float64(0.25))  # of 1 + R'^2: lower bound of Newton's slope, also past the evolute
EVOLUTE = wp.constant(wp.float64(1.0e-12))  # of 1 + kappa d: nearer to the evolute the normal is undefined
DEEPEST = wp.constant(wp.float64(1.5))  # of an arc's radius: largest distance from its centre beyond the half circle
DIAGONAL = wp.constant(wp.float64(0.7071067811865476))  # cosine of the 45 degrees by which a hollow arc is longer
CENTRE = wp.constant(wp.float64(1.0e-14))  # m: nearer to an arc's centre the direction is undefined
PLANE, EXTRUDED, HEIGHT = wp.constant(1), wp.constant(2), wp.constant(3)  # `planar`: plane, extruded curve, height
TWO_PI = wp.constant(wp.float64(2.0 * math.pi))
PIECES = wp.constant(24)  # Newton steps along a curve, each within a piece or to the next


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


@wp.struct
class Section:
    """A place of a curve: u [m], the point [m], tangent (not of unit length) and second derivative there; `free`: 1
    where the point whose foot it is lies below the material behind the curve, or so far away that no foot is found."""

    u: real
    free: int
    point: wp.vec2d
    slope: wp.vec2d
    bend: wp.vec2d


@wp.func
def on_piece(model: Model, s: int, piece: int, t: real) -> Section:
    """The place t [m] beyond the start of a piece; beyond the ends of an open curve along the tangent there."""
    i = model.surfaces.curve_start[s] + piece
    length = model.surfaces.curve_knot[i + 1] - model.surfaces.curve_knot[i]
    inside = t
    if model.surfaces.curve_length[s] == real(0.0):
        if piece == 0:
            inside = wp.max(inside, real(0.0))
        if piece == model.surfaces.curve_count[s] - 1:
            inside = wp.min(inside, length)
    found = Section()
    found.u = model.surfaces.curve_knot[i] + t
    for axis in range(2):
        c1 = model.surfaces.curve_piece[i, 4 * axis + 1]
        c2 = model.surfaces.curve_piece[i, 4 * axis + 2]
        c3 = model.surfaces.curve_piece[i, 4 * axis + 3]
        slope = c1 + inside * (real(2.0) * c2 + inside * real(3.0) * c3)
        found.slope[axis] = slope
        found.point[axis] = (
            model.surfaces.curve_piece[i, 4 * axis] + inside * (c1 + inside * (c2 + inside * c3)) + (t - inside) * slope
        )
        if inside == t:
            found.bend[axis] = real(2.0) * c2 + real(6.0) * c3 * inside
    return found


@wp.func
def section_at(model: Model, s: int, u: real) -> Section:
    """The place u [m] of a curve."""
    first = model.surfaces.curve_start[s]
    count = model.surfaces.curve_count[s]
    period = model.surfaces.curve_length[s]
    at = u
    if period > real(0.0):
        at = u - period * wp.floor((u - model.surfaces.curve_knot[first]) / period)
    low = int(0)
    high = count
    while high - low > 1:
        middle = (low + high) / 2
        if at >= model.surfaces.curve_knot[first + middle]:
            low = middle
        else:
            high = middle
    return on_piece(model, s, low, at - model.surfaces.curve_knot[first + low])


@wp.func
def section_near(model: Model, s: int, x: real, y: real) -> Section:
    """The foot of a point of the section on a curve."""
    first = model.surfaces.curve_start[s]
    count = model.surfaces.curve_count[s]
    closed = model.surfaces.curve_length[s] > real(0.0)
    pitch = model.surfaces.seed_pitch[s]
    i = wp.clamp(int(wp.floor((x - model.surfaces.seed_corner[s, 0]) / pitch)), 0, model.surfaces.seed_columns[s] - 1)
    j = wp.clamp(int(wp.floor((y - model.surfaces.seed_corner[s, 1]) / pitch)), 0, model.surfaces.seed_rows[s] - 1)
    piece = model.surfaces.curve_seed[model.surfaces.seed_start[s] + i * model.surfaces.seed_rows[s] + j]
    free = int(0)
    if piece < 0:
        free = 1
        piece = -1 - piece
    p = wp.vec2d(x, y)
    length = model.surfaces.curve_knot[first + piece + 1] - model.surfaces.curve_knot[first + piece]
    t = real(0.5) * length
    found = on_piece(model, s, piece, t)
    step = int(0)
    while step < PIECES:
        off = p - found.point
        square = wp.dot(found.slope, found.slope)
        move = wp.dot(off, found.slope) / wp.max(square - wp.dot(off, found.bend), LEAST_BEND * square)
        t += move
        step += 1
        if t < real(0.0) and (closed or piece > 0):  # on to the end of the piece before
            piece = (piece + count - 1) % count
            length = model.surfaces.curve_knot[first + piece + 1] - model.surfaces.curve_knot[first + piece]
            t = wp.max(length + t, real(0.0))
        elif t > length and (closed or piece < count - 1):
            t -= length
            piece = (piece + 1) % count
            length = model.surfaces.curve_knot[first + piece + 1] - model.surfaces.curve_knot[first + piece]
            t = wp.min(t, length)
        elif wp.abs(move) <= FOOT_TOLERANCE * length:
            step = PIECES + 1
        found = on_piece(model, s, piece, t)
    found.free = free
    if step == PIECES:  # far away
        found.free = 1
    return found


@wp.func
def past_end(model: Model, s: int, u: real) -> real:
    """How far [m] a foot lies beyond an end of a curve: negative before its start, 0 between its ends."""
    if model.surfaces.curve_length[s] > real(0.0):
        return real(0.0)
    first = model.surfaces.curve_start[s]
    low = model.surfaces.curve_knot[first]
    high = model.surfaces.curve_knot[first + model.surfaces.curve_count[s]]
    return wp.min(u - low, real(0.0)) + wp.max(u - high, real(0.0))


@wp.func
def foot_from(model: Model, s: int, x: vec3, near: Section) -> Foot:
    """The foot at a section of an extruded curve. Its ends are edges: beyond them all is free space, at the distance of
    the end, and so it is below the material, at the distance of the curve."""
    scale = real(1.0) / wp.length(near.slope)
    found = Foot()
    found.theta = near.u
    found.z = x[2]
    found.normal = vec3(scale * near.slope[1], -scale * near.slope[0], real(0.0))
    found.distance = (x[0] - near.point[0]) * found.normal[0] + (x[1] - near.point[1]) * found.normal[1]
    past = past_end(model, s, near.u)
    if past != real(0.0) or near.free != 0:
        off = wp.vec2d(x[0], x[1]) - near.point + past * near.slope
        found.distance = wp.length(off)
        scale = real(1.0) / wp.max(found.distance, CENTRE)
        found.normal = vec3(scale * off[0], scale * off[1], real(0.0))
    return found


@wp.func
def helical_foot(found: Foot, y: vec3, twist: real) -> Foot:
    """The foot on a helical surface, from that of y in its section."""
    lean = lean_of(twist, y, found.normal)
    scale = real(1.0) / wp.sqrt(real(1.0) + lean * lean)
    n = rotated(found.normal, twist * y[2])
    found.z = y[2] + scale * scale * lean * found.distance
    found.distance = scale * found.distance
    found.normal = scale * vec3(n[0], n[1], -lean)
    return found


@wp.func
def foot_on_height(model: Model, s: int, x: vec3, near: Height) -> Foot:
    """The foot of x at a place of a height: beyond the border all is free space, at the distance of the border."""
    found = Foot()
    found.theta = near.u
    found.z = near.v
    found.normal = height_normal(near)
    off = vec3(x[0] - near.value, x[1] - near.u, x[2] - near.v)
    found.distance = wp.dot(off, found.normal)
    size = wp.max(-model.surfaces.seed_corner[s, 0], -model.surfaces.seed_corner[s, 1])
    if wp.length(off - found.distance * found.normal) > ON_BORDER * size:
        found.distance = wp.length(off)
        found.normal = off / found.distance
    return found


@wp.func
def curved_foot(model: Model, s: int, x: vec3) -> Foot:
    """`foot_of` on an extruded curve and on a height."""
    if model.surfaces.planar[s] == HEIGHT:
        return foot_on_height(model, s, x, height_near(model, s, x))
    twist = twist_of(model, s)
    y = rotated(x, -twist * x[2])
    found = foot_from(model, s, y, section_near(model, s, y[0], y[1]))
    if twist == real(0.0):
        return found
    return helical_foot(found, y, twist)


@wp.func
def curve_curvature(model: Model, s: int, u: real) -> real:
    """Curvature [1/m] of an extruded surface along its curve, positive if convex."""
    at = section_at(model, s, u)
    long = wp.length(at.slope)
    lean = twist_of(model, s) * wp.dot(at.point, at.slope) / long
    kappa = (at.slope[0] * at.bend[1] - at.slope[1] * at.bend[0]) / (long * long * long)
    return kappa / wp.sqrt(real(1.0) + lean * lean)


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
def local_point(model: Model, s: int, theta: real, z: real) -> vec3:
    """Point of the surface [m] at its chart coordinates."""
    if model.surfaces.planar[s] == EXTRUDED:
        point = section_at(model, s, theta).point
        return rotated(vec3(point[0], point[1], z), twist_of(model, s) * z)
    if model.surfaces.planar[s] == HEIGHT:
        return vec3(height_at(model, s, theta, z).value, theta, z)
    if model.surfaces.planar[s] != 0:
        return vec3(real(0.0), theta, z)
    R = profile_of(model, s, z)[0]
    return vec3(R * wp.cos(theta), R * wp.sin(theta), z)


@wp.func
def local_normal(model: Model, s: int, theta: real, z: real) -> vec3:
    """Unit normal away from the material."""
    if model.surfaces.planar[s] == EXTRUDED:
        at = section_at(model, s, theta)
        t = wp.normalize(at.slope)
        twist = twist_of(model, s)
        n = rotated(vec3(t[1], -t[0], real(0.0)), twist * z)
        n[2] = twist * wp.dot(at.point, t)
        return wp.normalize(n)
    if model.surfaces.planar[s] == HEIGHT:
        return height_normal(height_at(model, s, theta, z))
    if model.surfaces.planar[s] != 0:
        return vec3(real(1.0), real(0.0), real(0.0))
    slope = profile_of(model, s, z)[1]
    scale = model.surfaces.side[s] / wp.sqrt(real(1.0) + slope * slope)
    return vec3(scale * wp.cos(theta), scale * wp.sin(theta), -scale * slope)


@wp.func
def around_of(normal: vec3) -> vec3:
    """e_theta, the first tangential direction, of a surface with this normal: against increasing theta on an inside
    surface."""
    return wp.normalize(vec3(-normal[1], normal[0], real(0.0)))


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
    """`distance_of` from a plane or a surface of revolution."""
    if model.surfaces.planar[s] != 0:
        return x[0]
    return model.surfaces.side[s] * meridian_of(model, s, wp.sqrt(x[0] * x[0] + x[1] * x[1]), x[2])[1]


@wp.func
def distance_of(model: Model, s: int, x: vec3) -> real:
    """Signed distance [m] of x from the surface, positive in the free space."""
    if model.surfaces.planar[s] >= EXTRUDED:
        return curved_foot(model, s, x).distance
    return smooth_distance(model, s, x)


@wp.func
def chart_of(model: Model, s: int, x: vec3) -> vec3:
    """theta (rad, of a plane m) and z [m] of the foot of x, and the signed distance [m] as `distance_of`."""
    if model.surfaces.planar[s] >= EXTRUDED:
        near = curved_foot(model, s, x)
        return vec3(near.theta, near.z, near.distance)
    if model.surfaces.planar[s] != 0:
        return vec3(x[1], x[2], x[0])
    foot = meridian_of(model, s, wp.sqrt(x[0] * x[0] + x[1] * x[1]), x[2])
    return vec3(wp.atan2(x[1], x[0]), foot[0], model.surfaces.side[s] * foot[1])


@wp.func
def gradient_of(model: Model, s: int, x: vec3) -> vec3:
    """Unit gradient of the signed distance at x: the normal at its foot. On the axis it has no radial part."""
    if model.surfaces.planar[s] >= EXTRUDED:
        return curved_foot(model, s, x).normal
    if model.surfaces.planar[s] != 0:
        return vec3(real(1.0), real(0.0), real(0.0))
    rho = wp.sqrt(x[0] * x[0] + x[1] * x[1])
    foot = meridian_of(model, s, rho, x[2])
    side = model.surfaces.side[s]
    if rho < CENTRE:
        return vec3(real(0.0), real(0.0), side * foot[3])
    scale = side * foot[2] / rho
    return vec3(scale * x[0], scale * x[1], side * foot[3])


@wp.func
def distance_and_gradient(model: Model, s: int, x: vec3) -> wp.vec4d:
    """`distance_of` and `gradient_of` at once."""
    if model.surfaces.planar[s] >= EXTRUDED:
        near = curved_foot(model, s, x)
        return wp.vec4d(near.distance, near.normal[0], near.normal[1], near.normal[2])
    if model.surfaces.planar[s] != 0:
        return wp.vec4d(x[0], real(1.0), real(0.0), real(0.0))
    rho = wp.sqrt(x[0] * x[0] + x[1] * x[1])
    foot = meridian_of(model, s, rho, x[2])
    side = model.surfaces.side[s]
    scale = real(0.0)
    if not rho < CENTRE:
        scale = side * foot[2] / rho
    return wp.vec4d(side * foot[1], scale * x[0], scale * x[1], side * foot[3])


@wp.func
def foot_of(model: Model, s: int, x: vec3) -> Foot:
    """`chart_of` and `gradient_of` at once."""
    if model.surfaces.planar[s] >= EXTRUDED:
        return curved_foot(model, s, x)
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
def expansion_of(model: Model, s: int, x: vec3):
    """The signed distance, its gradient as `gradient_of`, and the derivative [1/m] of that by x: symmetric, 0 along the
    normal; no circumferential part on the axis."""
    if model.surfaces.planar[s] == HEIGHT:
        place = height_near(model, s, x)
        under = foot_on_height(model, s, x, place)
        return under.distance, under.normal, bend_of_height(place, under.distance, under.normal)
    if model.surfaces.planar[s] == EXTRUDED:
        twist = twist_of(model, s)
        y = rotated(x, -twist * x[2])
        near = section_near(model, s, y[0], y[1])
        long = wp.length(near.slope)
        found = foot_from(model, s, y, near)
        t = vec3(-found.normal[1], found.normal[0], real(0.0))
        turn = (near.slope[0] * near.bend[1] - near.slope[1] * near.bend[0]) / (long * long * long)
        grown = real(1.0) + turn * found.distance
        if past_end(model, s, near.u) != real(0.0):  # about the end
            turn = real(1.0)
            grown = found.distance
        grown = wp.sign(grown) * wp.max(wp.abs(grown), EVOLUTE)
        if twist != real(0.0):
            twisted = helical_foot(found, y, twist)
            return twisted.distance, twisted.normal, helical_slope(turn / grown, y, found.normal, twisted.normal, twist)
        return found.distance, found.normal, turn / grown * wp.outer(t, t)
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


@wp.func
def gradient_slope_of(model: Model, s: int, x: vec3) -> mat33:
    """The third of `expansion_of`."""
    distance, gradient, slope = expansion_of(model, s, x)
    return slope


@wp.func
def origin_of(r1: wp.array2d(dtype=vec3), w: int, body: int) -> vec3:
    """Centre of mass of a body in the world; for the ground (body -1) the origin."""
    if body < 0:
        return vec3(real(0.0), real(0.0), real(0.0))
    return r1[w, body]


@wp.func
def axes_of(axes: wp.array2d(dtype=mat33), w: int, body: int) -> mat33:
    """Axes of a body in the world; for the ground (body -1) the world axes."""
    if body < 0:
        return wp.identity(n=3, dtype=real)
    return axes[w, body]
