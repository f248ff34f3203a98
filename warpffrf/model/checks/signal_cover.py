"""The signals of a scene: do they cover the time that is simulated, and how soon do they change?

A `Table` holds its end values outside its times, which is right for what is evaluated in passing but wrong for a run: a
measured load that ends early would go on unnoticed as a constant one. `Table(hold=True)` says that it should. A `Sine`
covers its duration.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.signals import Signal

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene

ROUNDING = 1e-9  # of the duration: ends that differ by less were meant to be the same


def refuse_short_signals(scene: Scene, begin: float, end: float) -> None:
    """Raises `InputError` naming the drive or force whose signal does not cover `begin` to `end` [s]."""
    slack = ROUNDING * (end - begin)
    for item in (*scene.drives, *scene.forces):
        for signal in signals_in(vars(item)):
            first, last = signal.covers
            if first > begin + slack or last < end - slack:
                raise InputError(
                    f"{item.kind} {item.name!r}: its signal covers {max(first, 0.0):g} to {last:g} s, but {begin:g} to "
                    f"{end:g} s are simulated; extend it, shorten the run, or give a Table hold=True if its end values "
                    "hold"
                )


def quickest_rise(scene: Scene, begin: float, end: float) -> float:
    """The shortest time [s] in which a signal of a drive or force would pass its whole range, at the largest slope that
    it has within `begin` to `end` [s]; infinite where nothing changes."""
    shortest = np.inf
    for item in (*scene.drives, *scene.forces):
        for signal in signals_in(vars(item)):
            values, slopes = signal.samples(begin, end)
            if (steepest := float(np.abs(slopes).max(initial=0.0))) > 0.0:
                shortest = min(shortest, float(np.ptp(values)) / steepest)
    return shortest


def signals_in(value: Any) -> Iterator[Signal]:
    """All signals in the attributes of a drive or force, `vars(item)`."""
    if isinstance(value, Signal):
        yield value
    elif isinstance(value, dict):
        for entry in value.values():
            yield from signals_in(entry)
    elif isinstance(value, (list, tuple)):
        for entry in value:
            yield from signals_in(entry)
