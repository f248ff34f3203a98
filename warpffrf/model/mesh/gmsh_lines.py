"""The lines of nodes and elements in an ASCII .msh file (2.x, 4.1): each has as many numbers as its kind needs.

meshio reads the numbers of a file as one long row: in an element line that lacks a node it takes a tag for one, and it
ends a number at the first character that it does not know. So the lines are looked at before it reads them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from warpffrf.model.errors import InputError

# nodes of Gmsh's element types, by number (Gmsh reference manual, "MSH file format")
NODES = {
    1: 2, 2: 3, 3: 4, 4: 4, 5: 8, 6: 6, 7: 5, 8: 3, 9: 6, 10: 9, 11: 10, 12: 27, 13: 18, 14: 14, 15: 1, 16: 8, 17: 20,
    18: 15, 19: 13,
}  # fmt: skip
SHOWN = 60  # characters of a bad line in a message
_INTEGERS = re.compile(rb"\s*(?:[+-]?[0-9]+(?:\s+|\Z))+")
_REALS = re.compile(rb"\s*(?:[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?:\s+|\Z))+")

Lines = Iterator[tuple[int, bytes]]


def check_lines(path: Path) -> None:
    """Raise `InputError`, with the number of the line, for a line of nodes or elements with too few or too many numbers
    or with something else. Binary files and other versions are left to meshio."""
    lines = enumerate(path.read_bytes().split(b"\n"), start=1)
    version = b""
    for _, line in lines:
        word = line.strip()
        if word == b"$MeshFormat":
            fields = next(lines, (0, b""))[1].split()
            if len(fields) != 3 or fields[1] != b"0":
                return
            version = fields[0]
        check = _SECTIONS.get((version[:2] if version.startswith(b"2") else version, word))
        if check is not None:
            check(path, lines)


def _integers(path: Path, lines: Lines, what: str, count: int | None = None) -> list[int]:
    """The integers of the next line, `count` of them."""
    number, line = next(lines, (0, b""))
    if not _INTEGERS.fullmatch(line):
        raise _fault(path, number, line, what)
    values = [int(word) for word in line.split()]
    if count is not None and len(values) != count:
        raise _fault(path, number, line, what)
    return values


def _reals(path: Path, lines: Lines, what: str, count: int) -> None:
    number, line = next(lines, (0, b""))
    if not _REALS.fullmatch(line) or len(line.split()) != count:
        raise _fault(path, number, line, what)


def _fault(path: Path, number: int, line: bytes, what: str) -> InputError:
    if not number:
        return InputError(f"mesh file {path.name}: ends within its nodes or elements; export it again")
    shown = line[:SHOWN].decode("ascii", errors="replace").strip()
    return InputError(f"mesh file {path.name}, line {number}: {shown!r} is not {what}; export it again")


def _nodes_2(path: Path, lines: Lines) -> None:
    for _ in range(_integers(path, lines, "the number of nodes", 1)[0]):
        _reals(path, lines, "'number x y z' of a node", 4)


def _elements_2(path: Path, lines: Lines) -> None:
    what = "'number type tags nodes' of an element, with all of its nodes"
    for _ in range(_integers(path, lines, "the number of elements", 1)[0]):
        number, line = next(lines, (0, b""))
        values = [int(word) for word in line.split()] if _INTEGERS.fullmatch(line) else []
        if len(values) < 3 or len(values) != 3 + values[2] + NODES.get(values[1], len(values) - 3 - values[2]):
            raise _fault(path, number, line, what)


def _nodes_41(path: Path, lines: Lines) -> None:
    for _ in range(_integers(path, lines, "the four numbers of $Nodes", 4)[0]):
        dim, _, parametric, count = _integers(path, lines, "'dimension entity parametric count' of nodes", 4)
        for _ in range(count):
            _integers(path, lines, "the number of a node", 1)
        for _ in range(count):
            _reals(path, lines, "the coordinates of a node", 3 + (dim if parametric else 0))


def _elements_41(path: Path, lines: Lines) -> None:
    for _ in range(_integers(path, lines, "the four numbers of $Elements", 4)[0]):
        _, _, kind, count = _integers(path, lines, "'dimension entity type count' of elements", 4)
        for _ in range(count):
            wanted = 1 + NODES[kind] if kind in NODES else None
            _integers(path, lines, "'number nodes' of an element, with all of its nodes", wanted)


_SECTIONS = {
    (b"2.", b"$Nodes"): _nodes_2,
    (b"2.", b"$Elements"): _elements_2,
    (b"4.1", b"$Nodes"): _nodes_41,
    (b"4.1", b"$Elements"): _elements_41,
}
