r"""What moments of lumped contacts have in common: m(w) = min(c F^p, d F^q w) under the force F at the angular speed w.

The bound c F^p is that of the law, the slope d F^q from rest makes it a function of the speed: nothing sticks, and what
rests on a slope rolls down slowly, at less than the speed c F^p/(d F^q) where both meet.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import asdict, dataclass
from typing import Any, ClassVar

from warpffrf.model.moments.patch import Patch


@dataclass(frozen=True)
class Resistance:
    """A moment as the kernels read it: `bound` c [N m/N^p], `bound_power` p, `slope` d [N m s/N^q], `slope_power` q."""

    bound: float = 0.0
    bound_power: float = 1.0
    slope: float = 0.0
    slope_power: float = 1.0


NO_RESISTANCE = Resistance()


class RollingResistance(ABC):
    """A law of resistance to rolling, a frozen dataclass listed in `warpffrf.model.moments.ROLLING_LAWS`: a moment
    against the relative angular velocity of both bodies across the normal.

    rolling_speed [rad/s]: of that velocity, below which the moment is proportional to it; far below what the machine
    turns at.
    """

    kind: ClassVar[str] = ""
    rolling_speed: float

    @abstractmethod
    def bound(self, patch: Patch | None, label: str) -> tuple[float, float]:
        """c [N m/N^p] and p of a place with that patch, None of a law of the force that knows none. Raises `InputError`
        naming `label` where it needs one."""

    def resistance(self, patch: Patch | None, label: str) -> Resistance:
        """Its numbers at a place with that patch. Raises `InputError` naming `label` as `bound` does."""
        c, p = self.bound(patch, label)
        return Resistance(c, p, c / self.rolling_speed, p)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        return {"kind": self.kind, **asdict(self)}  # pyright: ignore[reportArgumentType]
