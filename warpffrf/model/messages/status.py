"""How a run ended."""

from __future__ import annotations

from enum import StrEnum


class Status(StrEnum):
    """How a run ended, of `Result.status`; each is also its own text, `result.status == "completed"`. The cause and the
    cure are in `Result.message`."""

    COMPLETED = "completed"
    INTERRUPTED = "interrupted"  # by the user
    UNFINISHED = "unfinished"  # still running, or stopped from outside; read from its folder
    NO_EQUILIBRIUM = "no_equilibrium"
    NOT_CONVERGED = "not_converged"  # Newton iteration
    CYCLING = "cycling"  # active set of contact, or stick and slip of its cells
    CAPACITY = "capacity"  # of the window of a contact
    MEMORY = "memory"
    NOT_FINITE = "not_finite"
    SINGULAR = "singular"  # joint equations
    INDEFINITE = "indefinite"  # contact compliance
    STENCIL = "stencil"
    PASSED = "passed"  # a patch advances by more than its length in a step
    LEAPT = "leapt"  # surfaces pass through each other in a step
    ENERGY = "energy"  # the ledger does not close
    TOO_HOT = "too_hot"  # a film
    STEP_ERROR = "step_error"  # exceeds `RunOptions.step_error` at the shortest step
    STEP_UNDERFLOW = "step_underflow"

    def __repr__(self) -> str:
        return repr(self.value)
