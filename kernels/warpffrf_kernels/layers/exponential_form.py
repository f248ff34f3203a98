"""p = p_0 [exp(d/lambda) - eps] on the device, see `warpffrf.model.laws.curves.curve`."""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)

# --- columns of layer_number
AT_ZERO = wp.constant(0)  # p_0, Pa
LENGTH = wp.constant(1)  # lambda, m
EPS = wp.constant(2)
END = wp.constant(3)  # the gap at which pressure ends, m


@wp.func
def exponential_beginning(model: Model, pair: int) -> real:
    """Depth [m] at which the pressure begins."""
    return -model.elements[0].layers.number[pair, END]


@wp.func
def exponential_pressure(model: Model, pair: int, depth: real) -> wp.vec2d:
    """Pressure [Pa] and slope [Pa/m]."""
    k = model.elements[0].layers.number[pair, AT_ZERO]
    length = model.elements[0].layers.number[pair, LENGTH]
    e = wp.exp(depth / length)
    return wp.vec2d(k * (e - model.elements[0].layers.number[pair, EPS]), k * e / length)


@wp.func
def exponential_depth(model: Model, pair: int, p: real) -> real:
    """Depth [m] under p > 0."""
    whole = p / model.elements[0].layers.number[pair, AT_ZERO] + model.elements[0].layers.number[pair, EPS]
    return model.elements[0].layers.number[pair, LENGTH] * wp.log(whole)


@wp.func
def exponential_energy(model: Model, pair: int, depth: real) -> real:
    """Energy [J/m^2]."""
    length = model.elements[0].layers.number[pair, LENGTH]
    shift = model.elements[0].layers.number[pair, EPS]
    e = wp.exp(depth / length) - shift
    return model.elements[0].layers.number[pair, AT_ZERO] * (
        length * e - shift * (model.elements[0].layers.number[pair, END] + depth)
    )
