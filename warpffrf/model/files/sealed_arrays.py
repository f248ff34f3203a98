"""Named arrays in one sealed file without HDF5: quick to write, and beside other work, as it holds no lock of Python.

    mark (16), length of the header (8), header, the bytes of all arrays one behind the other, seal (`sealed_file`)

The header is JSON: `about`, what whoever writes the file wants to say, and of each array its name, type and shape.
Sizes are compared with the length of the file before anything is allocated.
"""

from __future__ import annotations

import hashlib
import json
import math
import struct
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.output_paths import written_whole
from warpffrf.model.files.sealed_file import require_sealed, seal_of

MARK = b"warpffrf arrays\n"
HEAD = struct.Struct("<16sQ")


def write_arrays(path: Path, about: Mapping[str, Any], arrays: Mapping[str, Sequence[np.ndarray]]) -> None:
    """Write `about` (JSON) and `arrays`, each given in blocks, one at least, that follow each other along the first
    axis. `path` is written whole or stays as it was. Raises OSError where it cannot be written."""
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
    length = require_sealed(path, subject, cure)
    try:
        with path.open("rb") as file:
            mark, size = HEAD.unpack(file.read(HEAD.size))
            if mark != MARK or size > length - HEAD.size:
                raise ValueError("it is no file of arrays")
            header = json.loads(file.read(size))
            entries = [(str(e["name"]), _type(e["type"]), tuple(map(int, e["shape"]))) for e in header["arrays"]]
            counts = [math.prod(shape) for _, _, shape in entries]
            total = sum(count * kind.itemsize for (_, kind, _), count in zip(entries, counts, strict=True))
            if any(n < 0 for _, _, shape in entries for n in shape) or total != length - HEAD.size - size:
                raise ValueError("its arrays have other sizes than it says")
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
    yield HEAD.pack(MARK, len(header)) + header
    for blocks in arrays:
        for block in blocks:
            yield np.ascontiguousarray(block).reshape(-1).view(np.uint8).data


def _type(described: Any) -> np.dtype:
    """The type that `dtype_to_descr` described; JSON knows no tuples."""
    kind = np.lib.format.descr_to_dtype(_fields(described) if isinstance(described, list) else described)
    if kind.hasobject or not kind.itemsize:
        raise ValueError(f"arrays of {kind} are not kept")
    return kind


def _fields(described: list[Any]) -> list[tuple[Any, ...]]:
    found = []
    for name, kind, *shape in described:
        inner = _fields(kind) if isinstance(kind, list) else kind
        found.append((name, inner, *(tuple(s) for s in shape)))
    return found
