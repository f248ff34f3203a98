"""All hard cases at all their settings: rows in a folder that an interrupted suite goes on with, a table, a map."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from studies.hard_cases.case import Case, Setting
from studies.hard_cases.cases import CASES
from studies.hard_cases.page import csv_rows, page, save_map
from studies.hard_cases.run import Row, run_case
from warpffrf import __version__
from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.files.paths import checked_output_path, written_whole
from warpffrf.model.messages.progress import Progress

KIND = "warpffrf stability study"
ROWS, TABLE, PAGE, MAP = "stability.json", "stability.csv", "stability.md", "stability.png"


class Stability:
    """A suite that was run: `cases`, and `rows` {(case, column): Row}."""

    def __init__(self, cases: Sequence[Case], rows: dict[tuple[str, str], Row]) -> None:
        self.cases, self.rows = list(cases), rows

    def of(self, kind: str) -> list[Row]:
        """Rows of a class."""
        return [row for row in self.rows.values() if row.kind == kind]

    def report(self) -> str:
        """The page, Markdown."""
        return page(self.cases, self.rows, MAP)

    def write(self, folder: str | os.PathLike[str], *, overwrite: bool = False) -> list[Path]:
        """Write page, table and map; raises `InputError` for files that are there unless `overwrite` is set."""
        text = io.StringIO()
        csv.writer(text).writerows([["warpffrf stability"], *csv_rows(self.cases, self.rows)])
        names = (PAGE, TABLE, MAP)
        paths = [
            checked_output_path(Path(folder) / name, "stability", overwrite=overwrite or name == MAP) for name in names
        ]
        for path, content in zip(paths[:2], (self.report(), text.getvalue()), strict=True):
            with written_whole(path) as partial:
                partial.write_text(content, encoding="utf-8")
        save_map(self.cases, self.rows, paths[2])
        return paths


def chosen(names: Sequence[str] | None, *, quick: bool) -> list[Case]:
    """The cases of those names; None: all but the slow ones, with `quick` those that are marked so."""
    if names is None:
        return [case for case in CASES.values() if not case.slow and (case.quick or not quick)]
    for name in names:
        if name not in CASES:
            raise unknown_name("stability: case", name, list(CASES))
    return [CASES[name] for name in dict.fromkeys(names)]


def run_suite(
    folder: str | os.PathLike[str] | None, cases: Sequence[Case], *, quick: bool, overwrite: bool, progress: bool
) -> Stability:
    """Run what `folder` does not hold yet of the cases; with None nothing is kept. Rows that it holds of other cases
    are found with them, as they were run."""
    kept = _read(folder, overwrite)
    plan = [(case, setting) for case in cases for setting in case.settings(quick=quick)]
    bar = Progress("stability", len(plan), enabled=progress, unit="run")
    rows: dict[tuple[str, str], Row] = {}
    try:
        for done, (case, setting) in enumerate(plan):
            key, label = _identity(case, setting), _label(case, setting)
            found = kept.get(label)
            if found is None or found["identity"] != key:
                row = run_case(case, setting)[1]
                kept[label] = {"identity": key, "row": row.plain()}
                _write(folder, kept)
            rows[case.name, setting.column] = Row(**kept[label]["row"])
            bar.update(done + 1)
    finally:
        bar.close()
    return _with_others(cases, rows, kept)


def _with_others(cases: Sequence[Case], rows: dict[tuple[str, str], Row], kept: dict[str, Any]) -> Stability:
    """The cases that were run, and those of the registry of which rows are `kept`, in the order of the registry."""
    names, found = {case.name for case in cases}, dict(rows)
    others = [case for case in CASES.values() if case.name not in names]
    for case in others:
        labels = {setting.column: _label(case, setting) for setting in case.settings()}
        found |= {(case.name, column): Row(**kept[at]["row"]) for column, at in labels.items() if at in kept}
    there = {name for name, _ in found} | names
    order = {name: place for place, name in enumerate(CASES)}
    together = [*cases, *(case for case in others if case.name in there)]
    return Stability(sorted(together, key=lambda case: order.get(case.name, len(order))), found)


def _label(case: Case, setting: Setting) -> str:
    """Under which a row is kept."""
    return f"{case.name} | {setting.column}"


def _identity(case: Case, setting: Setting) -> str:
    """What a row depends on, but for the program itself, of which it knows the version only."""
    try:
        scene = case.build().content_hash()
    except InputError as error:
        scene = str(error)
    parts = (
        __version__, scene, case.step_count(setting.step), setting, sorted(case.options.items(), key=str), case.ledger,
    )  # fmt: skip
    return hashlib.sha256(repr(parts).encode()).hexdigest()


def _read(folder: str | os.PathLike[str] | None, overwrite: bool) -> dict[str, Any]:
    if folder is None:
        return {}
    path = Path(folder).expanduser()
    if path.exists() and not path.is_dir():
        raise InputError(f"stability: '{path}' is a file; give the name of a folder")
    file = path / ROWS
    if overwrite or not file.is_file():
        checked_output_path(file, "stability", overwrite=overwrite)
        return {}
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
        if content["kind"] == KIND and isinstance(content["rows"], dict):
            return content["rows"]
    except (ValueError, KeyError, TypeError):
        pass
    raise InputError(f"stability: '{file}' is no stability study of warpffrf; choose another folder")


def _write(folder: str | os.PathLike[str] | None, rows: dict[str, Any]) -> None:
    if folder is not None:
        with written_whole(Path(folder).expanduser() / ROWS) as partial:
            partial.write_text(json.dumps({"kind": KIND, "rows": rows}, indent=1) + "\n", encoding="utf-8")
