"""Vibration modes of the free body: nothing is held, so that they are modes of the floating body itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.offline.bases.basis import ModalBasis
from warpffrf.offline.bases.problem import BasisProblem, RawBasis, lowest_modes


@named_arguments
@dataclass(frozen=True, kw_only=True)
class FreeFree(ModalBasis):
    """Vibration modes of the free body (interfaces free to move) and inertia-relief attachment modes: the default."""

    kind: ClassVar[str] = "free_free"
    takes: ClassVar[Mapping[str, str]] = {
        "max_frequency": "highest vibration mode",
        "modes": "number of vibration modes",
    }

    def columns(self, problem: BasisProblem) -> RawBasis:
        problem.require_fits(self.kind, problem.limits.count or 0, "vibration modes")
        omega, V, notes = lowest_modes(problem.model, problem.limits, self.mode_tolerance)
        return RawBasis(V, notes=notes, facts={"vibration_modes": len(omega)})
