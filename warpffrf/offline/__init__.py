"""Finite-element mesh and material to `ReducedBody`: NumPy, SciPy and scikit-fem, nothing from the simulation."""

from warpffrf.offline.reduction import reduce

__all__ = ["reduce"]
