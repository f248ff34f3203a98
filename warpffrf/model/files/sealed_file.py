"""A checksum over a whole file, behind its last byte, looked at before anything else of it: before the HDF5 library
opens a file of its own, and before arrays are read from one without it (`sealed_arrays`).

The library may loop for ever, or allocate what a damaged header asks for, so damage has to be seen in the raw bytes.
The seal is 96 bytes behind the file,

    mark (16), length of what stands before (8), version (4), zeros (4), sha256 of what stands before (32), zeros (16),
    mark (16),

which HDF5 ignores: a file says in its first bytes where it ends. h5py, h5dump, netCDF and xarray open a sealed file as
any other. A user block in front of the file would be as legal, but a file with one no longer begins with the signature
of HDF5, by which xarray, `file` and we ourselves know it. A program that changes the file overwrites the seal; the
result counts as damaged until `seal` is called again. A seal tells damage, not malice: whoever makes a file can seal
it.

Files of versions before the seal have none. Whoever reads one asks for it by the schema that the file says it has.
"""

from __future__ import annotations

import hashlib
import logging
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

from warpffrf.model.errors import InputError
from warpffrf.model.files.hdf5_probe import probe
from warpffrf.model.files.output_paths import written_whole

logger = logging.getLogger("warpffrf.model")
SIGNATURE = b"\x89HDF\r\n\x1a\n"
MARK = b"warpffrf sealed\n"
VERSION = 1
BLOCK = 1 << 20  # bytes read at once
TRAILER = struct.Struct("<16sQI4x32s16x16s")
_END_AT = {0: 40, 1: 44, 2: 28, 3: 28}  # where a superblock of that version holds the file's end; 8 bytes each


@contextmanager
def written_sealed(path: Path) -> Iterator[Any]:
    """An open HDF5 file, which is `path`, sealed, when the block ends without an error; else `path` stays as it was.

    It is made in memory: where a disk is full in the middle of a file, the HDF5 library takes the process with it.
    Raises OSError where it cannot be written.
    """
    import h5py

    with h5py.File(path.name, "w", driver="core", backing_store=False, block_size=BLOCK) as file:
        yield file
        file.flush()
        image = file.id.get_file_image()
    with written_whole(path) as partial:
        partial.write_bytes(image)
        seal(partial)


def seal(path: Path) -> None:
    """Append the seal to the closed HDF5 file `path`. Raises OSError where it cannot be written."""
    with path.open("r+b") as file:
        digest = hashlib.file_digest(file, "sha256").digest()
        file.write(seal_of(file.tell(), digest))


def seal_of(length: int, digest: bytes) -> bytes:
    """The seal of `length` bytes with the sha256 `digest`."""
    return TRAILER.pack(MARK, length, VERSION, digest, MARK)


def verify(path: Path, subject: str, cure: str) -> bool:
    """Whether the HDF5 file `path` has a seal that is right; False for a whole file without a seal, of older versions.

    Raises `InputError`, "`subject` is damaged (why); `cure`", where the bytes are not those that were sealed, where the
    file is cut off or longer than it says, where it cannot be read or is no HDF5 file, and where one without a seal
    holds up the HDF5 library.
    """
    try:
        fault, has_seal = _look(path)
    except OSError as error:
        raise InputError(f"{subject} cannot be read ({error.strerror or error}); check the path") from None
    if fault:
        raise InputError(f"{subject} is damaged ({fault}); {cure}")
    if not has_seal:
        probe(path, subject, cure)
    return has_seal


def require_sealed(path: Path, subject: str, cure: str) -> int:
    """Bytes before the seal of `path`, which may hold anything. Raises `InputError`, "`subject` is damaged (why);
    `cure`", without a seal, where the bytes are not those that were sealed, and where it cannot be read."""
    try:
        with path.open("rb") as file:
            size, end = _end_of(file)
            fault = _broken(file, size, end)
    except OSError as error:
        raise InputError(f"{subject} cannot be read ({error.strerror or error}); check the path") from None
    if fault:
        raise InputError(f"{subject} is damaged ({fault}); {cure}")
    return size - TRAILER.size


def require_seal(has_seal: bool, schema: int, since: int, subject: str, cure: str) -> None:
    """Raise `InputError` for a file without a seal of a schema that has one, `since` and later; log that damage to an
    older one cannot be seen."""
    if has_seal:
        return
    if schema >= since:
        raise InputError(
            f"{subject} is damaged or was changed by another program (its checksum is missing); {cure}, or take a copy "
            "from before the change"
        )
    logger.warning("%s is of an older version and has no checksum: damage to it may not be noticed; %s", subject, cure)


def _look(path: Path) -> tuple[str, bool]:
    """What is wrong with the bytes of `path`, "" for nothing, and whether they are sealed."""
    with path.open("rb") as file:
        start = file.read(64)
        size, end = _end_of(file)
        if end.startswith(MARK) or end.endswith(MARK):
            return _broken(file, size, end), True
    if not start.startswith(SIGNATURE):
        return "it is not an HDF5 file", False
    ends = _end(start)
    if ends is None:
        return "its header cannot be read", False
    if ends != size:
        return f"it has {size} bytes and should have {ends}", False
    return "", False


def _end_of(file: BinaryIO) -> tuple[int, bytes]:
    """The size of an open file, and what stands where its seal would."""
    size = file.seek(0, 2)
    file.seek(max(size - TRAILER.size, 0))
    return size, file.read(TRAILER.size)


def _broken(file: BinaryIO, size: int, end: bytes) -> str:
    """What is wrong with the open `file` of `size` bytes with the seal `end`."""
    if len(end) < TRAILER.size or not (end.startswith(MARK) or end.endswith(MARK)):
        return "it is cut off"
    length = TRAILER.unpack(end)[1]
    if length != size - TRAILER.size:
        return f"it has {size - TRAILER.size} bytes and should have {length}"
    file.seek(0)
    sha, left = hashlib.sha256(), length
    while left:
        block = file.read(min(left, BLOCK))
        if not block:
            return "it changed while it was read"
        sha.update(block)
        left -= len(block)
    if seal_of(length, sha.digest()) != end:
        return "its checksum differs"
    return ""


def _end(start: bytes) -> int | None:
    """The length that an HDF5 file says it has in its first bytes; None where it says none."""
    at = _END_AT.get(start[8] if len(start) > 8 else -1)
    if at is None or len(start) < at + 8:
        return None
    return int.from_bytes(start[at : at + 8], "little")
