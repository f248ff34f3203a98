"""Output paths are checked before a run, not after it, and files are written whole or not at all.

Nothing that exists is replaced unless that is asked for, and then only what warpffrf has written, which its files say
at their beginning or end. A file is written beside its target, under a name of the process and the machine that write
it, and renamed: so nobody touches the file of another, and what a killed process has left is removed when its target is
written the next time.
"""

from __future__ import annotations

import errno
import logging
import os
import re
import secrets
import socket
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from glob import escape
from pathlib import Path

from warpffrf.model.errors import InputError
from warpffrf.model.files.processes import lives

# How a format begins, and what warpffrf writes into such a file: its name alone may stand in anybody's
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
    """`path` as a Path that can be written: missing folders are made, an existing file is left as it is.

    ours: tells whether warpffrf wrote a file, `written_here` if None. Raises InputError naming `what` (for instance
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
            log.info("%s: the folder '%s' is new", what, target.parent)
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
            f"{what}: '{target}' was not written by warpffrf and stays; choose another name, or remove it first"
        )


def written_here(file: Path) -> bool:
    """Whether a file says that warpffrf wrote it, or is empty."""
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
    format misleads whoever opens it. Folders are left to `checked_output_path`."""
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
    """A name beside `path` of this process and machine."""
    host = socket.gethostname().replace(".", "-")
    return path.with_name(f".{path.name}.{host}.{os.getpid()}.{secrets.token_hex(4)}{ENDING}")


def remove_left_over(path: Path) -> None:
    """Remove what processes of this machine that are no more have left beside `path`."""
    for file in path.parent.glob(f".{escape(path.name)}.*{ENDING}"):
        _remove_of_the_dead(file, file.name.removeprefix(f".{path.name}.").removesuffix(ENDING).split("."))


def remove_left_over_in(folder: Path) -> None:
    """Remove what processes of this machine that are no more have left in `folder`, whatever it was to be."""
    for file in folder.glob(f".*{ENDING}"):
        _remove_of_the_dead(file, file.name.removesuffix(ENDING).rsplit(".", 3)[1:])


def _remove_of_the_dead(file: Path, left_by: list[str]) -> None:
    """Remove `file` if the process that wrote it is no more; left_by: its host, its number, and a random word."""
    host = socket.gethostname().replace(".", "-")
    if len(left_by) == 3 and left_by[0] == host and left_by[1].isdecimal() and not lives(int(left_by[1])):
        file.unlink(missing_ok=True)


def size_text(size: float) -> str:
    """A number of bytes as people say it: 14.2 MB."""
    for unit in UNITS[:-1]:
        if size < 1000:
            return f"{size:.3g} {unit}"
        size /= 1000
    return f"{size:.3g} {UNITS[-1]}"
