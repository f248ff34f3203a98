"""Numbers of a scene that stand in a file of their own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.scene_file.forms import brief


def read_numbers(file: Path, column: Any) -> Any:
    """An array from {file = "...", column = n}: .npy, or text with commas or blanks; whole numbers stay whole."""
    import numpy as np

    name = file.name
    if column is not None and (isinstance(column, bool) or not isinstance(column, int) or column < 0):
        raise InputError(f"column must be a whole number from 0, got {brief(column)}")
    if not file.is_file():
        raise InputError(f"file {name!r} does not exist; it is looked for in {file.parent}")
    try:
        if file.suffix.lower() == ".npy":
            array = np.load(file, allow_pickle=False)
        else:
            text = file.read_text(encoding="utf-8").replace(",", " ").splitlines()
            array = np.loadtxt(text, ndmin=2, comments="#")
            array = array[:, 0] if array.shape[1] == 1 else array
    except (OSError, ValueError) as error:
        raise InputError(f"file {name!r} holds no table of numbers ({error})") from None
    if column is not None:
        if array.ndim != 2 or column >= array.shape[1]:
            raise InputError(f"file {name!r}: column {column} does not exist, its numbers have shape {array.shape}")
        array = array[:, column]
    whole = (
        array.size and np.all(np.isfinite(array)) and np.all(array == np.rint(array)) and np.abs(array).max() < 2**53
    )
    return array.astype(np.int64) if whole else array
