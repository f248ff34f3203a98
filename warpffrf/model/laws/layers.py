r"""Common to all contact laws: the layer between two surfaces, pressure over depth.

With the gap g [m] between the deformed surfaces, negative where they penetrate, d = -g is the *depth* by which
the layer is compressed. A layer is a rising curve p = P(d), zero below a depth d_0 (0 for a layer that begins at touch,
negative for one that acts at a distance), and stores the energy

    W(d) = int_d0^d P(e) de        [J/m^2].

A law that also depends on the compression rate has p = P(d) (1 + chi d_dot), cut at zero: surfaces do not pull. The
part P(d) alone is elastic; p - P(d) dissipates (p - P) d_dot >= 0. P must then be convex, so that a step has one depth
for each pressure.

The solver requires the inverse: contact is solved for pressures (`warpffrf_kernels.layers.weak_layer`), with the layer
deformation y(p) = P^-1(p). All users, including run checks and test references, read the law's `curve` and `chi`: a
law consists of a name, its parameters and these.

Unilateral. No layer between the surfaces: 0 <= p, g >= 0, p g = 0, without a parameter.

Linear layer. A layer with the deformation p/k: 0 <= p, g + p/k >= 0, p (g + p/k) = 0, a Winkler bed.

The layer models a coating, or the penalty of other programs. In the weak form it adds the compliance E =
M_psi/k on the grid nodes, M_psi the Gram matrix of the shape functions: symmetric positive definite, so that the
problem is of the same type and never worse conditioned; its energy s.E s/2 is in the contact line of the ledger.
Limits: k -> infinity is `Unilateral`; for bodies much stiffer than the layer a cylinder of relative radius R pressed in
by d has p = k (d - x^2/2R), half-width sqrt(2 R d), and the load (4/3) k d sqrt(2 R d) per unit of width.

The layer acts at the nodes of the first surface; at the end of a narrower second surface a node counts fully.

Nonlinear layer. A layer that stiffens as it is compressed: p = k d^n of the depth d = -g > 0 (see `laws.curves.power`).

For bodies much stiffer than the layer a cylinder of relative radius R pressed in by d has the half-width b = sqrt(2 R
d), the pressure p = k d^n (1 - x^2/b^2)^n and, per unit of width, the load

    P' = k d^n b B(1/2, n + 1),        B the beta function: 4/3 at n = 1, 3 pi/8 at n = 3/2.

Tabulated layer. A layer whose pressure is given by a table against the gap, from a measurement or another program.

Between the points the curve is linear, so that pressure, slope and energy follow from the table alone, without
overshoot. Beyond the smallest gap the last piece is extrapolated; beyond the largest one, where the pressure must be
zero, the surfaces are apart.

Exponential asperities. Rough surfaces: the pressure of asperities falls exponentially with the gap between the mean
planes.

    p = p_0 exp(-g/lambda)

is the law of Greenwood and Williamson for an exponential distribution of the asperities' heights (Proc. R. Soc. A 295,
1966), whose decay length lambda is their standard deviation; p_0 is the pressure with the mean planes in touch, g = 0.
It is positive at any gap. Here it ends at a given gap `cut`, where the curve is shifted to zero,

    p = p_0 [exp(-g/lambda) - eps],      eps = exp(-cut/lambda),
    W = lambda p_0 [exp(-g/lambda) - eps] - p_0 eps (cut - g),

so that the pressure errs by no more than eps p_0; by default eps = 1e-6. The inverse is y(p) = lambda ln(p/p_0 + eps).
A uniform pressure p keeps the surfaces apart by lambda ln(p_0/p), if p >> eps p_0: choose `cut` well above that.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_number
from warpffrf.model.laws.curves import Curve, Exponential, Power, Straight, Table
from warpffrf.model.laws.curves.curve import MOST_POINTS, require_exponent
from warpffrf.model.messages.named_arguments import named_arguments


class Law(ABC):
    """A contact law: a frozen dataclass with a `kind` and a `curve`. Scene files refer to those in
    `warpffrf.model.laws.LAWS` by their kind."""

    kind: ClassVar[str]

    @property
    @abstractmethod
    def curve(self) -> Curve | None:
        """Pressure over depth; None without a layer."""

    @property
    def chi(self) -> float:
        """Damping [s/m] of the module docstring."""
        return 0.0

    @property
    def remark(self) -> str:
        """Text on the law in the report of a run, after the name of its contact."""
        return ""

    @property
    def compliance(self) -> float:
        """Constant compliance [m/Pa] of the layer; 0 where there is none, or it is not constant."""
        return 0.0 if self.curve is None else self.curve.compliance

    @property
    def bent(self) -> Curve | None:
        """The curve of a layer with variable compliance, else None."""
        return None if self.curve is None or self.curve.compliance else self.curve

    def pressure(self, gap: Any, closing_speed: Any = 0.0) -> np.ndarray:
        """Pressure [Pa] at the gaps [m], with the closing_speed [m/s] at which they decrease; arguments broadcast."""
        elastic = self._given.pressure(-np.asarray(gap, float))
        if not self.chi:
            return elastic
        return np.maximum(elastic * (1.0 + self.chi * np.asarray(closing_speed, float)), 0.0)

    def energy(self, gap: Any) -> np.ndarray:
        """Elastic energy [J/m^2] of the layer at the gaps [m], any shape."""
        return self._given.energy(-np.asarray(gap, float))

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        values = {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]
        return {"kind": self.kind} | {n: list(v) if isinstance(v, tuple) else v for n, v in values.items()}

    @property
    def _given(self) -> Curve:
        if self.curve is None:
            raise TypeError(f"{self.kind}: without a layer between the surfaces a gap has no pressure")
        return self.curve


@named_arguments
@dataclass(frozen=True)
class Unilateral(Law):
    """Surfaces in contact do not penetrate; no parameter. The default."""

    kind: ClassVar[str] = "unilateral"

    @property
    def curve(self) -> None:
        """No layer, no curve."""
        return None


@named_arguments
@dataclass(frozen=True)
class LinearLayer(Law):
    """A layer between the surfaces with the deformation p/stiffness; `stiffness` [Pa/m] must be positive. For a coating
    of thickness t about E/t (1 - nu)/((1 + nu)(1 - 2 nu)). Raises `InputError`."""

    stiffness: float
    kind: ClassVar[str] = "linear_layer"

    def __post_init__(self) -> None:
        stiffness = require_number(self.stiffness, "LinearLayer: stiffness [Pa/m]", positive=True)
        object.__setattr__(self, "stiffness", stiffness)

    @property
    def curve(self) -> Straight:
        """A straight curve; its compliance is constant and part of the bodies'."""
        return Straight(self.stiffness)


@named_arguments
@dataclass(frozen=True)
class NonlinearLayer(Law):
    """A layer with the pressure stiffness * depth^exponent; stiffness [Pa/m^exponent] positive, exponent at least 1.

    For exponent 1 it equals `LinearLayer`. Raises `InputError`.
    """

    stiffness: float
    exponent: float
    kind: ClassVar[str] = "nonlinear_layer"

    def __post_init__(self) -> None:
        stiffness = require_number(self.stiffness, "NonlinearLayer: stiffness [Pa/m^exponent]", positive=True)
        object.__setattr__(self, "stiffness", stiffness)
        object.__setattr__(self, "exponent", require_exponent(self.exponent, "NonlinearLayer: exponent"))

    @property
    def curve(self) -> Power:
        """k d^n."""
        return Power(self.stiffness, self.exponent)


@named_arguments
@dataclass(frozen=True)
class TabulatedLayer(Law):
    """A layer with tabulated pressures (n,) [Pa] at the gaps (n,) [m], which rise; the pressures must fall strictly and
    end at zero. Raises `InputError` for a table that is not monotonic."""

    gaps: tuple[float, ...]
    pressures: tuple[float, ...]
    kind: ClassVar[str] = "tabulated_layer"

    def __post_init__(self) -> None:
        gaps = require_array(self.gaps, "TabulatedLayer: gaps [m]", (None,))
        pressures = require_array(self.pressures, "TabulatedLayer: pressures [Pa]", (None,))
        if len(gaps) != len(pressures) or len(gaps) < 2:
            raise InputError(
                f"TabulatedLayer: as many pressures as gaps are needed, two at least, got {len(gaps)} gaps and "
                f"{len(pressures)} pressures"
            )
        if len(gaps) > MOST_POINTS:
            raise InputError(f"TabulatedLayer: at most {MOST_POINTS} points, got {len(gaps)}; remove points")
        for name, wrong, values in (
            ("gaps must rise", np.diff(gaps) <= 0.0, gaps),
            ("pressures must fall as the gap grows", np.diff(pressures) >= 0.0, pressures),
        ):
            if np.any(wrong):
                i = int(np.argmax(wrong))
                raise InputError(
                    f"TabulatedLayer: the table is not monotonic, {name} strictly, got {values[i]:g} and then "
                    f"{values[i + 1]:g} (points {i} and {i + 1})"
                )
        if pressures[-1] != 0.0:
            raise InputError(
                f"TabulatedLayer: the last pressure must be 0, got {pressures[-1]:g} Pa; add the gap where contact ends"
            )
        object.__setattr__(self, "gaps", tuple(float(g) for g in gaps))
        object.__setattr__(self, "pressures", tuple(float(p) for p in pressures))

    @property
    def curve(self) -> Table:
        """Depths and pressures, both rising."""
        return Table(-np.array(self.gaps)[::-1], np.array(self.pressures)[::-1])


NEGLIGIBLE = 1e-6  # of the pressure at zero gap: the default cut of the law
DEEPEST = 300.0  # decay lengths between zero gap and the cut: exponentials of more exceed the range of numbers


@named_arguments
@dataclass(frozen=True)
class ExponentialAsperities(Law):
    """Asperities with the pressure `pressure_at_zero` [Pa] at zero gap that falls by a factor e every `decay_length`
    [m] and ends at the gap `cut` [m], by default where it is 1e-6 of that at zero gap. Raises `InputError`."""

    pressure_at_zero: float
    decay_length: float
    cut: float | None = None
    kind: ClassVar[str] = "exponential_asperities"

    def __post_init__(self) -> None:
        pressure = require_number(self.pressure_at_zero, "ExponentialAsperities: pressure_at_zero [Pa]", positive=True)
        length = require_number(self.decay_length, "ExponentialAsperities: decay_length [m]", positive=True)
        object.__setattr__(self, "pressure_at_zero", pressure)
        object.__setattr__(self, "decay_length", length)
        if self.cut is not None:
            cut = require_number(self.cut, "ExponentialAsperities: cut [m]", positive=True)
            if cut > DEEPEST * length:
                raise InputError(
                    f"ExponentialAsperities: cut must be at most {DEEPEST:g} decay lengths, got {cut / length:g}"
                )
            object.__setattr__(self, "cut", cut)

    @property
    def end(self) -> float:
        """The gap [m] from which on there is no pressure: `cut`, or its default."""
        return float(-np.log(NEGLIGIBLE) * self.decay_length) if self.cut is None else self.cut

    @property
    def curve(self) -> Exponential:
        """p_0 exp(-g/lambda) up to where it ends."""
        return Exponential(self.pressure_at_zero, self.decay_length, self.end)

    @property
    def remark(self) -> str:
        return f"the pressure of its {self.kind} ends at {self.end:.3g} m"

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        numbers = {"pressure_at_zero": self.pressure_at_zero, "decay_length": self.decay_length}
        return {"kind": self.kind, **numbers, "cut": self.end}
