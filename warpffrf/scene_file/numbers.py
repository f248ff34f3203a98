"""Numbers of a scene that stand in a file of their own."""

from __future__ import annotations

import io
import math
from pathlib import Path
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.model.files.regular_file import read_regular
from warpffrf.scene_file.forms import brief

MOST_BYTES = 1 << 28  # of such a file


def read_numbers(file: Path, column: Any) -> Any:
    """An array from {file = "...", column = n}: .npy, or text with commas or blanks; whole numbers stay whole."""
    import numpy as np

    name = file.name
    if column is not None and (isinstance(column, bool) or not isinstance(column, int) or column < 0):
        raise InputError(f"column must be a whole number from 0, got {brief(column)}")
    if not file.is_file():
        raise InputError(f"file {name!r} does not exist; it is looked for in {file.parent}")
    try:
        content = read_regular(file, MOST_BYTES)
    except InputError as error:
        raise InputError(f"file {name!r} {error}") from None
    except OSError as error:
        raise InputError(f"file {name!r} cannot be read ({error.strerror or error})") from None
    try:
        if not content.strip():
            raise ValueError("is empty")
        if file.suffix.lower() == ".npy":
            array = _array(content)
        else:
            array = np.loadtxt(content.decode("utf-8").replace(",", " ").splitlines(), ndmin=2, comments="#")
            array = array[:, 0] if array.shape[1] == 1 else array
    except (ValueError, MemoryError):  # what NumPy says of it would show what is in a file that was never meant
        raise InputError(f"file {name!r} holds no table of numbers{_at_line(content)}") from None
    if column is not None:
        if array.ndim != 2 or column >= array.shape[1]:
            raise InputError(f"file {name!r}: column {column} does not exist, its numbers have shape {array.shape}")
        array = array[:, column]
    whole = (
        array.size and np.all(np.isfinite(array)) and np.all(array == np.rint(array)) and np.abs(array).max() < 2**53
    )
    return array.astype(np.int64) if whole else array


def _array(content: bytes) -> Any:
    """The array of a .npy file; ValueError where it declares more numbers than the file has."""
    import numpy as np

    stream = io.BytesIO(content)
    major = np.lib.format.read_magic(stream)[0]
    read_header = np.lib.format.read_array_header_1_0 if major == 1 else np.lib.format.read_array_header_2_0
    shape, _, dtype = read_header(stream)
    if dtype.kind not in "biuf" or math.prod(shape) * dtype.itemsize != len(content) - stream.tell():
        raise ValueError("no array of numbers of the size of the file")
    return np.load(io.BytesIO(content), allow_pickle=False)


def _at_line(content: bytes) -> str:
    """Where a text stops being numbers, as words for a message; "" where that is not known."""
    for number, line in enumerate(content.decode("utf-8", errors="replace").splitlines(), start=1):
        for word in line.replace(",", " ").split("#")[0].split():
            try:
                float(word)
            except ValueError:
                return f": line {number} has something else"
    return ""
