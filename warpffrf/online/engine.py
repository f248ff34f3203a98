"""A scene on a device: arrays, step graph, control words and the phases of a run."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import warp as wp

from warpffrf.model.errors import InputError
from warpffrf.model.integrators import GeneralizedAlpha, Integrator
from warpffrf.model.scene import Scene
from warpffrf.online.arrays import Ring, Sizes, initial_motion, initial_state, sizes_of
from warpffrf.online.arrays.ring import SavedRows, joined, taken
from warpffrf.online.arrays.scratch import KEPT, KEPT_OF_PATCHES, scratch_for
from warpffrf.online.compile.patches.plan import PatchPlan
from warpffrf.online.compile.retained_pattern import pattern_of
from warpffrf.online.compile.scene import CompiledScene, compile_scene, enlarge
from warpffrf.online.device import chosen_device
from warpffrf.online.local_modes import LocalModes
from warpffrf.online.settings import Settings
from warpffrf.online.step import kernel_cache
from warpffrf.online.step.graph import Parts, StepGraph
from warpffrf.online.warp_lock import WARP_LOCK
from warpffrf.online.warp_start import start_warp
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.declaration import DeviceArray
from warpffrf_kernels.matched.status_words import AHEAD, ANEW, HELD, NONE, READY

ROOM_GROWTH = 2  # of the node capacity, each time it is exceeded
OF_AN_ATTEMPT = ("attempt", "accept", "record")  # words of `Control` reset to zero before each attempt
NO_ATTEMPT = -1  # for a world that takes no part in the attempt
EngineOf = Callable[..., "Engine"]
"""Creates the engine of a run, with the scene and the options of `Engine`."""
NOT_KEPT = (
    "what contact-fixed cells keep from step to step is not in the checkpoint, or does not fit: the run "
    "goes on to the tolerance of the iteration, not bit for bit"
)
OFF_END = "off_end"  # in a checkpoint: cells cover patches of crowns that run off an end
KEPT_MARK = "kept_"  # prefix of arrays in a checkpoint that are not part of the state


def ready_device(named: str | None) -> str:
    """The device of that name, with Warp initialised and remains of an interrupted compilation removed."""
    if start_warp():
        kernel_cache.remove_unfinished()
    return chosen_device(named)


class Engine:
    """A scene on a device in `worlds` copies, ready to step. With several threads, the caller must hold `WARP_LOCK`."""

    @WARP_LOCK
    def __init__(
        self,
        scene: Scene,
        *,
        worlds: int = 1,
        device: str | None = None,
        settings: Settings | None = None,
        integrator: Integrator | None = None,
        step_error: float | None = None,
        local_modes: LocalModes | None = None,
        patches: Mapping[int, PatchPlan] | None = None,
        turned: Sequence[float] | np.ndarray = (),
        off_end: bool = False,
        progress: bool = False,
    ) -> None:
        """`patches`: the cells of contact-fixed grids, by contact number; None: as the contacts specify.
        `turned`: the largest angular speed of each body [rad/s] so far, also used to select inertia "auto".
        `off_end`: patches of crowns run off an end, see `PatchPlan.of`.
        `device`: None for the default (`chosen_device`). `progress`: a bar during kernel compilation; the other options
        as `online.run`."""
        settings = settings or Settings()
        compiled = compile_scene(
            scene, settings, ready_device(device), local_modes, patches, turned=turned, off_end=off_end
        )
        self._begin([compiled] * worlds, settings, integrator, step_error, progress)

    def _begin(
        self,
        scenes: Sequence[CompiledScene],
        settings: Settings,
        integrator: Integrator | None,
        step_error: float | None,
        progress: bool,
    ) -> None:
        """Arrays and graph of `scenes`, one per world."""
        self.settings, self.scenes, self.worlds = settings, list(scenes), len(scenes)
        self.compiled = scenes[0]
        self.scene = self.compiled.scene
        self._integrator, self._step_error, self._progress = integrator or GeneralizedAlpha(), step_error, progress
        self._projected = self._integrator.project_velocities and self.compiled.model.rows.count > 0
        self._pattern = pattern_of(self.compiled)
        self.state = initial_state(self.scenes, self._sizes())
        self.control(every=1)
        self.ring = Ring(self._sizes(), self.compiled.device)
        self._allocate()
        self._open_books()

    def _open_books(self) -> None:
        """Host data of a run."""
        self.no_room: dict[int, int] = {}  # world -> active nodes requested beyond the memory
        self.chunks: list[list[SavedRows]] = [[] for _ in range(self.worlds)]  # rows drained from the ring
        self.drained = np.zeros(self.worlds, dtype=int)
        self.seconds_in_graph = 0.0
        self.start_notes: list[str] = []
        self.not_at_rest = ""  # why `settle` found no static state, if known
        self.unconverged = ""  # how bodies still moved where its iteration did not converge
        self.given_off = 0.0  # J, released by the jumps of a static run, see `snap_through`

    def _allocate(self) -> None:
        """Scratch arrays and the graph that works on them."""
        scenes, worlds, integrator = self.scenes, self.worlds, self._integrator
        sizes = self._sizes()
        self.scratch = scratch_for(scenes, sizes, self.state)
        self.scratch.coefficients.assign(np.tile(integrator.coefficients, (worlds, 1)))
        self.scratch.local_coefficients.assign(np.tile(self.compiled.local.options.coefficients, (worlds, 1)))
        self.scratch.project.fill_(int(integrator.project_velocities))
        self.scratch.step_error.fill_(self._step_error or 0.0)
        self.graph: Parts = StepGraph(
            scenes, sizes, self.state, self.ring, self.scratch, self._pattern, progress=self._progress
        )

    def _sizes(self) -> Sizes:
        return sizes_of(
            self.compiled, self.worlds, self.settings.ring_rows, self._pattern, projected=self._projected,
            adaptive=self._step_error is not None,
        )  # fmt: skip

    def make_room(self, slots: int) -> bool:
        """Allocate at least `slots` active nodes, up to the capacities of the contacts; False if the memory does not
        suffice, and nothing changes.

        Scratch arrays are reallocated: references to them must be renewed. Their values are kept, except the matrices
        of nodes and cells, because other worlds may still have to be recorded from them.
        """
        m = self.compiled.model
        slots = min(slots, m.capacity.slot_limit)
        if slots <= m.capacity.slots:
            return True
        room, kept = (m.capacity.slots, m.capacity.cells), (self.scratch, self.graph)
        before = vars(self.scratch)
        try:
            enlarge(self.scenes, slots)
            self._allocate()
        except (InputError, MemoryError, RuntimeError):
            self.scratch, self.graph = kept
            for compiled in self.scenes:
                compiled.model.capacity.slots, compiled.model.capacity.cells = room
            return False
        for name, array in vars(self.scratch).items():
            if name in before and before[name].shape == array.shape:
                array.assign(before[name])
        self.scratch.lasting.zero_()
        if m.capacity.cells:
            self.control(stale=1)  # compliances kept from step to step now have another shape
        return True

    def _relieve(self) -> np.ndarray:
        """Enlarge the capacity after attempts that exceeded it; returns the worlds (worlds,) whose attempt can be
        repeated.

        If the memory does not suffice for the largest request, that world has failed and is not enlarged again; the
        other worlds receive what they request.
        """
        capacity = self.compiled.model.capacity
        short = (self.word("status") & int(k.ROOM)) != 0
        short[list(self.no_room)] = False
        if not np.any(short):
            return short
        wanted = np.minimum(np.maximum(ROOM_GROWTH * capacity.slots, self.word("spare")), capacity.slot_limit)
        while np.any(short) and not self.make_room(most := int(wanted[short].max())):
            refused = short & (wanted == most)
            self.no_room |= dict.fromkeys(np.flatnonzero(refused).tolist(), most)
            short &= ~refused
        words = self.state.ctl.numpy().copy()
        for word in ("status", "spare"):
            words[word][short] = 0
        self.state.ctl.assign(words)
        return short

    @property
    def models(self) -> wp.array:
        """Constants of the scenes for the kernels, one per world."""
        return self.graph.program.arrays["models"]

    @property
    def integrator(self) -> Integrator:
        """Integrator of bodies and global modes."""
        return self._integrator

    # --- control words, equal in all worlds

    def control(self, **values: int) -> None:
        """Set words of `warpffrf_kernels.core.control.Control` by name. Raises `InputError` for a save interval `every`
        below one step, by which kernels divide."""
        if values.get("every", 1) < 1:
            raise InputError(f"engine: every is {values['every']}; save every step, 1, or every so many of them")
        words = self.state.ctl.numpy().copy()
        for name, value in values.items():
            words[name] = value
        self.state.ctl.assign(words)

    def clock(self, **values: float | np.ndarray) -> None:
        """Set words of `warpffrf_kernels.core.control.Clock` by name."""
        words = self.state.clk.numpy().copy()
        for name, value in values.items():
            words[name] = value
        self.state.clk.assign(words)

    def coefficients(self, **values: float) -> None:
        """Set coefficients of the step of bodies, by their names in `warpffrf_kernels.core.control.Coefficients`."""
        words = self.state.clk.numpy().copy()
        for name, value in values.items():
            words["retained"][name] = value
        self.state.clk.assign(words)

    def word(self, name: str) -> np.ndarray:
        """A word of `Control` or `Clock`, of every world."""
        words = self.state.read("ctl")
        if name not in (words.dtype.names or ()):
            words = self.state.read("clk")
        return words[name].copy()

    def locked_rows(self, world: int) -> list[int]:
        """Rows of the pretensions with locked length."""
        rows = self.compiled.tensions.rows.values()
        return [row for row, held in zip(rows, self.state.locked.numpy()[world], strict=False) if held]

    def replay(self, attempts: int) -> float:
        """Replay the graph, enlarge the capacity on request, and drain the ring; returns the wall time [s]."""
        seconds = self._attempt(np.full(self.worlds, attempts))
        self.seconds_in_graph += seconds
        self.drain()
        return seconds

    def _attempt(self, attempts: np.ndarray) -> float:
        """Make at most the given number of attempts (worlds,) in each world, none if negative, and the same number
        again in a world whose capacity was enlarged; returns the wall time [s]."""
        seconds = self.graph.replay(attempts)
        while np.any(relieved := self._relieve()):
            seconds += self.graph.replay(np.where(relieved, attempts, NO_ATTEMPT))
        return seconds

    def drain(self) -> None:
        """Move the rows saved since the last call out of the ring."""
        saved = self.word("saved")
        if np.any(saved > self.drained):
            ring = self.ring.on_host()
            for w, chunks in enumerate(self.chunks):
                if saved[w] > self.drained[w]:
                    chunks.append(taken(ring, w, range(self.drained[w], saved[w])))
            self.drained = saved

    def saved(self, world: int = 0) -> SavedRows:
        """All rows saved of a world so far."""
        chunks = [dict(rows) for rows in self.chunks[world]] or [taken(self.ring.on_host(), world, range(0))]
        self.chunks[world] = []
        self.chunks[world] = [joined(chunks)]
        return self.chunks[world][0]

    def has_turned(self, turned: Sequence[float] | np.ndarray) -> None:
        """Raise the largest angular speeds [rad/s] in the state to at least these values."""
        if len(turned):
            self.state.turned.assign(np.maximum(self.state.turned.numpy(), turned))

    def outrun(self) -> np.ndarray | None:
        """The largest angular speed of each body [rad/s] if one exceeds the validity of its inertia level."""
        limits = self.compiled.inertia.limits
        if not np.any(np.isfinite(limits)):
            return None
        turned = self.state.turned.numpy()[0]
        return turned if np.any(turned > limits) else None

    @property
    def off_end(self) -> bool:
        """Whether cells cover patches of crowns that run off an end."""
        return any(plan.off_end for plan in self.compiled.patches.values())

    # --- checkpoints

    def checkpoint(self) -> dict[str, np.ndarray]:
        """Copies of all data required to continue bit for bit: the state and, for contact-fixed grids, the cell data
        kept from step to step. Tableaus of small-sliding contacts are not included: they are recomputed from the forces
        of the state, and a run continues to round-off of their solve. Words of the last attempt are omitted, because
        it depends on other worlds whether this world took part in it."""
        state = self.state.to_numpy()
        for word in OF_AN_ATTEMPT:
            state["ctl"][word] = 0
        rows = {OFF_END: np.ones(1, dtype=bool)} if self.off_end else {}
        rows |= self.compiled.inputs.checkpoint() | self.compiled.parameters.checkpoint()
        return state | rows | {f"{KEPT_MARK}{name}": a.numpy().copy() for name, a in self._kept().items()}

    def resume(self, checkpoint: Mapping[str, np.ndarray]) -> None:
        """Overwrite the state and the kept cell data; if these do not fit, compliances are recomputed, with a note in
        `start_notes`."""
        given = {name.removeprefix(KEPT_MARK): a for name, a in checkpoint.items() if name.startswith(KEPT_MARK)}
        for name in ("answer_node", "order"):  # lists over slots
            if name in given:
                self.make_room(given[name].shape[1])
        self.put_back(checkpoint)
        self.compiled.inputs.resume(checkpoint)
        self.compiled.parameters.resume(checkpoint)
        here = self._kept()
        if {name: a.shape for name, a in here.items()} == {name: a.shape for name, a in given.items()}:
            for name, array in here.items():
                array.assign(given[name])
        else:
            self.control(stale=1)
            self.start_notes.append(NOT_KEPT)

    def put_back(self, values: Mapping[str, np.ndarray]) -> None:
        """Overwrite the state of this engine. Tableaus of small-sliding contacts belong to the last evaluation and are
        recomputed from the forces of the state."""
        self.state.assign(values)
        words = self.scratch.matched_words.numpy()
        words[..., int(READY)] = np.where(words[..., int(READY)] == int(NONE), int(NONE), int(ANEW))
        words[..., [int(HELD), int(AHEAD)]] = 0
        self.scratch.matched_words.assign(words)

    def _kept(self) -> dict[str, DeviceArray]:
        """Arrays kept from step to step in addition to the state, each once: some are aliases."""
        sizes = self._sizes()
        if not sizes["patch_pair"]:
            return {}
        names = KEPT if sizes["rolling_pair"] else KEPT_OF_PATCHES
        found = {id(array): name for name in reversed(names) for array in (getattr(self.scratch, name),)}
        return {name: getattr(self.scratch, name) for name in sorted(found.values())}

    # --- phases

    def enter(self, mode: int, step: float, target: int = 1) -> None:
        """Start a count of `target` user steps of `step` [s] in a mode (DYNAMIC, STATIC, PROJECT, START, LOADING)."""
        self.control(mode=int(mode), step=0, sub=0, level=0, target=target)
        self.clock(user_step=step)

    def static_step(self, tau: float) -> None:
        """One proximal step of size tau [s] towards the static state; rates must be zero."""
        self.enter(k.STATIC, tau)
        self.replay(1)

    def commit(self) -> None:
        """Start all history variables at the present state, see `warpffrf_kernels.step.proximal`."""
        if not self.graph.remembers:
            return
        self.evaluate_here()
        self.control(commit=1)
        self.graph.commit()
        self.control(commit=0)

    def evaluate_here(self) -> None:
        """Forces and rows of the present state, at its time."""
        for name in ("dx", "psi", "dq", "centre_dx", "centre_psi", "centre_dq"):
            getattr(self.scratch, name).zero_()
        self.clock(next_time=self.word("time"))
        self.control(run=1, moved=1, iteration=0)
        self.graph.stand_still()
        self.graph.evaluate()
        self.control(run=0, moved=0)

    def save_now(self) -> None:
        """Append the present state to the rows."""
        self.control(record=1)
        self.graph.record()
        self.control(record=0)
        self.drain()

    def rates_to_zero(self) -> None:
        for name in ("v", "v_rate", "v_alg", "omega", "omega_rate", "omega_alg", "qd", "qd_rate", "qd_alg"):
            getattr(self.state, name).zero_()

    def initial_rates(self) -> None:
        """Set the initial velocities of the scene; positions are unchanged."""
        self.rates_to_zero()
        motions = [initial_motion(compiled.scene) for compiled in self.scenes]
        for name in ("v", "omega"):
            getattr(self.state, name).assign(np.stack([motion[name] for motion in motions]))
