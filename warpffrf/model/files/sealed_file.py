"""Files with a checksum after their last byte, checked before anything else: HDF5 files, and files of named arrays
without HDF5, which are fast to write, also in parallel, as writing does not hold Python's lock.

The HDF5 library may loop for ever, or allocate what a damaged header requests, so damage must be detected in the raw
bytes. The seal is 96 bytes after the file,

    mark (16), length of the preceding bytes (8), version (4), zeros (4), sha256 of the preceding bytes (32), zeros
    (16), mark (16),

which HDF5 ignores: the first bytes of a file state where it ends. h5py, h5dump, netCDF and xarray open a sealed file as
any other. A user block in front of the file would be as legal, but a file with one no longer begins with the signature
of HDF5, by which xarray, `file` and we ourselves know it. A program that changes the file overwrites the seal; the
result counts as damaged until `seal` is called again. A seal detects damage, not manipulation: anyone who writes a file
can seal it.

A file of arrays is

    mark (16), length of the header (8), header, the bytes of all arrays in sequence, seal.

The header is JSON: `about`, the writer's own data, and of each array its name, type and shape.
Sizes are compared with the length of the file before anything is allocated.
"""

from __future__ import annotations

import hashlib
import io
import json
import math
import struct
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import written_whole

MARK = b"warpffrf sealed\n"
VERSION = 1
BLOCK = 1 << 20  # bytes read at once
TRAILER = struct.Struct("<16sQI4x32s16x16s")
ARRAYS = b"warpffrf arrays\n"
HEAD = struct.Struct("<16sQ")
UNSEALED = "its checksum is missing: it is truncated, another program has changed it, or it is no file of warpffrf"


@contextmanager
def written_sealed(path: Path) -> Iterator[Any]:
    """An open HDF5 file, which is `path`, sealed, when the block ends without an error; else `path` is not changed.

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


class _Disk(io.FileIO):
    """A file that keeps its first error in `trouble` and then reports success: HDF5 crashes on a failure while it
    closes a file."""

    trouble: OSError | None = None

    def write(self, data: Any) -> int:
        left = memoryview(data)
        while len(left) and self.trouble is None:
            left = left[self._tried(super().write, left) :]
        return len(data)

    def truncate(self, size: int | None = None) -> int:
        return self._tried(super().truncate, size)

    def _tried(self, call: Callable[[Any], int], value: Any) -> int:
        try:
            return call(value)
        except OSError as error:
            self.trouble = self.trouble or error
            return 0

    def check(self) -> None:
        if self.trouble is not None:
            raise self.trouble


@contextmanager
def streamed_sealed(path: Path) -> Iterator[tuple[Any, Callable[[], None]]]:
    """As `written_sealed`, for files larger than memory: an open HDF5 file, and a call that writes what is in it to the
    disk. Raises OSError, also by that call, where it cannot be written."""
    import h5py

    with written_whole(path) as partial:
        with _Disk(partial, "w+") as disk:
            with h5py.File(disk, "w") as file:

                def flush() -> None:
                    file.flush()
                    disk.check()

                yield file, flush
            disk.check()
        seal(partial)


def seal(path: Path) -> None:
    """Append the seal to the closed HDF5 file `path`. Raises OSError where it cannot be written."""
    with path.open("r+b") as file:
        digest = hashlib.file_digest(file, "sha256").digest()
        file.write(seal_of(file.tell(), digest))


def seal_of(length: int, digest: bytes) -> bytes:
    """The seal of `length` bytes with the sha256 `digest`."""
    return TRAILER.pack(MARK, length, VERSION, digest, MARK)


def verify(path: Path, subject: str, cure: str) -> int:
    """Bytes before the seal of `path`. Raises `InputError`, "`subject` is damaged (why); `cure`", without a seal, where
    the bytes are not those that were sealed, and where the file cannot be read."""
    try:
        with path.open("rb") as file:
            size, fault = _look(file)
    except OSError as error:
        raise InputError(f"{subject} cannot be read ({error.strerror or error}); check the path") from None
    if fault:
        raise InputError(f"{subject} is damaged ({fault}); {cure}")
    return size - TRAILER.size


def check_schema(found: int, schema: int, subject: str, cure: str) -> None:
    """Raise `InputError` for a file of another schema than `schema`, with the cure."""
    if found != schema:
        raise InputError(
            f"{subject} has schema {found}, this version of warpffrf reads schema {schema} alone; {cure} with this "
            "version, or open the file with the version that wrote it"
        )


def _look(file: BinaryIO) -> tuple[int, str]:
    """The size of an open file, and its fault, "" for none."""
    size = file.seek(0, 2)
    file.seek(max(size - TRAILER.size, 0))
    end = file.read(TRAILER.size)
    if len(end) < TRAILER.size or not (end.startswith(MARK) or end.endswith(MARK)):
        return size, UNSEALED
    length = TRAILER.unpack(end)[1]
    if length != size - TRAILER.size:
        return size, f"it has {size - TRAILER.size} bytes and should have {length}"
    file.seek(0)
    sha, left = hashlib.sha256(), length
    while left:
        block = file.read(min(left, BLOCK))
        if not block:
            return size, "it changed while it was read"
        sha.update(block)
        left -= len(block)
    return size, "" if seal_of(length, sha.digest()) == end else "its checksum differs"


def write_arrays(path: Path, about: Mapping[str, Any], arrays: Mapping[str, Sequence[np.ndarray]]) -> None:
    """Write `about` (JSON) and `arrays`, each given in blocks, one at least, that follow each other along the first
    axis. `path` is written completely or not changed. Raises OSError where it cannot be written."""
    entries = [
        {"name": name, "type": np.lib.format.dtype_to_descr(blocks[0].dtype), "shape": _shape(blocks)}
        for name, blocks in arrays.items()
    ]
    header = json.dumps({"about": about, "arrays": entries}).encode()
    sha, length = hashlib.sha256(), 0
    with written_whole(path) as partial, partial.open("wb") as file:
        for piece in _pieces(header, arrays.values()):
            sha.update(piece)
            file.write(piece)
            length += len(piece)
        file.write(seal_of(length, sha.digest()))


def read_arrays(path: Path, subject: str, cure: str) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """What `write_arrays` wrote: `about`, and the arrays by name. Raises `InputError`, "`subject` is damaged (why);
    `cure`", for any other file."""
    length = verify(path, subject, cure)
    try:
        with path.open("rb") as file:
            mark, size = HEAD.unpack(file.read(HEAD.size))
            if mark != ARRAYS or size > length - HEAD.size:
                raise ValueError("it is no file of arrays")
            header = json.loads(file.read(size))
            entries = [(str(e["name"]), _type(e["type"]), tuple(map(int, e["shape"]))) for e in header["arrays"]]
            counts = [math.prod(shape) for _, _, shape in entries]
            total = sum(count * kind.itemsize for (_, kind, _), count in zip(entries, counts, strict=True))
            if any(n < 0 for _, _, shape in entries for n in shape) or total != length - HEAD.size - size:
                raise ValueError("its arrays do not have their declared sizes")
            found = {
                name: np.fromfile(file, kind, count).reshape(shape)
                for (name, kind, shape), count in zip(entries, counts, strict=True)
            }
        return dict(header["about"]), found
    except OSError as error:
        raise InputError(f"{subject} cannot be read ({error.strerror or error}); check the path") from None
    except (ValueError, TypeError, KeyError, OverflowError, struct.error, RecursionError) as error:
        raise InputError(f"{subject} is damaged ({error}); {cure}") from None


def _shape(blocks: Sequence[np.ndarray]) -> list[int]:
    if len(blocks) == 1:
        return list(blocks[0].shape)
    return [sum(len(block) for block in blocks), *blocks[0].shape[1:]]


def _pieces(header: bytes, arrays: Iterable[Sequence[np.ndarray]]) -> Iterable[Any]:
    """The bytes of the file up to its seal."""
    yield HEAD.pack(ARRAYS, len(header)) + header
    for blocks in arrays:
        for block in blocks:
            yield np.ascontiguousarray(block).reshape(-1).view(np.uint8).data


def _type(described: Any) -> np.dtype:
    """The type that `dtype_to_descr` described; JSON knows no tuples."""
    kind = np.lib.format.descr_to_dtype(_fields(described) if isinstance(described, list) else described)
    if kind.hasobject or not kind.itemsize:
        raise ValueError(f"arrays of {kind} cannot be stored")
    return kind


def _fields(described: list[Any]) -> list[tuple[Any, ...]]:
    found = []
    for name, kind, *shape in described:
        inner = _fields(kind) if isinstance(kind, list) else kind
        found.append((name, inner, *(tuple(s) for s in shape)))
    return found
