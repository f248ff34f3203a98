"""Plots of a run of one saved row, as an equilibrium: bars and numbers in the place of histories that are a dot."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.output.contact.hertz import hertz
from warpffrf.output.plots.scales import LEAST

BAR, TALL, FONT = "#1b6ca8", 12, 8  # more bars than so many have smaller names
FEW = 4  # bars are no thicker than those of so many
ROOM = 1.3  # of the longest bar, for its number


def draw_bars(ax: Any, values: Mapping[str, np.ndarray], label: str) -> None:
    """A bar for each of `values` {name: (1,)}, from the top, with its number; `label` has the unit."""
    sizes = np.array([float(value[0]) for value in values.values()])
    sizes[sizes < LEAST * np.max(sizes, initial=0.0)] = 0.0
    bars = ax.barh(range(len(sizes)), sizes, color=BAR)
    small = FONT - 2 if len(sizes) > TALL else FONT
    ax.bar_label(bars, labels=[f"{size:.4g}" for size in sizes], padding=3, fontsize=small)
    ax.set_yticks(range(len(sizes)), list(values), fontsize=small)
    ax.set_ylim(max(len(sizes), FEW) - 0.5, -0.5)
    ax.set_xlim(0.0, ROOM * float(np.max(sizes, initial=0.0)) or 1.0)
    ax.set_xlabel(label)


def draw_numbers(ax: Any, numbers: Mapping[str, str], title: str) -> None:
    """A table of `numbers`, name -> number with its unit."""
    ax.axis("off")
    table = ax.table(
        [[name, text] for name, text in numbers.items()], loc="upper center", cellLoc="left", colWidths=[0.62, 0.38],
        edges="horizontal",
    )  # fmt: skip
    table.auto_set_font_size(False)
    table.set_fontsize(FONT)
    ax.set_title(title, fontsize=10)


def numbers_of(result: Any, contact: Any, friction: Any, film: Any, lap: Any) -> dict[str, str]:
    """What histories of the run have in its row; contact, friction, film, lap: those whose figures are drawn, or None
    (friction: the pair that rubs)."""
    found: dict[str, str] = {}
    if contact is not None and contact.touching[0]:
        found["half-width"] = f"{contact.half_width[0] * 1e3:.4g} mm"
        found["peak pressure"] = f"{contact.mid_peak_pressure[0] * 1e-6:.4g} MPa"
        try:
            line = hertz(contact, 0)
        except InputError:
            pass  # Hertz does not apply
        else:
            found["Hertz at this load"] = f"{line.half_width * 1e3:.4g} mm, {line.peak_pressure * 1e-6:.4g} MPa"
    if friction is not None:
        found["tangential over normal load"] = load_ratio(friction.friction, 0)
    if film is not None:
        found["smallest film"] = f"{film.smallest_gap[0] * 1e6:.4g} µm"
        found["largest pressure of the film"] = f"{film.largest_pressure[0] * 1e-6:.4g} MPa"
    if lap is not None:
        found["normal force of the lap"] = f"{lap.normal_force[0] * 1e-3:.4g} kN"
        found["slipping area of the lap"] = f"{lap.slip_area[0] * 1e6:.4g} mm²"
    found["energy at hand"] = f"{result.energy_scale:.4g} J"
    return found


def load_ratio(friction: Any, row: int) -> str:
    """Tangential over normal load in a row; what is round-off is 0."""
    ratio = float(np.nan_to_num(friction.traction_coefficient[row]))
    return f"{ratio:.4g}" if abs(ratio) > LEAST else "0"
