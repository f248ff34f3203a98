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
from warpffrf.output.plots.bearing import BEARING_PLOTS, POLAR
from warpffrf.output.plots.figure import OfPair, about_kinds, drawable
from warpffrf.output.plots.scene_picture import ScenePicture, row_at
from warpffrf.output.report.fold import Entry
from warpffrf.output.report.model import modelled
from warpffrf.output.report.report import Report, report_of

SIZE = (5.2, 3.9)  # inches of a plot
MOST = 4  # contacts, films and bearings after the first whose maps are drawn, the most loaded ones
MAPS = {"contact": ("patch", "stick_slip"), "film": ("film_pressure", "film_gap"), "bearing": tuple(BEARING_PLOTS)}


def write_run_page(result: Any, path: str | os.PathLike[str], *, overwrite: bool, progress: bool) -> Path:
    """Write the page of a run, see `Result.page`; returns its path."""
    title = f"Run: {Path(path).stem}"
    return html.write_page(path, "page", lambda: run_page(result, title, progress), overwrite=overwrite)


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
    found, known = list[str](), errors(report.budget) if not report.unknown else {}
    entries = [*report.contacts, *report.items]
    head = ("quantity", "value", *(["estimated error (largest source)"] if known else []))
    for kind in dict.fromkeys(entry.kind for entry in entries):
        rows = [row for entry in entries if entry.kind == kind for row in _rows(entry, known)]
        found += [html.heading(f"{kind.capitalize()}s"), html.table(head, rows)]
    return found


def _rows(entry: Entry, known: Mapping[str, Mapping[str, Error]]) -> Iterator[Sequence[str]]:
    """The head of an entry, its figures, and errors of what has none."""
    about = [figure.text for figure in entry.figures if not figure.label and not figure.of]
    yield [": ".join([entry.head, *about])]
    owners = [{**known.get(f"{k} {name!r}", {})} for name in entry.names for k in {entry.kind.split()[-1], entry.kind}]
    told = set[str]()
    for figure in entry.figures:
        if figure.label or figure.of:
            told |= {*figure.of}
            cells = [figure.label or " and ".join(figure.of), figure.text]
            yield [*cells, "; ".join(_error(owners, kind, len(figure.of) > 1) for kind in figure.of)] if known else cells
    others = [kind for kind in dict.fromkeys(kind for own in owners for kind in own) if kind not in told]
    for kind in others:
        yield [kind, "", _error(owners, kind, False)]


def _error(owners: Sequence[Mapping[str, Error]], kind: str, named: bool) -> str:
    """The error of a quantity, for a group of owners the least and the largest."""
    own = [kinds[kind] for kinds in owners if kind in kinds]
    sized = sorted((error for error in own if error.source), key=lambda error: error.size)
    parts = [f"{100.0 * sized[0].size:.2g} to {sized[-1]}" if len(sized) > 1 else str(error) for error in sized[-1:]]
    parts += [f"not estimated: {why}" for why in dict.fromkeys(error.missing for error in own if error.missing)]
    return (f"{kind} " if named and parts else "") + "; ".join(parts)


def _bearings(result: Any) -> list[str]:
    found = []
    for name in result.bearing_names if len(result.time) else ():
        bearing = result.bearing(name)
        lines, columns = printed(bearing, -1)
        rows = [(n + 1, *(cells[n] for cells in columns.values())) for n in range(len(bearing.elements))]
        found += [*map(html.paragraph, lines), html.table((bearing.kind, *columns), rows, dense=True)]
    return found


def _plots(result: Any) -> list[str]:
    """Every plot for which the run has data, and the maps of further contacts, films and bearings."""
    if not len(result.time):
        return []
    wanted: list[tuple[str, dict[str, str]]] = [(kind, {}) for kind in drawable(result) if kind not in BEARING_PLOTS]
    first = result.finite_sliding_names or result.small_sliding_names
    names = {
        "contact": _most_loaded([name for name in result.contact_names if name not in first[:1]], result.contact),
        "film": _most_loaded(result.film_names[1:], result.film),
        "bearing": result.bearing_names[: MOST + 1],
    }
    for what, own in names.items():
        for name in own:
            kinds = drawable(OfPair(result, name)) if what == "contact" else MAPS[what]
            wanted += [(kind, {what: name}) for kind in MAPS[what] if kind in kinds]
    drawn = [_plot(result, kind, named) for kind, named in wanted]
    return [html.plots(drawn)]


def _most_loaded(names: Sequence[str], get: Any) -> list[str]:
    return sorted(names, key=lambda name: -float(np.linalg.norm(get(name).force[-1])))[:MOST]


def _plot(result: Any, kind: str, named: Mapping[str, str]) -> str:
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained")
    result.plot(kind, figure.add_subplot(projection="polar" if kind in POLAR else None), **named)
    whose = "".join(f" Of {what} '{name}'." for what, name in named.items())
    about = about_kinds()[kind] + whose
    return html.picture(figure, f"Plot: {about}", about)


def _errors(report: Report) -> list[str]:
    """The error budget with its cure, and the errors of quantities that are not in the tables of results."""
    if report.unknown or not report.budget:
        return [html.paragraph(f"Error budget {report.unknown}.")] if report.unknown else []
    worst = worst_lines(report.budget)
    rows = [(line.source, effect(line), line.basis, line.cure) for line in worst]
    listed = {entry.kind for entry in (*report.contacts, *report.items)}
    others = [
        (entry.head, "; ".join(figure.text for figure in entry.figures))
        for entry in report.errors()
        if entry.kind not in listed
    ]
    found = [
        html.paragraph("The largest effect of each source of error on the results, estimated without a reference run."),
        html.table(("source", "largest effect", "how it was estimated", "cure"), rows),
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
            rows.append((line.replace("_", " "), f"{values[-1]:.6g}", ENERGY_MEANINGS.get(line, "")))
    return [
        html.table(("quantity", "value"), [(figure.label, figure.text) for figure in report.energy]),
        html.table(("line of the ledger", "at the end [J]", "meaning"), rows),
    ]


def _settings(result: Any, report: Report) -> list[str]:
    options = [(name.replace("_", " "), text) for name, text in result.history.options.items() if name != "scene"]
    return [
        html.table(("setting", "value"), options),
        html.table(("of the solver", "value"), [(figure.label, figure.text) for figure in report.run[2:]]),
    ]


def _versions(result: Any) -> list[str]:
    rows = [*result.history.versions.items(), ("content hash of the scene", result.view.content_hash)]
    for name, body in result.view.bodies.items():
        versions = {} if body.reduced is None else body.reduced.provenance.get("versions", {})
        if versions:
            rows.append((f"reduction of body '{name}'", ", ".join(f"{k} {v}" for k, v in versions.items())))
    return [html.table(("of", "version"), rows)]
