"""Grouping of similar entries of a report: a rolling bearing has as many contacts as rolling elements.

An entry is a block of lines. Blocks are similar if they differ only in numbers, also within names ('roller 3', 'roller
12'), and have the same sort, if they have one. `FEWEST` or more similar blocks become one block: a quantity that
differs between them is given as its minimum and maximum, as printed, each with the name of the entry that has it. Text
of an entry, such as a warning, belongs to its block, so that a statement about a single entry is never lost.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

FEWEST = 4  # similar blocks that are grouped; fewer are all listed
Pairs = Literal["folded", "all"]
FIGURE = re.compile(r"(?<![\w.'#])[-+]?(?:\d+\.?\d*(?:e[-+]?\d+)?|nan|inf)(?![\w'])")
QUOTED = re.compile(r"(?<!\w)'[^']*'(?!\w)")
OF_BODY = re.compile(r"\d+(?=\[')")  # of a surface as named in messages, roller 3['rim']
DIGITS = re.compile(r"\d+")
MARK = "\0"  # placeholder of a number


@dataclass(frozen=True)
class Block:
    """Lines on one entry called `name`; `sort`: a further key that similar entries must share if names need not agree;
    None if names decide."""

    name: str
    lines: Sequence[str]
    sort: str | None = None

    def skeleton(self) -> tuple[str, ...]:
        """The lines without numbers, and without the variable parts of names."""
        return (self.sort or "", *(FIGURE.sub(MARK, self._without_names(line)) for line in self.lines))

    def figures(self) -> list[list[str]]:
        """The numbers of each line as printed."""
        return [FIGURE.findall(self._without_names(line)) for line in self.lines]

    def _without_names(self, line: str) -> str:
        own = line if self.sort is None else line.replace(f"'{self.name}'", "'#'")
        return OF_BODY.sub("#", QUOTED.sub(lambda found: DIGITS.sub("#", found.group()), own))


def folded(blocks: Sequence[Block], kind: str, pairs: Pairs = "folded") -> list[list[str]]:
    """The lines of all blocks, with similar ones grouped at the position of the first; `kind`: the text of the first
    line before the name, whose plural ends in s. pairs: "all" groups nothing."""
    if pairs == "all":
        return [list(block.lines) for block in blocks]
    alike: dict[tuple[str, ...], list[Block]] = {}
    for block in blocks:
        alike.setdefault(block.skeleton(), []).append(block)
    return [
        lines
        for group in alike.values()
        for lines in ([_one(group, kind)] if len(group) >= FEWEST else [list(block.lines) for block in group])
    ]


def folded_notes(notes: Sequence[str], pairs: Pairs = "folded") -> list[str]:
    """Notes, with similar ones grouped."""
    blocks = [Block(_first_name(note), [note]) for note in notes]
    return [line for lines in folded(blocks, "", pairs) for line in lines]


def _one(group: Sequence[Block], kind: str) -> list[str]:
    """The block that represents a group of similar ones."""
    names, tokens = [block.name for block in group], [block.figures() for block in group]
    lines = []
    for number, line in enumerate(group[0].skeleton()[1:]):
        pieces = line.split(MARK)
        slots = zip(*(found[number] for found in tokens), strict=True)
        spans = [_span(slot, names) for slot in slots]
        lines.append("".join(piece + span for piece, span in zip(pieces, [*spans, ""], strict=True)))
    if not kind:
        whose = f", '{names[0]}' to '{names[-1]}'" if names[0] != names[-1] else ""
        return [f"{len(group)} alike{whose}: {lines[0]}", *lines[1:]]
    who = f"{len(group)} {kind}s '{names[0]}' to '{names[-1]}'"
    return [re.sub(rf"^{kind} '[^']*'", lambda _: who, lines[0]), *lines[1:]]


def _span(slot: Sequence[str], names: Sequence[str]) -> str:
    """The minimum and maximum of numbers as printed, with the names that have them."""
    known = [n for n in range(len(slot)) if slot[n] != "nan"]
    if len({float(slot[n]) for n in known}) <= 1 and len(known) in (0, len(slot)):
        return slot[0]
    least, largest = min(known, key=lambda n: float(slot[n])), max(known, key=lambda n: float(slot[n]))
    told = [f"{slot[n]} ('{names[n]}')" if len(set(names)) == len(names) else slot[n] for n in (least, largest)]
    span = told[0] if float(slot[largest]) == float(slot[least]) else " to ".join(told)
    return span if len(known) == len(slot) else f"{span}, {len(slot) - len(known)} nan"


def _first_name(note: str) -> str:
    found = QUOTED.search(note)
    return found.group().strip("'") if found else ""
