"""Saved steps of a run, collected and converted to a history."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from references.monolithic.core.state import State
from references.monolithic.films.record import FILM_FIELDS, FILM_NUMBERS, FilmRow, film_arrays, film_row
from references.monolithic.history import BodyMotion, ContactForces, FilmForces, MonolithicHistory
from references.monolithic.line_of_centres.record import ContactRow, contact_arrays, contact_row, joined
from references.monolithic.newton import Solution, System
from references.monolithic.nodal.record import FrictionRow, friction_arrays, node_row
from warpffrf.model import rotation as rot

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
    """Saved steps being collected."""

    def __init__(self, system: System) -> None:
        self.system = system
        self.lines = (*LINES, *(NODAL_LINES if system.nodal else ()))
        self._saved: list[_Saved] = []

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
        self._saved.append(
            _Saved(
                state.copy(), (step, solution.iterations, solution.factorisations),
                [energy[line] for line in self.lines], reactions, evaluation.balance.springs,
                evaluation.balance.locked[:, 1],
                [row for row, _ in found], [rub for _, rub in found], films,
            )
        )  # fmt: skip

    def history(self, scene: Any, status: str, message: str, final: State) -> MonolithicHistory:
        """The saved results of a run of `scene`; `final`: its state at the end."""
        system, layout, saved, T = self.system, self.system.layout, self._saved, len(self._saved)
        numbers = np.array([s.numbers for s in saved], dtype=float).reshape(T, 3)
        energy = np.array([s.energy for s in saved], dtype=float).reshape(T, len(self.lines))
        all_reactions = np.array([s.reactions for s in saved]).reshape(T, layout.rows, 6)
        lengths = np.array([s.lengths for s in saved]).reshape(T, len(system.data.tensions))
        springs = sum(len(s.coordinates) for s in system.data.springs)
        axes = [
            np.array([rot.matrix(x) for x in self._state("p", 4)[:, b]]).reshape(-1, 3, 3) for b in range(layout.bodies)
        ]
        owner = np.array([c.joint for c in system.data.constraints])
        reactions = {}
        for joint in scene.joints:
            total = all_reactions[:, owner == str(joint.name)].sum(axis=1) if len(owner) else np.zeros((T, 6))
            reactions[str(joint.name)] = (total[:, :3], total[:, 3:])
        tensions = {
            data.name: np.hstack([lengths[:, n, None], all_reactions[:, data.row]])
            for n, data in enumerate(system.data.tensions)
        }
        return MonolithicHistory(
            scene, np.array([s.state.time for s in saved], dtype=float), numbers[:, 0], self._bodies(scene, axes),
            reactions, self._contacts(scene, axes),
            {line: energy[:, i].copy() for i, line in enumerate(self.lines)},
            numbers[:, 1].astype(int), numbers[:, 2].astype(int), status, message, final=final.copy(),
            spring_rows=np.array([s.springs for s in saved]).reshape(T, springs, 7), dropped=system.data.dropped,
            films=self._films(scene, axes), tensions=tensions,
        )  # fmt: skip

    def _state(self, name: str, *width: int) -> np.ndarray:
        """A field of `State` (T, bodies, width) of the saved steps, of coordinates (T, flexible)."""
        shape = (self.system.layout.bodies, *width) if width else (self.system.layout.flexible,)
        return np.array([getattr(s.state, name) for s in self._saved]).reshape(len(self._saved), *shape)

    def _bodies(self, scene: Any, axes: list[np.ndarray]) -> dict[str, BodyMotion]:
        r, v, v_rate, w, w_rate = (self._state(name, 3) for name in ("r", "v", "v_rate", "w", "w_rate"))
        p, (q, qd, qdd) = self._state("p", 4), (self._state(name) for name in ("q", "qd", "qdd"))
        found = {}
        for b, (body, A) in enumerate(zip(scene.bodies, axes, strict=True)):
            arm, omega, alpha = A @ body.center_of_mass, _apply(A, w[:, b]), _apply(A, w_rate[:, b])
            swing, at = np.cross(omega, arm), self.system.layout.body_modes(b)
            found[body.name] = BodyMotion(
                r[:, b] - arm, p[:, b], v[:, b] - swing, omega, q[:, at],
                v_rate[:, b] - np.cross(alpha, arm) - np.cross(omega, swing), alpha, qd[:, at], qdd[:, at],
            )  # fmt: skip
        return found

    def _contacts(self, scene: Any, axes: list[np.ndarray]) -> dict[str, ContactForces]:
        system, q, still = self.system, self._state("q"), np.tile(np.eye(3), (len(self._saved), 1, 1))
        contacts = {}
        for n, data in enumerate(system.pairs):
            sides = (data.a, data.b)
            owners = tuple(scene.ground if side.body < 0 else scene.bodies[side.body] for side in sides)
            A = tuple(still if side.body < 0 else axes[side.body] for side in sides)
            found = contact_arrays([s.contacts[n] for s in self._saved], owners, A, [side.grid for side in sides])
            a, b = (q[:, :0] if s is None else q[:, s] for s in system.local_slices(n))
            rub = None
            if system.nodal and data.rough:
                rub = friction_arrays([s.friction[n] for s in self._saved], joined, data.a.grid.rows)
            pressures = [s.state.active[n] for s in self._saved]
            contacts[data.name] = ContactForces(
                **found, friction=rub, active=np.array([len(p) for p in pressures], dtype=int), pressures=pressures,
                local=(a, b),
            )  # fmt: skip
        return contacts

    def _films(self, scene: Any, axes: list[np.ndarray]) -> dict[str, FilmForces]:
        T, films = len(self._saved), {}
        for n, data in enumerate(self.system.films):
            sides = (data.a, data.b)
            arms = [np.zeros((T, 3)) if b < 0 else axes[b] @ scene.bodies[b].center_of_mass for b in sides]
            turns = [np.tile(np.eye(3), (T, 1, 1)) if b < 0 else axes[b] for b in sides]
            own = [s.films[n] for s in self._saved]
            numbers = np.array([x.numbers for x in own], dtype=float).reshape(T, FILM_NUMBERS)
            fields = [np.array([x.fields[k] for x in own]).reshape(T, len(data.node_form)) for k in FILM_FIELDS]
            films[data.name] = FilmForces(**film_arrays(data, numbers, fields, arms, turns))
        return films


def _apply(A: np.ndarray, x: np.ndarray) -> np.ndarray:
    """A_t x_t of (T, 3, 3) and (T, 3)."""
    return np.einsum("tij,tj->ti", A, x)
