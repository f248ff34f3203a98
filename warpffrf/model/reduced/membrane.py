r"""The membrane energy of a body: what its fibres are stretched by, of second order in its modes, and cannot evade.

Deflections stretch fibres by w'^2/2. A beam whose ends may move, or a developable bend of a plate, relieves that by
motion along itself; a plate held along its rim, or bent both ways, cannot. The energy left is the square of a strain
that is quadratic in the modal coordinates q, and kept by its R largest principal parts (derived in
`warpffrf.offline.inertia.membrane`):

    V4 = 1/2 sum_r e_r^2,        e_r = q.L_r q/2,        y_r = L_r q,
    dV4/dq = sum_r e_r y_r,      d2V4/dq2 = sum_r y_r y_r^T + e_r L_r.

It is never negative, and so is the first part of its tangent. q is in m at modal mass 1 kg, L_r in sqrt(J)/m^2, e_r in
sqrt(J).
"""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray


def membrane_amplitudes(forms: Array, q: Array) -> Array:
    """e_r (R,) [sqrt(J)] of the `forms` L (R, k, k) at the first k of the coordinates q (m,) [m]."""
    q = q[: forms.shape[1]]
    return 0.5 * (forms @ q) @ q


def membrane_forms(body: Any) -> Array | None:
    """L (R, k, k) of a body that loads stiffen, None of others, and of one without membrane energy.

    A *body* is whatever has `reduced` and `stiffening`, as in `warpffrf.model.reduced.interface_motion`.
    """
    terms = body.reduced.inertia_terms if body.stiffening and body.reduced is not None else None
    return None if terms is None or terms.stiffening is None else terms.stiffening.membrane


def membrane_energies(forms: Array, q: Array) -> Array:
    """V4 (T,) [J] of rows of coordinates q (T, m)."""
    k = forms.shape[1]
    e = 0.5 * np.einsum("ti,rij,tj->tr", q[:, :k], forms, q[:, :k], optimize=True)
    return 0.5 * np.sum(e * e, axis=1)
