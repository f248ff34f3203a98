"""Cases of the verification page: what is compared with what, and what is kept of it."""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Row:
    """A `quantity` [`unit`] by this program and by the source. `tolerance`: the largest difference, over the size of
    `theirs`, or over `scale` where that is given (1: the difference as it is)."""

    quantity: str
    ours: float
    theirs: float
    tolerance: float
    unit: str = ""
    scale: float | None = None

    @property
    def difference(self) -> float:
        """What the tolerance limits."""
        return (self.ours - self.theirs) / (abs(self.theirs) if self.scale is None else self.scale)

    @property
    def reached(self) -> bool:
        """Whether the difference is within the tolerance; NaN is not."""
        return bool(abs(self.difference) <= self.tolerance)


@dataclass(frozen=True)
class Case:
    """A case by its `name`, in a `room` of the page; `title` says what it is, `source` where the other numbers are
    from."""

    name: str
    room: str
    title: str
    source: str
    rows: Callable[[], Iterable[Row]]


@dataclass(frozen=True)
class Outcome:
    """What came of a case: its rows, the time that it took [s], and how it ended where it did not come to its end."""

    name: str
    room: str
    title: str
    source: str
    rows: tuple[Row, ...]
    seconds: float
    failed: str = ""

    @property
    def missed(self) -> list[str]:
        """The quantities that are not within their tolerances."""
        return [self.failed] if self.failed else [row.quantity for row in self.rows if not row.reached]

    def stored(self) -> dict[str, Any]:
        """For the file of figures."""
        return asdict(self)

    @classmethod
    def read(cls, stored: dict[str, Any]) -> Outcome:
        """As it was stored."""
        return cls(**{**stored, "rows": tuple(Row(**row) for row in stored["rows"])})


CASES: dict[str, Case] = {}


def case(room: str, source: str) -> Callable[[Callable[[], Iterable[Row]]], Callable[[], Iterable[Row]]]:
    """Register a function without arguments as a case of the page, under its name; its docstring is the title."""

    def registered(rows: Callable[[], Iterable[Row]]) -> Callable[[], Iterable[Row]]:
        title = " ".join((rows.__doc__ or "").split()).rstrip(".")
        CASES[rows.__name__] = Case(rows.__name__, room, title, source, rows)
        return rows

    return registered


def outcome(chosen: Case) -> Outcome:
    """Run a case. One that raises has no rows, and misses."""
    begin = time.perf_counter()
    try:
        rows, failed = tuple(_rounded(row) for row in chosen.rows()), ""
    except Exception as error:  # the page says so, and the other cases are run
        traceback.print_exc()
        rows, failed = (), f"{type(error).__name__}: {error}"
    seconds = round(time.perf_counter() - begin, 1)
    return Outcome(chosen.name, chosen.room, chosen.title, chosen.source, rows, seconds, failed)


def _rounded(row: Row) -> Row:
    """With plain numbers of so many digits as are stored."""
    numbers = {name: float(f"{float(np.real(getattr(row, name))):.10g}") for name in ("ours", "theirs", "tolerance")}
    scale = None if row.scale is None else float(f"{row.scale:.10g}")
    return Row(row.quantity, numbers["ours"], numbers["theirs"], numbers["tolerance"], row.unit, scale)
