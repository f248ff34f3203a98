"""Nothing lies between the surfaces: 0 <= p, g >= 0, p g = 0, without a parameter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar


@dataclass(frozen=True)
class Unilateral:
    """Surfaces that touch do not enter one another; no parameter. The default."""

    kind: ClassVar[str] = "unilateral"

    @property
    def compliance(self) -> float:
        """Yield [m/Pa] of what lies between: none."""
        return 0.0

    @property
    def curve(self) -> None:
        """No layer, no curve."""
        return None

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"kind": self.kind}
