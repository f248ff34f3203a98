r"""Curves of the layers between two surfaces: pressure, depth and energy, see `warpffrf.model.laws`.

    POWER         p = k [(d + e)^n - e^n] (1 + chi d_dot)
    EXPONENTIAL   p = p_0 [exp(d/lambda) - eps]
    TABLE         straight between points

d is the depth of the layer, p >= 0. The rate of a step is a backward difference, d_dot = (d - d_past)/h: with chi/h as
`rate` a law of a step is again a curve p(d), which begins where pressure ends, at the larger of the elastic beginning
and of d_past - h/chi, and rises from there; being the product of two rising convex functions it is convex. `rate` is 0
for laws without damping, and wherever there is no step in time.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)

# --- forms
CONSTANT = wp.constant(0)  # nothing between, or a yield that is part of the compliance
POWER = wp.constant(1)
EXPONENTIAL = wp.constant(2)
TABLE = wp.constant(3)

# --- columns of layer_number
STIFFNESS = wp.constant(0)  # POWER: Pa/m^n; EXPONENTIAL: p_0, Pa
EXPONENT = wp.constant(1)  # POWER: n; EXPONENTIAL: lambda, m
SHIFT = wp.constant(2)  # POWER: e, m; EXPONENTIAL: eps
SHIFT_POWER = wp.constant(3)  # POWER: e^n; EXPONENTIAL: the gap where pressure ends, m
CHI = wp.constant(4)  # s/m
NUMBERS = 5

INVERSIONS = wp.constant(40)  # Newton steps of a damped law's inverse, convex and from above: a handful in practice
SETTLED = wp.constant(wp.float64(1.0e-14))  # of the depth: a Newton step at round-off
# of 1 + chi d_dot: where it vanishes at touch the curve has no slope, and its tangent no inverse
LEAST_FACTOR = wp.constant(wp.float64(1.0e-6))

pair2 = wp.vec2d


@wp.func
def least_depth(model: Model, pair: int, past: real, rate: real) -> real:
    """Depth [m] at which the pressure of a pair's layer begins."""
    kind = model.layers.kind[pair]
    if kind == EXPONENTIAL:
        return -model.layers.number[pair, SHIFT_POWER]
    if kind == TABLE:
        return model.layers.table[model.layers.table_start[pair], 0]
    if rate > real(0.0):
        return wp.max(past - real(1.0) / rate, real(0.0))
    return real(0.0)


@wp.func
def piece_of(model: Model, pair: int, column: int, value: real) -> int:
    """Line of the pair's table at or below `value` of a column, the last but one at most."""
    first = model.layers.table_start[pair]
    last = first + model.layers.table_count[pair] - 2
    i = int(first)
    while i < last and value >= model.layers.table[i + 1, column]:
        i += 1
    return i


@wp.func
def layer_pressure(model: Model, pair: int, depth: real, past: real, rate: real) -> pair2:
    """Pressure [Pa] of a layer at a depth [m], and its slope [Pa/m]; from `least_depth` on."""
    kind = model.layers.kind[pair]
    k = model.layers.number[pair, STIFFNESS]
    if kind == EXPONENTIAL:
        length = model.layers.number[pair, EXPONENT]
        e = wp.exp(depth / length)
        return pair2(k * (e - model.layers.number[pair, SHIFT]), k * e / length)
    if kind == TABLE:
        i = piece_of(model, pair, 0, depth)
        rise = model.layers.table[i + 1, 1] - model.layers.table[i, 1]
        slope = rise / (model.layers.table[i + 1, 0] - model.layers.table[i, 0])
        return pair2(model.layers.table[i, 1] + slope * (depth - model.layers.table[i, 0]), slope)
    n = model.layers.number[pair, EXPONENT]
    from_shift = depth + model.layers.number[pair, SHIFT]
    whole = wp.pow(from_shift, n)
    elastic = k * (whole - model.layers.number[pair, SHIFT_POWER])
    factor = real(1.0) + rate * (depth - past)
    slope = k * n * whole / from_shift * wp.max(factor, LEAST_FACTOR) + elastic * rate
    return pair2(elastic * factor, slope)


@wp.func
def layer_depth(model: Model, pair: int, p: real, past: real, rate: real) -> real:
    """Depth [m] of a layer under the pressure p [Pa], the inverse of `layer_pressure`; `least_depth` for p <= 0."""
    if p <= real(0.0):
        return least_depth(model, pair, past, rate)
    kind = model.layers.kind[pair]
    k = model.layers.number[pair, STIFFNESS]
    if kind == EXPONENTIAL:
        return model.layers.number[pair, EXPONENT] * wp.log(p / k + model.layers.number[pair, SHIFT])
    if kind == TABLE:
        i = piece_of(model, pair, 1, p)
        run = model.layers.table[i + 1, 0] - model.layers.table[i, 0]
        rise = model.layers.table[i + 1, 1] - model.layers.table[i, 1]
        return model.layers.table[i, 0] + run / rise * (p - model.layers.table[i, 1])
    n = model.layers.number[pair, EXPONENT]
    depth = wp.pow(p / k + model.layers.number[pair, SHIFT_POWER], real(1.0) / n) - model.layers.number[pair, SHIFT]
    if rate > real(0.0):
        depth = wp.max(depth, past)  # not below the root: both factors are at least those of the root
        step = depth
        i = int(0)
        while i < INVERSIONS and wp.abs(step) > SETTLED * depth:
            at = layer_pressure(model, pair, depth, past, rate)
            step = (at[0] - p) / at[1]
            depth = depth - step
            i += 1
    return depth


@wp.func
def layer_energy(model: Model, pair: int, depth: real) -> real:
    """Elastic energy [J/m^2] of a layer at a depth [m]; 0 below its beginning."""
    kind = model.layers.kind[pair]
    k = model.layers.number[pair, STIFFNESS]
    shift = model.layers.number[pair, SHIFT]
    if depth <= least_depth(model, pair, real(0.0), real(0.0)):
        return real(0.0)
    if kind == EXPONENTIAL:
        length = model.layers.number[pair, EXPONENT]
        e = wp.exp(depth / length) - shift
        return k * (length * e - shift * (model.layers.number[pair, SHIFT_POWER] + depth))
    if kind == TABLE:
        i = piece_of(model, pair, 0, depth)
        at = layer_pressure(model, pair, depth, real(0.0), real(0.0))
        mean = real(0.5) * (model.layers.table[i, 1] + at[0])
        return model.layers.table[i, 2] + mean * (depth - model.layers.table[i, 0])
    n = model.layers.number[pair, EXPONENT]
    e_n = model.layers.number[pair, SHIFT_POWER]
    from_shift = depth + shift
    whole = (wp.pow(from_shift, n) * from_shift - e_n * shift) / (n + real(1.0))
    return k * (whole - e_n * depth)
