"""Scales of axes: from zero, so that a small change looks small; cut where that would hide all there is to see, which
the label says; and never so fine that round-off looks like a ripple."""

from __future__ import annotations

from typing import Any

import numpy as np

HEADROOM = 1.08  # of the largest value of a plot
SMALL = 0.1  # of the mean: values that vary by less are a flat line on a scale from zero
ROUND_OFF = 1e-5  # of the mean: values that vary by less are constant, up to round-off and the tolerance of iterations
ROOM = 0.1  # of the range, above and below it on a cut axis
LEAST = 1e-6  # of a quantity's size: no axis shows less of it, but of motions, which no iteration finds


def from_zero(ax: Any, values: Any, *beside: Any, least: float = 0.0) -> None:
    """Scale the y axis of `ax`, which has its label, from zero to a little above the largest of `values` (n,) and of
    what is drawn `beside` them, `least` at the least: what is far below that is round-off.

    All that vary together by less than `SMALL` of their mean, but by more than `ROUND_OFF`, fill the axis instead, and
    its label says by how much the `values` vary. What is not finite does not count.
    """
    own = _finite(values)
    drawn = np.concatenate([own, *(_finite(v) for v in beside)])
    low, high = float(drawn.min(initial=np.inf)), float(drawn.max(initial=0.0))
    mean, spread = 0.5 * (low + high), high - low
    if low > 0.0 and high > least and np.isfinite(mean) and ROUND_OFF * mean < spread < SMALL * mean:
        ax.set_ylim(low - ROOM * spread, high + ROOM * spread)
        ax.ticklabel_format(axis="y", useOffset=False, style="plain")
        vary = f"varies by {100.0 * np.ptp(own) / np.mean(own):.2g} %" if np.ptp(own) > ROUND_OFF * mean else "constant"
        label = ax.yaxis.label
        ax.set_ylabel(f"{label.get_text()}\naxis cut, {vary}", color=label.get_color())
    else:
        ax.set_ylim(0.0, HEADROOM * max(high, least) or 1.0)


def no_finer(ax: Any, least: float) -> None:
    """Widen the y axis of `ax` about its middle to a range of at least `least`."""
    low, high = ax.get_ylim()
    if high - low < least:
        middle = 0.5 * (low + high)
        ax.set_ylim(middle - 0.5 * least, middle + 0.5 * least)


def about_zero(ax: Any, least: float) -> None:
    """Widen the y axis of `ax` to at least -`least` to `least`."""
    low, high = ax.get_ylim()
    ax.set_ylim(min(low, -least), max(high, least))


def _finite(values: Any) -> np.ndarray:
    found = np.ravel(np.asarray(values, dtype=float))
    return found[np.isfinite(found)]
