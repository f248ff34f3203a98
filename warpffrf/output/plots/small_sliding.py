"""Plots of small-sliding contacts: maps of pressure, state and loss over unrolled cells; histories; a page of maps at
selected times."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.output.contact.friction import STATES
from warpffrf.output.loops import value_at
from warpffrf.output.plots.colors import PRESSURE_STOPS, STATE_COLORS, WEAR_STOPS, from_zero, instant, largest, side_bar
from warpffrf.output.small_sliding import SmallSlidingResult, cell_chart

ROOM = 0.03  # margin of a map, of its extent
PAGE_TIMES = 3  # rows of maps on a page by default
PAGE_WIDTH, PAGE_HEIGHTS = 5.0, (1.9, 5.0)  # inches per map
TITLES, DRAWN = 1.1, 0.7  # inches above and below a map, and fraction of its width for the cells
FORCE, AREA = "#1b6ca8", "#d1495b"
APART = 1.3  # of the largest area: a constant force and a constant area are not drawn at the same height


def pressure(contact: SmallSlidingResult, ax: Any, row: int) -> None:
    """Pressure of the cells, with one colour range for the run."""
    colors = _map(contact, ax, contact.pressure[row] * 1e-6, PRESSURE_STOPS, largest([contact.peak_pressure]) * 1e-6)
    side_bar(ax, colors, label="pressure [MPa]")
    ax.set_title(f"Contact '{contact.name}': pressure, {_at(contact, row)}", fontsize=10)


def state(contact: SmallSlidingResult, ax: Any, row: int) -> None:
    """State of the cells: open, stick and slip."""
    from matplotlib.colors import BoundaryNorm, ListedColormap

    cells = _map(contact, ax, contact.state[row], STATE_COLORS, 1.0)
    cells.set(cmap=ListedColormap(STATE_COLORS), norm=BoundaryNorm(np.arange(len(STATES) + 1) - 0.5, len(STATES)))
    names = [f"{name}: {count}" for name, count in zip(STATES, contact.counts[row], strict=True)]
    bar = side_bar(ax, cells, ticks=np.arange(len(STATES)), format=lambda state, _: names[int(state)])
    bar.minorticks_off()  # at the boundaries of states
    ax.set_title(f"Contact '{contact.name}': open, stick, slip, {_at(contact, row)}", fontsize=10)


def loss(contact: SmallSlidingResult, ax: Any, row: int) -> None:
    """Friction energy per area, with one colour range for the run."""
    top = largest([contact.loss_density])
    colors = _map(contact, ax, contact.loss_density[row], WEAR_STOPS, top)
    side_bar(ax, colors, label="accumulated loss [J/m²]")
    ax.set_title(f"Contact '{contact.name}': loss {contact.loss[row]:.4g} J so far, {_at(contact, row)}", fontsize=10)


def history(contact: SmallSlidingResult, ax: Any, row: int) -> None:
    """Normal force, and slipping area below that under pressure, against time; a line where they slide as a whole."""
    time, loaded = contact.time * 1e3, (contact.stick_area + contact.slip_area) * 1e6
    ax.plot(time, contact.normal_force * 1e-3, color=FORCE)
    area = ax.twinx()
    area.plot(time, loaded, color=AREA, ls=":", lw=1.0)
    area.plot(time, contact.slip_area * 1e6, color=AREA)
    if np.isfinite(begin := contact.gross_slip_time):
        area.axvline(begin * 1e3, color=AREA, lw=0.8, ls="--")
        area.annotate(
            " slides as a whole", (begin * 1e3, 0.5), xycoords=("data", "axes fraction"), color=AREA, fontsize=8
        )
    ax.set(xlabel="time [ms]")
    ax.set_ylabel("normal force [kN]", color=FORCE)
    area.set_ylabel("slipping area [mm²]", color=AREA)
    from_zero(ax, contact.normal_force * 1e-3)
    from_zero(area, contact.slip_area * 1e6, APART * loaded)
    ax.set_title(f"Contact '{contact.name}': normal force, slipping area (dotted: loaded area)", fontsize=10)


def small_sliding_figure(result: Any, name: str | None, times: Sequence[float] | np.ndarray | None) -> Any:
    """A matplotlib Figure: pressure, state and loss of a small-sliding contact, the first one if None, in the saved
    steps nearest to `times` [s], one row each; `PAGE_TIMES` of the run if None. Raises `InputError` for a run without
    small-sliding contacts, an unknown name, and times outside of the run."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    contact = the_small_sliding(result, name)
    label = f"contact '{contact.name}'"
    if times is None:
        rows = np.unique(np.linspace(0, len(contact.time) - 1, PAGE_TIMES + 1).round().astype(int))[-PAGE_TIMES:]
    else:
        at = np.atleast_1d(np.asarray(times, dtype=float))
        found = value_at(contact.time, np.arange(len(contact.time), dtype=float), at, label)
        rows = np.unique(found.round().astype(int))
    wide, high = np.ptp(cell_chart(contact.view).triangles.reshape(-1, 2), axis=0)
    height = float(np.clip(TITLES + DRAWN * PAGE_WIDTH * high / wide, *PAGE_HEIGHTS))
    figure = Figure(figsize=(PAGE_WIDTH * 3, height * len(rows) + 0.3), layout="constrained")
    FigureCanvasAgg(figure)
    for line, row in enumerate(rows):
        for n, draw in enumerate((pressure, state, loss)):
            draw(contact, figure.add_subplot(len(rows), 3, 3 * line + n + 1), int(row))
    figure.suptitle(f"{label}: {contact.cells} cells, loss {contact.loss[-1]:.4g} J in the run", fontsize=11)
    return figure


def the_small_sliding(result: Any, name: str | None = None) -> SmallSlidingResult:
    """The contact with small sliding of a plot, the first one if None. Raises `InputError` if there is none."""
    known = result.small_sliding_names
    if not known:
        raise InputError(
            "plot: the scene has no contact with small sliding; give it one with scene.add(Contact(..., "
            "sliding='small')), and run again"
        )
    if name is not None and name not in known:
        raise unknown_name("plot: contact with small sliding", name, known)
    if not len(result.time):
        raise InputError("plot: the run has no saved row")
    return result.contact(known[0] if name is None else name)


def _at(contact: SmallSlidingResult, row: int) -> str:
    return f"t = {instant(contact.time[row])}"


def _map(contact: SmallSlidingResult, ax: Any, values: np.ndarray, stops: tuple[str, ...], top: float) -> Any:
    """`values` (c,) from 0 to `top` on the unrolled cells; returns the coloured polygons."""
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import LinearSegmentedColormap

    chart = cell_chart(contact.view)
    corners = chart.triangles * 1e3
    polygons = PolyCollection(
        list(corners), array=np.asarray(values, dtype=float)[chart.cell],
        cmap=LinearSegmentedColormap.from_list("cells", stops), linewidths=0.0, antialiaseds=False, rasterized=True,
    )  # fmt: skip
    polygons.set_clim(0.0, top if top > 0.0 else 1.0)
    ax.add_collection(polygons)
    low, high = corners.reshape(-1, 2).min(axis=0), corners.reshape(-1, 2).max(axis=0)
    room = ROOM * (high - low).max()
    ax.set(xlim=(low[0] - room, high[0] + room), ylim=(low[1] - room, high[1] + room), aspect="equal")
    ax.set(xlabel=f"{chart.labels[0]} [mm]", ylabel=f"{chart.labels[1]} [mm]")
    return polygons


SMALL_SLIDING_PLOTS: dict[str, Callable[[SmallSlidingResult, Any, int], None]] = {
    "patch": pressure,
    "stick_slip": state,
    "friction_loss": loss,
    "slip_area": history,
}
