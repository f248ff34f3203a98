r"""Displacement of an elastic half-space under normal loads on its surface (Boussinesq; K. L. Johnson, "Contact
Mechanics", 1985, section 3.2).

Coordinates (s, t) along the surface, y >= 0 the depth below it. A unit force pushed into the material at (0, 0) moves
the point (s, t, y), with r^2 = s^2 + t^2 + y^2 and the shear modulus G = E/(2 (1 + nu)), by

    u_s = s q,  u_t = t q,  q = (y/r^3 - (1 - 2 nu)/(r (r + y)))/(4 pi G),
    u_y = (y^2/r^3 + 2 (1 - nu)/r)/(4 pi G);           on the surface u_y = (1 - nu^2)/(pi E r).

Two loads distributed over supports that are small beside their distance d see each other, in the mean over both, as
points with second moments: with the sum Sigma of their covariances,

    <1/r> = 1/d + (3 d^T Sigma d/d^5 - tr Sigma/d^3)/2 + O((support/d)^4)/d.
"""

from __future__ import annotations

import numpy as np

Array = np.ndarray


def normal_load(s: Array, t: Array, depth: Array, poisson_ratio: float) -> tuple[Array, Array, Array]:
    """(u_s, u_t, u_y) times E [1/m], of a unit force into the material, at distances (s, t) [m] along the surface and
    `depth` [m]; arrays that broadcast, nowhere all zero."""
    nu = poisson_ratio
    r2 = s * s + t * t + depth * depth
    r = np.sqrt(r2)
    c = (1.0 + nu) / (2.0 * np.pi)
    q = c * (depth / (r2 * r) - (1.0 - 2.0 * nu) / (r * (r + depth)))
    return q * s, q * t, c * (depth * depth / r2 + 2.0 * (1.0 - nu)) / r


def mean_between(s: Array, t: Array, moments: tuple[Array, Array], poisson_ratio: float) -> Array:
    """Mean of u_y times E [1/m] over one load's support under the other, of unit forces whose centres lie (s, t) [m]
    apart; `moments`: the sums of both loads' variances along s and t [m^2], which have no mixed part."""
    d2 = s * s + t * t
    d = np.sqrt(d2)
    along, across = moments
    second = 1.5 * (along * s * s + across * t * t) / d2 - 0.5 * (along + across)
    return (1.0 - poisson_ratio**2) / np.pi * (1.0 + second / d2) / d
