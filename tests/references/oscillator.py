r"""An integrator on the oscillator qddot + 2 zeta omega qdot + omega^2 q = 0: amplification matrix, roots, order.

With the state x = (q, h qdot, h^2 a) of the update of `warpffrf.model.integrators`, W = omega h, and
h^2 qddot = -2 zeta W (h qdot) - W^2 q at both ends of a step,

    q_1 - beta h^2 a_1                                = q_0 + h qdot_0 + (1/2 - beta) h^2 a_0
    h qdot_1 - gamma h^2 a_1                          = h qdot_0 + (1 - gamma) h^2 a_0
    (1 - alpha_m) h^2 a_1 - (1 - alpha_f) h^2 qddot_1 = -alpha_m h^2 a_0 + alpha_f h^2 qddot_0,

so that x_1 = A x_0 with A (3, 3) of W and zeta alone. Its eigenvalues are the roots of the method.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.integrators import Coefficients

Array = np.ndarray


def amplification(coefficients: Coefficients, frequency: float, ratio: float = 0.0) -> Array:
    """A (3, 3) of one step, for `frequency` omega h [rad] and damping `ratio` zeta."""
    alpha_m, alpha_f, beta, gamma = coefficients
    W, force = frequency, np.array([-(frequency**2), -2.0 * ratio * frequency, 0.0])
    left = np.array([[1.0, 0.0, -beta], [0.0, 1.0, -gamma], [0.0, 0.0, 1.0 - alpha_m]])
    right = np.array([[1.0, 1.0, 0.5 - beta], [0.0, 1.0, 1.0 - gamma], [0.0, 0.0, -alpha_m]])
    left[2] -= (1.0 - alpha_f) * force
    right[2] += alpha_f * force
    scale = np.array([1.0, 1.0, 1.0 / max(1.0, W * W)])[:, None]  # rows of similar size at any frequency
    return np.linalg.solve(scale * left, scale * right)


def roots(coefficients: Coefficients, frequency: float, ratio: float = 0.0) -> Array:
    """Eigenvalues (3,), complex, of the amplification matrix, largest first."""
    found = np.linalg.eigvals(amplification(coefficients, frequency, ratio)).astype(complex)
    return found[np.argsort(-np.abs(found))]


def errors(coefficients: Coefficients, steps: list[int], ratio: float = 0.05, duration: float = 10.0) -> Array:
    """Error of (q, qdot/omega) after `duration` [rad] of omega t, from q = 1 at rest, for each number of `steps`.

    The start is consistent, a_0 = qddot_0. Exact: q = exp(-zeta t)(cos w t + zeta/w sin w t), w^2 = 1 - zeta^2, omega =
    1."""
    w = np.sqrt(1.0 - ratio**2)
    decay, c, s = np.exp(-ratio * duration), np.cos(w * duration), np.sin(w * duration)
    exact = decay * np.array([c + ratio / w * s, -s / w])
    found = []
    for count in steps:
        h = duration / count
        x = np.linalg.matrix_power(amplification(coefficients, h, ratio), count) @ np.array([1.0, 0.0, -(h**2)])
        found.append(np.linalg.norm(np.array([x[0], x[1] / h]) - exact))
    return np.array(found)
