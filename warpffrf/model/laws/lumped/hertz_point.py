r"""Hertz's contact of two bodies that touch in a point (K. L. Johnson, Contact Mechanics, 1985, section 4.1).

With the relative principal curvatures 1/R_x <= 1/R_y and the ratio k = b/a <= 1 of the half-axes, the root of

    R_D(0, 1, k^2)/R_D(0, k^2, 1) = R_x/R_y

in Carlson's integrals, the half-axis along x, the force and the approach are

    a^3 = F R_x R_D(0, k^2, 1)/(pi E*),      delta = (3 F/(2 pi E* a)) R_F(0, 1, k^2),

so that F = K delta^1.5 with K = pi E* sqrt(R_x R_D)/(1.5 R_F)^1.5. A ball on a plane has k = 1, R_D = 3 pi/4,
R_F = pi/2: K = 4/3 E* sqrt(R).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from scipy.optimize import brentq
from scipy.special import elliprd, elliprf

from warpffrf.model.errors import InputError
from warpffrf.model.laws.lumped.base import Approach, LumpedLaw, Meeting
from warpffrf.model.material import Material
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.moments.patch import Patch

SLENDEREST = 1e-4  # ratio of the half-axes down to which an ellipse is looked for; it is a line beyond
AHEAD = 3.0 / 16.0  # moment of the pressure ahead of the middle of an ellipse, over F and the half-axis ahead
ROUND = 1e-12  # difference of the curvatures, of the larger one, below which the patch is a circle


@named_arguments
@dataclass(frozen=True)
class HertzPoint(LumpedLaw):
    """Hertz's law of a point contact, for surfaces that are curved against each other in both directions.

    material_a, material_b: of the two bodies, of which E and nu count; None for one that does not yield. The stiffness
    is that of the curvatures where the surfaces are nearest at the initial pose, and stays. damping, restitution and
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
            f"{1.0 / large:.3g} m); take laws.PalmgrenLine or laws.IsoLamina, with the roller first"
        )
    root: Any = brentq(excess, least, 0.0, xtol=1e-14)
    return float(np.exp(2.0 * root))
