"""How much of a wanted accuracy each source of error may take.

Sources are independent, and several of about the same size may meet: each that can be chosen may take half. The field
of pressures, whose edge no grid meets, may err by twice what forces may, and its grid may take three quarters of that:
of what else it errs by forces tell.
"""

from __future__ import annotations

from dataclasses import dataclass

from warpffrf.model.errors import InputError, require_number

SHARE, OF_PRESSURES = 0.5, 0.75
PRESSURES = 2.0
FINEST, COARSEST = 1e-5, 0.2  # accuracies that budgets can tell of: below, round-off of second differences shows


@dataclass(frozen=True)
class Limits:
    """Largest errors of a source for a wanted `accuracy`, a fraction."""

    accuracy: float

    @classmethod
    def of(cls, accuracy: object) -> Limits:
        """Raises `InputError` for what is no fraction between FINEST and COARSEST."""
        wanted = require_number(accuracy, "simulate: accuracy", positive=True)
        if not FINEST <= wanted <= COARSEST:
            raise InputError(
                f"simulate: accuracy is the error wanted of forces, motions and deformations, from {FINEST:g} to "
                f"{COARSEST:g}, got {wanted:g}; for one per cent give 0.01. What halves single steps is step_error="
            )
        return cls(wanted)

    @property
    def force(self) -> float:
        """Of forces, motions and deformations."""
        return SHARE * self.accuracy

    @property
    def pressure(self) -> float:
        """Of pressures."""
        return OF_PRESSURES * PRESSURES * self.accuracy
