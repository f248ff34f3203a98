r"""Displacement of an elastic half-space under loads on its surface (Boussinesq and Cerruti; K. L. Johnson, "Contact
Mechanics", 1985, sections 3.2 and 3.6).

Coordinates (s, t) along the surface, y >= 0 the depth below it. A unit force pushed into the material at (0, 0) moves
the point (s, t, y), with r^2 = s^2 + t^2 + y^2 and the shear modulus G = E/(2 (1 + nu)), by

    u_s = s q,  u_t = t q,  q = (y/r^3 - (1 - 2 nu)/(r (r + y)))/(4 pi G),
    u_y = (y^2/r^3 + 2 (1 - nu)/r)/(4 pi G);           on the surface u_y = (1 - nu^2)/(pi E r).

A unit force along s moves it by

    u_s = (1/r + s^2/r^3 + (1 - 2 nu)(1/(r + y) - s^2/(r (r + y)^2)))/(4 pi G),
    u_t = s t (1/r^3 - (1 - 2 nu)/(r (r + y)^2))/(4 pi G),
    u_y = s (y/r^3 + (1 - 2 nu)/(r (r + y)))/(4 pi G);     on the surface u_s = ((1 - nu)/r + nu s^2/r^3)/(2 pi G),

and one along t likewise, s and t changing places.

Two loads distributed over supports that are small beside their distance d see each other, in the mean over both, as
points with second moments: with the sum Sigma of their covariances,

    <1/r> = 1/d + (3 d^T Sigma d/d^5 - tr Sigma/d^3)/2 + O((support/d)^4)/d.

Any kernel has that mean, as exact, over the four places that lie the roots of Sigma beside d (`four_places`).
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


def tangential_load(
    direction: int, s: Array, t: Array, depth: Array, poisson_ratio: float
) -> tuple[Array, Array, Array]:
    """As `normal_load`, of a unit force along s (`direction` 0) or t (1)."""
    if direction == 1:
        u_t, u_s, u_y = tangential_load(0, t, s, depth, poisson_ratio)
        return u_s, u_t, u_y
    k = 1.0 - 2.0 * poisson_ratio
    r2 = s * s + t * t + depth * depth
    r = np.sqrt(r2)
    c = (1.0 + poisson_ratio) / (2.0 * np.pi)
    below = 1.0 / (r + depth)
    q = c * (1.0 / r2 - k * below * below) / r
    return q * s * s + c * (1.0 / r + k * below), q * s * t, c * s * (depth / r2 + k * below) / r


def four_places(s: Array, t: Array, moments: tuple[Array, Array]) -> tuple[Array, Array]:
    """(s, t), each (4, ...) [m], of the places beside a distance whose mean is that between two supports; `moments` as
    in `mean_between`."""
    along, across = (np.sqrt(v) for v in moments)
    return np.stack([s - along, s + along, s - along, s + along]), np.stack(
        [t - across, t - across, t + across, t + across]
    )


def mean_between(s: Array, t: Array, moments: tuple[Array, Array], poisson_ratio: float) -> Array:
    """Mean of u_y times E [1/m] over one load's support under the other, of unit forces whose centres lie (s, t) [m]
    apart; `moments`: the sums of both loads' variances along s and t [m^2], which have no mixed part."""
    d2 = s * s + t * t
    d = np.sqrt(d2)
    along, across = moments
    second = 1.5 * (along * s * s + across * t * t) / d2 - 0.5 * (along + across)
    return (1.0 - poisson_ratio**2) / np.pi * (1.0 + second / d2) / d
