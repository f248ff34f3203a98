"""What the couples of the pressures (`rolling.places`) do to the outer coordinates within an iteration.

The gradient of a gap has no part along the couple that its pressure makes: with it the outer matrix were not
symmetric. So the pressures are solved for without it, and the outer increments follow their change ds = weight dp,

    dz = M weight F^T ds,      F^T the couples over the rigid columns of both bodies,

with the mobility M of the tractions. What dz does to gaps and slips in turn is left to the next iteration: nothing
where joints or drives hold the turning, and of the second order in the step where they do not.
"""

import warp as wp

from warpffrf_kernels.core.access import changed, inout
from warpffrf_kernels.core.control import Control
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, mat33, real, sync, vec3
from warpffrf_kernels.friction.cells import rubs_on_patch

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def change_of_couple(
    model: Model,
    w: int,
    pair: int,
    i: int,
    pressure: wp.array3d(dtype=real),
    base: wp.array3d(dtype=real),
    more_wrench: wp.array4d(dtype=real),
) -> real:
    """Component i of the wrench on A that the change of the pressures adds beyond that of the gaps' gradients."""
    cells = model.elements[0].patches.columns[pair] * model.surfaces.rows[model.pairs.first[pair]]
    total = real(0.0)
    m = int(0)
    while m < cells:
        total += (pressure[w, pair, m] - base[w, pair, m]) * more_wrench[w, pair, m, i]
        m += 1
    return total


@wp.kernel
def follow_couples(
    models: wp.array(dtype=Model),
    ctl: wp.array(dtype=Control),
    r1: wp.array2d(dtype=vec3),
    axes: wp.array2d(dtype=mat33),
    pressure: wp.array3d(dtype=real),
    base: wp.array3d(dtype=real),
    more_wrench: wp.array4d(dtype=real),
    weight: wp.array2d(dtype=real),
    M: wp.array(dtype=real),
    push: inout(wp.array(dtype=real)),
    z: changed(wp.array(dtype=real)),
):
    """Per world: adds what the couples of the pairs on patches do to the outer increments."""
    w, lane = wp.tid()
    model = models[w]
    if ctl[w].run == 0 or ctl[w].changes != 0:
        return
    N = model.outer.count
    i = lane
    while i < N:
        push[w * N + i] = real(0.0)
        i += wp.block_dim()
    sync()
    pair = int(0)
    while pair < model.pairs.count and lane == 0:
        if rubs_on_patch(model, pair):
            f = vec3(real(0.0))
            t = vec3(real(0.0))
            for c in range(3):
                f[c] = change_of_couple(model, w, pair, c, pressure, base, more_wrench)
                t[c] = change_of_couple(model, w, pair, 3 + c, pressure, base, more_wrench)
            scale = weight[w, pair] * weight[w, pair]
            A = model.surfaces.body[model.pairs.first[pair]]
            B = model.surfaces.body[model.pairs.second[pair]]
            t_a = wp.transpose(axes[w, A]) * t
            for c in range(3):
                at = w * N + 6 * A + c
                push[at] = push[at] + scale * f[c]
                push[at + 3] = push[at + 3] + scale * t_a[c]
            if B >= 0:
                t_b = wp.transpose(axes[w, B]) * (t + wp.cross(r1[w, A] - r1[w, B], f))
                for c in range(3):
                    at = w * N + 6 * B + c
                    push[at] = push[at] - scale * f[c]
                    push[at + 3] = push[at + 3] - scale * t_b[c]
        pair += 1
    sync()
    j = int(0)
    while j < N:
        if push[w * N + j] != real(0.0):
            axpy(N, push[w * N + j], M, (w * N + j) * N, z, w * N)
        j += 1
    sync()
