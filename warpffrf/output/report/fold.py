"""Entries of a report, and grouping of similar ones: a rolling bearing has as many contacts as rolling elements.

An entry lists figures, each a label and its values as text. Entries are similar if they differ only in numbers, also
within names ('roller 3', 'roller 12'), and have the same sort, if they have one. `FEWEST` or more similar entries
become one: a number that differs between them is given as its minimum and maximum, as printed, each with the name of
the entry that has it. Text of an entry, such as a warning, belongs to it, so that a statement about a single entry is
never lost.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

FEWEST = 4  # similar entries that are grouped; fewer are all listed
Pairs = Literal["folded", "all"]
NUMBER = re.compile(r"(?<![\w.'#])[-+]?(?:\d+\.?\d*(?:e[-+]?\d+)?|nan|inf)(?![\w'])")
QUOTED = re.compile(r"(?<!\w)'[^']*'(?!\w)")
OF_BODY = re.compile(r"\d+(?=\[')")  # of a surface as named in messages, roller 3['rim']
DIGITS = re.compile(r"\d+")
MARK = "\0"  # placeholder of a number


@dataclass(frozen=True)
class Figure:
    """One statement of an entry: a label and its text, such as values with units. of: the kinds of quantities in the
    error budget whose errors it has (`budget.figures`); inline: printed in the first line of its entry."""

    label: str
    text: str
    of: tuple[str, ...] = ()
    inline: bool = False


@dataclass(frozen=True)
class Entry:
    """The figures of one thing of a run: its kind, such as "contact" ("" for a note), and its name; of a group the
    names of all; none for the whole run. unit: printed behind the name. sort: a further key that similar entries must
    share if names need not agree; None if names decide."""

    kind: str
    names: tuple[str, ...]
    figures: Sequence[Figure]
    unit: str = ""
    sort: str | None = None

    @property
    def head(self) -> str:
        """Kind and name; of a group the number, and the first and the last name."""
        count, unit = len(self.names), f" [{self.unit}]" if self.unit else ""
        if count < 2:
            return f"{self.kind} '{self.names[0]}'{unit}" if count and self.kind else self.kind
        whose = f"'{self.names[0]}' to '{self.names[-1]}'" if self.names[0] != self.names[-1] else ""
        if not self.kind:
            return f"{count} alike, {whose}" if whose else f"{count} alike"
        plural = f"{self.kind[:-1]}ies" if self.kind.endswith("y") else f"{self.kind}s"
        return f"{count} {plural} {whose}{unit}"

    def lines(self) -> list[str]:
        """The entry as lines of a report."""
        first = "; ".join(f"{f.label} {f.text}".strip() for f in self.figures if f.inline)
        listed = [f"  {f.label:<15} {f.text}" for f in self.figures if not f.inline]
        return [": ".join(part for part in (self.head, first) if part), *listed]

    def skeleton(self) -> tuple[str, ...]:
        """The entry without numbers, and without the variable parts of names."""
        whose = self.sort if self.sort is not None else DIGITS.sub("#", "".join(self.names))
        figures = (f"{f.label}{MARK}{NUMBER.sub(MARK, self._without_names(f.text))}" for f in self.figures)
        return (self.kind, self.unit, whose, *figures)

    def numbers(self) -> list[list[str]]:
        """The numbers of each figure as printed."""
        return [NUMBER.findall(self._without_names(figure.text)) for figure in self.figures]

    def _without_names(self, text: str) -> str:
        if self.sort is not None:
            text = text.replace(f"'{self.names[0]}'", "'#'")
        return OF_BODY.sub("#", QUOTED.sub(lambda found: DIGITS.sub("#", found.group()), text))


def folded(entries: Sequence[Entry], pairs: Pairs = "folded") -> list[Entry]:
    """The entries, with similar ones grouped at the position of the first. pairs: "all" groups nothing."""
    if pairs == "all":
        return list(entries)
    alike: dict[tuple[str, ...], list[Entry]] = {}
    for entry in entries:
        alike.setdefault(entry.skeleton(), []).append(entry)
    return [one for group in alike.values() for one in ([_group(group)] if len(group) >= FEWEST else group)]


def folded_notes(notes: Sequence[str], pairs: Pairs = "folded") -> list[str]:
    """Notes, with similar ones grouped."""
    entries = [Entry("", (_first_name(note),), [Figure("", note, inline=True)]) for note in notes]
    return [line for entry in folded(entries, pairs) for line in entry.lines()]


def _group(group: Sequence[Entry]) -> Entry:
    """The entry that represents a group of similar ones."""
    names, tokens = [entry.names[0] for entry in group], [entry.numbers() for entry in group]
    figures = []
    for number, figure in enumerate(group[0].figures):
        pieces = NUMBER.sub(MARK, group[0]._without_names(figure.text)).split(MARK)
        slots = zip(*(found[number] for found in tokens), strict=True)
        spans = [_span(slot, names) for slot in slots]
        text = "".join(piece + span for piece, span in zip(pieces, [*spans, ""], strict=True))
        figures.append(replace(figure, text=text))
    return replace(group[0], names=tuple(names), figures=figures)


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
