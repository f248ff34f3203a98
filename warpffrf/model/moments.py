r"""Moments of lumped contacts, in addition to the contact force: rolling resistance and resistance to pivoting about
the normal.

    RollingResistanceArm    M = e F, e the arm
    RollingHysteresis       the fraction of the compression work that is lost in rolling
    spin                    Coulomb's friction over Hertz's ellipse in pure pivoting, of the contact's friction law

Kernels are `warpffrf_kernels.lumped.moments`. A user-defined rolling law is a subclass of `RollingResistance`.

Patch. Size of the patch of a lumped contact, which determines the moments; defined by the force law.

Resistance. Common base of moments of lumped contacts: m(w) = min(c F^p, d F^q w) under the force F at the angular speed
w.

The bound c F^p is that of the law, the slope d F^q from rest regularises it over the speed: there is no sticking, and a
body on a slope rolls down slowly, at less than the speed c F^p/(d F^q) where both meet.

Rolling resistance by hysteresis (D. Tabor 1955; K. L. Johnson, Contact Mechanics, 1985, section 9.2).

As a patch rolls, the pressure ahead of its centre does work on the incoming material, and the pressure behind recovers
it except for the fraction alpha. With the half-axis b of the patch in the direction of rolling, the pressures ahead
have the moments

    line    2 F b/(3 pi),      ellipse    3 F b/16

about the middle, of which the fraction alpha remains: M = alpha times that. b grows as F^(1/2) of a line, F^(1/3) of an
ellipse. The shorter half-axis is used for any direction: elements of bearings roll across the long one.

Rolling resistance by an arm: M = e F, the force of the ground a distance e ahead of the middle of the patch.

A roller of mass m, radius r and moment of inertia J that rolls out on a plane slows down by

    dv/dt = -(e/r) g/(1 + J/(m r^2)),

as the moment e F and a friction force F e/(r (1 + J/(m r^2))) decelerate it. e/r is the coefficient of
rolling resistance of handbooks. In a bearing Palmgren's torque M_1 = f_1 F d_m that grows with the load (A. Palmgren,
Ball and Roller Bearing Engineering, 1959) is that of a lever: an element of the diameter D that rotates with w_e
relative to both rings dissipates e Q w_e at each contact.

Spin. Friction of a patch that pivots about its normal: the moment of Coulomb's friction over Hertz's ellipse.

With the pressure p = p_0 sqrt(1 - x^2/a^2 - y^2/b^2) of the force F, pivoting at w_s without slip of the whole patch,
and regularised friction of the slip velocity v_s, tractions are mu p min(r w_s/v_s, 1) at the distance r, so that

    slow     M = mu w_s/v_s int p r^2 dA = mu F (a^2 + b^2)/5 w_s/v_s,
    fast     M = mu int p r dA = 3/8 mu F a E(m),      m = 1 - b^2/a^2, E the complete elliptic integral,

3 pi/16 mu F a of a circle. In between M is taken as the smaller of them, an upper bound. a and b grow as
F^(1/3).

Slip of the whole patch reduces the moment, and pivoting the friction force, as both share one traction
(Contensou 1963). This is not modelled: force and moment each have their full bound, and the pivoting resistance of a
patch that slips faster than it pivots at its edge, |v| > a w_s, is overestimated.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import asdict, dataclass
from typing import Any, ClassVar

from scipy.special import ellipe

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.friction import FrictionLaw
from warpffrf.model.messages.named_arguments import named_arguments


@dataclass(frozen=True)
class Patch:
    """Under the force F: half-axes `short` and `long` [m/N^growth] times F^growth, None of a line, and the moment
    `ahead` [-] of the pressure ahead of the middle, over F and the short one."""

    short: float
    long: float | None
    growth: float
    ahead: float


@dataclass(frozen=True)
class Resistance:
    """A moment as the kernels read it: `bound` c [N m/N^p], `bound_power` p, `slope` d [N m s/N^q], `slope_power` q."""

    bound: float = 0.0
    bound_power: float = 1.0
    slope: float = 0.0
    slope_power: float = 1.0


NO_RESISTANCE = Resistance()


class RollingResistance(ABC):
    """A law of resistance to rolling, a frozen dataclass listed in `warpffrf.model.moments.ROLLING_LAWS`: a moment
    against the relative angular velocity of both bodies across the normal.

    rolling_speed [rad/s]: of that velocity, below which the moment is proportional to it; far below the
    speeds of the machine.
    """

    kind: ClassVar[str] = ""
    rolling_speed: float

    @abstractmethod
    def bound(self, patch: Patch | None, label: str) -> tuple[float, float]:
        """c [N m/N^p] and p of a point with that patch, None for a force law without one. Raises `InputError` naming
        `label` where it requires one."""

    def resistance(self, patch: Patch | None, label: str) -> Resistance:
        """Its numbers at a point with that patch. Raises `InputError` naming `label` as `bound` does."""
        c, p = self.bound(patch, label)
        return Resistance(c, p, c / self.rolling_speed, p)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"kind": self.kind, **asdict(self)}  # pyright: ignore[reportArgumentType]


@named_arguments
@dataclass(frozen=True)
class RollingHysteresis(RollingResistance):
    """The fraction `loss` [-] of the work that presses the material ahead is lost, which results in a moment
    against rolling.

    loss: between 0 and 1, about 0.01 of hard steel. For laws.HertzPoint, laws.PalmgrenLine and laws.IsoLamina, whose
    patches are known. rolling_speed [rad/s] as in `RollingResistance`. Raises `InputError`.
    """

    loss: float
    rolling_speed: float
    kind: ClassVar[str] = "rolling_hysteresis"

    def __post_init__(self) -> None:
        alpha = require_number(self.loss, "RollingHysteresis: loss", non_negative=True)
        if alpha > 1.0:
            raise InputError(f"RollingHysteresis: loss must be at most 1, all of the work, got {alpha:g}")
        speed = require_number(self.rolling_speed, "RollingHysteresis: rolling_speed [rad/s]", positive=True)
        object.__setattr__(self, "loss", alpha)
        object.__setattr__(self, "rolling_speed", speed)

    def bound(self, patch: Patch | None, label: str) -> tuple[float, float]:
        if patch is None:
            raise InputError(
                f"{label}: laws.RollingHysteresis needs the size of the patch, which only laws.HertzPoint, "
                "laws.PalmgrenLine and laws.IsoLamina define; use one of these, or laws.RollingResistanceArm"
            )
        return self.loss * patch.ahead * patch.short, 1.0 + patch.growth


@named_arguments
@dataclass(frozen=True)
class RollingResistanceArm(RollingResistance):
    """M = lever * F against rolling, F the normal force; for any law of it, of laminae for each.

    lever [m]: not negative, some micrometres of hard steel. rolling_speed [rad/s] as in `RollingResistance`. Raises
    `InputError`.
    """

    lever: float
    rolling_speed: float
    kind: ClassVar[str] = "rolling_resistance_arm"

    def __post_init__(self) -> None:
        lever = require_number(self.lever, "RollingResistanceArm: lever [m]", non_negative=True)
        speed = require_number(self.rolling_speed, "RollingResistanceArm: rolling_speed [rad/s]", positive=True)
        object.__setattr__(self, "lever", lever)
        object.__setattr__(self, "rolling_speed", speed)

    def bound(self, patch: Patch | None, label: str) -> tuple[float, float]:
        return self.lever, 1.0


def spin_resistance(friction: FrictionLaw, patch: Patch | None, label: str) -> Resistance:
    """Of a contact with that friction and that patch, None where the force law has no patch. Raises `InputError` naming
    `label` for friction that sticks, which does not depend on a velocity, for a coefficient that rises with it, and for
    patches that are no ellipse."""
    if not friction.acts or not friction.creep_limit:
        raise InputError(
            f"{label}: spin=True requires friction that depends on the velocity of the surfaces, "
            "laws.RegularisedCoulomb or laws.TractionCurve"
        )
    if friction.static_coefficient < friction.largest_coefficient:
        raise InputError(
            f"{label}: spin=True has one coefficient for the whole patch, and that of laws.{type(friction).__name__} "
            "rises with the slip speed; use laws.TractionCurve"
        )
    if patch is None or patch.long is None:
        raise InputError(
            f"{label}: spin=True needs an elliptical patch, that of laws.HertzPoint; laminae resist pivoting without it"
        )
    a, b, mu = patch.long, patch.short, friction.static_coefficient
    fast = 0.375 * mu * a * float(ellipe(1.0 - (b / a) ** 2))
    slow = mu * (a**2 + b**2) / (5.0 * friction.creep_limit)
    return Resistance(fast, 1.0 + patch.growth, slow, 1.0 + 2.0 * patch.growth)


ROLLING_LAWS = {law.kind: law for law in (RollingResistanceArm, RollingHysteresis)}

__all__ = [
    "NO_RESISTANCE", "ROLLING_LAWS", "Resistance", "RollingHysteresis", "RollingResistanceArm", "RollingResistance",
    "as_rolling_resistance", "spin_resistance",
]  # fmt: skip


def as_rolling_resistance(value: Any, label: str) -> RollingResistance | None:
    """`value` if it is a law of rolling resistance, or None; raises `InputError` naming `label` and the
    existing laws."""
    if value is not None and not isinstance(value, RollingResistance):
        names = ", ".join(f"laws.{law.__name__}" for law in ROLLING_LAWS.values())
        raise InputError(
            f"{label}: rolling_resistance must be one of {names}, or None, got {value!r}; a coefficient is a lever "
            "over a radius, laws.RollingResistanceArm(coefficient * radius, rolling_speed)"
        )
    return value
