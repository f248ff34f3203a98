r"""Spectra of consecutive windows of a history, over time or over the rotational speed of a body.

Window w has the rows w H .. w H + N - 1 of the history at even times d apart, H = N/`OVERLAP`, and the amplitudes of
`spectrum.amplitudes` in them: a sine of amplitude A shows A at its frequency, with the resolution 1/(N d). A window is
placed at the middle of its rows, or at the mean speed over them. Excitations locked to the rotation lie on lines f = n
s through the origin, with the order n and the speed s in revolutions per second; natural frequencies stay constant. A
run-up is resolved best if the speed changes within a window by less than the resolution over the order, `ds < 1/(n N
d)`: the larger the order, the shorter the window.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_number
from warpffrf.output.spectrum import TURN, amplitudes, doubt, even_rows, turning_rate

PARTS = 8  # default window length: run duration over this number
FEWEST_ROWS, FEWEST_WINDOWS = 16, 3  # of a window and of a waterfall
OVERLAP = 4  # windows that share a row
STEADY = 1e-3  # of the largest speed: a smaller range is a constant speed
FLOOR = 1e-3  # of the largest amplitude: lower limit of the colour scale
SEEN, BEYOND = 0.02, 1.3  # of the largest amplitude, and of the highest frequency that reaches it: end of a plot
NARROW = 0.05  # of the axis: order lines that end closer to its start are labelled on the right
ORDERS = (1, 2, 3)  # default order lines
ORDER = "#6fe3ff"


@dataclass(frozen=True, eq=False)
class Waterfall:
    """Amplitudes (w, n) of the history `label` in `units` at the frequencies `frequency` (n,) [Hz], in windows about
    the times `time` (w,) [s]; with `body` at its speeds `speed` (w,) [rev/s], else None; `notes` list the
    preprocessing of the values, whose largest magnitude is `largest`."""

    label: str
    units: str
    time: np.ndarray
    frequency: np.ndarray
    amplitude: np.ndarray
    body: str | None = None
    speed: np.ndarray | None = None
    notes: list[str] = field(default_factory=list)
    largest: float = 0.0

    @property
    def resolution(self) -> float:
        """Frequency resolution [Hz], the inverse of the window length."""
        return float(self.frequency[1] - self.frequency[0])

    def report(self) -> str:
        """Windows, resolution and the largest amplitude, in a few lines."""
        w, k = np.unravel_index(int(np.argmax(self.amplitude)), self.amplitude.shape)
        where = f"{self.time[w]:.4g} s" if self.speed is None else f"{self.speed[w]:.4g} rev/s of '{self.body}'"
        lines = [f"{self.label}: {len(self.time)} windows of {1.0 / self.resolution:.4g} s"]
        lines.append(f"largest {self.amplitude[w, k]:.5g} {self.units} at {self.frequency[k]:.6g} Hz, {where}")
        return "\n".join(lines + [f"note: {note}" for note in self.notes])

    def draw(self, ax: Any, *, orders: Sequence[float] = ORDERS, highest: float | None = None) -> None:
        """Draw on matplotlib axes, with colours on a logarithmic scale; over speed with the lines of `orders`.

        highest: upper frequency limit [Hz]; None: slightly above the highest frequency whose amplitude is 2 % of the
        largest.
        """
        from matplotlib.colors import LogNorm

        seen = np.flatnonzero(np.any(self.amplitude > SEEN * self.amplitude.max(), axis=0))
        last = float(self.frequency[-1])
        if highest is None:
            highest = min(BEYOND * float(self.frequency[seen[-1]]), last) if len(seen) else last
        shown = self.frequency <= highest
        at, label = self.time, "time [s]"
        if self.speed is not None:
            at, label = self.speed, f"speed of '{self.body}' [rev/s]"
        rows = np.argsort(at, kind="stable")
        most = float(self.amplitude.max())
        scale = LogNorm(FLOOR * most, most) if most > 0.0 else None
        image = ax.pcolormesh(
            self.frequency[shown], at[rows], np.maximum(self.amplitude[rows][:, shown], FLOOR * most),
            shading="nearest", norm=scale, cmap="magma", rasterized=True,
        )  # fmt: skip
        ax.figure.colorbar(image, ax=ax, label=f"amplitude [{self.units}]")
        low, high = ax.get_ylim()
        for order in orders if self.speed is not None else ():
            end = min(high, highest / order) if order > 0.0 else high
            ax.plot([order * low, order * end], [low, end], color=ORDER, lw=0.9, ls=(0, (6, 4)))
            inside = order * end > NARROW * highest  # there is room left of the line
            place: dict[str, Any] = {"textcoords": "offset points", "va": "top", "ha": "right" if inside else "left"}
            place["xytext"] = (-3, -3) if inside else (3, -3)
            place["bbox"] = {"facecolor": "black", "alpha": 0.6, "pad": 1.0, "linewidth": 0.0}
            ax.annotate(f"{order:g}", (order * end, end), color=ORDER, fontsize=9, **place)
        ax.set(xlim=(0.0, highest), ylim=(low, high), xlabel="frequency [Hz]", ylabel=label)
        dashed = ", orders dashed" if self.speed is not None and len(orders) else ""
        ax.set_title(self.label + dashed + doubt(most, self.largest), fontsize=10)


def waterfall(time: np.ndarray, values: np.ndarray, label: str, units: str, window: float | None = None) -> Waterfall:
    """The `Waterfall` of `values` (T,) at `time` (T,) [s] over time; window: length of a window [s], None: an eighth of
    the run. Raises InputError for windows of fewer than 16 rows, fewer than 3 windows, and values that are not finite.
    """
    values, step, notes = even_rows(time, values, label)
    count = max(len(values) // PARTS, FEWEST_ROWS) if window is None else _rows(window, step, label)
    hop = count // OVERLAP
    starts = np.arange(0, len(values) - count + 1, hop)
    if len(starts) < FEWEST_WINDOWS:
        raise InputError(
            f"{label}: {len(values)} saved rows make {len(starts)} windows of {count} rows, a waterfall needs "
            f"{FEWEST_WINDOWS}; simulate longer, save more rows, save_every=1, or give a shorter window"
        )
    found = [amplitudes(values[s : s + count], step) for s in starts]
    middle = time[0] + step * (starts + 0.5 * (count - 1))
    largest = float(np.max(np.abs(values)))
    return Waterfall(label, units, middle, found[0][0], np.stack([f[1] for f in found]), notes=notes, largest=largest)


def over_speed(found: Waterfall, time: np.ndarray, spin: np.ndarray, body: str, axis: Any = None) -> Waterfall:
    """`found` over the speed of `body`, whose angular velocity is `spin` (T, 3) [rad/s] at `time` (T,) [s], about the
    `axis` (3,), None: that of its mean, both in the world. Raises InputError for a constant speed."""
    rate = turning_rate(time, spin, axis) / TURN
    turns = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time))])
    half = 0.5 * (1.0 / found.resolution - (time[-1] - time[0]) / (len(time) - 1))  # from first to last row of a window
    low, high = (np.interp(found.time + side * half, time, turns) for side in (-1.0, 1.0))
    speed = (high - low) / (2.0 * half)
    if np.ptp(speed) <= STEADY * np.max(np.abs(speed)):
        raise InputError(
            f"waterfall: body '{body}' turns at {np.mean(speed):.4g} rev/s throughout; draw it over time, without "
            "speed, or drive the body through a run-up"
        )
    notes = list(found.notes)
    if np.any(np.diff(speed) < 0.0) and np.any(np.diff(speed) > 0.0):
        notes.append("the speed rises and falls: windows are sorted by speed")
    return Waterfall(
        found.label, found.units, found.time, found.frequency, found.amplitude, body, speed, notes, found.largest
    )


def _rows(window: float, step: float, label: str) -> int:
    count = int(round(require_number(window, "waterfall: window", positive=True) / step))
    if count < FEWEST_ROWS:
        raise InputError(f"{label}: a window of {window:g} s has {count} rows, it needs {FEWEST_ROWS}; make it longer")
    return count
