r"""Films with closed forms: bearings long and short, sliders, squeezed plates, a cylinder on a plane.

Viscosity mu [Pa s], speed U [m/s] of one surface along the other at rest, clearance c, radius R, length L (along
the axis, or across the sliding) [m], eccentricity ratio eps.

    long bearing, whole film    W = mu U L (R/c)^2 12 pi eps/((2 + eps^2) sqrt(1 - eps^2)),  across the line of centres
                                (A. Sommerfeld, Z. Math. Phys. 50, 1904, 97)
    short bearing, half a film  W = mu U L^3/c^2 eps sqrt(pi^2 (1 - eps^2) + 16 eps^2)/(4 (1 - eps^2)^2),
                                tan(attitude) = pi sqrt(1 - eps^2)/(4 eps)     (F. W. Ocvirk, NACA TN 2808, 1952)
    plane slider                W = 6 mu U B^2 L/h_0^2 (ln K - 2 (K - 1)/(K + 1))/(K - 1)^2,   K inlet over outlet h_0
    cylinder on a plane         W/L = 4 mu u R/h_0 half the film, 4.894968 with dp/dx = 0 at the end; u mean speed
                                (H. M. Martin, Engineering 102, 1916, 119)
    disc squeezed               F = 3 pi mu R^4 V/(2 h^3)          (J. Stefan, Wien. Ber. 69, 1874, 713)
    long plate                  F = mu L B^3 V/h^3
    rectangular plate a x b     F = 12 mu V/h^3 sum (64/pi^4) a b/(m^2 n^2 pi^2 (m^2/a^2 + n^2/b^2)),  m, n odd
    under a constant force      1/h^2 = 1/h_1^2 + 2 F t/(F h^3/V)

The half-film forces of the short bearing in motion, with e = c eps along the line of centres, which rotates by phi, and
the shaft by omega, radial and transverse, on the shaft (J. F. Booker, J. Basic Eng. 87, 1965, 537):

    F_r = -(mu R L^3/(2 c^2)) (2 eps^2 (omega - 2 phi')/(1 - eps^2)^2 + pi eps' (1 + 2 eps^2)/(1 - eps^2)^(5/2))
    F_t = +(mu R L^3/(2 c^2)) (pi eps (omega - 2 phi')/(2 (1 - eps^2)^(3/2)) + 4 eps eps'/(1 - eps^2)^2)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.errors import InputError

Array = np.ndarray
TERMS = 400  # of each index of the double series: its rest is 1e-6 of the sum
REYNOLDS_CYLINDER, HALF_CYLINDER = 4.894968, 4.0


def _ratio(value: float) -> float:
    if not 0.0 <= value < 1.0:
        raise InputError(f"eccentricity ratio must lie in [0, 1), got {value:g}")
    return float(value)


@dataclass(frozen=True)
class JournalBearing:
    """radius, length, clearance [m], viscosity [Pa s], speed of the shaft's surface [m/s]."""

    radius: float
    length: float
    clearance: float
    viscosity: float
    speed: float

    def long(self, eccentricity: float) -> float:
        """Force [N] of a whole film without end flow or cavitation, perpendicular to the line of centres."""
        eps = _ratio(eccentricity)
        scale = self.viscosity * self.speed * self.length * (self.radius / self.clearance) ** 2
        return scale * 12.0 * np.pi * eps / ((2.0 + eps**2) * np.sqrt(1.0 - eps**2))

    def short(self, eccentricity: float) -> tuple[float, float]:
        """Force [N] and attitude [rad], between the load and the line of centres, of a short bearing at rest."""
        radial, across = self.short_forces(eccentricity, 0.0, 0.0)
        return float(np.hypot(radial, across)), float(np.arctan2(across, -radial))

    def short_forces(self, eccentricity: float, rate: float, turning: float) -> tuple[float, float]:
        """F_r, F_t [N] on the shaft; rate eps' and rotation phi' [1/s]."""
        eps = _ratio(eccentricity)
        g, omega = 1.0 - eps**2, self.speed / self.radius
        scale = self.viscosity * self.radius * self.length**3 / (2.0 * self.clearance**2)
        entrained = omega - 2.0 * turning
        radial = 2.0 * eps**2 * entrained / g**2 + np.pi * rate * (1.0 + 2.0 * eps**2) / g**2.5
        across = np.pi * eps * entrained / (2.0 * g**1.5) + 4.0 * eps * rate / g**2
        return -scale * radial, scale * across


def stability_threshold(K: Array, D: Array) -> tuple[float, float]:
    """Largest m c omega^2/W of a mass on a bearing, and its whirl there over omega; K (2, 2), D (2, 2): derivatives of
    -F by position and velocity, times c/W and c omega/W.

    The characteristic polynomial of M s^2 + D s + K has a root i gamma where

        k = (K_xx D_yy + K_yy D_xx - K_xy D_yx - K_yx D_xy)/(D_xx + D_yy),
        gamma^2 = ((K_xx - k)(K_yy - k) - K_xy K_yx)/(D_xx D_yy - D_xy D_yx),      M = k/gamma^2.
    """
    k = (K[0, 0] * D[1, 1] + K[1, 1] * D[0, 0] - K[0, 1] * D[1, 0] - K[1, 0] * D[0, 1]) / (D[0, 0] + D[1, 1])
    whirl = ((K[0, 0] - k) * (K[1, 1] - k) - K[0, 1] * K[1, 0]) / (D[0, 0] * D[1, 1] - D[0, 1] * D[1, 0])
    return float(k / whirl), float(np.sqrt(whirl))


def short_bearing_coefficients(eccentricity: float) -> tuple[Array, Array]:
    """K, D of `stability_threshold`, of a half film: along (0) and across (1) the line of centres.

    With g = 1 - eps^2 and F in units of mu R L^3 omega/(2 c^2), F_r = -2 eps^2/g^2 and F_t = pi eps/(2 g^1.5) at rest;
    a rotation of the line of centres rotates the force with it.
    """
    eps = _ratio(eccentricity)
    g = 1.0 - eps**2
    K = np.array([
        [4.0 * eps * (1.0 + eps**2) / g**3, 0.5 * np.pi / g**1.5],
        [-0.5 * np.pi * (1.0 + 2.0 * eps**2) / g**2.5, 2.0 * eps / g**2],
    ])  # fmt: skip
    cross = -4.0 * eps / g**2
    D = np.array([[np.pi * (1.0 + 2.0 * eps**2) / g**2.5, cross], [cross, np.pi / g**1.5]])
    load = np.hypot(2.0 * eps**2 / g**2, 0.5 * np.pi * eps / g**1.5)
    return K / load, D / load


def plane_slider(inlet: float, outlet: float, breadth: float, *, viscosity: float, speed: float) -> float:
    """Force per length [N/m] of a plane slider of `breadth` B along the sliding; inlet > outlet [m]."""
    K = inlet / outlet
    if K <= 1.0:
        raise InputError(f"plane_slider: the film must narrow, got {inlet:g} at the inlet and {outlet:g} at the outlet")
    shape = (np.log(K) - 2.0 * (K - 1.0) / (K + 1.0)) / (K - 1.0) ** 2
    return float(6.0 * viscosity * speed * breadth**2 / outlet**2 * shape)


def squeezed_plate(a: float, b: float) -> float:
    """F h^3/(mu V) [m4] of a rectangular plate a x b [m]."""
    odd = np.arange(1, TERMS, 2, dtype=float)
    m, n = odd[:, None], odd[None, :]
    terms = 1.0 / (m**2 * n**2 * (m**2 / a**2 + n**2 / b**2))
    return float(12.0 * 64.0 / np.pi**6 * a * b * terms.sum())


def squeezed_disc(radius: float) -> float:
    """F h^3/(mu V) [m4] of a disc."""
    return 1.5 * np.pi * radius**4


def falling_time(shape: float, force: float, viscosity: float, start: float, end: float) -> float:
    """Time [s] in which a plate falls from `start` to `end` [m] under `force` [N]; shape: F h^3/(mu V) [m4]."""
    return float(shape * viscosity / (2.0 * force) * (1.0 / end**2 - 1.0 / start**2))


def adiabatic_rise(mu: float, speed: float, breadth: float, inlet: float, outlet: float, capacity: float) -> float:
    """Rise of the temperature [K] along a wide plane slider with adiabatic walls and constant viscosity: the heat of
    shear and of the flow by pressure over the capacity rho c [J/(m3 K)] of the oil that flows,

        [int mu U^2/h + h^3 p'^2/(12 mu) dx]/(rho c q),   p' = 6 mu U (h - h_m)/h^3,  q = U h_m/2,

    h_m the gap at the largest pressure."""
    x, w = np.polynomial.legendre.leggauss(32)
    h = inlet + (outlet - inlet) * 0.5 * (x + 1.0)
    w = 0.5 * breadth * w
    h_m = float(w @ h**-2.0 / (w @ h**-3.0))
    slope = 6.0 * mu * speed * (h - h_m) / h**3
    return float(w @ (mu * speed**2 / h + h**3 * slope**2 / (12.0 * mu)) / (capacity * 0.5 * speed * h_m))


def couette_stress(brinkman: float) -> float:
    """Shear stress over mu_0 U/h of Couette flow between walls of one temperature, viscosity mu_0 exp(-beta (T - T_w)):

        arsinh(b)/(b sqrt(1 + b^2)),   b^2 = Br/8,   Br = beta mu_0 U^2/k       (S. Nahme, Ing.-Arch. 11, 1940, 191)

    With one adiabatic wall it is half of a flow of twice the gap and speed: Br is four times as large."""
    b = np.sqrt(brinkman / 8.0)
    return float(np.arcsinh(b) / (b * np.sqrt(1.0 + b * b)))
