"""The monolithic reference: all coordinates of all bodies, rigid, global, local and multipliers, in one Newton system.

The yardstick that the separated solver is measured by, written in NumPy and SciPy from the model alone.

    core             the system without contact: scene -> bodies, rows, springs, loads (description); residual and exact
                     Jacobian (equations, rows, inertia_forces); formulas of a step (integrator); local coordinates;
                     K of the variants: dense LU, kept LU, diagonal plus low rank (linear)
    line_of_centres  gaps and forces of a pair on the line of centres, its window and what is saved of it
    nodal            the same for the law at nodes of any shape, with friction
    films            oil films, by hats or with pressures at FE nodes
    newton           a step, contact included
    run, start       the time loop and what it begins with; history, records: what is saved
    settings         what can be chosen; refusals: what the reference does not have
    results          `simulate`: a run as a Result, beside those of the engine; the only file that needs it, and Warp

A room imports those above it, and none of them the files behind: these bring the rooms together.
"""

from references.monolithic.core.integrator import coefficients_of
from references.monolithic.history import MonolithicHistory
from references.monolithic.run import run

__all__ = [
    "MonolithicHistory",
    "coefficients_of",
    "run",
]
