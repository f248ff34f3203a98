r"""Hertz's contact of two bodies that touch in a point (K. L. Johnson, Contact Mechanics, 1985, section 4.1).

With the relative principal curvatures 1/R_x <= 1/R_y and the ratio k = b/a <= 1 of the half-axes, the root of

    R_D(0, 1, k^2)/R_D(0, k^2, 1) = R_x/R_y

in Carlson's integrals, the half-axis along x, the force and the approach are

    a^3 = F R_x R_D(0, k^2, 1)/(pi E*),      delta = (3 F/(2 pi E* a)) R_F(0, 1, k^2),

so that F = K delta^1.5 with K = pi E* sqrt(R_x R_D)/(1.5 R_F)^1.5. A ball on a plane has k = 1, R_D = 3 pi/4,
R_F = pi/2: K = 4/3 E* sqrt(R).

Palmgren's line contact of steel rollers (A. Palmgren, Ball and Roller Bearing Engineering, 1959).

    delta = 3.84e-5 F^0.9/l^0.8        in N and mm, at one contact

so that F = (delta l^0.8/3.84e-5)^(10/9), which is proportional to l^(8/9), not quite to l. Laminae share F evenly: a
skewed roller has a moment, and an aligned one the force of the formula. It was measured on steel and holds
for no other material.

The patch of a lamina of the width w is Hertz's of a line, b = sqrt(4 F/(pi E* kappa w)), kappa the relative curvature
across.

ISO lamina. The lamina model of roller bearings of ISO/TS 16281:2008.

A roller of effective length L is cut into n laminae. Between the rings, where it has two contacts in series, lamina k
carries q_k = (c_L/n) delta_k^(10/9) with c_L = 35948 L^(8/9), in N and mm, delta_k the approach of both together, each
reduced by the profile P(x_k). Each of two equal contacts has half of it:

    F_k = (c_L/n) (2 (a - P(x_k)))^(10/9) = (2^(10/9) c_L/n) (a - P(x_k))^(10/9).

The standard's profile of a roller of diameter D, x from its middle: where L <= 2.5 D

    P = 0.00035 D ln(1/(1 - (2 x/L)^2)),

else none for |x| <= (L - 2.5 D)/2 and, beyond,

    P = 0.0005 D ln(1/(1 - ((2 |x| - (L - 2.5 D))/(2.5 D))^2)).
"""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

import numpy as np
from scipy.optimize import brentq
from scipy.special import elliprd, elliprf

from warpffrf.model.errors import InputError, require_count, require_number
from warpffrf.model.laws.lumped.base import Approach, LumpedLaw, Meeting
from warpffrf.model.material import Material
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.moments import Patch

SLENDEREST = 1e-4  # ratio of the half-axes down to which an ellipse is searched for; below it is a line
AHEAD = 3.0 / 16.0  # moment of the pressure ahead of the middle of an ellipse, over F and the half-axis ahead
ROUND = 1e-12  # difference of the curvatures, of the larger one, below which the patch is a circle


@named_arguments
@dataclass(frozen=True)
class HertzPoint(LumpedLaw):
    """Hertz's law of a point contact, for surfaces that are curved against each other in both directions.

    material_a, material_b: of the two bodies, of which E and nu are used; None for a rigid one. The stiffness is
    that of the curvatures at the nearest points at the initial pose and remains constant. damping, restitution and
    impact_speed as in `LumpedLaw`. Raises `InputError`.
    """

    material_a: Material
    material_b: Material | None = None
    kind: ClassVar[str] = "hertz_point"

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, material in (("material_a", self.material_a), ("material_b", self.material_b)):
            if not isinstance(material, Material) and (material is not None or name == "material_a"):
                raise InputError(f"HertzPoint: {name} must be a Material, got {material!r}")

    def approach(self, meeting: Meeting) -> Approach:
        small, large = meeting.curvatures
        modulus = self._modulus()
        shear = 1.0 / sum((2.0 - m.poisson_ratio) / m.lame[1] for m in self._materials())
        k2 = _ratio_squared(small, large, meeting.label)
        R_x, R_D, R_F = 1.0 / small, float(elliprd(0.0, k2, 1.0)), float(elliprf(0.0, 1.0, k2))
        stiffness = np.pi * modulus * np.sqrt(R_x * R_D) / (1.5 * R_F) ** 1.5
        return Approach(float(stiffness), 1.5, shear=4.0 * shear / modulus)

    def patch(self, meeting: Meeting) -> Patch:
        small, large = meeting.curvatures
        k2 = _ratio_squared(small, large, meeting.label)
        a = (float(elliprd(0.0, k2, 1.0)) / (np.pi * self._modulus() * small)) ** (1.0 / 3.0)
        return Patch(float(a * np.sqrt(k2)), float(a), growth=1.0 / 3.0, ahead=AHEAD)

    def _materials(self) -> list[Material]:
        return [m for m in (self.material_a, self.material_b) if m is not None]

    def _modulus(self) -> float:
        """E* [Pa]."""
        return 1.0 / sum(1.0 / m.plane_strain_modulus for m in self._materials())


def load_at_pressure(peak: float, small: float, large: float, modulus: float) -> float:
    """Load [N] at which the pressure in the middle is `peak` [Pa], for the relative curvatures `small` <= `large` [1/m]
    and the modulus E* [Pa]: F = (2/3) p0 pi a b."""
    k2 = _ratio_squared(small, large, "point contact")
    return float(
        (2.0 / 3.0 * np.pi * np.sqrt(k2) * peak) ** 3 * (elliprd(0.0, k2, 1.0) / (np.pi * modulus * small)) ** 2
    )


def _ratio_squared(small: float, large: float, label: str) -> float:
    """k^2 of the module docstring."""
    if large - small <= ROUND * large:
        return 1.0
    wanted = np.log(large / small)

    def excess(log_k: float) -> float:
        k2 = np.exp(2.0 * log_k)
        return float(np.log(elliprd(0.0, 1.0, k2) / elliprd(0.0, k2, 1.0)) - wanted)

    least = float(np.log(SLENDEREST))
    if excess(least) < 0.0:
        raise InputError(
            f"{label}: the surfaces touch along a line, all but (relative radii {1.0 / small:.3g} and "
            f"{1.0 / large:.3g} m); use laws.PalmgrenLine or laws.IsoLamina, with the roller first"
        )
    root: Any = brentq(excess, least, 0.0, xtol=1e-14)
    return float(np.exp(2.0 * root))


COEFFICIENT = 3.84e-5  # delta [mm] of F = 1 N and l = 1 mm
FORCE_POWER, LENGTH_POWER = 0.9, 0.8
MM = 1e3  # in a metre
MODULUS = 0.5 * 207e9 / (1.0 - 0.3**2)  # Pa: E* of steel on steel
PALMGREN_AHEAD = 2.0 / (3.0 * np.pi)  # moment of the pressure ahead of the middle of a line, over F and its half-width


def laminae(length: float, count: int) -> np.ndarray:
    """Middles (count,) [m] of laminae of the same width, from the middle of the length [m]."""
    return length * ((np.arange(count) + 0.5) / count - 0.5)


def line_patch(meeting: Meeting, width: float) -> Patch:
    """Of a lamina of steel of the width [m]."""
    short = float(np.sqrt(4.0 / (np.pi * MODULUS * meeting.curvatures[1] * width)))
    return Patch(short, None, growth=0.5, ahead=PALMGREN_AHEAD)


@named_arguments
@dataclass(frozen=True)
class PalmgrenLine(LumpedLaw):
    """Palmgren's law of a roller of effective length `length` [m], steel on steel; the first surface is the roller.

    laminae: slices that each meet the other surface; one only has no moment against tilting. damping, restitution and
    impact_speed as in `LumpedLaw`. Raises `InputError`.
    """

    length: float
    laminae: int = 1
    kind: ClassVar[str] = "palmgren_line"
    by_laminae: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        self._keep("length", require_number(self.length, "PalmgrenLine: length [m]", positive=True))
        self._keep("laminae", require_count(self.laminae, "PalmgrenLine: laminae", 1))

    def approach(self, meeting: Meeting) -> Approach:
        exponent = 1.0 / FORCE_POWER
        stiffness = (MM * (MM * self.length) ** LENGTH_POWER / COEFFICIENT) ** exponent
        return Approach(stiffness, exponent, z=laminae(self.length, self.laminae), drop=np.zeros(self.laminae))

    def patch(self, meeting: Meeting) -> Patch:
        return line_patch(meeting, self.length / self.laminae)


CONSTANT, LENGTH_POWER_ISO_LAMINA, EXPONENT = 35948.0, 8.0 / 9.0, 10.0 / 9.0  # of c_L [N/mm^(10/9)], L in mm
SHORT, SHORT_DROP, LONG_DROP = 2.5, 0.00035, 0.0005  # diameters; of the diameter
LAMINAE = 30  # the fewest that the standard requires


@named_arguments
@dataclass(frozen=True)
class IsoLamina(LumpedLaw):
    """ISO/TS 16281's law of a steel roller of effective length `length` [m] on a raceway; the first surface is the
    roller.

    laminae: at least 30 by the standard. profile: whether the roller has the standard's profile, in addition to that of
    its surface. damping, restitution and impact_speed as in `LumpedLaw`. Raises `InputError`.
    """

    length: float
    laminae: int = LAMINAE
    _: KW_ONLY
    profile: bool = True
    kind: ClassVar[str] = "iso_lamina"
    by_laminae: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        self._keep("length", require_number(self.length, "IsoLamina: length [m]", positive=True))
        self._keep("laminae", require_count(self.laminae, "IsoLamina: laminae", 1))
        self._keep("profile", bool(self.profile))

    def approach(self, meeting: Meeting) -> Approach:
        stiffness = CONSTANT * (MM * self.length) ** LENGTH_POWER_ISO_LAMINA * (2.0 * MM) ** EXPONENT
        x = laminae(self.length, self.laminae)
        drop = iso_profile(x, self.length, 2.0 * meeting.radius) if self.profile else np.zeros(len(x))
        return Approach(stiffness, EXPONENT, z=x, drop=drop)

    def patch(self, meeting: Meeting) -> Patch:
        return line_patch(meeting, self.length / self.laminae)


def iso_profile(x: np.ndarray, length: float, diameter: float) -> np.ndarray:
    """P [m] at the positions x [m] from the middle of a roller, inside its length [m]."""
    if length <= SHORT * diameter:
        return -SHORT_DROP * diameter * np.log(1.0 - (2.0 * x / length) ** 2)
    beyond = np.maximum(2.0 * np.abs(x) - (length - SHORT * diameter), 0.0)
    return -LONG_DROP * diameter * np.log(1.0 - (beyond / (SHORT * diameter)) ** 2)
