"""Speed against error: refinement, contact grids, bases, inertia levels, evaluations, step times, another program;
`speed_error` studies any scene. It is loaded when first used."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from warpffrf.study.speed_against_error.study import speed_error

__all__ = ["speed_error"]


def __getattr__(name: str) -> Any:
    if name != "speed_error":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return importlib.import_module("warpffrf.study.speed_against_error.study").speed_error
