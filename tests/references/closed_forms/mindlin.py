r"""Cattaneo's and Mindlin's tangential loading of a Hertz contact at constant normal load.

A tangential force Q < mu P causes slip at the edge. The traction is that of full slip over the patch (a) less the
same shape over the stick zone (c), whose displacements inside c are both parabolic and cancel (K. L. Johnson, Contact
Mechanics, 1985, sections 7.2 and 7.4):

    q = mu p0 (sqrt(1 - r^2/a^2) - (c/a) sqrt(1 - r^2/c^2)),      (c/a)^n = 1 - Q/(mu P),   n = 2 (line), 3 (point).

**Point.** With S = sum (2 - nu)/G over the bodies, backbone b(Q) = (3 mu P/(16 a)) S (1 - (1 - Q/(mu P))^(2/3)). The
slip of points off the direction of Q, of order nu/(4 - 2 nu) of the main one, is neglected, as in the sources.

**Line.** Under a Hertz-shaped traction of half-width a and resultant P the middle moves by
2 P/(pi E*) (ln(2 L/a) + 1/2) against a point at the depth L. Resultants are mu P and mu P c^2/a^2 = mu P - Q:

    b(Q) = (2/(pi E*)) (Q (ln(2 L/a) + 1/2) + (mu P - Q)/2 ln(1 - Q/(mu P))).

**Unloading and cycles.** From (Q1, d1) the reverse slip again begins at the edge and acts against twice the bound:
d = d1 - 2 b((Q1 - Q)/2). A cycle between -Q1 and Q1 therefore encloses 4 Q1 b(Q1) - 8 int_0^Q1 b dQ; linear
parts of b do not contribute, so that the depth L is irrelevant:

    point:  (9 mu^2 P^2/(10 a)) S (1 - (1 - q)^(5/3) - (5 q/6)(1 + (1 - q)^(2/3))),      q = Q1/(mu P)
    line:   ((mu P)^2/(pi E*)) (4 y ln y + 2 (1 - y^2)),                                  y = 1 - q.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from scipy.special import xlog1py, xlogy

from references.closed_forms.hertz import LineContact, PointContact
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material

Array = np.ndarray


def tangential_compliance(first: Material, second: Material | None = None) -> float:
    """S = sum (2 - nu)/G [1/Pa] of two bodies; `second` None: rigid."""
    bodies = [first] if second is None else [first, second]
    return sum((2.0 - m.poisson_ratio) / m.lame[1] for m in bodies)


class _Mindlin(ABC):
    """Common part of line and point contact: traction and cycles from the stick ratio and the backbone b(Q)."""

    power: int
    contact: LineContact | PointContact
    friction: float

    @property
    def limit(self) -> float:
        """mu P, the force of full slip [N or N/m]."""
        return self.friction * self.contact.load

    def _share(self, force: Array | float) -> Array:
        q = np.asarray(force, dtype=float) / self.limit
        if np.any(np.abs(q) > 1.0):
            raise InputError(f"tangential force beyond mu P = {self.limit:g}: it slips as a whole, lower the force")
        return q

    def stick_ratio(self, force: float) -> float:
        """c/a at the first loading to `force`."""
        return float((1.0 - abs(self._share(force))) ** (1.0 / self.power))

    def traction(self, r: Array, force: float) -> Array:
        """q [Pa] at the distance r [m] from the middle, first loading to `force`."""
        k = self.stick_ratio(force)
        inner = self.friction * k * self.contact.pressure(np.asarray(r) / k) if k > 0.0 else 0.0
        return np.sign(force) * (self.friction * self.contact.pressure(np.asarray(r)) - inner)

    @abstractmethod
    def loading(self, force: Array | float) -> Array:
        """b(Q), displacement [m] at first loading; odd in Q."""

    def unloading(self, force: Array | float, peak: float) -> Array:
        """Displacement [m] at `force` during unloading from `peak`."""
        return self.loading(peak) - 2.0 * self.loading(0.5 * (peak - np.asarray(force)))

    def reloading(self, force: Array | float, peak: float) -> Array:
        """Displacement [m] at `force` during reloading from `-peak`."""
        return -self.unloading(-np.asarray(force), peak)


@dataclass(frozen=True)
class MindlinPoint(_Mindlin):
    """contact: Hertz; friction mu [-]; compliance S = sum (2 - nu)/G [1/Pa]."""

    contact: PointContact
    friction: float
    compliance: float
    power = 3

    def loading(self, force: Array | float) -> Array:
        """b(Q) [m]; odd in Q."""
        q = self._share(force)
        scale = 3.0 * self.limit / (16.0 * self.contact.half_width) * self.compliance
        return scale * np.sign(q) * (1.0 - (1.0 - np.abs(q)) ** (2.0 / 3.0))

    def cycle_loss(self, peak: float) -> float:
        """Work [J] lost in a cycle between -peak and peak [N]."""
        q = abs(self._share(peak))
        scale = 0.9 * self.limit**2 / self.contact.half_width * self.compliance
        return float(scale * (1.0 - (1.0 - q) ** (5.0 / 3.0) - 5.0 * q / 6.0 * (1.0 + (1.0 - q) ** (2.0 / 3.0))))


@dataclass(frozen=True)
class MindlinLine(_Mindlin):
    """contact: Hertz, like materials (its modulus is E*); friction mu [-]; depth L [m] of the fixed point."""

    contact: LineContact
    friction: float
    depth: float
    power = 2

    def loading(self, force: Array | float) -> Array:
        """b(Q) [m]; odd in Q."""
        q = np.abs(self._share(force))
        linear = np.log(2.0 * self.depth / self.contact.half_width) + 0.5
        scale = 2.0 * self.limit / (np.pi * self.contact.modulus)
        return scale * np.sign(force) * (q * linear + 0.5 * xlog1py(1.0 - q, -q))

    def cycle_loss(self, peak: float) -> float:
        """Work [J/m] lost in a cycle between -peak and peak [N/m]."""
        y = 1.0 - abs(float(self._share(peak)))
        return float(self.limit**2 / (np.pi * self.contact.modulus) * (4.0 * xlogy(y, y) + 2.0 * (1.0 - y * y)))
