"""Pictures of a study: error against wall time with the front marked, and error against step with observed orders.

Both have a panel for each measure, with logarithmic scales, and a curve for each group of runs that differ in the step
only. The difference of the reference from that with twice its step is a dashed line: errors near it are due to the
reference as much as to the run. matplotlib is imported when a picture is drawn.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from warpffrf.output.plots.panels import COLORS, COLUMNS, DPI, MARKS, PANEL_SIZE, REFERENCE_DASH
from warpffrf.study.speed_against_error.front import Order, front, grouped
from warpffrf.study.speed_against_error.runs import Row

MOST_NAMED = 24  # curves in the legend that differ in colour and marker
LEGEND_LINE = 0.19  # inches
TICKS = (1.0, 2.0, 5.0)  # in each decade of times
EXPECTED = 2.0  # order in the step of all integrators of simulate


def curves(rows: Sequence[Row]) -> dict[str, list[Row]]:
    """Timed rows that differ in the step only, coarse steps first, by the other choices."""
    return grouped([row for row in rows if row.timed])


def pareto_figure(rows: Sequence[Row], measures: Sequence[str], apart: Mapping[str, float], title: str) -> Any:
    """Errors [%] of all `rows` against the least wall time per simulated second; rows on the front are circled."""

    def draw(ax: Any, measure: str) -> None:
        for n, group in enumerate(curves(rows).values()):
            with_error = [row for row in group if measure in row.errors]
            _curve(ax, n, [row.fastest for row in with_error], [row.errors[measure] for row in with_error])
        best = front(rows, measure)
        ax.plot([r.fastest for r in best], [100.0 * r.errors[measure] for r in best], "o", ms=11.0, mfc="none",
                color="black", mew=0.9, ls=":", lw=0.8)  # fmt: skip
        ax.set(xlabel="wall time per simulated second [s/s]")

    offline = sorted({float(f"{row.offline:.3g}") for row in rows if np.isfinite(row.offline)})
    beside = f"; offline {' to '.join(f'{s:g}' for s in dict.fromkeys((offline[0], offline[-1])))} s" if offline else ""
    return _figure(rows, measures, apart, f"{title}: error against time (circles: front){beside}", draw)


def steps_figure(
    rows: Sequence[Row], measures: Sequence[str], apart: Mapping[str, float], found: Sequence[Order], title: str
) -> Any | None:
    """Errors [%] against the step [s], with the slope of order two. For measures with histories, titles show the range
    of the observed orders between the finest steps, by treatment of local modes. None if no group has two steps."""
    if all(len(group) < 2 for group in curves(rows).values()):
        return None

    def draw(ax: Any, measure: str) -> None:
        ends: list[tuple[float, float]] = []
        for n, group in enumerate(curves(rows).values()):
            with_error = [row for row in group if measure in row.errors]
            steps, errors = [row.setting["step"] for row in with_error], [row.errors[measure] for row in with_error]
            _curve(ax, n, steps, errors)
            ends += [(h, e) for h, e in zip(steps, errors, strict=True) if e > 0.0]
        if ends:
            coarse, fine = max(h for h, _ in ends), min(h for h, _ in ends)
            top = 100.0 * max(e for h, e in ends if h == coarse)
            ax.plot([fine, coarse], [top * (fine / coarse) ** EXPECTED, top], color="0.6", lw=0.9, ls="-.")
        shown = sorted({row.setting["step"] for row in rows if row.timed})
        ax.set_xticks(shown, [f"{step:g}" for step in shown])
        ax.set_xticks([], minor=True)
        ax.set(xlabel="step [s]")
        ax.set_title("\n".join([measure, *observed_orders(found, measure)]), fontsize=9)

    return _figure(rows, measures, apart, f"{title}: error against step (dash-dotted: order 2)", draw)


def observed_orders(found: Sequence[Order], measure: str) -> list[str]:
    """The orders between the finest steps of all groups, one text per treatment of local modes."""
    by_local: dict[str, list[float]] = {}
    for order in found:
        known = order.orders[np.isfinite(order.orders)]
        if order.measure == measure and len(known):
            by_local.setdefault(order.local, []).append(float(known[-1]))
    texts = {local: dict.fromkeys((f"{min(p):.2f}", f"{max(p):.2f}")) for local, p in by_local.items()}
    return [f"{local}: order {' to '.join(ends)}" for local, ends in texts.items()]


def _curve(ax: Any, n: int, x: Sequence[float], errors: Sequence[float]) -> None:
    color, mark = COLORS[n % len(COLORS)], MARKS[n // len(COLORS) % len(MARKS)]
    ax.plot(x, 100.0 * np.asarray(errors), marker=mark, ms=4.0, lw=0.9, color=color)


def _figure(
    rows: Sequence[Row],
    measures: Sequence[str],
    apart: Mapping[str, float],
    title: str,
    draw: Callable[[Any, str], None],
) -> Any:
    """A panel for each measure, and a legend of the groups below all."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.ticker import LogLocator, NullFormatter

    down = -(-len(measures) // COLUMNS)
    across = -(-len(measures) // down)
    labels = list(curves(rows))[:MOST_NAMED]
    size = (PANEL_SIZE[0] * across, PANEL_SIZE[1] * down + LEGEND_LINE * (len(labels) + 2))
    figure = Figure(figsize=size, dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    for n, measure in enumerate(measures):
        ax = figure.add_subplot(down, across, n + 1)
        ax.set_title(measure, fontsize=9)
        ax.set(xscale="log", yscale="log", ylabel="error [%]")
        ax.xaxis.set_major_locator(LogLocator(subs=TICKS))
        ax.xaxis.set_major_formatter("{x:g}")
        ax.xaxis.set_minor_formatter(NullFormatter())
        draw(ax, measure)
        if measure in apart:
            ax.axhline(100.0 * apart[measure], color="black", lw=0.9, ls=REFERENCE_DASH)
        ax.grid(which="both", alpha=0.25, lw=0.5)
        zero = sum(row.timed and row.errors.get(measure) == 0.0 for row in rows)
        if zero:
            ax.text(0.02, 0.02, f"{zero} with zero error, not shown", transform=ax.transAxes, fontsize=8)
    keys = [
        Line2D([], [], marker=MARKS[n // len(COLORS) % len(MARKS)], ms=4.0, lw=0.9, color=COLORS[n % len(COLORS)])
        for n in range(len(labels))
    ]
    keys.append(Line2D([], [], color="black", lw=0.9, ls=REFERENCE_DASH))
    figure.legend(
        keys, [*labels, "reference, from twice its step"], loc="outside lower left", fontsize=8, frameon=False
    )
    more = len(curves(rows)) - len(labels)
    figure.suptitle(title + (f"; {more} more curves are not named" if more else ""), fontsize=10)
    return figure
