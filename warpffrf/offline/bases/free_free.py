"""Vibration modes of the free body: nothing is held, so that they are modes of the floating body itself."""

from __future__ import annotations

from warpffrf.model.bases import FreeFree
from warpffrf.offline.bases.problem import BasisProblem, RawBasis, lowest_modes


def free_free(problem: BasisProblem, options: FreeFree) -> RawBasis:
    """Free-free vibration modes up to the limits of `reduce`. A-priori rule: all modes up to a frequency."""
    problem.require_fits(options.kind, problem.limits.count or 0, "vibration modes")
    omega, V, notes = lowest_modes(problem.model, problem.limits, options.mode_tolerance)
    return RawBasis(V, notes=notes, facts={"vibration_modes": len(omega)})
