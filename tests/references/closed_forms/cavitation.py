r"""Films with rupture and reformation, with solutions by quadrature: a parabolic slider, plates with oscillating gap.

At zero pressure the film has a cavity volume D per area, so that h - D is oil (B. Jakobsson and L. Floberg,
Chalmers Tekniska Hoegskola 190, 1957; K.-O. Olsson 1965: mass is conserved at both ends of a cavity).

**Slider.** One surface slides with U over another at rest, h(x) between, so that the flux q = U h/2 - h^3/(12 mu) p' is
constant. The film ruptures at x_r, behind its narrowest point, where p = p' = 0, so that q = U h(x_r)/2; it reforms
at x_f > x_r, where p = 0 and p rises to the pressure at the outlet:

    p(x) = int 6 mu U (h(y) - h(x_r))/h(y)^3 dy,     from 0 to x_r, p(0) = p_in, and from x_f to L, p(L) = p_out.

**Plates** of half-width a, gap h(t), pressure p_a outside. While they separate the middle ruptures to |x| < s,

    p'' = 12 mu h'/h^3,     p(s) = p'(s) = 0,  p(a) = p_a:      a - s = root(p_a h^3/(6 mu h')),

as long as s grows. In the cavity the oil height stays h_r(x), the gap at rupture. When the front returns it
refills the cavity with the flux due to the pressure gradient there,

    -(h - h_r(s)) s' = h^3/(12 mu) p'(s),     p'(s) = p_a/(a - s) - 6 mu h' (a - s)/h^3.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import quad, solve_ivp
from scipy.optimize import root_scalar

from warpffrf.model.errors import InputError

Array = np.ndarray
NEAR = 1e-4  # of the length: distance from the narrowest point within which a front is sought
LEAST_VOID = 1e-9  # of the gap: the front starts to return from a cavity of this size


@dataclass(frozen=True)
class RupturedSlider:
    """Results: x_r, x_f [m] (x_f is the length if the film does not reform), flux q [m2/s], force [N/m]."""

    rupture: float
    refill: float
    flux: float
    force: float


def ruptured_slider(
    gap: Callable[[float], float], length: float, narrowest: float, *, viscosity: float, speed: float, inlet: float,
    outlet: float,
) -> RupturedSlider:  # fmt: skip
    """Slider with the gap h(x) [m] over [0, length], narrowest at x = `narrowest`; pressures [Pa] at both ends. Raises
    `InputError` if it does not rupture behind the narrowest point."""

    def slope(x: float, h_r: float) -> float:
        return 6.0 * viscosity * speed * (gap(x) - h_r) / gap(x) ** 3

    least = 1e-12 * 6.0 * viscosity * speed * length / gap(narrowest) ** 2  # Pa

    def rise(start: float, end: float, h_r: float) -> float:
        return quad(slope, start, end, args=(h_r,), epsrel=1e-10, epsabs=least, limit=200)[0]

    def rest(x: float) -> float:
        return inlet + rise(0.0, x, gap(x))

    low, high = narrowest + NEAR * length, length * (1.0 - NEAR)
    if rest(low) * rest(high) > 0.0:
        raise InputError("ruptured_slider: the film does not rupture behind its narrowest place")
    rupture = _root(rest, low, high, length)
    h_r = gap(rupture)
    refill = length
    if outlet > 0.0:
        refill = _root(lambda x: rise(x, length, h_r) - outlet, rupture + NEAR * length, length, length)
    # int p dx = p(end) x(end) - int x p' dx by parts, from 0 to x_r and from x_f to the end
    first = quad(lambda x: x * slope(x, h_r), 0.0, rupture, epsrel=1e-10, epsabs=least * length, limit=200)[0]
    last = quad(lambda x: x * slope(x, h_r), refill, length, epsrel=1e-10, epsabs=least * length, limit=200)[0]
    force = -first + (outlet * length - last if outlet > 0.0 else 0.0)
    return RupturedSlider(rupture, refill, 0.5 * speed * h_r, float(force))


def _root(f: Callable[[float], float], low: float, high: float, length: float) -> float:
    """Between `low` and `high` [m], to 1e-14 of the `length`."""
    return float(root_scalar(f, bracket=(low, high), xtol=1e-14 * length, method="brentq").root)


@dataclass(frozen=True)
class PartingPlates:
    """Plates h = mean + amplitude cos(2 pi t/T) [m] apart, half-width a [m], ambient p_a [Pa]."""

    half_width: float
    mean: float
    amplitude: float
    period: float
    viscosity: float
    ambient: float

    def gap(self, t: Array | float) -> Array:
        """h [m]."""
        return self.mean + self.amplitude * np.cos(2.0 * np.pi * np.asarray(t, dtype=float) / self.period)

    def rate(self, t: Array | float) -> Array:
        """h' [m/s]."""
        w = 2.0 * np.pi / self.period
        return -self.amplitude * w * np.sin(w * np.asarray(t, dtype=float))

    def opening(self, t: Array | float) -> Array:
        """s [m] of a growing cavity; 0 if there is none, or the plates approach."""
        h, v = self.gap(t), self.rate(t)
        with np.errstate(divide="ignore"):
            s = self.half_width - np.sqrt(self.ambient * h**3 / (6.0 * self.viscosity * np.maximum(v, 0.0)))
        return np.maximum(s, 0.0)

    def cavity(self, samples: int = 4001) -> tuple[Array, Array]:
        """Times [s] and half-widths s [m] of the cavity from its opening until it is filled, from t = T/2 on, when
        the plates are nearest and the film is full. Raises `InputError` if none opens."""
        t = np.linspace(0.5 * self.period, self.period, 20 * samples)
        s = self.opening(t)
        if not s.any():
            raise InputError("PartingPlates: the pressure outside keeps the film whole")
        first, last = int(np.flatnonzero(s > 0.0)[0]), int(np.argmax(s))
        t, s = t[first - 1 : last + 1], s[first - 1 : last + 1]
        opened, oil = s[1:], self.gap(t[1:])  # the gap when the front was at s, ascending in s

        def filling(time: float, place: Array) -> Array:
            h, left = float(self.gap(time)), self.half_width - place[0]
            slope = self.ambient / left - 6.0 * self.viscosity * float(self.rate(time)) * left / h**3
            void = max(h - float(np.interp(place[0], opened, oil)), LEAST_VOID * h)
            return np.array([-(h**3) / (12.0 * self.viscosity) * max(slope, 0.0) / void])

        def closed(time: float, place: Array) -> float:
            return float(place[0])

        closed.terminal = True  # type: ignore[attr-defined]
        found = solve_ivp(
            filling, (t[-1], 2.0 * self.period), [s[-1]], events=closed, rtol=1e-8, atol=1e-12 * self.half_width,
            method="LSODA", max_step=self.period / samples,
        )  # fmt: skip
        return np.concatenate([t, found.t[1:]]), np.concatenate([s, found.y[0, 1:]])
