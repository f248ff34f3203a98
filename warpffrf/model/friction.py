r"""Friction laws of contacts and joints.

    Coulomb               |tau| <= mu p, stick and slip
    RegularisedCoulomb    no stick: tau proportional to the slip velocity below v_slip
    Stribeck              mu(v) = mu_k + (mu_s - mu_k) exp(-(v/v_s)^delta)
    TabulatedFriction     mu(v) from a table
    TractionCurve         lubricated rolling: a rise in proportion to v, a peak, a fall to a limit; of lumped contacts
    EyringTraction        lubricated rolling from data of the oil: shear thinning up to a limit; of lumped contacts

A user-defined law is a subclass of `FrictionLaw` with a coefficient and its slope.

Coulomb. Dry friction: |tau| <= mu p with one coefficient in stick and slip; the only parameter is mu.

Eyring traction. Traction of a film from data of the oil at the mean pressure p of a contact: shear thinning (H. Eyring,
J. Chem. Phys. 4, 1936, 283; K. L. Johnson and J. L. Tevaarwerk, Proc. R. Soc. A 356, 1977, 215) up to the limiting
shear stress, which is proportional to the pressure (S. Bair and W. O. Winer, J. Lubr. Technol. 101, 1979, 258),

    mu(v) = min((tau_0/p) asinh(v/v_0), mu_l),      v_0 = h tau_0/mu_p,

tau_0 the Eyring stress, some 5 MPa of mineral oils, h the thickness of the film, mu_p its viscosity at p. Below v_0/4
the oil is Newtonian. Isothermal, and without the elasticity of the oil.

Law. Common to all friction laws: the coefficient of the bound as a function of the slip speed.

With the pressure p, the tangential traction tau (2,) on the first surface, the slip velocity w (2,) of the first
surface relative to the second, and mu(v) >= 0 the coefficient at the slip speed v = |w|

    |tau| <= mu(v) p;      w = 0 where |tau| < mu(0) p (stick),      tau = -mu(|w|) p w/|w| where w != 0 (slip),

set-valued at w = 0, and solved as such, with stick and slip determined per cell. mu(0) is the coefficient of static
friction. A law with a `creep_limit` does not stick: below it the traction is proportional to the velocity.

A coefficient that falls with the speed does not have one solution for every step. The elasticity and inertia behind a
cell resist the slip of a step with the tangential stiffness k [Pa/m]; a sliding cell loses |mu'| p/h of traction per
metre of slip, h the step. The slip is unique where

    |mu'| p/h < k,      k -> M/(beta h^2) (mass M per area, beta of the integrator) where inertia governs,

so h < M/(beta |mu'| p): a step must resolve the growth of slip, with time scale M/(|mu'| p). The elastic deformation of
a surface without inertia has a k that does not grow as h decreases; there h > |mu'| p/k, and a shorter step shows jumps
that only local inertia would resolve. Where the iteration meets a slip beyond either bound, it proceeds to the solution
nearest to the current state, and the report states this.

Pieces. The device reads the friction coefficient of any law as cubic pieces over the slip speed.

Between neighbouring `breaks` of a law intervals are halved until Hermite's cubic, through values and slopes at both
ends, is within TOLERANCE of the law at three points in between. The pieces of a table are its straight lines.

Regularised Coulomb. Dry friction without stick: tau = -mu p w/max(|w|, v_slip), creep up to v_slip below the bound.

The approximation used by other programs; as v_slip goes to 0 it becomes `Coulomb`. Over a step h the slip velocity is
the increment of slip over h, so that the law is a bound with a compliance: h v_slip/(mu p) metres per pascal are added
to the tangential compliance of a cell, and the bound |tau| <= mu p cuts it: the same convex problem.

Stribeck. Dry friction whose coefficient falls from a static to a kinetic one as slip speed increases.

    mu(v) = mu_k + (mu_s - mu_k) exp(-(v/v_s)^delta),

steepest at rest for delta = 1, |mu'| = (mu_s - mu_k)/v_s, and at v_s/sqrt(2) for delta = 2, sqrt(2/e) times that. It
is the falling part of Stribeck's curve (Bo and Pavelescu, Wear 82, 1982, with delta from 1/2 to 1; Armstrong-Helouvry,
Control of Machines with Friction, 1991, with 2). delta below 1 has an infinite slope at rest, for which no step is
short enough for a unique solution (`law`), and is refused. v_s -> 0 is a coefficient that drops instantaneously.

Tabulated friction. Dry friction with a coefficient given by a table of the slip speed, from a measurement: straight
between the points, and the last value beyond them.

Traction of a lubricated rolling contact as a coefficient over the slip speed.

With the slip velocity w and v = |w| the traction is -mu(v) F w/v,

    mu(v) = mu_p v/v_p,      v <= v_p,                                (elastic and Newtonian rise)
    mu(v) = mu_l + (mu_p - mu_l) exp(-(v - v_p)/v_d),      v > v_p    (fall to the limiting traction, as Stribeck's)

the shape of measured curves of rolling bearings (Gupta, Advanced Dynamics of Rolling Elements, 1984, who takes mu(v) =
(A + B v) exp(-C v) + D): a steep rise from zero slip, a peak, and a fall as the film heats. It is not a fluid model:
its four parameters include film thickness, pressure and temperature. There is no stick. Where the coefficient falls,
the slip is unstable unless inertia stabilises it: |mu'| F h < M (`warpffrf.model.friction`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from numbers import Real
from typing import Any, ClassVar, TypeAlias

import numpy as np

from warpffrf.model.checks.plausibility import friction_doubts, warn
from warpffrf.model.errors import InputError, require_array, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.oils import Oil, as_oil


class FrictionLaw(ABC):
    """A friction law: a frozen dataclass with a `kind`. Scene files refer to those in
    `warpffrf.model.friction.FRICTION_LAWS` by their kind."""

    kind: ClassVar[str]

    @property
    def creep_limit(self) -> float:
        """Slip speed [m/s] at which the bound is reached; 0 for a law that sticks."""
        return 0.0

    @abstractmethod
    def coefficient_at(self, speed: Any) -> np.ndarray:
        """mu [-] of the bound at slip speeds [m/s] from 0 on, any shape."""

    def slope_at(self, speed: Any) -> np.ndarray:
        """dmu/dv [s/m] at slip speeds [m/s], any shape; on the right of a kink."""
        return np.zeros_like(np.asarray(speed, float))

    @property
    def breaks(self) -> tuple[float, ...]:
        """Speeds [m/s] from 0 on between which the coefficient is smooth and monotonic; beyond the last it is constant.
        None where it is constant at all speeds."""
        return ()

    @property
    def static_coefficient(self) -> float:
        """mu(0) [-]."""
        return float(self.coefficient_at(0.0))

    @property
    def largest_coefficient(self) -> float:
        """The largest mu [-] over all speeds."""
        return float(np.max(self.coefficient_at((0.0, *self.breaks))))

    @property
    def least_coefficient(self) -> float:
        """The smallest mu [-] over all speeds."""
        return float(np.min(self.coefficient_at((0.0, *self.breaks))))

    @property
    def acts(self) -> bool:
        """Whether there is any friction."""
        return self.largest_coefficient > 0.0

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        return {"kind": self.kind} | {n: list(v) if isinstance(v, tuple) else v for n, v in values.items()}


@named_arguments
@dataclass(frozen=True)
class Coulomb(FrictionLaw):
    """Dry friction with stick and slip. coefficient: mu [-], 0 is frictionless. Raises `InputError`."""

    coefficient: float
    kind: ClassVar[str] = "coulomb"

    def __post_init__(self) -> None:
        value = require_number(self.coefficient, "Coulomb: coefficient", non_negative=True)
        object.__setattr__(self, "coefficient", value)

    def coefficient_at(self, speed: Any) -> np.ndarray:
        return np.full_like(np.asarray(speed, float), self.coefficient)


TOLERANCE = 1e-9  # of the coefficient: far below the accuracy of any measured one
MOST_PIECES = 4096  # of a law
SHORTEST = 1e-12  # of its speeds: no piece is shorter
BETWEEN = np.array([0.25, 0.5, 0.75])  # where a piece is compared with the law


def cubic_pieces(law: FrictionLaw, label: str) -> np.ndarray:
    """Speeds v_i [m/s] at which pieces begin, and their coefficients by (v - v_i)^0 to ^3 (n, 5); the last one is
    constant. Raises `InputError` naming `label` where the coefficient is negative, no number, or not smooth."""
    found: list[np.ndarray] = []
    room = TOLERANCE * law.largest_coefficient
    least, most = law.least_coefficient - room, law.largest_coefficient + room
    ends = list(zip(law.breaks[:-1], law.breaks[1:], strict=True))[::-1]
    while ends:
        low, high = ends.pop()
        piece = _hermite(law, low, high)
        at = BETWEEN * (high - low)
        values = law.coefficient_at(low + at)
        if not np.all(np.isfinite(piece)) or not np.all(values >= 0.0):
            raise InputError(f"{label}: {law.kind} has a coefficient of friction that is negative or no number")
        if np.any(values > most) or np.any(values < least):
            raise InputError(
                f"{label}: the coefficient of {law.kind} rises and falls between {low:g} and {high:g} m/s; add the "
                "speed of its extreme to `breaks`"
            )
        if np.abs(_value(piece, at) - values).max() <= room:
            found.append(np.concatenate([[low], piece]))
            continue
        if len(found) + len(ends) > MOST_PIECES or high - low < SHORTEST * law.breaks[-1]:
            raise InputError(
                f"{label}: the coefficient of {law.kind} jumps near {low:g} m/s, or its slope_at is not that of its "
                "coefficient_at"
            )
        middle = 0.5 * (low + high)
        ends += [(middle, high), (low, middle)]
    last = law.breaks[-1]
    return np.array([*found, [last, float(law.coefficient_at(last)), 0.0, 0.0, 0.0]])


def _hermite(law: FrictionLaw, low: float, high: float) -> np.ndarray:
    """Coefficients (4,) of the cubic on an interval."""
    h = high - low
    m_0, m_1 = (float(law.coefficient_at(v)) for v in (low, high))
    s_0, s_1 = (float(law.slope_at(v)) for v in (low, np.nextafter(high, low)))  # at a kink the side of the interval
    rise = (m_1 - m_0) / h
    return np.array([m_0, s_0, (3.0 * rise - 2.0 * s_0 - s_1) / h, (s_0 + s_1 - 2.0 * rise) / h**2])


def _value(piece: np.ndarray, x: np.ndarray) -> np.ndarray:
    return piece[0] + x * (piece[1] + x * (piece[2] + x * piece[3]))


@named_arguments
@dataclass(frozen=True)
class RegularisedCoulomb(FrictionLaw):
    """Dry friction with creep in place of stick: below `slip_velocity` [m/s] the traction is proportional to the
    velocity.

    coefficient: mu [-], of the bound. Raises `InputError`.
    """

    coefficient: float
    slip_velocity: float
    kind: ClassVar[str] = "regularised_coulomb"

    def __post_init__(self) -> None:
        mu = require_number(self.coefficient, "RegularisedCoulomb: coefficient", non_negative=True)
        v = require_number(self.slip_velocity, "RegularisedCoulomb: slip_velocity [m/s]", positive=True)
        object.__setattr__(self, "coefficient", mu)
        object.__setattr__(self, "slip_velocity", v)

    @property
    def creep_limit(self) -> float:
        return self.slip_velocity

    def coefficient_at(self, speed: Any) -> np.ndarray:
        return np.full_like(np.asarray(speed, float), self.coefficient)


GONE = 1e-12  # of mu_s - mu_k: the remainder where the fall ends


@named_arguments
@dataclass(frozen=True)
class Stribeck(FrictionLaw):
    """Friction with the coefficient `static` [-] at rest that falls to `kinetic` [-], by a factor e of their difference
    at the speed `decay_velocity` [m/s]: kinetic + (static - kinetic) exp(-(speed/decay_velocity)^exponent).

    0 < kinetic <= static; exponent at least 1. Raises `InputError`.
    """

    static: float
    kinetic: float
    decay_velocity: float
    exponent: float = 2.0
    kind: ClassVar[str] = "stribeck"

    def __post_init__(self) -> None:
        for name, unit in (("static", ""), ("kinetic", ""), ("decay_velocity", " [m/s]"), ("exponent", "")):
            value = require_number(getattr(self, name), f"Stribeck: {name}{unit}", positive=True)
            object.__setattr__(self, name, value)
        if self.kinetic > self.static:
            raise InputError(
                f"Stribeck: kinetic must be at most static, got {self.kinetic:g} and {self.static:g}; for a "
                "coefficient that rises use laws.TabulatedFriction"
            )
        if self.exponent < 1.0:
            raise InputError(
                f"Stribeck: exponent must be at least 1, got {self.exponent:g}: below, the coefficient falls "
                "infinitely steeply at rest, and a step has more than one solution however short it is"
            )

    @property
    def breaks(self) -> tuple[float, ...]:
        """Speeds [m/s] from rest to where the fall has ended."""
        return 0.0, self.decay_velocity * float(-np.log(GONE)) ** (1.0 / self.exponent)

    def coefficient_at(self, speed: Any) -> np.ndarray:
        x = np.asarray(speed, float) / self.decay_velocity
        return self.kinetic + (self.static - self.kinetic) * np.exp(-(x**self.exponent))

    def slope_at(self, speed: Any) -> np.ndarray:
        x = np.asarray(speed, float) / self.decay_velocity
        falling = (self.coefficient_at(speed) - self.kinetic) * self.exponent * x ** (self.exponent - 1.0)
        return -falling / self.decay_velocity


@named_arguments
@dataclass(frozen=True)
class TabulatedFriction(FrictionLaw):
    """Friction with tabulated `coefficients` (n,) [-], positive, at slip `speeds` (n,) [m/s], which rise from 0; the
    first is the coefficient of static friction. Raises `InputError` for a table that is not monotonic."""

    speeds: tuple[float, ...]
    coefficients: tuple[float, ...]
    kind: ClassVar[str] = "tabulated_friction"

    def __post_init__(self) -> None:
        speeds = require_array(self.speeds, "TabulatedFriction: speeds [m/s]", (None,))
        coefficients = require_array(self.coefficients, "TabulatedFriction: coefficients", (None,))
        if len(speeds) != len(coefficients) or len(speeds) < 2:
            raise InputError(
                f"TabulatedFriction: as many coefficients as speeds are needed, two at least, got {len(speeds)} "
                f"speeds and {len(coefficients)} coefficients"
            )
        if speeds[0] != 0.0:
            raise InputError(
                f"TabulatedFriction: the first speed must be 0, got {speeds[0]:g} m/s; add the static coefficient"
            )
        folds = np.diff(speeds) <= 0.0
        if np.any(folds):
            i = int(np.argmax(folds))
            raise InputError(
                f"TabulatedFriction: the table is not monotonic, speeds must rise strictly, got {speeds[i]:g} and "
                f"then {speeds[i + 1]:g} (points {i} and {i + 1})"
            )
        if np.any(coefficients <= 0.0):
            raise InputError(f"TabulatedFriction: coefficients must be positive, got {coefficients.min():g}")
        object.__setattr__(self, "speeds", tuple(float(v) for v in speeds))
        object.__setattr__(self, "coefficients", tuple(float(mu) for mu in coefficients))

    @property
    def breaks(self) -> tuple[float, ...]:
        """The speeds [m/s] of the points."""
        return self.speeds

    def coefficient_at(self, speed: Any) -> np.ndarray:
        return np.interp(np.asarray(speed, float), self.speeds, self.coefficients)

    def slope_at(self, speed: Any) -> np.ndarray:
        slopes = np.append(np.diff(self.coefficients) / np.diff(self.speeds), 0.0)
        return slopes[np.searchsorted(self.speeds, np.asarray(speed, float), side="right") - 1]


FALLEN = 28.0  # decay velocities beyond the peak: e^-28 of the fall are left


@named_arguments
@dataclass(frozen=True)
class TractionCurve(FrictionLaw):
    """A coefficient that rises linearly with the slip speed up to `peak` [-] at `peak_velocity` [m/s], and falls from
    there to `limit` [-], by a factor e of their difference every `decay_velocity` [m/s].

    For lumped contacts, and so for rigid rolling bearings. 0 < limit <= peak. Raises `InputError`.
    """

    peak: float
    peak_velocity: float
    limit: float
    decay_velocity: float
    kind: ClassVar[str] = "traction_curve"

    def __post_init__(self) -> None:
        for name, unit in (("peak", ""), ("peak_velocity", " [m/s]"), ("limit", ""), ("decay_velocity", " [m/s]")):
            value = require_number(getattr(self, name), f"TractionCurve: {name}{unit}", positive=True)
            object.__setattr__(self, name, value)
        if self.limit > self.peak:
            raise InputError(
                f"TractionCurve: limit must be at most peak, got {self.limit:g} and {self.peak:g}; of a curve that "
                "only rises both are the same"
            )

    @property
    def creep_limit(self) -> float:
        return self.peak_velocity

    @property
    def breaks(self) -> tuple[float, ...]:
        """Speeds [m/s] at which the fall begins and ends."""
        return 0.0, self.peak_velocity, self.peak_velocity + FALLEN * self.decay_velocity

    def coefficient_at(self, speed: Any) -> np.ndarray:
        beyond = np.maximum(np.asarray(speed, float) - self.peak_velocity, 0.0)
        return self.limit + (self.peak - self.limit) * np.exp(-beyond / self.decay_velocity)

    def slope_at(self, speed: Any) -> np.ndarray:
        v = np.asarray(speed, float)
        beyond = np.maximum(v - self.peak_velocity, 0.0)
        fall = -(self.peak - self.limit) / self.decay_velocity * np.exp(-beyond / self.decay_velocity)
        return np.where(v >= self.peak_velocity, fall, 0.0)


STEEPEST_RISE = 25.0  # of limit over stress_ratio: sinh is 4e10, beyond any slip
NEWTONIAN = 0.25  # of v_0: below, asinh is its argument within 1 %


@named_arguments
@dataclass(frozen=True)
class EyringTraction(FrictionLaw):
    """A coefficient stress_ratio asinh(speed/velocity), at most `limit`: that of a lubricated contact whose oil thins
    with shear, `stress_ratio` [-] the Eyring stress over the mean pressure, `velocity` [m/s] the slip speed where
    thinning begins, `limit` [-] the limiting shear stress over the pressure.

    For lumped contacts, and so for rigid rolling bearings. Raises `InputError`.
    """

    stress_ratio: float
    velocity: float
    limit: float
    kind: ClassVar[str] = "eyring_traction"

    def __post_init__(self) -> None:
        for name, unit in (("stress_ratio", ""), ("velocity", " [m/s]"), ("limit", "")):
            value = require_number(getattr(self, name), f"EyringTraction: {name}{unit}", positive=True)
            object.__setattr__(self, name, value)
        if self.limit > STEEPEST_RISE * self.stress_ratio:
            raise InputError(
                f"EyringTraction: a limit of {self.limit:g} is not reached at any speed with the stress_ratio "
                f"{self.stress_ratio:g}; it is the Eyring stress, some 5e6 Pa, over the mean pressure"
            )

    @classmethod
    def of_oil(
        cls, oil: Oil, *, pressure: float, film: float, limit: float = 0.05, eyring_stress: float = 5e6
    ) -> EyringTraction:
        """The law of a contact of the mean `pressure` [Pa], two thirds of Hertz's peak, with a `film` [m] of `oil`;
        limit [-]: limiting shear stress over the pressure, 0.03 to 0.1; eyring_stress [Pa]. oils.Roelands, as Barus'
        law has far too high a viscosity at the pressures of bearings. Raises `InputError`."""
        oil = as_oil(oil, "EyringTraction.of_oil")
        p = require_number(pressure, "EyringTraction.of_oil: pressure [Pa]", positive=True)
        h = require_number(film, "EyringTraction.of_oil: film [m]", positive=True)
        tau = require_number(eyring_stress, "EyringTraction.of_oil: eyring_stress [Pa]", positive=True)
        return cls(tau / p, h * tau / float(oil.viscosity_at(p)), limit)

    @property
    def creep_limit(self) -> float:
        return min(NEWTONIAN * self.velocity, self._limiting)

    @property
    def _limiting(self) -> float:
        """Slip speed [m/s] at which the limit is reached."""
        return self.velocity * float(np.sinh(self.limit / self.stress_ratio))

    @property
    def breaks(self) -> tuple[float, ...]:
        """Speeds [m/s] between which the oil thins."""
        return (0.0, *sorted({self.creep_limit, self._limiting}))

    def coefficient_at(self, speed: Any) -> np.ndarray:
        x = np.clip(np.asarray(speed, float), self.creep_limit, self._limiting) / self.velocity
        return self.stress_ratio * np.arcsinh(x)

    def slope_at(self, speed: Any) -> np.ndarray:
        v = np.asarray(speed, float)
        thins = (v >= self.creep_limit) & (v < self._limiting)
        return np.where(thins, self.stress_ratio / np.hypot(v, self.velocity), 0.0)


FRICTION_LAWS = {
    law.kind: law for law in (Coulomb, RegularisedCoulomb, Stribeck, TabulatedFriction, TractionCurve, EyringTraction)
}

RUBBED_REST = (
    "equilibrium(scene, friction=True) includes it, starting from the initial pose, of surfaces from where they are "
    "pressed"
)

__all__ = [
    "FRICTION_LAWS", "Coulomb", "EyringTraction", "FrictionLaw", "RegularisedCoulomb", "Stribeck", "TabulatedFriction",
    "TractionCurve", "RUBBED_REST", "as_constant_friction", "as_friction", "as_lumped_friction", "as_pair_friction",
    "friction_notes", "rolling_notes", "rubbing",
]  # fmt: skip


FrictionLike: TypeAlias = FrictionLaw | float  # a number is the coefficient of Coulomb


def as_friction(value: Any, label: str) -> FrictionLaw:
    """`value` as a friction law: a number is the coefficient of `Coulomb`. Raises `InputError` naming `label`."""
    if isinstance(value, FrictionLaw):
        warn(friction_doubts(value.largest_coefficient, label))
        return value
    scalar = isinstance(value, Real) or (isinstance(value, np.ndarray) and value.ndim == 0)
    if isinstance(value, (bool, np.bool_)) or not scalar:
        names = ", ".join(f"laws.{law.__name__}" for law in FRICTION_LAWS.values())
        raise InputError(f"{label}: friction must be a coefficient or one of {names}, got {value!r}")
    law = Coulomb(require_number(value, f"{label}: friction", non_negative=True))
    warn(friction_doubts(law.coefficient, label))
    return law


def as_constant_friction(value: Any, label: str) -> FrictionLaw:
    """`as_friction` for joints and small-sliding contacts; raises `InputError` for a coefficient that depends on the
    slip speed too."""
    law = as_friction(value, label)
    if law.breaks:
        raise InputError(f"{label}: laws.{type(law).__name__} depends on the slip speed, which {_TAKERS}")
    return law


def as_lumped_friction(value: Any, label: str) -> FrictionLaw:
    """`as_friction` for lumped contacts: a coefficient may depend on the slip speed only if the law does not stick.
    Raises `InputError`."""
    law = as_friction(value, label)
    if law.breaks and not law.creep_limit:
        raise InputError(f"{label}: laws.{type(law).__name__} depends on the slip speed, which {_TAKERS}")
    return law


def as_pair_friction(value: Any, label: str) -> FrictionLaw:
    """`as_friction` for contacts of surfaces: all laws except those without stick whose coefficient depends on the slip
    speed. Raises `InputError`."""
    law = as_friction(value, label)
    if law.breaks and law.creep_limit:
        raise InputError(
            f"{label}: laws.{type(law).__name__} is a law of lumped contacts, LumpedContact(...); use laws.Stribeck "
            "or laws.RegularisedCoulomb between surfaces with a pressure"
        )
    return law


_TAKERS = (
    "only contacts of surfaces support, and of lumped contacts laws.TractionCurve and laws.EyringTraction; give a "
    "coefficient, or laws.RegularisedCoulomb"
)


def rubbing(scene: Any) -> list[str]:
    """Names of the contacts and joint frictions of a scene with friction; rolling resistance is not friction."""
    contacts = [contact.name for contact in (*scene.finite_sliding, *scene.lumped_contacts) if contact.friction.acts]
    return contacts + [force.name for force in scene.forces if hasattr(force, "slip")]


def friction_notes(scene: Any, state: str, cure: str = "") -> list[str]:
    """Notes on the contacts and joints whose friction a static `state` (text for the reader) neglects; `cure`: the
    alternative that includes friction."""
    names = ", ".join(map(repr, rubbing(scene)))
    if not names:
        return []
    return [f"friction of {names} does not act in {state}, which has no slip{cure and f'; {cure}'}"]


def rolling_notes(scene: Any, state: str) -> list[str]:
    """Notes on the lumped contacts whose rolling resistance a static `state` (text for the reader) neglects."""
    names = [repr(contact.name) for contact in scene.lumped_contacts if contact.rolling_resistance is not None]
    return [f"rolling resistance of {', '.join(names)} does not act in {state}, which has no rolling"] if names else []
