r"""Large deflections: a cantilever, vibration of a pinned beam, clamped plates, a stretched bar.

**Elastica** (K. E. Bisshopp and D. C. Drucker, Q. Appl. Math. 3 (1945) 272). An inextensible cantilever, EI
along L, bends under a dead force P across its tip: EI theta'' = -P cos theta, theta(0) = 0, theta'(L) = 0. With theta_0
at the tip, k^2 = (1 + sin theta_0)/2 and sin phi = 1/(k sqrt 2)

    sqrt(P L^2/EI) = K(k) - F(phi, k),
    w/L = 1 - 2 (E(k) - E(phi, k))/sqrt(P L^2/EI),        1 - u/L = sqrt(2 sin theta_0/(P L^2/EI)),

w the tip's displacement along the force, u that towards the root.

**Pinned beam** (S. Woinowsky-Krieger, J. Appl. Mech. 17 (1950) 35). Both ends are fixed at distance L, so the first
mode A sin(pi x/L) stretches the beam by (pi A/2 L)^2: with r the radius of gyration, x'' + w0^2 (x + x^3/(4 r^2)) = 0,

    f/f0 = pi sqrt(1 + b)/(2 K(m)),      b = (A/r)^2/4,      m = b/(2 (1 + b)).

**Clamped square plate** (S. Levy, NACA Report 740 (1942), table of centre deflections). Pressure q, edge a, thickness
t, nu = 0.316; the edges are fixed but free to move in their own direction; his error is at most 2 %.

**Clamped square plate that vibrates** (N. Yamaki, Z. angew. Math. Mech. 41 (1961) 501: one term, Duffing's equation).
With w = (A/4)(1 + cos kx)(1 + cos ky), k = 2 pi/a, and the same edges as Levy's, the energies of bending and stretching
are, D = E t^3/(12 (1 - nu^2)),

    V_b = pi^4 D A^2/a^2,        V_m = 16 pi^4 E t A^4/a^2 (S/512 + 9/(16384 (1 - nu))),

the last part of the mean strains <w_x^2>/2 = 3 k^2 A^2/128, the first of Airy's function, whose Laplacian solves
small-sliding contact small-sliding contact F = E (w_xy^2 - w_xx w_yy) term by term: S = sum c_mn^2/(m^2 + n^2)^2 <cos^2
mkx cos^2 nky> over c_11 = 1, c_10 = c_01 = c_12 = c_21 = c_20 = c_02 = 1/2 is 0.333125. The frequency is that of the
pinned beam with b = 2 V_m/V_b. As the shape becomes flatter at large amplitudes the one term is too stiff there.

**Bar** of St. Venant-Kirchhoff's material, stretched to L (1 + e), free to contract. The transverse stress S is zero
if the transverse strain is -nu E, so that S = E_Y E along it, E = e + e^2/2, and the force on its undeformed section is

    P = A E_Y (1 + e) (e + e^2/2),      its least, a limit point, at 1 + e = 1/sqrt 3:  P = -A E_Y/(3 sqrt 3).

A bar with fixed width has M = E_Y (1 - nu)/((1 + nu)(1 - 2 nu)) instead of E_Y.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

from warpffrf.model.errors import require_number

STEEPEST = 0.5 * np.pi - 1e-9  # rad, of the tip of a cantilever: pi/2 requires an infinite force
LIMIT_STRETCH = 1.0 / np.sqrt(3.0)
# of the plate: q a^4/(E t^4) -> w/t at its centre
LEVY_CLAMPED_SQUARE = {
    17.79: 0.237,
    38.3: 0.471,
    63.4: 0.695,
    95.0: 0.912,
    134.9: 1.121,
    184.0: 1.323,
    245.0: 1.521,
    318.0: 1.714,
    402.0: 1.902,
}
LEVY_POISSON = 0.316
ONE_TERM = 0.333125  # S of the vibrating plate
CLAMPED_SQUARE = (
    35.985  # omega_1 a^2 sqrt(rho t/D) of a clamped square plate (A. W. Leissa, NASA SP-160 (1969), table 4.22)
)


@dataclass(frozen=True)
class Elastica:
    """A cantilever under a dead force across its tip; `load` P L^2/(E I). Raises `InputError` for a load not above
    zero."""

    load: float

    def __post_init__(self) -> None:
        require_number(self.load, "elastica: load", positive=True)

    @cached_property
    def tip_angle(self) -> float:
        """theta_0 [rad]."""

        def excess(angle: float) -> float:
            m, phi = self._modulus(angle)
            return float(ellipk(m) - ellipkinc(phi, m)) - np.sqrt(self.load)

        return float(brentq(excess, 0.0, STEEPEST, xtol=1e-15, rtol=1e-14))  # type: ignore[arg-type]

    @property
    def deflection(self) -> float:
        """w/L, the displacement of the tip along the force."""
        m, phi = self._modulus(self.tip_angle)
        return float(1.0 - 2.0 * (ellipe(m) - ellipeinc(phi, m)) / np.sqrt(self.load))

    @property
    def shortening(self) -> float:
        """u/L, the displacement of the tip towards the root."""
        return float(1.0 - np.sqrt(2.0 * np.sin(self.tip_angle) / self.load))

    @staticmethod
    def _modulus(angle: float) -> tuple[float, float]:
        """k^2 and phi."""
        m = 0.5 * (1.0 + np.sin(angle))
        return m, float(np.arcsin(1.0 / np.sqrt(2.0 * m)))


def pinned_beam_frequency(amplitude: float) -> float:
    """f/f0 of the first mode at an `amplitude` A/r, r the radius of gyration of the section."""
    return _duffing(0.25 * require_number(amplitude, "pinned beam: amplitude") ** 2)


def clamped_plate_frequency(amplitude: float, poisson: float) -> float:
    """f/f0 of the first mode of a clamped square plate at an `amplitude` A/t of its centre, by one term."""
    stretching = ONE_TERM / 512.0 + 9.0 / (16384.0 * (1.0 - poisson))
    ratio = 192.0 * (1.0 - poisson**2) * stretching * require_number(amplitude, "clamped plate: amplitude") ** 2
    return _duffing(2.0 * ratio)


def _duffing(b: float) -> float:
    """f/f0 of x'' + x + b x^3 = 0 from x = 1."""
    return float(np.pi * np.sqrt(1.0 + b) / (2.0 * ellipk(0.5 * b / (1.0 + b))))


def bar_force(strain: np.ndarray | float) -> np.ndarray:
    """P/(A E_Y) of a bar stretched to 1 + `strain` times its length."""
    e = np.asarray(strain, dtype=float)
    return (1.0 + e) * (e + 0.5 * e**2)
