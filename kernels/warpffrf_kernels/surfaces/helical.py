"""Helical surfaces on the device: an extruded curve whose section at z is rotated by tau z about e_a.

For a point x let y be x rotated back by tau z: in the section of the curve it has the distance d_t, the normal n there
(both functions of the plane, |grad d_t| = 1 in it) and the lever q = (e_a x y).n of n about the axis. As y moves by
-tau e_a x y per z, d_t changes by -tau q, and

    grad d_t = (n, -tau q),        d = d_t/sqrt(1 + (tau q)^2).

On an *involute* q is the base radius everywhere, beyond the curve too, as its normals touch the base circle: |grad d| =
1, and d is the signed distance from the surface exactly, with tau q = tan beta_b of the base helix angle. On other
parts it is so to first order in d. The foot lies at z + d tau q/sqrt(1 + (tau q)^2).

Second derivatives in the section are kappa t t, kappa that of the parallel curve through y and t = e_a x n. With a =
tau (1 - kappa y.n), those of d_t by x are

    kappa t t + a (t e_a + e_a t) - tau a (y.n) e_a e_a,

and the unit gradient rotates by their projection across the normal over sqrt(1 + (tau q)^2). On an involute kappa y.n =
1 and a = 0: the surface is developable, straight along its generators e_a + tan beta_b n, along which the normal is
constant, with the curvature kappa cos beta_b along t.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def twist_of(model: Model, s: int) -> real:
    """tau [rad/m] of an extruded curve; 0 where it is straight along the axis."""
    return model.surfaces.tangent[s]


@wp.func
def rotated(x: vec3, angle: real) -> vec3:
    """x rotated by an angle [rad] about e_a."""
    if angle == real(0.0):
        return x
    c = wp.cos(angle)
    s = wp.sin(angle)
    return vec3(c * x[0] - s * x[1], s * x[0] + c * x[1], x[2])


@wp.func
def lean_of(twist: real, y: vec3, n: vec3) -> real:
    """tau q of the point y in the section with the normal n: tangent of the normal's angle to the section."""
    return twist * (y[0] * n[1] - y[1] * n[0])


@wp.func
def helical_slope(kappa: real, y: vec3, n: vec3, normal: vec3, twist: real) -> mat33:
    """Derivative [1/m] of the unit gradient `normal` by the point; n, kappa: the normal and the curvature through y in
    the section."""
    lean = lean_of(twist, y, n)
    t = rotated(vec3(-n[1], n[0], real(0.0)), twist * y[2])
    e = vec3(real(0.0), real(0.0), real(1.0))
    lever = y[0] * n[0] + y[1] * n[1]
    a = twist * (real(1.0) - kappa * lever)
    H = kappa * wp.outer(t, t) + a * (wp.outer(t, e) + wp.outer(e, t)) - twist * a * lever * wp.outer(e, e)
    P = wp.identity(n=3, dtype=real) - wp.outer(normal, normal)
    return P * H * P / wp.sqrt(real(1.0) + lean * lean)
