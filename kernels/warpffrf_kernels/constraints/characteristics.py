"""Nonlinear springs and dampers: one function for all kinds of characteristics.

A characteristic is a table of pieces (`Model.characteristics`), on each of them with xi = x - origin

    F = sum_k c_k xi^k + a sgn(xi) |xi|^p,      V = V_i + sum_k c_k xi^(k+1)/(k+1) + a |xi|^(p+1)/(p+1),

as defined in `warpffrf.model.forces.characteristics`. A row with characteristics has the law

    lambda = k c + F(c) + d cdot + G(cdot) + preload,      k_e = k + F' + (d + G') VEL,

and is solved like a linear spring, as a constraint with the compliance 1/k_e (`rows`). k_e can be negative, and zero:
in the clearance of a stop, at the start of a power law. As a compliance cannot be infinite, |k_e| has the lower bound
LIMP times m ACC, the inertial resistance of the lightest body. The law itself stays exact; Newton's method, whose
matrix then has an error of LIMP, gains a factor of LIMP per iteration instead of converging quadratically.
"""

import warp as wp

from warpffrf_kernels.bodies.interfaces import marker_of
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real, vec3

wp.set_module_options(MODULE_OPTIONS)

# of m ACC: a compliance of 1/LIMP times that of the inertia leaves ten digits for the inverse of the retained matrix
LIMP = wp.constant(wp.float64(1.0e-6))


@wp.func
def characteristic(model: Model, n: int, x: real) -> vec3:
    """Force, slope and potential of characteristic n at x."""
    low = model.elements[0].characteristics.start[n]
    high = model.elements[0].characteristics.start[n + 1] - 1
    while low < high:  # the last piece that begins at or below x
        middle = (low + high + 1) / 2
        if x >= model.elements[0].characteristics.begin[middle]:
            low = middle
        else:
            high = middle - 1
    xi = x - model.elements[0].characteristics.origin[low]
    force = real(0.0)
    slope = real(0.0)
    energy = real(0.0)
    i = int(7)
    while i >= 0:
        c = model.elements[0].characteristics.coefficient[low, i]
        slope = slope * xi + force
        force = force * xi + c
        energy = energy * xi + c / real(i + 1)
        i -= 1
    energy = energy * xi + model.elements[0].characteristics.constant[low]
    a = model.elements[0].characteristics.power[low]
    if a != real(0.0):
        p = model.elements[0].characteristics.exponent[low]
        size = wp.abs(xi)
        steep = a * wp.pow(size, p - real(1.0))
        slope += p * steep
        force += steep * xi
        energy += steep * xi * xi / (p + real(1.0))
    return vec3(force, slope, energy)


@wp.func
def firm(model: Model, row: int, force: vec3, acc: real, stiffness: real) -> real:
    """k_e, bounded away from zero, of a row with characteristics; `force` per unit of lambda, see the module."""
    least = real(0.0)
    for side in range(2):
        b = model.markers.body[marker_of(model, row, side)]
        if b >= 0:
            inertia = model.bodies.mass[b]
            if wp.length(force) == real(0.0):
                inertia = wp.trace(model.bodies.inertia[b]) / real(3.0)
            if least == real(0.0) or inertia < least:
                least = inertia
    least *= LIMP * acc
    if wp.abs(stiffness) < least:
        return least
    return stiffness
