"""p = k [(d + e)^n - e^n] on the device, see `warpffrf.model.laws.curves.curve`."""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)

# --- columns of layer_number
STIFFNESS = wp.constant(0)  # Pa/m^n
EXPONENT = wp.constant(1)
SHIFT = wp.constant(2)  # e, m
SHIFT_POWER = wp.constant(3)  # e^n


@wp.func
def power_pressure(model: Model, pair: int, depth: real) -> wp.vec2d:
    """Pressure [Pa] and slope [Pa/m]."""
    k = model.elements[0].layers.number[pair, STIFFNESS]
    n = model.elements[0].layers.number[pair, EXPONENT]
    from_shift = depth + model.elements[0].layers.number[pair, SHIFT]
    whole = wp.pow(from_shift, n)
    return wp.vec2d(k * (whole - model.elements[0].layers.number[pair, SHIFT_POWER]), k * n * whole / from_shift)


@wp.func
def power_depth(model: Model, pair: int, p: real) -> real:
    """Depth [m] under p > 0."""
    whole = p / model.elements[0].layers.number[pair, STIFFNESS] + model.elements[0].layers.number[pair, SHIFT_POWER]
    return (
        wp.pow(whole, real(1.0) / model.elements[0].layers.number[pair, EXPONENT])
        - model.elements[0].layers.number[pair, SHIFT]
    )


@wp.func
def power_energy(model: Model, pair: int, depth: real) -> real:
    """Energy [J/m^2]."""
    n = model.elements[0].layers.number[pair, EXPONENT]
    e_n = model.elements[0].layers.number[pair, SHIFT_POWER]
    shift = model.elements[0].layers.number[pair, SHIFT]
    from_shift = depth + shift
    whole = (wp.pow(from_shift, n) * from_shift - e_n * shift) / (n + real(1.0))
    return model.elements[0].layers.number[pair, STIFFNESS] * (whole - e_n * depth)
