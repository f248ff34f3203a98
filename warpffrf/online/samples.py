r"""Intermediate states of a run, from which parts of it can be repeated with another step.

A run of up to `WHOLE` steps stores `FEW` equidistant states, a longer one `SAMPLES`. They stay in memory with the
`History` and are not written to files. `Samples.again` creates a new engine: without a repetition the only cost is that
of the copies.

**Another step from a state in the middle of a run.** In a smooth motion x(t) the velocities and algorithmic
accelerations of the generalized-alpha method are not those of x, but off by a constant times the step. With v_n = x' +
c h^2 x''' and a_n = x'' + d h x''', the update of velocities and that of positions (`model.integrators`) give, order by
order in h,

    d = 1/2 - gamma = alpha_m - alpha_f,        c = 1/6 - beta - d/2.

A state continued with h_2 instead of h is corrected by c (h_2^2 - h^2) x''' and d (h_2 - h) x'''; otherwise it would
jump: the positions of a driven mechanism are prescribed, so its reactions would alternate. x''' is the difference of
the accelerations over the first step of the run from there. The first state of a run from rest or from given velocities
has the exact velocities and is not corrected.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.scene import Scene
from warpffrf.online.arrays.ring import SavedRows
from warpffrf.online.checkpoint import restore
from warpffrf.online.engine import Engine
from warpffrf.online.history.history import History
from warpffrf.online.history.record import history_from_rows

WHOLE = 4000  # steps, up to which a run is repeated as a whole
FEW, SAMPLES = 32, 100  # states of such a run, and of a longer one
MOST_BYTES = 64e6  # of them
COARSER, FINER = 2, 4  # times the step of the run, parts of it
ROUGHER = float(COARSER**3)  # factor of the allowed error of a step: local errors grow with h^3
MOST_ATTEMPTS = 4  # per user step, in one replay: more follow where steps are halved

Array = np.ndarray
State = Mapping[str, Array]


@dataclass(frozen=True)
class Again:
    """A part of a run, `begin` to `end` in its user steps, once more with `COARSER` times the step: `coarse`, and with
    the step itself: `fine`, None where that is the whole run, whose rows there are. `times`: (T,) s of the rows of
    `coarse`."""

    begin: int
    end: int
    fine: History | None
    coarse: History


class Samples:
    """States of a run of user steps `first` to `last` of `step` [s]; `options`: what its `Engine` was made with;
    `static`: of a static run, which leaves none."""

    def __init__(
        self, engine: Engine, options: Mapping[str, Any], step: float, first: int, last: int, *, static: bool = False
    ) -> None:
        self.scene: Scene = engine.scene
        self.static = static
        self.options, self.step, self.first, self.last = dict(options), step, first, last
        size = sum(array.nbytes for array in engine.state.to_numpy().values())
        count = int(np.clip(MOST_BYTES // size, 1, FEW if self.whole else SAMPLES))
        self.inputs = engine.compiled.inputs.checkpoint()
        self.steps = np.unique(np.linspace(first, last, count + 1).astype(int))
        self.states: dict[int, State] = {}

    @property
    def whole(self) -> bool:
        """Whether the run is short enough to be stepped again as a whole."""
        return self.last - self.first <= WHOLE

    def until(self, target: int, done: int) -> int:
        """The next step to stop at after `done`: `target`, or an earlier mark."""
        ahead = self.steps[self.steps > done]
        return min(target, int(ahead[0])) if len(ahead) else target

    def look(self, engine: Engine, done: int) -> None:
        """Store the state if a mark is reached, except the last."""
        if done in self.steps[:-1] and not np.any(engine.word("status")):
            self.states[done] = engine.state.to_numpy()

    def windows(self, reached: int) -> list[tuple[int, int]]:
        """Parts of a run up to user step `reached`, between samples."""
        ends = np.append(self.steps[(self.steps < reached)], reached)
        return [(int(a), int(b)) for a, b in zip(ends[:-1], ends[1:], strict=True) if int(a) in self.states]

    def engine(self) -> Engine:
        """A new engine of the run."""
        engine = Engine(self.scene, **self.options)
        engine.compiled.inputs.resume(self.inputs)
        return engine

    def again(self, engine: Engine, begin: int, end: int) -> Again | None:
        """Repeat user steps `begin` to `end`, an even number; None if they fail with the longer step."""
        state, pairs = self.states[begin], (end - begin) // COARSER
        fresh = begin == 0 and not np.any(state["ctl"]["steps"])
        step_error = engine.scratch.step_error.numpy()
        fine = None
        if not (fresh and self.whole):
            rows = _rows(engine, state, self.step, 1 if self.whole else COARSER * pairs)
            if rows is None:
                return None
            fine = None if self.whole else history_from_rows(engine.compiled, rows)
            state = state if fresh else other_step(engine, state, rows, self.step, COARSER)
        engine.scratch.step_error.assign(ROUGHER * step_error)
        rows = _rows(engine, state, COARSER * self.step, pairs)
        engine.scratch.step_error.assign(step_error)
        if rows is None:
            return None
        return Again(begin, begin + COARSER * pairs, fine, history_from_rows(engine.compiled, rows))

    def finer(self, engine: Engine, begin: int, steps: int) -> tuple[History, History] | None:
        """`steps` user steps from `begin` once more, and with a `FINER`th of the step, at the same times; None where
        one of them fails."""
        state = self.states[begin]
        own = _rows(engine, state, self.step, steps)
        if own is None:
            return None
        if begin or np.any(state["ctl"]["steps"]):
            state = other_step(engine, state, own, self.step, 1.0 / FINER)
        finer = _rows(engine, state, self.step / FINER, FINER * steps, FINER)
        if finer is None:
            return None
        return history_from_rows(engine.compiled, own), history_from_rows(engine.compiled, finer)


def other_step(engine: Engine, state: State, rows: SavedRows, step: float, ratio: float) -> dict[str, Array]:
    """`state` of a run with `step` [s], whose next step is the first of `rows`, for steps `ratio` times as long."""
    alpha_m, alpha_f, beta, _ = engine.scratch.coefficients.numpy()[0]
    ahead = alpha_m - alpha_f
    late = 1.0 / 6.0 - beta - 0.5 * ahead
    found = dict(state)
    for name in ("v", "omega", "qd"):
        jerk = (rows[f"saved_{name}_rate"][0] - state[f"{name}_rate"]) / step
        found[name] = state[name] + late * (ratio**2 - 1.0) * step**2 * jerk
        found[f"{name}_alg"] = state[f"{name}_alg"] + ahead * (ratio - 1.0) * step * jerk
    return found


def _rows(engine: Engine, state: State, step: float, steps: int, every: int = 1) -> SavedRows | None:
    """Each `every`th of the rows of `steps` user steps of `step` [s] from `state`, without the state itself; None where
    they fail."""
    engine.chunks = [[] for _ in range(engine.worlds)]
    done = restore(engine, state, step)
    engine.control(every=every, level=int(state["ctl"]["level"][0]))
    end = done + steps
    while done < end:
        target = min(done + engine.settings.ring_rows - 1, end)
        engine.control(target=target)
        engine.replay(MOST_ATTEMPTS * (target - done))
        done = int(engine.word("step").min())
        if np.any(engine.word("status")):
            return None
    return engine.saved()
