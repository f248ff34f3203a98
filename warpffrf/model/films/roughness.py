r"""Rough walls of a film: flow factors of Patir and Cheng (J. Lubr. Tech. 100, 1978, 12; 101, 1979, 220).

Walls A and B have Gaussian heights of the deviations s_A, s_B, s^2 = s_A^2 + s_B^2, and a pattern gamma each, the
length of its correlation around over that along: below 1 ridges lie along, across the sliding, above 1 they run around.
With the gap h between the mean planes, H = h/s, and the sliding v = u_B - u_A, the mean flow of oil is, around,

    q = (v/2)(h - l) - phi_p h^3/(12 mu) p_x,      l = s [(s_A/s)^2 Phi_s(H, gamma_A) - (s_B/s)^2 Phi_s(H, gamma_B)],
    phi_p = 1 - C exp(-r H)  or, of gamma > 1,  1 + C H^-r,
    Phi_s = A_1 H^a_1 exp(-a_2 H + a_3 H^2) up to H = 5,  A_2 exp(-H/4) beyond,

and along the same with 1/gamma. The flow by pressure of two patterns is phi_p = sum_i (s_i/s)^2 phi_p(H, gamma_i), as
roughness of small slope and height has it to second order. The *lag* l is the reduction of transport by valleys: those
of the wall A, at rest here, retain oil, those of B transport more.

**Shear.** The shear follows from the condition that the work done on both walls equals the heat
(`warpffrf_kernels.films.sampling`). The power of the pressure, int p h' dA = int (v/2)(h - l) p_x dA - int phi_p k
p_x^2 dA + (feeds), leaves losses none of which is negative with the force on A

    tau = Phi mu v/h + ((h - l)/2) p_x,      Phi >= 0.

So the pressure-driven shear is determined by the flow (Onsager's reciprocity). It is the total tangential force,
including pressures on the flanks of ridges, equal on both walls. For a smooth wall B it is the shear alone, that of the
paper's phi_fp = 1 - l/h, whose own fit, 1 - 1.4 exp(-0.66 H) for gamma = 1, is within 0.02 of this from H = 2 on (0.07
at 1). The sliding contributes

    Phi = phi_f + sum_i (s_i/s)^2 Phi_fs(H, gamma_i),      phi_f = h E[1/h_local],
    Phi_fs = A_3 H^a_4 exp(-a_5 H + a_6 H^2) up to H = 7, and as H^-2 beyond,

where the paper uses the difference of both walls' Phi_fs for the shear of one wall; including flank pressures it is the
sum, their loss int k |grad p_local|^2 dA. phi_f is that of the paper: heights with the density (35/96)(1 - (x/3)^2)^3,
x = height/s, and no oil where the local gap is below s/100.

**Range.** The fits hold for H >= `LEAST`, 0.5 for most gamma: below, phi_p keeps its value, and below H = 1 l is a
constant fraction of h. The oil in the film is taken as h, although walls in contact hold more, 0.4 % at H = 2, 8 % at H
= 1: the pressure then acts on the whole area, as that of asperities does, and power and oil are conserved. Between the
gammas of the paper, factors are interpolated in ln gamma. Of the coefficients of Phi_fs only those of gamma = 1 were
checked against a second source; phi_p and Phi_s were also checked against the theory of small heights.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.laws import Law, as_law
from warpffrf.model.messages.named_arguments import named_arguments

Array = np.ndarray

PATTERNS = np.array([1 / 9, 1 / 6, 1 / 3, 1.0, 3.0, 6.0, 9.0])
LEAST = np.array([1.0, 1.0, 0.75, 0.5, 0.5, 0.5, 0.5])  # H: down to where the fit of phi_p holds
FLOW = np.array([  # C, r
    [1.48, 0.42], [1.38, 0.42], [1.18, 0.42], [0.90, 0.56], [0.225, 1.5], [0.520, 1.5], [0.870, 1.5],
])  # fmt: skip
LAG = np.array([  # A_1, a_1, a_2, a_3, A_2
    [2.046, 1.12, 0.78, 0.03, 1.856], [1.962, 1.08, 0.77, 0.03, 1.754], [1.858, 1.01, 0.76, 0.03, 1.561],
    [1.899, 0.98, 0.92, 0.05, 1.126], [1.560, 0.85, 1.13, 0.08, 0.556], [1.290, 0.62, 1.09, 0.08, 0.388],
    [1.011, 0.54, 1.07, 0.08, 0.295],
])  # fmt: skip
DRAG = np.array([  # A_3, a_4, a_5, a_6
    [14.1, 2.45, 2.30, 0.10], [13.4, 2.42, 2.30, 0.10], [12.3, 2.32, 2.30, 0.10], [11.1, 2.31, 2.38, 0.11],
    [9.8, 2.25, 2.80, 0.18], [10.1, 2.25, 2.90, 0.18], [8.7, 2.15, 2.97, 0.18],
])  # fmt: skip
LAG_LEAST, LAG_CHANGES, DRAG_CHANGES = 1.0, 5.0, 7.0  # H
CUT = 0.01  # deviations: of less there is no oil, in phi_f
SERIES = 10.0  # H/3 from which on phi_f is a series: 5e-11
THICK, SMOOTH = 1e3, 2e3  # H: the last of a table, and from where on walls are smooth
PLACES = 320  # of a table


@named_arguments
@dataclass(frozen=True)
class Roughness:
    """Roughness of one wall of a film: the standard deviation `deviation` [m] of its heights, and its `pattern` gamma,
    from 1/9 (ridges along the axis) over 1 (no direction) to 9 (ridges around). Raises `InputError`."""

    deviation: float
    pattern: float = 1.0
    kind: ClassVar[str] = "roughness"

    def __post_init__(self) -> None:
        deviation = require_number(self.deviation, "films.Roughness: deviation [m]", positive=True)
        pattern = require_number(self.pattern, "films.Roughness: pattern", positive=True)
        if not PATTERNS[0] * (1.0 - 1e-9) <= pattern <= PATTERNS[-1] * (1.0 + 1e-9):
            raise InputError(
                f"films.Roughness: pattern must lie from 1/9 to 9, where flow factors are known, got {pattern:g}; 1/9 "
                "has ridges along the axis, 9 around"
            )
        object.__setattr__(self, "deviation", deviation)
        object.__setattr__(self, "pattern", float(np.clip(pattern, PATTERNS[0], PATTERNS[-1])))

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"kind": self.kind, "deviation": self.deviation, "pattern": self.pattern}


ROUGHNESSES = {Roughness.kind: Roughness}


@named_arguments
@dataclass(frozen=True)
class MixedLubrication:
    """Rough walls of a film: contact of their asperities, and their influence on the flow of the oil.

    asperities: a contact law whose pressure begins before the surfaces touch, such as `laws.ExponentialAsperities` or
    `laws.GreenwoodTripp`; its pressure adds to that of the film. boundary_friction: the friction coefficient of the
    asperities, in addition to the drag of the oil. roughness_a, roughness_b: `films.Roughness` of the two walls, with
    the flow factors of Patir and Cheng; None for smooth walls. Raises `InputError`.
    """

    asperities: Law | None = None
    boundary_friction: float = 0.0
    roughness_a: Roughness | None = None
    roughness_b: Roughness | None = None

    def __post_init__(self) -> None:
        label = "films.MixedLubrication"
        if self.asperities is not None:
            object.__setattr__(self, "asperities", _asperities(self.asperities))
        mu = require_number(self.boundary_friction, f"{label}: boundary_friction", non_negative=True)
        object.__setattr__(self, "boundary_friction", mu)
        if mu > 0.0 and self.asperities is None:
            raise InputError(
                f"{label}: boundary_friction is that of asperities, and none are given; the oil drags without it: "
                "give asperities=laws.ExponentialAsperities(...), or leave boundary_friction out"
            )
        for name, wall in (("roughness_a", self.roughness_a), ("roughness_b", self.roughness_b)):
            if wall is not None and not isinstance(wall, Roughness):
                raise InputError(f"{label}: {name} must be films.Roughness(deviation, pattern), got {wall!r}")

    @property
    def deviation(self) -> float:
        """Standard deviation [m] of the summed heights of both walls; 0 for smooth walls."""
        return summed_deviation(self.roughness_a, self.roughness_b)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        walls = {"roughness_a": self.roughness_a, "roughness_b": self.roughness_b}
        return {
            "asperities": None if self.asperities is None else self.asperities.describe(),
            "boundary_friction": self.boundary_friction,
            **{name: wall.describe() for name, wall in walls.items() if wall is not None},
        }


def _asperities(value: Any) -> Law:
    """An asperity law whose pressure begins before the surfaces touch, while a film still exists."""
    label = "films.MixedLubrication"
    law = as_law(value, label, "asperities")
    cure = (
        "take laws.ExponentialAsperities, laws.GreenwoodTripp, or laws.TabulatedLayer with gaps above 0, or leave "
        "asperities out"
    )
    if law.curve is None:
        raise InputError(f"{label}: the law {law.kind} has no pressure to a gap, and a film keeps a gap; {cure}")
    if law.curve.begins >= 0.0:
        raise InputError(
            f"{label}: the law {law.kind} begins where the surfaces touch, and no film is left there; {cure}"
        )
    if law.chi:
        raise InputError(f"{label}: the law {law.kind} is damped, which the film is already; leave out its damping")
    return law


@dataclass(frozen=True)
class FlowFactors:
    """Flow factors of two walls at gaps h (n,), each (n, 2), around and along: `flow` phi_p, `lag` l [m], `drag`
    Phi."""

    flow: Array
    lag: Array
    drag: Array


def summed_deviation(first: Roughness | None, second: Roughness | None) -> float:
    """s [m] of both walls; 0 for smooth walls."""
    return math.hypot(*(0.0 if wall is None else wall.deviation for wall in (first, second)))


def least_gap(first: Roughness | None, second: Roughness | None) -> float:
    """The gap [m] above which the fits hold, in both directions and for both walls."""
    gammas = [g for wall in (first, second) if wall is not None for g in (wall.pattern, 1.0 / wall.pattern)]
    least = [np.interp(np.log(gamma), np.log(PATTERNS), LEAST) for gamma in gammas]
    return summed_deviation(first, second) * max(least, default=0.0)


def flow_factors(first: Roughness | None, second: Roughness | None, gap: Any) -> FlowFactors:
    """Factors of the walls A and B, at least one rough, at gaps (n,) [m]."""
    s, gap = summed_deviation(first, second), np.asarray(gap, dtype=float)
    H, sides = gap / s, []
    for turn in (1.0, -1.0):
        flow, lag, drag = np.zeros(len(H)), np.zeros(len(H)), shear_of_sliding(H)
        for wall, sign in ((first, 1.0), (second, -1.0)):
            if wall is not None:
                part, gamma = (wall.deviation / s) ** 2, wall.pattern**turn
                flow = flow + part * of_pressure(H, gamma)
                lag = lag + sign * part * s * of_sliding(H, gamma)
                drag = drag + part * of_flanks(H, gamma)
        sides.append((flow, lag, drag))
    return FlowFactors(*(np.stack(pair, axis=1) for pair in zip(*sides, strict=True)))


def of_pressure(H: Array, gamma: float) -> Array:
    """phi_p."""

    def fit(i: int) -> Array:
        (C, r), x = FLOW[i], np.maximum(H, LEAST[i])
        return 1.0 - C * np.exp(-r * x) if PATTERNS[i] <= 1.0 else 1.0 + C * x**-r

    return _between(gamma, fit)


def of_sliding(H: Array, gamma: float) -> Array:
    """Phi_s."""

    def fit(i: int) -> Array:
        (A, a, b, c, B), x = LAG[i], np.clip(H, LAG_LEAST, LAG_CHANGES)
        thin = A * x**a * np.exp(-b * x + c * x**2) * np.minimum(H / LAG_LEAST, 1.0)
        return np.where(H <= LAG_CHANGES, thin, B * np.exp(-0.25 * H))

    return _between(gamma, fit)


def of_flanks(H: Array, gamma: float) -> Array:
    """Phi_fs."""

    def fit(i: int) -> Array:
        (A, a, b, c), x = DRAG[i], np.minimum(H, DRAG_CHANGES)
        return A * x**a * np.exp(-b * x + c * x**2) * (DRAG_CHANGES / np.maximum(H, DRAG_CHANGES)) ** 2

    return _between(gamma, fit)


def shear_of_sliding(H: Array) -> Array:
    """phi_f, in closed form."""
    z = np.asarray(H, dtype=float) / 3.0
    found = np.ones_like(z)
    thin, far = z <= 1.0, z > SERIES
    x = z[thin]
    tail = -55.0 + x * (132.0 + x * (345.0 + x * (-160.0 + x * (-405.0 + x * (60.0 + 147.0 * x)))))
    found[thin] = 35.0 / 32.0 * x * ((1.0 - x**2) ** 3 * np.log(3.0 * (1.0 + x) / CUT) + tail / 60.0)
    x = z[~thin & ~far]
    tail = x / 15.0 * (66.0 + x**2 * (30.0 * x**2 - 80.0))
    found[~thin & ~far] = 35.0 / 32.0 * x * ((1.0 - x**2) ** 3 * np.log((x + 1.0) / (x - 1.0)) + tail)
    x = z[far] ** -2
    found[far] = 1.0 + x * (1.0 / 9.0 + x * (1.0 / 33.0 + x * 5.0 / 429.0))
    return found


def factor_table(first: Roughness | None, second: Roughness | None) -> Array:
    """(n, 13) for cubics between gaps: h [m], then flow, lag [m] and drag around and along, each with its slope by h.
    Kinks are rounded over two of its pieces, 4 % of the gap each; beyond the last line walls are smooth."""
    s = summed_deviation(first, second)
    H = np.concatenate([[0.0], np.geomspace(0.01, THICK, PLACES)])

    def values(at: Array) -> Array:
        found = flow_factors(first, second, s * at)
        return np.concatenate([found.flow, found.lag, found.drag], axis=1)

    low, high = H - 1e-4 * H, H + np.maximum(1e-4 * H, 1e-6)
    slope = (values(high) - values(low)) / (s * (high - low))[:, None]
    table = np.stack([values(H), slope], axis=2).reshape(len(H), 12)
    smooth = np.array([1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0])
    return np.column_stack([s * np.append(H, SMOOTH), np.vstack([table, smooth])])


def _between(gamma: float, fit: Callable[[int], Array]) -> Array:
    """Of the two rows around gamma, in ln gamma."""
    place = float(np.interp(np.log(gamma), np.log(PATTERNS), np.arange(len(PATTERNS))))
    i = round(place)
    if abs(place - i) < 1e-9:
        return fit(i)
    i = int(place)
    return (1.0 - place + i) * fit(i) + (place - i) * fit(i + 1)
