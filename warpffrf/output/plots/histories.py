"""Plots of one history of a run, which has to be named: its spectrum, and spectra of windows, over frequency or with
the rotation of a body."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from warpffrf.model.errors import InputError


def spectrum(result: Any, ax: Any, channel: str, speed: str | None) -> None:
    """Amplitudes of a history by frequency, or by orders of the rotation of a body; needs a channel."""
    (result.spectrum(channel) if speed is None else result.orders(channel, speed)).draw(ax)


def waterfall(result: Any, ax: Any, channel: str, speed: str | None) -> None:
    """Spectra of consecutive windows of a history over time, or over the speed of a body with lines of orders; needs a
    channel."""
    result.waterfall(channel, speed).draw(ax)


HISTORY_PLOTS: dict[str, Callable[[Any, Any, str, str | None], None]] = {"spectrum": spectrum, "waterfall": waterfall}


def the_channel(kind: str, channel: str | None) -> str:
    """The history that a plot needs. Raises InputError where none is named."""
    if channel is None:
        raise InputError(
            f"plot: '{kind}' needs the history to draw, channel='contact_force_z[NAME]'; columns of to_csv have the "
            "names"
        )
    return channel
