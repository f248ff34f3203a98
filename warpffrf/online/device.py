"""The default device of a run."""

from __future__ import annotations

import os

import warp as wp

from warpffrf.model.errors import InputError

VARIABLE = "WARPFFRF_DEVICE"


def chosen_device(named: str | None) -> str:
    """The Warp device `named`, "cpu" or "cuda:0"; for None the one that the environment variable `WARPFFRF_DEVICE`
    names, else the CPU. Raises `InputError` for one that is not there."""
    chosen = named or os.environ.get(VARIABLE) or "cpu"
    try:
        wp.get_device(chosen)
    except (ValueError, RuntimeError) as error:
        source = "" if named else f" ({VARIABLE})"
        raise InputError(f"device {chosen!r}{source} is not available here; use 'cpu'") from error
    return chosen
