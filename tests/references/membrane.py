"""The membrane energy V4 of `warpffrf.model.reduced.inertia`, its gradient and its tangent, at one state."""

from __future__ import annotations

import numpy as np

from warpffrf.model.reduced.inertia import membrane_amplitudes

Array = np.ndarray


def membrane_energy(forms: Array, q: Array) -> float:
    """V4 [J]."""
    e = membrane_amplitudes(forms, q)
    return float(0.5 * e @ e)


def membrane_gradient(forms: Array, q: Array) -> Array:
    """dV4/dq (k,) [N], the term added to omega^2 q; the force on the modes is the opposite."""
    y = forms @ q[: forms.shape[1]]
    return (0.5 * y @ q[: forms.shape[1]]) @ y


def membrane_tangent(forms: Array, q: Array) -> Array:
    """d2V4/dq2 (k, k) [N/m], symmetric."""
    y = forms @ q[: forms.shape[1]]
    return y.T @ y + np.tensordot(0.5 * y @ q[: forms.shape[1]], forms, 1)
