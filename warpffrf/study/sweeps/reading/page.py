"""A sweep as one self-contained HTML page: pictures are embedded, and nothing is loaded from elsewhere."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.output.files.fields import COMPONENTS
from warpffrf.output.page import html
from warpffrf.output.plots.panels import COLUMNS, panels_figure
from warpffrf.study.sweeps.design import GIVEN
from warpffrf.study.sweeps.reading.plot import MOST_PANELS, Axis, axes_of, axis_of, plot
from warpffrf.study.sweeps.reading.sensitivities import Sensitivities, of_rows, of_surface, sensitivities
from warpffrf.study.sweeps.reading.surface import surface
from warpffrf.study.sweeps.reading.values import COMPLETED, TIME, WAITING, Table, shown_in

MOST_FAILED = 100  # rows in the table of failed ones
SCATTER = ("mean", "standard deviation", "10 % to 90 % of the rows")
FAITHFUL = 0.5  # error of a response surface over the standard deviation, above which its sensitivities are not shown


def write_page(table: Table, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
    """Write the page of a sweep, see `Sweep.page`; returns its path."""
    return html.write_page(path, "sweep: page", lambda: page(table), overwrite=overwrite)


def page(table: Table) -> str:
    """The page as text."""
    return html.document(
        f"Sweep: {table.definition['title']}",
        _summary(table),
        html.section("What was swept", _parameters(table), _outputs(table)),
        *_failed(table),
        *(html.section(f"Output: {name}", *_output(table, name)) for name in table.output_names),
        *_budget(table),
        html.section("Times, machines and versions", *_times(table)),
        html.section("How to run it again", html.verbatim(call_of(table))),
    )


# --- parts


def _summary(table: Table) -> str:
    about, status = table.definition, table["status"]
    counts = Counter(map(str, status))
    said = ", ".join(f"{n} {name or 'not run yet'}" for name, n in counts.most_common())
    how = f", sample {about['sample']}, seed {about['seed']}" if about["sample"] else ""
    whole = set(counts) == {COMPLETED}
    return html.paragraph(f"{len(status)} rows of {about['call']}{how}: {said}.", "" if whole else "bad")


def _parameters(table: Table) -> str:
    rows = []
    for name in table.parameter_names:
        axis = axis_of(table, name)
        at = axis.distinct
        span = ", ".join(axis.words) if axis.words is not None else f"{axis.text(at[0])} to {axis.text(at[-1])}"
        rows.append((name, table.definition["parameters"][name], span, len(at)))
    return html.table(("parameter", "given as", "values", "how many"), rows)


def _outputs(table: Table) -> str:
    """What the outputs are, and how they scatter in a sample."""
    rows = []
    sampled = bool(table.definition["sample"])
    for name in table.output_names:
        numbers = np.asarray(table[name], dtype=float)
        dims, unit = table.about(name)
        factor, shown = shown_in(unit, numbers)
        finite = numbers[np.isfinite(numbers)] * factor
        span = f"{finite.min():.5g} to {finite.max():.5g}" if len(finite) else "no value"
        row = [name, table.definition["outputs"][name], span, shown, ", ".join(dims) or "one number"]
        if sampled:
            row += _scatter(finite) if len(finite) > 1 and not dims else ["", "", ""]
        rows.append(row)
    head = ["output", "is", "values", "unit", "in a row"]
    return html.table([*head, *SCATTER] if sampled else head, rows)


def _scatter(values: np.ndarray) -> list[str]:
    """Of (rows,): as `SCATTER`."""
    low, high = np.quantile(values, [0.1, 0.9])
    return [f"{values.mean():.5g}", f"{values.std(ddof=1):.3g}", f"{low:.5g} to {high:.5g}"]


def _failed(table: Table) -> list[str]:
    """The rows with another status than completed, with their messages."""
    status, message = table["status"], table["message"]
    failed = np.flatnonzero((status != COMPLETED) & (status != WAITING))
    if not len(failed):
        return []
    axes = [axis_of(table, name) for name in table.parameter_names]
    rows = [
        (int(n), status[n], *(axis.text(float(axis.positions[n])) for axis in axes), message[n])
        for n in failed[:MOST_FAILED]
    ]
    head = ("row", "status", *table.parameter_names, "message")
    caption = f"the first {MOST_FAILED} of {len(failed)}" if len(failed) > MOST_FAILED else ""
    return [html.section("Rows that failed", html.table(head, rows, caption))]


def _output(table: Table, name: str) -> list[str]:
    """Pictures of an output, its response surface, and its sensitivities; or the reasons why they are missing."""
    numbers = table[name]
    dims, _ = table.about(name)
    others = [dim for dim in dims if dim != TIME]
    if others and (len(others) > 1 or others[-1] not in COMPONENTS):
        shape = " x ".join(map(str, numbers.shape[1:]))
        return [html.paragraph(f"{shape} numbers in a row along {', '.join(dims)}: read them as sweep[{name!r}].")]
    if others:
        return [
            _said(lambda c=c: html.picture(plot(table, name, component=c), f"{name}, {c}"))
            for c in COMPONENTS[others[-1]]
        ]
    axes = axes_of(table, np.ones(len(table["status"]), dtype=bool))
    if TIME in dims:
        colors = [axis.name for axis in axes] or [None]
        return [
            _said(lambda by=by: html.picture(plot(table, name, hue=by), f"{name} over time, by {by}")) for by in colors
        ]
    parts = [
        _said(lambda axis=axis: html.picture(plot(table, name, x=axis.name), f"{name} over {axis.name}"))
        for axis in axes
    ]
    if len(axes) > 1:
        parts.append(_said(lambda: _map(table, name, axes)))
    if axes:
        parts.append(_said(lambda: _surface(table, name)))
    return parts


def _said(make: Callable[[], str]) -> str:
    """A part, or the reason why it is missing."""
    try:
        return make()
    except InputError as error:
        return html.paragraph(str(error))


def _map(table: Table, name: str, axes: Sequence[Axis]) -> str:
    """Map over the first two parameters, with a panel for each value of the third if there are few."""
    x, y, *others = axes
    col = others[0].name if others and len(others[0].distinct) <= min(MOST_PANELS, 2 * COLUMNS) else None
    return html.picture(plot(table, name, x=x.name, y=y.name, col=col), f"map of {name} over {x.name} and {y.name}")


def _surface(table: Table, name: str) -> str:
    """The response surface, and sensitivities: from rows of a suitable sample, else from that surface."""
    found = surface(table, name)
    report = html.verbatim(found.report())
    if of_rows(table):
        return report + _said(lambda: _bars(sensitivities(table, name)))
    if not found.relative_error <= FAITHFUL:
        return report + html.paragraph(
            "No sensitivities: the response surface is off by more than half of the standard deviation, or by how much "
            "is not known; sweep more rows, or a sample 'saltelli:N'."
        )
    return report + _said(lambda: _bars(of_surface(table, found)))


def _bars(found: Sensitivities) -> str:
    return html.picture(panels_figure([found]), f"Sobol indices of {found.name}") + html.verbatim(found.report())


def _budget(table: Table) -> list[str]:
    """Sizes of the sources of errors, if the sweep has them."""
    if not table.definition.get("error_budget"):
        return []
    rows = []
    for source, sizes in zip(table["error_source"], np.asarray(table["error_budget"], dtype=float).T, strict=True):
        found = sizes[np.isfinite(sizes)]
        told = (f"{np.median(found):.2g}", f"{found.max():.2g}") if len(found) else ("not found", "not found")
        rows.append((source, *told, len(found)))
    return [html.section("Error budget", html.table(("source", "median", "largest", "rows that have it"), rows))]


def _times(table: Table) -> list[str]:
    """Times of the runs, machines and versions."""
    parts = []
    rows = []
    for name, label in (("wall_seconds", "a run, with set-up"), ("set_up_seconds", "set-up")):
        seconds = table[name][np.isfinite(table[name])]
        if len(seconds):
            rows.append((label, *(f"{v:.3g} s" for v in (np.median(seconds), seconds.max(), seconds.sum()))))
    parts.append(html.table(("", "median", "largest", "sum"), rows))
    for name in ("host", "device", "versions"):
        counts = Counter(str(v) for v in table[name] if v)
        parts.append(html.paragraph(f"{name}: " + "; ".join(f"{v} ({n} rows)" for v, n in counts.most_common())))
    return parts


def call_of(table: Table) -> str:
    """The call of this sweep, as far as known: a scene and functions are shown by their names."""
    about = table.definition
    parameters, outputs = about["parameters"], about["outputs"]
    if GIVEN in parameters.values():
        given = [f'    wf.study.open_sweep("NAME.sweep").to_dataframe()[{list(parameters)!r}],']
    else:
        given = ["    {", *(f"        {name!r}: {str(text)!r}," for name, text in parameters.items()), "    },"]
    outputs = {**outputs, **({"error_budget": "error_budget"} if about.get("error_budget") else {})}
    named = {name: text.removesuffix("()") if text.endswith("()") else repr(text) for name, text in outputs.items()}
    options = ", ".join([f"wf.{about['call']}", *(f"{name}={text}" for name, text in about["options"].items())])
    sample = [f"    sample='{about['sample']}:{about['seed']}',"] if about["sample"] else []
    return "\n".join([
        f"# scene: {about['title']}", "wf.study.sweep(", "    scene,", *given, "    outputs={",
        *(f"        {name!r}: {text}," for name, text in named.items()), "    },", *sample,
        f"    run=functools.partial({options}),", '    store="AGAIN.sweep",', ")",
    ])  # fmt: skip
