"""A work file from which an interrupted reduction is resumed.

Finished parts (the modes, each block of static responses) are appended as records

    magic (4), length (8), checksum (4), payload: an .npz archive of the part's arrays and its name,

so a truncated file keeps all records before the cut, and damage is detected. The first record contains a signature of
everything that determines the numbers in addition to the key of the input; with another signature the work restarts.
Records are buffered and written every few seconds: a short reduction writes no file, a killed one loses those seconds.
"""

from __future__ import annotations

import io
import json
import logging
import os
import struct
import time
import zipfile
import zlib
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO

import numpy as np

logger = logging.getLogger("warpffrf.offline")
Array = np.ndarray
MAGIC = b"WFP1"
HEADER = struct.Struct("<4sQI")
SUFFIX = ".part"
SECONDS = 3.0  # between writes: longer loses more of a killed run, shorter writes files for very short reductions
NAME = "__name__"
UNREADABLE = (OSError, ValueError, KeyError, EOFError, MemoryError, zipfile.BadZipFile)  # errors of a damaged archive


class Checkpoint:
    """Parts finished so far: `get` and `put` by name. Use as a context manager around the work.

    Leaving the context normally removes the file; an error or an interruption keeps it, and an interruption logs how to
    resume. Without a `path` nothing is kept on disk. A file that cannot be written is reported once and abandoned: it
    must not lose the work.
    """

    def __init__(self, path: Path | None = None, *, seconds: float = SECONDS) -> None:
        self.path = path
        self.seconds = seconds
        self.found = 0  # parts reused from an earlier run
        self._records: dict[str, tuple[int, int]] = {}  # position and length of the payload in the file
        self._waiting: dict[str, bytes] = {}
        self._written = time.monotonic()
        self._file: BinaryIO | None = None

    def begin(self, signature: dict[str, Any]) -> None:
        """Load the parts of an earlier run with the same `signature` (plain data); new parts are stored with it."""
        text = json.dumps(signature, sort_keys=True)
        first = _packed("signature", {"text": np.array(text)})
        self._waiting = {"signature": first}
        if self.path is None or not self.path.is_file():
            return
        try:
            records, end, size = _scan(self.path)
            same = "signature" in records and str(self._read(*records["signature"])["text"]) == text
        except UNREADABLE as error:
            self._drop(f"cannot be read: {error}")
            return
        if not records:
            self._drop("is damaged")
        elif not same:
            self._drop("belongs to other settings or another solver")
        else:
            if end < size:
                logger.warning("work file %s: damaged after %d parts, those are used", self.path, len(records) - 1)
                with self.path.open("r+b") as file:
                    file.truncate(end)
            self._records, self._waiting = records, {}
            self.found = len(records) - 1
            logger.info("continuing with %d finished parts of %s", self.found, self.path)

    def get(self, name: str) -> dict[str, Array] | None:
        """Arrays of part `name`, None if it is not finished."""
        if name in self._waiting:
            return _unpacked(self._waiting[name])
        if name not in self._records:
            return None
        try:
            return self._read(*self._records[name])
        except UNREADABLE as error:  # checked when found, so the file has changed since
            logger.warning("work file %s: part %r cannot be read (%s), it is recomputed", self.path, name, error)
            del self._records[name]
            return None

    def put(self, name: str, arrays: dict[str, Array]) -> None:
        """Store the finished part `name`."""
        if self.path is None:
            return
        self._waiting[name] = _packed(name, arrays)
        if time.monotonic() - self._written >= self.seconds:
            self.flush()

    def flush(self) -> None:
        """Write the buffered records to the disk."""
        if self.path is None or not self._waiting:
            return
        try:
            if self._file is None:
                self.path.parent.mkdir(parents=True, exist_ok=True)
                self._file = self.path.open("ab")
            for name, payload in self._waiting.items():
                header = HEADER.pack(MAGIC, len(payload), zlib.crc32(payload))
                start = self._file.seek(0, os.SEEK_END)
                self._file.write(header + payload)
                self._records[name] = start + HEADER.size, len(payload)
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            logger.warning(
                "work file %s cannot be written, an interrupted run restarts from the beginning: %s", self.path, error
            )
            self.path = None
            return
        self._waiting = {}
        self._written = time.monotonic()

    def remove(self) -> None:
        """Discard all parts and delete the file."""
        self._close()
        self._waiting, self._records = {}, {}
        if self.path is not None:
            try:
                self.path.unlink(missing_ok=True)
            except OSError:
                pass  # a remaining file only costs space; the next run of this input finds the cache entry first

    def __enter__(self) -> Checkpoint:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error is None:
            self.remove()
            return
        self.flush()
        self._close()
        if isinstance(error, KeyboardInterrupt) and self.path is not None and len(self._records) > 1:
            raise KeyboardInterrupt(
                f"interrupted; {len(self._records) - 1} finished parts are kept in {self.path}: call reduce with the "
                "same input to continue from there"
            ) from error

    def _read(self, start: int, length: int) -> dict[str, Array]:
        if self.path is None:
            raise OSError("the work file was abandoned")
        with self.path.open("rb") as file:
            file.seek(start)
            return _unpacked(file.read(length))

    def _drop(self, reason: str) -> None:
        logger.warning("work file %s %s: dropped, the reduction restarts from the beginning", self.path, reason)
        if self.path is not None:
            try:
                self.path.unlink(missing_ok=True)
            except OSError:
                self.path = None

    def _close(self) -> None:
        if self._file is not None:
            self._file.close()
            self._file = None


def _packed(name: str, arrays: dict[str, Array]) -> bytes:
    buffer = io.BytesIO()
    np.savez(buffer, **{NAME: np.array(name)}, **arrays)  # pyright: ignore[reportArgumentType]
    return buffer.getvalue()


def _opened(payload: bytes) -> Any:
    """The archive of a record; ValueError if it is compressed, which ours are not: its size would be unbounded."""
    with zipfile.ZipFile(io.BytesIO(payload)) as archive:
        if any(entry.compress_type != zipfile.ZIP_STORED for entry in archive.infolist()):
            raise ValueError("its records are compressed")
    return np.load(io.BytesIO(payload), allow_pickle=False)


def _unpacked(payload: bytes) -> dict[str, Array]:
    with _opened(payload) as archive:
        return {key: archive[key] for key in archive.files if key != NAME}


def _scan(path: Path) -> tuple[dict[str, tuple[int, int]], int, int]:
    """Undamaged leading records of a file (name -> position and length of the payload), their end, the file's size."""
    records: dict[str, tuple[int, int]] = {}
    size = path.stat().st_size
    end = 0
    with path.open("rb") as file:
        while header := file.read(HEADER.size):
            if len(header) < HEADER.size:
                break
            magic, length, checksum = HEADER.unpack(header)
            if magic != MAGIC or length > size - file.tell():
                break
            payload = file.read(length)
            if zlib.crc32(payload) != checksum:
                break
            try:
                with _opened(payload) as archive:
                    name = str(archive[NAME])
            except UNREADABLE:
                break
            records[name] = end + HEADER.size, length
            end = file.tell()
    return records, end, size
