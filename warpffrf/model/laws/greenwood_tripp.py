r"""Rough surfaces whose asperities' heights are Gaussian: the law of Greenwood and Tripp (Proc. Instn Mech. Engrs 185,
1970).

Both surfaces have eta asperities per unit area, paraboloids with the radius beta, and s is the standard deviation of
the summed heights. Two of them with the lateral distance r that would overlap by w if aligned touch as spheres do, with
the force (4/3) E* (beta/2)^(1/2) (w - r^2/(4 beta))^(3/2); over all neighbours and all heights, at the gap g between
the mean planes,

    p = K E* F(g/s),      K = (16 sqrt(2) pi/15) (eta beta s)^2 (s/beta)^(1/2),
    F(u) = (2 pi)^(-1/2) int_u^inf (v - u)^(5/2) exp(-v^2/2) dv,      F(0) = 0.6166,

with 1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2, the E' of that paper (not the one of elastohydrodynamics, which is
twice as large). Asperities are elastic, and far apart: below a gap of about zero the law is an extrapolation. A film
maintains a gap, so that asperities parallel to it carry at most 0.6166 K E*.

With v = u + x^2, F = (2 pi)^(-1/2) int x^6 exp(-(u + x^2)^2/2) dx over all x, which the trapezoidal rule integrates to
round-off, and F'' = (15/4) (2 pi)^(-1/2) int x^2 exp(-(u + x^2)^2/2) dx. The curve has straight pieces between `POINTS`
of its points, as long as s (8 e F/F'')^(1/2), e the same for all: pressures err by e = 4e-5 of themselves, slopes by
1 %. It is extrapolated linearly below the gap -4 s, and ends at the gap `cut`, where it is shifted to zero; by default
where F is 1e-6 F(0), about 4.3 s. The shift adds an equal error to all pressures.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.model.laws.curves import Table
from warpffrf.model.laws.layers import Law
from warpffrf.model.messages.named_arguments import named_arguments

POINTS = 1000  # of the table
DEEPEST = 4.0  # deviations that the mean planes overlap by at the last point: F is 36 there, some GPa of steel
NEGLIGIBLE = 1e-6  # of the pressure at zero gap: the default cut of the law
END = 4.2769  # deviations: gap of that pressure
FARTHEST = 10.0  # deviations: a larger cut has no effect, F is 1e-24 there
STEP, REACH = 0.02, 4.5  # of x, and where exp(-(x^2 - 4)^2/2) is below round-off: of the integrals


@named_arguments
@dataclass(frozen=True)
class GreenwoodTripp(Law):
    """Asperities with Gaussian heights: `deviation` [m], the standard deviation of the summed roughness, `density`
    [1/m^2] of the asperities and `radius` [m] of their tips, of either surface, `modulus` [Pa], E* of both. It ends at
    the gap `cut` [m], by default where the pressure is 1e-6 of that at zero gap. Raises `InputError`."""

    deviation: float
    density: float
    radius: float
    modulus: float
    cut: float | None = None
    kind: ClassVar[str] = "greenwood_tripp"

    def __post_init__(self) -> None:
        for name, unit in (("deviation", "m"), ("density", "1/m^2"), ("radius", "m"), ("modulus", "Pa")):
            number = require_number(getattr(self, name), f"GreenwoodTripp: {name} [{unit}]", positive=True)
            object.__setattr__(self, name, number)
        if self.cut is not None:
            cut = require_number(self.cut, "GreenwoodTripp: cut [m]", positive=True)
            if cut > FARTHEST * self.deviation:
                raise InputError(
                    f"GreenwoodTripp: cut must be at most {FARTHEST:g} deviations, got {cut / self.deviation:g}; leave "
                    "it out to end where the pressure is negligible"
                )
            object.__setattr__(self, "cut", cut)

    @classmethod
    def from_products(
        cls, deviation: float, crowding: float, steepness: float, modulus: float, cut: float | None = None
    ) -> GreenwoodTripp:
        """From the numbers that are usually given: `crowding` eta beta s, 0.03 to 0.05, and `steepness` s/beta, 1e-4 to
        1e-2, both dimensionless; deviation [m], modulus [Pa] and cut [m] as above."""
        s = require_number(deviation, "GreenwoodTripp: deviation [m]", positive=True)
        product = require_number(
            crowding, "GreenwoodTripp: crowding, density times radius times deviation", positive=True
        )
        ratio = require_number(steepness, "GreenwoodTripp: steepness, deviation over radius", positive=True)
        return cls(s, product * ratio / s**2, s / ratio, modulus, cut)

    @property
    def end(self) -> float:
        """The gap [m] from which on there is no pressure: `cut`, or its default."""
        return END * self.deviation if self.cut is None else self.cut

    @property
    def scale(self) -> float:
        """K E* [Pa]."""
        crowding, steepness = self.density * self.radius * self.deviation, self.deviation / self.radius
        return float(16.0 * np.sqrt(2.0) * np.pi / 15.0 * crowding**2 * np.sqrt(steepness) * self.modulus)

    @property
    def curve(self) -> Table:
        """K E* [F(g/s) - F(cut/s)], straight between its points."""
        depths, values = _points(self.end / self.deviation)
        return Table(self.deviation * depths, self.scale * values)

    @property
    def remark(self) -> str:
        return (
            f"the pressure of its {self.kind} ends at {self.end:.3g} m, {self.end / self.deviation:.3g} deviations of "
            "the roughness"
        )

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        numbers = {name: getattr(self, name) for name in ("deviation", "density", "radius", "modulus")}
        return {"kind": self.kind, **numbers, "cut": self.end}


def gaussian_overlap(u: Any, power: int = 6) -> np.ndarray:
    """(2 pi)^(-1/2) int x^power exp(-(u + x^2)^2/2) dx at u of any shape: F of the module docstring; 4 and 2 give its
    derivatives, F' = -(5/2) of that of 4 and F'' = (15/4) of that of 2."""
    x = np.arange(0.0, REACH, STEP)
    value = x**power * np.exp(-0.5 * (np.asarray(u, float)[..., None] + x**2) ** 2)
    return 2.0 * STEP / np.sqrt(2.0 * np.pi) * value.sum(axis=-1)


@lru_cache(maxsize=16)
def _points(end: float) -> tuple[np.ndarray, np.ndarray]:
    """Depths over the deviation, and F minus its value at the end, at the points of the table."""
    u = np.linspace(-DEEPEST, end, 5 * POINTS)
    share = np.sqrt(gaussian_overlap(u, 2) / gaussian_overlap(u))
    along = np.concatenate([[0.0], np.cumsum(0.5 * (share[1:] + share[:-1]) * np.diff(u))])
    places = np.interp(np.linspace(0.0, along[-1], POINTS), along, u)
    places[-1] = end
    values = gaussian_overlap(places)
    depths, pressures = -places[::-1], (values - values[-1])[::-1]
    for shared in (depths, pressures):
        shared.setflags(write=False)
    return depths, pressures
