r"""Carter's steady rolling of two identical cylinders with friction (F. W. Carter, Proc. R. Soc. A 112, 1926, 151).

The patch |x| <= a is fixed, material flows through it from the leading edge x = a to the trailing one x = -a. Material
sticks on entry, so that the stick zone a - 2 c <= x <= a touches the leading edge (K. L. Johnson, Contact
Mechanics, 1985, section 8.3):

    q = mu p0 (sqrt(1 - x^2/a^2) - (c/a) sqrt(1 - (x - d)^2/c^2)),     d = a - c,     (c/a)^2 = 1 - Q/(mu P).

Both parts stretch the surfaces uniformly in the stick zone; the remaining relative strain is the creepage, the
difference of the surface speeds over the rolling speed, with R the effective radius:

    xi = (mu a/R)(1 - c/a).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from references.closed_forms.hertz import LineContact
from warpffrf.model.errors import InputError

Array = np.ndarray


@dataclass(frozen=True)
class CarterRolling:
    """contact: Hertz, like materials; friction mu [-]; creepage xi [-], positive where the traction is."""

    contact: LineContact
    friction: float
    creepage: float

    @classmethod
    def from_share(cls, contact: LineContact, friction: float, share: float) -> CarterRolling:
        """The state at Q/(mu P) = share in [-1, 1]; InputError beyond."""
        if not abs(share) <= 1.0:
            raise InputError(f"share of the friction force must lie in [-1, 1], got {share:g}")
        most = friction * contact.half_width / contact.radius
        return cls(contact, friction, float(np.sign(share) * most * (1.0 - np.sqrt(1.0 - abs(share)))))

    @property
    def saturation(self) -> float:
        """mu a/R, the creepage at which all of the patch slips."""
        return self.friction * self.contact.half_width / self.contact.radius

    @property
    def stick_ratio(self) -> float:
        """c/a."""
        return max(0.0, 1.0 - abs(self.creepage) / self.saturation)

    @property
    def share(self) -> float:
        """Q/(mu P), with the sign of the creepage."""
        return float(np.sign(self.creepage)) * (1.0 - self.stick_ratio**2)

    @property
    def force(self) -> float:
        """Q [N/m]."""
        return self.share * self.friction * self.contact.load

    @property
    def stick_end(self) -> float:
        """a - 2 c [m], where slip begins; the stick zone extends from there to the leading edge a."""
        return self.contact.half_width * (1.0 - 2.0 * self.stick_ratio)

    def traction(self, x: Array) -> Array:
        """q [Pa] at x [m], leading edge at x = a."""
        x, a, k = np.asarray(x, dtype=float), self.contact.half_width, self.stick_ratio
        inner = k * self.contact.pressure((x - a * (1.0 - k)) / k) if k > 0.0 else 0.0
        return np.sign(self.creepage) * self.friction * (self.contact.pressure(x) - inner)
