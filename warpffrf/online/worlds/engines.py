"""One engine for many scenes, and for each of them an engine of its own: its place in that one.

`SharedEngine` has the arrays and the graph of all worlds. A `Place` has what an engine of its scene alone has, as views
on the arrays of the shared one (`online.arrays.views`), on which it launches the parts of a step that a run asks for on
the way. Only attempts of steps, which are where a run spends its time, are made for all worlds at once: whoever replays
waits until the others do (`online.worlds.meeting`), each with its own number of attempts. A world that has reached its
target, or has failed, takes no part in an attempt, so what others go on with does not touch it.

So a run in a place is the run of that scene alone, with the same bits on the CPU: kernels do the same for a world,
whatever others there are. Room for hats in play (`Engine.make_room`) is made for all worlds where one is short of it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from warpffrf.model.integrators import Integrator
from warpffrf.model.scene import Scene
from warpffrf.online.arrays.views import OnHost, Views, part
from warpffrf.online.compile.constants import Shared
from warpffrf.online.compile.scene import CompiledScene, compile_scene
from warpffrf.online.engine import NO_ATTEMPT, Engine, ready_device
from warpffrf.online.local_dynamics import LocalDynamics
from warpffrf.online.settings import Settings
from warpffrf.online.step.graph import Parts
from warpffrf.online.step.launches import DECLARED
from warpffrf.online.step.program import Program
from warpffrf.online.worlds.meeting import Meeting
from warpffrf.online.worlds.same_kind import refuse_other_kinds
from warpffrf_kernels.core import control as k

OF_WORLDS = ("models", *(name for name, declared in DECLARED.items() if declared.axes[0] == "world"))


class SharedEngine(Engine):
    """The arrays and the graph of `scenes`, one a world. Raises `InputError` where they differ by more than numbers."""

    def __init__(
        self,
        scenes: Sequence[CompiledScene],
        settings: Settings,
        integrator: Integrator | None,
        step_error: float | None,
        progress: bool,
    ) -> None:
        refuse_other_kinds(scenes)
        self._begin(scenes, settings, integrator, step_error, progress)
        self.on_host = OnHost()
        self.rooms = 0  # times that there was made more room, which makes scratch arrays anew

    def make_room(self, slots: int) -> bool:
        """As of any engine."""
        scratch = self.scratch
        found = super().make_room(slots)
        self.rooms += self.scratch is not scratch
        return found

    def attempt(self, budgets: Mapping[int, int]) -> float:
        """At most so many attempts in each world, none where there is no number, and more room where one asks for it;
        returns the wall time [s]."""
        each = np.full(self.worlds, NO_ATTEMPT)
        each[list(budgets)] = list(budgets.values())
        seconds = self._attempt(each)
        self.on_host.forget()
        return seconds

    def steps(self) -> int:
        """User steps that all worlds have done."""
        words = self.on_host.array(self.state.ctl)
        return int(np.where(np.isin(words["mode"], (int(k.DYNAMIC), int(k.LOADING))), words["step"], 0).min())


class Place(Engine):
    """World `world` of `shared`, as an engine of its scene alone."""

    def __init__(self, shared: SharedEngine, world: int, company: Company) -> None:
        self.shared, self.world, self._company = shared, world, company
        self.settings, self._progress = shared.settings, False
        self.compiled = shared.scenes[world]
        self.scenes, self.worlds, self.scene = [self.compiled], 1, self.compiled.scene
        self._integrator, self._step_error, self._projected = shared._integrator, shared._step_error, shared._projected
        self._pattern = shared._pattern
        self._views = views = Views(self.world, shared.worlds, OF_WORLDS, shared.on_host)
        self.state, self.ring = part(shared.state, views), part(shared.ring, views)
        self.scratch = part(shared.scratch, views)
        self._sit_down()
        self._open_books()

    def _sit_down(self) -> None:
        """Views on the arrays of the shared engine as they are now."""
        shared = self.shared
        self._rooms = shared.rooms
        whole = shared.graph.program
        self._views.see(whole.arrays)
        self._graph = _Together(self, whole.on(self._views, self._sizes()))

    @property
    def graph(self) -> _Together:
        """The parts of a step in this place; who asks for them may change the arrays."""
        self._views.touched = True
        return self._graph

    def make_room(self, slots: int) -> bool:
        """For all worlds."""
        found = self.shared.make_room(slots)
        self.after_others()
        return found

    def after_others(self) -> None:
        """Take up what the shared engine has done for all worlds."""
        if self._rooms != self.shared.rooms:
            self._sit_down()
        if self.world in self.shared.no_room:
            self.no_room = {0: self.shared.no_room[self.world]}

    def _relieve(self) -> np.ndarray:
        """The shared engine has done it."""
        return np.zeros(1, dtype=bool)

    def attempt(self, budget: int) -> float:
        """At most so many attempts, beside those of the other worlds; returns the wall time [s] of all."""
        seconds = self._company.attempt(self.world, budget)
        self._views.touched = False
        self.after_others()
        return seconds


class _Together(Parts):
    """The parts of a step in one place, and attempts that wait for the others."""

    def __init__(self, place: Place, program: Program) -> None:
        super().__init__(place.compiled, place.state, place.scratch, place._pattern, program)
        self._place = place

    def replay(self, budget: int | np.ndarray) -> float:
        """Attempt steps until the world has reached its target or failed, at most `budget` times."""
        return self._place.attempt(int(np.max(budget)))


class Company:
    """What the runs of `count` scenes, each in a thread of its own, make together. `meeting`: of these threads;
    progress: show that kernels are compiled, once for all."""

    def __init__(self, count: int, progress: bool) -> None:
        self.meeting = Meeting(count)
        self.progress = progress
        self.steps = 0  # user steps that all worlds have done
        self._tables: Shared | None = Shared()
        self._engine: SharedEngine | None = None
        self._seconds = 0.0

    def engine_of(self, world: int) -> Callable[..., Engine]:
        """What makes the engine of a run in place of `Engine`, with the same options in all worlds; of a run that
        begins anew an engine of its own."""

        def place(
            scene: Scene,
            *,
            device: str | None = None,
            settings: Settings | None = None,
            integrator: Integrator | None = None,
            step_error: float | None = None,
            local: LocalDynamics | None = None,
            turned: Sequence[float] | np.ndarray = (),
            off_end: bool = False,
            progress: bool = False,
        ) -> Engine:
            used = settings or Settings()
            if self._tables is None:  # the run begins anew with other inertia terms or cells: it is of another kind now
                self.meeting.leave(world)
                return Engine(
                    scene, device=device, settings=used, integrator=integrator, step_error=step_error, local=local,
                    turned=turned, off_end=off_end,
                )  # fmt: skip
            compiled = compile_scene(scene, used, ready_device(device), local, shared=self._tables, off_end=off_end)

            def build(scenes: dict[int, CompiledScene]) -> None:
                in_order = [scenes[w] for w in sorted(scenes)]
                self._engine = SharedEngine(in_order, used, integrator, step_error, self.progress)
                self._tables = None

            self.meeting.come(world, compiled, build)
            return Place(self._built, world, self)

        return place

    @property
    def _built(self) -> SharedEngine:
        if self._engine is None:
            raise RuntimeError("the engine of all worlds is built when each has compiled its scene")
        return self._engine

    def attempt(self, world: int, budget: int) -> float:
        """Attempts of a world, together with those of all others that still run; returns the wall time [s]."""

        def attempt(budgets: dict[int, int]) -> None:
            self._seconds = self._built.attempt(budgets)
            self.steps = self._built.steps()

        self.meeting.come(world, budget, attempt)
        return self._seconds
