"""Saved steps of a run: collected, as plain arrays that a file can hold, and made a history of.

Arrays have a row for each saved step, but for those of what has another size in each: windows of contact pairs and
multipliers by number stand one behind the other, with their sizes beside them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.messages.checkpoints import Rows
from warpffrf.monolithic.core.state import State
from warpffrf.monolithic.films.record import FILM_FIELDS, FILM_NUMBERS, FilmRow, film_arrays, film_row
from warpffrf.monolithic.history import BodyMotion, ContactForces, FilmForces, MonolithicHistory
from warpffrf.monolithic.line_of_centres.record import ContactRow, Window, contact_arrays, contact_row, joined
from warpffrf.monolithic.newton import Solution, System
from warpffrf.monolithic.nodal.record import FRICTION_FIELDS, FrictionRow, friction_arrays, node_row

MOTION = ("r", "p", "v", "v_rate", "w", "w_rate", "q", "qd", "qdd")  # fields of `State` that a history is made of
LINES, NODAL_LINES = ("kinetic", "strain", "contact", "potential"), ("friction", "layer")


@dataclass(eq=False)
class _Saved:
    """A saved step."""

    state: State
    numbers: tuple[float, int, int]  # step size, iterations, factorisations
    energy: list[float]
    reactions: np.ndarray
    springs: np.ndarray
    lengths: np.ndarray
    contacts: list[ContactRow]
    friction: list[FrictionRow | None]
    films: list[FilmRow]


class Records:
    """Saved steps being collected; `chunks`: of an earlier run, which goes on."""

    def __init__(self, system: System, chunks: Sequence[Rows] = ()) -> None:
        self.system = system
        self._chunks = list(chunks)
        self._fresh: list[_Saved] = []

    def save(self, state: State, solution: Solution, step: float) -> None:
        """Append the accepted state."""
        evaluation = solution.evaluation
        if evaluation is None:
            return
        energy = dict(evaluation.balance.energy)
        if self.system.nodal:
            energy["contact"] += sum(pair.stored for pair in evaluation.pairs)
            energy |= {"friction": -float(state.lost[0]), "layer": float(state.lost[1])}
            found = [node_row(pair) for pair in evaluation.pairs]
        else:
            pairs = zip(evaluation.pairs, evaluation.pressures, strict=True)
            found = [(contact_row(pair, s), None) for pair, s in pairs]
        films = [film_row(film, state.film_nodes[film.data.in_nodes, 1]) for film in evaluation.films]
        reactions = -solution.increment.lam[:, None] * evaluation.balance.wrenches
        self._fresh.append(
            _Saved(
                state.copy(), (step, solution.iterations, solution.factorisations),
                [energy[line] for line in _lines(self.system)], reactions, evaluation.balance.springs,
                evaluation.balance.locked[:, 1],
                [row for row, _ in found], [rub for _, rub in found], films,
            )
        )  # fmt: skip

    def chunks(self) -> list[Rows]:
        """All rows so far; what was saved since the last call is a chunk of its own."""
        if self._fresh or not self._chunks:
            self._chunks.append(_rows(self.system, self._fresh))
            self._fresh = []
        return self._chunks

    def joined(self) -> Rows:
        """All rows so far as one chunk."""
        chunks = self.chunks()
        return {name: np.concatenate([chunk[name] for chunk in chunks]) for name in chunks[0]}


def history_of(
    scene: Any, system: System, rows: Rows, status: str, message: str, final: State | None
) -> MonolithicHistory:
    """What the rows of a run of `scene` hold; `final`: its state at the end."""
    r, p, v, v_rate, w, w_rate, q, qd, qdd = (rows[name] for name in MOTION)
    T = len(r)
    bodies: dict[str, BodyMotion] = {}
    for b, body in enumerate(scene.bodies):
        A = np.array([rot.matrix(x) for x in p[:, b]]).reshape(-1, 3, 3)
        arm, omega, alpha = A @ body.center_of_mass, _apply(A, w[:, b]), _apply(A, w_rate[:, b])
        swing, at = np.cross(omega, arm), system.layout.body_modes(b)
        bodies[body.name] = BodyMotion(
            r[:, b] - arm, p[:, b], v[:, b] - swing, omega, q[:, at],
            v_rate[:, b] - np.cross(alpha, arm) - np.cross(omega, swing), alpha, qd[:, at], qdd[:, at],
        )  # fmt: skip
    owner = np.array([c.joint for c in system.data.constraints])
    reactions = {}
    for joint in scene.joints:
        total = rows["reactions"][:, owner == str(joint.name)].sum(axis=1) if len(owner) else np.zeros((T, 6))
        reactions[str(joint.name)] = (total[:, :3], total[:, 3:])
    tensions = {
        data.name: np.hstack([rows["lengths"][:, n, None], rows["reactions"][:, data.row]])
        for n, data in enumerate(system.data.tensions)
    }
    contacts = {}
    for n, data in enumerate(system.pairs):
        sides = (data.a, data.b)
        grounds = [side.body < 0 for side in sides]
        owners = tuple(
            scene.ground if ground else scene.bodies[side.body] for side, ground in zip(sides, grounds, strict=True)
        )
        A = tuple(
            np.tile(np.eye(3), (T, 1, 1)) if ground
            else np.array([rot.matrix(x) for x in p[:, side.body]]).reshape(-1, 3, 3)
            for side, ground in zip(sides, grounds, strict=True)
        )  # fmt: skip
        found = contact_arrays(_contact_rows(rows, n), owners, A, [side.grid for side in sides])
        local = [np.zeros((T, 0)) if s is None else q[:, s] for s in system.local_slices(n)]
        rub = None
        if _rough(system, n):
            rub = friction_arrays(_friction_rows(rows, n), joined, data.a.grid.rows)
        pressures = _by_number(rows, f"pressure of pair {n}")
        contacts[data.name] = ContactForces(
            **found, friction=rub, active=rows[f"pressure of pair {n}: count"], pressures=pressures,
            local=(local[0], local[1]),
        )  # fmt: skip
    films = {}
    for n, data in enumerate(system.films):
        arms = [
            np.zeros((T, 3)) if body < 0
            else np.array([rot.matrix(x) @ scene.bodies[body].center_of_mass for x in p[:, body]]).reshape(-1, 3)
            for body in (data.a, data.b)
        ]  # fmt: skip
        turns = [
            np.tile(np.eye(3), (T, 1, 1)) if body < 0
            else np.array([rot.matrix(x) for x in p[:, body]]).reshape(-1, 3, 3)
            for body in (data.a, data.b)
        ]  # fmt: skip
        fields = [rows[f"{name} of film {n}"] for name in FILM_FIELDS]
        films[data.name] = FilmForces(**film_arrays(data, rows[f"film {n}"], fields, arms, turns))
    return MonolithicHistory(
        scene, rows["time"], rows["step"], bodies, reactions, contacts,
        {line: rows["energy"][:, i].copy() for i, line in enumerate(_lines(system))},
        rows["iterations"], rows["factorisations"], status, message, final=None if final is None else final.copy(),
        spring_rows=rows["springs"], dropped=system.data.dropped,
        films=films, tensions=tensions,
    )  # fmt: skip


def _lines(system: System) -> tuple[str, ...]:
    return (*LINES, *(NODAL_LINES if system.nodal else ()))


def _rough(system: System, n: int) -> bool:
    """Whether pair n has friction."""
    return system.nodal and system.pairs[n].rough


def _rows(system: System, saved: list[_Saved]) -> Rows:
    """Saved steps as arrays."""
    layout, T = system.layout, len(saved)
    B, springs = layout.bodies, sum(len(s.coordinates) for s in system.data.springs)
    shapes = {name: (B, 3) for name in ("r", "v", "v_rate", "w", "w_rate")} | {"p": (B, 4)}
    shapes |= {name: (layout.flexible,) for name in ("q", "qd", "qdd")}
    numbers = np.array([s.numbers for s in saved], dtype=float).reshape(T, 3)
    rows = {name: np.array([getattr(s.state, name) for s in saved]).reshape(T, *shapes[name]) for name in MOTION}
    rows |= {"time": np.array([s.state.time for s in saved], dtype=float), "step": numbers[:, 0]}
    rows |= {"iterations": numbers[:, 1].astype(int), "factorisations": numbers[:, 2].astype(int)}
    rows["energy"] = np.array([s.energy for s in saved], dtype=float).reshape(T, len(_lines(system)))
    rows["reactions"] = np.array([s.reactions for s in saved]).reshape(T, layout.rows, 6)
    rows["lengths"] = np.array([s.lengths for s in saved]).reshape(T, len(system.data.tensions))
    rows["springs"] = np.array([s.springs for s in saved]).reshape(T, springs, 7)
    for n, data in enumerate(system.films):
        own = [s.films[n] for s in saved]
        rows[f"film {n}"] = np.array([x.numbers for x in own], dtype=float).reshape(T, FILM_NUMBERS)
        for name in FILM_FIELDS:
            rows[f"{name} of film {n}"] = np.array([x.fields[name] for x in own]).reshape(T, len(data.hat_form))
    for n, data in enumerate(system.pairs):
        found = [s.contacts[n] for s in saved]
        second = 0 if data.b.grid is None else data.b.grid.rows
        rows[f"force of pair {n}"] = np.array([x.force for x in found], dtype=float).reshape(T, 12)
        rows[f"approach of pair {n}"] = np.array([x.approach for x in found], dtype=float)
        rows |= _window_rows(f"hats of pair {n}", [x.pressure for x in found], data.a.grid.rows)
        rows |= _window_rows(f"second hats of pair {n}", [x.second for x in found], second)
        active = [s.state.active[n] for s in saved]
        rows |= {
            f"pressure of pair {n}: count": np.array([len(a) for a in active], dtype=int),
            f"pressure of pair {n}: number": np.array([number for a in active for number in a], dtype=int),
            f"pressure of pair {n}: value": np.array([value for a in active for value in a.values()], dtype=float),
        }
        if _rough(system, n):
            rubbing: list[Any] = [s.friction[n] for s in saved]
            for name in FRICTION_FIELDS:
                windows = [x.windows[name] for x in rubbing]
                rows |= _window_rows(f"{name} of pair {n}", windows, data.a.grid.rows)
            values = [(x.power, *x.creep, x.rolling, x.advanced) for x in rubbing]
            rows[f"friction of pair {n}"] = np.array(values, dtype=float).reshape(T, 5)
    return rows


def _contact_rows(rows: Rows, n: int) -> list[ContactRow]:
    """The records of pair n."""
    windows = (_windows(rows, f"{name} of pair {n}") for name in ("hats", "second hats"))
    values = rows[f"force of pair {n}"], rows[f"approach of pair {n}"]
    return [ContactRow(force, float(approach), *both) for force, approach, *both in zip(*values, *windows, strict=True)]


def _friction_rows(rows: Rows, n: int) -> list[FrictionRow]:
    """The records of friction of pair n."""
    fields = [_windows(rows, f"{name} of pair {n}") for name in FRICTION_FIELDS]
    return [
        FrictionRow(
            dict(zip(FRICTION_FIELDS, windows, strict=True)), float(x[0]), x[1:3], float(x[3]), float(x[4])
        )
        for x, *windows in zip(rows[f"friction of pair {n}"], *fields, strict=True)
    ]  # fmt: skip


def _window_rows(name: str, windows: list[Window], lines: int) -> Rows:
    """Windows (columns, lines) of all steps one behind the other."""
    return {
        f"{name}: first": np.array([w.first for w in windows], dtype=int),
        f"{name}: middle": np.array([w.middle for w in windows], dtype=float),
        f"{name}: columns": np.array([len(w.values) for w in windows], dtype=int),
        f"{name}: values": np.concatenate([np.zeros((0, lines)), *(w.values for w in windows)]),
    }


def _windows(rows: Rows, name: str) -> list[Window]:
    ends = np.cumsum(rows[f"{name}: columns"])
    values = np.split(rows[f"{name}: values"], ends[:-1]) if len(ends) else []
    places = zip(rows[f"{name}: first"], rows[f"{name}: middle"], strict=True)
    return [Window(int(first), float(middle), own) for (first, middle), own in zip(places, values, strict=True)]


def _by_number(rows: Rows, name: str) -> list[dict[int, float]]:
    """Values by number of all steps."""
    count, number, value = (rows[f"{name}: {part}"] for part in ("count", "number", "value"))
    ends = np.cumsum(count)
    return [
        {int(k): float(x) for k, x in zip(number[end - c : end], value[end - c : end], strict=True)}
        for c, end in zip(count, ends, strict=True)
    ]


def _apply(A: np.ndarray, x: np.ndarray) -> np.ndarray:
    """A_t x_t of (T, 3, 3) and (T, 3)."""
    return np.einsum("tij,tj->ti", A, x)
