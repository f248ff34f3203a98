"""Nothing lies between the surfaces: 0 <= p, g >= 0, p g = 0, without a parameter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from warpffrf.model.laws.law import Law
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
@dataclass(frozen=True)
class Unilateral(Law):
    """Surfaces that touch do not enter one another; no parameter. The default."""

    kind: ClassVar[str] = "unilateral"

    @property
    def curve(self) -> None:
        """No layer, no curve."""
        return None
