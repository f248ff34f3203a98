"""Files that a user names: ordinary ones on a disk, of a size that can be meant, and no more of them than can be meant.

All readers of files go through `read_regular`; those whose files include others through one `Budget` for all of them.
Numbers in text have at most `MOST_DIGITS` digits where they are whole: Python's own conversion ends, with another
error, at some thousand.
"""

from __future__ import annotations

import os
import stat
from dataclasses import dataclass
from pathlib import Path

from warpffrf.model.errors import InputError

MADE_UP = ("/proc/", "/sys/")
MOST_BYTES = 1 << 32  # of a mesh or a matrix, with all that it includes
MOST_FILES = 1000  # read for one mesh; decks of whole machines include some dozen
DEEPEST = 50  # files in files; Abaqus ends at five
MOST_DIGITS = 18  # of a whole number: below 2^63


def read_regular(file: Path, most: int = MOST_BYTES) -> bytes:
    """The bytes of `file`. Raises `InputError` for a pipe, a device, a file that the system makes up (/proc, /sys), and
    for one of more than `most` bytes; OSError where it cannot be read."""
    # a pipe without a writer would wait for one
    with open(file, "rb", buffering=0, opener=lambda name, flags: os.open(name, flags | os.O_NONBLOCK)) as opened:
        found = os.fstat(opened.fileno())
        if not stat.S_ISREG(found.st_mode) or str(file.resolve()).startswith(MADE_UP):
            raise InputError("is no ordinary file")
        if found.st_size > most:
            raise InputError(f"has {found.st_size} bytes, more than {most} are not read")
        parts, left = [], found.st_size
        while left and (part := opened.read(left)):
            parts.append(part)
            left -= len(part)
    return b"".join(parts)


def read_named(file: Path, kind: str, most: int = MOST_BYTES) -> bytes:
    """The bytes of `file`, a `kind` of file in messages. Raises `InputError` with its name for whatever is wrong."""
    try:
        return read_regular(file, most)
    except FileNotFoundError:
        raise InputError(f"{kind} {str(file)!r} does not exist; check the path") from None
    except InputError as error:
        raise InputError(f"{kind} {file.name}: {error}; check the path") from None
    except (OSError, ValueError) as error:
        raise InputError(f"{kind} {file.name}: cannot be read ({reason(error)}); check the path") from None


def exists(file: Path) -> bool:
    """Whether there is something behind the name; False for a name that no file can have."""
    try:
        return file.exists()
    except (OSError, ValueError):
        return False


def reason(error: Exception) -> str:
    """What the system says of a file that it does not open."""
    return str(getattr(error, "strerror", None) or error)


@dataclass
class Budget:
    """What is left for a file and all that it includes."""

    bytes_left: int = MOST_BYTES
    files_left: int = MOST_FILES

    def read(self, file: Path, depth: int = 0) -> bytes:
        """`read_regular` of `file`, which lies `depth` files deep. Raises `InputError` where the budget ends."""
        if depth > DEEPEST:
            raise InputError(f"lies more than {DEEPEST} files deep; put the files together")
        if self.files_left < 1:
            raise InputError(f"is one file more than {MOST_FILES} (a file counts each time); put the files together")
        content = read_regular(file, self.bytes_left)
        self.files_left -= 1
        self.bytes_left -= len(content)
        return content
