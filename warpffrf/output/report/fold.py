"""Alike things of a report as one: the rollers of a bearing have as many pairs, and few readers want each.

A thing is a block of lines. Blocks are alike where they differ in figures and in numbers within names alone, as
'roller 3' from 'roller 12', and are of the same sort, if their kind says what sorts there are. From `FEWEST` on they
become one block: a figure that is not the same in all is told as its least and its largest, as they would be printed,
each with the name of the thing that has it. What is said of a thing in words, such as a warning, is a part of its
block, so that nothing that is said of one alone disappears among the others.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

FEWEST = 4  # that are alike: up to there all are told
Pairs = Literal["folded", "all"]
FIGURE = re.compile(r"(?<![\w.'#])[-+]?(?:\d+\.?\d*(?:e[-+]?\d+)?|nan|inf)(?![\w'])")
QUOTED = re.compile(r"(?<!\w)'[^']*'(?!\w)")
OF_BODY = re.compile(r"\d+(?=\[')")  # of a surface as messages call it, roller 3['rim']
DIGITS = re.compile(r"\d+")
MARK = "\0"  # in the place of a figure


@dataclass(frozen=True)
class Block:
    """Lines on one thing, called `name`; `sort`: what else it must have in common to be alike, where its name needs
    not be; None where names decide."""

    name: str
    lines: Sequence[str]
    sort: str | None = None

    def skeleton(self) -> tuple[str, ...]:
        """The lines without figures, and without what may differ in names."""
        return (self.sort or "", *(FIGURE.sub(MARK, self._without_names(line)) for line in self.lines))

    def figures(self) -> list[list[str]]:
        """The figures of each line as they are printed."""
        return [FIGURE.findall(self._without_names(line)) for line in self.lines]

    def _without_names(self, line: str) -> str:
        own = line if self.sort is None else line.replace(f"'{self.name}'", "'#'")
        return OF_BODY.sub("#", QUOTED.sub(lambda found: DIGITS.sub("#", found.group()), own))


def folded(blocks: Sequence[Block], kind: str, pairs: Pairs = "folded") -> list[list[str]]:
    """The lines of all blocks, alike ones as one in the place of the first; `kind`: how the first line begins, before
    the name, with the plural made by an s. pairs: "all" leaves them apart."""
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
    """Notes, those that say the same of alike things as one."""
    blocks = [Block(_first_name(note), [note]) for note in notes]
    return [line for lines in folded(blocks, "", pairs) for line in lines]


def _one(group: Sequence[Block], kind: str) -> list[str]:
    """The block of a group of alike ones."""
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
    """The least and the largest of figures as printed, and whose they are."""
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
