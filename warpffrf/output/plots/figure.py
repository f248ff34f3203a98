"""Plots of a result and the summary figure; matplotlib is imported when a plot is drawn."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, nearest, unknown_name
from warpffrf.output.contact.cell_result import CellContactResult
from warpffrf.output.contact.hertz import HertzLine, HertzPoint, hertz
from warpffrf.output.plots.bearing import BEARING_PLOTS, POLAR, the_bearing
from warpffrf.output.plots.colors import FINEST, LEAST, about_zero, from_zero, instant, largest, no_finer, side_bar
from warpffrf.output.plots.films import FILM_PLOTS, film_kinds
from warpffrf.output.plots.friction import FRICTION_PLOTS, draw_depth, has_material, rubbing
from warpffrf.output.plots.gears import GEAR_PLOTS, gear_kinds, the_gear
from warpffrf.output.plots.panels import HISTORY_PLOTS, STYLES, draw_bars, draw_numbers, numbers_of, page, the_channel
from warpffrf.output.plots.picture import write_drawing, write_picture
from warpffrf.output.plots.restyle import THEMES, columns_in, require_theme, restyle
from warpffrf.output.plots.small_sliding import SMALL_SLIDING_PLOTS, the_small_sliding

RIPPLE = 1e-3  # %: smaller deviations are round-off or iteration tolerance
FINE = 400  # points of a smooth curve
SHOWN_WIDTHS = 2.5  # half-widths to either side of the line of centres in patch plots
MOST_INSIDE = 8  # curves named in a legend inside the axes; with more the legend is at the right
COLORS = 10  # of lines, before another line style
LEGEND_ROWS = 16  # rows of a legend at the right
PAGE_COLUMNS = 6  # columns of a legend below a page
PAGE_PANELS, PAGE_PANEL = 3, (5.2, 4.1)  # most side by side, and inches
SECTIONS = {"point": "Across the patch through its centre"}  # other kinds: at mid-width
PROFILE, REFERENCE, FORCE = "#1b6ca8", "#d1495b", "#2a9d6f"


class OfPair:
    """A result restricted to the contact `name`."""

    def __init__(self, result: Any, name: str) -> None:
        result.contact(name)  # raises for an unknown name
        self._result, self.contact_names = result, [name]
        self.finite_sliding_names = [one for one in result.finite_sliding_names if one == name]
        self.small_sliding_names = [one for one in result.small_sliding_names if one == name]

    def __getattr__(self, name: str) -> Any:
        return getattr(self._result, name)


def _contact(result: Any) -> Any:
    if not result.finite_sliding_names:
        raise InputError(
            f"plot: the scene has no contact with finite sliding, or another one is named; 'energy' can be drawn, of "
            f"contacts with small sliding {', '.join(map(repr, SMALL_SLIDING_PLOTS))}, and plots of films if it has "
            "some"
        )
    return result.contact(result.finite_sliding_names[0])


def _last_touching(contact: Any) -> int:
    """The last saved row in which the surfaces touch; the last row if they never do."""
    touching = np.flatnonzero(contact.touching)
    return int(touching[-1]) if len(touching) else len(contact.touching) - 1


def hertz_of(contact: Any, i: int) -> HertzLine | HertzPoint | None:
    """Hertz solution in saved step `i`, None if it does not apply or nothing touches."""
    try:
        return hertz(contact, i)
    except InputError:
        return None


def _at(result: Any, i: int) -> str:
    return f"t = {instant(result.time[i])}"


def _marker(rows: np.ndarray) -> str:
    """Marker of a curve with one row."""
    return "o" if len(rows) == 1 else ""


def _legend(ax: Any, curves: int) -> None:
    """Add a legend of several curves: inside the axes if there is room, else to their right."""
    if curves > MOST_INSIDE:
        columns = -(-curves // LEGEND_ROWS)
        ax.legend(
            frameon=False, fontsize=6, ncols=columns, loc="upper left", bbox_to_anchor=(1.0, 1.0), borderaxespad=0
        )
    elif curves > 1:
        ax.legend(frameon=False)


def _crowd_below(figure: Any) -> None:
    """Move legends at the right of their axes below the page, where they take no width from the panels."""
    for ax in figure.axes:
        legend = ax.get_legend()
        if legend is not None and len(legend.get_texts()) > MOST_INSIDE:
            handles, labels = ax.get_legend_handles_labels()
            legend.remove()
            place = {"loc": "outside lower center", "ncols": PAGE_COLUMNS, "fontsize": 7, "frameon": False}
            figure.legend(handles, labels, title=ax.get_title(), title_fontsize=8, **place)


def force(result: Any, ax: Any) -> None:
    """Force of every contact, lumped contact and oil film against time; bars for a run of one
    row."""
    forces = {name: result.contact(name).force_magnitude for name in result.contact_names}
    forces |= {name: np.linalg.norm(c.force, axis=1) for name, c in result.history.lumped_contacts.items()}
    pressed = bool(forces)
    forces |= {name: result.film(name).force_magnitude for name in result.film_names if name not in forces}
    what = " and ".join(["contact"] * pressed + ["film"] * bool(result.film_names))
    ax.set_title(f"{what.capitalize()} force", fontsize=10)
    _curves(result, ax, {name: size * 1e-3 for name, size in forces.items()}, f"{what} force [kN]")


def _curves(result: Any, ax: Any, curves: dict[str, np.ndarray], label: str) -> None:
    """Sizes (T,) by name against time, from zero; bars for a run of one row."""
    if len(result.time) == 1:
        draw_bars(ax, curves, label)
        return
    _lines(result, ax, curves, label)
    from_zero(ax, np.concatenate(list(curves.values())))


def _lines(result: Any, ax: Any, curves: dict[str, np.ndarray], label: str) -> None:
    for n, (name, values) in enumerate(curves.items()):
        ax.plot(result.time * 1e3, values, STYLES[n // COLORS % len(STYLES)], label=name)
    ax.set(xlabel="time [ms]", ylabel=label)
    _legend(ax, len(curves))


def _reactions(result: Any) -> dict[str, np.ndarray]:
    """(T,) N, force of each joint that is no part of a bearing and carries one."""
    inside = tuple(f"{name} " for name in result.bearing_names)
    forces = {
        name: np.linalg.norm(joint.force, axis=1)
        for name, joint in result.history.joints.items()
        if not name.startswith(inside or ("\0",))
    }
    least = LEAST * largest(list(forces.values()))
    return {name: force for name, force in forces.items() if largest([force]) > least}


def joints(result: Any, ax: Any) -> None:
    """Reaction force of every joint against time; bars for a run of one row."""
    forces = _reactions(result)
    if not forces:
        raise InputError("plot: no joint of the run carries a force")
    _curves(result, ax, {name: force * 1e-3 for name, force in forces.items()}, "joint force [kN]")
    ax.set_title("Joint forces", fontsize=10)


def sensors(result: Any, ax: Any, channel: str | None = None) -> None:
    """Sensors against time, all that have the unit of the sensor `channel`, or of the first one."""
    known = result.history.sensors
    if not known:
        raise InputError("plot: the scene has no sensor; give it one with scene.add(sensors.Position(...)), run again")
    if channel is not None and channel not in known:
        raise unknown_name("plot: sensor", channel, tuple(known))
    unit = known[channel or next(iter(known))].unit
    alike = {name: sensor for name, sensor in known.items() if sensor.unit == unit}
    curves = {
        f"{name} {part}".strip(): values
        for name, sensor in alike.items()
        for part, values in zip(sensor.components, sensor.values.T, strict=True)
    }
    _lines(result, ax, curves, f"sensors [{unit}]")
    no_finer(ax, FINEST * largest([np.abs(values) for values in curves.values()]))
    ax.set_title("Sensors", fontsize=10)


def _profile(ax: Any, contact: Any, x: np.ndarray, p: np.ndarray, lines: np.ndarray) -> None:
    """Pressures p (n,) at x (n,) along a section: linear between nodes, or constant on cells between `lines` (n +
    1,)."""
    if isinstance(contact, CellContactResult):
        ax.stairs(p, lines, lw=1.0, color=PROFILE, label="computed, on the cells")
        ax.plot(x, p, "o", ms=3.0, color=PROFILE)
    else:
        ax.plot(x, p, "o-", ms=3.5, lw=1.0, color=PROFILE, label="computed, at the nodes")


def across(result: Any, ax: Any) -> None:
    """Pressure across the patch at mid-width (point contact: through its centre), with the Hertz solution at the same
    load."""
    contact = _contact(result)
    i = _last_touching(contact)
    p = contact.mid_pressure[i] * 1e-6
    _profile(ax, contact, contact.arc[i] * 1e3, p, contact.cell_lines(i)[0] * 1e3)
    title = f"{SECTIONS.get(contact.patch_kind, 'Across the patch at mid-width')}, {_at(result, i)}"
    line = hertz_of(contact, i)
    if line is not None:
        fine = contact.center[i] + line.half_width * np.linspace(-1.0, 1.0, FINE)
        label = (
            f"Hertz at {line.load:.4g} N"
            if isinstance(line, HertzPoint)
            else f"Hertz at {line.line_load * 1e-3:.4g} N/mm"
        )
        ax.plot(fine * 1e3, contact.hertz_pressure(i, fine) * 1e-6, color=REFERENCE, label=label)
        ax.set_xlim(*((contact.center[i] + line.half_width * SHOWN_WIDTHS * np.array([-1.0, 1.0])) * 1e3))
        ratio = contact.half_width[i] / line.half_width - 1.0, contact.mid_peak_pressure[i] / line.peak_pressure - 1.0
        title += f"\nagainst Hertz: half-width {ratio[0]:+.2%}, peak {ratio[1]:+.2%}"
    ax.set(xlabel="arc from the line of centres [mm]", ylabel="pressure [MPa]")
    ax.set_title(title, fontsize=10)
    from_zero(ax, p, [line.peak_pressure * 1e-6] if line else [])
    ax.legend(frameon=False, fontsize=8, loc="upper right")


def along(result: Any, ax: Any) -> None:
    """Pressure along the axis, in the column with the largest pressure of `across`, with the Hertz solution of a point
    contact."""
    contact = _contact(result)
    i = _last_touching(contact)
    patch = contact.pressure(i)
    column = int(np.argmax(contact.mid_pressure[i]))
    _profile(ax, contact, patch.z * 1e3, patch.pressure[column] * 1e-6, contact.cell_lines(i)[1] * 1e3)
    found = hertz_of(contact, i)
    if isinstance(found, HertzPoint):
        width, middle = found.half_width_along, contact.center_of_pressure[i, 1]
        z = middle + found.section_along * np.linspace(-1.0, 1.0, FINE)
        p = found.peak_pressure * np.sqrt(np.maximum(0.0, 1.0 - ((z - middle) / found.section_along) ** 2))
        ax.plot(z * 1e3, p * 1e-6, color=REFERENCE, label="Hertz")
        ax.set_xlim(*((middle + width * SHOWN_WIDTHS * np.array([-1.0, 1.0])) * 1e3))
        ax.legend(frameon=False, fontsize=8, loc="upper right")
    ax.set(xlabel="position along the axis [mm]", ylabel="pressure [MPa]")
    ax.set_title(f"Along the axis at {patch.arc[column] * 1e3:+.3f} mm of arc", fontsize=10)
    from_zero(ax, patch.pressure[column] * 1e-6)


def patch(result: Any, ax: Any) -> None:
    """Pressure on the unwrapped patch, bilinear between nodes or constant on cells that move with it."""
    contact = _contact(result)
    i = _last_touching(contact)
    field = contact.pressure(i)
    on_cells = isinstance(contact, CellContactResult)
    arc, z = contact.cell_lines(i) if on_cells else (field.arc, field.z)
    shading = "flat" if on_cells else "gouraud"
    image = ax.pcolormesh(arc * 1e3, z * 1e3, field.pressure.T * 1e-6, shading=shading, cmap="magma_r", vmin=0.0)
    side_bar(ax, image, label="pressure [MPa]")
    reach = contact.half_width[i] * SHOWN_WIDTHS * 1e3
    if reach > 0.0:
        middle = contact.center[i] * 1e3
        ax.set_xlim(max(middle - reach, arc[0] * 1e3), min(middle + reach, arc[-1] * 1e3))
    if contact.patch_kind == "point" and reach > 0.0:
        reach, middle = contact.half_widths[i, 1] * SHOWN_WIDTHS * 1e3, contact.center_of_pressure[i, 1] * 1e3
        ax.set_ylim(max(middle - reach, z[0] * 1e3), min(middle + reach, z[-1] * 1e3))
    ax.set(xlabel="arc from the line of centres [mm]", ylabel="along the axis [mm]")
    ax.set_title(f"Patch, unwrapped, {_at(result, i)}", fontsize=10)


def stress_depth(result: Any, ax: Any) -> None:
    """Von Mises and largest shear stress against depth below the centre of the patch, due to the pressure alone, with
    the depths of the Hertz maxima; b is the half-width of a line or the smaller semi-axis."""
    contact = _contact(result)
    i = _last_touching(contact)
    draw_depth(contact, ax, i, _at(result, i))


def energy(result: Any, ax: Any) -> None:
    """Energy residual and grid defect over the largest energy of the run."""
    scale = result.energy_scale
    ax.plot(result.time * 1e3, result.energy_residual, color=PROFILE, label="energy residual (numerical)", zorder=3)
    defect = result.energy.get("contact_grid")
    if defect is not None and np.max(np.abs(defect), initial=0.0) > LEAST * scale > 0.0:
        ax.plot(
            result.time * 1e3, np.asarray(defect) / scale, color=REFERENCE, lw=1.0, label="grid defect of the contact"
        )
    ax.axhline(0.0, color="0.7", lw=0.6)
    about_zero(ax, LEAST)
    ax.ticklabel_format(axis="y", scilimits=(-2, 3))
    ax.set(xlabel="time [ms]", ylabel="over the energy scale [-]")
    ax.set_title(f"Energy residual; energy scale {scale:.3g} J", fontsize=10)
    ax.legend(frameon=False, fontsize=8)


def widths(result: Any, ax: Any) -> None:
    """Half-width and peak pressure against time, with the Hertz solution at the load of each row."""
    contact = _contact(result)
    rows = np.flatnonzero(contact.touching)
    time, mark = result.time[rows] * 1e3, "-" + _marker(rows)
    ax.plot(time, contact.half_width[rows] * 1e3, mark, color=PROFILE, label="half-width")
    peak = ax.twinx()
    peak.plot(time, contact.mid_peak_pressure[rows] * 1e-6, mark, color=REFERENCE, label="peak pressure")
    lines = [v for v in (hertz_of(contact, int(i)) for i in rows) if v is not None]
    lines = lines if len(lines) == len(rows) else []
    reference = [v.half_width * 1e3 for v in lines], [v.peak_pressure * 1e-6 for v in lines]
    if lines:
        dashed = {"lw": 0.8, "ls": "--", "marker": "_" if len(rows) == 1 else None, "ms": 20.0}
        ax.plot(time, reference[0], color=PROFILE, **dashed)
        peak.plot(time, reference[1], color=REFERENCE, **dashed)
    ax.set(xlabel="time [ms]", title="Half-width across and peak pressure (dashed: Hertz)")
    ax.set_ylabel("half-width [mm]", color=PROFILE)
    peak.set_ylabel("peak pressure [MPa]", color=REFERENCE)
    from_zero(ax, contact.half_width[rows] * 1e3, reference[0])
    from_zero(peak, contact.mid_peak_pressure[rows] * 1e-6, reference[1])
    ax.title.set_fontsize(10)


def ripple(result: Any, ax: Any) -> None:
    """Force, half-width and peak pressure of the second half of the run, as deviations from their means in per cent,
    down to 1e-3 %.

    Smaller deviations are round-off and iteration tolerance.
    """
    contact = _contact(result)
    rows = np.flatnonzero(contact.touching & (result.time >= 0.5 * (result.time[0] + result.time[-1])))
    curves = {
        "force": (contact.force_magnitude, FORCE), "half-width": (contact.half_width, PROFILE),
        "peak pressure": (contact.mid_peak_pressure, REFERENCE),
    }  # fmt: skip
    for name, (values, color) in curves.items():
        mean = float(np.mean(values[rows])) if len(rows) else 0.0
        about = 100.0 * (values[rows] / mean - 1.0) if mean > 0.0 else np.zeros(len(rows))
        label = f"{name}, {np.ptp(about) if len(rows) else 0.0:.2g} % from end to end"
        ax.plot(result.time[rows] * 1e3, about, lw=1.1, color=color, label=label)
    ax.axhline(0.0, color="0.7", lw=0.6)
    ax.margins(y=0.25)
    about_zero(ax, RIPPLE)
    ax.set(xlabel="time [ms]", ylabel="about the mean [%]")
    ax.set_title("Ripple in the second half of the run", fontsize=10)
    ax.legend(frameon=False, fontsize=7, loc="upper left")


SUMMARY = "summary"  # command-line word for the page with all plots
Draw = Callable[[Any, Any], None]
# Histories: for a run of one row a page shows their numbers instead.
OVER_TIME = {
    "widths", "ripple", "energy", "creepage", "spin", "t_gamma", "power", "film_thickness", "slip_area",
    "element_loads", "sensors", *GEAR_PLOTS,
}  # fmt: skip
MACHINE_PLOTS: dict[str, Draw] = {"joints": joints, "sensors": sensors, "energy": energy}
PLOTS: dict[str, Draw] = {
    "force": force,
    "widths": widths,
    "ripple": ripple,
    "across": across,
    "along": along,
    "patch": patch,
    "stress_depth": stress_depth,
}


def _film(result: Any, name: str | None) -> Any:
    if name is None and not result.film_names:
        raise InputError("plot: the scene has no oil film; give it one with scene.add(Film(...)), and run again")
    return result.film(result.film_names[0] if name is None else name)


def plot(
    result: Any, kind: str, ax: Any = None, contact: str | None = None, film: str | None = None,
    row: int | None = None, channel: str | None = None, speed: str | None = None, bearing: str | None = None,
    gear: str | None = None, theme: str = "light", width: float | None = None,
) -> Any:  # fmt: skip
    """Draw `kind` on `ax` (a new one if None) and return the axes.

    theme, width: of new axes, as of `restyle`.

    contact, film, bearing, gear: names of the contact, film, bearing and gear pair to draw, the first ones if None;
    kinds that contacts with finite and with small sliding have in common are of the first with finite sliding, where
    there is one. row: saved step of the maps of films and of contacts with small sliding and of the loads of bearings,
    the last one if None; channel, speed: names of a history and of the rotating body, for plots of a history. Raises
    `InputError` for an unknown kind, contact, film, bearing, gear pair or row, a run without rows, plots of friction,
    films, contacts, bearings or gear pairs of a run without them, and plots of histories without a name.
    """
    known = {**PLOTS, **MACHINE_PLOTS, **FRICTION_PLOTS}
    known["sensors"] = lambda result, ax: sensors(result, ax, channel)
    others = (*FILM_PLOTS, *SMALL_SLIDING_PLOTS, *BEARING_PLOTS, *GEAR_PLOTS, *HISTORY_PLOTS)
    kinds = tuple(dict.fromkeys((*known, *others)))
    if kind not in kinds:
        cure = "; the page with all of them is result.summary()" if kind == SUMMARY else ""
        close = f"did you mean '{near}'? " if (near := nearest(kind, kinds)) else ""
        raise InputError(f"plot: unknown kind '{kind}'; {close}known: {', '.join(kinds)}{cure}")
    result, row = _shown(result, contact, row)
    known |= {name: _of_film(draw, film, row) for name, draw in FILM_PLOTS.items()}
    taken = _kinds_of_finite_sliding(result) if result.small_sliding_names else known
    known |= {name: _of_small_sliding(draw, row) for name, draw in SMALL_SLIDING_PLOTS.items() if name not in taken}
    known |= {name: _of_bearing(draw, bearing, row) for name, draw in BEARING_PLOTS.items()}
    known |= {name: _of_gear(draw, gear) for name, draw in GEAR_PLOTS.items()}
    if kind in HISTORY_PLOTS:
        known[kind] = _of_history(HISTORY_PLOTS[kind], the_channel(kind, channel), speed)
    require_theme(theme)
    if ax is not None:
        if theme != THEMES[0] or width is not None:
            raise InputError("plot: theme and width are of new axes; leave ax out")
        known[kind](result, ax)
        return ax
    import matplotlib.pyplot as plt

    ax = plt.subplots(layout="constrained", subplot_kw={"projection": "polar"} if kind in POLAR else None)[1]
    known[kind](result, ax)
    restyle(ax.figure, theme, width)
    return ax


def _shown(result: Any, contact: str | None, row: int | None) -> tuple[Any, int]:
    """The result, restricted to one contact if one is named, and the saved step to draw. Raises `InputError`."""
    if contact is not None:
        result = OfPair(result, contact)
    if len(result.time) == 0:
        raise InputError("plot: the run has no saved row")
    row = len(result.time) - 1 if row is None else row
    if not 0 <= row < len(result.time):
        raise InputError(f"plot: row is {row}; the run has the saved rows 0 to {len(result.time) - 1}")
    return result, row


def _of_film(draw: Callable[[Any, Any, int], None], film: str | None, row: int) -> Draw:
    return lambda result, ax: draw(_film(result, film), ax, row)


def _of_small_sliding(draw: Callable[[Any, Any, int], None], row: int) -> Draw:
    return lambda result, ax: draw(the_small_sliding(result), ax, row)


def _kinds_of_finite_sliding(result: Any) -> set[str]:
    """The kinds of plots that show a contact with finite sliding; those with small sliding have some in common."""
    names = result.finite_sliding_names
    rubs = any(result.contact(name).has_friction for name in names)
    return {*(PLOTS if names else ()), *(FRICTION_PLOTS if rubs else ())}


def _of_history(draw: Callable[[Any, Any, str, str | None], None], channel: str, speed: str | None) -> Draw:
    return lambda result, ax: draw(result, ax, channel, speed)


def _of_bearing(draw: Callable[[Any, Any, int], None], bearing: str | None, row: int) -> Draw:
    return lambda result, ax: draw(the_bearing(result, bearing), ax, row)


def _of_gear(draw: Callable[[Any, Any], None], gear: str | None) -> Draw:
    return lambda result, ax: draw(the_gear(result, gear), ax)


def drawable(result: Any, film: str | None = None, row: int = -1) -> dict[str, Draw]:
    """The kinds of plots for which the run has data, with their drawing functions; film, row: as of `plot`."""
    finite = result.finite_sliding_names
    drawn: dict[str, Draw] = dict(PLOTS) if finite else {}
    if finite and not has_material(_contact(result)):
        del drawn["stress_depth"]
    if result.lumped_contact_names or result.film_names or result.small_sliding_names:
        drawn = {"force": force} | drawn
    if any(result.contact(name).has_friction for name in finite):
        drawn.update(FRICTION_PLOTS)
    if result.film_names:
        drawn |= {kind: _of_film(FILM_PLOTS[kind], film, row) for kind in film_kinds(_film(result, film))}
    if result.small_sliding_names:
        frictionless = the_small_sliding(result).friction == 0.0
        kinds = [kind for kind in SMALL_SLIDING_PLOTS if kind != "friction_loss" or not frictionless]
        drawn |= {kind: _of_small_sliding(SMALL_SLIDING_PLOTS[kind], row) for kind in kinds if kind not in drawn}
    if result.bearing_names:
        drawn |= {kind: _of_bearing(BEARING_PLOTS[kind], None, row) for kind in BEARING_PLOTS}
    if result.gear_names:
        drawn |= {kind: _of_gear(GEAR_PLOTS[kind], None) for kind in gear_kinds(the_gear(result, None))}
    has = {"joints": bool(_reactions(result)), "sensors": bool(result.history.sensors), "energy": True}
    drawn |= {kind: draw for kind, draw in MACHINE_PLOTS.items() if has[kind]}
    return drawn if len(result.time) > 1 else {kind: draw for kind, draw in drawn.items() if kind not in OVER_TIME}


def about_kinds() -> dict[str, str]:
    """Every kind of plot with a one-sentence description."""
    draws: dict[str, Callable[..., None]] = {
        **SMALL_SLIDING_PLOTS, **PLOTS, **FRICTION_PLOTS, **FILM_PLOTS, **BEARING_PLOTS, **GEAR_PLOTS, **MACHINE_PLOTS,
        **HISTORY_PLOTS,
    }  # fmt: skip
    said = {kind: " ".join((draw.__doc__ or "").split("\n\n")[0].split()) for kind, draw in draws.items()}
    return said | {SUMMARY: "Everything that the run has data for, on one page."}


def summary(
    result: Any, contact: str | None = None, film: str | None = None, row: int | None = None, *, theme: str = "light",
    width: float | None = None,
) -> Any:  # fmt: skip
    """A matplotlib Figure with every plot for which the run has data; contact, film, row and errors raised: as of
    `plot`; theme, width: as of `restyle`."""
    require_theme(theme)
    result, row = _shown(result, contact, row)
    drawn = drawable(result, film, row)
    if result.small_sliding_names:  # what a contact with finite sliding has in common with them is drawn of both
        both = [kind for kind in SMALL_SLIDING_PLOTS if kind in _kinds_of_finite_sliding(result)]
        drawn |= {f"{kind}, small sliding": _of_small_sliding(SMALL_SLIDING_PLOTS[kind], row) for kind in both}
    units = {sensor.unit: name for name, sensor in reversed(result.history.sensors.items())}
    for name in [*reversed(units.values())][1:] if "sensors" in drawn else ():  # a panel for each unit
        drawn[f"sensors like {name}"] = lambda result, ax, name=name: sensors(result, ax, name)
    if "load_zone" in drawn and _only_bearings(result):
        drawn.pop("force", None)  # as many curves as elements, rings and pockets; the loads of elements say the same
    if len(result.time) == 1:
        numbers: dict[str, Draw] = {"numbers": lambda result, ax: _numbers(result, ax, film)}
        drawn = {"force": drawn.pop("force")} | numbers | drawn if "force" in drawn else numbers | drawn
    figure, places = page(len(drawn), columns_in(width, PAGE_PANELS), PAGE_PANEL)
    for place, (kind, draw) in zip(places, drawn.items(), strict=True):
        draw(result, figure.add_subplot(place, projection="polar" if kind in POLAR else None))
    _crowd_below(figure)
    saved = "1 saved row" if len(result.time) == 1 else f"{len(result.time)} saved rows"
    end = f"{instant(result.time[-1])}, {saved}, status: {result.status}"
    if isinstance(result, OfPair):
        end += f"; contact {[*result.finite_sliding_names, *result.small_sliding_names][0]!r}"
    finite = result.finite_sliding_names
    if len(finite) > 1:
        end += f"; patches of contact {finite[0]!r}, the first of {len(finite)}"
        with_friction = [name for name in finite if result.contact(name).has_friction]
        end += f", friction of {with_friction[0]!r}" if with_friction else ""
    if len(result.film_names) > 1:
        end += f"; film {_film(result, film).name!r} of {len(result.film_names)}"
    if len(small := result.small_sliding_names) > 1:
        end += f"; of {len(small)} contacts with small sliding {small[0]!r}"
    figure.suptitle(end, fontsize=11)
    return restyle(figure, theme, width)


def _only_bearings(result: Any) -> bool:
    """True if every contact and film is one of the bearings."""
    names = (*result.contact_names, *result.lumped_contact_names, *result.film_names)
    return all(any(name.startswith(f"{bearing} ") for bearing in result.bearing_names) for name in names)


def _numbers(result: Any, ax: Any, film: str | None) -> None:
    """Numbers of the histories of a run of one row."""
    numbers = numbers_of(
        result,
        _contact(result) if result.finite_sliding_names else None,
        rubbing(result) if any(result.contact(name).has_friction for name in result.finite_sliding_names) else None,
        _film(result, film) if result.film_names else None,
        the_small_sliding(result) if result.small_sliding_names else None,
    )
    draw_numbers(ax, numbers, f"Numbers at {_at(result, 0)}")


def write_plot(
    result: Any, kind: str, path: str | os.PathLike[str], *, contact: str | None = None, film: str | None = None,
    row: int | None = None, channel: str | None = None, speed: str | None = None, theme: str = "light",
    width: float | None = None, dpi: int = 130, overwrite: bool = False,
) -> Path:  # fmt: skip
    """Write `plot(result, kind, ...)` as a picture; the file ending selects the format (.png, .pdf, .svg). Raises
    InputError as `plot`, for a path that cannot be written, and for an existing file, unless `overwrite` is set."""

    def draw(ax: Any) -> None:
        plot(result, kind, ax, contact, film, row, channel, speed)

    if kind != SUMMARY:
        return write_drawing(
            draw, path, "figure", theme=theme, width=width, overwrite=overwrite, dpi=dpi,
            projection="polar" if kind in POLAR else None,
        )  # fmt: skip
    figure = summary(result, contact, film, row, theme=theme, width=width)
    return write_picture(figure, path, "figure", overwrite=overwrite, dpi=dpi)


def write_figure(result: Any, path: str | os.PathLike[str], *, dpi: int = 130, overwrite: bool = False) -> Path:
    """Write the summary figure; the file ending selects the format (.png, .pdf, .svg). Raises InputError for a path
    that cannot be written, and for an existing file, unless `overwrite` is set."""
    return write_plot(result, SUMMARY, path, dpi=dpi, overwrite=overwrite)
