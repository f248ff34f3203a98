"""All hard cases over all their steps: `python -m warpffrf.study.stability.suite [FOLDER]`, some minutes.

Writes stability.md and stability.png, a heat map, into FOLDER (docs if left out). A run that is wrong in silence makes
the exit status 1.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from warpffrf.model.errors import unknown_name
from warpffrf.model.progress import Progress
from warpffrf.output.plots.picture import write_picture
from warpffrf.study.stability.case import STEPS
from warpffrf.study.stability.cases import CASES
from warpffrf.study.stability.classes import CLASSES, SILENT, Judged, judge
from warpffrf.verification.markdown import table

MADE = "Made by `python -m warpffrf.study.stability.suite`; do not edit.\n"
COLORS = {"pass": "#3a7d44", "degraded": "#e9c46a", "said": "#e07a5f", "refused": "#8d99ae", "silent": "#000000"}
LONGEST = 160  # characters of what a run said


def stability(cases: Sequence[str] | None = None, *, progress: bool = True) -> list[Judged]:
    """Judge the `cases` by name, all if None, with all their steps. Raises `InputError` for an unknown name."""
    for name in cases or ():
        if name not in CASES:
            raise unknown_name("stability: case", name, list(CASES))
    chosen = [CASES[name] for name in (cases or CASES)]
    runs = [(case, step) for case in chosen for step in case.steps()]
    bar, found = Progress("stability", len(runs), enabled=progress, unit="run"), []
    for case, step in runs:
        found.append(judge(case, step))
        bar.update(len(found))
    bar.close()
    return found


def page(found: Sequence[Judged]) -> str:
    """Table and what the runs said."""
    rows, said = [], []
    for name in dict.fromkeys(judged.case for judged in found):
        own = {judged.step: judged for judged in found if judged.case == name}
        rows.append([name, CASES[name].what, *(_shown(own.get(step)) for step in STEPS)])
        said += [f"- {name}, {step:g} s: {_short(own[step].said)}" for step in STEPS if step in own and own[step].said]
    counts = ", ".join(f"{sum(j.verdict == verdict for j in found)} {verdict}" for verdict in CLASSES)
    return (
        f"""# Hard cases

{MADE}
Each case by the step of the run [s]: its class, and the largest error (`warpffrf/study/stability/classes.py`): *pass*
and *degraded* by the two limits of the case, *said* where the run ended early with a message or a note tells of a step
too long, *refused* before it began, *silent* where it is wrong and nothing says so. {counts}.

![classes by case and step](stability.png)

{table(["case", "what it tests", *(f"{step:g}" for step in STEPS)], rows)}
What runs said:

"""
        + "\n".join(said)
        + "\n"
    )


def picture(found: Sequence[Judged], path: Path) -> None:
    """The classes as a heat map."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.colors import ListedColormap
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    names = list(dict.fromkeys(judged.case for judged in found))
    grid = np.full((len(names), len(STEPS)), np.nan)
    for judged in found:
        grid[names.index(judged.case), STEPS.index(judged.step)] = CLASSES.index(judged.verdict)
    figure = Figure(figsize=(8.0, 1.6 + 0.36 * len(names)), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    ax = figure.subplots()
    colors = ListedColormap([COLORS[verdict] for verdict in CLASSES])
    ax.imshow(grid, cmap=colors, vmin=-0.5, vmax=len(CLASSES) - 0.5, aspect="auto")
    ax.set_xticks(range(len(STEPS)), [f"{step:g}" for step in STEPS])
    ax.set_yticks(range(len(names)), names)
    ax.set_xlabel("step [s]")
    ax.legend(
        handles=[Patch(color=COLORS[verdict], label=verdict) for verdict in CLASSES], ncols=len(CLASSES),
        loc="lower center", bbox_to_anchor=(0.5, 1.0), frameon=False,
    )  # fmt: skip
    write_picture(figure, path, "stability", overwrite=True)


def _shown(judged: Judged | None) -> str:
    if judged is None:
        return ""
    return judged.verdict + (f" {judged.error:.1e}" if np.isfinite(judged.error) else "")


def _short(text: str) -> str:
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}..."


def main(folder: str = "docs") -> int:
    """Write the page; 1 where a run is wrong in silence."""
    found = stability()
    (Path(folder) / "stability.md").write_text(page(found), encoding="utf-8")
    picture(found, Path(folder) / "stability.png")
    return int(any(judged.verdict == SILENT for judged in found))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
