"""The verification page: all cases in two processes, one table, and what misses."""

from __future__ import annotations

import contextlib
import json
import os
import platform
import time
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from studies.validate.case import CASES, Outcome, Row, outcome
from studies.validate.known import KNOWN_MISSES, NOT_COMPARED
from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.reduced.body import library_versions
from warpffrf.study.machine import processor
from warpffrf.study.markdown import table

PAGE, FIGURES = "verification.md", "verification.json"
PROCESSES = 2
HEAD = ["case", "source", "quantity", "ours", "theirs", "difference", "allowed", "", "s"]


class Missed(Exception):
    """Rows miss their tolerance and are not known to, or are known to and do not."""


def write(folder: str | Path, cases: Sequence[str], *, quick: bool) -> list[Path]:
    """Run all cases and write the page and the figures below `folder`; of the named `cases` alone the rows are printed.

    Raises `InputError` for a case that does not exist and for `quick`, `Missed` where what misses is not what is known
    to, after the page was written.
    """
    if quick:
        raise InputError("study 'validate' has no quick version; name some of its cases")
    for name in cases:
        if name not in CASES:
            raise unknown_name("study 'validate': case", name, CASES)
    begin = time.perf_counter()
    found = [_run(name) for name in cases] if cases else computed(CASES)
    figures = {
        "minutes": round((time.perf_counter() - begin) / 60.0, 1), "processes": PROCESSES, "machine": processor(),
        "python": platform.python_version(), "versions": library_versions(("warp-lang", "numpy", "scipy")),
        "cases": [one.stored() for one in found],
    }  # fmt: skip
    if cases:
        print(table(HEAD, [line for one in found for line in lines(one)]))
        return []
    paths = [Path(folder) / PAGE, Path(folder) / FIGURES]
    paths[0].write_text(page(figures), encoding="utf-8")
    paths[1].write_text(json.dumps(figures, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    wrong = unexpected(found)
    if wrong:
        raise Missed("\n".join(["not as known (bench/studies/validate/known.py):", *wrong]))
    return paths


def computed(names: Iterable[str]) -> list[Outcome]:
    """Outcomes of the named cases, by processes of their own with one thread of the BLAS each."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    found = []
    with ProcessPoolExecutor(PROCESSES, get_context("spawn")) as pool:
        for one in pool.map(_run, names):
            print(f"{one.name}: {len(one.rows)} rows, {one.seconds:g} s{_told(one)}", flush=True)
            found.append(one)
    return found


def _told(one: Outcome) -> str:
    return f", misses: {'; '.join(one.missed)}" if one.missed else ""


def _run(name: str) -> Outcome:
    """A case, without what its runs print."""
    with open(os.devnull, "w", encoding="utf-8") as nowhere, contextlib.redirect_stdout(nowhere):
        return outcome(CASES[name])


def unexpected(found: Iterable[Outcome]) -> list[str]:
    """A line for each row that misses and is not known to, and for each that is known to and does not."""
    misses = {(one.name, quantity) for one in found for quantity in one.missed}
    return [
        *(f"{name}: {quantity} misses" for name, quantity in sorted(misses - set(KNOWN_MISSES))),
        *(f"{name}: {quantity} misses no more" for name, quantity in sorted(set(KNOWN_MISSES) - misses)),
    ]


def lines(one: Outcome) -> list[list[str]]:
    """A case in the table: its name, title, source and seconds stand in its first row."""
    told = [f"{one.title} `{one.name}`", one.source]
    if one.failed:
        return [[*told, "", "", "", one.failed, "", "**misses**", f"{one.seconds:g}"]]
    rows = []
    for number, row in enumerate(one.rows):
        left = told if number == 0 else ["", ""]
        rows.append([*left, *_cells(row), f"{one.seconds:g}" if number == 0 else ""])
    return rows


def _cells(row: Row) -> list[str]:
    unit = f" {row.unit}" if row.unit else ""
    numbers = [f"{value:.6g}{unit}" for value in (row.ours, row.theirs)]
    relative, small = row.scale is None or row.scale != 1.0, row.tolerance < 1e-4
    if small:
        sizes = [f"{row.difference:+.1e}", f"{row.tolerance:g}"]
    elif relative or not row.unit:
        sizes = [f"{100.0 * row.difference:+.2g} %", f"{100.0 * row.tolerance:g} %"]
    else:
        sizes = [f"{row.difference:+.2g}{unit}", f"{row.tolerance:g}{unit}"]
    return [row.quantity.replace("|", r"\|"), *numbers, *sizes, "" if row.reached else "**misses**"]


def page(figures: dict[str, Any]) -> str:
    """Markdown of the page, from its figures alone."""
    found = [Outcome.read(one) for one in figures["cases"]]
    count = sum(len(one.rows) for one in found)
    missed = [(one, quantity) for one in found for quantity in one.missed]
    body, room = [], ""
    for one in found:
        if one.room != room:
            room = one.room
            body.append([f"**{room}**", *[""] * (len(HEAD) - 1)])
        body += lines(one)
    reasons = "\n".join(
        f"- `{one.name}`, {quantity}: {KNOWN_MISSES.get((one.name, quantity), 'not known; look into it')}."
        for one, quantity in missed
    )
    versions = ", ".join(f"{name} {version}" for name, version in figures["versions"].items())
    return f"""# Verification

Made by `make validate`; do not edit. A single case: `python -m studies validate NAME`, its name being the one in code
letters. The figures are also in [verification.json](verification.json).

{len(found)} cases, {count} rows, of which **{len(missed)} miss** their tolerance. {figures["minutes"]:g} minutes in
{figures["processes"]} processes, together with other work ({figures["machine"]}; Python {figures["python"]},
{versions}).

*Ours* is a run of the program, from the mesh to the result, unless the title names the law by itself, which is the
reference that the program is tested with. *Theirs* is a published number, a closed form, or what its source says. The
*difference* is over the size of theirs; where that is zero or not the size that matters, over one that the quantity
names, in percent too, or as it is, with its unit. *Allowed* is the tolerance, of a coarse mesh or of the source's own
discretisation; *s* are the seconds of a case with its meshes and reductions. Names such as C1 or P7 are those of the
verification cases that tests and studies name. The studies behind many of the rows, with more meshes and steps, are in
[studies](studies/README.md).

{table(HEAD, body)}
## Misses

{reasons or "None."}

## Not compared yet

{table(["case", "source", "reason"], [list(row) for row in NOT_COMPARED])}"""
