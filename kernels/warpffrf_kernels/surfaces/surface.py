"""True contact surfaces of all kinds on the device: points, normals, charts and signed distances.

Coordinates are components along e_0, e_1, e_a of the surface's frame, measured from its origin. An *extruded* surface
has the point (x(u), y(u), z), u = theta the arc length of a curve in cubic pieces, the material to its left, and the
normal (y', -x', 0)/|c'|; beyond its ends the chart of an open curve continues along its tangents, while all is free
space, at the distance of the end, and so it is below the depth of its material. The foot of a point is the root of f(u)
= (p - c).c' by Newton's method from the piece that a lattice names, negative in cells below that depth; with d the
distance and kappa the curvature the normal rotates by kappa/(1 + kappa d) along the tangent. A *helical* one is rotated
by tau z: see `helical`. *Heights* are in `height`, planes and surfaces of revolution in `smooth`.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3
from warpffrf_kernels.surfaces.height import ON_BORDER, Height, bend_of_height, height_at, height_near, height_normal
from warpffrf_kernels.surfaces.helical import helical_slope, lean_of, rotated, twist_of
from warpffrf_kernels.surfaces.smooth import (
    CENTRE,
    EVOLUTE,
    FOOT_TOLERANCE,
    LEAST_BEND,
    Foot,
    profile_of,
    smooth_expansion,
    smooth_foot,
)

wp.set_module_options(MODULE_OPTIONS)

PLANE, EXTRUDED, HEIGHT = wp.constant(1), wp.constant(2), wp.constant(3)  # `planar`: plane, extruded curve, height
PIECES = wp.constant(24)  # Newton steps along a curve, each within a piece or to the next


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
def foot_of(model: Model, s: int, x: vec3) -> Foot:
    """The foot of x, the signed distance [m], positive in the free space, and its unit gradient."""
    if model.surfaces.planar[s] >= EXTRUDED:
        return curved_foot(model, s, x)
    return smooth_foot(model, s, x)


@wp.func
def expansion_of(model: Model, s: int, x: vec3):
    """The signed distance, its gradient and the derivative [1/m] of that by x: symmetric, 0 along the
    normal."""
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
    return smooth_expansion(model, s, x)


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
