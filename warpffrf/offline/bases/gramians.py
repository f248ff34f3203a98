r"""Gramians and Hankel values of a modal system with symmetric inputs and outputs, in closed form.

    q_i'' + 2 zeta omega_i q_i' + omega_i^2 q_i = b_i u,      y = sum_i b_i^T q_i.

An impulse gives `q_i = b_i Im(e^(mu_i t))/omega_d,i` with mu_i = omega_i (-zeta + i sqrt(1 - zeta^2)), omega_d,i =
Im mu_i, and `q_i' = b_i Im(mu_i e^(mu_i t))/omega_d,i`. The controllability Gramian `P = int x x^T dt` of x = (q, q')
needs, for complex alpha and beta,

    int Im(alpha e^(mu t)) Im(beta e^(nu t)) dt = 1/2 Re[ alpha beta/(mu + nu) - alpha conj(beta)/(mu + conj(nu)) ].

No Lyapunov equation is solved. With `J = [[D, 1], [1, 0]]`, D = diag(2 zeta omega), one has A^T J = J A and B^T J = C:
the observability Gramian is `Q = J P J`, the Hankel values are the absolute eigenvalues of P J, and the velocity block
of Q is the position block of P. The state is scaled to (omega q, q'), so that both halves have the unit of a velocity.
"""

from __future__ import annotations

import numpy as np

from warpffrf.offline.elastic import Array


def _integral(mu: Array, alpha: Array, beta: Array) -> Array:
    """int Im(alpha_i e^(mu_i t)) Im(beta_j e^(mu_j t)) dt (m, m)."""
    a, b = alpha[:, None], beta[None, :]
    m, n = mu[:, None], mu[None, :]
    return 0.5 * np.real(a * b / (m + n) - a * b.conj() / (m + n.conj()))


def _poles(omega: Array, damping: float) -> Array:
    return omega * complex(-damping, np.sqrt(1.0 - damping**2))


def position_gramian(omega: Array, damping: float, b: Array) -> Array:
    """P_pp (m, m) = int q q^T dt of modes `omega` (m,) [rad/s] with ratio `damping` and inputs b (m, a)."""
    mu = _poles(omega, damping)
    one = 1.0 / np.imag(mu).astype(complex)
    return (b @ b.T) * _integral(mu, one, one)


def hankel_values(omega: Array, damping: float, b: Array) -> Array:
    """Hankel values (2 m,), descending, of the system from u to y = b^T q."""
    m = len(omega)
    mu = _poles(omega, damping)
    states = [omega / np.imag(mu) + 0j, mu / np.imag(mu)]  # amplitudes of omega q and of q'
    P = np.block([[_integral(mu, x, y) for y in states] for x in states]) * np.tile(b @ b.T, (2, 2))
    D = np.diag(2.0 * damping / omega)
    J = np.block([[D, np.diag(1.0 / omega)], [np.diag(1.0 / omega), np.zeros((m, m))]])
    values, vectors = np.linalg.eigh(0.5 * (P + P.T))
    L = vectors * np.sqrt(np.maximum(values, 0.0))
    return np.sort(np.abs(np.linalg.eigvalsh(L.T @ J @ L)))[::-1]


def modal_receptance(at: Array, omega: Array, damping: float, b: Array) -> Array:
    """b^T (Omega^2 + 2 i zeta w Omega - w^2)^-1 b (w, a, a) at the angular frequencies `at` (w,)."""
    response = 1.0 / (omega**2 + at[:, None] * (2j * damping * omega - at[:, None]))
    return b.T @ (response[:, :, None] * b)


def projected_receptance(at: Array, D: Array, K: Array, b: Array) -> Array:
    """b^T (K + i w D - w^2)^-1 b (w, a, a) at the angular frequencies `at` (w,); D, K dense (m, m), unit mass."""
    w = at[:, None, None]
    S = K + 1j * w * D - w**2 * np.eye(len(K))
    return b.T @ np.linalg.solve(S, np.broadcast_to(b.astype(complex), (len(at), *b.shape)))
