r"""Lubrication of rolling contacts by formula: film thickness, heat and starvation, drag in oil, torque of catalogues.

**Film thickness**, E' = 2 E*, oil of viscosity mu_0 and pressure-viscosity coefficient alpha at the inlet, entrainment
speed u, the mean of both surface speeds against the point of contact. With R the radius of relative curvature in the
direction of rolling, load F, or F/l of a line, and the ratio k of the half-axes across and along the rolling,

    U = mu_0 u/(E' R),      G = alpha E',      W = F/(E' R^2),      W' = F/(l E' R),

    point    h_c/R = 2.69 U^0.67 G^0.53 W^-0.067 (1 - 0.61 exp(-0.73 k)),
             h_0/R = 3.63 U^0.68 G^0.49 W^-0.073 (1 - exp(-0.68 k)),
    line     h_c/R = 3.06 U^0.69 G^0.56 W'^-0.10,      h_0/R = 2.65 U^0.70 G^0.54 W'^-0.13,

h_c at the centre and h_0 the least: B. J. Hamrock and D. Dowson, J. Lubr. Technol. 99 (1977) 264 (part III), k >= 1;
D. Dowson, Proc. IMechE 182 (1968) part 3A, 151, whose exponents replace 1.6 U^0.7 G^0.6 W'^-0.13 of Dowson and
Higginson's book of 1966, and D. Dowson and S. Toyoda, 5th Leeds-Lyon Symp. (1979) for h_c. Smooth surfaces, isothermal,
fully flooded, in the elastic and piezoviscous regime.

**Heat of the inlet** multiplies both (P. K. Gupta, H. S. Cheng, D. Zhu, N. H. Forster, J. B. Schrand, Tribol. Trans. 35
(1992) 269), with the peak pressure p_0, slip S = |u_1 - u_2|/u, thinning beta = -d ln(mu)/dT and conductivity k_f of
the oil:

    phi = (1 - 13.2 (p_0/E') L^0.42)/(1 + 0.213 (1 + 2.23 S^0.83) L^0.64),      L = beta mu_0 u^2/k_f.

**Starvation** (Hamrock and Dowson, J. Lubr. Technol. 99 (1977) 15, part IV): oil that begins m half-axes b ahead of the
centre of a point contact, with m less than m*, multiplies

    h_c by ((m - 1)/(m* - 1))^0.29,  m* = 1 + 3.06 ((R/b)^2 h_c/R)^0.58,
    h_0 by ((m - 1)/(m* - 1))^0.25,  m* = 1 + 3.34 ((R/b)^2 h_0/R)^0.56.

**Drag** of Z elements, of all rows, that orbit with w through a mixture of the density rho: Z (d_pw/2) rho c_d A
v^2/2, v = w d_pw/2, A the area across the path, with Re = rho v D/mu (F. M. White, Viscous Fluid Flow, 1991, section
3-10; Re < 2e5)

    c_d = 24/Re + 6/(1 + sqrt(Re)) + 0.4 of a sphere,      c_d = 1 + 10 Re^(-2/3) of a cylinder.

Neighbours that lie in each other's wake have less. Churning of a bearing that is partly immersed is in f_0 below.

**Friction torque** by catalogues (SKF, General Catalogue 4000, 1994, after A. Palmgren 1959), M = M_0 + M_1 in N mm,
with d_pw in mm, nu in mm2/s, n in rpm, P_1 in N:

    M_0 = 1e-7 f_0 (nu n)^(2/3) d_pw^3 (nu n >= 2000),   160e-7 f_0 d_pw^3 (else),      M_1 = f_1 P_1^a d_pw^b.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.bearings.geometry import BallGeometry, RollerGeometry
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.oils import Oil

CONDUCTIVITY = 0.14  # W/(m K), of mineral oils
MM, MM2, RPM, N_MM = 1e3, 1e6, 30.0 / np.pi, 1e-3  # mm per m, mm2 per m2, rpm per rad/s, N m per N mm
SLOWEST = 1e-9  # of Reynolds' number: at rest there is no drag
VISCOUS = 2000.0  # mm2/s rpm: nu n above which the film of a bearing grows with it


@dataclass(frozen=True)
class FilmThickness:
    """Film thickness (...) of contacts of any shape: `central` [m] in the middle, `minimum` [m] at the constriction."""

    central: np.ndarray
    minimum: np.ndarray


def pressure_coefficient(oil: Any, label: str) -> float:
    """alpha [1/Pa] of an oil; raises `InputError` naming `label` for a viscosity that does not rise with pressure."""
    alpha = oil.numbers[0] if isinstance(oil, Oil) else 0.0
    if alpha <= 0.0:
        raise InputError(
            f"{label}: an oil whose viscosity rises with pressure is needed, oils.Barus(viscosity, coefficient=2e-8) "
            f"or oils.Roelands, got {oil!r}; mineral oils have some 2e-8 1/Pa"
        )
    return alpha


def _groups(oil: Oil, label: str, speed: Any, radius: Any, modulus: float) -> tuple[np.ndarray, float, float]:
    """U, G and E' of the module docstring."""
    alpha = pressure_coefficient(oil, label)
    E = 2.0 * require_number(modulus, f"{label}: modulus [Pa]", positive=True)
    return oil.viscosity * np.abs(np.asarray(speed, float)) / (E * np.asarray(radius, float)), alpha * E, E


def film_of_points(oil: Oil, *, speed: Any, load: Any, radius: Any, ratio: Any, modulus: float) -> FilmThickness:
    """Hamrock and Dowson's film (1977) of point contacts: entrainment `speed` [m/s], `load` [N] positive, `radius` [m]
    of relative curvature in the direction of rolling and `ratio` [-] of the half-axes across and along it, numbers or
    arrays of any shape; modulus [Pa]: E*. Raises `InputError` for an oil without pressure-viscosity coefficient."""
    U, G, E = _groups(oil, "film_of_points", speed, radius, modulus)
    R, k = np.asarray(radius, float), np.asarray(ratio, float)
    W = np.asarray(load, float) / (E * R**2)
    central = 2.69 * R * U**0.67 * G**0.53 * W**-0.067 * (1.0 - 0.61 * np.exp(-0.73 * k))
    return FilmThickness(central, 3.63 * R * U**0.68 * G**0.49 * W**-0.073 * (1.0 - np.exp(-0.68 * k)))


def film_of_lines(oil: Oil, *, speed: Any, line_load: Any, radius: Any, modulus: float) -> FilmThickness:
    """Dowson and Higginson's film with the exponents of 1968, at the centre Dowson and Toyoda's (1979), of line
    contacts: entrainment `speed` [m/s], `line_load` [N/m] positive and `radius` [m] of relative curvature, numbers or
    arrays of any shape; modulus [Pa]: E*. Raises `InputError` for an oil without pressure-viscosity coefficient."""
    U, G, E = _groups(oil, "film_of_lines", speed, radius, modulus)
    R = np.asarray(radius, float)
    W = np.asarray(line_load, float) / (E * R)
    return FilmThickness(3.06 * R * U**0.69 * G**0.56 * W**-0.10, 2.65 * R * U**0.7 * G**0.54 * W**-0.13)


def thermal_factor(
    oil: Oil, *, speed: Any, slip: Any, peak_pressure: Any, modulus: float, thinning: float,
    conductivity: float = CONDUCTIVITY,
) -> np.ndarray:  # fmt: skip
    """phi (...) [-] by which the heat of the inlet multiplies a film (Gupta and others 1992): entrainment `speed`
    [m/s], `slip` speed [m/s] of the surfaces, `peak_pressure` [Pa], any shape; modulus [Pa]: E*; thinning [1/K]: -d
    ln(mu)/dT, 0.03 to 0.05 of mineral oils; conductivity [W/(m K)] of the oil. nan beyond the formula's range. Raises
    `InputError`."""
    label = "thermal_factor"
    beta = require_number(thinning, f"{label}: thinning [1/K]", non_negative=True)
    k = require_number(conductivity, f"{label}: conductivity [W/(m K)]", positive=True)
    E = 2.0 * require_number(modulus, f"{label}: modulus [Pa]", positive=True)
    u, w = np.abs(np.asarray(speed, float)), np.abs(np.asarray(slip, float))
    L, S = beta * oil.viscosity * u**2 / k, np.divide(w, u, out=np.zeros(np.broadcast(w, u).shape), where=u > 0.0)
    rest = 1.0 - 13.2 * np.asarray(peak_pressure, float) / E * L**0.42
    return np.where(rest > 0.0, rest, np.nan) / (1.0 + 0.213 * (1.0 + 2.23 * S**0.83) * L**0.64)


def starved(film: FilmThickness, *, inlet: Any, half_axis: Any, radius: Any) -> FilmThickness:
    """The `film` of point contacts whose oil begins `inlet` [m] ahead of their centre (Hamrock and Dowson 1977):
    half_axis [m] and radius [m] of relative curvature in the direction of rolling, any shape. Raises `InputError` for
    an inlet within the contact."""
    m, R = np.asarray(inlet, float) / half_axis, np.asarray(radius, float)
    if np.any(m <= 1.0):
        raise InputError(
            f"starved: inlet [m] is the distance from the centre of the contact to where the oil begins, beyond its "
            f"half-axis of {np.nanmax(half_axis):.3g} m, got {np.min(inlet):.3g}"
        )
    found = []
    for h, factor, power, exponent in ((film.central, 3.06, 0.58, 0.29), (film.minimum, 3.34, 0.56, 0.25)):
        flooded = factor * ((R / half_axis) ** 2 * h / R) ** power  # m* - 1
        found.append(h * np.minimum((m - 1.0) / flooded, 1.0) ** exponent)
    return FilmThickness(*found)


@named_arguments
def drag_torque(geometry: BallGeometry | RollerGeometry, orbit: Any, *, density: float, viscosity: float) -> np.ndarray:
    """Torque (...) [N m] about the axis that resists the `orbit` [rad/s], any shape, of all elements of a `geometry`
    through a mixture of oil and air of the density [kg/m3] and dynamic viscosity [Pa s] (White 1991), of the sign of
    the orbit. Raises `InputError`."""
    rho = require_number(density, "drag_torque: density [kg/m3]", positive=True)
    mu = require_number(viscosity, "drag_torque: viscosity [Pa s]", positive=True)
    D, arm, w = geometry.diameter, 0.5 * geometry.pitch_diameter, np.asarray(orbit, float)
    v = arm * np.abs(w)
    Re = np.maximum(rho * v * D / mu, SLOWEST)
    if isinstance(geometry, BallGeometry):
        area, drag = 0.25 * np.pi * D**2, 24.0 / Re + 6.0 / (1.0 + np.sqrt(Re)) + 0.4
    else:
        area, drag = D * geometry.roller_length, 1.0 + 10.0 * Re ** (-2.0 / 3.0)
    return np.sign(w) * len(geometry.places) * arm * 0.5 * rho * drag * area * v**2


@named_arguments
def catalogue_torque(
    pitch_diameter: float, speed: float, *, viscosity: float, load: float, f0: float, f1: float, a: float = 1.0,
    b: float = 1.0,
) -> tuple[float, float]:  # fmt: skip
    """(M_0, M_1) [N m] of the catalogue (SKF 1994): pitch_diameter [m], speed [rad/s] of the rings against each other,
    kinematic viscosity [m2/s] at the temperature of operation, load P_1 [N]; f0, f1, a, b [-]: factors and exponents of
    the kind of bearing and lubrication. In an oil bath f0 is some 2 of deep-groove, 3.3 of angular contact ball
    bearings, 3 of cylindrical, 6 of tapered and spherical, 12 of needle roller bearings, twice as much with oil
    injection; f1 0.0002, 0.0005, 0.0003, 0.0004, 0.0006 and 0.002. Raises `InputError`."""
    label = "catalogue_torque"
    d = MM * require_number(pitch_diameter, f"{label}: pitch_diameter [m]", positive=True)
    n = RPM * abs(require_number(speed, f"{label}: speed [rad/s]"))
    nu = MM2 * require_number(viscosity, f"{label}: viscosity [m2/s]", positive=True)
    P = abs(require_number(load, f"{label}: load [N]"))
    grows = (nu * n) ** (2.0 / 3.0) if nu * n >= VISCOUS else 160.0
    return N_MM * 1e-7 * f0 * grows * d**3, N_MM * f1 * P**a * d**b
