r"""Lives of rolling bearings modified for lubrication, contamination and reliability, of duty cycles, static safety.

**Modified life** (ISO 281:2007, section 9.3): L_nm = a_1 a_ISO L_10. For n % of failures, S = 100 - n,

    a_1 = 0.95 (ln(100/S)/ln(100/90))^(2/3) + 0.05,

a Weibull distribution with a least life (ISO/TR 1281-2:2008) whose values are those of the table of ISO 281. With the
viscosity ratio kappa = nu/nu_1 of the oil at the temperature of operation, nu_1 in mm2/s, speed n in rpm, d_pw in mm,

    nu_1 = 45000 n^-0.83 d_pw^-0.5 (n < 1000),   4500 n^-0.5 d_pw^-0.5 (else),      or  kappa = Lambda^1.3,

Lambda the film thickness over the roughness, the factor e_C of contamination, the fatigue load limit C_u, and P

    a_ISO = 0.1 (1 - (x_1 - x_2/kappa^y)^z (e_C C_u/(f P))^w)^-v  <= 50,

    radial balls     x_1 = 2.5671, z = 0.83, w = 1/3, v = 9.3,    x_2 = 2.2649, 1.9987, 1.9987,   f = 1
    radial rollers   x_1 = 1.5859, z = 1,    w = 0.4, v = 9.185,  x_2 = 1.3993, 1.2348, 1.2348,   f = 1
    thrust           the same with f = 3 of balls, 2.5 of rollers

and y = 0.054381, 0.19087, 0.071739, for kappa from 0.1 to 0.4, to 1 and to 4; above it counts as 4. Of lives
from the loads of elements P is that of the life found, C L_10r^(-1/p). ISO/TS 16281 has a_ISO of each lamina of
rollers; here it is one of the whole bearing.

**Contamination** (ISO 281:2007, annex A), d_pw in mm: e_C = min(c kappa^0.68 d_pw^0.55, 1) (1 - g/d_pw^(1/3)), at
least 0, with c and g of `CLEANLINESS` for oil that circulates through a filter, for an oil bath or a filter in a
branch, and for grease.

**Fatigue load limit** (ISO 281:2007, annex B.3.3, simplified): C_0/22 of balls and C_0/8.2 of rollers; from a pitch
diameter of 100 mm on times (100 mm/d_pw)^0.5 and ^0.3.

**Duty cycles**: by the rule of Palmgren (1924) and Miner (1945) shares t_i of the time at speeds n_i with the lives
L_i, use up the fraction sum_i t_i n_i/L_i of the life per unit of time.

**Static safety** (ISO 76): s_0 = C_0/P_0, P_0 = max(F_r, X_0 F_r + Y_0 F_a).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.bearings.life import EXPONENTS, BasicLife, ReferenceLife
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.messages.named_arguments import named_arguments

# (x_1, z, w, v, x_2 by range of kappa, f of thrust bearings) of the module docstring
MODIFIED = {
    "ball": (2.5671, 0.83, 1.0 / 3.0, 9.3, (2.2649, 1.9987, 1.9987), 3.0),
    "roller": (1.5859, 1.0, 0.4, 9.185, (1.3993, 1.2348, 1.2348), 2.5),
}
RANGES, POWERS = (0.4, 1.0), (0.054381, 0.19087, 0.071739)  # of kappa, and y in them
LEAST_RATIO, MOST_RATIO, LARGEST_FACTOR = 0.1, 4.0, 50.0  # of kappa; of a_ISO
MOST_RELIABLE = 99.95  # %

# lubrication -> cleanliness, by ISO 4406 or in words -> (c, g)
CLEANLINESS = {
    "filtered": {
        "-/13/10": (0.0864, 0.5663), "-/15/12": (0.0432, 0.9987), "-/17/14": (0.0288, 1.6329),
        "-/19/16": (0.0216, 2.3362),
    },
    "bath": {
        "-/13/10": (0.0864, 0.6796), "-/15/12": (0.0288, 1.141), "-/17/14": (0.0133, 1.67),
        "-/19/16": (0.00864, 2.5164), "-/21/18": (0.00411, 3.8974),
    },
    "grease": {
        "high": (0.0864, 0.6796), "normal": (0.0432, 1.141), "slight": (0.0177, 1.887), "severe": (0.0115, 2.662),
        "very severe": (0.00617, 4.06),
    },
}  # fmt: skip
SLIGHT_AND_LARGE, LARGE = 1.677, 500.0  # g of slightly contaminated grease above this pitch diameter [mm]
LIMIT = {"ball": (22.0, 0.5), "roller": (8.2, 0.3)}  # C_0/C_u, and the exponent of large bearings
LARGE_LIMIT = 100.0  # mm
SHARES = 1e-3  # by which the sum of shares may differ from 1: numbers of three digits
MM, MM2, RPM = 1e3, 1e6, 30.0 / np.pi  # mm per m, mm2 per m2, rpm per rad/s


@dataclass(frozen=True)
class ModifiedLife:
    """L_nm in 10^6 revolutions: reliability_factor a_1 [-] times life_factor a_ISO [-] times the life `basic`.
    fatigue_limit [N]: C_u, load [N]: P, which a_ISO is of."""

    revolutions: float
    reliability_factor: float  # a_1
    life_factor: float  # a_ISO
    fatigue_limit: float
    load: float
    basic: BasicLife | ReferenceLife


@dataclass(frozen=True)
class DutyLife:
    """Life under a duty cycle: in 10^6 revolutions, its `time` [s], and the `shares` (n,) [-] of the damage that its
    points do."""

    revolutions: float
    time: float
    shares: np.ndarray


def _constants(table: dict[str, Any], kind: str) -> Any:
    if kind not in table:
        raise InputError(f"bearing life: kind must be 'ball' or 'roller', got {kind!r}")
    return table[kind]


def reliability_factor(reliability: float) -> float:
    """a_1 [-] of ISO 281 for a `reliability` from 90 to 99.95 %. Raises `InputError`."""
    S = require_number(reliability, "reliability_factor: reliability [%]")
    if not 90.0 <= S <= MOST_RELIABLE:
        raise InputError(f"reliability_factor: reliability must lie between 90 and {MOST_RELIABLE} %, got {S:g}")
    return float(0.95 * (np.log(100.0 / S) / np.log(100.0 / 90.0)) ** (2.0 / 3.0) + 0.05)


@named_arguments
def viscosity_ratio(viscosity: float, speed: float, pitch_diameter: float) -> float:
    """kappa [-] of ISO 281: kinematic `viscosity` [m2/s] at the temperature of operation over the reference viscosity
    for the `speed` [rad/s] of the rings against each other and the pitch diameter [m]. Raises `InputError`."""
    nu = MM2 * require_number(viscosity, "viscosity_ratio: viscosity [m2/s]", positive=True)
    n = RPM * abs(require_number(speed, "viscosity_ratio: speed [rad/s]"))
    d = MM * require_number(pitch_diameter, "viscosity_ratio: pitch_diameter [m]", positive=True)
    if n == 0.0:
        raise InputError("viscosity_ratio: a bearing at rest has no film; give the speed of the rings in rad/s")
    if nu > MM2:
        raise InputError(f"viscosity_ratio: {viscosity:g} m2/s is not that of an oil; 46 mm2/s are 46e-6 m2/s")
    return float(nu / (45000.0 * n**-0.83 * d**-0.5 if n < 1000.0 else 4500.0 * n**-0.5 * d**-0.5))


@named_arguments
def contamination_factor(lubrication: str, cleanliness: str, kappa: float, pitch_diameter: float) -> float:
    """e_C [-] of ISO 281:2007, annex A. lubrication: "filtered" (oil through a filter in line), "bath" or "grease";
    cleanliness: of oil the code of ISO 4406, "-/15/12", of grease "high", "normal", "slight", "severe", "very severe";
    kappa [-]: viscosity ratio; pitch_diameter [m]. Raises `InputError`."""
    label = "contamination_factor"
    if lubrication not in CLEANLINESS:
        raise InputError(
            f"{label}: lubrication must be one of {', '.join(map(repr, CLEANLINESS))}, got {lubrication!r}"
        )
    known = CLEANLINESS[lubrication]
    if cleanliness not in known:
        raise InputError(
            f"{label}: cleanliness of {lubrication!r} must be one of {', '.join(map(repr, known))}, got {cleanliness!r}"
        )
    ratio = min(require_number(kappa, f"{label}: kappa", positive=True), MOST_RATIO)
    d = MM * require_number(pitch_diameter, f"{label}: pitch_diameter [m]", positive=True)
    c, g = known[cleanliness]
    if cleanliness == "slight" and d >= LARGE:
        g = SLIGHT_AND_LARGE
    return float(min(c * ratio**0.68 * d**0.55, 1.0) * max(1.0 - g / np.cbrt(d), 0.0))


def fatigue_load_limit(kind: str, static_capacity: float, pitch_diameter: float) -> float:
    """C_u [N] of ISO 281 by the simplified method, of a `kind` "ball" or "roller" of the static capacity C_0 [N] and
    the pitch diameter [m]. Raises `InputError`."""
    over, exponent = _constants(LIMIT, kind)
    C = require_number(static_capacity, "fatigue_load_limit: static_capacity [N]", positive=True)
    d = MM * require_number(pitch_diameter, "fatigue_load_limit: pitch_diameter [m]", positive=True)
    return float(C / over * min((LARGE_LIMIT / d) ** exponent, 1.0))


def life_factor(kind: str, kappa: float, load_ratio: float, *, thrust: bool = False) -> float:
    """a_ISO [-] of ISO 281, of a `kind` "ball" or "roller": kappa [-] the viscosity ratio, load_ratio [-] e_C C_u/P,
    thrust: of a thrust bearing. kappa above 4 counts as 4; a_ISO is at most 50. Raises `InputError` for kappa below
    0.1, where ISO 281 gives no value."""
    x_1, z, w, v, x_2, f = _constants(MODIFIED, kind)
    kappa = min(require_number(kappa, "life_factor: kappa", positive=True), MOST_RATIO)
    ratio = require_number(load_ratio, "life_factor: load_ratio", non_negative=True)
    if kappa < LEAST_RATIO:
        raise InputError(
            f"life_factor: kappa must be {LEAST_RATIO} at least, got {kappa:.3g}: the film is so thin that ISO 281 "
            "gives no life; use a more viscous oil, or a higher speed"
        )
    i = int(np.searchsorted(RANGES, kappa, side="right"))
    rest = 1.0 - (x_1 - x_2[i] / kappa ** POWERS[i]) ** z * (ratio / (f if thrust else 1.0)) ** w
    return LARGEST_FACTOR if rest <= 0.0 else float(min(0.1 * rest**-v, LARGEST_FACTOR))


def modified_life(
    kind: str,
    basic: BasicLife | ReferenceLife,
    fatigue_limit: float,
    kappa: float,
    contamination: float,
    *,
    reliability: float = 90.0,
    thrust: bool = False,
) -> ModifiedLife:
    """L_nm of ISO 281 from the life `basic` of a bearing of `kind` "ball" or "roller", of its loads or of those of its
    elements. fatigue_limit [N]: C_u; kappa [-]: viscosity ratio; contamination [-]: e_C, from 0 to 1; reliability [%];
    thrust: of a thrust bearing. Raises `InputError`."""
    C_u = require_number(fatigue_limit, "modified_life: fatigue_limit [N]", positive=True)
    e_C = require_number(contamination, "modified_life: contamination", non_negative=True)
    if e_C > 1.0:
        raise InputError(f"modified_life: contamination must lie between 0 and 1, perfectly clean, got {e_C:g}")
    load = basic.capacity * basic.revolutions ** (-1.0 / _constants(EXPONENTS, kind))
    a_1, a_iso = reliability_factor(reliability), life_factor(kind, kappa, e_C * C_u / load, thrust=thrust)
    return ModifiedLife(a_1 * a_iso * basic.revolutions, a_1, a_iso, C_u, load, basic)


@named_arguments
def duty_life(points: Sequence[tuple[float, float, float]]) -> DutyLife:
    """Life under a duty cycle of `points` (share of the time [-], speed [rad/s], life [10^6 revolutions]), by
    Palmgren's and Miner's rule; the shares add up to 1, a share at rest has speed 0. Raises `InputError`."""
    rows = [tuple(point) for point in points]
    if not rows or any(len(row) != 3 for row in rows):
        raise InputError(f"duty_life: points must be (share, speed [rad/s], life [10^6 revolutions]), got {points!r}")
    label = "duty_life: points"
    share = np.array([require_number(row[0], f"{label}: share", non_negative=True) for row in rows])
    speed = np.array([require_number(row[1], f"{label}: speed [rad/s]") for row in rows])
    life = np.array([require_number(row[2], f"{label}: life [10^6 revolutions]", positive=True) for row in rows])
    return life_of_points(share, speed, life)


def life_of_points(share: np.ndarray, speed: np.ndarray, life: np.ndarray) -> DutyLife:
    """`duty_life` of arrays (n,); points without a load have the life infinity."""
    if abs(share.sum() - 1.0) > SHARES:
        raise InputError(f"duty_life: the shares of the time add up to {share.sum():g}; make their sum 1")
    turns = share * np.abs(speed) / (2.0 * np.pi * 1e6)  # 10^6 revolutions per second
    damage = turns / life
    if not damage.any():
        raise InputError("duty_life: no point has a speed and a load, and the life is unbounded")
    time = 1.0 / damage.sum()
    return DutyLife(float(turns.sum() * time), float(time), damage * time)


def static_safety(
    static_capacity: float, radial: float, axial: float = 0.0, *, X: float = 0.6, Y: float = 0.5
) -> float:
    """s_0 = C_0/P_0 [-] of ISO 76 under forces `radial` and `axial` [N], of the static capacity C_0 [N]; X, Y [-]:
    factors X_0 and Y_0, those of deep-groove ball bearings if not given. Raises `InputError` without a load."""
    C = require_number(static_capacity, "static_safety: static_capacity [N]", positive=True)
    F_r, F_a = (abs(require_number(F, f"static_safety: {n} [N]")) for F, n in ((radial, "radial"), (axial, "axial")))
    load = max(F_r, X * F_r + Y * F_a)
    if load <= 0.0:
        raise InputError("static_safety: the equivalent static load is zero, and the safety is unbounded")
    return C / load
