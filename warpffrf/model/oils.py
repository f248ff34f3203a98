r"""Oils of a film.

With the pressure p >= 0 [Pa] above that of the cavity

    Newtonian            mu = mu_0
    Barus                mu = mu_0 exp(alpha p)
    Roelands             mu = mu_0 exp((ln mu_0 + 9.67)((1 + p/196.2 MPa)^z - 1))
    DowsonHigginson      rho/rho_0 = 1 + a p/(1 + b p), combined with any of them

Without `thermal` an oil is isothermal; `vogel`, `walther` and `iso_vg` give the viscosity at one temperature. With
`thermal=Thermal(...)` (`warpffrf.model.oil_temperature`) its viscosity and density depend on the temperature, too:
`oil.at(T)` is the oil at T. A user-defined oil is a subclass of one of them: the kernels evaluate mu(p) in these forms.

Barus. Viscosity that grows exponentially with pressure (C. Barus, Am. J. Sci. 45, 1893, 87).

    mu = mu_0 exp(alpha p),      mu' = alpha mu

Mineral oils have alpha between 1e-8 and 3e-8 per Pa. The law holds up to some 0.1 to 0.2 GPa, and rises too steeply
above: use `Roelands` there.

Dowson-Higginson. Density against pressure (D. Dowson and G. R. Higginson, Elasto-hydrodynamic Lubrication, 1966).

    rho/rho_0 = 1 + a p/(1 + b p),      a = 0.6 1/GPa,   b = 1.7 1/GPa of mineral oils,

which rises from 1 with the compliance a and stays below 1 + a/b = 1.35.

ISO VG. Mineral oils by their ISO viscosity grade (ISO 3448: the grade is the kinematic viscosity at 40 degrees in
mm2/s).

With mu_40 = rho nu_40, Vogel's equation with c = 95 K and all oils meeting in one viscosity,

    mu = mu_40 exp(b (1/(T + 95) - 1/135)),      b = 159.56 K ln(mu_40/1.8e-4 Pa s),

is how standards for plain bearings describe mineral oils of viscosity index 95 to 100. With a measured viscosity at 100
degrees, `at_100`, Walther's line through the two points is used instead.

Newtonian. An oil whose viscosity does not depend on pressure: valid below about 20 MPa, as in most bearings with a soft
lining.

Oil. Common to all oils: viscosity and density over pressure, at one temperature.

A film is solved for pressures by Newton's method, which requires both and their derivatives,

    mu(p) [Pa s],    mu'(p) [s],    r(p) = rho(p)/rho_0 [-],    r'(p) [1/Pa],

of the pressure above that of the cavity. Both rise with p. The cavity has pressure zero and an oil of mu(0), r(0) = 1.

The kernels evaluate mu(p) by the `form` of an oil, one of FORMS, and its `numbers`; another form needs a kernel.

Roelands. Viscosity against pressure to a GPa (C. J. A. Roelands, Correlational Aspects of the Viscosity-Temperature-
Pressure Relationship of Lubricating Oils, Delft 1966).

    mu = mu_0 exp(b ((1 + p/p_r)^z - 1)),      b = ln(mu_0/mu_r),      p_r = 196.2 MPa,   mu_r = 6.315e-5 Pa s

All oils have mu_r at the pressure -p_r. Oils are usually characterised by the coefficient of Barus' law, the slope at
zero pressure: alpha = b z/p_r, z = alpha p_r/b. Mineral oils have z between 0.5 and 0.7.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, fields, replace
from typing import Any, ClassVar, Self

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.oil_temperature import (
    CONDUCTIVITY,
    DENSITY,
    EXPANSION,
    POLE_VISCOSITY,
    THERMAL_LAWS,
    ExponentialLaw,
    RoelandsLaw,
    Thermal,
    ThermalLaw,
    VogelLaw,
    WaltherLaw,
    temperature_of,
    walther_points,
)

Array = np.ndarray


@named_arguments
@dataclass(frozen=True)
class DowsonHigginson:
    """rho/rho_0 = 1 + a p/(1 + b p); a, b [1/Pa] positive, by default those of mineral oils. Raises `InputError`."""

    a: float = 0.6e-9
    b: float = 1.7e-9

    def __post_init__(self) -> None:
        for name in ("a", "b"):
            number = require_number(getattr(self, name), f"oils.DowsonHigginson: {name} [1/Pa]", positive=True)
            object.__setattr__(self, name, number)

    def ratio(self, pressure: Any) -> Array:
        """rho/rho_0 [-] at pressures [Pa], any shape."""
        p = np.asarray(pressure, dtype=float)
        return 1.0 + self.a * p / (1.0 + self.b * p)

    def slope(self, pressure: Any) -> Array:
        """Its derivative [1/Pa] at pressures [Pa], any shape."""
        return self.a / (1.0 + self.b * np.asarray(pressure, dtype=float)) ** 2

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"a": self.a, "b": self.b}


GRADES = (2, 3, 5, 7, 10, 15, 22, 32, 46, 68, 100, 150, 220, 320, 460, 680, 1000, 1500, 2200, 3200)
VOGEL_SHIFT, VOGEL_RISE, VOGEL_POLE = 95.0, 159.55787, 1.8e-4  # K, K, Pa s
REFERENCE = 40.0  # degrees Celsius


@named_arguments
def iso_vg(
    grade: int,
    *,
    temperature: float,
    at_100: float | None = None,
    density: float = DENSITY,
    heat_capacity: float | None = None,
    conductivity: float = CONDUCTIVITY,
    expansion: float = EXPANSION,
) -> Newtonian:
    """The oil of ISO VG `grade` at `temperature` [degrees Celsius]; at_100: kinematic viscosity at 100 degrees [m2/s],
    of an oil whose viscosity index differs from about 95; density [kg/m3]. With heat_capacity [J/(kg K)], about 2000,
    it depends on the temperature of the film; conductivity [W/(m K)], expansion [1/K]: as of `Thermal`. Raises
    `InputError`."""
    label = f"oils.iso_vg({grade!r})"
    if grade not in GRADES:
        raise InputError(f"{label}: no such grade; known: {', '.join(map(str, GRADES))}")
    T = temperature_of(temperature, label)
    rho = require_number(density, f"{label}: density [kg/m3]", positive=True)
    nu_40 = 1e-6 * grade
    mu_40 = rho * nu_40
    law: ThermalLaw = VogelLaw(float(VOGEL_RISE * np.log(mu_40 / VOGEL_POLE)), VOGEL_SHIFT)
    mu = float(law.viscosity(mu_40, REFERENCE, T))
    if at_100 is not None:
        law = WaltherLaw([(REFERENCE, nu_40), (100.0, at_100)])
        mu = walther(T, points=law.points, density=rho)
    if heat_capacity is None:
        return Newtonian(mu)
    return Newtonian(mu, thermal=Thermal(law, T, heat_capacity, conductivity, rho, expansion))


# Pa s: air has 2e-5, and bitumen at room temperature 1e5
LEAST, MOST = 1e-6, 1e4
FORMS = ("newtonian", "barus", "roelands")  # that `warpffrf_kernels.films.oil` evaluates


@dataclass(frozen=True)
class Oil(ABC):
    """An oil of `viscosity` [Pa s] at zero pressure, compressible where it has a law of `density`, and dependent on
    temperature where it has `thermal` data. Raises `InputError` for an implausible viscosity, a density that is not a
    law, and thermal data that are none.

    A user-defined oil is a subclass of `Newtonian`, `Barus` or `Roelands`, whose form the kernels evaluate.
    """

    viscosity: float
    _: KW_ONLY
    density: DowsonHigginson | None = None
    thermal: Thermal | None = None
    kind: ClassVar[str]
    form: ClassVar[str] = ""

    def __post_init__(self) -> None:
        viscosity = require_number(self.viscosity, f"{self.label}: viscosity [Pa s]", positive=True)
        if not LEAST <= viscosity <= MOST:
            raise InputError(
                f"{self.label}: viscosity must lie between {LEAST:g} and {MOST:g} Pa s, got {viscosity:g}; an oil of "
                "46 mm2/s has about 0.04 Pa s"
            )
        if self.density is not None and not isinstance(self.density, DowsonHigginson):
            raise InputError(
                f"{self.label}: density must be oils.DowsonHigginson(...) or None, of an oil that is not compressible, "
                f"got {self.density!r}"
            )
        if self.thermal is not None and not isinstance(self.thermal, Thermal):
            raise InputError(
                f"{self.label}: thermal must be oils.Thermal(...) or None, of an oil at one temperature, got "
                f"{self.thermal!r}"
            )
        object.__setattr__(self, "viscosity", viscosity)

    @property
    def label(self) -> str:
        """For messages."""
        return f"oils.{type(self).__name__}"

    @property
    def numbers(self) -> tuple[float, float, float]:
        """Parameters of the form on the device: coefficient [1/Pa], rise and exponent [-], 0 where it has none."""
        return 0.0, 0.0, 0.0

    def at(self, temperature: float) -> Self:
        """The oil at `temperature` [degrees Celsius], `density_at` relative to its density there. Raises `InputError`
        for one without thermal data."""
        T = temperature_of(temperature, self.label)
        if self.thermal is None:
            raise InputError(f"{self.label}: it is isothermal; give it thermal=oils.Thermal(...)")
        there = replace(
            self.thermal,
            temperature=T,
            density=float(self.thermal.density_at(T)),
            expansion=self.thermal.expansion * self.thermal.density / float(self.thermal.density_at(T)),
        )
        return replace(self, thermal=there, **self._numbers_at(float(self.thermal.viscosity(self.viscosity, T))))

    def _numbers_at(self, viscosity: float) -> dict[str, float]:
        """Fields at the temperature where it has that viscosity [Pa s]."""
        return {"viscosity": viscosity}

    @abstractmethod
    def viscosity_at(self, pressure: Any) -> Array:
        """mu [Pa s] at pressures [Pa], any shape."""

    @abstractmethod
    def viscosity_slope(self, pressure: Any) -> Array:
        """mu' [s] at pressures [Pa], any shape."""

    def thinned(self, pressure: Any, thinning: Any) -> Array:
        """mu [Pa s] at pressures [Pa] at another temperature; thinning: ln of the viscosity without pressure there over
        that of this oil, arguments broadcast."""
        return self.viscosity_at(pressure) * np.exp(thinning)

    def density_at(self, pressure: Any) -> Array:
        """rho/rho_0 [-] at pressures [Pa], any shape."""
        p = np.asarray(pressure, dtype=float)
        return np.ones_like(p) if self.density is None else self.density.ratio(p)

    def density_slope(self, pressure: Any) -> Array:
        """Its derivative [1/Pa] at pressures [Pa], any shape."""
        p = np.asarray(pressure, dtype=float)
        return np.zeros_like(p) if self.density is None else self.density.slope(p)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        numbers = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in ("density", "thermal", "_")}
        warm = {} if self.thermal is None else {"thermal": self.thermal.describe()}
        density = None if self.density is None else self.density.describe()
        return {"kind": self.kind, **numbers, "density": density, **warm}


@named_arguments
@dataclass(frozen=True)
class Barus(Oil):
    """mu = viscosity exp(coefficient p); viscosity [Pa s], coefficient alpha [1/Pa]. Raises `InputError`."""

    _: KW_ONLY
    coefficient: float
    kind: ClassVar[str] = "barus"
    form: ClassVar[str] = "barus"

    def __post_init__(self) -> None:
        super().__post_init__()
        alpha = require_number(self.coefficient, f"{self.label}: coefficient [1/Pa]", non_negative=True)
        object.__setattr__(self, "coefficient", alpha)

    @property
    def numbers(self) -> tuple[float, float, float]:
        return self.coefficient, 0.0, 0.0

    def viscosity_at(self, pressure: Any) -> Array:
        return self.viscosity * np.exp(self.coefficient * np.asarray(pressure, dtype=float))

    def viscosity_slope(self, pressure: Any) -> Array:
        return self.coefficient * self.viscosity_at(pressure)


@named_arguments
@dataclass(frozen=True)
class Newtonian(Oil):
    """mu = viscosity [Pa s]. Raises `InputError`."""

    kind: ClassVar[str] = "newtonian"
    form: ClassVar[str] = "newtonian"

    def viscosity_at(self, pressure: Any) -> Array:
        return np.full_like(np.asarray(pressure, dtype=float), self.viscosity)

    def viscosity_slope(self, pressure: Any) -> Array:
        return np.zeros_like(np.asarray(pressure, dtype=float))


POLE_PRESSURE = 196.2e6  # Pa
LARGEST = 1.5  # of z: no known oil exceeds 1


@named_arguments
@dataclass(frozen=True)
class Roelands(Oil):
    """mu = viscosity exp(b ((1 + p/p_r)^z - 1)) with mu'/mu = coefficient at zero pressure; viscosity [Pa s],
    coefficient alpha [1/Pa]. Raises `InputError`."""

    _: KW_ONLY
    coefficient: float
    kind: ClassVar[str] = "roelands"
    form: ClassVar[str] = "roelands"

    def __post_init__(self) -> None:
        super().__post_init__()
        alpha = require_number(self.coefficient, f"{self.label}: coefficient [1/Pa]", positive=True)
        object.__setattr__(self, "coefficient", alpha)
        if self.viscosity <= POLE_VISCOSITY:
            raise InputError(
                f"{self.label}: viscosity must be above {POLE_VISCOSITY:g} Pa s, the least that an oil of Roelands "
                f"has, got {self.viscosity:g}; use oils.Barus"
            )
        if self.exponent > LARGEST:
            usual = 0.6 * self.rise / POLE_PRESSURE
            raise InputError(
                f"{self.label}: a coefficient of {alpha:g} 1/Pa with {self.viscosity:g} Pa s makes its exponent z "
                f"{self.exponent:.3g}; mineral oils have 0.5 to 0.7, which is about {usual:.2g} 1/Pa here"
            )

    def _numbers_at(self, viscosity: float) -> dict[str, float]:
        b = float(np.log(viscosity / POLE_VISCOSITY))
        return {"viscosity": viscosity, "coefficient": self.exponent * b / POLE_PRESSURE}

    @property
    def rise(self) -> float:
        """b of the module docstring [-]."""
        return float(np.log(self.viscosity / POLE_VISCOSITY))

    @property
    def exponent(self) -> float:
        """z [-]."""
        return self.coefficient * POLE_PRESSURE / self.rise

    @property
    def numbers(self) -> tuple[float, float, float]:
        return self.coefficient, self.rise, self.exponent

    def viscosity_at(self, pressure: Any) -> Array:
        relative = 1.0 + np.asarray(pressure, dtype=float) / POLE_PRESSURE
        return self.viscosity * np.exp(self.rise * (relative**self.exponent - 1.0))

    def thinned(self, pressure: Any, thinning: Any) -> Array:
        relative = 1.0 + np.asarray(pressure, dtype=float) / POLE_PRESSURE
        return self.viscosity_at(pressure) * np.exp(thinning * relative**self.exponent)

    def viscosity_slope(self, pressure: Any) -> Array:
        relative = 1.0 + np.asarray(pressure, dtype=float) / POLE_PRESSURE
        return self.coefficient * relative ** (self.exponent - 1.0) * self.viscosity_at(pressure)


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
    return float(rho * WaltherLaw(walther_points(points, label)).kinematic(T))


OILS = {oil.kind: oil for oil in (Newtonian, Barus, Roelands)}  # kind -> class

__all__ = [
    "OILS", "THERMAL_LAWS", "Barus", "DowsonHigginson", "ExponentialLaw", "Newtonian", "Oil", "Roelands", "RoelandsLaw",
    "Thermal", "VogelLaw", "WaltherLaw", "as_oil", "iso_vg", "vogel", "walther",
]  # fmt: skip


def __dir__() -> list[str]:
    return __all__


def as_oil(value: Any, label: str) -> Oil:
    """`value` if it is an oil of a form that kernels evaluate; raises `InputError` naming `label`, with the
    existing oils."""
    names = ", ".join(f"oils.{oil.__name__}" for oil in OILS.values())
    if not isinstance(value, Oil):
        raise InputError(f"{label}: oil must be one of {names}, or made by oils.iso_vg, got {value!r}")
    if value.form not in FORMS:
        raise InputError(
            f"{label}: the oil {value.label} has the form {value.form!r}; the kernels evaluate {', '.join(FORMS)}; "
            f"make it a subclass of one of {names}"
        )
    return value
