"""A run in time step by step: its inputs, rows and states between the steps.

On the CPU a step costs the replay of its graph and a few words that are written and read in place: no launch and no
copy. Every `LOOK` steps the rows are drained from the ring and the run is watched as that of `simulate` is.

Rows of all steps are recorded, so that outputs of the present are known, and thinned to every `save_every`th as they
are drained; counts of iterations are then sums over the steps between two rows, as the device makes them.

A run that has to begin anew, because a body rotates faster than its inertia level is valid for or a patch runs off an
end, repeats the changes of its inputs at the same steps.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
import warp as wp

from warpffrf.model.errors import MOST_COUNTED, InputError
from warpffrf.model.scene import Scene
from warpffrf.online.arrays.ring import SavedRows, joined, taken
from warpffrf.online.checkpoint import off_end_of, restore
from warpffrf.online.diagnosis.patch_off_end import OffEnd
from warpffrf.online.history.history import ENERGY_LINES, History
from warpffrf.online.running import Outrun, Running
from warpffrf.online.warp_lock import WARP_LOCK, replays_side_by_side

log = logging.getLogger("warpffrf")

LOOK = 200  # steps between two looks at the run; fewer than rows of the ring
MOST_ATTEMPTS = 1000  # of a step in one replay: more follow where it is halved so often
ROW = "row_"  # prefix of arrays of a state that are of its row
SUMMED = ("saved_iterations", "saved_solves")  # over the steps since the last row
LARGEST = ("saved_advanced",)  # of these steps

State = dict[str, np.ndarray]


class Stepping:
    """A run of `scene` in steps of `step` [s] without an end; options: those of `Running`, but `save_every`, of the
    rows of its History. Raises `InputError` for wrong input."""

    def __init__(self, scene: Scene, *, step: float, start: str | History, save_every: int, **options: Any) -> None:
        self.scene, self.step_size, self.save_every = scene, step, save_every
        self._start, self._options = start, options
        self._state: State | None = None  # that the run was set to last
        self._changes: list[tuple[int, dict[str, float]]] = []  # of inputs and parameters, before each step, since then
        self._set: dict[str, float] = {}  # inputs and parameters that change in the next step
        self._ended: History | None = None
        self.on_look: Callable[[], object] | None = None  # before rows are overwritten
        with WARP_LOCK:
            self._begin(np.zeros(0), off_end=False)

    def _begin(self, turned: np.ndarray, *, off_end: bool) -> None:
        self.running = running = Running(
            self.scene, None, step=self.step_size, start=self._start, save_every=1, turned=turned, off_end=off_end,
            keeper=None, uneven=[], **self._options,
        )  # fmt: skip
        self._off_end, self._turned = off_end, turned
        self.engine = engine = running.engine
        self.inputs, self.parameters = engine.compiled.inputs, engine.compiled.parameters
        self._row: SavedRows | None = None  # of the present, if it is not in the ring
        self._carried: dict[str, np.ndarray]  # counts of steps since the last row that is kept
        self.stopped = bool(running.failed)  # after a failure: no further step can be made
        self._bind()
        if self.stopped:
            return
        if self._state is not None:
            self._put(self._state)
            return
        if isinstance(self._start, History):
            before = engine.checkpoint()
            engine.evaluate_here()
            engine.save_now()
            self._row = taken(engine.ring.on_host(), 0, range(int(engine.drained[0]) - 1, int(engine.drained[0])))
            engine.resume(before)
            engine.drained = engine.word("saved")
            engine.chunks[0] = [dict(self._row)]
            self._bind()
        self._count_from()

    def _bind(self) -> None:
        """Words of the device that a step writes and reads: on the CPU in place."""
        engine = self.engine
        self._graph: Any = engine.graph
        device = engine.compiled.device
        self._in_place = wp.get_device(device).is_cpu and replays_side_by_side(device)
        if self._in_place:
            self._words = words = engine.state.ctl.numpy()
            self._target, self._status, self._step = words["target"], words["status"], words["step"]
            self._time = engine.state.clk.numpy()["time"]
            self._ring = engine.ring.on_host()
            self._budget, self._more = engine.scratch.budget.numpy(), engine.scratch.more.numpy()

    def _count_from(self) -> None:
        """Rows from here on: of which step the next one is."""
        engine = self.engine
        self._saved = int(engine.word("saved")[0])
        self._first = int(engine.word("step")[0])
        self._origin = float(engine.word("start_time")[0])
        self.running.done, self.stopped = self._first, False
        self._looked, self._thinned, self._carried = 0, len(engine.chunks[0]), {}

    # --- the present

    @property
    def time(self) -> float:
        """The present time [s]."""
        return float(self._time[0]) if self._in_place else float(self.engine.word("time")[0])

    def rows(self, since: int) -> tuple[Mapping[str, np.ndarray], int]:
        """Rows from that number, if they are still in the ring, up to the present, and the number of the latter."""
        if self._row is not None:
            return self._row, self._saved - 1
        last = self._rows_saved() - 1
        first = min(max(since, last - LOOK, self._saved - 1), last)
        if not self._in_place:
            return taken(self.engine.ring.on_host(), 0, range(first, last + 1)), last
        return RingRows(self._ring, first, last), last

    def _rows_saved(self) -> int:
        return int(self._words["saved"][0]) if self._in_place else int(self.engine.word("saved")[0])

    def all_rows(self) -> SavedRows:
        """The rows of the run so far, thinned, and that of the present."""
        self._drain()
        chunks, last = [dict(chunk) for chunk in self.engine.chunks[0]], dict(self.rows(MOST_COUNTED)[0])
        if not chunks or chunks[-1]["saved_time"][-1] < last["saved_time"][-1]:
            chunks.append(last)
        return joined(chunks)

    # --- steps

    def set(self, name: str, value: float) -> None:
        """Let the input `name` reach `value` in the next step, or the parameter have it there."""
        if value != self.value(name):
            self._set[name] = value

    def value(self, name: str) -> float:
        """The value of an input or parameter, as it was set last."""
        if name in self._set:
            return self._set[name]
        inputs = self.inputs.values
        return inputs[name] if name in inputs else self.parameters.values[name]

    def step(self) -> bool:
        """Make one step; returns whether that succeeded."""
        self._pass_on()
        before = self.running.done
        if self._in_place:
            made = self._replay_in_place(before + 1)
            self.running.done = int(self._step[0])
        else:
            with WARP_LOCK:
                made = self._replay(before + 1)
                self.running.done = int(self.engine.word("step")[0])
        self._row = None
        self._looked += 1
        if made and self._looked < LOOK:
            return True
        # a failure may be none: created energy that is round-off
        return self.look() and (self.running.done > before or self.step())

    def advance(self, steps: int) -> bool:
        """Make so many steps in chunks, with the inputs as they are; returns whether that succeeded."""
        self._pass_on()
        target = self.running.done + steps
        with WARP_LOCK:
            while self.running.done < target:
                self._row = None
                try:
                    self.running.advance(min(target, self.running.done + LOOK))
                except (Outrun, OffEnd) as why:
                    self._begin_anew(why)
                except KeyboardInterrupt:
                    self.running.done = int(self.engine.word("step")[0])
                    raise
                if not self.look():
                    return False
        return True

    def _pass_on(self) -> None:
        """Let the inputs that were set change in the step that follows."""
        if self._set:
            self._change(self.running.done, self._set)
            self._set = {}

    def _change(self, at: int, values: dict[str, float]) -> None:
        """Set inputs in the step that begins after `at` user steps."""
        self._changes.append((at, values))
        begin = self._origin + self.step_size * at
        changed = {name: values[name] for name in values if name in self.parameters.values}
        if changed:
            state = self.engine.state
            gained = self.parameters.set(changed, lambda row: float(state.stretch.numpy()[0, row]))
            energy = state.energy.numpy().copy()
            energy[0, 0, [ENERGY_LINES.index(line) for line in ("potential", "force_work")]] += gained
            state.energy.assign(energy)
            values = {name: values[name] for name in values if name not in changed}
        if values:
            self.inputs.set(values, begin, self._origin + self.step_size * (at + 1))

    def _replay_in_place(self, target: int) -> bool:
        if self.engine.graph is not self._graph:  # more room was made
            self._bind()
        self._target[0] = target
        graph = self._graph.graph
        while self._step[0] < target:
            self._budget[0] = MOST_ATTEMPTS
            self._more[0] = 1
            wp.capture_launch(graph)
            if self._status[0]:
                with WARP_LOCK:
                    if not np.any(self.engine._relieve()):
                        return False
                self._bind()
                graph = self._graph.graph
        return True

    def _replay(self, target: int) -> bool:
        engine = self.engine
        engine.control(target=target)
        while int(engine.word("step")[0]) < target:
            engine._attempt(np.full(1, MOST_ATTEMPTS))
            if engine.word("status")[0]:
                return False
        return True

    def look(self) -> bool:
        """Drain the rows and watch the run; returns whether it goes on. Begins it anew where it has to."""
        self._looked = 0
        with WARP_LOCK:
            try:
                self._drain()
                self.running.look()
            except (Outrun, OffEnd) as why:
                self._begin_anew(why)
        self.stopped = self.running.over
        if self.on_look is not None:
            self.on_look()
        return not self.stopped

    def _begin_anew(self, why: Outrun | OffEnd) -> None:
        reached, changes = self.running.done, self._changes
        log.info("the run is begun anew, with the changes of its inputs at the same steps")
        turned, off_end = (why.turned, self._off_end) if isinstance(why, Outrun) else (self._turned, True)
        self._begin(turned, off_end=off_end)
        self._changes = []
        for at, values in [*changes, (reached, {})]:
            if at > self.running.done and not self.advance(at - self.running.done):
                return
            if values:
                self._change(at, values)

    # --- rows

    def _drain(self) -> None:
        """Move the rows saved since the last call out of the ring, and thin them."""
        engine = self.engine
        if self._in_place:
            saved, drained = self._rows_saved(), int(engine.drained[0])
            if saved > drained:
                engine.chunks[0].append(taken(self._ring, 0, range(drained, saved)))
                engine.drained = np.array([saved])
        else:
            with WARP_LOCK:
                engine.drain()
        self._thin()

    def _steps_of(self, rows: SavedRows, end: int) -> np.ndarray:
        """User steps of rows, the last of which has number `end` - 1; -1 of the first row of the run, which is kept."""
        numbers = np.arange(end - len(rows["saved_time"]), end)
        return np.where(numbers < self._saved, -1, self._first + numbers - self._saved + 1)

    def _thin(self) -> None:
        """Keep every `save_every`th of the rows drained last."""
        chunks = self.engine.chunks[0]
        if self.save_every == 1 or len(chunks) == self._thinned:
            self._thinned = len(chunks)
            return
        parts, end = chunks[self._thinned :], int(self.engine.drained[0])
        ends = end - np.cumsum([0, *(len(part["saved_time"]) for part in parts[:0:-1])])[::-1]
        kept = [self._kept(part, int(e)) for part, e in zip(parts, ends, strict=True)]
        chunks[self._thinned :] = [part for part in kept if len(part["saved_time"])]
        self._thinned = len(chunks)

    def _kept(self, rows: SavedRows, end: int) -> SavedRows:
        steps = self._steps_of(rows, end)
        keep = (steps < 0) | (steps % self.save_every == 0)
        found = {name: array[keep] for name, array in rows.items()}
        for names, total in ((SUMMED, np.add), (LARGEST, np.maximum)):
            for name in names:
                if name in rows:
                    found[name], self._carried[name] = _gathered(rows[name], keep, total, self._carried.get(name))
        return found

    # --- states

    def state(self) -> State:
        """Everything that the next steps depend on, and the row of the present."""
        row, _ = self.rows(MOST_COUNTED)
        with WARP_LOCK:
            return self.engine.checkpoint() | {ROW + name: array[-1:].copy() for name, array in row.items()}

    def put(self, state: Mapping[str, np.ndarray]) -> None:
        """Set the run to a `state`; its rows begin there. Raises `InputError`."""
        row = {name.removeprefix(ROW): np.asarray(a) for name, a in state.items() if name.startswith(ROW)}
        with WARP_LOCK:
            known = self.engine.ring.on_host()
        if set(known) - set(row) or any(row[name].shape != (1, *known[name].shape[2:]) for name in known):
            raise InputError("Simulation: state is none of a Simulation of this scene; set what sim.state has returned")
        with WARP_LOCK:
            if off_end_of(state) and not self._off_end:  # its cells are others
                self._state = None
                self._begin(self._turned, off_end=True)
            self._put(state)
        self._state = dict(state)
        self._changes, self._set = [], {}

    def _put(self, state: Mapping[str, np.ndarray]) -> None:
        engine, running = self.engine, self.running
        restore(engine, state, self.step_size, "Simulation: state")
        words = np.asarray(state["ctl"])
        if not words["status"][0]:
            engine.control(reason=int(words["reason"][0]), gaining_steps=int(words["gaining_steps"][0]))
        self._row = {name.removeprefix(ROW): np.asarray(a) for name, a in state.items() if name.startswith(ROW)}
        engine.chunks[0] = [dict(self._row)]
        running.gain, self._ended = "", None
        running.watch_from_here()
        self._bind()
        self._count_from()

    # --- the end, so far

    def history(self) -> History:
        """The History up to here; the run goes on as if it had not been asked for."""
        if self._ended is not None:
            return self._ended
        with WARP_LOCK:
            if self.running.failed:
                self._ended = self.running.finish()
                return self._ended
            self.look()
            found = self._so_far()
        if self.stopped:
            self._ended = found
        return found

    def _so_far(self) -> History:
        engine = self.engine
        kept, rows, drained = engine.checkpoint(), engine.chunks[0], engine.drained.copy()
        gain = self.running.gain
        engine.chunks[0] = [dict(chunk) for chunk in rows]
        if not self.stopped and self._row is None and self.running.done % self.save_every:
            last = dict(self.rows(MOST_COUNTED)[0])
            for name, total in self._carried.items():
                last[name] = total[None].copy()
            engine.chunks[0].append(last)
        try:
            self.running.judge_end()
            return self.running.so_far()
        finally:
            engine.resume(kept)
            engine.chunks[0], engine.drained, self.running.gain = rows, drained, gain


class RingRows(Mapping[str, np.ndarray]):
    """Rows from number `first` to `last`, as they are in the `ring`, each array when it is asked for."""

    def __init__(self, ring: SavedRows, first: int, last: int) -> None:
        self._ring, n = ring, ring["saved_time"].shape[1]
        begin, end = first % n, last % n + 1
        self._at: Any = slice(begin, end) if begin < end else np.arange(first, last + 1) % n

    def __getitem__(self, name: str) -> np.ndarray:
        return self._ring[name][0, self._at]

    def __iter__(self) -> Iterator[str]:
        return iter(self._ring)

    def __len__(self) -> int:
        return len(self._ring)


def _gathered(values: np.ndarray, keep: np.ndarray, total: Any, before: np.ndarray | None) -> tuple[Any, np.ndarray]:
    """`values` (T, ...) of rows gathered into those to `keep`, and what is left for the next one."""
    carried = np.zeros_like(values[0]) if before is None else before
    found = []
    for value, kept in zip(values, keep, strict=True):
        carried = total(carried, value)
        if kept:
            found.append(carried)
            carried = np.zeros_like(carried)
    return np.array(found, dtype=values.dtype).reshape(len(found), *values.shape[1:]), np.asarray(carried)
