"""Files that a user names: regular files on a disk, of a plausible size and number.

All readers of files go through `read_regular`; those whose files include others through one `Budget` for all of them.
Numbers in text have at most `MOST_DIGITS` digits where they are whole: Python's own conversion ends, with another
error, at some thousand.

Output paths are checked before a run, and files are written completely or not at all.

Existing files are replaced on request only, and only those that warpffrf has written, which its files state at their
beginning or end. A file is written next to its target, under a name of the writing process and machine, and
renamed: so processes do not interfere, and files left by a killed process are removed when the target is next written.

Processes: whether one that a file names runs on this machine.
"""

from __future__ import annotations

import errno
import logging
import os
import re
import secrets
import socket
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from glob import escape
from pathlib import Path
from typing import IO

from warpffrf.model.errors import InputError

MADE_UP = ("/proc/", "/sys/")
MOST_BYTES = 1 << 32  # of a mesh or a matrix, with all that it includes
MOST_FILES = 1000  # read for one mesh; decks of whole machines include some dozen
DEEPEST = 50  # files in files; Abaqus ends at five
MOST_DIGITS = 18  # of a whole number: below 2^63


def read_regular(file: Path, most: int = MOST_BYTES) -> bytes:
    """The bytes of `file`. Raises `InputError` for a pipe, a device, a file that the system generates (/proc, /sys),
    and for one of more than `most` bytes; OSError where it cannot be read."""
    # a pipe without a writer would wait for one
    with open(file, "rb", buffering=0, opener=lambda name, flags: os.open(name, flags | os.O_NONBLOCK)) as opened:
        found = os.fstat(opened.fileno())
        if not stat.S_ISREG(found.st_mode) or str(file.resolve()).startswith(MADE_UP):
            raise InputError("is not a regular file")
        if found.st_size > most:
            raise InputError(f"has {found.st_size} bytes, more than {most} are not read")
        parts, left = [], found.st_size
        while left and (part := opened.read(left)):
            parts.append(part)
            left -= len(part)
    return b"".join(parts)


def read_named(file: Path, kind: str, most: int = MOST_BYTES) -> bytes:
    """The bytes of `file`, a `kind` of file in messages. Raises `InputError` with its name for any fault."""
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
    """The system's reason for not opening a file."""
    return str(getattr(error, "strerror", None) or error)


@dataclass
class Budget:
    """Remaining bytes and files for a file and all that it includes."""

    bytes_left: int = MOST_BYTES
    files_left: int = MOST_FILES

    def read(self, file: Path, depth: int = 0) -> bytes:
        """`read_regular` of `file`, which lies `depth` files deep. Raises `InputError` where the budget ends."""
        if depth > DEEPEST:
            raise InputError(f"lies more than {DEEPEST} files deep; merge the files")
        if self.files_left < 1:
            raise InputError(f"is one file more than {MOST_FILES} (a file counts each time); merge the files")
        content = read_regular(file, self.bytes_left)
        self.files_left -= 1
        self.bytes_left -= len(content)
        return content


# Beginning of a format, and the mark that warpffrf writes into such a file: its name alone may occur in any file
SIGNS = {
    b"\x89HDF": rb"warpffrf sealed\n",
    b"\x89PNG": rb"Software\x00warpffrf",
    b"%PDF": rb"/Creator \(warpffrf\)",
    b"RRF": rb"warpffrf",
    b"GIF8": rb"written by warpffrf",
    b"": rb"written by warpffrf|Made by `(python -m )?warpffrf|<!-- warpffrf -->|as warpffrf ran it"
    rb"|[aA] warpffrf example"
    rb'|\Awarpffrf (stability|speed_error)|<dc:title>warpffrf<|content="warpffrf |"(format|kind)": "warpffrf',
}
SIGN_WITHIN = 1 << 16  # bytes of the beginning and of the end
ENDING = ".part"
UNITS = ("bytes", "kB", "MB", "GB", "TB")

log = logging.getLogger("warpffrf")


def checked_output_path(
    path: str | os.PathLike[str], what: str, *, overwrite: bool, ours: Callable[[Path], bool] | None = None
) -> Path:
    """`path` as a Path that can be written: missing folders are created, an existing file is not changed.

    ours: whether warpffrf wrote a file, `written_here` if None. Raises InputError naming `what` (for instance
    "record") when the path is a folder, when a parent is not a folder, when the folder or file cannot be written, and
    for a file that exists, unless warpffrf wrote it and `overwrite` is set.
    """
    refuse_nul(path, what)
    target = Path(path).expanduser()
    try:
        if target.is_dir():
            raise InputError(f"{what}: '{target}' is a folder; give the name of a file in it")
        if not target.parent.exists():
            target.parent.mkdir(parents=True, exist_ok=True)
            log.info("%s: created folder '%s'", what, target.parent)
        partial = _partial(target)  # the longest name that there will be
        partial.touch(exist_ok=False)
        partial.unlink()
        if target.exists():
            _refuse(target, what, overwrite, ours or written_here)
            with target.open("ab"):
                pass
    except OSError as error:
        cure = "a shorter name" if error.errno == errno.ENAMETOOLONG else "a folder that you may write to"
        raise InputError(f"{what}: '{target}' cannot be written ({error.strerror or error}); choose {cure}") from error
    return target


def refuse_nul(path: str | os.PathLike[str], what: str) -> None:
    """Raises `InputError` naming `what` for a path that no file can have."""
    if "\0" in os.fspath(path):
        raise InputError(f"{what}: {os.fspath(path)!r} holds a NUL, which no name of a file can; choose another name")


def _refuse(target: Path, what: str, overwrite: bool, ours: Callable[[Path], bool]) -> None:
    if not overwrite:
        raise InputError(
            f"{what}: '{target}' exists; choose another name, or replace it with overwrite=True (--overwrite)"
        )
    if not ours(target):
        raise InputError(
            f"{what}: '{target}' was not written by warpffrf and is not replaced; choose another name, or remove it "
            "first"
        )


def written_here(file: Path) -> bool:
    """Whether a file states that warpffrf wrote it, or is empty."""
    with file.open("rb") as stream:
        size = stream.seek(0, os.SEEK_END)
        if not size:
            return True
        stream.seek(0)
        head = stream.read(SIGN_WITHIN)
        sign = next(sign for start, sign in SIGNS.items() if head.startswith(start))
        stream.seek(max(size - SIGN_WITHIN, 0))
        return any(re.search(sign, part) for part in (head, stream.read(SIGN_WITHIN)))


def check_ending(path: str | os.PathLike[str], what: str, endings: tuple[str, ...]) -> None:
    """Raises `InputError` naming `what` unless `path` ends like one of `endings`: a file whose name promises another
    format is misleading. Folders are left to `checked_output_path`."""
    if not isinstance(path, str | os.PathLike):
        raise InputError(f"{what} must be the name of a file, got {path!r}")
    if Path(path).suffix.lower() not in endings and not Path(path).is_dir():
        raise InputError(f"{what}: '{path}' must end in {' or '.join(endings)}")


@contextmanager
def written_whole(path: Path) -> Iterator[Path]:
    """A neighbouring name to write to; it replaces `path` only when the block ends without error, so no file is
    left half written."""
    remove_left_over(path)
    partial = _partial(path)
    try:
        yield partial
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)


def _partial(path: Path) -> Path:
    """A name next to `path` with this process and machine."""
    host = socket.gethostname().replace(".", "-")
    return path.with_name(f".{path.name}.{host}.{os.getpid()}.{secrets.token_hex(4)}{ENDING}")


def remove_left_over(path: Path) -> None:
    """Remove the partial files next to `path` of processes of this machine that have ended."""
    for file in path.parent.glob(f".{escape(path.name)}.*{ENDING}"):
        _remove_of_the_dead(file, file.name.removeprefix(f".{path.name}.").removesuffix(ENDING).split("."))


def remove_left_over_in(folder: Path) -> None:
    """Remove the partial files in `folder` of processes of this machine that have ended, whatever their target."""
    for file in folder.glob(f".*{ENDING}"):
        _remove_of_the_dead(file, file.name.removesuffix(ENDING).rsplit(".", 3)[1:])


def _remove_of_the_dead(file: Path, left_by: list[str]) -> None:
    """Remove `file` if the process that wrote it has ended; left_by: its host, its number, and a random word."""
    host = socket.gethostname().replace(".", "-")
    if len(left_by) == 3 and left_by[0] == host and left_by[1].isdecimal() and not lives(int(left_by[1])):
        file.unlink(missing_ok=True)


def size_text(size: float) -> str:
    """A number of bytes as text: 14.2 MB."""
    for unit in UNITS[:-1]:
        if size < 1000:
            return f"{size:.3g} {unit}"
        size /= 1000
    return f"{size:.3g} {UNITS[-1]}"


try:
    import fcntl
except ImportError:  # without it two processes that write the same file are not distinguished
    fcntl = None


def lives(process: int) -> bool:
    """Whether a process of that number runs on this machine, as far as can be determined without affecting it."""
    if os.name != "posix":  # there a signal of 0 is one that ends a process
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):  # it is another user's, or no number of a process
        return True
    return True


def locked(stream: IO[str]) -> bool:
    """Lock an open file that no other process has locked, until it is closed; whether that was so."""
    if fcntl is None:
        return True
    try:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
