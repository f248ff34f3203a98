"""Runs of free bodies on the host, with `RungeKutta4` or `EnergyMomentum`: independent checks of the step graph.

The integrators differ in one function, `advance(body, state, t, h)`; bodies are independent of each other. The result
is the same `History` that `run` makes, with the same ledger; the line `numerical` closes it, so that it shows the loss
or gain of the method. The checkpoint contains positions, velocities and the ledger; those of another run of either
kind, host or device, contain these too, so that a check can start from an equilibrium or from a stage that the kernels
computed. A run in progress stores the same with its counts (`_Counts`): time is counted in steps from its beginning, so
that a continued run has the same times, bit for bit.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from warpffrf.model.checks.scene import refuse_short_signals
from warpffrf.model.errors import MOST_COUNTED, InputError, require_count
from warpffrf.model.integrators import EnergyMomentum, RungeKutta4
from warpffrf.model.messages.checkpoints import Keeper, Plan, Rows, Source, Unfinished
from warpffrf.model.messages.progress import Progress, deferred_interrupts
from warpffrf.model.messages.status import Status
from warpffrf.model.scene import Scene
from warpffrf.model.step_count import step_count
from warpffrf.online.arrays.declaration import host_structs
from warpffrf.online.arrays.ring import joined
from warpffrf.online.checkpoint import is_dynamic, time_of
from warpffrf.online.compile.forces import ForceTable
from warpffrf.online.compile.inertia_plan import InertiaPlan
from warpffrf.online.diagnosis.inertia_indicator import deflection_lines, deflections
from warpffrf.online.free_flight import free_bodies
from warpffrf.online.free_flight.free_bodies import FreeBody, Motion, check_free, free_body, initial_motion
from warpffrf.online.history.history import ENERGY_LINES, History
from warpffrf.online.history.record import user_frame
from warpffrf.online.history.sensors import force_histories, sensor_histories
from warpffrf.online.warp_start import start_warp
from warpffrf_kernels.core.control import Clock

KIND = "check"
COUNTS = "check_counts"  # in the checkpoint of a run in progress
ADVANCE = {EnergyMomentum: free_bodies.advance_energy_momentum, RungeKutta4: free_bodies.advance}
WITH_LOADS = {EnergyMomentum: False, RungeKutta4: True}


class _Ledger:
    """The lines of the energy ledger of all bodies; `numerical` closes the balance."""

    def __init__(self, bodies: list[FreeBody], states: list[Motion], before: np.ndarray | None) -> None:
        self.lines = dict.fromkeys(ENERGY_LINES, 0.0)
        if before is not None:
            self.lines.update(zip(ENERGY_LINES, np.asarray(before, dtype=float), strict=True))
        self._present(bodies, states)
        self.stored = self._stored()

    def _present(self, bodies: list[FreeBody], states: list[Motion]) -> None:
        pairs = list(zip(bodies, states, strict=True))
        self.lines["kinetic"] = sum(b.kinetic_energy(s) for b, s in pairs)
        self.lines["strain"] = sum(b.strain_energy(s) for b, s in pairs)
        self.lines["potential"] = sum(b.potential(s) for b, s in pairs)

    def _stored(self) -> float:
        return self.lines["kinetic"] + self.lines["strain"] + self.lines["potential"]

    def book(self, bodies: list[FreeBody], states: list[Motion], work: float, damping: float) -> list[float]:
        """Close the books at `states`: work of loads and loss by damping [J] since the last time; all lines."""
        self._present(bodies, states)
        stored = self._stored()
        self.lines["force_work"] += work
        self.lines["damping"] += damping
        self.lines["numerical"] += stored - self.stored - work + damping
        self.stored = stored
        return list(self.lines.values())


class _Rows:
    """Saved steps being collected, for `history_of`; `chunks`: of an earlier run that is continued."""

    def __init__(self, bodies: list[FreeBody], chunks: Sequence[Rows] = ()) -> None:
        self.bodies = bodies
        self._chunks = list(chunks)
        self._fresh: list[tuple[float, float, int, list[float], np.ndarray]] = []

    def add(self, t: float, step: float, states: list[Motion], energy: list[float], iterations: int) -> None:
        """Append a step of size `step` [s] to time t [s]."""
        motion: list[np.ndarray] = []
        for body, state in zip(self.bodies, states, strict=True):
            rates = body.rates(state, t)
            motion += [*state, rates.v, rates.w, rates.qd]
        self._fresh.append((t, step, iterations, energy, np.concatenate(motion)))

    def chunks(self) -> list[Rows]:
        """All rows so far; the rows added since the last call form a new chunk."""
        if self._fresh or not self._chunks:
            columns = [list(column) for column in zip(*self._fresh, strict=True)] or [[]] * 5
            T, width = len(self._fresh), sum(19 + 3 * len(body.stiffness) for body in self.bodies)
            shapes = {"time": (T,), "step": (T,), "iterations": (T,), "energy": (T, len(ENERGY_LINES))}
            shapes["motion"] = (T, width)
            self._chunks.append(
                {
                    name: np.array(column, dtype=int if name == "iterations" else float).reshape(shape)
                    for (name, shape), column in zip(shapes.items(), columns, strict=True)
                }
            )
            self._fresh = []
        return self._chunks


@dataclass
class _Counts:
    """Progress of a run: the time [s] it began at, steps done, and iterations: of all, of the worst, since the last
    saved row.
    """

    begin: float
    done: int = 0
    total: int = 0
    worst: int = 0
    pending: int = 0

    def to_array(self) -> np.ndarray:
        return np.array(list(vars(self).values()))

    @classmethod
    def of(cls, array: np.ndarray) -> _Counts:
        return cls(float(array[0]), *(int(value) for value in array[1:]))


def run_check(
    scene: Scene,
    duration: float,
    *,
    step: float,
    integrator: EnergyMomentum | RungeKutta4,
    save_every: int = 1,
    progress: bool = True,
    start: str | History | Unfinished = "initial",
    keeper: Keeper | None = None,
) -> History:
    """Simulate the free bodies of `scene` for `duration` [s] in steps of `step` [s] on the host.

    start: "initial", the History of an earlier run or equilibrium of the same scene, which is continued, or an
    Unfinished run, which is continued to its end. keeper: stores intermediate results while the run is in progress. A
    step that fails is a status of the History ("not_converged", "not_finite"), as is an interruption; computed results
    are kept. Raises `InputError` for wrong numbers, for scenes with more than free bodies (`check_free`), and for a
    step beyond the stability limit of an explicit method.
    """
    kind = type(integrator)
    if kind not in ADVANCE:
        raise InputError(f"simulate: a check runs with RungeKutta4() or EnergyMomentum(), got {integrator!r}")
    steps, notes = step_count(duration, step)
    save_every = require_count(save_every, "simulate: save_every", 1, most=MOST_COUNTED)
    check_free(scene, kind.__name__, loads=WITH_LOADS[kind])
    continued = isinstance(start, History | Unfinished)
    if not isinstance(start, Unfinished) and start != "initial" and not (continued and is_dynamic(start.checkpoint)):
        raise InputError("simulate: free bodies have no equilibrium; start from 'initial' or from an earlier run")
    count = _Counts(time_of(start.checkpoint) if isinstance(start, History) else 0.0)
    if isinstance(start, Unfinished):
        count = _Counts.of(start.checkpoint[COUNTS])
    refuse_short_signals(scene, count.begin, count.begin + steps * step)
    began = time.perf_counter()
    start_warp()  # the clock of the checkpoint is a structure of Warp
    plan = InertiaPlan.of(scene)
    bodies = [free_body(scene, body, own) for body, own in zip(scene.bodies, plan.bodies, strict=True)]
    if kind is RungeKutta4:
        for body in bodies:
            free_bodies.check_step(body, step)
    states, before = [initial_motion(b) for b in scene.bodies], None
    if isinstance(start, History | Unfinished):
        states, before = _restored(scene, start.checkpoint)
    ledger = _Ledger(bodies, states, before)
    rows = _Rows(bodies, start.rows if isinstance(start, Unfinished) else ())
    accepted = list(ledger.lines.values())
    if not continued:
        rows.add(count.begin, 0.0, states, accepted, 0)
    if keeper is not None:
        keeper.begin(Source(KIND, scene))

    def keep(keeper: Keeper) -> None:
        checkpoint = _checkpoint(states, accepted, count.begin + count.done * step) | {COUNTS: count.to_array()}
        keeper.keep(Unfinished(tuple(rows.chunks()), checkpoint, Plan(steps, 0, ())))

    loop = time.perf_counter()
    status, message = Status.COMPLETED, ""
    bar = Progress("simulate", steps, enabled=progress)
    try:
        with np.errstate(over="ignore", invalid="ignore"), deferred_interrupts() as asked:
            for n in range(count.done + 1, steps + 1):
                t = count.begin + (n - 1) * step
                moved = [ADVANCE[kind](b, s, t, step) for b, s in zip(bodies, states, strict=True)]
                energy = ledger.book(bodies, [m[0] for m in moved], sum(m[1] for m in moved), sum(m[2] for m in moved))
                if not np.all(np.isfinite(energy)):
                    status, message = Status.NOT_FINITE, "a NaN or infinite number occurred; reduce step"
                    break
                states, accepted, count.done = [m[0] for m in moved], energy, n
                most = max(m[3] for m in moved)
                count.total, count.worst, count.pending = (
                    count.total + most, max(count.worst, most), count.pending + most,
                )  # fmt: skip
                if n % save_every == 0 or n == steps:
                    rows.add(count.begin + n * step, step, states, energy, count.pending)
                    count.pending = 0
                bar.update(n)
                if keeper is not None and (asked or keeper.due()):
                    keep(keeper)
                if asked:
                    raise KeyboardInterrupt
    except free_bodies.NotConverged as error:
        status, message = Status.NOT_CONVERGED, str(error)
    except np.linalg.LinAlgError:
        status, message = (
            Status.SINGULAR,
            "the inertia of a deformed body is singular; reduce step, or its inertia level",
        )
    except KeyboardInterrupt:
        status, message = Status.INTERRUPTED, "interrupted by the user; results up to there are kept"
    bar.close()
    history = history_of(scene, joined(rows.chunks()))
    history.status, history.message = status, message
    deflected = deflection_lines(scene, deflections(scene, history.bodies))
    history.notes = [*plan.notes, *notes, f"integrated on the host by {kind.__name__}", *deflected]
    history.counters = {
        "steps": count.done, "rejected_steps": 0, "max_iterations": count.worst,
        "mean_iterations": count.total / max(count.done, 1),
        "build_seconds": loop - began, "seconds_in_graph": 0.0, "loop_seconds": time.perf_counter() - loop,
    }  # fmt: skip
    history.checkpoint = _checkpoint(states, accepted, count.begin + count.done * step)
    return history


def history_of(scene: Scene, rows: Rows) -> History:
    """The saved rows as a History."""
    T, times, energy = len(rows["time"]), rows["time"], rows["energy"]
    bodies, first = {}, 0
    for body in scene.bodies:
        m = body.mode_count
        x = rows["motion"][:, first : first + 19 + 3 * m]
        first += 19 + 3 * m
        ends = np.cumsum([3, 4, 3, 3, m, m, 3, 3])
        r, p, v, w, q, qd, vdot, wdot, qdd = np.split(x, ends, axis=1)
        bodies[body.name] = user_frame(body.center_of_mass, r, p, v, w, vdot, wdot, q, qd, qdd)
    forces = force_histories(scene, ForceTable(), times, np.zeros((T, 0)), np.zeros((T, 0, 6)), bodies)
    history = History(
        scene=scene, time=times, step_size=rows["step"], bodies=bodies, joints={}, contacts={}, forces=forces,
        energy={name: energy[:, i].copy() for i, name in enumerate(ENERGY_LINES)},
        iterations=rows["iterations"], factorisations=np.zeros(T, dtype=int),
    )  # fmt: skip
    history.sensors = sensor_histories(history)
    return history


def _checkpoint(states: list[Motion], energy: list[float], t: float) -> dict[str, np.ndarray]:
    """Positions, velocities, ledger and time in the shapes of the device state, one world."""
    found = {name: np.array([[getattr(s, field) for s in states]]) for name, field in _FIELDS.items()}
    for name in ("q", "qd"):
        found[name] = np.concatenate([np.zeros(0), *(getattr(s, name) for s in states)])[None]
    clock = host_structs(Clock, 1)
    clock["time"] = t
    return {**found, "energy": np.array([[energy, energy]]), "clk": clock, "stretch": np.zeros((1, 0))}


_FIELDS = {"r": "r", "p": "p", "v": "v", "omega": "w"}


def _restored(scene: Scene, checkpoint: Mapping[str, np.ndarray]) -> tuple[list[Motion], np.ndarray]:
    """States of all bodies and the ledger from the checkpoint of an earlier run, of this or of the other kind."""
    B, Q = len(scene.bodies), sum(body.mode_count for body in scene.bodies)
    shapes = {"r": (B, 3), "p": (B, 4), "v": (B, 3), "omega": (B, 3), "q": (Q,), "qd": (Q,)}
    for name, shape in shapes.items():
        given = np.asarray(checkpoint[name])[0] if name in checkpoint else None
        if given is not None and not Q and name in ("q", "qd"):
            given = given[:0]  # the device keeps one unused entry
        if given is None or given.shape != shape or not np.all(np.isfinite(given)):
            raise InputError(
                f"simulate: the checkpoint does not hold {name} {shape} of this scene; continue with the scene and the "
                "version of warpffrf that wrote it, or start from 'initial'"
            )
    at = np.cumsum([0] + [body.mode_count for body in scene.bodies])
    x = {name: np.asarray(checkpoint[name], dtype=float)[0] for name in shapes}
    states = [
        Motion(
            x["r"][i].copy(), x["p"][i].copy(), x["v"][i].copy(), x["omega"][i].copy(),
            x["q"][at[i] : at[i + 1]].copy(), x["qd"][at[i] : at[i + 1]].copy(),
        )
        for i in range(B)
    ]  # fmt: skip
    return states, np.asarray(checkpoint["energy"])[0, 0]
