"""The step as a graph: recorded once, replayed until a chunk of steps is done.

One attempt of a step consists of: begin, predict, the Newton loop (evaluate, check the balance, condense, contact,
advance), optional projection of velocities and local error estimate, ledger, decision, commit or restore, record.
Parts that a scene does not have (contact, modes, inertia terms, rows, loads) record no kernel. Nothing runs on the host
while a graph replays.
"""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Sequence
from contextlib import nullcontext
from typing import Any

import numpy as np
import warp as wp

from warpffrf.online.arrays import Ring, Scratch, Sizes, State
from warpffrf.online.compile.retained_pattern import RetainedPattern, on_device
from warpffrf.online.compile.scene import CompiledScene, models_of
from warpffrf.online.step import phases
from warpffrf.online.step.modules import load
from warpffrf.online.step.program import Program
from warpffrf.online.warp_lock import WARP_LOCK, replays_side_by_side

STARTING = ("v_rate", "v_alg", "omega_rate", "omega_alg", "qd_rate", "qd_alg")


class Parts(ABC):
    """A step on the arrays of `program`: its parts, launched one by one, and many attempts of it."""

    def __init__(
        self, compiled: CompiledScene, state: State, scratch: Scratch, pattern: RetainedPattern, program: Program
    ) -> None:
        self.compiled, self.state, self.scratch, self.device = compiled, state, scratch, compiled.device
        self.pattern, self.program = pattern, program

    @abstractmethod
    def replay(self, budget: int | np.ndarray) -> float:
        """Attempt steps until every world has reached its target or failed, at most `budget` times each: one number for
        all worlds, or one per world. Returns the wall time [s]."""

    def evaluate(self) -> None:
        """Trial state of the increments, its unbalanced forces and rows, the diagonal of the tangent, gaps and contact
        forces."""
        self.program.run(phases.EVALUATION)

    def move_and_load(self) -> None:
        """The part of `evaluate` without contact."""
        self.program.run(phases.MOVE_AND_LOAD)

    def contact(self) -> None:
        """The contact part of `evaluate`."""
        self.program.run(phases.CONTACT)

    def displace(self) -> None:
        """Displacements by local modes due to the present contact pressures."""
        self.program.run(("displace",))

    def assemble(self) -> None:
        """The retained matrix and its right-hand side, from the last `evaluate`."""
        self.program.run(("assemble",))

    def iterate(self) -> None:
        """One Newton iteration: the linearised step, with the increments once the active set has converged."""
        self.program.run((*phases.EVALUATION, *phases.JUDGEMENT))
        running: Any = self.scratch.running
        wp.capture_if(running, lambda: self.program.run(phases.SOLUTION))

    def record(self) -> None:
        """Write the accepted state to the ring where `record` is set."""
        self.program.run(phases.RECORD)

    def commit(self) -> None:
        """Update the history with the last evaluation where `commit` is set."""
        self.program.run(("commit",))

    @property
    def remembers(self) -> bool:
        """Whether the scene has anything for `commit` to store."""
        return any(True for _ in phases.launches(self.program.parts["commit"], self.program.sizes))

    def open_books(self) -> None:
        """Set the initial energies of the ledger to those of the last evaluated state, in every world."""
        words = self.state.ctl.numpy().copy()
        words["attempt"] = 1
        self.state.ctl.assign(words)
        self.program.run(("book",))
        words["attempt"] = 0
        self.state.ctl.assign(words)
        lines = self.state.energy.numpy().copy()
        lines[:, 0] = lines[:, 1]
        self.state.energy.assign(lines)

    def stand_still(self) -> None:
        """Prepare an evaluation outside an attempt: keep the accelerations, mark no pair as impulsive."""
        s, x = self.state, self.scratch
        if self.compiled.model.pairs.count:
            for name in STARTING:
                getattr(x, name + "0").assign(getattr(s, name))
            s.impulsive.zero_()
            x.weight.fill_(1.0)


class StepGraph(Parts):
    """Records the loop over attempts on a device; `replay(budget)` runs it. `worlds`: the scene of each world."""

    def __init__(
        self,
        worlds: Sequence[CompiledScene],
        sizes: Sizes,
        state: State,
        ring: Ring,
        scratch: Scratch,
        pattern: RetainedPattern,
        *,
        progress: bool = False,
    ) -> None:
        self.pattern_struct, patterns = on_device(pattern, worlds[0].device)
        self.models = models_of(worlds)
        constants: dict[str, object] = {"models": self.models, "patterns": patterns}
        program = Program(worlds[0], sizes, (state, ring, scratch), constants)
        super().__init__(worlds[0], state, scratch, pattern, program)
        load((launch.kernel.module for launch in self.program.launches()), self.device, progress=progress)
        self.graph: Any = self._recorded()

    def replay(self, budget: int | np.ndarray) -> float:
        """Run the graph."""
        begin = time.perf_counter()
        self.scratch.budget.assign(np.full(self.state.ctl.shape, budget, dtype=np.int32) + 1)
        self.program.run(("count",))
        with WARP_LOCK.left() if replays_side_by_side(self.device) else nullcontext():
            self._run()
        if wp.get_device(self.device).is_cuda:
            wp.synchronize_device(self.device)
        return time.perf_counter() - begin

    def _run(self) -> None:
        wp.capture_launch(self.graph)

    # --- recording

    def _recorded(self) -> Any:
        """The graph of the loop over attempts."""
        with wp.ScopedCapture(device=self.device) as capture:
            self._loop()
        return capture.graph

    def _loop(self) -> None:
        more: Any = self.scratch.more
        wp.capture_while(more, self._attempt)

    def _attempt(self) -> None:
        self.program.run(phases.ATTEMPT)
        running: Any = self.scratch.running
        running.fill_(1)
        wp.capture_while(running, self.iterate)
        self.program.run(phases.DECISION)


class LaunchByLaunch(StepGraph):
    """The same loop, one launch after another, for profiles and checks of single launches."""

    def _recorded(self) -> None:
        pass

    def _run(self) -> None:
        self._loop()
