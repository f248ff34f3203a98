"""A sweep as one self-contained HTML page: pictures are embedded, and nothing is loaded from elsewhere."""

from __future__ import annotations

import base64
import io
import os
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf import __version__
from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import checked_output_path, written_whole
from warpffrf.output.files.fields import COMPONENTS
from warpffrf.output.plots.panels import COLUMNS, panels_figure
from warpffrf.study.sweeps.design import GIVEN
from warpffrf.study.sweeps.reading.plot import MOST_PANELS, Axis, axes_of, axis_of, plot
from warpffrf.study.sweeps.reading.sensitivities import Sensitivities, of_rows, of_surface, sensitivities
from warpffrf.study.sweeps.reading.surface import surface
from warpffrf.study.sweeps.reading.values import COMPLETED, TIME, WAITING, Table, shown_in

ENDINGS = (".html", ".htm")
DPI = 90
MOST_FAILED = 100  # rows in the table of failed ones
FAITHFUL = 0.5  # error of a response surface over the standard deviation, above which its sensitivities are not shown
STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; color: #222; max-width: 1180px; margin: 2em auto; padding: 0 1em; }
h1 { font-size: 1.6em; } h2 { font-size: 1.2em; margin-top: 2em; border-bottom: 1px solid #ddd; }
table { border-collapse: collapse; margin: 0.6em 0; } caption { text-align: left; color: #666; padding-bottom: 0.2em; }
th, td { text-align: left; vertical-align: top; padding: 0.15em 0.9em 0.15em 0; border-bottom: 1px solid #eee; }
img { max-width: 100%; display: block; margin: 0.8em 0; } .bad { color: #b3262f; }
pre { background: #f5f6f8; padding: 0.8em; overflow-x: auto; font-size: 13px; }
"""


def write_page(table: Table, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
    """Write the page of a sweep, see `Sweep.page`; returns its path."""
    target = checked_output_path(path, "sweep: page", overwrite=overwrite)
    if target.suffix.lower() not in ENDINGS:
        raise InputError(f"sweep: page: '{target.name}' must end in {' or '.join(ENDINGS)}")
    text = page(table)
    with written_whole(target) as partial:
        partial.write_text(text, encoding="utf-8")
    return target


def page(table: Table) -> str:
    """The page as text."""
    about = table.definition
    title = f"Sweep: {about['title']}"
    parts = [
        f"<h1>{escape(title)}</h1>",
        _summary(table),
        _section("What was swept", _parameters(table), _outputs(table)),
        *_failed(table),
        *(_section(f"Output: {name}", *_output(table, name)) for name in table.output_names),
        *_budget(table),
        _section("Times, machines and versions", *_times(table)),
        _section("How to run it again", f"<pre>{escape(call_of(table))}</pre>"),
    ]
    head = (
        f'<meta charset="utf-8"><meta name="generator" content="warpffrf {escape(__version__)}">'
        f"<title>{escape(title)}</title><style>{STYLE}</style>"
    )
    return f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head>\n<body>\n' + "\n".join(parts) + "\n</body></html>\n"


# --- parts


def _section(title: str, *parts: str) -> str:
    return f"<h2>{escape(title)}</h2>\n" + "\n".join(parts)


def _paragraph(text: str, bad: bool = False) -> str:
    return f"<p{' class=bad' if bad else ''}>{escape(text)}</p>"


def _rows(head: Sequence[str], rows: Iterable[Sequence[Any]], caption: str = "") -> str:
    """A table; every entry is escaped."""
    cells = "".join(f"<th>{escape(name)}</th>" for name in head)
    body = "".join("<tr>" + "".join(f"<td>{escape(str(v))}</td>" for v in row) + "</tr>\n" for row in rows)
    said = f"<caption>{escape(caption)}</caption>" if caption else ""
    return f"<table>{said}<tr>{cells}</tr>\n{body}</table>"


def _picture(figure: Any, alt: str) -> str:
    """A figure embedded in the page."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=DPI, metadata={"Software": "warpffrf"})
    data = base64.b64encode(stream.getvalue()).decode("ascii")
    return f'<img alt="{escape(alt, quote=True)}" src="data:image/png;base64,{data}">'


def _summary(table: Table) -> str:
    about, status = table.definition, table["status"]
    counts = Counter(map(str, status))
    said = ", ".join(f"{n} {name or 'not run yet'}" for name, n in counts.most_common())
    how = f", sample {about['sample']}, seed {about['seed']}" if about["sample"] else ""
    whole = set(counts) == {COMPLETED}
    return _paragraph(f"{len(status)} rows of {about['call']}{how}: {said}.", bad=not whole)


def _parameters(table: Table) -> str:
    rows = []
    for name in table.parameter_names:
        axis = axis_of(table, name)
        at = axis.distinct
        span = ", ".join(axis.words) if axis.words is not None else f"{axis.text(at[0])} to {axis.text(at[-1])}"
        rows.append((name, table.definition["parameters"][name], span, len(at)))
    return _rows(("parameter", "given as", "values", "how many"), rows)


def _outputs(table: Table) -> str:
    rows = []
    for name in table.output_names:
        numbers = np.asarray(table[name], dtype=float)
        dims, unit = table.about(name)
        factor, shown = shown_in(unit, numbers)
        finite = numbers[np.isfinite(numbers)] * factor
        span = f"{finite.min():.5g} to {finite.max():.5g}" if len(finite) else "no value"
        rows.append((name, table.definition["outputs"][name], span, shown, ", ".join(dims) or "one number"))
    return _rows(("output", "is", "values", "unit", "in a row"), rows)


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
    return [_section("Rows that failed", _rows(head, rows, caption))]


def _output(table: Table, name: str) -> list[str]:
    """Pictures of an output, its response surface, and its sensitivities; or the reasons why they are missing."""
    numbers = table[name]
    dims, _ = table.about(name)
    others = [dim for dim in dims if dim != TIME]
    if others and (len(others) > 1 or others[-1] not in COMPONENTS):
        shape = " x ".join(map(str, numbers.shape[1:]))
        return [_paragraph(f"{shape} numbers in a row along {', '.join(dims)}: read them as sweep[{name!r}].")]
    if others:
        return [
            _said(lambda c=c: _picture(plot(table, name, component=c), f"{name}, {c}")) for c in COMPONENTS[others[-1]]
        ]
    axes = axes_of(table, np.ones(len(table["status"]), dtype=bool))
    if TIME in dims:
        colors = [axis.name for axis in axes] or [None]
        return [_said(lambda by=by: _picture(plot(table, name, hue=by), f"{name} over time, by {by}")) for by in colors]
    parts = [
        _said(lambda axis=axis: _picture(plot(table, name, x=axis.name), f"{name} over {axis.name}")) for axis in axes
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
        return _paragraph(str(error))


def _map(table: Table, name: str, axes: Sequence[Axis]) -> str:
    """Map over the first two parameters, with a panel for each value of the third if there are few."""
    x, y, *others = axes
    col = others[0].name if others and len(others[0].distinct) <= min(MOST_PANELS, 2 * COLUMNS) else None
    return _picture(plot(table, name, x=x.name, y=y.name, col=col), f"map of {name} over {x.name} and {y.name}")


def _surface(table: Table, name: str) -> str:
    """The response surface, and sensitivities: from rows of a suitable sample, else from that surface."""
    found = surface(table, name)
    report = f"<pre>{escape(found.report())}</pre>"
    if of_rows(table):
        return report + _said(lambda: _bars(sensitivities(table, name)))
    if not found.relative_error <= FAITHFUL:
        return report + _paragraph(
            "No sensitivities: the response surface is off by more than half of the standard deviation, or by how much "
            "is not known; sweep more rows, or a sample 'saltelli:N'."
        )
    return report + _said(lambda: _bars(of_surface(table, found)))


def _bars(found: Sensitivities) -> str:
    return _picture(panels_figure([found]), f"Sobol indices of {found.name}") + f"<pre>{escape(found.report())}</pre>"


def _budget(table: Table) -> list[str]:
    """Sizes of the sources of errors, if the sweep has them."""
    if not table.definition.get("error_budget"):
        return []
    rows = []
    for source, sizes in zip(table["error_source"], np.asarray(table["error_budget"], dtype=float).T, strict=True):
        found = sizes[np.isfinite(sizes)]
        told = (f"{np.median(found):.2g}", f"{found.max():.2g}") if len(found) else ("not found", "not found")
        rows.append((source, *told, len(found)))
    return [_section("Error budget", _rows(("source", "median", "largest", "rows that have it"), rows))]


def _times(table: Table) -> list[str]:
    """Times of the runs, machines and versions."""
    parts = []
    rows = []
    for name, label in (("wall_seconds", "a run, with set-up"), ("set_up_seconds", "set-up")):
        seconds = table[name][np.isfinite(table[name])]
        if len(seconds):
            rows.append((label, *(f"{v:.3g} s" for v in (np.median(seconds), seconds.max(), seconds.sum()))))
    parts.append(_rows(("", "median", "largest", "sum"), rows))
    for name in ("host", "device", "versions"):
        counts = Counter(str(v) for v in table[name] if v)
        parts.append(_paragraph(f"{name}: " + "; ".join(f"{v} ({n} rows)" for v, n in counts.most_common())))
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
