r"""Viscosity against temperature, in degrees Celsius T.

Vogel (H. Vogel, Phys. Z. 22, 1921, 645), of the dynamic viscosity:

    mu = a exp(b/(T + c))

Walther (C. Walther, Erdoel und Teer 7, 1931, 382; ASTM D341), of the kinematic viscosity nu in mm2/s: a straight line
through two measured points,

    ln ln(nu + 0.7) = A - B ln(T + 273.15),      mu = rho nu.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.messages.named_arguments import named_arguments

ABSOLUTE_ZERO = -273.15  # degrees Celsius
COLDEST, HOTTEST = -60.0, 300.0  # degrees Celsius, of oils that flow
SHIFT = 0.7  # mm2/s
TO_MM2_S = 1e6


def temperature_of(value: float, label: str) -> float:
    """A temperature in degrees Celsius; raises `InputError` where no oil flows, as it does for kelvins."""
    T = require_number(value, f"{label}: temperature [degrees Celsius]")
    if not COLDEST <= T <= HOTTEST:
        raise InputError(
            f"{label}: temperature must lie between {COLDEST:g} and {HOTTEST:g} degrees Celsius, got {T:g}; from "
            "kelvins take 273.15"
        )
    return T


@named_arguments
def vogel(temperature: float, *, a: float, b: float, c: float) -> float:
    """Dynamic viscosity a exp(b/(T + c)) [Pa s] at `temperature` [degrees Celsius]; a [Pa s], b and c [K]. Raises
    `InputError` where T + c is not positive."""
    label = "oils.vogel"
    T = temperature_of(temperature, label)
    a, b = (require_number(v, f"{label}: {name}", positive=True) for v, name in ((a, "a [Pa s]"), (b, "b [K]")))
    c = require_number(c, f"{label}: c [K]")
    if T + c <= 0.0:
        raise InputError(f"{label}: the temperature must be above -c, {-c:g} degrees Celsius, got {T:g}")
    return float(a * np.exp(b / (T + c)))


@named_arguments
def walther(temperature: float, *, points: Sequence[tuple[float, float]], density: float) -> float:
    """Dynamic viscosity [Pa s] at `temperature` [degrees Celsius] by two measured `points` (temperature [degrees
    Celsius], kinematic viscosity [m2/s]); density [kg/m3], which is taken as constant. Raises `InputError`."""
    label = "oils.walther"
    T = temperature_of(temperature, label)
    rho = require_number(density, f"{label}: density [kg/m3]", positive=True)
    pairs = list(points)
    if len(pairs) != 2 or any(len(pair) != 2 for pair in pairs):
        raise InputError(f"{label}: points must be two pairs (temperature, kinematic viscosity), got {points!r}")
    at = [temperature_of(pair[0], f"{label}: points") for pair in pairs]
    nu = [require_number(pair[1], f"{label}: kinematic viscosity [m2/s]", positive=True) for pair in pairs]
    if at[0] == at[1]:
        raise InputError(f"{label}: points must be at two temperatures, both are at {at[0]:g} degrees Celsius")
    if max(nu) > 1.0:
        raise InputError(f"{label}: kinematic viscosity {max(nu):g} m2/s is none of an oil; 46 mm2/s are 46e-6 m2/s")
    if (nu[1] - nu[0]) * (at[1] - at[0]) >= 0.0:
        raise InputError(f"{label}: the viscosity must fall with the temperature, got points {points!r}")
    if min(nu) * TO_MM2_S + SHIFT <= 1.0:
        raise InputError(f"{label}: below 0.3 mm2/s the equation has no logarithm, got {min(nu) * TO_MM2_S:g} mm2/s")
    x = np.log(np.array([*at, T]) - ABSOLUTE_ZERO)
    y = np.log(np.log(np.array(nu) * TO_MM2_S + SHIFT))
    line = y[0] + (y[1] - y[0]) * (x[2] - x[0]) / (x[1] - x[0])
    return float(rho * (np.exp(np.exp(line)) - SHIFT) / TO_MM2_S)
