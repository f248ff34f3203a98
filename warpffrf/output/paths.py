"""Output paths are checked before a run, not after it."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from warpffrf.model.errors import InputError


def checked_output_path(path: str | os.PathLike[str], what: str) -> Path:
    """`path` as a Path that can be written: missing folders are made, an existing file is left as it is.

    Raises InputError naming `what` (for instance "record") when the path is a folder, when a parent is not a folder,
    or when the folder or file cannot be written.
    """
    target = Path(path).expanduser()
    if target.is_dir():
        raise InputError(f"{what}: '{target}' is a folder; give the name of a file in it")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=target.parent, prefix=".warpffrf-"):
            pass
        if target.exists():
            with target.open("ab"):
                pass
    except OSError as error:
        raise InputError(
            f"{what}: '{target}' cannot be written ({error.strerror or error}); choose a folder that you may write to"
        ) from error
    return target


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
    partial = path.with_name(path.name + ".part")
    try:
        yield partial
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)
