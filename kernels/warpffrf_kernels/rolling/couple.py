"""Effect of the couples of the pressures (`rolling.places`) on the retained coordinates within an iteration.

The gradient of a gap has no component along the couple of its pressure: with it the retained matrix would not be
symmetric. The pressures are therefore solved for without it, and the retained increments follow their change
ds = weight dp,

    dz = M weight F^T ds,      F^T the couples over the rigid columns of both bodies,

with the receptance M of the tractions. The resulting change of gaps and slips is left to the next iteration: zero if
joints or drives constrain the rotation, and of second order in the step otherwise.
"""

import warp as wp

from warpffrf_kernels.core.contact_scratch import ContactFields, ContactGeometry
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.friction_scratch import FrictionSolve
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, axpy, real, sync, vec3
from warpffrf_kernels.core.scratch import ImpulsiveContact, RetainedSystem, Trial
from warpffrf_kernels.core.state import ContactState
from warpffrf_kernels.friction.cells import rubs_on_patch

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def change_of_couple(
    model: Model, w: int, pair: int, i: int, contact: ContactState, fields: ContactFields, geometry: ContactGeometry
) -> real:
    """Component i of the wrench on A due to the change of the pressures, beyond that of the gaps' gradients."""
    cells = model.elements[0].patches.columns[pair] * model.surfaces.rows[model.pairs.first[pair]]
    total = real(0.0)
    m = int(0)
    while m < cells:
        total += (contact.pressure[w, pair, m] - fields.base[w, pair, m]) * geometry.more_wrench[w, pair, m, i]
        m += 1
    return total


@kernel
def follow_couples(
    run: Run, trial: Trial, contact: ContactState, fields: ContactFields, geometry: ContactGeometry,
    impulses: ImpulsiveContact, tangential: FrictionSolve, system: RetainedSystem,
):  # fmt: skip
    """Per world: adds the effect of the couples of contact-fixed pairs to the retained increments."""
    w, lane = wp.tid()
    model = run.models[w]
    if run.ctl[w].run == 0 or run.ctl[w].changes != 0:
        return
    N = model.retained.count
    i = lane
    while i < N:
        tangential.cell_load[w * N + i] = real(0.0)
        i += wp.block_dim()
    sync()
    pair = int(0)
    while pair < model.pairs.count and lane == 0:
        if rubs_on_patch(model, pair):
            f = vec3(real(0.0))
            t = vec3(real(0.0))
            for c in range(3):
                f[c] = change_of_couple(model, w, pair, c, contact, fields, geometry)
                t[c] = change_of_couple(model, w, pair, 3 + c, contact, fields, geometry)
            scale = impulses.weight[w, pair] * impulses.weight[w, pair]
            A = model.surfaces.body[model.pairs.first[pair]]
            B = model.surfaces.body[model.pairs.second[pair]]
            t_a = wp.transpose(trial.axes[w, A]) * t
            for c in range(3):
                at = w * N + 6 * A + c
                tangential.cell_load[at] = tangential.cell_load[at] + scale * f[c]
                tangential.cell_load[at + 3] = tangential.cell_load[at + 3] + scale * t_a[c]
            if B >= 0:
                t_b = wp.transpose(trial.axes[w, B]) * (t + wp.cross(trial.r1[w, A] - trial.r1[w, B], f))
                for c in range(3):
                    at = w * N + 6 * B + c
                    tangential.cell_load[at] = tangential.cell_load[at] - scale * f[c]
                    tangential.cell_load[at + 3] = tangential.cell_load[at + 3] - scale * t_b[c]
        pair += 1
    sync()
    j = int(0)
    while j < N:
        if tangential.cell_load[w * N + j] != real(0.0):
            axpy(N, tangential.cell_load[w * N + j], tangential.friction_receptance, (w * N + j) * N, system.z, w * N)
        j += 1
    sync()
