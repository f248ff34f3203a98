r"""Interference fits of rings by formula: pressure, loss by speed and temperature, operating clearance.

Ring, shaft and housing are tubes in plane stress, free along the axis, the ring up to its raceway; loads of elements
are left out. A tube from a to b, k = a^2/b^2, under pressures p_a inside and p_b outside, at the speed w and warmer by
T, has at r (S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, 1970, sections 28 (Lame) and 32)

    s_t = (k p_a - p_b + (p_a - p_b) a^2/r^2)/(1 - k)
          + (3 + nu)/8 rho w^2 (a^2 + b^2 + a^2 b^2/r^2 - (1 + 3 nu)/(3 + nu) r^2),
    E u/r = ((1 - nu) (k p_a - p_b) + (1 + nu) (p_a - p_b) a^2/r^2)/(1 - k)
          + (3 + nu)/8 rho w^2 ((1 - nu) (a^2 + b^2) + (1 + nu) a^2 b^2/r^2 - (1 - nu^2)/(3 + nu) r^2) + E alpha T,

a = 0 of a solid shaft, b infinite of a massive housing. An interference I, the difference of the diameters before
assembly, leaves for the pressure

    I_e = I - 2 (u_outer - u_inner)    at the seat, without pressure,      p = I_e/(2 (u_outer - u_inner) per pressure),

u_outer of the outer of the two parts; p is zero where I_e is negative. The diametral clearance of a bearing whose
elements of diameter D are inclined by tau becomes

    s + 2 u_e - 2 u_i - 2 alpha T D/cos tau,

u_i, u_e at the raceways.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

from warpffrf.model.bearings.geometry import SIDES, BallGeometry, RollerGeometry, pair
from warpffrf.model.bearings.parts import STEEL
from warpffrf.model.bearings.rating import is_thrust
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.material import Material
from warpffrf.model.messages.named_arguments import named_arguments

EXPANSION = 12e-6  # 1/K, of steel
MPA = 1e-6  # MPa per Pa


@named_arguments
@dataclass(frozen=True)
class Fit:
    """A ring on its seat in operation: `side` "inner" or "outer"; `interference` I_e [m] that is left for the pressure,
    negative for a clearance; `pressure` p [Pa]; `raceway_change` [m] of the diameter of the raceway, positive where it
    grows; `hoop_stress` [Pa] of (ring, seat), the largest by amount, positive in tension."""

    side: str
    interference: float
    pressure: float
    raceway_change: float
    hoop_stress: tuple[float, float]


@dataclass(frozen=True)
class _Tube:
    """A tube between the radii a and b [m], whose `warming` is alpha T [-]."""

    a: float
    b: float
    material: Material
    warming: float

    def strain(self, r: float, p_a: float, p_b: float, speed: float) -> float:
        """u/r [-] of the module docstring, without the warming."""
        k, E, nu = (self.a / self.b) ** 2, self.material.youngs_modulus, self.material.poisson_ratio
        pressed = ((1.0 - nu) * (k * p_a - p_b) + (1.0 + nu) * (p_a - p_b) * (self.a / r) ** 2) / (1.0 - k)
        own = (1.0 - nu) * (self.a**2 + self.b**2) + (1.0 + nu) * (self.a * self.b / r) ** 2
        spun = self._spin(speed) * (own - (1.0 - nu**2) / (3.0 + nu) * r**2) if speed else 0.0
        return (pressed + spun) / E

    def hoop(self, p_a: float, p_b: float, speed: float) -> float:
        """The largest s_t by amount [Pa], which is at a surface or in the middle of a solid shaft."""
        k, nu, found = (self.a / self.b) ** 2, self.material.poisson_ratio, []
        for r, ratio in ((self.a, float(self.a > 0.0)), (self.b, k)):  # a^2/r^2
            stress = (k * p_a - p_b + (p_a - p_b) * ratio) / (1.0 - k)
            if speed:
                own = self.a**2 + self.b**2 + self.b**2 * ratio - (1.0 + 3.0 * nu) / (3.0 + nu) * r**2
                stress += self._spin(speed) * own
            found.append(stress)
        return float(max(found, key=abs))

    def _spin(self, speed: float) -> float:
        return (3.0 + self.material.poisson_ratio) / 8.0 * self.material.density * speed**2


@named_arguments
def fit(
    geometry: BallGeometry | RollerGeometry, side: str, *, interference: float, free_diameter: float | None = None,
    material: Material | tuple[Material, Material] = STEEL, speed: float = 0.0,
    temperature_rise: float | tuple[float, float] = 0.0, expansion: float | tuple[float, float] = EXPANSION,
    yield_strength: float | tuple[float | None, float | None] | None = None,
) -> Fit:  # fmt: skip
    """The fit of the ring of a side, "inner" on a shaft or "outer" in a housing, of a `geometry` with `bore` or
    `outside_diameter`.

    interference [m]: of the diameters at rest and reference temperature, after what smoothing of the surfaces takes;
    negative for a clearance. free_diameter [m]: of the bore of a hollow shaft, None for a solid one; of the outside of
    the housing, None for a massive one. speed [rad/s]: at which both rotate. One value for both, or (ring, seat):
    material; temperature_rise [K] above the reference; expansion [1/K]: coefficient; yield_strength [Pa] that the hoop
    stress is compared with, None for no check.

    Raises `InputError` for diameters that do not ascend, an interference that is lost, and a hoop stress beyond the
    yield strength.

    >>> bearing = wf.bearings.catalogue("6210", clearance=20e-6)
    >>> f"{wf.bearings.fit(bearing, 'inner', interference=15e-6).pressure:.3g} Pa"
    '7.92e+06 Pa'
    """
    ring_name, seat_name = f"{side} ring", "shaft" if side == "inner" else "housing"
    label = f"bearings.fit, {ring_name}"
    if side not in SIDES:
        raise InputError(f"bearings.fit: side must be 'inner' or 'outer', got {side!r}")
    _check(geometry, label)
    given = require_number(interference, f"{label}: interference [m]")
    w = abs(require_number(speed, f"{label}: speed [rad/s]"))
    seat, raceway, free = _diameters(geometry, side, free_diameter, label)
    if w and np.isinf(free):
        raise InputError(f"{label}: a massive housing does not rotate; give free_diameter [m], its outside diameter")
    both = _pair(temperature_rise, f"{label}: temperature_rise [K]")
    warming = [a * T for a, T in zip(_pair(expansion, f"{label}: expansion [1/K]"), both, strict=True)]
    of = pair(material, f"{label}: material", "(ring, seat)")
    if not all(isinstance(one, Material) for one in of):
        raise InputError(f"{label}: material must be a Material, or two, (ring, seat), got {material!r}")
    ring = _Tube(0.5 * min(seat, raceway), 0.5 * max(seat, raceway), of[0], warming[0])
    mate = _Tube(0.5 * min(seat, free), 0.5 * max(seat, free), of[1], warming[1])
    inner, outer = (mate, ring) if side == "inner" else (ring, mate)

    def opening(p: float, speed: float) -> float:
        """2 (u_outer - u_inner) [m] at the seat."""
        return seat * (outer.strain(0.5 * seat, p, 0.0, speed) - inner.strain(0.5 * seat, 0.0, p, speed))

    heat, spin = seat * (outer.warming - inner.warming), opening(0.0, w)
    left = given - heat - spin
    if given > 0.0 >= left:
        cure = f"more interference, above {heat + spin:.3g} m, or a smaller difference of the temperatures"
        if spin > 0.0 and given > heat:
            cure += f", or a speed below {w * np.sqrt((given - heat) / spin):.4g} rad/s"
        raise InputError(
            f"{label}: it comes loose from the {seat_name}: of its interference of {given:.3g} m the speed takes "
            f"{spin:.3g} m and the temperatures {heat:.3g} m; use {cure}"
        )
    softness = opening(1.0, 0.0)  # m/Pa
    p = max(left, 0.0) / softness
    inside = side == "inner"  # where the seat presses the ring

    def hoop(tube: _Tube, p: float) -> float:
        return tube.hoop(p, 0.0, w) if (tube is ring) == inside else tube.hoop(0.0, p, w)

    strength = f"{label}: yield_strength [Pa]"
    limits = pair(yield_strength, strength, "(ring, seat)")
    for tube, name, limit in zip((ring, mate), (ring_name, seat_name), limits, strict=True):
        if limit is None or abs(hoop(tube, p)) <= require_number(limit, strength, positive=True):
            continue
        cure = "a lower speed"
        if abs(hoop(tube, 0.0)) < limit:
            most: Any = brentq(lambda q, tube=tube, limit=limit: abs(hoop(tube, q)) - limit, 0.0, p)
            cure = f"at most {heat + spin + softness * most:.3g} m of interference"
        raise InputError(
            f"{label}: the hoop stress of the {name}, {hoop(tube, p) * MPA:.4g} MPa at a pressure of {p * MPA:.3g} MPa "
            f"and {w:.4g} rad/s, exceeds its yield strength of {limit * MPA:.4g} MPa; use {cure}, a thicker wall or a "
            "stronger material"
        )
    strain = ring.strain(0.5 * raceway, *((p, 0.0) if inside else (0.0, p)), w) + ring.warming
    return Fit(side, left, p, raceway * strain, (hoop(ring, p), hoop(mate, p)))


@named_arguments
def operating_clearance(
    geometry: BallGeometry | RollerGeometry, inner: Fit | None = None, outer: Fit | None = None, *,
    temperature_rise: float = 0.0, expansion: float = EXPANSION,
) -> float:  # fmt: skip
    """Diametral clearance [m] in operation, negative for a preload, of a `geometry` with the clearance before assembly;
    of one with a contact angle it is counted from elements that just touch both rings. inner, outer: the fits of the
    rings, None for one that stays as it is. temperature_rise [K] and expansion [1/K]: of the elements. Raises
    `InputError`.
    """
    label = "operating_clearance"
    _check(geometry, label)
    for given, side in zip((inner, outer), SIDES, strict=True):
        if given is not None and (not isinstance(given, Fit) or given.side != side):
            what = f"the fit of the {given.side} ring" if isinstance(given, Fit) else repr(given)
            raise InputError(f"{label}: {side} must be bearings.fit(geometry, {side!r}, ...) or None, got {what}")
    rise = require_number(temperature_rise, f"{label}: temperature_rise [K]")
    grown = require_number(expansion, f"{label}: expansion [1/K]") * rise * geometry.diameter
    changes = [0.0 if given is None else given.raceway_change for given in (inner, outer)]
    return float(geometry.clearance + changes[1] - changes[0] - 2.0 * grown / np.cos(geometry.inclination))


def _pair(value: Any, name: str) -> tuple[float, float]:
    """Numbers (ring, seat)."""
    first, second = pair(value, name, "(ring, seat)")
    return require_number(first, name), require_number(second, name)


def _check(geometry: BallGeometry | RollerGeometry, label: str) -> None:
    """Raises `InputError` for what is no geometry of a radial bearing."""
    if not isinstance(geometry, (BallGeometry, RollerGeometry)):
        raise InputError(
            f"{label}: geometry must be bearings.BallGeometry(...), RollerGeometry(...) or catalogue(...), got "
            f"{geometry!r}"
        )
    if is_thrust(geometry.inclination):
        raise InputError(f"{label}: the washers of a thrust bearing have no diametral clearance; use a radial bearing")


def _diameters(
    geometry: BallGeometry | RollerGeometry, side: str, free_diameter: float | None, label: str
) -> tuple[float, float, float]:
    """Diameters [m] of the seat, of the raceway and of the free surface of shaft or housing."""
    name = "bore" if side == "inner" else "outside_diameter"
    if (seat := getattr(geometry, name)) is None:
        raise InputError(
            f"{label}: the geometry has no {name}; give {geometry.label}({name}=...) [m], or take bearings.catalogue"
        )
    raceway, free = 2.0 * geometry.bottom(side), 0.0 if side == "inner" else np.inf
    if free_diameter is not None:
        free = require_number(free_diameter, f"{label}: free_diameter [m]", non_negative=True)
    names = (
        ("bore of the shaft", "seat", "raceway") if side == "inner" else ("raceway", "seat", "outside of the housing")
    )
    ascending = (free, seat, raceway) if side == "inner" else (raceway, seat, free)
    if not ascending[0] < ascending[1] < ascending[2]:
        said = ", ".join(f"{what} {value:.4g} m" for what, value in zip(names, ascending, strict=True))
        raise InputError(f"{label}: diameters must ascend: {said}; correct free_diameter, or {name} of the geometry")
    return float(seat), raceway, free
