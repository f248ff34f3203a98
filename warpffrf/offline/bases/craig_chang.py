r"""Free vibration modes and residual flexibility (Craig and Chang 1977, after MacNeal 1971 and Rubin 1975).

The residual-flexibility attachment modes are what the kept modes V lack of the static response to interface loads,

    A_res = G F - V Omega^-2 V^T F,      G = P^T K^+ P.

MacNeal's method uses them in the stiffness only, without mass; Rubin's, and Craig and Chang's as a basis, project mass
and stiffness alike, which is what the Rayleigh-Ritz step here does. Since V Omega^-2 V^T F is in the span of V,

    span [V, A_res] = span [V, G F]:

the *space* is that of `free_free` with the same modes, and so is every frequency and response. The two differ in their
coordinates before orthonormalisation only.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.offline.bases.basis import ModalBasis
from warpffrf.offline.bases.free_free import FreeFree
from warpffrf.offline.bases.problem import BasisProblem, RawBasis, lowest_modes

# Energy norm, of that of the whole attachment mode, below which a residual one is the round-off of the subtraction.
NEGLIGIBLE = 1e-7


@named_arguments
@dataclass(frozen=True, kw_only=True)
class CraigChang(ModalBasis):
    """Free vibration modes and residual-flexibility attachment modes (Craig and Chang 1977; Rubin 1975)."""

    kind: ClassVar[str] = "craig_chang"
    takes: ClassVar[Mapping[str, str]] = FreeFree.takes

    def columns(self, problem: BasisProblem) -> RawBasis:
        problem.require_fits(self.kind, problem.limits.count or 0, "vibration modes")
        model = problem.model
        omega, V, notes = lowest_modes(model, problem.limits, self.mode_tolerance)
        A, F = problem.attachments, problem.system.loads
        residual = A - V @ ((V.T @ F) / (omega**2)[:, None])
        energy = np.einsum("na,na->a", residual, model.K @ residual)
        kept = energy > NEGLIGIBLE**2 * np.einsum("na,na->a", A, model.K @ A)
        columns = np.concatenate([V, residual[:, kept]], axis=1)
        facts = {"vibration_modes": len(omega), "residual_attachment_modes": int(kept.sum())}
        return RawBasis(columns, redundant=int(kept.sum()), notes=notes, facts=facts)
