"""An input deck as a list of keyword blocks: lines, continuations, comments and included files.

A keyword line begins with `*`, a comment with `**`; a keyword line that ends in a comma continues in the next line.
Keywords, parameters and names do not depend on upper or lower case, surrounding blanks are ignored, and a quoted name
may contain blanks and commas. The lines from a keyword line up to the next one are its data lines. `*Include` inserts
the lines of another file, so data lines may be in another file than their keyword.

The file and line of every block and data line are stored for messages.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import Budget, read_named, reason


@dataclass(frozen=True)
class Place:
    """A line of a file: `file` is the file's name, `line` counts from 1."""

    file: str
    line: int

    def fault(self, text: str) -> InputError:
        """An `InputError` that begins with the file and the line."""
        return InputError(f"{self}: {text}")

    def __str__(self) -> str:
        return f"{self.file}, line {self.line}"


@dataclass
class Block:
    """A keyword with its parameters and data lines.

    `keyword` is in capitals without blanks and without the `*`; the keys of `parameters` likewise, their values as in
    the file without quotes, None where a parameter has no value. `lines` are the raw data lines, comments included.
    """

    keyword: str
    parameters: dict[str, str | None]
    place: Place
    lines: list[str] = field(default_factory=list)
    _segments: list[tuple[int, str, int]] = field(default_factory=list)  # first line's index, file, line number

    def extend(self, lines: list[str], file: str, first: int) -> None:
        """Append data lines of `file` from line `first` on."""
        if lines:
            self._segments.append((len(self.lines), file, first))
            self.lines = self.lines + lines if self.lines else lines

    def place_of(self, index: int) -> Place:
        """Place of the data line with this index."""
        start, file, first = next(s for s in reversed(self._segments) if s[0] <= index)
        return Place(file, first + index - start)

    def data(self) -> Iterator[tuple[str, int]]:
        """The nonempty data lines, stripped, with their index."""
        for index, line in enumerate(self.lines):
            text = line.strip()
            if text and not text.startswith("**"):
                yield text, index

    def fields(self) -> Iterator[tuple[list[str], Place]]:
        """The data lines split at commas, blanks and quotes removed, a trailing comma dropped."""
        for text, index in self.data():
            place = self.place_of(index)
            parts = [unquoted(part) for part in split_commas(text)]
            yield parts[:-1] if not parts[-1] else parts, place

    def has(self, parameter: str) -> bool:
        """Whether the keyword line names the parameter, with or without a value."""
        return parameter in self.parameters

    def value(self, parameter: str) -> str | None:
        """The value of a parameter, None where it is not given or empty."""
        return self.parameters.get(parameter) or None

    def required(self, parameter: str) -> str:
        """The value of a required parameter."""
        value = self.value(parameter)
        if value is None:
            raise self.place.fault(f"*{self.keyword} needs {parameter}=")
        return value


def read_blocks(path: Path) -> list[Block]:
    """The blocks of a deck and of the files that it includes, in the order of the lines.

    Raises `InputError` when a file is missing or includes itself, and when text precedes the first keyword.
    """
    blocks: list[Block] = []
    _Reader(path, blocks).read(_lines(read_named(path, "mesh file")), path, [])
    return blocks


class _Reader:
    """Divides the lines of the deck `main` and of its includes into `blocks`."""

    def __init__(self, main: Path, blocks: list[Block]) -> None:
        self.main, self.blocks, self.budget = main, blocks, Budget()

    def read(self, lines: list[str], path: Path, chain: list[Path]) -> None:
        """The lines of `path`, which the files of `chain` include."""
        starts = [i for i, line in enumerate(lines) if line.lstrip()[:1] == "*" and line.lstrip()[:2] != "**"]
        _append(lines[: starts[0] if starts else len(lines)], 0, path, self.blocks)
        for start, stop in pairwise([*starts, len(lines)]):
            place = Place(path.name, start + 1)
            text, data = _header(lines, start, stop)
            block = _parse_header(text, place)
            if block.keyword == "INCLUDE":
                self._include(block.required("INPUT"), place, path, chain)
            else:
                self.blocks.append(block)
                if block.keyword in ("NODE", "ELEMENT") and block.value("INPUT"):  # its data lines lie in another file
                    self._include(block.required("INPUT"), place, path, chain)
            _append(lines[data:stop], data, path, self.blocks)

    def _include(self, name: str, place: Place, path: Path, chain: list[Path]) -> None:
        """Read the file `name`, searched next to the including file, then next to the deck itself."""
        here = [*chain, path.resolve()]
        for folder in (path.parent, self.main.parent):
            candidate = folder / name.replace("\\", "/")
            try:
                if not candidate.exists():
                    continue
                content, resolved = self.budget.read(candidate, len(here)), candidate.resolve()
            except (OSError, ValueError) as error:  # an invalid name, or a file that may not be read
                raise place.fault(f"the included file {name[:200]!r} cannot be read ({reason(error)})") from None
            if resolved in here:
                raise place.fault(f"{name!r} includes itself; remove one of the *Include lines")
            self.read(_lines(content), candidate, here)
            return
        raise place.fault(f"the included file {name[:200]!r} does not exist; put it next to the deck")


def _append(lines: list[str], index: int, path: Path, blocks: list[Block]) -> None:
    """Append data lines to the last keyword, which may be in another file."""
    if blocks:
        blocks[-1].extend(lines, path.name, index + 1)
        return
    for i, line in enumerate(lines):
        if line.strip() and not line.strip().startswith("**"):
            place = Place(path.name, index + i + 1)
            raise place.fault("text before the first keyword: is this an Abaqus or CalculiX deck?")


def _lines(raw: bytes) -> list[str]:
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = raw.decode("latin-1")  # never fails; matters for names and comments only
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def _header(lines: list[str], start: int, stop: int) -> tuple[str, int]:
    """The keyword line with its continuations, and the index of the first data line."""
    text = lines[start].strip()
    index = start + 1
    while text.endswith(",") and index < stop:
        more = lines[index].strip()
        index += 1
        if not more.startswith("**"):
            text += more
            if not more:  # a blank line ends the keyword too
                break
    return text, index


def _parse_header(text: str, place: Place) -> Block:
    keyword, *rest = split_commas(text[1:])
    parameters: dict[str, str | None] = {}
    for part in rest:
        key, equals, value = part.partition("=")
        key = "".join(key.split()).upper()
        if key:
            parameters[key] = unquoted(value) if equals else None
    return Block("".join(keyword.split()).upper(), parameters, place)


def split_commas(text: str) -> list[str]:
    """`text` split at the commas outside quotes."""
    if '"' not in text:
        return text.split(",")
    parts, current, quoted = [], [], False
    for character in text:
        if character == '"':
            quoted = not quoted
        if character == "," and not quoted:
            parts.append("".join(current))
            current = []
        else:
            current.append(character)
    return [*parts, "".join(current)]


def unquoted(text: str) -> str:
    """`text` without the blanks around it and without quotes."""
    text = text.strip()
    if len(text) >= 2 and text[0] == text[-1] == '"':
        return text[1:-1].strip()
    return text.replace('"', "")
