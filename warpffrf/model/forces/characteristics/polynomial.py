"""A force that is a polynomial of deformation or rate without a constant term, F = k_1 x + k_2 x^2 + k_3 x^3 + ...

k_1 and k_3 > 0 make the hardening spring of Duffing's oscillator, k_3 < 0 a softening one; even powers act differently
in tension and compression.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_array
from warpffrf.model.forces.characteristics.characteristic import TERMS, Characteristic, Pieces
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
@dataclass(frozen=True)
class ForcePolynomial(Characteristic):
    """F = k_1 x + k_2 x^2 + ... with `coefficients` (k_1, k_2, ...) [N/m, N/m^2, ...; of torques and angles N m/rad,
    ...], seven at most. Raises `InputError`."""

    coefficients: Sequence[float]
    kind: ClassVar[str] = "force_polynomial"

    def __post_init__(self) -> None:
        k = require_array(self.coefficients, "ForcePolynomial: coefficients", (None,))
        if not 1 <= len(k) < TERMS:
            raise InputError(f"ForcePolynomial: 1 to {TERMS - 1} coefficients are needed, got {len(k)}")
        object.__setattr__(self, "coefficients", tuple(k.tolist()))

    @cached_property
    def pieces(self) -> Pieces:
        c = np.zeros((1, TERMS))
        c[0, 1 : len(self.coefficients) + 1] = self.coefficients
        return Pieces(np.zeros(0), np.zeros(1), c, np.zeros(1), np.ones(1))

    def describe(self) -> dict[str, Any]:
        return {"kind": self.kind, "coefficients": list(self.coefficients)}
