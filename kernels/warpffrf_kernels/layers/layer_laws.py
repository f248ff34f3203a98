r"""Curves of the layers between two surfaces: pressure, depth and energy, see `warpffrf.model.laws`.

    p = P(d) (1 + chi d_dot),      P: `power_form`, `exponential_form`, `table_form`

d is the depth of the layer, p >= 0. The rate of a step is a backward difference, d_dot = (d - d_past)/h: with chi/h as
`rate`, the law of a step is again a curve p(d), which begins where pressure ends, at the larger of the elastic start
and of d_past - h/chi, and rises from there; as the product of two rising convex functions it is convex. `rate` is 0 for
laws without damping, and outside time steps.

A form is a file with its functions, a number and a name here, and a line in each function below.
"""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.layers.exponential_form import (
    exponential_beginning,
    exponential_depth,
    exponential_energy,
    exponential_pressure,
)
from warpffrf_kernels.layers.power_form import power_depth, power_energy, power_pressure
from warpffrf_kernels.layers.table_form import table_beginning, table_depth, table_energy, table_pressure

wp.set_module_options(MODULE_OPTIONS)

POWER = wp.constant(1)
EXPONENTIAL = wp.constant(2)
TABLE = wp.constant(3)
FORMS = {"power": POWER, "exponential": EXPONENTIAL, "table": TABLE}  # by `form` of `warpffrf.model.laws.curves`

# --- columns of layer_number: four of the form, then
CHI = wp.constant(4)  # s/m
NUMBERS = 5

INVERSIONS = wp.constant(40)  # Newton steps of a damped law's inverse, convex and from above: a handful in practice
SETTLED = wp.constant(wp.float64(1.0e-14))  # of the depth: a Newton step at round-off
# of 1 + chi d_dot: where it vanishes at first contact the curve has no slope, and its tangent no inverse
LEAST_FACTOR = wp.constant(wp.float64(1.0e-6))

pair2 = wp.vec2d


@wp.func
def beginning(model: Model, pair: int) -> real:
    """Depth [m] at which P begins."""
    kind = model.elements[0].layers.kind[pair]
    if kind == EXPONENTIAL:
        return exponential_beginning(model, pair)
    if kind == TABLE:
        return table_beginning(model, pair)
    return real(0.0)


@wp.func
def elastic_pressure(model: Model, pair: int, depth: real) -> pair2:
    """P [Pa] at a depth [m], and its slope [Pa/m]; from `beginning` on."""
    kind = model.elements[0].layers.kind[pair]
    if kind == EXPONENTIAL:
        return exponential_pressure(model, pair, depth)
    if kind == TABLE:
        return table_pressure(model, pair, depth)
    return power_pressure(model, pair, depth)


@wp.func
def elastic_depth(model: Model, pair: int, p: real) -> real:
    """Depth [m] at which P is p > 0."""
    kind = model.elements[0].layers.kind[pair]
    if kind == EXPONENTIAL:
        return exponential_depth(model, pair, p)
    if kind == TABLE:
        return table_depth(model, pair, p)
    return power_depth(model, pair, p)


@wp.func
def layer_energy(model: Model, pair: int, depth: real) -> real:
    """Elastic energy [J/m^2] of a layer at a depth [m]; 0 below its beginning."""
    if depth <= beginning(model, pair):
        return real(0.0)
    kind = model.elements[0].layers.kind[pair]
    if kind == EXPONENTIAL:
        return exponential_energy(model, pair, depth)
    if kind == TABLE:
        return table_energy(model, pair, depth)
    return power_energy(model, pair, depth)


@wp.func
def least_depth(model: Model, pair: int, past: real, rate: real) -> real:
    """Depth [m] at which the pressure of a pair's layer begins."""
    if rate > real(0.0):
        return wp.max(past - real(1.0) / rate, beginning(model, pair))
    return beginning(model, pair)


@wp.func
def layer_pressure(model: Model, pair: int, depth: real, past: real, rate: real) -> pair2:
    """Pressure [Pa] of a layer at a depth [m], and its slope [Pa/m]; from `least_depth` on."""
    elastic = elastic_pressure(model, pair, depth)
    if rate == real(0.0):
        return elastic
    factor = real(1.0) + rate * (depth - past)
    return pair2(elastic[0] * factor, elastic[1] * wp.max(factor, LEAST_FACTOR) + elastic[0] * rate)


@wp.func
def layer_depth(model: Model, pair: int, p: real, past: real, rate: real) -> real:
    """Depth [m] of a layer under the pressure p [Pa], the inverse of `layer_pressure`; `least_depth` for p <= 0."""
    if p <= real(0.0):
        return least_depth(model, pair, past, rate)
    depth = elastic_depth(model, pair, p)
    if rate > real(0.0):
        depth = wp.max(depth, past)  # not below the root: both factors are at least those of the root
        step = depth
        i = int(0)
        while i < INVERSIONS and wp.abs(step) > SETTLED * wp.abs(depth):
            at = layer_pressure(model, pair, depth, past, rate)
            step = (at[0] - p) / at[1]
            depth = depth - step
            i += 1
    return depth
