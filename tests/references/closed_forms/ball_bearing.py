r"""Rigid-ring ball bearings by the equations of ISO/TS 16281:2008, solved by root finding.

With the groove radii r_i, r_e, A = r_i + r_e - D, the free contact angle cos alpha_0 = 1 - s/(2 A) of a diametral
clearance s, and R_i = d_pw/2 + (r_i - D/2) cos alpha_0, the deflection and load of a ball at the angle phi from the
radial load are

    X = A cos alpha_0 + delta_r cos phi,      Y = A sin alpha_0 + delta_a + R psi cos phi,
    delta = sqrt(X^2 + Y^2) - A,              Q = c_P delta^1.5,    tan alpha = Y/X,

and sum Q cos alpha cos phi = F_r, sum Q sin alpha = F_a, sum Q sin alpha cos phi = 0 for a ring that tilts freely. The
lever R of the tilt psi is R_i; a published program uses d_pw/2. c_P is that of both contacts in series, by Hertz's
formulas in complete elliptic integrals.

**Exact kinematics.** The equations are of first order in the tilt and in the transverse motion of the inner ring. In
`exact` the circle of the inner groove centres is translated and rotated as a whole and intersected with the meridian
plane of each ball; the potential sum (2/5) c_P delta^(5/2) less the work of the loads is made stationary.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq, root
from scipy.special import ellipe, ellipk

STEP = 1e-8, 1e-8, 1e-6  # of the differences of the potential: m, m, rad


@dataclass(frozen=True)
class BallBearing:
    """`count` balls of `diameter` on `pitch` [m], groove radii `inner`, `outer` [m], diametral `clearance` [m], modulus
    E [Pa], Poisson ratio nu."""

    count: int
    diameter: float
    pitch: float
    inner: float
    outer: float
    clearance: float
    youngs_modulus: float
    poisson_ratio: float = 0.3

    @property
    def angles(self) -> np.ndarray:
        return 2.0 * np.pi * np.arange(self.count) / self.count

    @property
    def reach(self) -> float:
        return self.inner + self.outer - self.diameter

    @property
    def free_angle(self) -> float:
        return float(np.arccos(1.0 - self.clearance / (2.0 * self.reach)))

    @property
    def lever(self) -> float:
        """R_i [m]."""
        return 0.5 * self.pitch + (self.inner - 0.5 * self.diameter) * float(np.cos(self.free_angle))

    def one_contact(self, groove: float, sign: float) -> float:
        """K [N/m^1.5] of a ball on a raceway, sign +1 of the inner one: Hertz with chi = a/b > 1 from

        1 - (2/(chi^2 - 1)) (K(chi)/E(chi) - 1) = (difference over sum of the relative curvatures)."""
        gamma = self.diameter / self.pitch
        small = 2.0 / self.diameter - 1.0 / groove
        large = 2.0 / self.diameter * (1.0 + sign * gamma / (1.0 - sign * gamma))
        wanted = (large - small) / (large + small)

        def lacking(chi: float) -> float:
            m = 1.0 - chi**-2
            return 1.0 - 2.0 / (chi**2 - 1.0) * (float(ellipk(m)) / float(ellipe(m)) - 1.0) - wanted

        chi: Any = brentq(lacking, 1.0 + 1e-6, 1e3)
        m, total = 1.0 - chi**-2, small + large
        modulus = 0.5 * self.youngs_modulus / (1.0 - self.poisson_ratio**2)
        star = 2.0 * ellipk(m) / np.pi * (np.pi / (2.0 * chi**2 * ellipe(m))) ** (1.0 / 3.0)
        return float((2.0 / (star * total)) ** 1.5 * 2.0 * total * modulus / 3.0)

    @property
    def stiffness(self) -> float:
        """c_P [N/m^1.5]."""
        both = self.one_contact(self.inner, 1.0), self.one_contact(self.outer, -1.0)
        return float(sum(k ** (-2.0 / 3.0) for k in both) ** -1.5)

    def balls(self, X: np.ndarray, Y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Loads [N] and contact angles [rad] (count,)."""
        depth = np.maximum(np.hypot(X, Y) - self.reach, 0.0)
        return self.stiffness * depth**1.5, np.arctan2(Y, X)

    def solve(
        self, radial: float, axial: float, guess: tuple[float, float, float], *, tilts: bool, lever: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """(delta_r, delta_a from the middle [m], psi [rad]) and loads (count,) [N] under forces [N]; lever: R [m]."""
        a0, phi = self.free_angle, self.angles

        def taken(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            X = self.reach * np.cos(a0) + x[0] * np.cos(phi)
            return self.balls(X, x[1] + lever * x[2] * np.cos(phi))

        def lacking(x: np.ndarray) -> list[float]:
            Q, alpha = taken(x)
            across = np.sum(Q * np.sin(alpha) * np.cos(phi)) if tilts else 1e6 * x[2]
            return [np.sum(Q * np.cos(alpha) * np.cos(phi)) - radial, np.sum(Q * np.sin(alpha)) - axial, across]

        found = root(lacking, guess, tol=1e-13)
        return found.x, taken(found.x)[0]

    def exact(self, radial: float, axial: float, guess: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
        """The same for a ring that tilts freely, by exact kinematics."""
        outer = 0.5 * self.pitch - (self.outer - 0.5 * self.diameter) * np.cos(self.free_angle)

        def taken(x: np.ndarray) -> np.ndarray:
            c, s, places = np.cos(x[2]), np.sin(x[2]), []
            for phi in self.angles:

                def point(t: float) -> np.ndarray:
                    across = self.lever * np.cos(t)
                    return np.array([c * across + x[0], self.lever * np.sin(t), s * across + x[1]])

                def off(t: float, phi: float = phi) -> float:
                    return float(point(t)[1] * np.cos(phi) - point(t)[0] * np.sin(phi))

                t: Any = brentq(off, phi - 0.2, phi + 0.2, xtol=1e-15)
                P = point(t)
                places.append((P[0] * np.cos(phi) + P[1] * np.sin(phi) - outer, P[2]))
            return self.balls(*np.array(places).T)[0]

        def potential(x: np.ndarray) -> float:
            Q = taken(x)
            return float(0.4 * np.sum(Q * (Q / self.stiffness) ** (2.0 / 3.0))) - radial * x[0] - axial * x[1]

        def slopes(x: np.ndarray) -> list[float]:
            steps = np.diag(STEP)
            return [
                (potential(x + h) - potential(x - h)) / (2.0 * h.max()) * w
                for h, w in zip(steps, (1, 1, 10), strict=True)
            ]

        found = root(slopes, guess, tol=1e-10)
        return found.x, taken(found.x)
