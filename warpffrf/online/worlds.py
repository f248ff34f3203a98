"""Many scenes in one graph, each with the results of a single run.

Engines. One shared engine for many scenes, and one engine per scene that is a view of a world of the shared one.

`SharedEngine` has the arrays and the graph of all worlds. A `Place` is the engine of one scene: its arrays are views
of the shared ones (`online.arrays.views`), on which it launches the individual parts of a step that a run requires.
Only attempts of steps, which take most of the time, are made for all worlds at once: a thread that replays
waits for the others (`Meeting`), each with its own number of attempts. A world that has reached its
target, or has failed, takes no part in an attempt, so its state is unaffected by the other worlds.

A run in a place is therefore bit for bit the run of that scene alone on the CPU: kernels treat a world independently of
the others. The capacity of active nodes (`Engine.make_room`) is enlarged for all worlds if one exceeds it.

Meeting. A barrier: each thread waits until all others have arrived.

Each run is a thread with the code of a single run. For a replay of the common graph it arrives at the barrier and
releases the lock (`warpffrf.online.warp_lock`) until all threads still running have arrived; the last one replays
for all. Between two barriers the threads run one at a time, as Warp requires.

Same kind. Whether scenes fit into one graph: they may differ in numbers, not in structure.

One graph launches the same kernels over the same axes in every world, so everything with an axis must have the same
count in all scenes. The elimination order of the retained matrix is common, so joints, contacts and films must
connect the same bodies. The capacity of active nodes is equal in all worlds; it grows up to the limit of the contacts,
which must be equal in all scenes, so that no world has more than in a single run. All other data are read from the
tables of each world's own scene.

Side by side. Simultaneous runs of many scenes in the worlds of one engine.

Each run is a thread with the code of a single run, `online.run.run` or `online.load_steps.run_static`, and
its own `Place` in the shared engine: start, monitoring, notes and history are
those of the scene alone. One thread works at a time, except for the graph, which steps all worlds at once.
"""

from __future__ import annotations

import contextvars
import threading
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.integrators import Integrator
from warpffrf.model.messages.progress import Progress
from warpffrf.model.scene import Scene
from warpffrf.online.arrays.axes import NAMES, Sizes, sizes_of
from warpffrf.online.arrays.views import OnHost, Views, part
from warpffrf.online.compile.constants import Shared
from warpffrf.online.compile.retained_pattern import couplings, pattern_of
from warpffrf.online.compile.scene import CompiledScene, compile_scene
from warpffrf.online.engine import NO_ATTEMPT, Engine, EngineOf, ready_device
from warpffrf.online.history.history import History
from warpffrf.online.local_modes import LocalModes
from warpffrf.online.settings import Settings
from warpffrf.online.step.graph import Parts
from warpffrf.online.step.launches import DECLARED
from warpffrf.online.step.program import Program
from warpffrf.online.warp_lock import WARP_LOCK
from warpffrf_kernels.core import control as k

OF_WORLDS = ("models", *(name for name, declared in DECLARED.items() if declared.axes[0] == "world"))


class SharedEngine(Engine):
    """The arrays and the graph of `scenes`, one per world. Raises `InputError` if they differ in structure."""

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
        self.rooms = 0  # number of enlargements, each of which reallocates scratch arrays

    def make_room(self, slots: int) -> bool:
        """As of any engine."""
        scratch = self.scratch
        found = super().make_room(slots)
        self.rooms += self.scratch is not scratch
        return found

    def attempt(self, budgets: Mapping[int, int]) -> float:
        """Make at most the given number of attempts in each world, none without a number, and enlarge the capacity on
        request; returns the wall time [s]."""
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
        """Views of the present arrays of the shared engine."""
        shared = self.shared
        self._rooms = shared.rooms
        whole = shared.graph.program
        self._views.see(whole.arrays)
        self._graph = _Together(self, whole.on(self._views, self._sizes()))

    @property
    def graph(self) -> _Together:
        """The parts of a step in this place; the caller may change the arrays."""
        self._views.touched = True
        return self._graph

    def make_room(self, slots: int) -> bool:
        """For all worlds."""
        found = self.shared.make_room(slots)
        self.after_others()
        return found

    def after_others(self) -> None:
        """Adopt the changes that the shared engine has made for all worlds."""
        if self._rooms != self.shared.rooms:
            self._sit_down()
        if self.world in self.shared.no_room:
            self.no_room = {0: self.shared.no_room[self.world]}

    def _relieve(self) -> np.ndarray:
        """Done by the shared engine."""
        return np.zeros(1, dtype=bool)

    def attempt(self, budget: int) -> float:
        """Make at most the given number of attempts, with those of the other worlds; returns the wall time [s] of
        all."""
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
    """State shared by the runs of `count` scenes, each in its own thread. `meeting`: the barrier of these threads;
    progress: report the compilation of kernels, once for all."""

    def __init__(self, count: int, progress: bool) -> None:
        self.meeting = Meeting(count)
        self.progress = progress
        self.steps = 0  # user steps that all worlds have done
        self._tables: Shared | None = Shared()
        self._engine: SharedEngine | None = None
        self._seconds = 0.0

    def engine_of(self, world: int) -> Callable[..., Engine]:
        """Creates the engine of a run in place of `Engine`, with the same options in all worlds; for a restarted run
        its own engine.
        """

        def place(
            scene: Scene,
            *,
            device: str | None = None,
            settings: Settings | None = None,
            integrator: Integrator | None = None,
            step_error: float | None = None,
            local_modes: LocalModes | None = None,
            turned: Sequence[float] | np.ndarray = (),
            off_end: bool = False,
            progress: bool = False,
        ) -> Engine:
            used = settings or Settings()
            # the run is restarted with other inertia terms or cells, so that its structure differs
            if self._tables is None:
                self.meeting.leave(world)
                return Engine(
                    scene, device=device, settings=used, integrator=integrator, step_error=step_error,
                    local_modes=local_modes, turned=turned, off_end=off_end,
                )  # fmt: skip
            compiled = compile_scene(
                scene, used, ready_device(device), local_modes, shared=self._tables, off_end=off_end
            )

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


Together = Callable[[dict[int, Any]], None]


class Ended(BaseException):
    """Raised in a run whose result is no longer needed, because another one has raised an error."""


class Meeting:
    """A barrier of `count` threads, numbered from 0."""

    def __init__(self, count: int) -> None:
        self._changed = threading.Condition()
        self._coming = set(range(count))  # threads that will arrive again
        self._brought: dict[int, Any] = {}
        self._together: Together | None = None
        self._held = 0  # barriers so far
        self.error: BaseException | None = None  # of the last one
        self._ends: type[BaseException] | None = None

    def come(self, number: int, brings: Any, together: Together) -> None:
        """Wait for the others; the last to arrive calls `together` with the contribution of each, by number. Its errors
        are raised in all threads. The thread holds the lock before and after."""
        with self._changed:
            self._raise_end()
            self._brought[number], self._together = brings, together
            held = self._held
            last = len(self._brought) == len(self._coming)
        if last:
            self._hold()
        else:
            with WARP_LOCK.left(), self._changed:
                self._changed.wait_for(lambda: self._held > held)
        self._raise_end()
        if self.error is not None:
            raise self.error

    def leave(self, number: int) -> None:
        """This thread no longer arrives; if all others wait for it, they proceed now. Called without the lock."""
        with WARP_LOCK:
            with self._changed:
                self._coming.discard(number)
                last = bool(self._brought) and len(self._brought) == len(self._coming)
            if last:
                self._hold()

    def end(self, how: type[BaseException]) -> None:
        """From now on each thread that arrives at the barrier or is released from it raises `how`, once per barrier."""
        with self._changed:
            self._ends = how

    def _raise_end(self) -> None:
        if self._ends is not None:
            raise self._ends

    def _hold(self) -> None:
        """Call `together` and release all threads; the caller has the lock."""
        together, brought = self._together, self._brought
        self._brought, self.error = {}, None
        try:
            if together is not None and self._ends is None:
                together(brought)
        except BaseException as error:
            self.error = error
        with self._changed:
            self._held += 1
            self._changed.notify_all()


PLACES = (
    "modes with inertia",
    "joints and forces",
    "flexible interfaces",
    "contacts",
    "films and small-sliding contacts",
)  # `couplings`
KINDS = {
    "body": "bodies", "joint": "joints", "drive": "drives", "force": "forces", "contact": "contacts",
    "lumped contact": "lumped_contacts", "film": "films",
}  # fmt: skip
CURE = "worlds of one graph differ in numbers only; run this scene by itself"


def refuse_other_kinds(scenes: Sequence[CompiledScene]) -> None:
    """Raises `InputError` for the first of `scenes` that is not of the kind of scene 0."""
    first, pattern = couplings(scenes[0]), pattern_of(scenes[0])
    sizes = [sizes_of(compiled, 1, 1, pattern, projected=False, adaptive=False) for compiled in scenes]
    for i, (compiled, own) in enumerate(zip(scenes, sizes, strict=True)):
        difference = (
            _counts(compiled.scene, scenes[0].scene, i) or _axes(own, sizes[0], i) or _room(compiled, scenes[0], i)
        )
        if not difference:
            unlike = [not np.array_equal(a, b) for a, b in zip(couplings(compiled), first, strict=True)]
            if any(unlike):
                difference = f"the {PLACES[unlike.index(True)]} of scene {i} are on other bodies than those of scene 0"
        if difference:
            raise InputError(f"{difference}; {CURE}")


def _counts(scene: Scene, first: Scene, i: int) -> str:
    for one, name in KINDS.items():
        here, there = len(getattr(scene, name)), len(getattr(first, name))
        if here != there:
            return f"scene {i} has {here} {one if here == 1 else _several(one)}, scene 0 has {there}"
    return ""


def _several(one: str) -> str:
    return f"{one[:-1]}ies" if one.endswith("y") else f"{one}s"


def _room(own: CompiledScene, first: CompiledScene, i: int) -> str:
    here, there = own.model.capacity.slot_limit, first.model.capacity.slot_limit
    return "" if here == there else f"the contacts of scene {i} allow {here} active nodes, those of scene 0 {there}"


def _axes(own: Sizes, first: Sizes, i: int) -> str:
    for axis, count in own.items():
        if count != first[axis]:
            return f"scene {i} has {count} along '{axis}' ({NAMES[axis]}), scene 0 has {first[axis]}"
    return ""


LOOK = 0.2  # s between two updates of the progress of the runs

Run = Callable[[EngineOf], History]


def side_by_side(runs: Sequence[Run], steps: int, *, progress: bool) -> list[History]:
    """The histories of `runs`, called with the factory of their engines, in order; steps: of each, for the bar.

    A run that fails returns its History, and the others continue. An error ends all: `InputError` starts with the
    number of the scene it belongs to. KeyboardInterrupt is passed to every run; it is raised if a
    run had not begun its steps.
    """
    company = Company(len(runs), progress)
    found: list[History | None] = [None] * len(runs)
    errors: dict[int, BaseException] = {}

    def work(i: int) -> None:
        try:
            found[i] = runs[i](company.engine_of(i))
        except Ended:
            pass
        except BaseException as error:
            errors[i] = error
            company.meeting.end(KeyboardInterrupt if isinstance(error, KeyboardInterrupt) else Ended)
        finally:
            company.meeting.leave(i)

    threads = [
        threading.Thread(target=contextvars.copy_context().run, args=(work, i), name=f"world {i}", daemon=True)
        for i in range(len(runs))
    ]
    bar = Progress("simulate", steps, enabled=progress)
    try:
        for thread in threads:
            thread.start()
        _wait(threads, company, bar)
    except KeyboardInterrupt as interruption:
        company.meeting.end(KeyboardInterrupt)
        for i, thread in enumerate(threads):
            if thread.ident is None:  # it never began, and the others wait for it
                errors[i] = interruption
                company.meeting.leave(i)
        _wait(threads, company, bar)
    bar.close()
    if errors:
        i = min(errors)
        error = errors[i]
        if isinstance(error, InputError) and error is not company.meeting.error:
            raise InputError(f"scene {i}: {error}") from error
        raise error
    return [history for history in found if history is not None]


def _wait(threads: Sequence[threading.Thread], company: Company, bar: Progress) -> None:
    for thread in threads:
        while thread.is_alive():
            thread.join(LOOK)
            bar.update(company.steps)
