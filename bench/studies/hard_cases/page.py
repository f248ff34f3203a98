"""The page, the table and the map of a suite: cases against columns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from studies.charts import save_class_map
from studies.hard_cases.case import STEPS, Case, Setting
from studies.hard_cases.classes import CLASSES, DEGRADED, FAIL, PASS, REFUSED, SILENT
from studies.hard_cases.run import Row
from warpffrf.study.markdown import table

MADE = "Made by `python -m studies stability`; do not edit."
COLORS = {PASS: "#4c9f70", DEGRADED: "#ffd166", FAIL: "#ef8354", REFUSED: "#9aa5b1", SILENT: "#7b1e3a"}
BY_ACCURACY = "accuracy "  # how columns of that kind begin
LONGEST = 240  # characters of a reason in the page; the table has all

Rows = Mapping[tuple[str, str], Row]


def columns_of(cases: Sequence[Case]) -> list[str]:
    """All columns of the cases: steps from short to long, then tolerances and errors."""
    settings = [setting for case in cases for setting in case.settings()]
    steps = [Setting(step).column for step in sorted({*STEPS, *(s.step for s in settings)})]
    return list(dict.fromkeys([*steps, *(s.column for s in settings)]))


def used_columns(cases: Sequence[Case], rows: Rows) -> list[str]:
    """Columns with a row."""
    names = {case.name for case in cases}
    there = {column for name, column in rows if name in names}
    return [column for column in columns_of(cases) if column in there]


def worst_of(row: Row) -> str:
    """The comparison furthest beyond its limit in words; "" of a run without any."""
    if not row.findings:
        return ""
    of, error, good, _ = max(row.findings, key=_beyond)
    return f"{of} {error:.2g} (passes to {good:g})"


def _beyond(finding: Sequence[float]) -> float:
    """A comparison's error over what passes; over what is wrong where nothing but zero passes."""
    _, error, good, bad = finding
    return error / (good or bad or 1.0)


def csv_rows(cases: Sequence[Case], rows: Rows) -> list[list[str]]:
    """One line a run."""
    found = [["case", "setting", "class", "why", "simulated [s]", "steps", "halved", "seconds", "comparisons", "notes"]]
    for (name, column), row in rows.items():
        if name in {case.name for case in cases}:
            numbers = [f"{row.simulated:.6g}", str(row.steps), str(row.halved), f"{row.seconds:.3g}"]
            findings = "; ".join(f"{of} {error:.3g} ({good:g}, {bad:g})" for of, error, good, bad in row.findings)
            found.append([name, column, row.kind, row.why, *numbers, findings, " | ".join(row.notes)])
    return found


def page(cases: Sequence[Case], rows: Rows, map_name: str) -> str:
    """The whole page."""
    columns = used_columns(cases, rows)
    counts = {kind: sum(row.kind == kind for row in rows.values()) for kind in CLASSES}
    grid = []
    for case in cases:
        own = [rows.get((case.name, column)) for column in columns]
        grid.append([case.name, *("" if row is None else row.kind for row in own)])
    passes = [case.name for case in cases if any(r.kind == PASS for (n, _), r in rows.items() if n == case.name)]
    never = [case.name for case in cases if case.name not in passes]
    stories = []
    for case in cases:
        stories += [f"### {case.name}", "", case.tests, ""]
        lines = []
        for column in columns:
            row = rows.get((case.name, column))
            if row is not None:
                lines.append(
                    [column, row.kind, f"{row.simulated:.3g}", str(row.halved), worst_of(row), _short(row.why)]
                )
        head = ["setting", "class", "simulated [s]", "steps halved", "furthest from its limit", "why"]
        stories += [table(head, lines), ""]
    summary = ", ".join(f"{count} {kind}" for kind, count in counts.items())
    return f"""# Hard cases

{MADE}

Every case is run with steps from 1e-7 to 1e-2 s, a bounded number of them, and at its middle step with other tolerances
of the iteration, with halving by the local error, and with `accuracy=` alone, which finds its own setting. *pass*,
*degraded*: by the energy ledger, the joints and what is known of the case from elsewhere. *fail*: wrong, and the run
says so. *refused*: the input is not accepted. *silent*: wrong result without a warning; must not occur. How
classes are found: `bench/studies/hard_cases/classes.py`.

{len(rows)} runs: {summary}. Cases that pass at some setting: {len(passes)} of {len(cases)}{_named(never)}.
{_unaided(cases, rows)}
![cases against steps and tolerances]({map_name})

{table(["case", *columns], grid)}
## Each case

{chr(10).join(stories)}"""


def save_map(cases: Sequence[Case], rows: Rows, path: Path) -> Path:
    """Draw the map, cases against columns."""
    columns = used_columns(cases, rows)
    kinds = [[rows[case.name, c].kind if (case.name, c) in rows else None for c in columns] for case in cases]
    return save_class_map([case.name for case in cases], columns, kinds, COLORS, path, title="Hard cases")


def _unaided(cases: Sequence[Case], rows: Rows) -> str:
    """How many cases pass with `accuracy=` alone."""
    own = {name: row.kind for (name, column), row in rows.items() if column.startswith(BY_ACCURACY)}
    if not own:
        return ""
    others = [f"{case.name} ({own[case.name]})" for case in cases if own.get(case.name, PASS) != PASS]
    return f"With `accuracy=` alone {sum(kind == PASS for kind in own.values())} of {len(own)} pass{_named(others)}.\n"


def _named(names: Sequence[str]) -> str:
    return f"; not {', '.join(names)}" if names else ""


def _short(text: str) -> str:
    text = text.replace("|", "/").replace("\n", " ")
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"
