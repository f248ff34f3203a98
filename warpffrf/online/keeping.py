"""What a run gives out while it is under way, and how it goes on from there.

A *keeper* is asked between chunks of steps whether it is due, and is given what has been saved since the last time,
with a checkpoint. A run that was stopped, by whatever, goes on from the last of these bit for bit: `Unfinished` holds
its rows, as the device wrote them, beside the checkpoint, so that what is made of rows is made of all of them at once,
as in a run that never stopped.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from warpffrf_kernels.core import control as k

from warpffrf.model.interruption import deferred_interrupts
from warpffrf.online.arrays.ring import SavedRows, joined, taken
from warpffrf.online.checkpoint import restore
from warpffrf.online.engine import Engine
from warpffrf.online.history.history import History
from warpffrf.online.history.record import history_from_rows

UNFINISHED = "unfinished"  # status of what is given out
MOST_ATTEMPTS = 1000  # to end a step that an interruption has cut


@dataclass(frozen=True)
class Plan:
    """What a run is to reach, and what it brings from its start."""

    last_step: int  # user steps, counted as the checkpoint does
    rejected: int  # attempts that an earlier run, which this one continues, had rejected
    notes: tuple[str, ...]


@dataclass(frozen=True)
class Unfinished:
    """A run up to its last checkpoint."""

    rows: SavedRows
    checkpoint: Mapping[str, np.ndarray]
    plan: Plan


class Keeper(Protocol):
    """Somewhere to put what a run has done so far."""

    def due(self) -> bool:
        """Whether it is time to."""
        ...

    def keep(self, history: History, rows: SavedRows, plan: Plan) -> bool:
        """Take what was saved since the last time: `history`, with the checkpoint, and the same as `rows`; False where
        it could not, and the same is to come again."""
        ...


class Keeping:
    """A run beside its keeper; `None`: nothing is kept."""

    def __init__(self, engine: Engine, keeper: Keeper | None, plan: Plan, given: int) -> None:
        """given: how many chunks of rows the keeper has already."""
        self.engine, self.keeper, self.plan, self.given = engine, keeper, plan, given

    def look(self) -> None:
        """Keep what there is, where it is time to and a step has just ended. Raises KeyboardInterrupt afterwards if
        that was asked for meanwhile."""
        if self.keeper is None or not self.keeper.due() or _within_step(self.engine):
            return
        with deferred_interrupts() as asked:
            self._keep(self.keeper)
        if asked:
            raise KeyboardInterrupt

    def end(self) -> None:
        """Of a run that is interrupted: end the step at hand, and keep what there is."""
        if self.keeper is None:
            return
        if _within_step(self.engine):
            self.engine.control(target=int(self.engine.word("step").min()) + 1)
            self.engine.replay(MOST_ATTEMPTS)
        if not _within_step(self.engine) and not np.any(self.engine.word("status")):
            self._keep(self.keeper)

    def _keep(self, keeper: Keeper) -> None:
        chunks = self.engine.chunks[0][self.given :]
        rows = joined(chunks or [taken(self.engine.ring.on_host(), 0, range(0))])
        history = history_from_rows(self.engine.compiled, rows)
        history.status, history.notes, history.checkpoint = UNFINISHED, list(self.plan.notes), self.engine.checkpoint()
        if keeper.keep(history, rows, self.plan):
            self.given += len(chunks)


def _within_step(engine: Engine) -> bool:
    """Whether a user step is only partly done, or an attempt is to be repeated."""
    return bool(
        np.any(engine.word("sub")) or np.any(engine.word("again")) or np.any(engine.word("status") & int(k.ROOM))
    )


def go_on(engine: Engine, unfinished: Unfinished, step: float) -> int:
    """Bring `engine` to where `unfinished` ended, its rows taken out of the ring; returns the user steps done."""
    done = restore(engine, unfinished.checkpoint, step)
    words = np.asarray(unfinished.checkpoint["ctl"])
    engine.control(reason=int(words["reason"][0]), spell=int(words["spell"][0]))
    engine.chunks[0] = [unfinished.rows]
    return done
