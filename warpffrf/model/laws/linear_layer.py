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
from typing import Any, ClassVar

import numpy as np

from warpffrf.model.errors import require_number


@dataclass(frozen=True)
class LinearLayer:
    """A layer between the surfaces that yields by p/stiffness; `stiffness` [Pa/m] must be positive. For a coating of
    thickness t about E/t (1 - nu)/((1 + nu)(1 - 2 nu)). Raises `InputError`."""

    stiffness: float
    kind: ClassVar[str] = "linear_layer"

    def __post_init__(self) -> None:
        stiffness = require_number(self.stiffness, "LinearLayer: stiffness [Pa/m]", positive=True)
        object.__setattr__(self, "stiffness", stiffness)

    @property
    def compliance(self) -> float:
        """Yield [m/Pa] of the layer, 1/stiffness."""
        return 1.0 / self.stiffness

    @property
    def curve(self) -> None:
        """None: the yield is a constant, and part of the compliance."""
        return None

    def pressure(self, gap: Any) -> np.ndarray:
        """Pressure [Pa] at the gaps [m], any shape."""
        return self.stiffness * np.maximum(-np.asarray(gap, float), 0.0)

    def energy(self, gap: Any) -> np.ndarray:
        """Energy [J/m^2] of the layer at the gaps [m], any shape."""
        return 0.5 * self.stiffness * np.maximum(-np.asarray(gap, float), 0.0) ** 2

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"kind": self.kind, "stiffness": self.stiffness}
