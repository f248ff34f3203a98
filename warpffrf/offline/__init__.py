"""Finite-element mesh and material to `ReducedBody`, with NumPy, SciPy and scikit-fem only."""

from warpffrf.offline.half_space_body import half_space_body
from warpffrf.offline.options import ContactGrid, ReductionOptions
from warpffrf.offline.reduction import reduce
from warpffrf.offline.rigid_film_body import rigid_film_body

__all__ = ["ContactGrid", "ReductionOptions", "half_space_body", "reduce", "rigid_film_body"]
