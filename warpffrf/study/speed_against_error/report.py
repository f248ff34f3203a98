"""The report of a study as Markdown: reference, machine, what to take for a wanted error, fronts, orders, all runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from warpffrf.model.errors import InputError
from warpffrf.study.markdown import table
from warpffrf.study.speed_against_error.errors import OWN
from warpffrf.study.speed_against_error.front import WANTED, changed_names, label_in
from warpffrf.study.speed_against_error.machine import stated, unit_of
from warpffrf.study.speed_against_error.tables import UNITS, front_table, full_table, order_table, shortened

if TYPE_CHECKING:  # what it reports; it is imported there
    from warpffrf.study.speed_against_error.outcome import SpeedError


def wanted_table(study: SpeedError) -> tuple[list[str], list[list[str]]]:
    """The fastest setting for each of WANTED, or why there is none."""
    names, lines = changed_names(study.rows), []
    for error in WANTED:
        try:
            best = study.recommended(error)
            lines.append([f"{error:.1%}", label_in(names, best) or best.label, f"{best.fastest:.4g}"])
        except InputError as none:
            lines.append([f"{error:.1%}", str(none).removeprefix("speed_error: "), "-"])
    return ["error", "setting", "wall s/s"], lines


def report(study: SpeedError) -> str:
    """Everything."""
    unit = unit_of(study.sittings)
    apart = ", ".join(f"{m} {100.0 * e:.2g} %" for m, e in study.reference["apart"].items())
    parts = [
        f"Reference: {study.reference['label']}; from twice its step it differs by {apart or 'nothing measured'}.",
        *(stated(facts) for facts in study.sittings),
        "Fastest within a wanted error of all measures against the reference:",
        table(*wanted_table(study)),
    ]
    against = [m for m in study.measures if m not in OWN]
    head, lines = front_table(study.rows, against, unit)
    if lines:
        parts += ["Settings on a front, from fast to slow; errors against the reference:", table(head, lines)]
    orders = study.orders()
    if orders:
        parts += [
            "Order in the step, from differences of runs whose steps follow one another, coarse to fine:",
            table(*order_table(orders)),
        ]
    head, lines, same = shortened(*full_table(study.rows, study.measures, unit))
    parts += ["All runs:", table(head, lines)]
    if same:
        parts.append("The same in all of them: " + ", ".join(f"{name} {value}" for name, value in same.items()) + ".")
    if UNITS in head:
        parts.append("`step U` is the time of a step in units of U.")
    parts += [f"Left out: {name} {value}: {reason}." for name, value, reason in study.left_out]
    return "\n\n".join(part.rstrip("\n") for part in parts) + "\n"
