r"""Load ratings of rolling bearings from their inside, by ISO 281:2007 and ISO 76:2006, and equivalent loads.

With the elements' diameter D, number Z in each of i rows, pitch diameter d_pw and contact angle alpha; N and mm. A
bearing is radial up to alpha = 45 degrees, and its ratings are radial loads; beyond, a thrust bearing, they are axial.

**Dynamic ratings** are the loads of a life of 10^6 revolutions, of Lundberg and Palmgren. The factor f_c of ISO 281
contains powers of gamma = D cos(alpha)/d_pw, which are combined with those of cos(alpha) here. Balls, with the groove
radii r_i = f_i D and r_e = f_e D, have

    radial:   C_r = b_m 0.41 lambda F(1.04) cos(alpha) i^0.7 Z^(2/3) D^1.8,
    thrust:   C_a = b_m lambda (1 - sin(alpha)/3) F(1) sin(alpha) Z^(2/3) D^1.8,
    F(c) = 98.0665 (2 f_i/(2 f_i - 1))^0.41 (D/d_pw)^0.3 (1 - gamma)^1.39/(1 + gamma)^(1/3)/(1 + h^(10/3))^(3/10),
    h = c ((1 - gamma)/(1 + gamma))^1.72 (f_i (2 f_e - 1)/(f_e (2 f_i - 1)))^0.41,

with 3.647 D^1.4 in place of D^1.8 for D > 25.4 mm. b_m = 1.3; lambda = 0.95, of thrust bearings and of two rows of
deep-groove balls 0.9. The standard's tables have f_i = f_e = 0.52 (thrust: 0.535) and are valid up to f_i = 0.52 and
f_e = 0.53 (0.54): wider grooves reduce the rating in the ratio of F to that at this limit, narrower ones do not raise
it. Rollers of the effective length l:

    radial:   C_r = b_m 0.377 0.83 F(1.04) cos(alpha) (i l)^(7/9) Z^(3/4) D^(29/27),
    thrust:   C_a = b_m 0.73 (1 - 0.15 sin(alpha)) F(1) sin(alpha) l^(7/9) Z^(3/4) D^(29/27),
    F(c) = 551.13373 (D/d_pw)^(2/9) (1 - gamma)^(29/27)/(1 + gamma)^(1/4)/(1 + h^(9/2))^(2/9),
    h = c ((1 - gamma)/(1 + gamma))^(143/108).

**Static ratings** are the loads at which the element under the largest load, 5 C_0r/(i Z cos(alpha)) of a radial
bearing and C_0a/(Z sin(alpha)) of a thrust bearing, has a Hertz pressure of 4,200 MPa (balls) or 4,000 MPa (rollers) on
the raceway where the pressure is larger, with E = 207 GPa and nu = 0.3. Balls have groove radii of 0.52 D and 0.53 D
(thrust: 0.54 D), or those of the bearing where these are wider; rollers have

    C_0r = 44 (1 - gamma) i Z l D cos(alpha),      C_0a = 220 (1 - gamma) Z l D sin(alpha).

**Equivalent load** P = X F_r + Y F_a. Single-row ball bearings have the tabulated limit e of F_a/F_r, up to which X = 1
and Y = 0, and X and Y beyond; rollers e = 1.5 tan(alpha), X = 0.4, Y = 0.4 cot(alpha). Two rows have X = 1 and a
smaller Y up to the limit, too: balls by the table, of self-aligning ones 0.42 cot(alpha), and 0.65 and 0.65 cot(alpha)
beyond e = 1.5 tan(alpha); rollers 0.45 cot(alpha), and 0.67 and 0.67 cot(alpha) beyond. Thrust ball bearings have X =
1.25 tan(alpha) (1 - (2/3) sin(alpha)), thrust roller bearings X = tan(alpha), both Y = 1; at 90 degrees they carry no
radial load, X = 0.

**Equivalent static load** P_0 = max(F_r, X_0 F_r + Y_0 F_a) of ISO 76. Deep-groove ball bearings have X_0 = 0.6 and Y_0
= 0.5, straight rollers 1 and 0. Otherwise one row has X_0 = 0.5 and two have 1; Y_0 of angular contact ball bearings is
tabulated, of rollers and self-aligning balls 0.22 cot(alpha), of two rows twice that. Thrust bearings have X_0 = 2.3
tan(alpha) and Y_0 = 1.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.laws.lumped.hertz_point import MODULUS, load_at_pressure

BALL_B_M, ROLLER_B_M = 1.3, 1.1  # of balls; of cylindrical and tapered rollers, and needles in machined rings
NO_RADIAL = 1e-3  # of the axial force: what friction transmits
UPRIGHT = np.radians(89.9)  # bearings of a larger contact angle carry no radial load
STEEPEST_RADIAL = np.radians(45.001)
PEAK = 4200e6  # Pa, of balls
INCH = 25.4  # mm: larger balls have a smaller exponent
MM = 1e3  # in a metre

# ISO 281, table 3, single-row: e and Y at values of F_a/(Z D^2) [MPa] and contact angles; constant from 20 degrees on.
RELATIVE = (0.172, 0.345, 0.689, 1.03, 1.38, 2.07, 3.45, 5.17, 6.89)
ANGLES = np.radians([0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0])
TABLE_X = (0.56, 0.56, 0.46, 0.44, 0.43, 0.41, 0.39, 0.37, 0.35, 0.33)
SHALLOW_E = (
    *2 * ((0.19, 0.22, 0.26, 0.28, 0.30, 0.34, 0.38, 0.42, 0.44),),
    (0.29, 0.32, 0.36, 0.38, 0.40, 0.44, 0.49, 0.54, 0.54), (0.38, 0.40, 0.43, 0.46, 0.47, 0.50, 0.55, 0.56, 0.56),
)  # fmt: skip
SHALLOW_Y = (
    *2 * ((2.30, 1.99, 1.71, 1.55, 1.45, 1.31, 1.15, 1.04, 1.00),),
    (1.88, 1.71, 1.52, 1.41, 1.34, 1.23, 1.10, 1.01, 1.00), (1.47, 1.40, 1.30, 1.23, 1.19, 1.12, 1.02, 1.00, 1.00),
)  # fmt: skip
STATIC_Y = (0.5, 0.52, 0.5, 0.46, 0.42, 0.38, 0.33, 0.29, 0.26, 0.22)  # ISO 76, at `ANGLES`
# two rows, from 20 degrees on: Y up to e; X and Y beyond
DOUBLE_BELOW, DOUBLE_X = (1.09, 0.92, 0.78, 0.66, 0.55, 0.47), (0.70, 0.67, 0.63, 0.60, 0.57, 0.54)
DOUBLE_Y = (1.63, 1.41, 1.24, 1.07, 0.93, 0.81)
STEEP_E, STEEP_Y = (0.57, 0.68, 0.80, 0.95, 1.14, 1.34), (1.00, 0.87, 0.76, 0.66, 0.57, 0.50)


def is_thrust(angle: float) -> bool:
    """Whether a bearing of that contact angle [rad] has axial ratings."""
    return abs(angle) > STEEPEST_RADIAL


def ball_dynamic(
    count: int, diameter: float, pitch: float, angle: float, osculation: tuple[float, float], rows: int = 1
) -> float:
    """C_r, or C_a of a thrust bearing [N]: `count` balls in each of `rows`, diameter and pitch diameter [m], contact
    angle [rad], groove radii (inner, outer) over the diameter."""
    thrust, D, sine, cosine = is_thrust(angle), diameter * MM, abs(np.sin(angle)), abs(np.cos(angle))
    gamma = diameter * cosine / pitch

    def factor(inner: float, outer: float) -> float:
        h = (1.0 if thrust else 1.04) * ((1.0 - gamma) / (1.0 + gamma)) ** 1.72
        h *= (inner * (2.0 * outer - 1.0) / (outer * (2.0 * inner - 1.0))) ** 0.41
        return (2.0 * inner / (2.0 * inner - 1.0)) ** 0.41 / (1.0 + h ** (10.0 / 3.0)) ** 0.3

    table, limit = ((0.535, 0.535), (0.54, 0.54)) if thrust else ((0.52, 0.52), (0.52, 0.53))
    grooves = factor(*table) * min(1.0, factor(*osculation) / factor(*limit))
    common = 98.0665 * (diameter / pitch) ** 0.3 * (1.0 - gamma) ** 1.39 / (1.0 + gamma) ** (1.0 / 3.0)
    common *= count ** (2.0 / 3.0) * (D**1.8 if D <= INCH else INCH**0.4 * D**1.4)
    if thrust:
        return float(BALL_B_M * 0.9 * (1.0 - sine / 3.0) * grooves * common * sine)
    lam = 0.9 if rows > 1 and not angle else 0.95
    return float(BALL_B_M * 0.41 * lam * grooves * common * cosine * rows**0.7)


def roller_dynamic(
    count: int, diameter: float, length: float, pitch: float, angle: float = 0.0, rows: int = 1, b_m: float = ROLLER_B_M
) -> float:
    """C_r, or C_a of a thrust bearing [N]: `count` rollers in each of `rows`, diameter, effective length and pitch
    diameter [m], contact angle [rad]; b_m: factor of the kind."""
    thrust, sine, cosine = is_thrust(angle), abs(np.sin(angle)), abs(np.cos(angle))
    gamma = diameter * cosine / pitch
    h = (1.0 if thrust else 1.04) * ((1.0 - gamma) / (1.0 + gamma)) ** (143.0 / 108.0)
    common = 551.13373 * (diameter / pitch) ** (2.0 / 9.0) * (1.0 - gamma) ** (29.0 / 27.0) / (1.0 + gamma) ** 0.25
    common *= count**0.75 * (diameter * MM) ** (29.0 / 27.0) / (1.0 + h**4.5) ** (2.0 / 9.0)
    if thrust:
        return float(b_m * 0.73 * (1.0 - 0.15 * sine) * common * sine * (length * MM) ** (7.0 / 9.0))
    return float(b_m * 0.377 * 0.83 * common * cosine * (rows * length * MM) ** (7.0 / 9.0))


def ball_static(
    count: int, diameter: float, pitch: float, angle: float, osculation: tuple[float, float], rows: int = 1
) -> float:
    """C_0r, or C_0a of a thrust bearing [N]; arguments as of `ball_dynamic`."""
    gamma, least = diameter * np.cos(angle) / pitch, (0.54, 0.54) if is_thrust(angle) else (0.52, 0.53)
    loads = []
    for sign, given, limit in zip((1.0, -1.0), osculation, least, strict=True):
        across, around = (2.0 - 1.0 / max(given, limit)) / diameter, 2.0 / diameter / (1.0 - sign * gamma)
        loads.append(load_at_pressure(PEAK, across, around, MODULUS))
    share = abs(np.sin(angle)) if is_thrust(angle) else 0.2 * rows * np.cos(angle)
    return float(min(loads) * count * share)


def roller_static(count: int, diameter: float, length: float, pitch: float, angle: float = 0.0, rows: int = 1) -> float:
    """C_0r, or C_0a of a thrust bearing [N]; arguments as of `roller_dynamic`."""
    share = 220.0 * abs(np.sin(angle)) if is_thrust(angle) else 44.0 * rows * np.cos(angle)
    return float(share * (1.0 - diameter * np.cos(angle) / pitch) * count * length * diameter * MM**2)


def ball_load_factors(count: int, diameter: float, angle: float, radial: float, axial: float) -> tuple[float, float]:
    """(X, Y) of a single row of `count` balls, diameter [m], contact angle [rad], forces `radial`, `axial` [N]."""
    radial, axial, angle = abs(radial), abs(axial), abs(angle)
    if is_thrust(angle):
        _refuse_radial(angle, radial, axial)
        X = 0.0 if angle >= UPRIGHT else 1.25 * np.tan(angle) * (1.0 - 2.0 / 3.0 * np.sin(angle))
        return float(X), 1.0
    relative = axial / (count * (diameter * MM) ** 2)

    def at(shallow: Any, steep: tuple[float, ...]) -> float:
        return float(np.interp(angle, ANGLES, [*(np.interp(relative, RELATIVE, row) for row in shallow), *steep]))

    if axial <= at(SHALLOW_E, STEEP_E) * radial:
        return 1.0, 0.0
    return float(np.interp(angle, ANGLES, TABLE_X)), at(SHALLOW_Y, STEEP_Y)


def double_row_load_factors(angle: float, radial: float, axial: float, self_aligning: bool) -> tuple[float, float]:
    """(X, Y) of two rows of angular contact balls, contact angle [rad], or of self-aligning ones."""
    angle, ratio = abs(angle), abs(axial)
    if self_aligning:
        tangent = float(np.tan(angle))
        return (1.0, 0.42 / tangent) if ratio <= 1.5 * tangent * abs(radial) else (0.65, 0.65 / tangent)
    if angle < ANGLES[4]:
        raise InputError(
            f"load factors: two rows of balls at {np.degrees(angle):.3g} degrees are not built, 20 is the least; "
            "give X and Y of a catalogue"
        )
    e, below, X, Y = (float(np.interp(angle, ANGLES[4:], row)) for row in (STEEP_E, DOUBLE_BELOW, DOUBLE_X, DOUBLE_Y))
    return (1.0, below) if ratio <= e * abs(radial) else (X, Y)


def _refuse_radial(angle: float, radial: float, axial: float) -> None:
    """Raises `InputError` for a radial force on a bearing that carries none."""
    if abs(angle) >= UPRIGHT and abs(radial) > NO_RADIAL * abs(axial):
        raise InputError(
            f"load factors: a bearing with a contact angle of 90 degrees carries no radial load, and it has "
            f"{radial:.4g} N; support the shaft radially by another bearing, or give X and Y"
        )


def roller_load_factors(angle: float, radial: float, axial: float, rows: int = 1) -> tuple[float, float]:
    """(X, Y) of rollers, contact angle [rad], under `radial` and `axial` forces [N]."""
    tangent = float(np.tan(abs(angle)))
    if is_thrust(angle):
        _refuse_radial(angle, radial, axial)
        return (tangent if abs(angle) < UPRIGHT else 0.0), 1.0
    if not angle:
        return 1.0, 0.0
    below = abs(axial) <= 1.5 * tangent * abs(radial)
    if rows > 1:
        return (1.0, 0.45 / tangent) if below else (0.67, 0.67 / tangent)
    return (1.0, 0.0) if below else (0.4, 0.4 / tangent)


def static_load_factors(angle: float, rows: int, *, tabulated: bool) -> tuple[float, float]:
    """(X_0, Y_0) of a contact angle [rad]; tabulated: of ball bearings that are not self-aligning."""
    angle = abs(angle)
    if is_thrust(angle):
        return (2.3 * float(np.tan(angle)) if angle < UPRIGHT else 0.0), 1.0
    if not angle:
        return (0.6, 0.5) if tabulated else (1.0, 0.0)
    Y = float(np.interp(angle, ANGLES, STATIC_Y)) if tabulated else 0.22 / float(np.tan(angle))
    return 0.5 * rows, Y * rows
