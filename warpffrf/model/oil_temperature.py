r"""Oils over temperature: viscosity, density, heat capacity and conductivity. Temperatures T in degrees Celsius.

With the viscosity mu_0 of an oil at T_0 and without pressure, its viscosity at T is, by the law of

    Vogel           mu = mu_0 exp(b/(T + c) - b/(T_0 + c))
    Walther         mu = mu_0 nu(T)/nu(T_0) rho(T)/rho(T_0),     ln ln(nu + 0.7) = A - B ln(T + 273.15)
    Roelands        mu = mu_r (mu_0/mu_r)^x,    x = ((T_0 + 135)/(T + 135))^S,    mu_r = 6.315e-5 Pa s
    exponential     mu = mu_0 exp(-beta (T - T_0))

nu the kinematic viscosity in mm2/s, the straight line through two measured points (C. Walther, Erdoel und Teer 7, 1931,
382; ASTM D341). Vogel: H. Vogel, Phys. Z. 22 (1921) 645. Roelands: C. J. A. Roelands, Correlational Aspects of the
Viscosity-Temperature-Pressure Relationship of Lubricating Oils, Delft 1966; S between 1.0 and 1.5 of mineral oils. The
exponential law holds in a narrow range, and has closed forms (S. Nahme, Ing.-Arch. 11, 1940, 191).

Pressure at T: the coefficient of Barus stays; Roelands' exponent z stays, so that his coefficient alpha falls with
ln(mu/mu_r). The density is rho = rho_0 (1 - e (T - T_0)), heat capacity and conductivity are constant: of mineral
oils they change by 10 % and 3 % over 50 K.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.messages.named_arguments import named_arguments

Array = np.ndarray
ABSOLUTE_ZERO = -273.15  # degrees Celsius
COLDEST, HOTTEST = -60.0, 300.0  # degrees Celsius, of oils that flow
SHIFT = 0.7  # mm2/s
TO_MM2_S = 1e6
POLE_TEMPERATURE, POLE_VISCOSITY = -135.0, 6.315e-5  # degrees Celsius, Pa s: of Roelands
LEAST_CAPACITY, MOST_CAPACITY = 100.0, 1e4  # J/(kg K): water has 4186, oils 2000
LEAST_CONDUCTIVITY, MOST_CONDUCTIVITY = 1e-3, 100.0  # W/(m K): oils have 0.13, liquid metals tens
DENSITY = 880.0  # kg/m3
CONDUCTIVITY, EXPANSION = 0.13, 7e-4  # W/(m K), 1/K: of mineral oils


def temperature_of(value: Any, label: str) -> float:
    """A temperature in degrees Celsius; raises `InputError` where no oil flows, as for values in kelvin."""
    T = require_number(value, f"{label}: temperature [degrees Celsius]")
    if not COLDEST <= T <= HOTTEST:
        raise InputError(
            f"{label}: temperature must lie between {COLDEST:g} and {HOTTEST:g} degrees Celsius, got {T:g}; from "
            "kelvins subtract 273.15"
        )
    return T


class ThermalLaw(ABC):
    """Viscosity over temperature: a frozen dataclass with a `kind`."""

    kind: ClassVar[str]

    @abstractmethod
    def viscosity(self, viscosity: float, reference: float, temperature: Any) -> Array:
        """Viscosity [Pa s] without pressure at temperatures [degrees Celsius] of any shape, `viscosity` being that at
        `reference` [degrees Celsius]."""

    @property
    def with_density(self) -> bool:
        """Whether it is a law of the kinematic viscosity, to be multiplied by that of the density."""
        return False

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"kind": self.kind} | {f.name: getattr(self, f.name) for f in fields(self)}  # type: ignore[arg-type]

    def _keep(self, name: str, unit: str, *, positive: bool = True) -> None:
        value = require_number(getattr(self, name), f"oils.{type(self).__name__}: {name} {unit}", positive=positive)
        object.__setattr__(self, name, value)


@named_arguments
@dataclass(frozen=True)
class VogelLaw(ThermalLaw):
    """mu proportional to exp(b/(T + c)); b and c [K]. Raises `InputError`."""

    b: float
    c: float
    kind: ClassVar[str] = "vogel_law"

    def __post_init__(self) -> None:
        self._keep("b", "[K]")
        self._keep("c", "[K]", positive=False)
        if self.c <= -COLDEST:
            raise InputError(
                f"oils.VogelLaw: c must be above {-COLDEST:g} K, or the viscosity is infinite within the range of "
                f"temperatures, got {self.c:g}; mineral oils have about 95"
            )

    def viscosity(self, viscosity: float, reference: float, temperature: Any) -> Array:
        T = np.asarray(temperature, dtype=float)
        return viscosity * np.exp(self.b / (T + self.c) - self.b / (reference + self.c))


@named_arguments
@dataclass(frozen=True)
class WaltherLaw(ThermalLaw):
    """ASTM D341 through two measured `points` (temperature [degrees Celsius], kinematic viscosity [m2/s]). Raises
    `InputError`."""

    points: Sequence[tuple[float, float]]
    kind: ClassVar[str] = "walther_law"

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", walther_points(self.points, "oils.WaltherLaw"))

    @property
    def with_density(self) -> bool:
        return True

    def kinematic(self, temperature: Any) -> Array:
        """Kinematic viscosity [m2/s] at temperatures [degrees Celsius], any shape."""
        (T_0, nu_0), (T_1, nu_1) = self.points
        x_0, x_1, x = (np.log(np.asarray(T, dtype=float) - ABSOLUTE_ZERO) for T in (T_0, T_1, temperature))
        y_0, y_1 = (np.log(np.log(nu * TO_MM2_S + SHIFT)) for nu in (nu_0, nu_1))
        line = y_0 + (y_1 - y_0) * (x - x_0) / (x_1 - x_0)
        return (np.exp(np.exp(line)) - SHIFT) / TO_MM2_S

    def viscosity(self, viscosity: float, reference: float, temperature: Any) -> Array:
        return viscosity * self.kinematic(temperature) / self.kinematic(reference)


@named_arguments
@dataclass(frozen=True)
class RoelandsLaw(ThermalLaw):
    """ln(mu/6.315e-5 Pa s) proportional to (T + 135)^-slope; slope S [-]. Raises `InputError`."""

    slope: float
    kind: ClassVar[str] = "roelands_law"

    def __post_init__(self) -> None:
        self._keep("slope", "[-]")

    def viscosity(self, viscosity: float, reference: float, temperature: Any) -> Array:
        T = np.asarray(temperature, dtype=float)
        x = ((reference - POLE_TEMPERATURE) / (T - POLE_TEMPERATURE)) ** self.slope
        return POLE_VISCOSITY * (viscosity / POLE_VISCOSITY) ** x


@named_arguments
@dataclass(frozen=True)
class ExponentialLaw(ThermalLaw):
    """mu proportional to exp(-slope T); slope beta [1/K]. Raises `InputError`."""

    slope: float
    kind: ClassVar[str] = "exponential_law"

    def __post_init__(self) -> None:
        object.__setattr__(self, "slope", require_number(self.slope, "oils.ExponentialLaw: slope [1/K]",
                                                         non_negative=True))  # fmt: skip

    def viscosity(self, viscosity: float, reference: float, temperature: Any) -> Array:
        return viscosity * np.exp(-self.slope * (np.asarray(temperature, dtype=float) - reference))


THERMAL_LAWS: dict[str, type[Any]] = {law.kind: law for law in (VogelLaw, WaltherLaw, RoelandsLaw, ExponentialLaw)}


@named_arguments
@dataclass(frozen=True)
class Thermal:
    """An oil over temperature: `law` of its viscosity, `oils.VogelLaw(...)`, `WaltherLaw`, `RoelandsLaw` or
    `ExponentialLaw`; temperature [degrees Celsius] at which the oil has its viscosity; heat_capacity [J/(kg K)];
    conductivity [W/(m K)]; density [kg/m3] at that temperature; expansion [1/K]: relative loss of density per kelvin.
    Raises `InputError`."""

    law: ThermalLaw
    temperature: float
    heat_capacity: float
    conductivity: float = CONDUCTIVITY
    density: float = DENSITY
    expansion: float = EXPANSION

    def __post_init__(self) -> None:
        label = "oils.Thermal"
        if not isinstance(self.law, ThermalLaw):
            names = ", ".join(f"oils.{law.__name__}" for law in THERMAL_LAWS.values())
            raise InputError(f"{label}: law must be one of {names}, got {self.law!r}")
        object.__setattr__(self, "temperature", temperature_of(self.temperature, label))
        for name, unit, least, most, usual in (
            ("heat_capacity", "J/(kg K)", LEAST_CAPACITY, MOST_CAPACITY, 2000.0),
            ("conductivity", "W/(m K)", LEAST_CONDUCTIVITY, MOST_CONDUCTIVITY, CONDUCTIVITY),
            ("density", "kg/m3", 100.0, 2e4, DENSITY),
        ):
            value = require_number(getattr(self, name), f"{label}: {name} [{unit}]", positive=True)
            if not least <= value <= most:
                raise InputError(
                    f"{label}: {name} must lie between {least:g} and {most:g} {unit}, got {value:g}; mineral oils have "
                    f"about {usual:g}"
                )
            object.__setattr__(self, name, value)
        e = require_number(self.expansion, f"{label}: expansion [1/K]", non_negative=True)
        if e * (HOTTEST - COLDEST) >= 1.0:
            raise InputError(
                f"{label}: expansion {e:g} 1/K leaves no density at {HOTTEST:g} degrees Celsius; mineral oils have "
                f"about {EXPANSION:g}"
            )
        object.__setattr__(self, "expansion", e)

    def viscosity(self, viscosity: float, temperature: Any) -> Array:
        """Viscosity [Pa s] without pressure at temperatures [degrees Celsius], any shape; `viscosity`: that at
        `Thermal.temperature`."""
        found = self.law.viscosity(viscosity, self.temperature, temperature)
        return found * self.density_at(temperature) / self.density if self.law.with_density else found

    def density_at(self, temperature: Any) -> Array:
        """Density [kg/m3] without pressure at temperatures [degrees Celsius], any shape."""
        return self.density * (1.0 - self.expansion * (np.asarray(temperature, dtype=float) - self.temperature))

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {f.name: getattr(self, f.name) for f in fields(self) if f.name != "law"} | {"law": self.law.describe()}


def walther_points(points: Any, label: str) -> tuple[tuple[float, float], tuple[float, float]]:
    """The two checked points (temperature [degrees Celsius], kinematic viscosity [m2/s]) of Walther's line; raises
    `InputError` naming `label`."""
    pairs = list(points)
    if len(pairs) != 2 or any(len(pair) != 2 for pair in pairs):
        raise InputError(f"{label}: points must be two pairs (temperature, kinematic viscosity), got {points!r}")
    at = [temperature_of(pair[0], f"{label}: points") for pair in pairs]
    nu = [require_number(pair[1], f"{label}: kinematic viscosity [m2/s]", positive=True) for pair in pairs]
    if at[0] == at[1]:
        raise InputError(f"{label}: points must be at two temperatures, both are at {at[0]:g} degrees Celsius")
    if max(nu) > 1.0:
        raise InputError(
            f"{label}: kinematic viscosity {max(nu):g} m2/s is not that of an oil; 46 mm2/s are 46e-6 m2/s"
        )
    if (nu[1] - nu[0]) * (at[1] - at[0]) >= 0.0:
        raise InputError(f"{label}: the viscosity must fall with the temperature, got points {points!r}")
    if min(nu) * TO_MM2_S + SHIFT <= 1.0:
        raise InputError(f"{label}: below 0.3 mm2/s the equation has no logarithm, got {min(nu) * TO_MM2_S:g} mm2/s")
    return (at[0], nu[0]), (at[1], nu[1])
