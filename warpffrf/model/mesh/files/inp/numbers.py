"""Tables of numbers in a deck: nodes, elements and the members of sets, read in bulk.

A table of 100,000 lines is joined and converted in one go; only when that fails are the lines looked at one by one, to
name the one at fault.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.mesh.files.inp.deck import Block, Place

LARGEST_NUMBER = 2**53  # of a node or element: exact as a float, far above what a program numbers


@dataclass(frozen=True, eq=False)
class Table:
    """Numbered rows of a block: `labels` (m,), `rows` (m, k), and the index of each row's data line."""

    block: Block
    labels: np.ndarray
    rows: np.ndarray
    lines: np.ndarray

    def place(self, row: int) -> Place:
        """Where a row begins."""
        return self.block.place_of(int(self.lines[row]))


def node_table(block: Block) -> Table:
    """Node numbers and coordinates (m, 3): `number, x, y, z`; what is not given is 0."""
    texts, lines = [], []
    for text, index in block.data():
        texts.append(text.rstrip(", \t"))
        lines.append(index)
    values = None
    if all(text.count(",") == 3 for text in texts):
        values = _floats(",".join(texts)) if texts else np.zeros(0)
    if values is None:
        values = np.array([_node(text, block.place_of(i)) for text, i in zip(texts, lines, strict=True)])
    values = values.reshape(-1, 4)
    good = np.isfinite(values).all(axis=1) & (values[:, 0] == np.floor(values[:, 0]))
    good &= (values[:, 0] >= 1) & (values[:, 0] <= LARGEST_NUMBER)
    if not good.all():
        row = int(np.flatnonzero(~good)[0])
        raise block.place_of(lines[row]).fault(f"a node is 'number, x, y, z' with finite values, got {texts[row]!r}")
    return Table(block, values[:, 0].astype(np.int64), values[:, 1:], np.array(lines, dtype=np.int64))


def _node(text: str, place: Place) -> list[float]:
    fields = [field.strip() for field in text.split(",")]
    values = _floats(",".join(field or "0" for field in fields[:4])) if fields[0] else None
    if values is None:
        raise place.fault(f"a node is 'number, x, y, z', got {text!r}")
    return [*values.tolist(), *[0.0] * (4 - len(values))]


def element_table(block: Block, nodes: int) -> Table:
    """Element numbers and their node numbers (m, nodes); the numbers of one element may take several lines.

    Raises `InputError` naming the line where an element has too many or too few numbers, or one that is none.
    """
    wanted = nodes + 1
    texts: list[str] = []
    starts: list[int] = []  # index in `texts` of the first line of each element
    indices: list[int] = []
    have = 0
    for text, index in block.data():
        text = text.rstrip(", \t")
        if have == 0:
            starts.append(len(texts))
        texts.append(text)
        indices.append(index)
        have += text.count(",") + 1
        if have > wanted:
            place = block.place_of(indices[starts[-1]])
            kind = block.value("TYPE")
            raise place.fault(f"an element of type {kind} has a number and {nodes} nodes, got {have} values")
        if have == wanted:
            have = 0
    if have:
        place = block.place_of(indices[starts[-1]])
        raise place.fault(f"the element has {have - 1} of {nodes} nodes; is the deck cut off here?")
    values = _integers(",".join(texts)) if texts else np.zeros(0, dtype=np.int64)
    if values is None:
        row = next(i for i, text in enumerate(texts) if _integers(text) is None)
        raise block.place_of(indices[row]).fault(f"element and node numbers are whole and positive, got {texts[row]!r}")
    values = values.reshape(-1, wanted)
    lines = np.array(indices, dtype=np.int64)[starts] if starts else np.zeros(0, dtype=np.int64)
    return Table(block, values[:, 0], values[:, 1:], lines)


def element_numbers(block: Block) -> np.ndarray:
    """The numbers of elements whose nodes are of no interest; lines without one are passed over."""
    labels, begins = [], True
    for text, _ in block.data():
        if begins:
            value = _integers(text.split(",", 1)[0])
            if value is not None:
                labels.append(int(value[0]))
        begins = not text.endswith(",")
    return np.array(labels, dtype=np.int64)


def set_members(block: Block) -> tuple[np.ndarray, list[tuple[str, Place]]]:
    """The members listed by a set: numbers, and names of other sets with their places."""
    texts = [text.rstrip(", \t") for text, _ in block.data()]
    numbers = _integers(",".join(texts)) if texts else np.zeros(0, dtype=np.int64)
    if numbers is not None:
        return numbers, []
    found: list[np.ndarray] = []
    names: list[tuple[str, Place]] = []
    for fields, place in block.fields():
        for word in fields:
            number = _integers(word)
            if number is not None:
                found.append(number)
            elif word and not _looks_like_number(word):
                names.append((word, place))
            else:
                raise place.fault(f"a member of a set is a whole positive number or a name, got {word!r}")
    return np.concatenate([np.zeros(0, dtype=np.int64), *found]), names


def set_ranges(block: Block) -> list[tuple[int, int, int]]:
    """The ranges (first, last, step) of a set with GENERATE."""
    ranges = []
    for fields, place in block.fields():
        values = _integers(",".join(fields))
        if values is None or len(values) not in (2, 3) or values[1] < values[0]:
            raise place.fault(f"a generated range is 'first, last, step', got {', '.join(fields)!r}")
        ranges.append((int(values[0]), int(values[1]), int(values[2]) if len(values) == 3 else 1))
    return ranges


def number_or_none(text: str) -> int | None:
    """A node or element number, or None where `text` is a name."""
    value = _integers(text)
    return None if value is None else int(value[0])


def reals(fields: list[str], place: Place, what: str, least: int) -> list[float]:
    """Finite numbers, blanks as 0; raises `InputError` naming `what` for anything else or fewer than `least`."""
    values = _floats(",".join(field or "0" for field in fields))
    if values is None or len(values) < least or not np.all(np.isfinite(values)):
        raise place.fault(f"{what} needs {least} finite number(s), got {', '.join(fields)!r}")
    return values.tolist()


def _looks_like_number(text: str) -> bool:
    return text[:1] in "+-.0123456789<"  # "<" is a *Parameter that a deck wants replaced


def _floats(text: str) -> np.ndarray | None:
    """Numbers between commas, Fortran's `1.5D-3` among them, or None."""
    if "_" in text:  # Python would take 1_000 for a number
        return None
    try:
        return np.array(list(map(float, text.split(","))))
    except ValueError:
        pass
    try:
        return np.array(list(map(float, text.upper().replace("D", "E").split(","))))
    except ValueError:
        return None


def _integers(text: str) -> np.ndarray | None:
    """Whole numbers from 1 to LARGEST_NUMBER between commas, or None."""
    if "_" in text:
        return None
    try:
        values = np.array(list(map(int, text.split(","))), dtype=np.int64)
    except (ValueError, OverflowError):
        return None
    return values if values.min() >= 1 and values.max() <= LARGEST_NUMBER else None
