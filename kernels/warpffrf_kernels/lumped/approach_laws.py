r"""Force as a function of the approach a = -g of lumped contacts, see `warpffrf.model.laws.lumped`.

    POWER    F = K a^n, a > 0;      slope n F/a,      energy F a/(n + 1)
    TABLE    linear between points, from force 0 on; extrapolated by the last piece

for one contact point times its `share`. With damping the force is F (1 + chi a_dot), cut off at zero: no tension.
"""

import warp as wp

from warpffrf_kernels.core.lookup import piece_at
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


@wp.struct
class Push:
    """Elastic force [N] of a point, its first and second derivative by the approach, and the energy [J]."""

    force: real
    slope: real
    bend: real
    energy: real


@wp.func
def push_of(model: Model, contact: int, share: real, approach: real) -> Push:
    """For a lumped contact at an approach [m]."""
    out = Push()
    count = model.elements[0].lumped.table_count[contact]
    if count == 0:
        if approach > real(0.0):
            n = model.elements[0].lumped.exponent[contact]
            out.force = share * model.elements[0].lumped.stiffness[contact] * wp.pow(approach, n)
            out.slope = n * out.force / approach
            out.bend = (n - real(1.0)) * out.slope / approach
            out.energy = out.force * approach / (n + real(1.0))
        return out
    i = model.elements[0].lumped.table_start[contact]
    if approach > model.elements[0].lumped.table[i, 0]:
        i = piece_at(model.elements[0].lumped.table, i, count, 0, approach)
        rise = model.elements[0].lumped.table[i + 1, 1] - model.elements[0].lumped.table[i, 1]
        beyond = approach - model.elements[0].lumped.table[i, 0]
        out.slope = share * rise / (model.elements[0].lumped.table[i + 1, 0] - model.elements[0].lumped.table[i, 0])
        out.force = share * model.elements[0].lumped.table[i, 1] + out.slope * beyond
        mean = real(0.5) * (share * model.elements[0].lumped.table[i, 1] + out.force)
        out.energy = share * model.elements[0].lumped.table[i, 2] + mean * beyond
    return out
