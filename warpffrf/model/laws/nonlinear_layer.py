r"""A layer that stiffens as it is compressed: p = k d^n of the depth d = -g > 0 (see `laws.curves.power`).

For bodies that hardly yield beside the layer a cylinder of relative radius R pressed in by d has the half-width
b = sqrt(2 R d), the pressure p = k d^n (1 - x^2/b^2)^n and, per unit of width, the load

    P' = k d^n b B(1/2, n + 1),        B the beta function: 4/3 at n = 1, 3 pi/8 at n = 3/2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from warpffrf.model.errors import require_number
from warpffrf.model.laws.curves import Power
from warpffrf.model.laws.curves.power import require_exponent
from warpffrf.model.laws.law import Law
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
@dataclass(frozen=True)
class NonlinearLayer(Law):
    """A layer with the pressure stiffness * depth^exponent; stiffness [Pa/m^exponent] positive, exponent at least 1.

    For exponent 1 the numbers of `LinearLayer`. Raises `InputError`.
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
