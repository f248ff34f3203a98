"""States of cells: target values of their independent numbers, required state changes, and their forces.

Loops over the cells of a group, by one lane; `at` is the start of the group's numbers.
"""

import warp as wp

from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3
from warpffrf_kernels.matched.forms import Form

wp.set_module_options(MODULE_OPTIONS)

NEAR = wp.constant(wp.float64(0.1))
TINY = wp.constant(wp.float64(1.0e-9))  # of mu p: a transverse traction below that does not determine kappa
NO_PRESSURE = wp.constant(wp.float64(1.0e-11))  # of the largest force of a cell


@wp.func
def triple(x: wp.array(dtype=real), at: int, components: int) -> vec3:
    out = vec3(x[at], real(0.0), real(0.0))
    if components == 3:
        out = vec3(x[at], x[at + 1], x[at + 2])
    return out


@wp.func
def put_triple(x: wp.array(dtype=real), at: int, components: int, value: vec3):
    x[at] = value[0]
    if components == 3:
        x[at + 1] = value[1]
        x[at + 2] = value[2]


@wp.struct
class Aim:
    """Target values of the small independent numbers of a slipping cell; far: 1 if its form is too far off, and the
    direction and kappa of a better one."""

    target: vec3
    far: int
    d: wp.vec2d
    kappa: real


@wp.func
def aim_of(form: Form, u: vec3, v: vec3, largest: real, own: real) -> Aim:
    """For a slipping cell with u and v; `largest` force of a cell [N], `own` compliance along the face [m/N]."""
    out = Aim()
    out.target = vec3(real(0.0))
    out.d = form.d
    out.kappa = form.kappa
    bound = form.mu * v[0]
    along = v[1]
    if bound <= NO_PRESSURE * largest or along >= real(0.0):
        return out
    across = u[2] - form.kappa * v[2]
    size = wp.sqrt(along * along + across * across)
    if not (size > real(0.0)):  # squares below the smallest representable number
        return out
    kappa = size / bound
    apart = wp.abs(v[2]) > NEAR * bound
    if wp.abs(kappa - form.kappa) > NEAR * (own + form.kappa) and wp.abs(v[2]) > TINY * bound:
        apart = True
    if apart:
        out.far = 1
        out.d = wp.vec2d(
            -(along * form.d[0] - across * form.d[1]) / size, -(along * form.d[1] + across * form.d[0]) / size
        )
        out.kappa = kappa
    else:
        out.target = vec3(real(0.0), wp.sqrt(bound * bound - v[2] * v[2]) - bound, (form.kappa - kappa) * v[2])
    return out


@wp.func
def form_of(
    w: int, cell: int, mu: real, matched_mode: wp.array2d(dtype=int), matched_target_form: wp.array3d(dtype=real)
) -> Form:
    out = Form()
    out.state = matched_mode[w, cell]
    out.d = wp.vec2d(matched_target_form[w, cell, 0], matched_target_form[w, cell, 1])
    out.kappa = matched_target_form[w, cell, 2]
    out.mu = mu
    return out


@wp.func
def set_form(
    w: int, cell: int, form: Form, matched_mode: wp.array2d(dtype=int), matched_target_form: wp.array3d(dtype=real)
):
    matched_mode[w, cell] = form.state
    matched_target_form[w, cell, 0] = form.d[0]
    matched_target_form[w, cell, 1] = form.d[1]
    matched_target_form[w, cell, 2] = form.kappa
