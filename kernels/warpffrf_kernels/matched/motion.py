r"""Motion of small-sliding contacts: the relative motion of two bodies in the axes of the first, and global modes.

With R_A, R_B the axes of the bodies, r their centres of mass, a point c whose initial positions in the bodies are rho_A
and rho_B, and the initial R_0 = R_A^T R_B,

    d = R_A^T (x - r_A) - rho_A,     x = r_B + R_B rho_B,        exp(theta^) = R_A^T R_B R_0^T,

so points of B move by d + theta x (y - c) relative to A, to first order in theta; both are initially zero, and do not
change if both bodies move as one. With phi_A, phi_B rotations of the bodies (world axes) and J_l the left
Jacobian of the exponential map,

    delta d = R_A^T (delta r_B + phi_B x R_B rho_B - delta r_A - phi_A x (x - r_A)),
    delta theta = J_l(theta)^-1 R_A^T (phi_B - phi_A).

Forces F and couples M conjugate to d and theta act on B as R_A F at x and R_A J_l^-T M, on A as their opposite at the
same point: forces and moments of the two cancel to the last digit.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.rotation import rotation_vector, tangent_inverse
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, mat33, real, vec3
from warpffrf_kernels.core.scratch import Trial

wp.set_module_options(MODULE_OPTIONS)

RIGID = wp.constant(6)  # coordinates d, theta of a contact between two bodies
WRENCH = wp.constant(12)  # motions of its bodies, six each


@wp.struct
class Relative:
    """d and theta of a contact; the position x of the point of B, axes of both, and J_l^-1(theta)."""

    d: vec3
    theta: vec3
    x: vec3
    first_arm: vec3  # x - r_A, world
    second_arm: vec3  # R_B rho_B
    first_axes: mat33
    second_axes: mat33
    by_turn: mat33


@wp.func
def relative_motion(model: Model, w: int, contact: int, trial: Trial) -> Relative:
    out = Relative()
    a = model.elements[0].matched[0].first[contact]
    b = model.elements[0].matched[0].second[contact]
    r_a = vec3(real(0.0))
    r_b = vec3(real(0.0))
    out.first_axes = wp.identity(n=3, dtype=real)
    out.second_axes = wp.identity(n=3, dtype=real)
    if a >= 0:
        r_a = trial.r1[w, a]
        out.first_axes = trial.axes[w, a]
    if b >= 0:
        r_b = trial.r1[w, b]
        out.second_axes = trial.axes[w, b]
    out.second_arm = out.second_axes * model.elements[0].matched[0].second_point[contact]
    out.x = r_b + out.second_arm
    out.first_arm = out.x - r_a
    turned = wp.transpose(out.first_axes)
    out.d = turned * out.first_arm - model.elements[0].matched[0].first_point[contact]
    out.theta = rotation_vector(turned * out.second_axes * wp.transpose(model.elements[0].matched[0].turn[contact]))
    out.by_turn = wp.transpose(tangent_inverse(out.theta))  # J_l(theta) = T(theta)^T
    return out


@wp.func
def rigid_gradient(seen: Relative, i: int) -> vec3:
    """Change of d by motion i of the bodies: of A, then of B, three translations (world), three rotations (own
    axes)."""
    if i < 3:
        return -wp.transpose(seen.first_axes) * unit(i)
    if i < 6:
        return wp.transpose(seen.first_axes) * wp.cross(seen.first_arm, axis_of(seen.first_axes, i - 3))
    if i < 9:
        return wp.transpose(seen.first_axes) * unit(i - 6)
    return wp.transpose(seen.first_axes) * wp.cross(axis_of(seen.second_axes, i - 9), seen.second_arm)


@wp.func
def turn_gradient(seen: Relative, i: int) -> vec3:
    """Change of theta by the same."""
    turn = vec3(real(0.0))
    if i >= 3 and i < 6:
        turn = -axis_of(seen.first_axes, i - 3)
    if i >= 9:
        turn = axis_of(seen.second_axes, i - 9)
    return seen.by_turn * (wp.transpose(seen.first_axes) * turn)


@wp.func
def unit(i: int) -> vec3:
    out = vec3(real(0.0))
    out[i] = real(1.0)
    return out


@wp.func
def axis_of(axes: mat33, i: int) -> vec3:
    return vec3(axes[0, i], axes[1, i], axes[2, i])
