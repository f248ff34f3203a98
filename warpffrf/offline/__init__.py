"""Finite-element mesh and material to `ReducedBody`, with NumPy, SciPy and scikit-fem only."""

from warpffrf.offline.options import ContactGrid, ReductionOptions
from warpffrf.offline.reduction import reduce

__all__ = ["ContactGrid", "ReductionOptions", "reduce"]
