"""Base class of all force elements."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar

from warpffrf.model.messages import reprs


class Force(reprs.Item, ABC):
    """Base of the force elements.

    A subclass defines its `kind`, `ports` and `describe`, and its law in terms of `warpffrf.model.forces.laws`:
    `law()`, a `SpringLaw` between two ports (`scalar_law` makes one of a single coordinate); `load()`, a `PointLoad` or
    a `BodyLoad`; `slip()`, a `SlipLaw`; `tension()`, a `TensionLaw`. Its constructor sets `name`.
    """

    scene_list = "forces"
    kind: ClassVar[str] = ""
    name: str | None = None

    @abstractmethod
    def describe(self) -> dict[str, Any]:
        """Plain data for hashing: all parameters of the element."""
