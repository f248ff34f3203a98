"""Plots of bearings: the load of each element at its angular position, on polar axes, and over time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.output.bearings.bearing_result import BearingResult
from warpffrf.output.plots.colors import HEADROOM, from_zero, instant

INNER, OUTER = "#d1495b", "#1b6ca8"
MOST_NAMED = 12  # curves in a legend
RADII, BELOW_RIM = 4, 0.85  # circles, whose labels stand along one radius; of the rim, where the angles are


def load_zone(bearing: BearingResult, ax: Any, row: int) -> None:
    """Loads on the inner and the outer ring at the angular positions of the elements, a line of each row; the first
    element is at the bottom."""
    from matplotlib.ticker import MaxNLocator

    if not hasattr(ax, "set_theta_zero_location"):
        raise InputError("plot: 'load_zone' is drawn on polar axes; leave ax out, or make it with projection='polar'")
    angle, inner, outer = bearing.angle[row], bearing.inner_load[row] * 1e-3, bearing.outer_load[row] * 1e-3
    rows = len(bearing.geometry.tracks)
    for side, loads, color, style in (("outer", outer, OUTER, "-"), ("inner", inner, INNER, "--")):
        for i, (load, at) in enumerate(zip(np.split(loads, rows), np.split(angle, rows), strict=True)):
            label = f"{side} ring" + (f", row {i + 1}" if rows > 1 else "")
            line = np.append(at, at[0]), np.append(load, load[0])
            ax.plot(*line, "os"[i] + style, color=color, label=label, markersize=4)
    ax.set_theta_zero_location("S")
    ax.set_xticks(np.unique(np.round(np.mod(np.round(angle, 9), 2.0 * np.pi), 6)))
    top = HEADROOM * max(float(outer.max()), float(inner.max())) or 1.0
    ax.set_ylim(0.0, top)
    circles = np.asarray(MaxNLocator(RADII).tick_values(0.0, top))
    ax.set_yticks(circles[(circles > 0.0) & (circles < BELOW_RIM * top)])
    ax.set_rlabel_position(
        np.degrees(angle[np.argmax(outer)] + np.pi * (1.0 + 1.0 / len(angle)))
    )  # away from the loads
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=2, fontsize=8, frameon=False)
    ax.set_title(f"Bearing '{bearing.name}': loads [kN], t = {instant(bearing.time[row])}", fontsize=10)


def element_loads(bearing: BearingResult, ax: Any, row: int) -> None:
    """Load of every element on the outer ring against time."""
    for i, load in enumerate(bearing.outer_load.T, start=1):
        ax.plot(bearing.time * 1e3, load * 1e-3, label=f"{bearing.kind} {i}" if i <= MOST_NAMED else None)
    ax.set(xlabel="time [ms]", ylabel="load on the outer ring [kN]")
    ax.set_title(f"Bearing '{bearing.name}': loads of the elements", fontsize=10)
    from_zero(ax, bearing.outer_load * 1e-3)
    ax.legend(fontsize=7, ncols=3, frameon=False)


BEARING_PLOTS: dict[str, Callable[[BearingResult, Any, int], None]] = {
    "load_zone": load_zone,
    "element_loads": element_loads,
}
POLAR = frozenset({"load_zone"})


def the_bearing(result: Any, name: str | None) -> BearingResult:
    """The bearing called `name`, the first one if None; raises `InputError` if there is none."""
    if name is None and not result.bearing_names:
        raise InputError("plot: the scene has no bearing; make one with scene.add_bearing(...), and run again")
    return result.bearing(result.bearing_names[0] if name is None else name)
