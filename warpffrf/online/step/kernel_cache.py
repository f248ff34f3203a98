"""Warp's cache of compiled kernels: files are loaded only as the compiler wrote them.

Warp loads an object file without a check; a damaged file crashes the process or stops every run until the folder is
deleted. Each module's folder therefore gets a seal, the sha256 of its files, once it has been compiled and loaded. A
folder without a seal, or with different content, is removed and recompiled. What Warp compiles for another kind of
processor is kept in the same folder and sealed with it. While one process handles a module, others wait at a lock file
(where file locks are available), and then find it compiled.

Killed compilations leave folders `*_pPID_tTHREAD`; those of processes that have ended are removed.
"""

from __future__ import annotations

import hashlib
import json
import logging
import os
import re
import shutil
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import warp as wp

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import lives
from warpffrf.online.warp_start import kernels_not_kept

try:
    import fcntl
except ImportError:  # Windows: processes that start simultaneously compile in parallel, as Warp allows
    fcntl = None

logger = logging.getLogger("warpffrf.online")
SEAL = "warpffrf.seal"
SOURCES = (".cpp", ".cu")
UNFINISHED = re.compile(r"wp_.*_p([0-9]+)_t[0-9]+")
UNFINISHED_FOR = 600.0  # seconds without a change; its process may belong to another machine or container

_known: dict[Path, list[Path]] = {}  # folders that this process has verified or sealed, with what they held then
_in_hand = threading.local()  # names of the modules that a thread handles: their locks are not acquired again


def remove_unfinished() -> None:
    """Remove the folders that killed compilations on this machine have left."""
    for folder in Path(wp.config.kernel_cache_dir or ".").glob("wp_*_p*_t*"):
        found = UNFINISHED.fullmatch(folder.name)
        try:
            if found and not lives(int(found[1])) and time.time() - folder.stat().st_mtime > UNFINISHED_FOR:
                shutil.rmtree(folder)
                logger.info("kernel cache: %s, left by a process that has ended, is removed", folder.name)
        except OSError:
            continue  # it only occupies disk space


@contextmanager
def sound(module: Any) -> Iterator[None]:
    """Load the Warp `module` within this block: its cached folders are verified before and sealed afterwards.

    Raises `InputError` if a damaged folder cannot be removed, and if kernels that are compiled cannot be written.
    """
    root, name = Path(wp.config.kernel_cache_dir or "."), f"wp_{module.name}"
    names: set[str] = vars(_in_hand).setdefault("names", set())
    if name in names:
        yield
        return
    with _alone(root / f"{name}.lock"):
        names.add(name)
        try:
            for folder in _folders(root, name):
                if not _is_sealed(folder):
                    _remove(folder)
            try:
                yield
            except OSError as error:
                raise kernels_not_kept(error) from None
            for folder in _folders(root, name):
                _seal(folder)
        finally:
            names.remove(name)


def _folders(root: Path, name: str) -> list[Path]:
    """The folders of a module, one per content and block size, that this process has not checked as they are now."""
    pattern = re.compile(re.escape(name) + "_[0-9a-f]{7}")
    found = [root / entry for entry in os.listdir(root) if pattern.fullmatch(entry)]
    return [folder for folder in found if _known.get(folder) != _files(folder)]


def _remove(folder: Path) -> None:
    damaged = (folder / SEAL).is_file()
    was = "is damaged" if damaged else "was not finished or is of an earlier version"
    level = logging.WARNING if damaged else logging.INFO
    logger.log(level, "kernel cache: %s %s, it is compiled anew", folder, was)
    try:
        shutil.rmtree(folder)
    except OSError as error:
        if not damaged:  # a read-only cache that was prepared in advance
            logger.warning("kernel cache: %s has no seal and cannot be removed, it is used as it is", folder)
            return
        raise InputError(
            f"kernel cache: {folder} {was} and cannot be removed ({error.strerror or error}); remove it, or set "
            "WARP_CACHE_PATH to another folder"
        ) from None


def _files(folder: Path) -> list[Path]:
    """The files that are loaded; source files are excluded."""
    return [
        path
        for path in sorted(folder.iterdir())
        if not path.name.startswith(SEAL) and path.suffix not in SOURCES and path.is_file()
    ]


def _digests(folder: Path) -> dict[str, str]:
    """sha256 of each file that is loaded."""
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in _files(folder)}


def _is_sealed(folder: Path) -> bool:
    try:
        found = json.loads((folder / SEAL).read_bytes()) == _digests(folder)
    except (OSError, ValueError, RecursionError):
        found = False
    if found:
        _known[folder] = _files(folder)
    return found


def _seal(folder: Path) -> None:
    """Write the seal. A cache that cannot be written to is recompiled next time."""
    part = folder / f"{SEAL}.{os.getpid()}"
    try:
        text = json.dumps(_digests(folder))
        part.write_text(text)
        part.replace(folder / SEAL)
        _known[folder] = _files(folder)
    except OSError as error:
        logger.info("kernel cache: %s cannot be sealed (%s)", folder, error)


@contextmanager
def _alone(path: Path) -> Iterator[None]:
    """Hold the lock file `path`, if the system and the file system support such locks."""
    try:
        lock = path.open("ab") if fcntl is not None else None
    except OSError:
        lock = None
    if lock is None or fcntl is None:
        yield
        return
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX)  # released when the file is closed, also if the process is killed
        except OSError:
            pass
        yield
