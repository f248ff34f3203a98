"""Plots of flanks of gears: maps over roll angle and width, and film thickness."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.output.plots.colors import from_zero, side_bar

LINE = "#1b6ca8"
FIELDS = {"pressure": ("pressure [MPa]", 1e-6, "YlOrRd"), "wear_index": ("wear index [W/mm²]", 1e-6, "PuRd")}
UM, MM = 1e6, 1e3


def flank_field(found: Any, ax: Any, field: str) -> None:
    """A `field` of a `FlankMap` over roll angle and width. Raises `InputError` for fewer than two rows."""
    if len(found.step) < 2:
        raise InputError("plot: a map of a flank requires two saved steps under load at least")
    label, factor, colors = FIELDS[field]
    values, angle = factor * getattr(found, field), np.degrees(found.roll_angle)
    image = ax.pcolormesh(angle, MM * found.width, values, shading="gouraud", cmap=colors, vmin=0.0)
    side_bar(ax, image, label=label)
    loaded = angle[found.pressure > 0.0]  # sections of helical gears enter later and leave earlier than others
    ax.set_xlim(loaded.min(initial=np.inf), loaded.max(initial=-np.inf))
    ax.set(xlabel="roll angle of gear 1 [degrees]", ylabel="along the axis [mm]")
    ax.set_title("Flank of gear 1: " + label.split(" [")[0], fontsize=10)


def film(found: Any, ax: Any) -> None:
    """Least film thickness of `FlankFilms` over the roll angle, and the film parameter where roughness was given."""
    angle, thickness, ratio = np.degrees(found.roll_angle), UM * found.minimum, found.parameter
    for x, y in zip(angle.T, thickness.T, strict=True):
        along(ax, x, y)
    ax.set(xlabel="roll angle of gear 1 [degrees]", ylabel="least film [µm]")
    from_zero(ax, thickness)
    if np.any(np.isfinite(ratio)):
        both = ax.twinx()
        both.set_ylim(np.array(ax.get_ylim()) * np.nanmedian(ratio / thickness))
        both.set_ylabel("film parameter Λ [-]")
    ax.set_title("Film thickness on the flanks", fontsize=10)


def along(ax: Any, x: np.ndarray, y: np.ndarray) -> None:
    """The rows with a value, in the order of x."""
    rows = np.argsort(x)
    rows = rows[np.isfinite(y[rows])]
    if len(rows):
        ax.plot(x[rows], y[rows], ".-", lw=1.1, ms=4.0, color=LINE)
