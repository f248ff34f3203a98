"""Histories that a result exposes unchanged, with their meaning, shape, unit and frame."""

from __future__ import annotations

from operator import attrgetter
from typing import Any, Self, overload

import numpy as np


class Recorded:
    """Descriptor of an array in the result's `history`, or at `place` ("view.points"), with its meaning."""

    def __init__(self, meaning: str, place: str = "") -> None:
        self.__doc__, self.place = meaning, place

    def __set_name__(self, owner: type, name: str) -> None:
        self.__name__ = name
        self.read = attrgetter(self.place or f"history.{name}")

    @overload
    def __get__(self, result: None, owner: type) -> Self: ...

    @overload
    def __get__(self, result: Any, owner: type) -> np.ndarray: ...

    def __get__(self, result: Any, owner: type) -> Any:
        return self if result is None else self.read(result)

    def __set__(self, result: Any, value: Any) -> None:
        raise AttributeError(f"{type(result).__name__}.{self.__name__} is a recorded quantity and cannot be set")
