"""Small-sliding contacts of the engine beside closed forms: what joints that slide a little are accepted by.

`python -m studies.small_sliding.acceptance [FOLDER]` writes docs/studies/small_sliding_acceptance.md. Minutes. Cases at
rest are in `cases`, those in motion in `motion`.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

from studies.small_sliding import cases as cases
from studies.small_sliding import motion as motion
from studies.small_sliding.rows import Row
from warpffrf.study.markdown import table

MADE = "Made by `python -m studies.small_sliding.acceptance`; do not edit.\n"

CASES: dict[str, Callable[[], list[Row]]] = {
    "leaves": cases.leaf_rows, "steps": cases.many_steps_rows, "bar": cases.micro_slip_rows, "bolt": cases.bolt_rows,
    "fit": cases.press_fit_rows, "press": cases.press_rows, "flight": motion.flight_rows, "ring": motion.ring_down_rows,
}  # fmt: skip


def page() -> str:
    """Markdown."""
    found = [row for case in CASES.values() for row in case()]
    missed = [row for row in found if not row.reached]
    head = ["case", "cells", "compared", "exact", "found", "error", "target", ""]
    return f"""# Joints that slide a little by their acceptance

{MADE}
Closed forms beside scenes that `simulate` solves, in load steps (`kind="static"`) and in time. Poisson's ratio is zero
but in the press of two blocks; cells are facets of the mesh where nothing else is said.

{len(found) - len(missed)} of {len(found)} targets are reached.

{table(head, [row.line() for row in found])}
{READ}"""


READ = """\
**Two leaves**, 200 x 20 x 4 mm each, are clamped at one end, pressed together from outside and loaded at the tip, half
of the force on either. A cycle goes to twice the force of slip. What is off of the stuck deflection is shear, which the
closed form leaves out. Times are those of the whole call, after the program was compiled, the least of three; that of
the processor counts where the machine does other work as well.

**The bar**, 4 mm high, stands between rigid faces with interference, and is pulled at one end; cells grow from there.
Behind the slip zone the bar sticks by its own shear, over less than half its height where the closed form has none: at
the smallest force, with a slip zone of six heights, that is most of what the loss is off.

**The press fit** has curved quadratic cells; what the seat is off is that of means over facets, which are flat to their
cells, and falls with their number.

**The pair that spins** is held by a spring alone, which pulls from the start; the first half of the flight, in which
that has died away, is left out of the angular momentum, as steps of an impact turn while they last.

**The mass** swings on a spring at the end of the bar and loses energy by the slip of the bar alone. Load steps between
the same forces give D, and U as half of force times displacement; the damping is that by which the force of the spring
falls from cycle to cycle.
"""


def main(folder: Path) -> None:
    """Writes the page to `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "small_sliding_acceptance.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("docs/studies"))
