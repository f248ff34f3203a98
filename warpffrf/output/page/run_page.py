"""A run as one self-contained HTML page: what was modelled, the figures of its report with their errors, plots, error
budget, energy, neglected effects, settings and versions."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.online.history.history import ENERGY_MEANINGS
from warpffrf.output.bearings.bearing_result import printed
from warpffrf.output.bodies.skin import DISPLACEMENT
from warpffrf.output.budget.budget import conclusion, effect, worst_lines
from warpffrf.output.budget.figures import Error, errors
from warpffrf.output.page import html
from warpffrf.output.plots.bearing import BEARING_PLOTS, MOST_NAMED, POLAR
from warpffrf.output.plots.figure import OfPair, about_kinds, drawable
from warpffrf.output.plots.gears import GEAR_PLOTS, gear_kinds
from warpffrf.output.plots.scene_picture import ScenePicture, row_at
from warpffrf.output.report.fold import Entry
from warpffrf.output.report.model import modelled
from warpffrf.output.report.report import Report, report_of

SIZE = (5.2, 3.9)  # inches of a plot
MOST = 4  # contacts, films, bearings and gear pairs after the first whose maps are drawn, the most loaded ones
ABOUT_RESULTS = "Values at the last saved step, with the largest of the run in brackets."
ABOUT_ERRORS = " Errors are estimates: all sources together, with the name of the largest."
TIMES = ("duration", "step")  # settings in seconds
MAPS = {
    "contact": ("patch", "stick_slip"), "film": ("film_pressure", "film_gap"), "bearing": tuple(BEARING_PLOTS),
    "gear": tuple(GEAR_PLOTS),
}  # fmt: skip


def write_run_page(result: Any, path: str | os.PathLike[str], *, overwrite: bool, progress: bool) -> Path:
    """Write the page of a run, see `Result.page`; returns its path."""
    return html.write_page(
        path, "page", lambda: run_page(result, f"Run: {Path(path).stem}", progress), overwrite=overwrite
    )


def run_page(result: Any, title: str, progress: bool = False) -> str:
    """The page as text."""
    report = report_of(result, progress)
    sections = {
        "What was modelled": _model(result),
        "Results": _results(report),
        "Bearings": _bearings(result),
        "Plots": _plots(result),
        "Errors": _errors(report),
        "Energy": _energy(result, report),
        "Neglected and limited": [html.listed(report.notes)] if report.notes else [],
        "Settings": _settings(result, report),
        "Versions": _versions(result),
    }
    sections = {name: parts for name, parts in sections.items() if parts}
    status, *rest = report.run
    look = "good" if result.status == "completed" else "bad"
    head = [html.paragraph(f"Status: {status.text}", look), *(html.paragraph(f.text) for f in rest[:1])]
    if said := conclusion(worst_lines(report.budget)):
        head.append(html.paragraph(f"Largest estimated error: {said}"))
    return html.document(
        title, *head, html.contents(sections), *(html.section(name, *parts) for name, parts in sections.items())
    )


def _model(result: Any) -> list[str]:
    view, rows = result.view, list[tuple[str, str]]()
    gravity = view.description.get("gravity", (0.0, 0.0, 0.0))
    if np.any(gravity):
        rows.append(("gravity", f"({', '.join(f'{g:.6g}' for g in gravity)}) m/s2"))
    for entry in modelled(view):
        rows.append((entry.head, "; ".join(figure.text for figure in entry.figures)))
    return [*_picture(result), html.table(("item", "description, in SI units"), rows)]


def _picture(result: Any) -> list[str]:
    """The bodies at the last saved step, where they can be drawn."""
    try:
        row = row_at(result, None, "page")
        scene = ScenePicture(result, DISPLACEMENT, np.array([row]), factor=None, what="page")
    except InputError:
        return []
    figure = scene.figure()
    scene.draw(figure, row)
    names = ", ".join(result.view.bodies)
    return [html.picture(figure, f"Picture of the bodies {names}", "The bodies at the last saved step.")]


def _results(report: Report) -> list[str]:
    """A table of figures for each kind of item."""
    known = errors(report.budget) if not report.unknown else {}
    entries = [*report.contacts, *report.items]
    head = ("quantity", "value", *(["error (source)"] if known else []))
    found = [html.paragraph(ABOUT_RESULTS + (ABOUT_ERRORS if known else ""))] if entries else []
    for kind in dict.fromkeys(entry.kind for entry in entries):
        rows = [row for entry in entries if entry.kind == kind for row in _rows(entry, known)]
        found += [html.heading(f"{kind.capitalize()}s"), html.table(head, rows)]
    return found


def _rows(entry: Entry, known: Mapping[str, Mapping[str, Error]]) -> Iterator[Sequence[str]]:
    """The head of an entry, its figures, and errors of quantities that it does not list."""
    about = [figure.text for figure in entry.figures if not figure.label and not figure.of]
    yield [": ".join([entry.head, *about])]
    owners = [known.get(f"{kind} {name!r}", {}) for name in entry.names for kind in _kinds(entry)]
    told = {kind for figure in entry.figures for kind in figure.of}
    for figure in entry.figures:
        if figure.label or figure.of:
            error = [_error(owners, figure.of)] if known else []
            yield [figure.label or " and ".join(figure.of), figure.text, *error]
    for kind in dict.fromkeys(kind for own in owners for kind in own if kind not in told):
        yield [kind, "not listed", _error(owners, (kind,))]


def _kinds(entry: Entry) -> tuple[str, ...]:
    """Its kinds in the error budget: the force of a lumped contact is that of a contact."""
    return tuple(dict.fromkeys((entry.kind, entry.kind.split()[-1])))


def _error(owners: Sequence[Mapping[str, Error]], kinds: Sequence[str]) -> str:
    """The errors of quantities, for a group of owners the least and the largest of each."""
    parts, missing = [], dict[str, None]()
    for kind in kinds:
        own = [errors_of[kind] for errors_of in owners if kind in errors_of]
        sized = sorted((error for error in own if error.source), key=lambda error: error.size)
        least = f"{100.0 * sized[0].size:.2g} to " if len(sized) > 1 else ""
        parts += [f"{f'{kind} ' if len(kinds) > 1 else ''}{least}{error}" for error in sized[-1:]]
        missing |= dict.fromkeys(error.missing for error in own if error.missing)
    return "; ".join([", ".join(parts), *(f"not estimated: {why}" for why in missing)]).removeprefix("; ")


def _bearings(result: Any) -> list[str]:
    found = []
    for name in result.bearing_names if len(result.time) else ():
        bearing = result.bearing(name)
        lines, columns = printed(bearing, -1)
        rows = [(n + 1, *(cells[n] for cells in columns.values())) for n in range(len(bearing.elements))]
        found += [*map(html.paragraph, lines), html.table((bearing.kind, *columns), rows)]
    return found


def _plots(result: Any) -> list[str]:
    """Every plot for which the run has data, and the maps of further contacts, films, bearings and gear pairs."""
    if not len(result.time):
        return []
    wanted: list[tuple[str, dict[str, str]]] = [(kind, {}) for kind in drawable(result) if kind not in BEARING_PLOTS]
    first = result.finite_sliding_names or result.small_sliding_names
    names = {
        "contact": _most_loaded([name for name in result.contact_names if name not in first[:1]], result.contact),
        "film": _most_loaded(result.film_names[1:], result.film),
        "bearing": result.bearing_names[: MOST + 1],
        "gear": result.gear_names[1 : MOST + 1] if len(result.time) > 1 else [],
    }
    for what, own in names.items():
        for name in own:
            kinds = drawable(OfPair(result, name)) if what == "contact" else MAPS[what]
            kinds = gear_kinds(result.gear(name)) if what == "gear" else kinds
            wanted += [(kind, {what: name}) for kind in MAPS[what] if kind in kinds]
    drawn = [_plot(result, kind, named) for kind, named in wanted]
    return [html.plots(drawn)]


def _most_loaded(names: Sequence[str], get: Any) -> list[str]:
    return sorted(names, key=lambda name: -float(np.linalg.norm(get(name).force[-1])))[:MOST]


def _plot(result: Any, kind: str, named: Mapping[str, str]) -> str:
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained")
    ax = figure.add_subplot(projection="polar" if kind in POLAR else None)
    result.plot(kind, ax, **named)
    about = [about_kinds()[kind].replace("`", ""), *(f"Of {what} '{name}'." for what, name in named.items())]
    legend = ax.get_legend()
    if legend is not None and (curves := len(legend.get_texts())) > MOST_NAMED:
        legend.remove()
        about.append(f"The names of the {curves} curves are left out.")
    whose = "".join(f" of {what} '{name}'" for what, name in named.items())
    return html.picture(figure, f"Plot '{kind}'{whose}: {' '.join(ax.get_title().split())}", " ".join(about))


def _errors(report: Report) -> list[str]:
    """The error budget with its cure, and the errors of quantities that are not in the tables of results."""
    if report.unknown or not report.budget:
        return [html.paragraph(f"Error budget {report.unknown}.")] if report.unknown else []
    worst = worst_lines(report.budget)
    rows = [(line.source, f"{effect(line)} ({line.basis})", line.cure) for line in worst]
    listed = {kind for entry in (*report.contacts, *report.items) for kind in _kinds(entry)}
    others = [
        (entry.head, "; ".join(figure.text for figure in entry.figures))
        for entry in report.errors()
        if entry.kind not in listed
    ]
    found = [
        html.paragraph("The largest effect of each source of error on the results, estimated without a reference run."),
        html.table(("source", "largest effect, and how it was estimated", "cure"), rows),
    ]
    if others:
        caption = "Errors of further results: all sources together, and the largest of them"
        found.append(html.table(("of", "error"), others, caption))
    return found


def _energy(result: Any, report: Report) -> list[str]:
    if not report.energy:
        return []
    rows = []
    for line, values in result.energy.items():
        if np.any(np.nan_to_num(values)):
            rows.append((line.replace("_", " "), f"{values[-1]:.5g}", ENERGY_MEANINGS.get(line, "")))
    return [
        html.table(("quantity", "value"), [(figure.label, figure.text) for figure in report.energy], "Balance"),
        html.table(("line", "at the end [J]", "meaning"), rows, "Ledger"),
    ]


def _settings(result: Any, report: Report) -> list[str]:
    options = result.history.options
    given = [(f"{name} [s]", f"{float(options[name]):.6g}") for name in TIMES if name in options]
    given += [(name.replace("_", " "), text) for name, text in options.items()
              if name not in ("scene", *TIMES) and text not in ("None", "False")]  # fmt: skip
    return [
        html.table(("setting", "value"), given, "Options that were set; others have their defaults"),
        html.table(("count", "value"), [(figure.label, figure.text) for figure in report.run[2:]], "Solver"),
    ]


def _versions(result: Any) -> list[str]:
    rows = [*result.history.versions.items(), ("content hash of the scene", result.view.content_hash)]
    for name, body in result.view.bodies.items():
        versions = {} if body.reduced is None else body.reduced.provenance.get("versions", {})
        if versions:
            rows.append((f"reduction of body '{name}'", ", ".join(f"{k} {v}" for k, v in versions.items())))
    return [html.table(("of", "version"), rows)]
