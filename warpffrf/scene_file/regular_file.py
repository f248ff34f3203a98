"""Files that a scene names: ordinary ones on a disk, of a size that can be meant."""

from __future__ import annotations

import stat
from pathlib import Path

from warpffrf.model.errors import InputError

MADE_UP = ("/proc/", "/sys/")


def read_regular(file: Path, most: int) -> bytes:
    """The bytes of `file`. Raises `InputError` for a pipe, a device, a file that the system makes up (/proc, /sys), and
    for one of more than `most` bytes; OSError where it cannot be read."""
    found = file.stat()
    if not stat.S_ISREG(found.st_mode) or str(file.resolve()).startswith(MADE_UP):
        raise InputError("is no ordinary file")
    if found.st_size > most:
        raise InputError(f"has {found.st_size} bytes, more than {most} are not read")
    with file.open("rb", buffering=0) as opened:
        return opened.read(found.st_size)
