r"""Inertia of the local modes of a contact surface: Gram matrices of the residual static responses, for both paths.

Of the residual responses U (n, count) to the loads `B s` of unit coefficients, `N = U^T M U` and `W = Phi_g^T M U` are
projected like the compliance, so that they belong to unit forces of the functions:

    N := M_psi^-1 N M_psi^-1,      W := W M_psi^-1.

On a periodic body this is done in every harmonic, as for the compliance: the response to a unit load of sector 0 is 1/N
times the sum of the waves, so N is block-circulant with `lags[l] = 1/N sum_k N_k e^{i k l phi}`. A global mode
`sqrt(2/N) Re (phi e^{i k s phi})` overlaps with the response of sector s by `sqrt(2/N) Re ((u^H M_k phi) e^{i k s
phi})`: the wave `u^H M_k phi` becomes a real field just as a displacement of the modes does.

Consistent mass matrices throughout, or the one that came with the mesh.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.reduced.local_mass import LocalMass

if TYPE_CHECKING:
    from warpffrf.offline.contact.traction_fields import KeptFunctions
    from warpffrf.offline.cyclic.surface import CyclicField

Array = np.ndarray


class HarmonicMass:
    """N and W of one field of a periodic body's contact surface, as the harmonics come."""

    def __init__(self, field: CyclicField) -> None:
        self.field = field
        self._N = np.zeros((field.N // 2 + 1, field.count, field.count), dtype=complex)
        self._W: list[tuple[int, Array]] = []

    def add(self, k: int, M: Any, u: Array, Phi: Array) -> None:
        """Harmonic k: mass matrix M (n, n), residual responses u (n, count), global modes Phi (n, p; none: p = 0)."""
        inertia = M @ u
        half = self.field.without_gram(k, u.conj().T @ inertia)
        N = self.field.without_gram(k, half.conj().T)
        self._N[k] = 0.5 * (N + N.conj().T)
        if Phi.shape[1]:
            self._W.append((k, self.field.without_gram(k, inertia.conj().T @ Phi)))

    def product(self, combine: Callable[[list[Array]], Array]) -> LocalMass:
        """What the reduced body keeps; `combine` makes real fields of the waves of the harmonics with global modes."""
        field = self.field
        lags = np.fft.irfft(self._N, n=field.N, axis=0)[:: field.stride]
        whole = len(lags) * field.c
        sampled = [field.sampled(k, wave, whole) for k, wave in self._W]
        overlap = combine(sampled) if sampled else np.zeros((whole * field.rows, 0))
        return LocalMass(np.ascontiguousarray(lags), np.ascontiguousarray(overlap))


def dense_mass(kept: KeptFunctions, N: Array, W: Array) -> LocalMass:
    """N (count, count) and W^T (count, m) of unit coefficients of the whole field, for forces of the functions
    `kept`."""
    projected = kept.without_gram(kept.without_gram(N).T)
    lags = np.ascontiguousarray(0.5 * (projected + projected.T))[None]
    return LocalMass(lags, np.ascontiguousarray(kept.without_gram(W)))
