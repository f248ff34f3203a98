"""Plots of oil films: unwrapped maps of pressure, gap and temperature, the orbit in the clearance circle, and the
smallest film."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.output.contact.result import FilmResult
from warpffrf.output.plots.colors import LEAST, from_zero, instant, largest, side_bar
from warpffrf.output.plots.restyle import BELOW

FULL = 1.0 - 1e-3  # film fraction below which the gap is cavitated
GAP, PEAK, CIRCLE = "#1b6ca8", "#d1495b", "0.55"
CIRCLE_POINTS = 181
ROOM = 1.12  # of the clearance, to either side of the circle


def has_orbit(film: FilmResult) -> bool:
    """True if there is a clearance circle: two surfaces of revolution that are not cones."""
    return film.clearance is not None and bool(np.any(np.isfinite(film.eccentricity)))


def film_kinds(film: FilmResult) -> list[str]:
    """The kinds of plots for which a film has data."""
    lacking = {"film_orbit": not has_orbit(film), "film_temperature": film.temperature is None}
    return [kind for kind in FILM_PLOTS if not lacking.get(kind, False)]


def pressure(film: FilmResult, ax: Any, row: int) -> None:
    """Pressure on the unwrapped first surface, with the cavity boundaries dashed."""
    _map(film, ax, row, film.pressure[row] * 1e-6, ("pressure [MPa]", "magma_r"), from_zero=True)
    ax.set_title(f"Film '{film.name}': pressure, {_at(film, row)}", fontsize=10)


def gap(film: FilmResult, ax: Any, row: int) -> None:
    """Gap on the unwrapped first surface, with the cavity boundaries dashed."""
    _map(film, ax, row, film.gap[row] * 1e6, ("gap [µm]", "viridis"), from_zero=False)
    ax.set_title(f"Film '{film.name}': gap, {_at(film, row)}", fontsize=10)


def orbit(film: FilmResult, ax: Any, row: int) -> None:
    """Path of the eccentricity over the clearance in the clearance circle, along e_0 and e_1 of the first surface, with
    its start and the position in the saved step `row`."""
    if not has_orbit(film):
        raise InputError(
            f"plot: film '{film.name}' has no clearance circle, which takes two surfaces of revolution that are no "
            "cones; draw 'film_gap' or 'film_thickness'"
        )
    x, y = (film.eccentricity / film.clearance).T
    angle = np.linspace(0.0, 2.0 * np.pi, CIRCLE_POINTS)
    ax.plot(np.cos(angle), np.sin(angle), color=CIRCLE, lw=1.0, label="clearance circle")
    ax.plot(x, y, color=GAP, lw=1.2)
    ax.plot(x[:1], y[:1], "o", ms=5.0, mfc="white", color=GAP, ls="none", label="begin")
    ax.plot(x[[row]], y[[row]], "o", ms=5.0, color=PEAK, ls="none", label=_at(film, row))
    for line in (ax.axhline, ax.axvline):
        line(0.0, color="0.85", lw=0.6, zorder=0)
    reach = ROOM * max(1.0, largest([np.abs(film.eccentricity)]) / float(film.clearance or 1.0))
    ax.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    ax.set(xlabel="along e_0, over the clearance [-]", ylabel="along e_1, over the clearance [-]")
    ax.set_title(f"Film '{film.name}': inner axis against the outer one", fontsize=10)
    ax.legend(frameon=False, fontsize=8, ncols=3, loc="upper center", bbox_to_anchor=(0.5, BELOW))


def temperature(film: FilmResult, ax: Any, row: int) -> None:
    """Temperature of the oil, its mean across the gap, on the unwrapped first surface, with the cavity boundaries
    dashed."""
    if film.temperature is None:
        raise InputError(
            f"plot: film '{film.name}' is isothermal; give it films.FilmTemperature(...), or draw 'film_pressure'"
        )
    _map(film, ax, row, film.temperature[row], ("temperature [°C]", "inferno"), from_zero=False)
    ax.set_title(f"Film '{film.name}': temperature, {_at(film, row)}", fontsize=10)


def thickness(film: FilmResult, ax: Any, row: int) -> None:
    """Smallest film and largest pressure against time."""
    time = film.time * 1e3
    ax.plot(time, film.smallest_gap * 1e6, color=GAP)
    peak = ax.twinx()
    peak.plot(time, film.largest_pressure * 1e-6, color=PEAK)
    ax.set(xlabel="time [ms]")
    ax.set_ylabel("smallest film [µm]", color=GAP)
    peak.set_ylabel("largest pressure [MPa]", color=PEAK)
    from_zero(ax, film.smallest_gap * 1e6)
    from_zero(peak, film.largest_pressure * 1e-6)
    ax.set_title(f"Film '{film.name}': smallest film, largest pressure", fontsize=10)


def _at(film: FilmResult, row: int) -> str:
    return f"t = {instant(film.time[row])}"


def _map(film: FilmResult, ax: Any, row: int, values: np.ndarray, look: tuple[str, str], *, from_zero: bool) -> None:
    """`values` (columns, rows) over the chart of the first surface; a full revolution from 0 to 360 degrees."""
    x, order = _around(film, row)
    label, colors = look
    low = min(0.0, float(np.nanmin(values))) if from_zero else None
    image = ax.pcolormesh(x, film.z * 1e3, values[order].T, shading="gouraud", cmap=colors, vmin=low)
    low, high = image.get_clim()
    if high - low < (least := LEAST * float(np.nanmax(np.abs(values)))):  # uniform up to round-off
        image.set_clim(0.5 * (low + high - least), 0.5 * (low + high + least))
    side_bar(ax, image, label=label)
    fill = film.fill[row][order]
    if np.min(fill) < FULL < np.max(fill):
        ax.contour(x, film.z * 1e3, fill.T, levels=[FULL], colors="0.35", linestyles="dashed", linewidths=0.8)
    planar = film.view.first.shape.profile().planar
    ax.set(xlabel="along e_1 [mm]" if planar else "angle from e_0 [degrees]", ylabel="along the axis [mm]")


def _around(film: FilmResult, row: int) -> tuple[np.ndarray, np.ndarray]:
    """Positions of columns along the map, ascending, in degrees (plane: mm), and the column indices there; a full
    revolution is closed by its first column, and cut where the pressure of saved step `row` is far from its peak."""
    surface = film.view.first
    columns = np.arange(len(film.theta))
    if surface.shape.profile().planar:
        return film.theta * 1e3, columns
    if not surface.grid.periodic:
        return np.degrees(film.theta), columns
    turned = np.degrees(film.theta) % 360.0
    if np.cos(np.radians(turned[np.nanargmax(np.nanmax(film.pressure[row], axis=1))])) > 0.0:
        turned -= 360.0 * (turned >= 180.0)
    order = np.argsort(turned)
    return np.append(turned[order], turned[order[0]] + 360.0), np.append(order, order[0])


FILM_PLOTS: dict[str, Callable[[FilmResult, Any, int], None]] = {
    "film_pressure": pressure,
    "film_gap": gap,
    "film_orbit": orbit,
    "film_thickness": thickness,
    "film_temperature": temperature,
}
