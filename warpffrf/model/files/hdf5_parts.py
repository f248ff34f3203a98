"""Reading parts of an HDF5 file: only data in the file itself, only numbers and text, and no more than it can contain.

A dataset may declare any size, also one of which nothing was ever written: reading it takes that memory. Compression
makes at most `RATIO` bytes of one, so a dataset that declares more than its stored bytes can give is wrong, and one
that claims more stored bytes than the file has. Links to other files and datasets that lie in other files are refused.

Damage in a sealed file can cause the library to loop for ever in code that no signal of Python reaches: `probe` first
reads a file in a child process, which can be ended.
"""

from __future__ import annotations

import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError

RATIO = 1032  # bytes that one byte of deflate can stand for, at most
REAL = "biufV"  # V: vectors in records
COMPLEX = REAL + "c"
LEAST = 1 << 16  # bytes below which a size is not checked
SECONDS = 15.0  # it takes half a second
_LOOK = """
import sys, h5py
def look(item):
    for name in item.attrs:
        item.attrs[name]
    texts = isinstance(item, h5py.Dataset) and item.dtype.kind == "O"
    if texts and 16 * item.size <= item.id.get_storage_size() + 65536:  # references that are stored, not only declared
        item[()]
with h5py.File(sys.argv[1], "r") as file:
    look(file)
    file.visititems(lambda name, item: look(item))
"""


def member(file: Any, path: str) -> Any:
    """The group or dataset at `path` of the open `h5py.File`, every step on the way a part of the file itself.

    Raises KeyError where there is none, and `InputError` for links to other locations.
    """
    import h5py

    here = file
    for name in path.split("/"):
        if not isinstance(here, h5py.Group):
            raise KeyError(f"{path} is missing")
        if not isinstance(here.get(name, getlink=True), h5py.HardLink):
            if here.get(name, getlink=True) is None:
                raise KeyError(f"{path} is missing")
            raise InputError(f"{path} is a link to another place")
        here = here[name]
    return here


def names(file: Any, path: str) -> list[str]:
    """The names in the group at `path`, none where there is no such group."""
    try:
        return list(member(file, path))
    except KeyError:
        return []


def read(file: Any, path: str, part: Any = (), *, kinds: str = REAL) -> np.ndarray:
    """The numbers at `path` of the open `h5py.File`, or of them the `part` of an index; `kinds` of NumPy's types.

    Raises KeyError where there is none, and `InputError` for an object that is no dataset of numbers, lies elsewhere,
    or declares more than the file can hold.
    """
    dataset = _dataset(file, path)
    found = {dataset.dtype[name].kind for name in dataset.dtype.names or ()} or {dataset.dtype.kind}
    if not found <= set(kinds):
        raise InputError(f"{path} holds no numbers, or of another kind")
    return np.asarray(dataset[part])


def read_text(file: Any, path: str) -> str:
    """The text at `path`; raises as `read` does."""
    dataset = _dataset(file, path)
    if dataset.shape != () or dataset.dtype.kind not in "OS":
        raise InputError(f"{path} holds no text")
    found = dataset[()]
    if not isinstance(found, bytes | str):
        raise InputError(f"{path} holds no text")
    return found.decode() if isinstance(found, bytes) else found


def probe(path: Path, subject: str, cure: str) -> None:
    """Raise `InputError`, "`subject` is damaged (why); `cure`", where reading the texts of `path` never ends or ends
    the process. What else is wrong with it is left to its reader."""
    if not sys.executable:
        return
    try:
        done = subprocess.run([sys.executable, "-I", "-c", _LOOK, str(path)], capture_output=True, timeout=SECONDS)
    except subprocess.TimeoutExpired:
        raise InputError(f"{subject} is damaged (the HDF5 library does not return from it); {cure}") from None
    except OSError:
        return  # no process to be had
    if done.returncode < 0:
        raise InputError(f"{subject} is damaged (the HDF5 library crashes on it); {cure}")


def _dataset(file: Any, path: str) -> Any:
    import h5py

    dataset = member(file, path)
    if not isinstance(dataset, h5py.Dataset):
        raise InputError(f"{path} is no dataset")
    if dataset.is_virtual or dataset.external:
        raise InputError(f"{path} lies in another file")
    if dataset.compression not in (None, "gzip"):
        raise InputError(f"{path} is compressed by {dataset.compression}")
    # a chunk is unpacked as a whole, also where the dataset is a part of it
    stored, numbers = dataset.id.get_storage_size(), max(dataset.size or 0, math.prod(dataset.chunks or (0,)))
    declared = numbers * dataset.dtype.itemsize
    most = stored * (RATIO if dataset.compression else 1)
    if declared > max(most, LEAST) or stored > _size(file):
        raise InputError(f"{path} declares {declared} bytes, more than the file can contain")
    if declared > _memory():
        raise InputError(f"{path} declares {declared} bytes, more than this machine's memory")
    return dataset


def _size(file: Any) -> int:
    return os.path.getsize(file.filename)


def _memory() -> int:
    """Bytes of memory of this machine, 2^62 where unknown."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return 1 << 62
