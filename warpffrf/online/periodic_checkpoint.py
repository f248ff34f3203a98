"""Saving a run with a keeper (`warpffrf.model.messages.checkpoints`) while it is under way, and continuing from what
was saved."""

from __future__ import annotations

import numpy as np

from warpffrf.model.messages.checkpoints import Keeper, Plan, Rows, Source, Unfinished
from warpffrf.model.messages.progress import deferred_interrupts
from warpffrf.model.scene import Scene
from warpffrf.online.arrays.ring import taken
from warpffrf.online.checkpoint import restore
from warpffrf.online.compile.scene import compile_scene
from warpffrf.online.engine import Engine
from warpffrf.online.history.history import History
from warpffrf.online.history.record import history_from_rows
from warpffrf.online.local_modes import LocalModes
from warpffrf.online.settings import Settings
from warpffrf.online.warp_lock import WARP_LOCK
from warpffrf.online.warp_start import start_warp
from warpffrf_kernels.core import control as k

KIND = "steps"
MOST_ATTEMPTS = 1000  # to complete an interrupted step


class Keeping:
    """A run with its keeper; `None`: nothing is saved."""

    def __init__(self, engine: Engine, keeper: Keeper | None, plan: Plan) -> None:
        self.engine, self.keeper, self.plan = engine, keeper, plan
        if keeper is None:
            return
        if not engine.chunks[0]:
            engine.chunks[0].append(taken(engine.ring.on_host(), 0, range(0)))  # describes the rows
        options = {"local_modes": engine.compiled.local.options, "settings": engine.settings, "off_end": engine.off_end}
        keeper.begin(Source(KIND, engine.scene, options))

    def look(self) -> None:
        """Save the rows if it is due and a step has just ended. Raises KeyboardInterrupt afterwards if it was requested
        meanwhile."""
        if self.keeper is None or not self.keeper.due() or _within_step(self.engine):
            return
        with deferred_interrupts() as asked:
            self._keep(self.keeper)
        if asked:
            raise KeyboardInterrupt

    def end(self) -> None:
        """For an interrupted run: complete the current step and save."""
        if self.keeper is None:
            return
        if _within_step(self.engine):
            self.engine.control(target=int(self.engine.word("step").min()) + 1)
            self.engine.replay(MOST_ATTEMPTS)
        if not _within_step(self.engine) and not np.any(self.engine.word("status")):
            self._keep(self.keeper)

    def _keep(self, keeper: Keeper) -> None:
        keeper.keep(Unfinished(tuple(self.engine.chunks[0]), self.engine.checkpoint(), self.plan))


def _within_step(engine: Engine) -> bool:
    """Whether a user step is incomplete, or an attempt is to be repeated."""
    return bool(
        np.any(engine.word("sub")) or np.any(engine.word("again")) or np.any(engine.word("status") & int(k.ROOM))
    )


def go_on(engine: Engine, unfinished: Unfinished, step: float) -> int:
    """Set `engine` to the end of `unfinished`, with its rows drained from the ring; returns the user steps done."""
    done = restore(engine, unfinished.checkpoint, step)
    words = np.asarray(unfinished.checkpoint["ctl"])
    engine.control(reason=int(words["reason"][0]), gaining_steps=int(words["gaining_steps"][0]))
    engine.chunks[0] = list(unfinished.rows)
    return done


@WARP_LOCK
def history_of(
    scene: Scene, rows: Rows, *, local_modes: LocalModes, settings: Settings, off_end: bool = False
) -> History:
    """The History of rows that a run of `scene` has given out; options as its `Source` has them."""
    start_warp()
    return history_from_rows(compile_scene(scene, settings, "cpu", local_modes, off_end=off_end), rows)
