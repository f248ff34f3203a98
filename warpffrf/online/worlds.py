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

Each run is a thread with the code of a single run, `online.run.run`, `online.run.find_equilibrium` or
`online.load_steps.run_static`, and its own `Place` in the shared engine: start, monitoring, notes and history are
those of the scene alone. One thread works at a time, except for the graph, which steps all worlds at once. A thread
ends with its run, after it has passed on what is wanted of the history.

Seats. The first scene that is compiled determines how many worlds fit into the free memory of the device
(`room_for_worlds`). Runs that come later than that end at once, without a result, and follow in another batch.
"""

from __future__ import annotations

import contextvars
import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
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
from warpffrf.online.local_modes import LocalModes
from warpffrf.online.room_for_worlds import worlds_that_fit
from warpffrf.online.settings import Settings
from warpffrf.online.step.graph import Parts
from warpffrf.online.step.launches import DECLARED
from warpffrf.online.step.program import Program
from warpffrf.online.warp_lock import WARP_LOCK
from warpffrf_kernels.core import control as k

OF_WORLDS = ("models", *(name for name, declared in DECLARED.items() if declared.axes[0] == "world"))


class SharedEngine(Engine):
    """The arrays and the graph of `scenes`, one per world, which must be of one kind."""

    def __init__(
        self,
        scenes: Sequence[CompiledScene],
        settings: Settings,
        integrator: Integrator | None,
        step_error: float | None,
        progress: bool,
    ) -> None:
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
    """World `world` of `shared`, as an engine of its scene alone; number: of its run in the company."""

    def __init__(self, shared: SharedEngine, world: int, company: Company, number: int) -> None:
        self.shared, self.world, self._company, self._number = shared, world, company, number
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
        seconds = self._company.attempt(self._number, budget)
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
    """State shared by the runs of the scenes `numbers`, each in its own thread. `meeting`: the barrier of these
    threads; progress: report the compilation of kernels, once for all; alike: a scene of another kind than the first
    raises `InputError` in all runs, otherwise in its own."""

    def __init__(self, numbers: Sequence[int], progress: bool, alike: bool) -> None:
        self.meeting = Meeting(numbers)
        self.count, self.progress, self.alike = len(numbers), progress, alike
        self.seats = 0  # worlds that fit into the memory, known from the first scene
        self.steps = 0  # user steps that all worlds have done
        self._taken = 0
        self._tables: Shared | None = Shared()
        self._engine: SharedEngine | None = None
        self._worlds: dict[int, int] = {}  # of the runs in the shared engine, by number
        self._others: dict[int, str] = {}  # what differs in scenes of other kinds, by number
        self._seconds = 0.0

    def engine_of(self, number: int) -> Callable[..., Engine]:
        """Creates the engine of a run in place of `Engine`, with the same options in all worlds; for a restarted run
        its own engine. Raises `NoSeat` in a run for which the memory does not suffice.
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
                self.meeting.leave(number)
                return Engine(
                    scene, device=device, settings=used, integrator=integrator, step_error=step_error,
                    local_modes=local_modes, turned=turned, off_end=off_end,
                )  # fmt: skip
            if self.seats and self._taken == self.seats:
                raise NoSeat
            compiled = compile_scene(
                scene, used, ready_device(device), local_modes, shared=self._tables, off_end=off_end
            )
            if not self.seats:
                self.seats = worlds_that_fit(compiled, used, integrator, step_error, self.count)
            self._taken += 1

            def build(scenes: dict[int, CompiledScene]) -> None:
                self._others = other_kinds(scenes)
                for difference in self._others.values() if self.alike else ():
                    raise InputError(difference)
                together = [n for n in sorted(scenes) if n not in self._others]
                self._engine = SharedEngine([scenes[n] for n in together], used, integrator, step_error, self.progress)
                self._worlds = {n: world for world, n in enumerate(together)}
                self._tables = None

            self.meeting.come(number, compiled, build)
            if number in self._others:
                raise InputError(self._others[number])
            return Place(self._built, self._worlds[number], self, number)

        return place

    @property
    def _built(self) -> SharedEngine:
        if self._engine is None:
            raise RuntimeError("the engine of all worlds is built when each has compiled its scene")
        return self._engine

    def attempt(self, number: int, budget: int) -> float:
        """Attempts of a run, together with those of all others that still run; returns the wall time [s]."""

        def attempt(budgets: dict[int, int]) -> None:
            self._seconds = self._built.attempt({self._worlds[n]: most for n, most in budgets.items()})
            self.steps = self._built.steps()

        self.meeting.come(number, budget, attempt)
        return self._seconds


Together = Callable[[dict[int, Any]], None]


class NoSeat(BaseException):
    """Raised in a run for which the memory does not suffice together with the others: it belongs to a later batch."""


class Ended(BaseException):
    """Raised in a run whose result is no longer needed, because another one has raised an error."""


class Meeting:
    """A barrier of threads with these numbers."""

    def __init__(self, numbers: Iterable[int]) -> None:
        self._changed = threading.Condition()
        self._coming = set(numbers)  # threads that will arrive again
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


def other_kinds(scenes: Mapping[int, CompiledScene]) -> dict[int, str]:
    """Those of `scenes`, by number, that are not of the kind of the first, and what differs."""
    lowest, *others = sorted(scenes)
    first, pattern = scenes[lowest], pattern_of(scenes[lowest])
    places = couplings(first)

    def sizes(compiled: CompiledScene) -> Sizes:
        return sizes_of(compiled, 1, 1, pattern, projected=False, adaptive=False)

    of_first, found = sizes(first), {}
    for i in others:
        own, here, there = scenes[i], f"scene {i}", f"scene {lowest}"
        difference = (
            _counts(own.scene, first.scene, here, there)
            or _axes(sizes(own), of_first, here, there)
            or _room(own, first, here, there)
        )
        unlike = [not np.array_equal(a, b) for a, b in zip(couplings(own), places, strict=True)]
        if not difference and any(unlike):
            difference = f"the {PLACES[unlike.index(True)]} of {here} are on other bodies than those of {there}"
        if difference:
            found[i] = f"{difference}; {CURE}"
    return found


def _counts(own: Scene, first: Scene, here: str, there: str) -> str:
    for one, name in KINDS.items():
        count, of_first = len(getattr(own, name)), len(getattr(first, name))
        if count != of_first:
            return f"{here} has {count} {one if count == 1 else _several(one)}, {there} has {of_first}"
    return ""


def _several(one: str) -> str:
    return f"{one[:-1]}ies" if one.endswith("y") else f"{one}s"


def _room(own: CompiledScene, first: CompiledScene, here: str, there: str) -> str:
    slots, of_first = own.model.capacity.slot_limit, first.model.capacity.slot_limit
    return (
        "" if slots == of_first else f"the contacts of {here} allow {slots} active nodes, those of {there} {of_first}"
    )


def _axes(own: Sizes, first: Sizes, here: str, there: str) -> str:
    for axis, count in own.items():
        if count != first[axis]:
            return f"{here} has {count} along '{axis}' ({NAMES[axis]}), {there} has {first[axis]}"
    return ""


LOOK = 0.2  # s between two updates of the progress of the runs

Run = Callable[[EngineOf], Any]


def side_by_side(runs: Sequence[Run], steps: int, *, progress: bool, alike: bool = True) -> list[Any]:
    """What `runs` return, called with the factory of their engines, in order; steps: of each, for the bar.

    Runs for which the memory does not suffice follow in further batches. A run that fails returns its History, and the
    others continue. alike: an error ends all: `InputError` starts with the number of the scene it belongs to; otherwise
    it is returned in place of the result, and the others continue. KeyboardInterrupt is passed to every run; it is
    raised if a run had not begun its steps.
    """
    found: list[Any] = [None] * len(runs)
    left = list(range(len(runs)))
    while left:
        left = _batch(runs, left, found, steps, progress, alike)
    return found


def _batch(
    runs: Sequence[Run], numbers: Sequence[int], found: list[Any], steps: int, progress: bool, alike: bool
) -> list[int]:
    """Runs as many of `numbers` as have room, which sets what is `found`; returns the others."""
    company = Company(numbers, progress, alike)
    errors: dict[int, BaseException] = {}
    later: list[int] = []

    def work(i: int) -> None:
        try:
            found[i] = runs[i](company.engine_of(i))
        except Ended:
            pass
        except NoSeat:
            later.append(i)
        except BaseException as error:
            if not alike and isinstance(error, Exception):
                found[i] = error
                return
            errors[i] = error
            company.meeting.end(KeyboardInterrupt if isinstance(error, KeyboardInterrupt) else Ended)
        finally:
            company.meeting.leave(i)

    threads = {
        i: threading.Thread(target=contextvars.copy_context().run, args=(work, i), name=f"world {i}", daemon=True)
        for i in numbers
    }
    bar = Progress("simulate", steps, enabled=progress)
    try:
        for thread in threads.values():
            thread.start()
        _wait(threads.values(), company, bar)
    except KeyboardInterrupt as interruption:
        company.meeting.end(KeyboardInterrupt)
        for i, thread in threads.items():
            if thread.ident is None:  # it never began, and the others wait for it
                errors[i] = interruption
                company.meeting.leave(i)
        _wait(threads.values(), company, bar)
    bar.close()
    if errors:
        i = min(errors)
        error = errors[i]
        if isinstance(error, InputError) and error is not company.meeting.error:
            raise InputError(f"scene {i}: {error}") from error
        raise error
    return sorted(later)


def _wait(threads: Iterable[threading.Thread], company: Company, bar: Progress) -> None:
    for thread in threads:
        while thread.is_alive():
            thread.join(LOOK)
            bar.update(company.steps)
