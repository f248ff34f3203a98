"""Hard cases over steps and tolerances: pass, degraded, fail, refused or silent; half an hour.

case       what a case is, its settings and limits
classes    pass, degraded, fail, refused, silent
cases      one file a case, and the registry
memory     whether a run keeps its memory
run        a run, judged
page       page, table, map
suite      all of it, kept in a folder
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from studies.hard_cases.suite import Stability

__all__ = ["stability", "write"]


def stability(
    folder: str | os.PathLike[str] | None = None,
    *,
    cases: Sequence[str] | None = None,
    quick: bool = False,
    overwrite: bool = False,
    progress: bool = True,
) -> Stability:
    """Run hard cases over steps and tolerances and classify the results: `.rows`, `.report()`, `.of("silent")`.

    folder: where rows are kept, so that a suite that was stopped goes on, and where stability.md, .csv and .png are
    written; None: nothing is kept. cases: names of `studies.hard_cases.cases.CASES`; None: all but the slow
    ones. quick: some of the cases, at two steps each. overwrite: begin anew. progress: what is being done, on
    stderr. Rows are taken from the folder as long as
    case, setting and version are the same: begin anew after a change of the program. Rows that it holds of other cases
    stay in the report. Raises `InputError` for unknown names, and for a folder of something else.
    """
    from studies.hard_cases.suite import chosen, run_suite

    found = run_suite(folder, chosen(cases, quick=quick), quick=quick, overwrite=overwrite, progress=progress)
    if folder is not None:
        found.write(folder, overwrite=True)
    return found


def write(folder: str | os.PathLike[str], cases: Sequence[str], *, quick: bool) -> list[Path]:
    """Run all cases anew, or those of the named ones that FOLDER/stability has no rows of, and write page, table and
    map there; half an hour for all, on a quiet machine."""
    from studies.hard_cases.suite import MAP, PAGE, TABLE

    folder = Path(folder) / "stability"
    stability(folder, cases=cases or None, quick=quick, overwrite=not cases)
    return [folder / name for name in (PAGE, TABLE, MAP)]
