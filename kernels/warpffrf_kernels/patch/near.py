r"""The half-space of both bodies under a patch at any half-width W: levels of tables, and distant ends.

The weak displacement of a cell due to a unit pressure on another one is tabulated for every pair, as blocks by
frequency (`patch.strips`), at the half-widths W of its levels; apart from a power of W it varies slowly,

    K(W) = W^p sum_l c_l(ln W) K_l,        c cubic, through the four adjacent levels,

with p = 2 along a line and 3, exactly, if rows grow with W: then a single level suffices. The contribution of ends far
from the cells is then a constant, the sum over the ends of strength over distance.
"""

import warp as wp

from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)


@wp.func
def cubic_shares(u: real) -> wp.vec4d:
    """Weights of values at 0, 1, 2 and 3 in the cubic through them at u."""
    a = u
    b = u - real(1.0)
    c = u - real(2.0)
    d = u - real(3.0)
    return wp.vec4d(-b * c * d / real(6.0), a * c * d / real(2.0), -a * b * d / real(2.0), a * b * c / real(6.0))


@wp.func
def level_shares(elements: Elements, pair: int, width: real) -> wp.vec4d:
    """c of the four levels from `first_level` on."""
    if elements.patches.near_levels[pair] < 4:
        return wp.vec4d(real(1.0), real(0.0), real(0.0), real(0.0))
    x = (wp.log(width) - elements.patches.near_first[pair]) / elements.patches.near_step[pair]
    return cubic_shares(x - real(first_level(elements, pair, width)))


@wp.func
def first_level(elements: Elements, pair: int, width: real) -> int:
    """The first of the four levels adjacent to W."""
    levels = elements.patches.near_levels[pair]
    if levels < 4:
        return 0
    x = (wp.log(width) - elements.patches.near_first[pair]) / elements.patches.near_step[pair]
    return wp.clamp(int(wp.floor(x)) - 1, 0, levels - 4)


@wp.func
def end_constant(model: Model, elements: Elements, pair: int, z: real, least: real) -> real:
    """Contribution of the ends of both bodies [1/(Pa m) per unit force] to the patch around z of A; nearer than `least`
    [m] to an end, its contribution at that distance."""
    total = real(0.0)
    i = elements.patches.end_start[pair]
    while i < elements.patches.end_start[pair + 1]:
        total += elements.patches.end_strength[i] / wp.max(wp.abs(z - elements.patches.end_z[i]), least)
        i += 1
    return total
