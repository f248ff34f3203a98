r"""Where deflections take the points of a body: its motion of second order in the modes, on few shapes.

A body that deflects far moves by u = sum_i q_i phi_i + Theta(q, q): Theta is what bends shorten, and how the body
evades stretching (derived in `warpffrf.offline.inertia.second_order`). Of the pairs of modes, each a field, the R
principal ones in the mass are kept (`warpffrf.offline.inertia.second_order_shapes`),

    Theta(q, q) = sum_s g_s B_s,      g_s = q.S_s q/2,      dTheta = sum_s (q.S_s dq) B_s,

with shapes B_s of modal mass 1 kg, as those of modes, orthogonal to one another: g_s is in m like q, S_s in 1/m. In the
rates gd_s = q.S_s qd and with the overlap C_is = int phi_i.B_s dm the kinetic energy of a body that does not turn is

    T = |qd|^2/2 + qd.C gd + |gd|^2/2,

of which simulations have the first part.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class SecondOrderMotion:
    """Amplitudes of the shapes of second order: `forms` S (R, k, k) [1/m], symmetric, of the first k modes, and the
    `overlap` C (k, R) of these modes with the shapes. The shapes themselves are with what is seen of them, as
    `DisplaySurface.second_order`."""

    forms: Array
    overlap: Array

    def __post_init__(self) -> None:
        require_array(self.forms, "second-order motion", (None, None, None))
        if self.forms.shape[1] != self.forms.shape[2] or self.overlap.shape != self.forms.shape[1::-1]:
            raise InputError(
                f"second-order motion: forms {self.forms.shape} and overlap {self.overlap.shape} are not (R, k, k) and "
                "(k, R)"
            )

    def amplitudes(self, q: Array) -> Array:
        """g (..., R) [m] at modal coordinates q (..., m) [m]."""
        return 0.5 * self.between(q, q)

    def between(self, x: Array, y: Array) -> Array:
        """x.S_s y (..., R) [m] of x, y (..., m) [m]: of y a rate or a variation, at x, that of g."""
        k = self.forms.shape[1]
        return np.einsum("...i,sij,...j->...s", x[..., :k], self.forms, y[..., :k], optimize=True)

    def kinetic_energy(self, q: Array, qd: Array) -> Array:
        """What T (...) [J] has beside |qd|^2/2, at q (..., m) [m] and rates qd (..., m) [m/s]."""
        gd = self.between(q, qd)
        along = np.einsum("...i,is,...s->...", qd[..., : len(self.overlap)], self.overlap, gd, optimize=True)
        return along + 0.5 * np.sum(gd * gd, axis=-1)


def motion_of(body: Any) -> SecondOrderMotion | None:
    """The second-order motion of a body that loads stiffen, None of others, and of one that was reduced without.

    A *body* is whatever has `reduced` and `stiffening`, as in `warpffrf.model.reduced.interface_motion`.
    """
    terms = body.reduced.inertia_terms if body.stiffening and body.reduced is not None else None
    return None if terms is None or terms.stiffening is None else terms.stiffening.motion


def skin_displacement(body: Any, q: Array) -> Array:
    """Phi q + Theta(q, q) (n, 3) [m, user axes] at the points of the skin of a flexible body."""
    surface, motion = body.reduced.surface, motion_of(body)
    u = np.einsum("m,mnd->nd", q, surface.modes)  # without a copy of the modes in double precision
    if motion is not None and surface.second_order is not None:
        u += np.einsum("s,snd->nd", motion.amplitudes(q), surface.second_order)
    return u


def skin_variation(body: Any, q: Array, dq: Array) -> Array:
    """The change (n, 3) [m, user axes] of `skin_displacement` at q (m,) by small dq (m,), real or complex."""
    surface, motion = body.reduced.surface, motion_of(body)
    du = np.tensordot(dq, surface.modes, 1)
    if motion is not None and surface.second_order is not None:
        du = du + np.tensordot(motion.between(q, dq), surface.second_order, 1)
    return du
