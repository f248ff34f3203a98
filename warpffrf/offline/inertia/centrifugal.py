r"""The static response of a body to its own turning: attachment modes for it, and what a reduced body lacks of it.

At constant angular velocity w a body carries the load `-int rho w x (w x X) dV`, one field for each of the six products
w_a w_b. For loads on interfaces attachment modes make the static response exact at any number of modes; the loads of
turning are no different. With

    F_c = T^T M a,        a_ab = -(R_a R_b + R_b R_a) X,   a_aa = -R_a R_a X,        A_c = G F_c,

beside the interface loads (`reduce(centrifugal=True)`), Phi Omega^-2 Phi^T F_c = G F_c. Vibration modes alone hardly
hold it: that of a disc is the breathing one, above hundreds of others, and interface modes have it by accident only.

Without it, or where the inertia terms cover the lowest k modes only, a part of G F_c is left out,

    u = G F_c - Phi_k Omega_k^-2 Phi_k^T F_c,        S = u^T M u (6, 6).

The products, those of two axes times root 2, have the length |w|^2, whichever axes they are taken in. So, with those
columns over root 2, the displacement left out has at turning |w| a root mean square over the radius of gyration of at
most

    |w|^2 left_out,        left_out = root(largest eigenvalue of S) / root(tr J0/2)      [s^2].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from warpffrf.model.reduced.inertia import PRODUCTS
from warpffrf.offline.elastic import ElasticModel
from warpffrf.offline.inertia.invariants import covered_modes

Array = np.ndarray
# Of the static response to turning that inertia terms may leave to modes beyond those they cover: displacements are
# usually wanted to that.
BEYOND = 0.01


@dataclass(frozen=True, eq=False)
class TurningResponse:
    """Static response u (n, c) to loads F (n, c) of turning beside the modes Phi (n, m), `omega` (m,) [rad/s]
    ascending: `on_modes` Phi^H F (m, c), `overlap` Phi^H M u (m, c), `gram` u^H M u (c, c)."""

    omega: Array
    on_modes: Array
    overlap: Array
    gram: Array

    @classmethod
    def of(cls, M, F: Array, u: Array, omega: Array, Phi: Array) -> TurningResponse:
        """Of loads `F`, whose flexible response is `u`, and M-orthonormal modes `Phi`; M (n, n) mass matrix."""
        Mu = M @ u
        return cls(omega, Phi.conj().T @ F, Phi.conj().T @ Mu, u.conj().T @ Mu)

    def beyond(self, limit: float) -> Array:
        """S (c, c): M-products of what modes up to `limit` [rad/s] lack of the response."""
        inside = self.omega <= limit
        c = self.on_modes[inside] / (self.omega[inside] ** 2)[:, None]
        both = self.overlap[inside].conj().T @ c
        return self.gram - both - both.conj().T + c.conj().T @ c


def covering_turning(omega: Array, least: int, lacking: Callable[[float], float]) -> int:
    """How many of the modes `omega` (m,) [rad/s], `least` at least, get inertia terms so that they hold the static
    response to turning but `BEYOND`; `lacking`: `left_out` [s^2] of the modes up to a limit [rad/s]."""
    allowed = BEYOND * lacking(0.0)
    for kept in range(least, len(omega)):
        whole = covered_modes(omega, kept) == kept  # cuts no multiple frequency apart
        if whole and lacking(float(omega[kept - 1]) if kept else 0.0) <= allowed:
            return kept
    return len(omega)


def left_out(S: Array, inertia: Array) -> float:
    """Bound of the displacement left out [s^2], see the module: S (6, 6) [kg m2 s4] in the order of `PRODUCTS`,
    `inertia` J0 (3, 3) [kg m2]."""
    scale = np.array([1.0 if a == b else np.sqrt(0.5) for a, b in PRODUCTS])
    largest = float(np.linalg.eigvalsh(0.5 * (S + S.T) * np.outer(scale, scale))[-1])
    return float(np.sqrt(max(largest, 0.0) / (0.5 * np.trace(inertia))))


def turning_response(model: ElasticModel, F: Array, omega: Array, Phi: Array) -> TurningResponse:
    """`TurningResponse` of the free body `model` to loads F (n, c) beside modes Phi (n, m)."""
    return TurningResponse.of(model.M, F, model.flexibility(F), omega, Phi)
