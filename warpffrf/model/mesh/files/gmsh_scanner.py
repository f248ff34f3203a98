"""The numbers of a .msh file, line by line of a text or one behind the other in a binary file."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.files.regular_file import MOST_DIGITS

Array = np.ndarray

SHOWN = 60  # characters of a bad line in a message


class Scanner:
    """The content of a file, as text or binary, from `at` on."""

    def __init__(self, path: Path, content: bytes) -> None:
        self.path, self.content = path, content
        self.at, self.line = 0, 0
        self.binary, self.order, self.version = False, "<", b""
        self._words: list[bytes] = []

    def fault(self, what: str, line: bytes | None = None, number: int | None = None) -> InputError:
        if self.binary:
            return self.damaged(what)
        if self.at >= len(self.content) and line is None:
            return InputError(f"mesh file {self.path.name}: cannot be read (it ends too early); export it again")
        shown = (line or b"")[:SHOWN].decode("ascii", errors="replace").strip()
        at = number or self.line
        return InputError(f"mesh file {self.path.name}, line {at}: {shown!r} is not {what}; export it again")

    def damaged(self, what: str) -> InputError:
        return InputError(f"mesh file {self.path.name}: cannot be read ({what}); export it again")

    def text_line(self) -> bytes:
        """The next line without its end."""
        end = self.content.find(b"\n", self.at)
        end = len(self.content) if end < 0 else end
        found = self.content[self.at : end]
        self.at, self.line = end + 1, self.line + 1
        return found

    def take(self, form: str, what: str) -> list:
        """Numbers: i an int, n a size, d a double; of a text the next words, from the next line where a line ends."""
        if self.binary:
            layout = self.order + form.replace("n", "Q")
            size = struct.calcsize(layout)
            if self.at + size > len(self.content):
                raise self.damaged("it ends too early")
            values = list(struct.unpack_from(layout, self.content, self.at))
            self.at += size
            return values
        if form and not self._words:
            line = self.text_line()
            self._words = line.split()[::-1]
            if not self._words:
                raise self.fault(what, line)
        values = []
        for letter in form:
            if not self._words:
                raise self.fault(what, b"")
            values.append(self._number(self._words.pop(), letter == "d", what))
        return values

    def end(self, what: str) -> None:
        """The line has no more words."""
        if self._words:
            raise self.fault(what, b" ".join(self._words[::-1]))

    def head(self, form: str, what: str) -> list:
        """The numbers of a line of their own."""
        values = self.take(form, what)
        self.end(what)
        return values

    def _number(self, word: bytes, real: bool, what: str) -> float | int:
        try:
            if b"_" in word or (not real and len(word) > MOST_DIGITS):
                raise ValueError
            value = float(word) if real else int(word)
        except ValueError:
            raise self.fault(what, word) from None
        if not np.isfinite(value):
            raise self.fault(what, word)
        return value

    def table(self, count: int, ints: int, reals: int, what: str, size: str = "i") -> tuple[Array, Array]:
        """`count` lines of `ints` whole numbers and `reals` finite ones: (count, ints) and (count, reals)."""
        if self.binary:
            layout = np.dtype([("n", self.order + {"i": "i4", "n": "u8"}[size], ints), ("x", self.order + "f8", reals)])
            if not 0 <= count <= (len(self.content) - self.at) // layout.itemsize:
                raise self.damaged("it ends too early")
            rows = np.frombuffer(self.content, layout, count, self.at)
            self.at += count * layout.itemsize
            if not np.isfinite(rows["x"]).all() or (ints and np.any(rows["n"] > np.uint64(10**MOST_DIGITS))):
                raise self.damaged(f"{what} holds no numbers")
            return rows["n"].astype(np.int64).reshape(count, ints), rows["x"].astype(float).reshape(count, reals)
        lines, begin = self.lines(count, what)
        words = [line.split() for line in lines]
        for number, row in enumerate(words):
            if len(row) != ints + reals:
                raise self.fault(what, lines[number], begin + number)
        try:
            if any(b"_" in line for line in lines):
                raise ValueError
            n = np.array([int(w) for row in words for w in row[:ints]], dtype=np.int64)
            x = np.array([float(w) for row in words for w in row[ints:]], dtype=float)
        except (ValueError, OverflowError):
            n, x = np.zeros(0, dtype=np.int64), np.full(1, np.nan)
        if not np.isfinite(x).all() or (len(n) and np.abs(n).max() >= 10**MOST_DIGITS):
            bad = next(i for i, row in enumerate(words) if not are_numbers(row, ints))
            raise self.fault(what, lines[bad], begin + bad)
        return n.reshape(count, ints), x.reshape(count, reals)

    def lines(self, count: int, what: str) -> tuple[list[bytes], int]:
        """The next `count` lines, and the number of the first."""
        if not 0 <= count <= len(self.content) - self.at:
            raise self.damaged(f"it says {count} lines, more than it has")
        begin = self.line + 1
        found = [self.text_line() for _ in range(count) if self.at < len(self.content)]
        if len(found) < count:
            raise self.damaged("it ends too early")
        return found, begin


def are_numbers(words: list[bytes], ints: int) -> bool:
    """Whether the first `ints` words are whole numbers and the others finite ones."""
    try:
        whole = all(len(w) <= MOST_DIGITS and b"_" not in w and int(w) is not None for w in words[:ints])
        return whole and all(b"_" not in w and np.isfinite(float(w)) for w in words[ints:])
    except ValueError:
        return False
