r"""A cylinder sliding on a body of another material: asymmetric pressure (K. L. Johnson, Contact Mechanics, 8.1).

With the traction q = mu p on the first body over the whole patch, Dundurs' beta (`coupling_ratio`) and kappa = beta mu,
the slope of the closed gap, x/R, is that of the normal displacement:

    (1/pi) PV int p/(x - s) ds - kappa p = E* x/(2 R).

F(z) = (1/pi) int p/(z - s) ds jumps by -2 i p; the equation is F+ (1 - i kappa) + F- (1 + i kappa) = E* x/R, solved by

    F = (E*/(2 R)) (z - (z + b)^m (z - c)^(1 - m)),     m = 1/2 - arctan(kappa)/pi,
    p = (E*/(2 R sqrt(1 + kappa^2))) (b + x)^m (c - x)^(1 - m)      on -b < x < c.

F must decay as P'/(pi z): b m = c (1 - m) and (b + c)^2 = 4 P' R/(pi E* m (1 - m)).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.material import Material

Array = np.ndarray


def coupling_ratio(first: Material, second: Material | None = None) -> float:
    """Dundurs' beta [-] of two bodies in plane strain, E* ((1 - 2 nu1)/(4 G1) - (1 - 2 nu2)/(4 G2)); None: rigid."""
    direct, coupled = 0.0, 0.0
    for m, sign in ((first, 1.0), (second, -1.0)):
        if m is not None:
            direct += (1.0 - m.poisson_ratio) / (2.0 * m.lame[1])
            coupled += sign * (1.0 - 2.0 * m.poisson_ratio) / (4.0 * m.lame[1])
    return coupled / direct


@dataclass(frozen=True)
class SlidingLine:
    """load P' [N/m], effective radius R [m], modulus E* [Pa], beta [-] of the pair; mu [-], positive where the traction
    on the first body is along +x."""

    load: float
    radius: float
    modulus: float
    coupling: float
    friction: float

    @property
    def exponent(self) -> float:
        """m [-]."""
        return 0.5 - float(np.arctan(self.coupling * self.friction)) / np.pi

    @property
    def ends(self) -> tuple[float, float]:
        """-b and c [m] from the line where the undeformed surfaces touch."""
        m = self.exponent
        whole = np.sqrt(4.0 * self.load * self.radius / (np.pi * self.modulus * m * (1.0 - m)))
        return float(-(1.0 - m) * whole), float(m * whole)

    def pressure(self, x: Array) -> Array:
        """p [Pa] at x [m]."""
        low, high = self.ends
        m, kappa = self.exponent, self.coupling * self.friction
        scale = self.modulus / (2.0 * self.radius * np.hypot(1.0, kappa))
        inside = np.clip(np.asarray(x, dtype=float), low, high)
        return scale * (inside - low) ** m * (high - inside) ** (1.0 - m)
