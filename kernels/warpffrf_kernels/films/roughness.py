"""Flow factors of rough walls, as defined in `warpffrf.model.films.roughness`: cubics between lines of a table.

A line has h [m], then the circumferential phi_p with its slope [1/m], the axial one likewise, the lag l [m] and Phi in
the same way.
"""

import warp as wp

from warpffrf_kernels.core.lookup import piece_at
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)

FLOW = wp.constant(1)
LAG = wp.constant(5)
DRAG = wp.constant(9)


@wp.struct
class Factors:
    """Circumferential and axial: phi_p and its slope [1/m], l [m] and its slope, Phi."""

    flow: wp.vec2d
    flow_slope: wp.vec2d
    lag: wp.vec2d
    lag_slope: wp.vec2d
    drag: wp.vec2d


@wp.func
def cubic_at(model: Model, i: int, column: int, h: real) -> wp.vec2d:
    """A value and its slope with respect to h, after line i."""
    start = model.elements[0].films[0].factor[i, 0]
    length = model.elements[0].films[0].factor[i + 1, 0] - start
    u = (h - start) / length
    low = model.elements[0].films[0].factor[i, column]
    rise = model.elements[0].films[0].factor[i + 1, column] - low
    a = length * model.elements[0].films[0].factor[i, column + 1]
    b = length * model.elements[0].films[0].factor[i + 1, column + 1]
    second = real(3.0) * rise - real(2.0) * a - b
    third = a + b - real(2.0) * rise
    value = low + u * (a + u * (second + u * third))
    return wp.vec2d(value, (a + u * (real(2.0) * second + real(3.0) * u * third)) / length)


@wp.func
def factors_at(model: Model, film: int, h: real) -> Factors:
    """Factors of a film at the gap h > 0 [m]."""
    found = Factors()
    found.flow = wp.vec2d(real(1.0), real(1.0))
    found.drag = wp.vec2d(real(1.0), real(1.0))
    count = model.elements[0].films[0].factor_count[film]
    if count == 0:
        return found
    start = model.elements[0].films[0].factor_start[film]
    if h >= model.elements[0].films[0].factor[start + count - 1, 0]:
        return found
    i = piece_at(model.elements[0].films[0].factor, start, count, 0, h)
    for c in range(2):
        flow = cubic_at(model, i, FLOW + 2 * c, h)
        lag = cubic_at(model, i, LAG + 2 * c, h)
        found.flow[c] = flow[0]
        found.flow_slope[c] = flow[1]
        found.lag[c] = lag[0]
        found.lag_slope[c] = lag[1]
        found.drag[c] = cubic_at(model, i, DRAG + 2 * c, h)[0]
    return found
