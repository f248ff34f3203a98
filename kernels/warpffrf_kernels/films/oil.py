"""Viscosity and density of the oils of a film, as defined in `warpffrf.model.oils`, with their derivatives."""

import warp as wp

from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real

wp.set_module_options(MODULE_OPTIONS)

NEWTONIAN = wp.constant(0)
BARUS = wp.constant(1)
ROELANDS = wp.constant(2)
POLE_PRESSURE = wp.constant(wp.float64(196.2e6))  # Pa, of Roelands' law


@wp.struct
class Oil:
    """Properties at a pressure: mu [Pa s], mu'/mu [1/Pa], rho/rho_0 and its derivative [1/Pa]."""

    viscosity: real
    thickening: real
    density: real
    stiffening: real


@wp.func
def oil_at(model: Model, film: int, pressure: real, thinning: real) -> Oil:
    """Oil of a film; below the cavitation pressure the properties at it. thinning: ln of the viscosity without pressure
    over that at the oil's reference temperature; Roelands' exponent does not depend on it."""
    p = wp.max(pressure, real(0.0))
    found = Oil()
    found.viscosity = model.elements[0].films[0].oil[film, 0]
    if thinning != real(0.0):
        found.viscosity *= wp.exp(thinning)
    kind = model.elements[0].films[0].oil_kind[film]
    if kind == BARUS:
        found.thickening = model.elements[0].films[0].oil[film, 1]
        found.viscosity *= wp.exp(model.elements[0].films[0].oil[film, 1] * p)
    elif kind == ROELANDS:
        relative = real(1.0) + p / POLE_PRESSURE
        exponent = model.elements[0].films[0].oil[film, 3]
        rise = model.elements[0].films[0].oil[film, 2]
        found.thickening = model.elements[0].films[0].oil[film, 1] * wp.pow(relative, exponent - real(1.0))
        if thinning != real(0.0):
            found.thickening *= (rise + thinning) / rise
            rise += thinning
        found.viscosity *= wp.exp(rise * (wp.pow(relative, exponent) - real(1.0)))
    a = model.elements[0].films[0].oil[film, 4]
    b = model.elements[0].films[0].oil[film, 5]
    found.density = real(1.0) + a * p / (real(1.0) + b * p)
    found.stiffening = a / ((real(1.0) + b * p) * (real(1.0) + b * p))
    return found
