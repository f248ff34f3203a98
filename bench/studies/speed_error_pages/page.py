"""Speed against error of known machines: a page per study and an index; half an hour.

FOLDER/speed_error/NAME.md, NAME.png, NAME_steps.png     the page of a study and its pictures
FOLDER/speed_error/NAME.json                             what the index says of it
FOLDER/speed_error.md                                    the index
"""

from __future__ import annotations

import json
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from studies.speed_error_pages import STUDIES
from studies.speed_error_pages.study import Study
from warpffrf.model.errors import unknown_name
from warpffrf.study.markdown import table
from warpffrf.study.speed_against_error.outcome import SpeedError, wanted_table

PAGES, INDEX = "speed_error", "speed_error.md"
MADE = "Made by `python -m studies speed_error`; do not edit.\n"
COARSE = "Made with --quick: the machine is coarse, and figures only show that it runs.\n\n"
SHOWN = ("1.0%", "0.1%")  # wanted errors in the index


def write(folder: str | Path, cases: Sequence[str], *, quick: bool) -> list[Path]:
    """Write the pages of the named studies, or of all, and the index after each."""
    for name in cases:
        if name not in STUDIES:
            raise unknown_name("study 'speed_error': case", name, STUDIES)
    paths = []
    for name in cases or STUDIES:
        paths.append(write_study(STUDIES[name], folder, quick=quick))
        index = write_index(STUDIES, folder)
    return [*paths, index]


def write_study(study: Study, folder: str | Path, *, quick: bool, progress: bool = True) -> Path:
    """Run `study` and write its page, pictures and facts below `folder`; returns the path of the page."""
    pages = Path(folder) / PAGES
    pages.mkdir(parents=True, exist_ok=True)
    begin = time.perf_counter()
    found = study.make(quick, progress=progress)
    pictures = found.draw(pages / study.name, overwrite=True)
    seconds = time.perf_counter() - begin
    page = pages / f"{study.name}.md"
    page.write_text(page_of(study, found, [Path(p).name for p in pictures], seconds, quick=quick), encoding="utf-8")
    facts = json.dumps(facts_of(found, seconds, quick=quick), indent=1)
    (pages / f"{study.name}.json").write_text(facts + "\n", encoding="utf-8")
    return page


def page_of(study: Study, found: SpeedError, pictures: list[str], seconds: float, *, quick: bool) -> str:
    """The page as Markdown."""
    shown = "\n\n".join(f"![{name}]({name})" for name in pictures)
    return f"""# {study.heading}: speed against error

{MADE}
{COARSE if quick else ""}{study.text}

Errors and times are defined in [the index](../{INDEX}).

{shown}

{found.report()}
The study took {seconds:.0f} s.
"""


def facts_of(found: SpeedError, seconds: float, *, quick: bool) -> dict[str, Any]:
    """What the index says of a study, as plain data."""
    _, wanted = wanted_table(found)
    return {
        "quick": quick,
        "seconds": round(seconds),
        "settings": len(found.rows),
        "wanted": {error: {"setting": setting, "wall": wall} for error, setting, wall in wanted},
    }


def write_index(studies: Mapping[str, Study], folder: str | Path) -> Path:
    """Write the index of those of `studies` whose pages are below `folder`; returns its path."""
    folder = Path(folder)
    lines = []
    for name, study in studies.items():
        file = folder / PAGES / f"{name}.json"
        if not file.is_file():
            continue
        facts = json.loads(file.read_text(encoding="utf-8"))
        heading = f"[{study.heading}]({PAGES}/{name}.md)" + (" (quick)" if facts["quick"] else "")
        best = [facts["wanted"][error] for error in SHOWN]
        cells = [text for one in best for text in (one["setting"] if one["wall"] != "-" else "none", one["wall"])]
        lines.append([heading, str(facts["settings"]), *cells, str(facts["seconds"])])
    head = ["study", "settings", *(text for error in SHOWN for text in (f"fastest within {error}", "wall s/s"))]
    index = folder / INDEX
    index.write_text(
        f"""# Speed against error

{MADE} Each machine runs with all combinations of some choices in one process, in rounds of changing order where there
are several, and is compared with a reference that the study computes itself, of a step four times finer than the
finest. Errors are fractions of the whole history (`warpffrf.study.speed_against_error.errors`); times are wall time of
the time loop per simulated second, the fastest run of each, and `step U` is the same for one step in units of U. What a
run costs once is given separately: `set-up`, `checks` when it ends (contact-fixed cells are compared with finer ones,
for the error that the run states), and the reduction, `offline`. A setting is Pareto-optimal if no other is both
faster and at least as accurate, to three digits. Where rounds differ by more than fronts do (compare `fastest` with
`median`), the order of neighbours on a front is chance. Bodies are the same in all runs of a study but for what it
chooses: what their meshes and modes leave out in the reference too is not in these errors.

{table([*head, "made in s"], lines)}
Figures of one machine, each page states what else ran on it; the table has the fastest setting with at most the error
of its column in all measures against the reference, "none" where there is none or the reference does not resolve it.
""",
        encoding="utf-8",
    )
    return index
