"""Runs of the benchmarks against stored ones of the same machine: what is slower, or takes more memory, by how much.

A document is what a script of bench/ writes: machine, `unit_seconds` U, and lists of rows. What of a row are words and
counts named in IDENTITY says what was measured; times (names that contain "seconds", or are in TIMES) are compared in
units of U of their own run, memory (MEMORY) as it is. A machine is its processor's model and number of cores.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

Document = dict[str, Any]
IDENTITY = (
    "table", "scene", "name", "case", "cells", "treatment", "quadrature", "law", "variant", "kept", "path", "solver",
    "friction", "sectors", "layers", "columns", "approach", "gap_columns", "bodies", "pairs", "modes", "count",
    "points", "local_modes", "dofs", "runs", "saved",
)  # fmt: skip
TIMES = ("offline", "online")  # s
NO_TIMES = ("unit_seconds", "middle_seconds_per_step", "stage_seconds")
MEMORY = ("peak_bytes", "megabytes")
SLOWER, LARGER = 0.25, 0.1  # tolerated: two runs on a quiet machine differ by up to a tenth, on a shared one by more
LEAST = 0.05  # s: a time of a whole run below it is not compared, the clock and the caches say more


def machine_id(machine: dict[str, Any]) -> str:
    """The folder of a machine (`step_time.machine()["machine"]`): model and cores, in letters, digits and hyphens."""
    words = f"{machine.get('processor') or 'unknown processor'} {machine.get('cores') or 'unknown'} cores"
    return re.sub(r"[^a-z0-9]+", "-", words.lower()).strip("-")


def measured(document: Document) -> dict[tuple[str, str], float]:
    """By what was measured and the name of the quantity: times in U, memory in its unit. Rows that say the same of
    themselves are numbered."""
    found: dict[tuple[str, str], float] = {}
    for title, rows in document.items():
        if not isinstance(rows, list):
            continue
        seen: Counter[str] = Counter()
        for row in rows:
            label = label_of(title, row)
            seen[label] += 1
            if seen[label] > 1:
                label += f" #{seen[label]}"
            found.update({(label, name): value for name, value in quantities(row, document).items()})
    return found


def label_of(title: str, row: dict[str, Any]) -> str:
    """What a row measures, in words."""
    parts = [f"{name} {row[name]}" for name in IDENTITY if row.get(name) is not None]
    return ", ".join(([] if title == "rows" else [title]) + parts) or title


def quantities(row: dict[str, Any], document: Document) -> dict[str, float]:
    """Times of a row in U and its memory."""
    unit = row.get("unit_seconds") or document.get("unit_seconds")
    found = {}
    for name, value in row.items():
        if name in NO_TIMES or isinstance(value, bool) or not isinstance(value, int | float):
            continue
        a_step = "per_step" in name or "a_side" in name
        if unit and ("seconds" in name or name in TIMES) and (a_step or value > LEAST):
            found[name] = value / unit
        elif name in MEMORY and value > 0.0:
            found[name] = float(value)
    return found


@dataclass(frozen=True)
class Compared:
    """One quantity of two runs: `now` and `before` in U or in the unit of a memory; tolerated `share` more."""

    script: str
    label: str
    quantity: str
    now: float
    before: float
    tolerated: float

    @property
    def ratio(self) -> float:
        """Now over before."""
        return self.now / self.before

    @property
    def flagged(self) -> bool:
        """Whether it is more than is tolerated."""
        return self.ratio > 1.0 + self.tolerated


@dataclass(frozen=True)
class Comparison:
    """All that two runs share, and what only one of them has, as "script: label"."""

    compared: list[Compared]
    new: list[str]
    gone: list[str]

    @property
    def flagged(self) -> list[Compared]:
        """What is slower or larger than tolerated."""
        return [one for one in self.compared if one.flagged]


def compare(
    now: dict[str, Document], before: dict[str, Document], *, slower: float = SLOWER, larger: float = LARGER
) -> Comparison:
    """This run against a stored one, documents by script; only scripts of this run count."""
    found, new, gone = [], [], []
    for script, document in now.items():
        if script not in before:
            new.append(script)
            continue
        ours, theirs = measured(document), measured(before[script])
        new += [f"{script}: {label} ({name})" for label, name in ours if (label, name) not in theirs]
        gone += [f"{script}: {label} ({name})" for label, name in theirs if (label, name) not in ours]
        for (label, name), value in ours.items():
            if (label, name) in theirs:
                tolerated = larger if name in MEMORY else slower
                found.append(Compared(script, label, name, value, theirs[label, name], tolerated))
    return Comparison(found, new, gone)


def lines(comparison: Comparison) -> list[str]:
    """The comparison as it is printed: one row a quantity, then what only one run has."""
    out = [f"{'script':24s} {'quantity':18s} {'before':>10s} {'now':>10s} {'ratio':>6s}  what"]
    for one in comparison.compared:
        mark = f"  more than {one.tolerated:.0%}" if one.flagged else ""
        figures = f"{one.before:10.4g} {one.now:10.4g} {one.ratio:6.2f}"
        out.append(f"{one.script:24s} {one.quantity:18s} {figures}  {one.label}{mark}")
    out += [f"not in the stored run: {what}" for what in comparison.new]
    out += [f"only in the stored run: {what}" for what in comparison.gone]
    return out


def read(folder: Path) -> dict[str, Document]:
    """Documents of a folder by script; other files are left out. Raises `ValueError` for one that is no document."""
    found = {}
    for file in sorted(folder.glob("*.json")):
        document = json.loads(file.read_text(encoding="utf-8"))
        if not isinstance(document, dict) or "machine" not in document:
            raise ValueError(f"{file}: no run of a benchmark, which has a machine; remove it, or run its script again")
        found[file.stem] = document
    return found


def store(documents: dict[str, Document], folder: Path) -> Path:
    """Write documents, all of one machine, below `folder`; returns the machine's folder. Raises `ValueError` for
    documents of several machines, and for none."""
    ids = {machine_id(document["machine"]) for document in documents.values()}
    if len(ids) != 1:
        raise ValueError(
            f"runs of {len(ids)} machines ({', '.join(sorted(ids)) or 'none'}) cannot be stored as one; "
            "run `make bench` again"
        )
    own = folder / ids.pop()
    own.mkdir(parents=True, exist_ok=True)
    for script, document in documents.items():
        (own / f"{script}.json").write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    return own
