"""Writes docs/studies/joint_bases.md: `python -m studies.small_sliding.joint_bases [FOLDER]`. Some minutes on one core.

Two ways of reducing a joint side by side: coordinates for the bodies (static and vibration modes, and trial vector
derivatives of the joint), or the flexibility of the relative motion of the joint's cells, all of them or fewer. Held
against full finite elements with contact and friction; every way goes through the same solver of the increment, so that
what differs is the space.
"""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from references.small_sliding.contact_program import SLIP
from references.small_sliding.quasi_static import Followed
from studies.small_sliding import joint_engine
from studies.small_sliding.joint_engine import SCALE, Both
from studies.small_sliding.joint_spaces import (
    BOLTS,
    COUNTS,
    FRICTION,
    HALF_WIDTH,
    LAYER,
    PRELOAD,
    SIZE,
    STEPS,
    TIP,
    Entry,
    Joint,
    Space,
    load_path,
    measure,
    spaces,
    two_sheets,
)
from warpffrf.offline.reduction import one_thread
from warpffrf.study.markdown import table


@dataclass(frozen=True, eq=False)
class Compared:
    """One load: its name, tip force [N], the full model's history, an entry a space (None: no state found)."""

    name: str
    force: float
    reference: Followed
    entries: list[Entry | None]


def compared(joint: Joint, found: Sequence[Space], tip: dict[str, float] | None = None) -> list[Compared]:
    """All spaces under all loads; the first is the reference."""
    results = []
    for name, force in (TIP if tip is None else tip).items():
        path = load_path(force)
        reference = found[0].follow(path)
        results.append(Compared(name, force, reference, [measure(space, path, reference) for space in found]))
    return results


def engine_table(both: Sequence[Both]) -> str:
    """Section on small-sliding contacts of the engine."""
    rows = []
    for one in both:
        for who, entry in (("study", one.study), ("engine", one.engine)):
            if entry is None:
                continue
            shares = (entry.pressure, entry.traction, entry.slip)
            rows.append([
                entry.space.name, f"{entry.space.unknowns}", one.load, who, *(f"{v:.1%}" for v in shares),
                f"{entry.loss:+.1%}", f"{entry.amplitude:+.2%}", f"{entry.milliseconds:.1f}",
            ])  # fmt: skip
    what = f"""The same joint in the engine, whose cells are made by `surfaces.Matched(size=)` and
`surfaces.Matched(growth=, fine=)`, with {joint_engine.MODES} vibration modes and {SCALE:g} of the loads; *study*: the
flexibility of the same cells in the solver of all rows above. Errors beside the full model, milliseconds a load step,
of the engine with everything that
belongs to one."""
    head = ["cells", "unknowns", "load", "by", "pressure", "friction", "slip", "loss", "amplitude", "ms"]
    pairs = [(one.study, one.engine) for one in both if one.study is not None]
    values = ("pressure", "traction", "slip", "loss", "amplitude")
    apart = max(abs(getattr(mine, v) - getattr(theirs, v)) for theirs, mine in pairs for v in values)
    ratio = np.median([theirs.milliseconds / max(mine.milliseconds, 1e-9) for theirs, mine in pairs])
    said = f"""Study and engine differ by {apart:.0e} at most, which is the turning of bolts; the engine's load step
takes 1/{ratio:.0f} of the time in the middle of the rows."""
    title = "## Small-sliding contacts of the engine"
    return f"{title}\n\n{textwrap.fill(what, 120)}\n\n{table(head, rows)}\n{textwrap.fill(said, 120)}\n"


def page(joint: Joint, found: Sequence[Space], results: Sequence[Compared], both: Sequence[Both]) -> str:
    """The Markdown page."""
    parts = []
    for one in results:
        rows = []
        for space, entry in zip(found, one.entries, strict=True):
            row = [space.name, str(space.unknowns), str(space.solves)]
            if entry is None:
                rows.append([*row, "no state found", "", "", "", "", ""])
                continue
            shares = (entry.pressure, entry.traction, entry.slip)
            row += [f"{v:.1%}" for v in shares] + [f"{entry.loss:+.1%}", f"{entry.amplitude:+.2%}"]
            rows.append([*row, f"{entry.milliseconds:.1f}"])
        head = ["space", "unknowns", "solves", "pressure", "friction", "slip", "loss", "amplitude", "ms"]
        last = len(one.reference.force) - 1
        slips = np.mean(one.reference.state[last] == SLIP) / max(np.mean(one.reference.state[last] > 0), 1e-9)
        swing = np.ptp(one.reference.observed[-2 * STEPS[2] - 1 :, 0])
        loss = one.reference.loss(last - 2 * STEPS[2], last)
        text = (
            f"Tip force ±{one.force:g} N: amplitude {0.5e6 * swing:.1f} µm, loss per cycle {1e3 * loss:.3f} mJ; at the "
            f"peak {slips:.0%} of the cells that touch slip, {np.mean(one.reference.state[last] == 0):.0%} are open."
        )
        parts.append(f"## {one.name.capitalize()}\n\n{textwrap.fill(text, 120)}\n\n{table(head, rows)}")
    what = f"""Two steel sheets of {SIZE[0] * 1e3:g} x {SIZE[1] * 1e3:g} x {SIZE[2] * 1e3:g} mm lie on each other,
clamped at one end, pressed together by two bolts ({PRELOAD / 1e3:g} kN each, as forces under heads of
{2e3 * HALF_WIDTH:g} mm at {BOLTS[0] * 1e3:g} and {BOLTS[1] * 1e3:g} mm), and bent by a force at the tip of the upper
one: {joint.lap.model.size} dofs of hex27, {joint.cells.count} facets in the joint, friction {FRICTION:g}, a layer of
{LAYER:g} Pa/m, which spaces of few coordinates need. The full model has every facet as a cell and the full
flexibility between them. *Statics + modes*: the responses to preload and tip force, and the lowest modes of the open
joint. *TVD*: with trial vector derivatives (`wf.bases.TrialVectorDerivatives`), half from pressures, half from
tractions; what they leave out of the derivatives stands beside them, which says how far the set of derivatives is
used up, not how good it is. *Cells*: the flexibility of the relative motion of larger cells, uniform tractions on
each; graded ones grow with the distance from the ends and the edges of the heads, by "growth" times it. Errors in L2 at
the peak, of slip that of its range in the last cycle where cells touch; loss and amplitude of that cycle. Solves:
static ones before the first increment. Milliseconds an increment with the dense solver that all go through, in which
the forces of the cells are the unknowns; a space of m coordinates still has all of them."""
    return f"""# Reducing a joint: coordinates for the bodies or cells of the joint

Made by `python -m studies.small_sliding.joint_bases`; do not edit.

{textwrap.fill(what, 120)}

{chr(10).join(parts)}
{engine_table(both)}
## What to take from it

{_reading(results)}"""


def _reading(results: Sequence[Compared]) -> str:
    """Sentences whose figures are those of the tables."""

    def told(one: Compared, begins: str, value: str, form: str) -> str:
        entries = [e for e in one.entries if e is not None and e.space.name.startswith(begins)]
        return ", ".join(f"{getattr(e, value):{form}} ({e.space.unknowns})" for e in entries) or "no state found"

    points = []
    for one in results:
        points.append(
            f"{one.name.capitalize()}, error of pressure by unknowns: statics + modes "
            f"{told(one, 'statics', 'pressure', '.0%')}; with TVD {told(one, '+', 'pressure', '.0%')}; cells "
            f"{told(one, 'cells', 'pressure', '.1%')}; graded {told(one, 'graded', 'pressure', '.1%')}."
        )
        points.append(
            f"Loss per cycle there: statics + modes {told(one, 'statics', 'loss', '+.0%')}; with TVD "
            f"{told(one, '+', 'loss', '+.0%')}; cells {told(one, 'cells', 'loss', '+.1%')}; graded "
            f"{told(one, 'graded', 'loss', '+.1%')}."
        )
    points.append(
        "A basis cannot press where no mode presses: its errors of pressure stay, and do not fall evenly with its "
        "size. The flexibility of the cells is exact for the tractions that the cells can have, at the price of "
        "one solve an unknown, and what is lost by larger cells is known: it is where the slip zone ends inside a "
        "cell."
    )
    wrapped = (textwrap.fill(p, 120, initial_indent="- ", subsequent_indent="  ") for p in points)
    return "\n".join(wrapped) + "\n"


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the page."""
    given: Sequence[Any] = sys.argv[1:] if arguments is None else arguments
    folder = Path(given[0] if given else "docs/studies")
    folder.mkdir(parents=True, exist_ok=True)
    with one_thread():
        joint = two_sheets()
        found = spaces(joint)
        results = compared(joint, found)
        references = {one.name: (one.force, one.reference) for one in results}
        both = joint_engine.compared(joint, joint_engine.sheets(COUNTS), references)
    (folder / "joint_bases.md").write_text(page(joint, found, results, both))
    print(folder / "joint_bases.md")


if __name__ == "__main__":
    main()
