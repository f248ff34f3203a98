r"""Lives of rolling bearings, in 10^6 revolutions at 90 % reliability.

**Basic rating life** (ISO 281): L_10 = (C/P)^p, p = 3 of balls and 10/3 of rollers, P = X F_r + Y F_a.

**Basic reference life of radial ball bearings** (ISO/TS 16281:2008, section 4.2), which takes the load of every ball.
With gamma = D cos(alpha)/d_pw and i rows the loads of a raceway that give it a life of one million revolutions are

    h = 1.044 ((1 - gamma)/(1 + gamma))^1.72 ((r_i/r_e) (2 r_e - D)/(2 r_i - D))^0.41,
    Q_ci = C_r/(0.407 Z cos(alpha)^0.7 i^0.7) (1 + h^(10/3))^(3/10),
    Q_ce = C_r/(0.389 Z cos(alpha)^0.7 i^0.7) (1 + h^(-10/3))^(3/10),

the equivalent loads of a raceway that turns against the load, and of one that stands still under it,

    Q_e = (mean of Q_j^3)^(1/3),      Q_e = (mean of Q_j^(10/3))^(3/10),

and L_10r = ((Q_ci/Q_ei)^(-10/3) + (Q_ce/Q_ee)^(-10/3))^(-9/10). alpha is the nominal contact angle, 0 of a deep-groove
bearing whatever its clearance. Roller bearings have a life of each lamina there, with factors for edge stress, which is
not offered.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.bearings.geometry import BallRaceways
from warpffrf.model.errors import InputError, require_number

EXPONENTS = {"ball": 3.0, "roller": 10.0 / 3.0}
TURNS, STANDS = 3.0, 10.0 / 3.0  # exponents of equivalent loads


@dataclass(frozen=True)
class BasicLife:
    """L_10 in 10^6 revolutions, with the capacity C and equivalent load P [N] that it comes from, P = X F_r + Y F_a."""

    revolutions: float
    capacity: float
    load: float
    X: float
    Y: float


@dataclass(frozen=True)
class ReferenceLife:
    """L_10r in 10^6 revolutions, with loads of the raceways [N]: those for a life of one, and the equivalent ones."""

    revolutions: float
    capacity: float
    inner_rating: float  # Q_ci
    outer_rating: float  # Q_ce
    inner_load: float  # Q_ei
    outer_load: float  # Q_ee


def basic_life(
    kind: str, capacity: float, radial: float, axial: float = 0.0, *, X: float = 1.0, Y: float = 0.0
) -> BasicLife:
    """ISO 281's L_10 of a "ball" or "roller" bearing of dynamic capacity [N] under forces [N]; X, Y: factors of the
    catalogue. Raises `InputError` for loads that make none."""
    C = require_number(capacity, "basic life: capacity [N]", positive=True)
    load = X * abs(radial) + Y * abs(axial)
    if load <= 0.0:
        raise InputError(
            f"basic life: the equivalent load X F_r + Y F_a is {load:g} N, and the life without bounds; give X and "
            "Y of the catalogue where the load is axial"
        )
    return BasicLife(float((C / load) ** EXPONENTS[kind]), C, load, X, Y)


def reference_life(
    raceways: Any, capacity: float, inner: np.ndarray, outer: np.ndarray, *, turning: str = "inner"
) -> ReferenceLife:
    """ISO/TS 16281's L_10r of a ball bearing from the loads (Z,) [N] of its balls on either raceway; turning: the ring
    that turns against the load, the other one stands still. Raises `InputError`."""
    if not isinstance(raceways, BallRaceways):
        raise InputError("reference life: only that of ball bearings is offered; take basic_life for rollers")
    if turning not in ("inner", "outer"):
        raise InputError(f"reference life: turning must be 'inner' or 'outer', got {turning!r}")
    C = require_number(capacity, "reference life: capacity [N]", positive=True)
    D, Z, c = raceways.diameter, raceways.count, float(np.cos(raceways.contact_angle))
    gamma, r_i, r_e = D * c / raceways.pitch_diameter, raceways.inner_groove, raceways.outer_groove
    h = 1.044 * ((1.0 - gamma) / (1.0 + gamma)) ** 1.72 * (r_i / r_e * (2.0 * r_e - D) / (2.0 * r_i - D)) ** 0.41
    ratings = [
        C / (factor * Z * c**0.7) * (1.0 + h ** (sign * 10.0 / 3.0)) ** 0.3
        for factor, sign in ((0.407, 1.0), (0.389, -1.0))
    ]
    powers = (TURNS, STANDS) if turning == "inner" else (STANDS, TURNS)
    both = zip((inner, outer), powers, strict=True)
    loads = [float(np.mean(np.asarray(Q, float) ** power) ** (1.0 / power)) for Q, power in both]
    if max(loads) <= 0.0:
        raise InputError("reference life: no ball is loaded, and the life without bounds")
    harm = sum((load / rating) ** (10.0 / 3.0) for load, rating in zip(loads, ratings, strict=True))
    return ReferenceLife(float(harm**-0.9), C, *ratings, *loads)
