"""Fraction of a required accuracy available to each source of error.

Sources are independent, and several of similar size may occur: each that can be chosen may take half. The field of
pressures, whose edge never coincides with the grid, may err by twice as much as forces, and its grid may take three
quarters of that: the remaining error also appears in the forces.
"""

from __future__ import annotations

from dataclasses import dataclass

from warpffrf.model.errors import InputError, require_number

SHARE, OF_PRESSURES = 0.5, 0.75
PRESSURES = 2.0
FINEST, COARSEST = 1e-5, 0.2  # range that budgets can resolve: below, round-off of second differences dominates


@dataclass(frozen=True)
class Limits:
    """Largest errors of a source for a required `accuracy`, a fraction."""

    accuracy: float

    @classmethod
    def of(cls, accuracy: object) -> Limits:
        """Raises `InputError` for values that are not a fraction between FINEST and COARSEST."""
        wanted = require_number(accuracy, "simulate: accuracy", positive=True)
        if not FINEST <= wanted <= COARSEST:
            raise InputError(
                f"simulate: accuracy is the error wanted of forces, motions and deformations, from {FINEST:g} to "
                f"{COARSEST:g}, got {wanted:g}; for one per cent give 0.01. What halves single steps is step_error="
            )
        return cls(wanted)

    @property
    def force(self) -> float:
        """Limit for forces, motions and deformations."""
        return SHARE * self.accuracy

    @property
    def pressure(self) -> float:
        """Limit for pressures."""
        return OF_PRESSURES * PRESSURES * self.accuracy
