"""The lines of nodes and elements in an ASCII .msh file (2.x, 4.1): each has as many numbers as its kind needs.

meshio reads the numbers of a file as one long row: in an element line that lacks a node it takes a tag for one, and it
ends a number at the first character that it does not know. Its table of nodes is as long as the largest of their
numbers, and of more nodes than the file holds the rest is whatever was in memory. So the lines are looked at before it
reads them, and of binary files of 4.1 the nodes.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from warpffrf.model.errors import InputError

# nodes of Gmsh's element types, by number (Gmsh reference manual, "MSH file format")
NODES = {
    1: 2, 2: 3, 3: 4, 4: 4, 5: 8, 6: 6, 7: 5, 8: 3, 9: 6, 10: 9, 11: 10, 12: 27, 13: 18, 14: 14, 15: 1, 16: 8, 17: 20,
    18: 15, 19: 13,
}  # fmt: skip
SPARSE, FEW = 100, 10_000_000  # numbers of nodes go up to that many times their count, or to that
SHOWN = 60  # characters of a bad line in a message
_INTEGERS = re.compile(rb"\s*(?:[+-]?[0-9]+(?:\s+|\Z))+")
_REALS = re.compile(rb"\s*(?:[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?:\s+|\Z))+")

Lines = Iterator[tuple[int, bytes]]


def check_lines(path: Path) -> None:
    """Raise `InputError`, with the number of the line, for a line of nodes or elements with too few or too many numbers
    or with something else, and for nodes whose numbers are not positive, distinct and of a size that can be meant.
    Other binary files than those of 4.1 and other versions are left to meshio."""
    content = path.read_bytes()
    lines = enumerate(content.split(b"\n"), start=1)
    version = b""
    for _, line in lines:
        word = line.strip()
        if word == b"$MeshFormat":
            fields = next(lines, (0, b""))[1].split()
            if fields == [b"4.1", b"1", b"8"]:
                _check_numbers(path, _binary_nodes(path, content))
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


def _reals(path: Path, lines: Lines, what: str, count: int) -> float:
    """The first of the `count` numbers of the next line."""
    number, line = next(lines, (0, b""))
    words = line.split()
    if not _REALS.fullmatch(line) or len(words) != count:
        raise _fault(path, number, line, what)
    return float(words[0])


def _fault(path: Path, number: int, line: bytes, what: str) -> InputError:
    if not number:
        return InputError(f"mesh file {path.name}: ends within its nodes or elements; export it again")
    shown = line[:SHOWN].decode("ascii", errors="replace").strip()
    return InputError(f"mesh file {path.name}, line {number}: {shown!r} is not {what}; export it again")


def _check_numbers(path: Path, numbers: Sequence[int] | np.ndarray) -> None:
    """Raise `InputError` for numbers of nodes that are not positive, or twice there, or far above their count."""
    found = np.asarray(numbers, dtype=np.float64)
    if not len(found):
        return
    if found.min() < 1.0 or len(np.unique(found)) < len(found):
        raise InputError(f"mesh file {path.name}: node numbers are not positive and distinct; export it again")
    if found.max() > max(SPARSE * len(found), FEW):
        raise InputError(
            f"mesh file {path.name}: {len(found)} nodes have numbers up to {found.max():.0f}; renumber them in Gmsh"
        )


def _binary_nodes(path: Path, content: bytes) -> np.ndarray:
    """The numbers of the nodes of a binary file of 4.1."""
    fault = InputError(f"mesh file {path.name}: cannot be read (its nodes are damaged); export it again")
    at = content.find(b"\n$Nodes\n") + len(b"\n$Nodes\n")
    if len(content) < at + 32 or at < 16:
        raise fault
    blocks, total, _, _ = struct.unpack_from("=4Q", content, at)
    at, numbers = at + 32, [np.zeros(0, dtype=np.uint64)]
    for _ in range(blocks):
        if len(content) < at + 20:
            raise fault
        dim, _, parametric, count = struct.unpack_from("=3iQ", content, at)
        end = at + 20 + count * 8 * (4 + (dim if parametric else 0))
        if end > len(content) or not 0 <= dim <= 3:
            raise fault
        numbers.append(np.frombuffer(content, dtype=np.uint64, count=count, offset=at + 20))
        at = end
    found = np.concatenate(numbers)
    if len(found) != total:
        raise fault
    return found


def _nodes_2(path: Path, lines: Lines) -> None:
    numbers = []
    for _ in range(_integers(path, lines, "the number of nodes", 1)[0]):
        numbers.append(_reals(path, lines, "'number x y z' of a node", 4))
    _check_numbers(path, numbers)


def _elements_2(path: Path, lines: Lines) -> None:
    what = "'number type tags nodes' of an element, with all of its nodes"
    for _ in range(_integers(path, lines, "the number of elements", 1)[0]):
        number, line = next(lines, (0, b""))
        values = [int(word) for word in line.split()] if _INTEGERS.fullmatch(line) else []
        if len(values) < 3 or len(values) != 3 + values[2] + NODES.get(values[1], len(values) - 3 - values[2]):
            raise _fault(path, number, line, what)


def _nodes_41(path: Path, lines: Lines) -> None:
    blocks, total, _, _ = _integers(path, lines, "the four numbers of $Nodes", 4)
    numbers: list[int] = []
    for _ in range(blocks):
        dim, _, parametric, count = _integers(path, lines, "'dimension entity parametric count' of nodes", 4)
        for _ in range(count):
            numbers += _integers(path, lines, "the number of a node", 1)
        for _ in range(count):
            _reals(path, lines, "the coordinates of a node", 3 + (dim if parametric else 0))
    if len(numbers) != total:
        raise InputError(f"mesh file {path.name}: has {len(numbers)} nodes and says {total}; export it again")
    _check_numbers(path, numbers)


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
