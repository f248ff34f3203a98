r"""Impacts with a closed form: Hertz's of two spheres, St Venant's of two bars.

**Hertz** (K. L. Johnson, Contact Mechanics, 1985, section 11.4): both bodies are rigid except for the static compliance
of the contact, P = K delta^(3/2), K = (4/3) E* sqrt(R), with 1/m = 1/m1 + 1/m2 and approach speed v. With the energy
m v^2/2 = (2/5) K delta^(5/2) + m delta'^2/2, and with int_0^1 dx/sqrt(1 - x^(5/2)) = (2/5) B(2/5, 1/2),

    delta_max = (5 m v^2/(4 K))^(2/5),      T = (4/5) B(2/5, 1/2) delta_max/v = 2.94 delta_max/v.

**St Venant**: two equal bars, one at rest, meet with their flat ends. The wave of stress rho c v/2 and particle speed
v/2 runs to both free ends and back: contact ends after 2 L/c, c = sqrt(E/rho), and the bars have exchanged their
speeds. The force is a rectangle in time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import beta

from warpffrf.model.material import Material


@dataclass(frozen=True)
class HertzImpact:
    """effective radius R [m], modulus E* [Pa], effective mass m [kg], approach speed v [m/s]."""

    radius: float
    modulus: float
    mass: float
    speed: float

    @property
    def stiffness(self) -> float:
        """K [N/m^(3/2)]."""
        return 4.0 / 3.0 * self.modulus * np.sqrt(self.radius)

    @property
    def approach(self) -> float:
        """Largest approach [m]."""
        return (1.25 * self.mass * self.speed**2 / self.stiffness) ** 0.4

    @property
    def force(self) -> float:
        """Largest force [N]."""
        return self.stiffness * self.approach**1.5

    @property
    def duration(self) -> float:
        """Time [s] in contact."""
        return 0.8 * float(beta(0.4, 0.5)) * self.approach / self.speed

    @property
    def impulse(self) -> float:
        """int P dt [N s]: both speeds are reversed in the frame of the common centre of mass."""
        return 2.0 * self.mass * self.speed


@dataclass(frozen=True)
class BarImpact:
    """Two equal bars without lateral inertia: length L [m], area A [m2], relative speed v [m/s]."""

    material: Material
    length: float
    area: float
    speed: float

    @property
    def wave_speed(self) -> float:
        """c = sqrt(E/rho) [m/s]."""
        return float(np.sqrt(self.material.youngs_modulus / self.material.density))

    @property
    def duration(self) -> float:
        """Time [s] in contact, 2 L/c."""
        return 2.0 * self.length / self.wave_speed

    @property
    def stress(self) -> float:
        """Pressure [Pa] while in contact, rho c v/2."""
        return 0.5 * self.material.density * self.wave_speed * self.speed

    @property
    def force(self) -> float:
        """Force [N] while in contact."""
        return self.stress * self.area

    @property
    def impulse(self) -> float:
        """Impulse [N s]: the momentum of one bar, all of which is transferred."""
        return self.force * self.duration
