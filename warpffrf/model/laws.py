r"""Contact laws: what lies between two surfaces that touch.

With the gap g [m] between the deformed surfaces and the pressure p [Pa]

    Unilateral      0 <= p,   g >= 0,   p g = 0: nothing between them, no parameter
    LinearLayer     0 <= p,   g + p/k >= 0,   p (g + p/k) = 0: a layer that yields by p/k, a Winkler bed

The layer stands for asperities, a coating, or the penalty of other programs. In the weak form its yield is one more
compliance, E = M_psi/k on the hats, M_psi their Gram matrix: symmetric positive definite, so that the problem stays the
same one and is never worse conditioned; its energy s.E s/2 is in the contact line of the ledger. Limits: k -> infinity
is `Unilateral`; for bodies that hardly yield beside the layer a cylinder of relative radius R pressed in by d has
p = k (d - x^2/2R), half-width sqrt(2 R d), and the load (4/3) k d sqrt(2 R d) per unit of width.

A layer counts where hats of the first surface lie; at the end of a narrower second surface a hat counts whole.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from warpffrf.model.errors import InputError, require_number


@dataclass(frozen=True)
class Unilateral:
    """Surfaces that touch do not enter one another; no parameter. The default."""

    kind = "unilateral"

    @property
    def yielding(self) -> float:
        """Yield [m/Pa] of what lies between: none."""
        return 0.0

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"kind": self.kind}


@dataclass(frozen=True)
class LinearLayer:
    """A layer between the surfaces that yields by p/stiffness; `stiffness` [Pa/m] must be positive. For a coating of
    thickness t about E/t (1 - nu)/((1 + nu)(1 - 2 nu)). Raises `InputError`."""

    stiffness: float
    kind = "linear_layer"

    def __post_init__(self) -> None:
        require_number(self.stiffness, "LinearLayer: stiffness [Pa/m]", positive=True)

    @property
    def yielding(self) -> float:
        """Yield [m/Pa] of the layer, 1/stiffness."""
        return 1.0 / self.stiffness

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"kind": self.kind, "stiffness": float(self.stiffness)}


LAWS = {law.kind: law for law in (Unilateral, LinearLayer)}


def as_law(value: Any, label: str) -> Unilateral | LinearLayer:
    """`value` if it is a law; raises `InputError` naming `label` and the laws there are."""
    if not isinstance(value, tuple(LAWS.values())):
        names = ", ".join(f"laws.{law.__name__}" for law in LAWS.values())
        raise InputError(f"{label}: law must be one of {names}, got {value!r}")
    return value
