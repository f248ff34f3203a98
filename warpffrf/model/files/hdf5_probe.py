"""Whether the HDF5 library comes back from a file that has no seal: asked of it in a process of its own.

Damage can make the library loop for ever in code that no signal of Python reaches. Files of today are sealed, and
damage to them is seen in their bytes; one of an older version is looked through by a child process that can be ended.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from warpffrf.model.errors import InputError

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


def probe(path: Path, subject: str, cure: str) -> None:
    """Raise `InputError`, "`subject` is damaged (why); `cure`", where reading the texts of `path` never ends or ends
    the process. What else is wrong with it is left to its reader."""
    if not sys.executable:
        return
    try:
        done = subprocess.run([sys.executable, "-I", "-c", _LOOK, str(path)], capture_output=True, timeout=SECONDS)
    except subprocess.TimeoutExpired:
        raise InputError(f"{subject} is damaged (the HDF5 library does not come back from it); {cure}") from None
    except OSError:
        return  # no process to be had
    if done.returncode < 0:
        raise InputError(f"{subject} is damaged (the HDF5 library breaks down on it); {cure}")
