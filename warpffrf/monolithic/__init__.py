"""The monolithic reference: all coordinates of all bodies, rigid, global, local and multipliers, in one Newton system.

The yardstick that the separated solver is measured by, written in NumPy and SciPy from the model alone.

    core             the system without contact: scene -> bodies, rows, springs, loads (description); residual and exact
                     Jacobian (equations, rows, inertia_forces); formulas of a step (integrator); local coordinates;
                     K of the variants: dense LU, kept LU, diagonal plus low rank (linear)
    line_of_centres  gaps and forces of a pair on the line of centres, its window and what is saved of it
    nodal            the same for the law at nodes of any shape, with friction
    films            oil films, by hats or with pressures at FE nodes
    newton           a step, contact included
    run, start       the time loop and what it begins with; history, checkpoint: what is saved
    settings         what `simulate(method=Monolithic(...))` chooses; refusals: what the reference does not have

A room imports those above it, and none of them the files behind: these bring the rooms together.
"""

from warpffrf.monolithic.core.integrator import DEFAULT_INTEGRATOR, coefficients_of
from warpffrf.monolithic.history import MonolithicHistory
from warpffrf.monolithic.run import run
from warpffrf.monolithic.settings import Monolithic

__all__ = [
    "DEFAULT_INTEGRATOR",
    "Monolithic",
    "MonolithicHistory",
    "coefficients_of",
    "run",
]
