r"""Load distributions of rolling bearings with rigid rings that are displaced in parallel (Sjoevall).

An element at the angle phi of a row with the contact angle alpha, signed, is approached by

    delta = delta_r cos(phi) cos(alpha) + delta_a sin(alpha) - c,

c the play along the line of contact, and takes Q(delta); the sums of Q cos(phi) cos(alpha) and Q sin(alpha) over all
rows are the radial and the axial force. With Q = K delta^t and many elements the sums become Sjoevall's integrals

    J_r = 1/(2 pi) int (1 - (1 - cos psi)/(2 eps))^t cos psi dpsi,        F_r = Z Q_max J_r cos(alpha),
    J_a = 1/(2 pi) int (1 - (1 - cos psi)/(2 eps))^t dpsi,                F_a = Z Q_max J_a sin(alpha),

eps the loaded share of the diameter.

**Laminae** of ISO/TS 16281: Q = (c_L/n) sum max(delta - P_i(x_k) - P_e(x_k), 0)^(10/9) of a roller between two
raceways, c_L = 35948 l^(8/9) in N and mm, with the profiles P of roller and raceway together at each contact.

**A tapered roller** between raceways with the contact angles alpha_i, alpha_e and a rib with the normal at the angle
beta from the radial direction (forces on the roller, radially and axially):

    Q_i cos(alpha_i) + F cos(beta) = Q_e cos(alpha_e),        Q_i sin(alpha_i) + F sin(beta) = Q_e sin(alpha_e).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import quad
from scipy.optimize import root

Array = np.ndarray


@dataclass(frozen=True)
class Rows:
    """Rows of `count` elements each, contact angles `alphas` [rad], signed, the play along lines of contact [m], and
    `force`, Q [N] of the approach delta [m], any shape."""

    count: int
    alphas: tuple[float, ...]
    play: float
    force: Callable[[Array], Array]

    def loads(self, radial: float, axial: float) -> Array:
        """Q (rows, count) [N] at displacements [m]."""
        phi, alpha = 2.0 * np.pi * np.arange(self.count) / self.count, np.array(self.alphas)[:, None]
        return self.force(radial * np.cos(phi) * np.cos(alpha) + axial * np.sin(alpha) - self.play)

    def solve(self, F_r: float, F_a: float, guess: tuple[float, float]) -> tuple[Array, Array]:
        """Displacements (radial, axial) [m] and loads (rows, count) [N] under forces [N]."""
        phi, alpha = 2.0 * np.pi * np.arange(self.count) / self.count, np.array(self.alphas)[:, None]

        def lacking(x: Array) -> list[float]:
            Q = self.loads(*(1e-6 * x))
            return [float(np.sum(Q * np.cos(phi) * np.cos(alpha)) - F_r), float(np.sum(Q * np.sin(alpha)) - F_a)]

        found = root(lacking, 1e6 * np.array(guess), tol=1e-12)
        return 1e-6 * found.x, self.loads(*(1e-6 * found.x))


def lamina_force(length: float, profiles: Array) -> Callable[[Array], Array]:
    """Q [N] of a roller of the length [m] between two raceways; profiles (n,) [m]: of both contacts together."""
    c_L = 35948.0 * (1e3 * length) ** (8.0 / 9.0)

    def force(delta: Array) -> Array:
        depth = 1e3 * np.maximum(np.asarray(delta)[..., None] - profiles, 0.0)
        return c_L / len(profiles) * np.sum(depth ** (10.0 / 9.0), axis=-1)

    return force


def iso_profiles(length: float, diameter: float, count: int = 30) -> Array:
    """2 P (count,) [m] of a short roller of ISO/TS 16281."""
    x = length * ((np.arange(count) + 0.5) / count - 0.5)
    return -2.0 * 0.00035 * diameter * np.log(1.0 - (2.0 * x / length) ** 2)


def sjoevall(eps: float, exponent: float) -> tuple[float, float]:
    """J_r and J_a."""
    edge = np.arccos(max(1.0 - 2.0 * eps, -1.0))

    def share(psi: float) -> float:
        return max(1.0 - (1.0 - np.cos(psi)) / (2.0 * eps), 0.0) ** exponent

    J_r = quad(lambda psi: share(psi) * np.cos(psi), 0.0, edge)[0] / np.pi
    return float(J_r), float(quad(share, 0.0, edge)[0] / np.pi)


def tapered(Q_e: float, alpha_i: float, alpha_e: float, beta: float) -> tuple[float, float]:
    """Q_i and the force F of the rib [N]."""
    rows = np.array([[np.cos(alpha_i), np.cos(beta)], [np.sin(alpha_i), np.sin(beta)]])
    Q_i, F = np.linalg.solve(rows, Q_e * np.array([np.cos(alpha_e), np.sin(alpha_e)]))
    return float(Q_i), float(F)
