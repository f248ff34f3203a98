"""The friction law in body-fixed cells compared with Carter, Cattaneo and Mindlin; two minutes.

Every figure is computed here by the reference of the friction law (`rolling` and `tangential_loading` in `half_space`),
which shares nothing with the engine.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from references.closed_forms import (
    CarterRolling,
    LineContact,
    MindlinLine,
    MindlinPoint,
    PointContact,
    contact_modulus,
    tangential_compliance,
)
from references.half_space.rolling import Rolling, settle
from references.half_space.tangential_loading import Patch, cycle_loss, line_patch, point_patch
from warpffrf.model.material import Material
from warpffrf.study.markdown import table

STEEL = Material(210e9, 0.3, 7800.0, name="steel")
FRICTION = 0.3
LINE = LineContact(1e5, 0.025, contact_modulus(STEEL, STEEL))  # case C1
POINT = PointContact(100.0, 0.01, contact_modulus(STEEL))  # case C3
SHARES = (0.25, 0.5, 0.75, 0.99)  # Q/(mu P) of case C6
CELLS = STEPS = (8, 16, 32)
PHASES = (0.0, 0.25, 0.5, 0.75, 0.9)
CROSSINGS = 10.0


@dataclass(frozen=True)
class Settled:
    """Q/(mu P) against Carter's, relative, mean over the last crossing; stick zone at its end: first and last sticking
    edge against Carter's, in cells; smallest work [J/m] of friction in a step."""

    error: float
    stick_begin: float  # towards the trailing edge
    stick_end: float  # towards the leading edge
    least_loss: float


def settled(
    share: float, cells: float, steps: int, *, phase: float = 0.0, carried: bool = False, late: bool = True
) -> Settled:
    """Rolling at Carter's creepage for Q/(mu P) = share; phase, carried, late: of `Rolling`."""
    exact = CarterRolling.from_share(LINE, FRICTION, share)
    rolling = Rolling(LINE, FRICTION, cells, phase=phase, carried=carried, late=late)
    found = settle(rolling, exact.creepage, steps=steps, crossings=CROSSINGS)
    x, w = rolling.centers[rolling.stick], rolling.width
    if not len(x):
        x = np.full(1, np.nan)
    begin, end = (x.min() - 0.5 * w - exact.stick_end) / w, (x.max() + 0.5 * w - LINE.half_width) / w
    return Settled(float(np.mean(found[-steps:])) / share - 1.0, float(begin), float(end), rolling.least_loss)


def creepage_error(share: float, cells: float, steps: int) -> float:
    """Relative error of the creepage, mean over the last crossing, at the prescribed force."""
    exact = CarterRolling.from_share(LINE, FRICTION, share)
    rolling = Rolling(LINE, FRICTION, cells)
    whole = float(rolling.bound.sum() * rolling.width)
    advance = 2.0 * LINE.half_width / steps
    found = [rolling.roll_under(advance, share * whole) for _ in range(int(CROSSINGS) * steps)]
    return float(np.mean(found[-steps:])) / exact.creepage - 1.0


def law_rows() -> list[list[str]]:
    """Cells by steps; the cells travel, so that a fraction of a cell per step passes through the phases."""
    rows = []
    for cells in CELLS:
        for steps in STEPS:
            found = [settled(q, cells, steps, carried=True).error for q in SHARES]
            rows.append([str(cells), str(steps), f"{2 * cells / steps:g}", *(f"{e:+.2%}" for e in found)])
    return rows


def phase_rows(late: bool) -> list[list[str]]:
    """Over the phase, at whole cells per step, with and without the softness of cells that the patch reaches."""
    rows = []
    for cells, steps in ((8, 16), (8, 8), (16, 32)):
        for p in PHASES:
            found = [settled(q, cells, steps, phase=p, late=late).error for q in SHARES]
            rows.append([str(cells), f"{2 * cells / steps:g}", f"{p:g}", *(f"{e:+.2%}" for e in found)])
    return rows


def stick_rows() -> list[list[str]]:
    """Ends of the stick zone."""
    rows = []
    for cells in CELLS:
        for q in SHARES:
            s = settled(q, cells, 2 * cells)
            ratio = CarterRolling.from_share(LINE, FRICTION, q).stick_ratio
            rows.append(
                [str(cells), f"{q:g}", f"{2.0 * ratio * cells:.1f}", f"{s.stick_end:+.1f}", f"{s.stick_begin:+.1f}"]
            )
    return rows


def transient_rows() -> list[list[str]]:
    """Q against its own end value after some crossings, by the depth of the fixed point."""
    rows = []
    exact = CarterRolling.from_share(LINE, FRICTION, 0.5)
    for depth in (3.0, 10.0, 100.0):
        rolling = Rolling(LINE, FRICTION, 8, depth=depth)
        q = np.array(settle(rolling, exact.creepage, steps=16, crossings=60.0))
        rows.append([f"{depth:g} a", *(f"{q[16 * n - 1] / q[-1] - 1.0:+.2%}" for n in (1, 2, 5, 10, 20))])
    return rows


def line_rows() -> list[list[str]]:
    """Cattaneo's line."""
    rows, exact = [], MindlinLine(LINE, FRICTION, 10.0 * LINE.half_width)
    for cells in (8, 16, 32):
        for q in (0.25, 0.5, 0.75):
            patch = line_patch(LINE, FRICTION, cells)
            rows.append(_mindlin_row(patch, exact, q, cells, 8))
    return rows


def point_rows() -> list[list[str]]:
    """Mindlin's circle."""
    exact = MindlinPoint(POINT, FRICTION, tangential_compliance(STEEL))
    return [
        _mindlin_row(point_patch(POINT, FRICTION, cells, STEEL), exact, q, cells, 6)
        for cells in (6, 8, 10, 12)
        for q in (0.5, 0.75)
    ]


def mindlin_errors(
    patch: Patch, exact: MindlinLine | MindlinPoint, share: float, cells: int, steps: int
) -> tuple[float, float, float]:
    """Load to Q = share mu P and a cycle: error of the stick size in cells, of the displacement, of the loss."""
    force = share * exact.limit
    patch.move_under(share * patch.limit, 2.0 * float(exact.loading(0.95 * exact.limit)))
    a, shift = exact.contact.half_width, patch.shift
    stick = (patch.stick_size - exact.stick_ratio(force) * a) / (a / cells)
    loss = cycle_loss(patch, shift, steps)
    return stick, shift / float(exact.loading(force)) - 1.0, loss / exact.cycle_loss(force) - 1.0


def _mindlin_row(patch: Patch, exact: MindlinLine | MindlinPoint, share: float, cells: int, steps: int) -> list[str]:
    stick, shift, loss = mindlin_errors(patch, exact, share, cells, steps)
    return [str(cells), f"{share:g}", f"{stick:+.2f}", f"{shift:+.2%}", f"{loss:+.2%}"]


def compute() -> dict[str, list[list[str]]]:
    """The figures of the page."""
    return {
        "law": law_rows(),
        "phase": phase_rows(True),
        "phase_2": phase_rows(False),
        "forced": [[f"{q:g}", f"{creepage_error(q, 8, 16):+.2%}"] for q in SHARES],
        "stick": stick_rows(),
        "transient": transient_rows(),
        "line": line_rows(),
        "point": point_rows(),
    }


def page(found: dict[str, list[list[str]]]) -> str:
    """The whole page."""
    shares = [f"Q/μP {q:g}" for q in SHARES]
    mindlin = ["cells", "Q/μP", "stick, cells", "displacement", "loss per cycle"]
    return f"""# Friction in body-fixed cells compared with Carter, Cattaneo and Mindlin

A reference of the friction law without bodies: exact elastic half-plane and half-space, Hertz's contact with its
pressure in bilinear shape functions, traction constant in cells, slip in the mean over them, bounds half the way from
the node to the mean of the pressure over the cell, one convex program per step (`friction_program.py`). Steel on steel,
C1 of the verification cases (a = {LINE.half_width * 1e3:.4f} mm, R = 25 mm), μ = {FRICTION:g}.

## Carter: error of Q at his creepage

After {CROSSINGS:g} crossings of the patch, mean over the last; a point at the depth 10 a fixed; cells travel with the
material. Cells per half-width, steps per crossing, cells advanced per step.

{table(["cells", "steps", "cells/step", *shares], found["law"])}
A cell that the patch reaches during a step resists by what is left of the step then (`half_space/rolling.py`): what is
left of the error hardly depends on the step up to two cells, nor on where the cells lie against the patch. Here they
stand with it, at a phase in cells (at 0 a centre is in the middle).

{table(["cells", "cells/step", "phase", *shares], found["phase"])}
The same with such cells charged with the whole step:

{table(["cells", "cells/step", "phase", *shares], found["phase_2"])}
Prescribed Q, 8 cells and 16 steps: error of the creepage.

{table(["Q/μP", "creepage"], found["forced"])}
## Stick zone

It touches the leading edge. Its ends against Carter's, in cells, one cell advanced per step: the leading end against
a (the cell next to the patch has a small bound and sticks), the trailing end against a - 2 c.

{table(["cells", "Q/μP", "cells in 2 c", "leading end", "trailing end"], found["stick"])}
## Transient

Q/μP = 0.5, 8 cells, 16 steps: Q against its own end value, by the depth L of the fixed point and the crossings rolled.
The deeper the body, the longer it takes: its elastic shift is wound up by the creep.

{table(["depth", "1", "2", "5", "10", "20"], found["transient"])}
## Cattaneo and Mindlin

A standing patch is loaded to Q and back and forth once. Size of the stick zone (in cells), displacement at Q, work lost
in the cycle, against the closed forms. *Line*, like steels:

{table(mindlin, found["line"])}
*Point*, case C3 (steel sphere on a rigid plane), both components of traction:

{table(mindlin, found["point"])}
The loss is made in a slip zone of width a - c: of two cells there it has some percent.
"""
