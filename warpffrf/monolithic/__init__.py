"""The monolithic reference: all coordinates of all bodies, rigid, global, local and multipliers, in one Newton system.

The yardstick that the separated solver is measured by, written in NumPy and SciPy from the model alone.

    description     scene -> bodies, markers, rows, springs, loads
    integrator      the formulas of a step
    equations       residual and exact Jacobian of everything but contact (rows, inertia_forces)
    contact         gaps and forces of a pair on the line of centres (contact_frame, sampling, local_coordinates)
    node_pair       the same for the law at nodes of any shape, with friction (node_gap, node_tangent, node_surface,
                    layer_slopes, node_friction; node_build, node_newton, node_record)
    linear          K of the variants: dense LU, kept LU, diagonal plus low rank
    newton, run     a step; the time loop
    settings        what `simulate(method=Monolithic(...))` chooses; contact_record, checkpoint: what is saved
"""

from warpffrf.monolithic.history import MonolithicHistory
from warpffrf.monolithic.integrator import DEFAULT_INTEGRATOR, coefficients_of
from warpffrf.monolithic.run import run
from warpffrf.monolithic.settings import Monolithic

__all__ = [
    "DEFAULT_INTEGRATOR",
    "Monolithic",
    "MonolithicHistory",
    "coefficients_of",
    "run",
]
