"""Asperity contact laws of a film, as defined in `warpffrf.model.laws`: pressure as a function of the depth -h."""

import warp as wp

from warpffrf_kernels.core.lookup import piece_at
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3

wp.set_module_options(MODULE_OPTIONS)

SMOOTH = wp.constant(0)
EXPONENTIAL = wp.constant(1)  # pressure at zero [Pa], decay length [m], subtracted offset, where it ends [m]
TABLE = wp.constant(2)  # piecewise linear


@wp.func
def asperities_at(model: Model, film: int, depth: real) -> vec3:
    """Pressure [Pa], its slope [Pa/m] and energy [J/m2] of a film's asperities."""
    none = vec3(real(0.0))
    kind = model.elements[0].films[0].asperity_kind[film]
    if kind == EXPONENTIAL:
        end = model.elements[0].films[0].asperity[film, 3]
        if depth <= -end:
            return none
        k = model.elements[0].films[0].asperity[film, 0]
        length = model.elements[0].films[0].asperity[film, 1]
        shift = model.elements[0].films[0].asperity[film, 2]
        e = wp.exp(depth / length)
        return vec3(k * (e - shift), k * e / length, k * (length * (e - shift) - shift * (end + depth)))
    if kind == TABLE:
        i = model.elements[0].films[0].table_start[film]
        if depth <= model.elements[0].films[0].table[i, 0]:
            return none
        i = piece_at(model.elements[0].films[0].table, i, model.elements[0].films[0].table_count[film], 0, depth)
        rise = model.elements[0].films[0].table[i + 1, 1] - model.elements[0].films[0].table[i, 1]
        slope = rise / (model.elements[0].films[0].table[i + 1, 0] - model.elements[0].films[0].table[i, 0])
        into = depth - model.elements[0].films[0].table[i, 0]
        p = model.elements[0].films[0].table[i, 1] + slope * into
        mean = real(0.5) * (model.elements[0].films[0].table[i, 1] + p)
        return vec3(p, slope, model.elements[0].films[0].table[i, 2] + mean * into)
    return none
