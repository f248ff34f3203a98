"""Do the tables of a scene cover the time that is simulated?

A `Table` holds its end values outside its times, which is right for what is evaluated in passing but wrong for a run: a
measured load that ends early would go on unnoticed as a constant one. `Table(hold=True)` says that it should.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from warpffrf.model.errors import InputError
from warpffrf.model.signals import Signal, Table

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene

ROUNDING = 1e-9  # of the duration: ends that differ by less were meant to be the same


def refuse_short_tables(scene: Scene, begin: float, end: float) -> None:
    """Raises `InputError` naming the drive or force whose table does not cover `begin` to `end` [s]."""
    slack = ROUNDING * (end - begin)
    for item in (*scene.drives, *scene.forces):
        for table in _tables(vars(item)):
            first, last = float(table.times[0]), float(table.times[-1])
            if not table.hold and (first > begin + slack or last < end - slack):
                raise InputError(
                    f"{item.kind} {item.name!r}: its table covers {first:g} to {last:g} s, but {begin:g} to {end:g} s "
                    "are simulated; extend the table, shorten the run, or give it hold=True if its end values hold"
                )


def _tables(value: Any) -> Iterator[Table]:
    if isinstance(value, Table):
        yield value
    elif isinstance(value, dict):
        for entry in value.values():
            yield from _tables(entry)
    elif isinstance(value, (list, tuple)) and not isinstance(value, Signal):
        for entry in value:
            yield from _tables(entry)
