r"""A layer that yields by p/k: 0 <= p, g + p/k >= 0, p (g + p/k) = 0, a Winkler bed.

The layer stands for a coating, or for the penalty of other programs. In the weak form its yield is one more compliance,
E = M_psi/k on the hats, M_psi their Gram matrix: symmetric positive definite, so that the problem stays the same one
and is never worse conditioned; its energy s.E s/2 is in the contact line of the ledger. Limits: k -> infinity is
`Unilateral`; for bodies that hardly yield beside the layer a cylinder of relative radius R pressed in by d has
p = k (d - x^2/2R), half-width sqrt(2 R d), and the load (4/3) k d sqrt(2 R d) per unit of width.

A layer counts where hats of the first surface lie; at the end of a narrower second surface a hat counts whole.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from warpffrf.model.errors import require_number
from warpffrf.model.laws.curves import Straight
from warpffrf.model.laws.law import Law
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
@dataclass(frozen=True)
class LinearLayer(Law):
    """A layer between the surfaces that yields by p/stiffness; `stiffness` [Pa/m] must be positive. For a coating of
    thickness t about E/t (1 - nu)/((1 + nu)(1 - 2 nu)). Raises `InputError`."""

    stiffness: float
    kind: ClassVar[str] = "linear_layer"

    def __post_init__(self) -> None:
        stiffness = require_number(self.stiffness, "LinearLayer: stiffness [Pa/m]", positive=True)
        object.__setattr__(self, "stiffness", stiffness)

    @property
    def curve(self) -> Straight:
        """Its yield is a constant, and part of the compliance."""
        return Straight(self.stiffness)
