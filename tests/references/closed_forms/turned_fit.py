r"""A press fit under a torque that enters the shaft at one end of the fit and leaves the hub at the other: micro-slip.

Rotating a solid of revolution about its axis y displaces every ring by r psi without other strains, so that pressure
and torsion are decoupled. With the torques T_s(y) of the shaft and T_h = T - T_s of the hub, the fit from
y = 0, where T enters, to b, and the torque per length q = -T_s' transferred by the fit, at most m = 2 pi R^2 mu p,
sections rotate by phi' = T_s/(G_s J_s) and T_h/(G_h J_h). If the fit sticks both would rotate as one with

    T_s = k T,      k = G_s J_s/(G_s J_s + G_h J_h),

all of (1 - k) T transferred at y = 0 and the rest at b, each at a point. So slip would begin at both ends with the
torque. The shear of the rings prevents it: for the constant q of Saint-Venant's torsion, tau r^2 = q r^4/(4 J_s) in
the shaft and (q/2 pi) (r_o^4 - r^4)/(r_o^4 - R^4) in the hub, and psi' = tau/(G r) rotates the fit relative to the
section, whose rotation is the mean of psi with the weight r^3, the work-conjugate of the torque. It is ahead by c q,

    c_s = R^2/(24 G_s J_s),
    c_h = [r_o^4/2 (1/R^2 - 2/(r_o^2 + R^2)) - (r_o^6 - R^6)/(3 (r_o^4 - R^4)) + R^2/2]/(2 pi G_h (r_o^4 - R^4)).

With C = c_s + c_h, S = 1/(G_s J_s) + 1/(G_h J_h), x = T_s - k T and the relative rotation s of the sections, s' = -S x:

    stick  s = C q:    lambda^2 x'' = x,   lambda^2 = C/S;        slip  q = m:    x' = -m.

With slip zones of length a at the entry and c at the end, l = b - a - c between them, x is antisymmetric about the
middle of the sticking part, and with t = tanh(l/(2 lambda))

    (1 - k) T = m (a + lambda t),      k T = m (c + lambda t),      T = m (b - l + 2 lambda t),

full slip at T = m b. While k T < m lambda t the far end sticks, and x(b) = -k T replaces the second. Slip
begins at m lambda sinh(b/lambda)/((1 - k) cosh(b/lambda) + k). The shaft's end at 0 rotates relative to the hub's at b
by int T_s dy/(G_s J_s) + s(b), which for lambda = 0 is

    phi = T b/(G_s J_s + G_h J_h) + T^2/(2 m) ((1 - k)^2/(G_s J_s) + k^2/(G_h J_h)),

and in a cycle Masing's rule (`joints`): the bound is the same both ways.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import brentq

from references.closed_forms.joints import Masing, PressFit
from warpffrf.model.errors import InputError

Array = np.ndarray
SHORT = 1e-9  # of the fit: no part of it sticks
QUADRATURE = np.polynomial.legendre.leggauss(24)  # of the torque, in each of three parts of the loading


@dataclass(frozen=True)
class TurnedFit(Masing):
    """A press fit with a solid shaft under torsion; `loading` takes torques [N m] and returns angles [rad].

    Raises `InputError` for a hollow shaft, and for one that is stiffer than its hub; methods do for torques beyond
    that of full slip.
    """

    fit: PressFit

    def __post_init__(self) -> None:
        if self.fit.bore > 0.0:
            raise InputError("turned press fit: the closed form is that of a solid shaft; set bore to 0")
        if self.share > 0.5:
            raise InputError("turned press fit: the shaft is stiffer in torsion than the hub; make the hub thicker")

    @cached_property
    def _stiffness(self) -> tuple[float, float]:
        """G J [N m2] of shaft and hub."""
        R, out = self.fit.radius, self.fit.outer_radius
        hub = self.fit.hub or self.fit.shaft
        return self.fit.shaft.lame[1] * 0.5 * np.pi * R**4, hub.lame[1] * 0.5 * np.pi * (out**4 - R**4)

    @property
    def share(self) -> float:
        """k [-], fraction of the torque in the shaft if both stick."""
        shaft, hub = self._stiffness
        return shaft / (shaft + hub)

    @property
    def limit(self) -> float:
        """m [N], torque per length."""
        return self.fit.slip_torque / self.fit.width

    @cached_property
    def _yields(self) -> tuple[float, float]:
        """C [rad/N] and S [1/(N m2)]."""
        R, out = self.fit.radius, self.fit.outer_radius
        shaft, hub = self._stiffness
        D = out**4 - R**4
        ring = 0.5 * out**4 * (1.0 / R**2 - 2.0 / (out**2 + R**2)) - (out**6 - R**6) / (3.0 * D) + 0.5 * R**2
        return R**2 / (24.0 * shaft) + 0.25 * ring / hub, 1.0 / shaft + 1.0 / hub

    @property
    def decay(self) -> float:
        """lambda [m]."""
        C, S = self._yields
        return float(np.sqrt(C / S))

    @property
    def first_slip(self) -> float:
        """Torque [N m] at which the entry begins to slip."""
        z = self.fit.width / self.decay
        return self.limit * self.decay / ((1.0 - self.share) / np.tanh(z) + self.share / np.sinh(z))

    def zones(self, torque: float) -> tuple[float, float]:
        """Lengths a and c [m] of the slip zones at first loading, at the entry and at the other end."""
        T, m, k, b, decay = abs(torque), self.limit, self.share, self.fit.width, self.decay
        if T > m * b * (1.0 + 1e-12):
            raise InputError(f"turned press fit: all of it slips at {m * b:g} N m; lower the torque of {T:g} N m")
        if T <= self.first_slip:
            return 0.0, 0.0

        def both(sticks: float) -> float:
            return m * (b - sticks + 2.0 * decay * np.tanh(0.5 * sticks / decay)) - T

        if both(b) < 0.0:
            sticks = float(brentq(both, 0.0, b)) if both(0.0) > 0.0 else 0.0  # type: ignore[arg-type]
            carried = decay * np.tanh(0.5 * sticks / decay)
            if k * T >= m * carried:
                return float((1.0 - k) * T / m - carried), float(k * T / m - carried)

        def entry(a: float) -> float:
            z = (b - a) / decay
            return (1.0 - k) * T - m * a - m * decay * np.tanh(z) + k * T / np.cosh(z)

        return float(brentq(entry, 0.0, b)), 0.0  # type: ignore[arg-type]

    def slip(self, y: Array | float, torque: float) -> Array:
        """Slip [m] of the shaft's surface on the hub at y [m] from the entry, first loading; odd in the torque."""
        T, m, k, b = abs(torque), self.limit, self.share, self.fit.width
        a, c = self.zones(T)
        y = np.asarray(y, dtype=float)
        near, far = np.clip(a - y, 0.0, None), np.clip(y - (b - c), 0.0, None)
        entry = (1.0 - k) * T * near - 0.5 * m * near * (a + y)
        end = k * T * far - m * far * (c - 0.5 * far)
        return np.sign(torque) * self.fit.radius * self._yields[1] * np.where(y < a, entry, end)

    def loading(self, force: Array | float) -> Array:
        """Angle [rad] of the shaft's end relative to the hub's far end at first loading; odd in the torque."""
        torque = np.asarray(force, dtype=float)
        return np.sign(torque) * np.vectorize(self._angle, otypes=[float])(np.abs(torque))

    def carried(self, y: Array | float, torque: float) -> Array:
        """q [N], torque per length transferred at y [m] from the entry, first loading; at most `limit`;
        odd in the torque."""
        T, m, k, b, decay = abs(torque), self.limit, self.share, self.fit.width, self.decay
        a, c = self.zones(T)
        y = np.asarray(y, dtype=float)
        if b - a - c < SHORT * b:
            return np.sign(torque) * np.full_like(y, m)
        first, last = (1.0 - k) * T - m * a, m * c - k * T
        z, far = (y - a) / decay, (b - c - y) / decay
        with np.errstate(over="ignore"):  # in the slip zone
            sticks = (first * np.cosh(far) - last * np.cosh(z)) / (decay * np.sinh((b - a - c) / decay))
        return np.sign(torque) * np.where((z < 0.0) | (far < 0.0), m, sticks)

    def _angle(self, T: float) -> float:
        m, k, b, decay = self.limit, self.share, self.fit.width, self.decay
        a, c = self.zones(T)
        first, last = (1.0 - k) * T - m * a, m * c - k * T  # x at both ends of the sticking part
        sticks = decay * np.tanh(0.5 * (b - a - c) / decay) * (first + last)  # int x over it
        excess = a * (first + 0.5 * m * a) + sticks + c * (last - 0.5 * m * c)
        end = self._yields[0] * float(self.carried(b, T)) + float(self.slip(b, T)) / self.fit.radius
        return (k * T * b + excess) / self._stiffness[0] + end

    def cycle_loss(self, peak: float) -> float:
        """Work [J] lost in a cycle between -peak and peak [N m], by Masing's rule."""
        peak = abs(peak)
        if peak <= self.first_slip:
            return 0.0
        x, w = QUADRATURE
        edges = np.concatenate([[0.0], np.linspace(self.first_slip, peak, 3)])
        middle, half = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
        under = half @ self.loading(middle[:, None] + half[:, None] * x) @ w
        return 4.0 * peak * float(self.loading(peak)) - 8.0 * float(under)
