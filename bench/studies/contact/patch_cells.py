"""Error by the number of cells of a patch: the rule behind `Contact(cell_error=)`.

Two hollow rollers of 4 mm hexahedra (`coarse_rollers`) at rest, straight and crowned, on cells of many numbers. Bodies
and half-space are the same in all of them, so that cells are all that differs from the finest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from studies.contact.coarse_rollers import PAIR, held, hexahedra, reduced
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online.compile.patches.plan import CROWNED_ERROR, STRIPS_ERROR
from warpffrf.output.simulate import equilibrium
from warpffrf.study.markdown import table

STRIPS = (5, 7, 9, 11, 13, 15, 17, 21)
ROWS = (11, 15, 19, 23, 27, 35, 45)
FINE = 2.0  # times the largest number


@dataclass(frozen=True)
class Case:
    """A roller with a crown of `radius` [m], None of a straight one, at an `approach` [m], rows that `follow`."""

    name: str
    radius: float | None
    approach: float
    rows: int | None  # against strips; None: as many


CASES = (
    Case("line", None, 3e-5, 21),
    Case("crown of 2 m, rows fixed", 2.0, 1e-5, 45),
    Case("crown of 0.14 m, rows follow", 0.14, 1e-5, None),
)


def found(body: ReducedBody, approach: float, cells: tuple[int, int]) -> tuple[float, float]:
    """Force [N] and largest pressure [Pa] at rest on cells, strips by rows."""
    result = equilibrium(held(body, body, approach, cells=cells))
    if result.status != "completed":
        raise RuntimeError(result.message)
    pair: Any = result.contact(PAIR)
    return float(pair.force_magnitude[-1]), float(pair.peak_pressure[-1])


def errors(
    body: ReducedBody, approach: float, cells: list[tuple[int, int]], finest: tuple[int, int]
) -> list[tuple[float, float]]:
    """Relative errors of force and largest pressure on each of `cells`, against the `finest`."""
    exact = found(body, approach, finest)
    return [
        (force / exact[0] - 1.0, pressure / exact[1] - 1.0)
        for force, pressure in (found(body, approach, n) for n in cells)
    ]


def strip_rows(bodies: dict[float | None, ReducedBody]) -> list[list[str]]:
    """By number of strips the errors of every case, and the rule's."""
    columns = []
    last = round(FINE * STRIPS[-1]) - 1
    for case in CASES:
        cells = [(n, case.rows or n) for n in (*STRIPS, last)]
        columns.append(errors(bodies[case.radius], case.approach, cells[:-1], cells[-1]))
    return [
        [str(n), *(f"{value:+.2%}" for column in columns for value in column[i]), f"{STRIPS_ERROR / n**2:.2%}"]
        for i, n in enumerate(STRIPS)
    ]


def row_rows(bodies: dict[float | None, ReducedBody]) -> list[list[str]]:
    """By number of fixed rows the errors of a line and of a crown, and the rule's for the crown."""
    last = round(FINE * ROWS[-1]) - 1
    columns = [
        errors(bodies[case.radius], case.approach, [(11, n) for n in ROWS], (11, last)) for case in CASES if case.rows
    ]
    return [
        [str(n), *(f"{value:+.2%}" for column in columns for value in column[i]), f"{CROWNED_ERROR / n**3:.2%}"]
        for i, n in enumerate(ROWS)
    ]


def compute() -> dict[str, list[list[str]]]:
    """Rows by strips across and by rows along."""
    bodies = {
        case.radius: reduced(
            hexahedra(4e-3) if case.radius is None else hexahedra(4e-3, 2, case.radius), case.radius
        )
        for case in CASES
    }  # fmt: skip
    return {"strips": strip_rows(bodies), "rows": row_rows(bodies)}


def page(found: dict[str, list[list[str]]]) -> str:
    """The whole page."""
    head = [f"{case.name}: {what}" for case in CASES for what in ("force", "peak")]
    fixed = [f"{case.name}: {what}" for case in CASES if case.rows for what in ("force", "peak")]
    return f"""# Cells of a patch and their error

Two hollow steel rollers (R 50, bore 15, width 20 mm) of 4 mm hexahedra, bores held at an approach: force and largest
pressure on contact-fixed cells, compared with the same on twice as many. The patch takes nine of eleven strips.
Where rows follow the patch errors go up and down as cells lie under its edge; all stay below the rule by which
`Contact(cell_error=)` chooses how many there are. Five strips can err by more in a patch that moves.

## Strips across

Rows along: 21 of the line, 45 of the crown on which rows are fixed, as many as strips where they follow the patch.

{table(["strips", *head, "rule"], found["strips"])}
## Rows along

Eleven strips. A crown of 2 m carries on a part of the width; the rule is for it. Rows of straight rollers are there for
the pressure near their ends.

{table(["rows", *fixed, "rule"], found["rows"])}"""
