r"""Basic and reference life of rolling bearings, in 10^6 revolutions at 90 % reliability.

**Basic rating life** (ISO 281): L_10 = (C/P)^p, p = 3 of balls and 10/3 of rollers, P = X F_r + Y
F_a.

**Basic reference life of radial ball bearings** (ISO/TS 16281:2008, section 4.2), from the load of every ball. With
gamma = D cos(alpha)/d_pw and i rows the loads of a raceway that give it a life of one million revolutions are

    h = 1.044 ((1 - gamma)/(1 + gamma))^1.72 ((r_i/r_e) (2 r_e - D)/(2 r_i - D))^0.41,
    Q_ci = C_r/(0.407 Z cos(alpha) i^0.7) (1 + h^(10/3))^(3/10),
    Q_ce = C_r/(0.389 Z cos(alpha) i^0.7) (1 + h^(-10/3))^(3/10),

the equivalent loads of a raceway that rotates relative to the load, and of one that is stationary,

    Q_e = (mean of Q_j^3)^(1/3),      Q_e = (mean of Q_j^(10/3))^(3/10),

and L_10r = ((Q_ci/Q_ei)^(-10/3) + (Q_ce/Q_ee)^(-10/3))^(-9/10). alpha is the nominal contact angle, 0 of a deep-groove
bearing whatever its clearance. Rows, of which each has its own equivalent loads, fail independently: their terms add.

**Basic reference life of radial roller bearings** (ISO/TS 16281:2008, section 5.3), from the load q_jk of every lamina
k, of n, on every roller j. With h = 1.038 ((1 - gamma)/(1 + gamma))^(143/108)

    Q_ci = C_r/(lambda nu 0.378 Z i^(7/9) cos(alpha)) (1 + h^(9/2))^(2/9),
    Q_ce = C_r/(lambda nu 0.364 Z i^(7/9) cos(alpha)) (1 + h^(-9/2))^(2/9),

lambda nu = 0.83 (ISO 281 has it in C_r for stresses that are not uniform, which enter individually here), laminae have
the ratings q_c = Q_c n^(-7/9), and with the factor of the stress at the edges

    f_k = 1 - 0.01/ln(1.985 |2 k - n - 1|/(2 n - 2)),      q_ek = (mean over j of (f_k q_jk)^w)^(1/w),

w = 4 for a raceway that rotates relative to the load and 9/2 for a stationary one,

    L_10r = (sum over k of (q_ci/q_eik)^(-9/2) + (q_ce/q_eek)^(-9/2))^(-8/9).

f is 1 in the middle and 2.3 at the ends: that of rollers with a usual profile. Without it, and with equally loaded
laminae, Lundberg and Palmgren's distribution under F_r = C_r/(lambda nu) has a life of one, as ISO 281's has under C_r.

**Thrust bearings** (the same sections; beyond a contact angle of 45 degrees) have the axial rating C_a of one row, each
row its own, and h without its leading number,

    Q_ci = C_a/(Z sin(alpha)) (1 + h^(10/3))^(3/10),                  Q_ce with h^(-10/3), of balls,
    Q_ci = C_a/(lambda nu Z sin(alpha)) (1 + h^(9/2))^(2/9),          Q_ce with h^(-9/2), lambda nu = 0.73, of rollers,

so that equally loaded balls have a life of one under F_a = C_a, and rollers without f under C_a/(lambda nu).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.bearings.geometry import BallGeometry, RollerGeometry
from warpffrf.model.bearings.rating import is_thrust
from warpffrf.model.errors import InputError, require_number

EXPONENTS = {"ball": 3.0, "roller": 10.0 / 3.0}
TURNS, STANDS = 3.0, 10.0 / 3.0  # exponents of equivalent loads
TURNS_LINE, STANDS_LINE = 4.0, 4.5
UNIFORM, UNIFORM_THRUST = 0.83, 0.73  # lambda nu of radial and of thrust bearings
# leading number of h, and of a load on all elements over the largest one times Z, inner and outer
BALLS, ROLLERS, THRUST = (1.044, 0.407, 0.389), (1.038, 0.378, 0.364), (1.0, 1.0, 1.0)
FEWEST = 30  # laminae of a roller


@dataclass(frozen=True)
class BasicLife:
    """L_10 in 10^6 revolutions, with the capacity C [N] and the equivalent load P [N], P = X F_r + Y F_a [-]."""

    revolutions: float
    capacity: float
    load: float
    X: float
    Y: float


@dataclass(frozen=True)
class ReferenceLife:
    """L_10r in 10^6 revolutions, with the capacity [N] and loads of the raceways: inner_rating and outer_rating [N]
    give a life of one, inner_load and outer_load [N] are the equivalent ones, for rollers those of the most critical
    lamina, times the number of laminae."""

    revolutions: float
    capacity: float
    inner_rating: float  # Q_ci
    outer_rating: float  # Q_ce
    inner_load: float  # Q_ei
    outer_load: float  # Q_ee


def basic_life(
    kind: str, capacity: float, radial: float, axial: float = 0.0, *, X: float = 1.0, Y: float = 0.0
) -> BasicLife:
    """ISO 281's L_10 of a `kind` "ball" or "roller" of dynamic capacity [N] under `radial` and `axial` forces [N]; X, Y
    [-]: factors of the catalogue. Raises `InputError` for loads without a positive equivalent."""
    C = require_number(capacity, "basic life: capacity [N]", positive=True)
    load = X * abs(radial) + Y * abs(axial)
    if load <= 0.0:
        raise InputError(
            f"basic life: the equivalent load X F_r + Y F_a is {load:g} N, and the life is unbounded; give X and Y of "
            "the catalogue where the load is axial"
        )
    return BasicLife(float((C / load) ** EXPONENTS[kind]), C, load, X, Y)


def reference_life(
    geometry: Any, capacity: float, inner: np.ndarray, outer: np.ndarray, *, turning: str = "inner"
) -> ReferenceLife:
    """ISO/TS 16281's L_10r from the loads [N] of elements on either raceway, of balls (Z,), of rollers (Z, n) of their
    laminae, row by row; capacity [N]; turning: the ring that rotates relative to the load, the other one is
    stationary. Raises `InputError`."""
    if turning not in ("inner", "outer"):
        raise InputError(f"reference life: turning must be 'inner' or 'outer', got {turning!r}")
    C = require_number(capacity, "reference life: capacity [N]", positive=True)
    if max(float(np.max(Q, initial=0.0)) for Q in (inner, outer)) <= 0.0:
        raise InputError("reference life: no element is loaded, and the life is unbounded")
    if isinstance(geometry, BallGeometry):
        return _of_balls(geometry, C, inner, outer, turning)
    if np.shape(inner)[1] < FEWEST:
        raise InputError(
            f"reference life: ISO/TS 16281 has {FEWEST} laminae at least on a roller, and there are "
            f"{np.shape(inner)[1]}; give them in the law, laws.IsoLamina(length)"
        )
    return _of_rollers(geometry, C, inner, outer, turning)


def _of_balls(geometry: BallGeometry, C: float, inner: np.ndarray, outer: np.ndarray, turning: str) -> ReferenceLife:
    D, r_i, r_e = geometry.diameter, geometry.groove("inner"), geometry.groove("outer")
    lead, *factors = THRUST if is_thrust(geometry.contact_angle) else BALLS
    gamma, share = _share(geometry, 0.7)
    h = lead * ((1.0 - gamma) / (1.0 + gamma)) ** 1.72 * (r_i / r_e * (2.0 * r_e - D) / (2.0 * r_i - D)) ** 0.41
    ratings = [
        C / (factor * share) * (1.0 + h**power) ** 0.3 for factor, power in zip(factors, (10 / 3, -10 / 3), strict=True)
    ]
    powers = (TURNS, STANDS) if turning == "inner" else (STANDS, TURNS)
    harm, worst = 0.0, []
    for Q, power, rating in zip((inner, outer), powers, ratings, strict=True):
        of_row = np.reshape(np.asarray(Q, float), (-1, geometry.elements))
        loads = np.mean(of_row**power, axis=1) ** (1.0 / power)
        harm += float(np.sum((loads / rating) ** (10.0 / 3.0)))
        worst.append(float(loads.max()))
    return ReferenceLife(harm**-0.9, C, *ratings, *worst)


def _share(geometry: BallGeometry | RollerGeometry, power: float) -> tuple[float, float]:
    """gamma, and Z times the part of an element's load along that of the bearing: Z i^power cos(alpha), or Z sin(alpha)
    of a thrust bearing."""
    alpha, Z = abs(geometry.contact_angle), geometry.elements
    along = np.sin(alpha) if is_thrust(alpha) else geometry.rows**power * np.cos(alpha)
    return float(geometry.diameter * np.cos(alpha) / geometry.pitch_diameter), float(Z * along)


def edge_factor(count: int) -> np.ndarray:
    """f (count,) of the stress of laminae from end to end, see the module; 1 of a single one."""
    if count < 2:
        return np.ones(count)
    off = np.abs(2.0 * np.arange(1, count + 1) - count - 1.0) / (2.0 * count - 2.0)
    return np.array([1.0 - 0.01 / np.log(1.985 * x) if x > 0.0 else 1.0 for x in off])


def _of_rollers(
    geometry: RollerGeometry, C: float, inner: np.ndarray, outer: np.ndarray, turning: str,
    edges: Callable[[int], np.ndarray] = edge_factor,
) -> ReferenceLife:  # fmt: skip
    thrust = is_thrust(geometry.contact_angle)
    (lead, *factors), uniform = (THRUST, UNIFORM_THRUST) if thrust else (ROLLERS, UNIFORM)
    gamma, share = _share(geometry, 7.0 / 9.0)
    h = lead * ((1.0 - gamma) / (1.0 + gamma)) ** (143.0 / 108.0)
    ratings = [
        C / (uniform * factor * share) * (1.0 + h**power) ** (2.0 / 9.0)
        for factor, power in zip(factors, (4.5, -4.5), strict=True)
    ]
    powers = (TURNS_LINE, STANDS_LINE) if turning == "inner" else (STANDS_LINE, TURNS_LINE)
    harm, worst = 0.0, []
    for q, power, rating in zip((inner, outer), powers, ratings, strict=True):
        n = np.shape(q)[1]
        of_row = np.reshape(np.asarray(q, float), (-1, geometry.elements, n))
        equivalent = np.mean((edges(n) * of_row) ** power, axis=1) ** (1.0 / power)
        harm += float(np.sum((equivalent / (rating * n ** (-7.0 / 9.0))) ** 4.5))
        worst.append(float(equivalent.max()) * n)
    return ReferenceLife(harm ** (-8.0 / 9.0), C, *ratings, *worst)
