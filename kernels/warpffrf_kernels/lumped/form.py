r"""Form deviations of surfaces of revolution in lumped contacts: waviness, ovality, measured roundness.

The actual surface lies at the depth w(theta) below the ideal one. With the ideal signed distance d (gradient n, Hessian
H, `surfaces.surface`), the angle theta about the axis and the radius rho of a point,

    grad theta = e_theta/rho,      Hess theta = -(e_r e_theta + e_theta e_r)/rho^2,

the surface with its form is the zero of d + w, and to first order in the slope w'/rho,

    distance   d + w,      normal   (n + w'/rho e_theta)/|..|,      curvature   H + w''/rho^2 e_theta e_theta
                                                                             - w'/rho^2 (e_r e_theta + e_theta e_r).

w is periodic, in cubic pieces of equal width with a continuous second derivative: a division finds the piece. These
functions are not called for surfaces without a form deviation.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3

wp.set_module_options(MODULE_OPTIONS)

TURN = wp.constant(wp.float64(6.283185307179586))  # rad
AXIS = wp.constant(wp.float64(1.0e-14))  # m: nearer to the axis the angle is undefined


@wp.func
def depth_of(model: Model, s: int, theta: real) -> vec3:
    """w [m], w' and w'' [m, per rad] at an angle [rad] of the surface's chart."""
    count = model.elements[0].lumped.form_count[s]
    width = TURN / real(count)
    at = (theta - model.elements[0].lumped.form_begin[s]) / TURN
    at = (at - wp.floor(at)) * real(count)
    i = wp.min(int(wp.floor(at)), count - 1)
    t = (at - real(i)) * width
    i += model.elements[0].lumped.form_start[s]
    c1 = model.elements[0].lumped.form_piece[i, 1]
    c2 = model.elements[0].lumped.form_piece[i, 2]
    c3 = model.elements[0].lumped.form_piece[i, 3]
    value = model.elements[0].lumped.form_piece[i, 0] + t * (c1 + t * (c2 + t * c3))
    slope = c1 + t * (real(2.0) * c2 + real(3.0) * t * c3)
    return vec3(value, slope, real(2.0) * c2 + real(6.0) * t * c3)


@wp.func
def depth_at(model: Model, s: int, x: vec3) -> vec3:
    """The same for a point in the surface's frame."""
    return depth_of(model, s, wp.atan2(x[1], x[0]))


@wp.func
def formed_normal(model: Model, s: int, x: vec3, n: vec3) -> vec3:
    """For a point in the surface's frame, n that of the ideal surface."""
    rho = wp.sqrt(x[0] * x[0] + x[1] * x[1])
    if rho < AXIS:
        return n
    w = depth_at(model, s, x)
    return wp.normalize(n + (w[1] / (rho * rho)) * vec3(-x[1], x[0], real(0.0)))


@wp.func
def form_bend(model: Model, s: int, x: vec3) -> mat33:
    """Contribution to the Hessian [1/m] of the distance, in the surface's frame."""
    rho = wp.sqrt(x[0] * x[0] + x[1] * x[1])
    if rho < AXIS:
        return mat33()
    w = depth_at(model, s, x)
    e_r = vec3(x[0], x[1], real(0.0)) / rho
    e_t = vec3(-e_r[1], e_r[0], real(0.0))
    both = wp.outer(e_r, e_t) + wp.outer(e_t, e_r)
    return (w[2] * wp.outer(e_t, e_t) - w[1] * both) / (rho * rho)
