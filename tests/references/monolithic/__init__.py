"""The monolithic reference: all coordinates of all bodies, rigid, global, local and multipliers, in one Newton system.

The reference for the separated solver, written in NumPy and SciPy from the model alone.

    core             the system without contact: scene -> bodies, rows, springs, loads (description); residual and exact
                     Jacobian (equations, rows, inertia_forces); formulas of a step (integrator); local coordinates;
                     K of the variants: dense LU, kept LU, diagonal plus low rank (linear)
    line_of_centres  gaps and forces of a pair with parallel-axes kinematics, its window and its records
    nodal            the same for the law at nodes of any shape, with friction
    films            oil films, on grid nodes or with pressures at FE nodes
    newton           a step, contact included
    run, start       the time loop and its initial state; history, records: saved results
    settings         options; refusals: what the reference does not support
    results          `simulate`: a run as a Result, like those of the engine; the only file that requires it, and Warp

A package imports those above it, and none of them the files behind, which combine the packages.
"""

from references.monolithic.core.integrator import coefficients_of
from references.monolithic.history import MonolithicHistory
from references.monolithic.run import run

__all__ = ["MonolithicHistory", "coefficients_of", "run"]
