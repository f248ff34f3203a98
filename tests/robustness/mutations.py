"""Damage to files: what disks, transfers, editors and faulty writers do, drawn from a seeded generator."""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

ODD = (
    b"nan", b"inf", b"-inf", b"1e999", b"-1", b"0", b"1e308", b"99999999999999999999", b"4294967297", b"2147483648",
    b"-0", b"1e-320", b"0x10", b"1_0", b"1,5", b"\xd9\xa3", b"True", b"1.5D6", b"1e15",
)  # fmt: skip
CONTROLS = (b"\0", b"\x1b[31m", b"\xff\xfe", b"\r", b"\xe2\x80\xae", b"\t", b"\x0c")
_NUMBER = re.compile(rb"[-+]?\d+\.?\d*(?:[eEdD][-+]?\d+)?")
_WORD = re.compile(rb"[^\s,]+")


def of_bytes(data: bytes, rng: random.Random) -> tuple[bytes, str]:
    """The file with a change that knows nothing of its format, and what was done."""
    d, n, p = bytearray(data), len(data), rng.randrange(len(data))
    q, length = rng.randrange(n), rng.choice((1, 8, 64, 512, 4096))
    kind = rng.choice(_BYTES)
    if kind == "bit":
        d[p] ^= 1 << rng.randrange(8)
    elif kind == "byte":
        d[p] = rng.choice((0, 255, 128, 127, 1))
    elif kind == "cut":
        del d[p:]
    elif kind == "zero":
        d[p : p + length] = bytes(len(d[p : p + length]))
    elif kind == "copy":
        d[q : q + length] = d[p : p + length]
    elif kind == "swap":
        d[p], d[q] = d[q], d[p]
    elif kind == "insert":
        d[p:p] = rng.randbytes(length)
    elif kind == "delete":
        del d[p : p + length]
    elif kind == "append":
        d += rng.randbytes(length)
    else:
        for _ in range(16):
            d[rng.randrange(n)] ^= 1 << rng.randrange(8)
    return bytes(d), f"{kind} {p} {q} {length}"


def of_text(data: bytes, rng: random.Random) -> tuple[bytes, str]:
    """The file with a number, word, line or character changed, and what was done."""
    kind = rng.choice((*["number"] * 4, *_LINES, *_CHARACTERS, *_WORDS))
    if kind == "number":
        found = rng.choice(list(_NUMBER.finditer(data)))
        new = rng.choice(ODD)
        return _put(data, found.span(), new), f"number {found[0]!r} {new!r} at {found.start()}"
    if kind in _LINES:
        lines = data.split(b"\n")
        i, j = rng.randrange(len(lines)), rng.randrange(len(lines))
        _LINES[kind](lines, i, j)
        return b"\n".join(lines), f"{kind} {i + 1} {j + 1}"
    if kind in _CHARACTERS:
        p = rng.randrange(len(data))
        return _CHARACTERS[kind](data, p, rng), f"{kind} {p}"
    words = list(_WORD.finditer(data))
    one, other = rng.choice(words), rng.choice(words)
    new = {
        "delete word": b"",
        "double word": one[0] + b", " + one[0],
        "case": one[0].swapcase(),
        "other word": other[0],
    }
    return _put(data, one.span(), new[kind]), f"{kind} {one[0]!r} {other[0]!r} at {one.start()}"


def _put(data: bytes, span: tuple[int, int], new: bytes) -> bytes:
    return data[: span[0]] + new + data[span[1] :]


def _swap(lines: list[bytes], i: int, j: int) -> None:
    lines[i], lines[j] = lines[j], lines[i]


_BYTES = ("bit", "bit", "bit", "byte", "cut", "zero", "copy", "swap", "insert", "delete", "append", "bits")
_LINES: dict[str, Callable[[list[bytes], int, int], None]] = {
    "delete line": lambda lines, i, j: lines.__delitem__(i),
    "double line": lambda lines, i, j: lines.insert(i, lines[i]),
    "swap lines": _swap,
}
_CHARACTERS: dict[str, Callable[[bytes, int, random.Random], bytes]] = {
    "character": lambda data, p, rng: _put(data, (p, p + 1), bytes([rng.randrange(32, 127)])),
    "cut": lambda data, p, rng: data[:p],
    "control": lambda data, p, rng: _put(data, (p, p), rng.choice(CONTROLS)),
}
_WORDS = ("delete word", "double word", "case", "other word")


def of_arrays(path: Path, rng: random.Random) -> str:
    """Change one array or attribute of the HDF5 file as a faulty writer would, in place; returns what was done."""
    import h5py

    with h5py.File(path, "r+") as file:
        names: list[str] = []
        file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        names = [name for name in names if name not in ("facts", "report", "provenance")]
        kind = rng.choice(list(_ARRAYS))
        if kind == "attribute":
            name = rng.choice(list(file.attrs))
            file.attrs[name] = rng.choice(["", "[", "{}", "[1]", '["x"]', "null", 10**9, np.zeros(3), "[" * 60000])
            return f"attribute {name}"
        name = rng.choice(names)
        dataset: Any = file[name]
        if kind == "huge":
            attributes, dtype = dict(dataset.attrs), dataset.dtype
            shape = dataset.shape or (1,)
            del file[name]
            made = file.create_dataset(name, shape=(1 << rng.choice((30, 40)), *shape[1:]), dtype=dtype, chunks=True)
            made.attrs.update(attributes)
        elif kind == "unknown":
            file.create_dataset("unknown/thing", shape=(1 << 30,), dtype="f8", chunks=True)
        elif kind == "elsewhere":
            del file[name]
            file[name] = h5py.ExternalLink("elsewhere.h5", "/x")
        elif kind == "gone":
            del file[name]
        else:
            old, attributes = dataset[()], dict(dataset.attrs)
            del file[name]
            file.create_dataset(name, data=_ARRAYS[kind](np.asarray(old))).attrs.update(attributes)
        return f"{kind} {name}"


def _bad_number(array: np.ndarray) -> np.ndarray:
    new = array.copy()
    if new.size and new.dtype.kind == "f":
        new.reshape(-1)[new.size // 2] = np.nan
    elif new.size:
        new.reshape(-1)[new.size // 2] = np.iinfo(new.dtype).max if new.dtype.kind in "iu" else 0
    return new


_ARRAYS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "bad number": _bad_number,
    "short": lambda a: a[:-1] if a.ndim else a,
    "long": lambda a: np.concatenate([a, a[:1]]) if a.ndim else a,
    "flat": lambda a: a.reshape(-1),
    "turned": lambda a: a.T.copy(),
    "empty": lambda a: a[:0] if a.ndim else a,
    "text": lambda a: np.array(b"text"),
    "complex": lambda a: a.astype(complex) if a.dtype.kind in "iuf" else a,
    "huge": lambda a: a,
    "unknown": lambda a: a,
    "elsewhere": lambda a: a,
    "gone": lambda a: a,
    "attribute": lambda a: a,
}
