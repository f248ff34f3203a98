"""TOML text with line numbers: the values as `tomllib` reads them, and the line of every key and list entry.

`tomllib` alone validates and parses the text. `_Walk` only finds lines in valid text, so it handles no more of the
grammar than the ends of values: headers, dotted keys, strings, lists and inline tables.
"""

from __future__ import annotations

import re
import tomllib
from bisect import bisect_right
from dataclasses import dataclass
from pathlib import Path as FilePath
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import read_regular

Path = tuple[str | int, ...]  # keys and list indices from the top of the document
LARGEST_INTEGER = 2**63 - 1  # TOML guarantees 64 bits; larger integers may overflow in floating point
DEEPEST = 40  # nested tables: no scene requires more; limits the recursion
MOST_BYTES = 1 << 22  # per file: some hundred thousand numbers
# a key with more parts, found before parsing (the parser's time is quadratic in their number)
_DEEP_KEY = re.compile(rf"""(?<![\w.'"-])(?>(?>[A-Za-z0-9_-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){{{DEEPEST}}}""")
MOST_DIGITS = 1000  # consecutive digits: no number requires more; Python converts at most 4,300
_LONG_INTEGER = re.compile(rf"(?<![0-9_])[0-9](?>_?[0-9]){{{MOST_DIGITS}}}")
_BARE = re.compile(r"[A-Za-z0-9_-]+")
_PLAIN = re.compile(r"[^,\]}#\n]+")
_BLANK = re.compile(r"(?:[ \t\n]|#[^\n]*)*")
_SPACE = re.compile(r"[ \t]*")
_STRINGS = (
    re.compile(r'"""(?:[^\\]|\\.)*?"{3,5}', re.DOTALL),
    re.compile(r"'''.*?'{3,5}", re.DOTALL),
    re.compile(r'"(?:[^"\\]|\\.)*"'),
    re.compile(r"'[^']*'"),
)


@dataclass(frozen=True)
class Place:
    """Origin of a value: a line of a file, or an option; its relative paths start from `folder`."""

    label: str
    folder: FilePath

    def __str__(self) -> str:
        return self.label


@dataclass
class Source:
    """A table and the place of every key and entry in it."""

    values: dict[str, Any]
    places: dict[Path, Place]

    def place(self, path: Path) -> Place:
        """The place of `path`, or of the innermost enclosing entry."""
        while path and path not in self.places:
            path = path[:-1]
        return self.places[path]


def read_source(file: FilePath, name: str) -> Source:
    """Read a TOML file; messages call it `name`. Raises `InputError` with the line of the error."""
    try:
        text = read_regular(file, MOST_BYTES).decode("utf-8-sig")
    except InputError as error:
        raise InputError(f"{name}: {error}; write tables of numbers to separate files") from None
    except UnicodeDecodeError as error:
        raise InputError(f"{name}: is not text in UTF-8 ({error.reason} at byte {error.start})") from None
    except (OSError, ValueError) as error:
        raise InputError(f"{name}: cannot be read ({getattr(error, 'strerror', None) or error})") from None
    return parse(text, name, file.parent)


def parse(text: str, name: str, folder: FilePath) -> Source:
    """`read_source` of a text."""
    text = text.replace("\r\n", "\n")
    if found := _DEEP_KEY.search(text):
        raise InputError(f"{name}:{text.count(chr(10), 0, found.start()) + 1}: invalid TOML: nested too deeply")
    if found := _LONG_INTEGER.search(text):  # also in texts and comments
        line = text.count(chr(10), 0, found.start()) + 1
        raise InputError(f"{name}:{line}: a number of more than {MOST_DIGITS} digits")
    try:
        values = tomllib.loads(text)
        lines = _Walk(text).lines()
    except tomllib.TOMLDecodeError as error:
        what, found = str(error), re.search(r"\(at line (\d+), column \d+\)$", str(error))
        at = f":{found[1]}" if found else ""
        if what.endswith("(at end of document)"):
            at = f":{text.count(chr(10)) + 1}"
        raise InputError(f"{name}{at}: invalid TOML: {what}") from None
    except RecursionError:
        raise InputError(f"{name}: invalid TOML: nested too deeply") from None
    places = {path: Place(f"{name}:{line}", folder) for path, line in lines.items()}
    places[()] = Place(name, folder)
    source = Source(values, places)
    _refuse_odd_values(source, values, ())
    return source


def _refuse_odd_values(source: Source, value: Any, path: Path) -> None:
    """Raises `InputError` for dates, times, integers above 64 bits and deep nesting."""
    if len(path) > DEEPEST:
        raise InputError(f"{source.place(path)}: nested too deeply")
    if isinstance(value, dict):
        for key, entry in value.items():
            _refuse_odd_values(source, entry, (*path, key))
    elif isinstance(value, list):
        for index, entry in enumerate(value):
            _refuse_odd_values(source, entry, (*path, index))
    elif not isinstance(value, bool | int | float | str):
        raise InputError(f"{source.place(path)}: {path[-1]!r} is a date or time, which has no meaning here")
    elif isinstance(value, int) and abs(value) > LARGEST_INTEGER:
        raise InputError(f"{source.place(path)}: {path[-1]!r} is an integer of more than 64 bits")


class _Walk:
    """Lines of all paths in a valid TOML text."""

    def __init__(self, text: str) -> None:
        self.text, self.at = text, 0
        self.ends = [m.start() for m in re.finditer("\n", text)]
        self.found: dict[Path, int] = {}
        self.lists: dict[Path, int] = {}  # number of entries of [[lists]] of tables up to here

    def lines(self) -> dict[Path, int]:
        table: Path = ()
        self._skip(_BLANK)
        while self.at < len(self.text):
            if self.text.startswith("[", self.at):
                table = self._header()
            else:
                self._pair(table)
            self._skip(_BLANK)
        return self.found

    def _skip(self, pattern: re.Pattern[str]) -> str:
        match = pattern.match(self.text, self.at)
        if match is None:
            return ""
        self.at = match.end()
        return match.group()

    def _note(self, path: Path) -> None:
        """Record the line of `path` and its parents; the first occurrence counts."""
        line = bisect_right(self.ends, self.at - 1) + 1
        for n in range(1, len(path) + 1):
            self.found.setdefault(path[:n], line)

    def _header(self) -> Path:
        begin, many = self.at, self.text.startswith("[[", self.at)
        self.at += 2 if many else 1
        path: Path = ()
        keys = self._keys()
        for n, key in enumerate(keys):
            path = (*path, key)
            if path in self.lists and not (many and n == len(keys) - 1):
                path = (*path, self.lists[path] - 1)
        if many:
            count = self.lists.get(path, 0)
            self.lists[path] = count + 1
            path = (*path, count)
        self.at += 2 if many else 1
        end, self.at = self.at, begin
        self._note(path)
        self.at = end
        return path

    def _keys(self) -> list[str]:
        keys = []
        while True:
            self._skip(_SPACE)
            if self.text[self.at] in "\"'":
                (key,) = tomllib.loads(f"{self._string()} = 0")
            else:
                key = self._skip(_BARE)
            keys.append(key)
            self._skip(_SPACE)
            if not self.text.startswith(".", self.at):
                return keys
            self.at += 1

    def _pair(self, table: Path) -> None:
        begin = self.at
        path = (*table, *self._keys())
        end, self.at = self.at, begin
        self._note(path)
        self.at = end + 1  # the equals sign
        self._skip(_SPACE)
        self._value(path)

    def _value(self, path: Path) -> None:
        opening = self.text[self.at]
        if opening in "\"'":
            self._string()
        elif opening not in "[{":
            self._skip(_PLAIN)
        else:
            self._entries(path, opening)

    def _entries(self, path: Path, opening: str) -> None:
        self.at += 1
        index = 0
        while True:
            self._skip(_BLANK)
            if self.text[self.at] in "]}":
                self.at += 1
                return
            if self.text[self.at] == ",":
                self.at += 1
            elif opening == "{":
                self._pair(path)
            else:
                self._note((*path, index))
                self._value((*path, index))
                index += 1

    def _string(self) -> str:
        for pattern in _STRINGS:
            text = self._skip(pattern)
            if text:
                return text
        raise IndexError("a string that tomllib accepted has no end")
