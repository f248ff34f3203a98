"""Heights over a rectangle of a plane on the device: bicubic pieces on a lattice.

A *height* has the point (h(u, v), u, v), theta = u and z = v in metres, |u| <= a, |v| <= b, and the normal (1, -h_u,
-h_v)/|...|. With J its tangents, G = J^T J, b = n_0 h'' and d the distance, Newton's matrix of the foot of a point is
G - d b, and the normal rotates with the point by -J G^-1 b (G - d b)^-1 J^T. Beyond the rectangle all is free space, at
the distance of its border.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3

wp.set_module_options(MODULE_OPTIONS)

FOOT_STEPS = wp.constant(24)  # of Newton's method for a foot, from the point below; five suffice near the surface
EVOLUTE = wp.constant(wp.float64(1.0e-12))  # of det G: nearer to a centre of curvature the normal is undefined
INDEFINITE = wp.constant(wp.float64(0.05))  # of det G: where Newton's matrix has a smaller determinant, G replaces it
ON_BORDER = wp.constant(wp.float64(1.0e-9))  # of the rectangle: where the rest along the surface is longer, it ends
SETTLED = wp.constant(wp.float64(1.0e-13))  # of the rectangle: smaller Newton steps to a foot on a height end


@wp.struct
class Height:
    """A place of a height: u and v [m], h [m], its gradient, and its second derivatives [1/m] by uu, uv, vv."""

    u: real
    v: real
    value: real
    slope: wp.vec2d
    bend: vec3


@wp.func
def height_at(model: Model, s: int, u: real, v: real) -> Height:
    """The place (u, v) [m] of a height; beyond its rectangle on the outermost pieces."""
    columns = model.surfaces.seed_columns[s]
    rows = model.surfaces.seed_rows[s]
    wide = -real(2.0) * model.surfaces.seed_corner[s, 0] / real(columns)
    high = -real(2.0) * model.surfaces.seed_corner[s, 1] / real(rows)
    x = (u - model.surfaces.seed_corner[s, 0]) / wide
    y = (v - model.surfaces.seed_corner[s, 1]) / high
    i = wp.clamp(int(wp.floor(x)), 0, columns - 1)
    j = wp.clamp(int(wp.floor(y)), 0, rows - 1)
    x -= real(i)
    y -= real(j)
    piece = model.surfaces.curve_start[s] + 2 * (i * rows + j)
    found = Height()
    power = int(3)  # of x: Horner's scheme, with a polynomial of y for each
    while power >= 0:
        row = piece + power / 2
        at = 4 * (power % 2)
        c1 = model.surfaces.curve_piece[row, at + 1]
        c2 = model.surfaces.curve_piece[row, at + 2]
        c3 = model.surfaces.curve_piece[row, at + 3]
        slope = c1 + y * (real(2.0) * c2 + y * real(3.0) * c3)
        found.bend[0] = found.bend[0] * x + real(2.0) * found.slope[0]
        found.bend[1] = found.bend[1] * x + found.slope[1]
        found.bend[2] = found.bend[2] * x + real(2.0) * c2 + real(6.0) * c3 * y
        found.slope[0] = found.slope[0] * x + found.value
        found.slope[1] = found.slope[1] * x + slope
        found.value = found.value * x + model.surfaces.curve_piece[row, at] + y * (c1 + y * (c2 + y * c3))
        power -= 1
    found.u = u
    found.v = v
    found.slope = wp.vec2d(found.slope[0] / wide, found.slope[1] / high)
    found.bend = vec3(found.bend[0] / (wide * wide), found.bend[1] / (wide * high), found.bend[2] / (high * high))
    return found


@wp.func
def height_near(model: Model, s: int, x: vec3) -> Height:
    """The foot of a point on a height, within its rectangle."""
    a = -model.surfaces.seed_corner[s, 0]
    b = -model.surfaces.seed_corner[s, 1]
    u = wp.clamp(x[1], -a, a)
    v = wp.clamp(x[2], -b, b)
    found = Height()
    step = int(0)
    while step < FOOT_STEPS:
        found = height_at(model, s, u, v)
        off = x[0] - found.value
        h_u = found.slope[0]
        h_v = found.slope[1]
        pull_u = x[1] - u + off * h_u
        pull_v = x[2] - v + off * h_v
        m_uu = real(1.0) + h_u * h_u - off * found.bend[0]
        m_uv = h_u * h_v - off * found.bend[1]
        m_vv = real(1.0) + h_v * h_v - off * found.bend[2]
        metric = real(1.0) + h_u * h_u + h_v * h_v
        if not (m_uu > real(0.0) and m_uu * m_vv - m_uv * m_uv > INDEFINITE * metric):
            m_uu = real(1.0) + h_u * h_u
            m_uv = h_u * h_v
            m_vv = real(1.0) + h_v * h_v
        if (u <= -a and pull_u < real(0.0)) or (u >= a and pull_u > real(0.0)):
            pull_u = real(0.0)
            m_uv = real(0.0)
        if (v <= -b and pull_v < real(0.0)) or (v >= b and pull_v > real(0.0)):
            pull_v = real(0.0)
            m_uv = real(0.0)
        determinant = m_uu * m_vv - m_uv * m_uv
        to_u = wp.clamp(u + (m_vv * pull_u - m_uv * pull_v) / determinant, -a, a)
        to_v = wp.clamp(v + (m_uu * pull_v - m_uv * pull_u) / determinant, -b, b)
        step += 1
        if wp.abs(to_u - u) + wp.abs(to_v - v) <= SETTLED * (a + b):
            step = FOOT_STEPS
        u = to_u
        v = to_v
    return found


@wp.func
def height_normal(at: Height) -> vec3:
    """Unit normal of a height away from the material."""
    return wp.normalize(vec3(real(1.0), -at.slope[0], -at.slope[1]))


@wp.func
def bend_of_height(near: Height, distance: real, normal: vec3) -> mat33:
    """Derivative [1/m] of the unit gradient of the distance from a height by the point, whose foot is `near`;
    0 about its border."""
    u = vec3(near.slope[0], real(1.0), real(0.0))
    v = vec3(near.slope[1], real(0.0), real(1.0))
    n = height_normal(near)
    if wp.dot(n, normal) < real(1.0) - ON_BORDER:
        return mat33()
    G = wp.mat22d(wp.dot(u, u), wp.dot(u, v), wp.dot(u, v), wp.dot(v, v))
    b = n[0] * wp.mat22d(near.bend[0], near.bend[1], near.bend[1], near.bend[2])
    M = G - distance * b
    if wp.abs(wp.determinant(M)) < EVOLUTE * wp.determinant(G):
        return mat33()
    W = wp.inverse(G) * b * wp.inverse(M)
    return -(W[0, 0] * wp.outer(u, u) + W[0, 1] * (wp.outer(u, v) + wp.outer(v, u)) + W[1, 1] * wp.outer(v, v))


@wp.func
def height_curvature(model: Model, s: int, u: real, v: real, x: real, y: real) -> real:
    """Curvature [1/m] of a height in the direction (x, y) of its tangents e_theta, t_z, positive if convex."""
    at = height_at(model, s, u, v)
    n = height_normal(at)
    around = wp.normalize(vec3(at.slope[0], real(1.0), real(0.0)))
    d = x * around + y * wp.cross(n, around)
    return -n[0] * (at.bend[0] * d[1] * d[1] + real(2.0) * at.bend[1] * d[1] * d[2] + at.bend[2] * d[2] * d[2])
