"""Topics of arrays for kernels that a test launches by itself."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import warp as wp

from warpffrf.online.arrays.axes import NAMES
from warpffrf.online.arrays.declaration import allocate, as_taken
from warpffrf.online.device import chosen_device


def zeros(topic: Any, sizes: Mapping[str, int]) -> Any:
    """`topic` with zero arrays; axes that `sizes` does not name have one entry."""
    found = topic()
    for name, declaration in topic.declarations.items():
        array = allocate(declaration, dict.fromkeys(NAMES, 1) | dict(sizes), chosen_device(None))
        setattr(found, name, as_taken(array, topic.vars[name].type))
    return found


def given(struct: Any, topic: Any) -> wp.array:
    """As a kernel takes it."""
    return wp.array([struct], dtype=topic)
