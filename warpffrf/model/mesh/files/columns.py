"""Lines of a text file, and tables of numbers in columns of fixed width, as Fortran writes them.

A table of a million lines is read as arrays of characters, one row per line, without a loop over lines. A blank integer
is 0, and where a program omits trailing zeros, a real too. Every other character that is not of a number is refused,
with the file and the line.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import MOST_DIGITS, read_named

Array = np.ndarray

CHUNK = 1 << 13  # lines whose characters are held at once, in the cache of a core
PART = 1 << 20  # bytes in which line ends are searched at once
WIDEST = 1000  # characters of a line of a table
SHOWN = 60  # characters of a bad line in a message
_ITEM = re.compile(r"(?:[0-9]?p,?)?([0-9]{0,3})([ieda])([0-9]{1,3})(?:\.[0-9]{1,3}(?:e[0-9])?)?", re.IGNORECASE)
_REAL = re.compile(rb"[+-]?+(?>[0-9]++\.?+[0-9]*+|\.[0-9]++)(?>[Ee]?+[+-][0-9]++|[Ee][0-9]++)?+")
_LETTERLESS = re.compile(rb"(?<=[0-9.])([+-])")  # of three digits Fortran omits the E
_BLANK = np.uint8(ord(" "))
_RANK = np.full(256, 3, dtype=np.uint8)  # 0: blank, 1: minus, 2: digit, 3: other
_RANK[ord(" ")], _RANK[ord("-")], _RANK[list(b"0123456789")] = 0, 1, 2
_UPPER = np.frombuffer(bytes(range(256)).upper().replace(b"D", b"E"), dtype=np.uint8)
_POWERS = 10.0 ** np.arange(23)  # exact


class Lines:
    """The lines of the text file `path`, numbered from 0; `kind` of file in messages."""

    def __init__(self, path: Path, kind: str) -> None:
        self.label = f"{kind} {path.name}"
        content = read_named(path, kind)
        content = content.replace(b"\r\n", b"\n") if b"\r\n" in content else content
        self.bytes = np.frombuffer(content if content.endswith(b"\n") else content + b"\n", dtype=np.uint8)
        parts = range(0, len(self.bytes), PART)
        self.stops = np.concatenate([at + np.flatnonzero(self.bytes[at : at + PART] == ord("\n")) for at in parts])
        self.starts = np.concatenate([[0], self.stops[:-1] + 1])

    def __len__(self) -> int:
        return len(self.stops)

    def text(self, i: int) -> str:
        return self.bytes[self.starts[i] : self.stops[i]].tobytes().decode("latin-1").rstrip()

    def fault(self, i: int, what: str) -> InputError:
        """An error that begins with the file and the line with index `i`."""
        return InputError(f"{self.label}, line {min(i, len(self) - 1) + 1}: {what}")

    def short(self, i: int) -> str:
        """Line `i` for messages."""
        return repr(self.text(i).strip()[:SHOWN])

    def table(
        self, rows: Array, integers: Sequence[int], reals: Sequence[int] = (), *, needed: int | None = None
    ) -> tuple[Array, Array]:
        """Integers (n, i) int64 and then reals (n, r) float64 of the lines `rows`, columns of the given widths; the
        reals from number `needed` on may be missing at the end of a line (None: none of them), and are 0.

        Raises `InputError` for other characters, numbers too large, and text behind the columns.
        """
        whole, real = np.zeros((len(rows), len(integers)), dtype=np.int64), np.zeros((len(rows), len(reals)))
        edges = np.cumsum([0, *integers, *reals])
        for at in range(0, len(rows), CHUNK):
            part = np.asarray(rows[at : at + CHUNK])
            characters = np.ascontiguousarray(self._characters(part, int(edges[-1])).T)  # one place in all lines: a row
            ended = np.zeros(len(part), dtype=bool)  # lines whose last reals are missing
            for k, (a, b) in enumerate(zip(edges[:-1], edges[1:], strict=True)):
                field = characters[a:b]
                if k < len(integers):
                    whole[at : at + CHUNK, k] = self._integers(part, field, k)
                    continue
                blank = np.all(field == _BLANK, axis=0) if a < self._filled else np.ones(len(part), dtype=bool)
                lost = (ended & ~blank) | (blank if needed is None or k - len(integers) < needed else False)
                if np.any(lost):
                    i = int(part[np.argmax(lost)])
                    raise self.fault(i, f"{self.short(i)}: column {k + 1} is empty; write the file again")
                ended = blank
                if not blank.all():
                    real[at : at + CHUNK, k - len(integers)] = self._reals(part, field, k)
        return whole, real

    def _characters(self, rows: Array, width: int) -> Array:
        """Characters (n, width) of the lines, filled up with blanks."""
        lengths = self.stops[rows] - self.starts[rows]
        longest = int(lengths.max(initial=0))
        self._filled = longest
        if longest > max(width, WIDEST):
            raise self.fault(int(rows[np.argmax(lengths)]), f"has {longest} characters; write the file again")
        first, last = int(self.starts[rows[0]]), int(self.stops[rows[-1]])
        if len(rows) * (longest + 1) == last + 1 - first:  # lines of one length that follow each other
            found = self.bytes[first : last + 1].reshape(len(rows), longest + 1)[:, :-1]
        else:
            place = np.arange(longest)
            index = self.starts[rows][:, None] + place
            np.minimum(index, len(self.bytes) - 1, out=index)
            found = np.where(place < lengths[:, None], self.bytes[index], _BLANK)
        if longest < width:
            found = np.pad(found, ((0, 0), (0, width - longest)), constant_values=_BLANK)
        behind = np.flatnonzero(np.any(found[:, width:] != _BLANK, axis=1))
        if len(behind):
            i = int(rows[behind[0]])
            raise self.fault(i, f"{self.short(i)} has text behind its {width} columns; write the file again")
        return found[:, :width]

    def _integers(self, rows: Array, field: Array, k: int) -> Array:
        """The numbers (n,) in the characters `field` (w, n) of column k, up to its right edge."""
        value, sound = _whole(field)
        if not sound.all():
            i = int(rows[np.argmin(sound)])
            raise self.fault(i, f"{self.short(i)}: column {k + 1} is no integer; write the file again")
        return value

    def _reals(self, rows: Array, field: Array, k: int) -> Array:
        """The numbers (n,) in the characters `field` (w, n) of column k."""
        value, left = _aligned(field)
        for i in np.flatnonzero(left).tolist():
            value[i] = self._real(int(rows[i]), field[:, i].tobytes(), k)
        if not np.all(np.isfinite(value)):
            i = int(rows[np.argmin(np.isfinite(value))])
            raise self.fault(i, f"{self.short(i)} holds a number that is too large; write the file again")
        return value

    def _real(self, row: int, text: bytes, k: int) -> float:
        text = text.strip().replace(b"D", b"E").replace(b"d", b"E")
        if not text:
            return 0.0
        if not _REAL.fullmatch(text):
            raise self.fault(row, f"{self.short(row)}: column {k + 1} is no number; write the file again")
        return float(text if b"E" in text.upper() else _LETTERLESS.sub(rb"E\1", text))


def _whole(field: Array) -> tuple[Array, Array]:
    """Integers (n,) of characters (w, n), and which are sound: blanks, a minus, digits."""
    rank = _RANK[field]
    sound = np.all(rank[1:] >= rank[:-1], axis=0) & (rank[-1] < 3) & (rank[-1] != 1)
    minus = rank == 1
    signed = minus.any(axis=0)
    if signed.any():
        sound &= minus.sum(axis=0) < 2
        field = np.where(minus, _BLANK, field)
    if len(field) > MOST_DIGITS:
        sound &= np.sum(rank == 2, axis=0) <= MOST_DIGITS
    value = _digits(field)
    return np.where(signed, -value, value), sound


def _digits(field: Array) -> Array:
    """The number (n,) that digits and blanks (w, n) form; blanks count as zeros."""
    value = np.zeros(field.shape[1], dtype=np.int64)
    for at in range(0, len(field), 9):
        part = np.zeros(field.shape[1], dtype=np.uint32)
        for row in field[at : at + 9]:
            part *= np.uint32(10)
            part += row & np.uint8(15)
        value = value * 10 ** len(field[at : at + 9]) + part
    return value


def _aligned(field: Array) -> tuple[Array, Array]:
    """Reals (n,) of characters (w, n), and which are left to do: all that are not like the first one, with the point
    and the exponent at the same place. Exact: of at most 15 digits, times or over a power of ten below 1e23."""
    count = field.shape[1]
    like = re.fullmatch(rb" *([+-]?)([0-9]+)\.([0-9]*)[EeDd]([+-])([0-9]{1,3}) *", field[:, 0].tobytes())
    if like is None or len(like[2]) + len(like[3]) > 15:
        return np.zeros(count), np.ones(count, dtype=bool)
    begin, dot, exponent = like.start(2), like.end(2), like.end(3)
    mantissa, power = np.r_[begin:dot, dot + 1 : exponent], np.r_[slice(*like.span(5))]
    sound = np.all(_RANK[field[np.r_[mantissa, power]]] == 2, axis=0) & (field[dot] == ord("."))
    negative = field[exponent + 1] == ord("-")
    sound &= (_UPPER[field[exponent]] == ord("E")) & (negative | (field[exponent + 1] == ord("+")))
    blank = np.r_[0 : max(begin - 1, 0), like.end(5) : len(field)]
    sound &= np.all(field[blank] == _BLANK, axis=0)
    minus = np.zeros(count, dtype=bool)
    if begin:
        minus = field[begin - 1] == ord("-")
        sound &= minus | (field[begin - 1] == ord("+")) | (field[begin - 1] == _BLANK)
    e = _digits(field[power])
    e = np.where(negative, -e, e) - len(like[3])
    sound &= np.abs(e) <= 22
    scale = _POWERS[np.minimum(np.abs(e), 22)]
    whole = _digits(field[mantissa])
    found = np.where(e < 0, whole / scale, whole * scale)
    return np.where(sound, np.where(minus, -found, found), 0.0), ~sound


def widths(form: str) -> tuple[list[int], list[int]] | None:
    """Widths of the integers (and words) and of the reals of a Fortran format such as (3i9,6e21.13e3); None for another
    text."""
    text = form.strip().strip("()")
    integers: list[int] = []
    reals: list[int] = []
    for item in text.replace(" ", "").split(","):
        found = _ITEM.fullmatch(item)
        if found is None or (found[2].lower() in "ia" and reals):
            return None
        count = int(found[1] or 1)
        if not 0 < count <= 100 or not int(found[3]):
            return None
        (integers if found[2].lower() in "ia" else reals).extend([int(found[3])] * count)
    return integers, reals
