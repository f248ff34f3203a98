r"""Heat conduction and thermal expansion in closed form.

Slab 0 < x < L, insulated sides, conductivity k, diffusivity a = k/(rho c), theta above the surroundings at x = 0, where
h theta = k dtheta/dx; a flux q enters at x = L from time zero on. With Bi = h L/k, mu_n tan mu_n = Bi, xi = 1 - x/L
(H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids, 2nd ed. 1959, section 3.11),

    theta = q/h + q x/k - sum_n c_n cos(mu_n xi) exp(-mu_n^2 a t/L^2),

where c_n follows from the condition theta = 0 at t = 0: with int_0^1 cos^2 = (mu + sin cos)/(2 mu) and
int_0^1 (1/Bi + 1 - xi) cos(mu xi) dxi = sin mu/(mu Bi) + (1 - cos mu)/mu^2 = 1/mu^2 (by mu tan mu = Bi),

    c_n = (q L/k) 2/(mu_n (mu_n + sin mu_n cos mu_n)).

Disc with a hole, a < r < b, plane stress, faces insulated: T = T_b + q a/k ln(b/r) under the flux q at a, and
(S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, 3rd ed. 1970, section 151, free edges)

    u = alpha/r [(1 + nu) int_a^r T r dr + ((1 - nu) r^2 + (1 + nu) a^2)/(b^2 - a^2) int_a^b T r dr].
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import brentq

TERMS = 400


def slab(
    x: Any, time: float, *, flux: float, length: float, conductivity: float, diffusivity: float, h: float
) -> np.ndarray:
    """theta [K] at x (...)."""
    biot = h * length / conductivity

    def root(n: int) -> float:
        low, high = n * np.pi + 1e-12, (n + 0.5) * np.pi - 1e-12
        found: Any = brentq(lambda m: m * np.sin(m) - biot * np.cos(m), low, high)
        return float(found)

    mu = np.array([root(n) for n in range(TERMS)])
    size = flux * length / conductivity
    c = 2.0 * size / (mu * (mu + np.sin(mu) * np.cos(mu)))
    xi = 1.0 - np.asarray(x, dtype=float)[..., None] / length
    decayed = c * np.cos(mu * xi) * np.exp(-(mu**2) * diffusivity * time / length**2)
    return flux / h + size * (1.0 - xi[..., 0]) - decayed.sum(axis=-1)


def disc(
    r: Any, *, inner: float, outer: float, flux: float, conductivity: float, rim: float, expansion: float,
    poisson_ratio: float,
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """Temperature [K], `rim` that at the outer radius, and radial displacement [m] at radii r (...)."""
    r = np.asarray(r, dtype=float)
    a, b, nu, size = inner, outer, poisson_ratio, flux * inner / conductivity

    def integral(s: Any) -> Any:
        """int_a^s T r dr."""
        of_log = 0.5 * (s**2 * (np.log(b / s) + 0.5) - a**2 * (np.log(b / a) + 0.5))
        return 0.5 * rim * (s**2 - a**2) + size * of_log

    across = ((1.0 - nu) * r**2 + (1.0 + nu) * a**2) / (b**2 - a**2)
    return rim + size * np.log(b / r), expansion / r * ((1.0 + nu) * integral(r) + across * integral(b))
