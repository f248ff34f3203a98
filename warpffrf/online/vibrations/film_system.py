r"""The linear system of a film, dense and exact, from the values of its points in the last evaluation.

With the unknowns x of a film, pressures or cavity fractions and pressures of asperities, and the columns z that it is
coupled to (`warpffrf_kernels.films.system`),

    R + J dx + B dz = 0,      force on the columns:  P^T x.

R depends on the gap at the points by H and on the pressures at a given gap by A; pressures of functions that are full
open it by E, and columns by L:  J = A + H E, B = H L; asperities at the nodes likewise, by their stiffness. Both are
linear functions of the coefficient a_0 of the rates, J = J_0 + a_0 J_1, of which two determine both parts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.online.compile.films.bases import Basis, basis_of
from warpffrf.online.diagnosis.film_grid import transport
from warpffrf.online.engine import Engine
from warpffrf_kernels.films import sampling, unknowns

Array = np.ndarray
RATES = 100.0, 200.0  # 1/s: two coefficients of rates
GAP_STEP = 1e-3  # of the smallest gap, for differences


@dataclass(frozen=True)
class FilmSystem:
    """J_0, J_1 (x, x), B_0, B_1 (x, n), P (x, n) over displacements, rotations and modes of all bodies (n); thin (x,):
    the unknowns whose rows are nearly diagonal, cavity fractions and asperities without contact.
    """

    J_0: Array
    J_1: Array
    B_0: Array
    B_1: Array
    P: Array
    thin: Array


def smallest_gap(engine: Engine) -> float:
    """The smallest of all films [m], at the last evaluation; infinite without films."""
    count = engine.compiled.films.count
    return float(engine.scratch.film_line.numpy()[0, :, int(sampling.GAP)].min()) if count else np.inf


def film_systems(engine: Engine, coordinates: int) -> list[FilmSystem]:
    """Those of all films of world 0 at the state of the last evaluation; `coordinates`: n."""
    count = engine.compiled.films.count
    found: list[list[tuple[Array, Array]]] = []
    for rate in RATES if count else ():
        engine.scratch.film_rates.assign(np.tile([rate, 0.0, 0.0], (engine.worlds, 1)))
        engine.control(run=1, moved=1, refresh=1, failure=0, changes=0)
        engine.graph.move_and_load()
        found.append([FilmState(engine, film).system() for film in range(count)])
    first, second = RATES
    systems = []
    for film, ((J, B), (J_2, B_2)) in enumerate(zip(*found, strict=True)):
        state = FilmState(engine, film)
        place = state.coordinates(coordinates)
        J_1, B_1 = ((later - now) / (second - first) for now, later in ((J, J_2), (B, B_2)))
        systems.append(
            FilmSystem(J - first * J_1, J_1, (B - first * B_1) @ place, B_1 @ place, state.loads() @ place, ~state.full)
        )
    return systems


class FilmState:
    """A film of world 0 at the last evaluation, and the matrices of its points and nodes."""

    def __init__(self, engine: Engine, film: int) -> None:
        films, state, scratch = engine.compiled.films, engine.state, engine.scratch
        self.engine, self.film, self.basis = engine, film, basis_of(engine.scene.films[film])
        spans = {
            name: slice(*(int(n) for n in getattr(films, f"{name}_start").numpy()[film : film + 2]))
            for name in ("function", "point", "node", "seat", "press", "second_node")
        }
        self.spans = spans
        numbers = {name: int(getattr(films, name).numpy()[film]) for name in
                   ("rule", "rough", "modes", "second_modes", "first", "second", "second_nodes")}  # fmt: skip
        self.rule, self.rough, self.modes, self.second_modes = (
            numbers[name] for name in ("rule", "rough", "modes", "second_modes")
        )
        self.surfaces, self.grid_nodes = (numbers["first"], numbers["second"]), spans["node"].stop - spans["node"].start
        self.second_nodes = numbers["second_nodes"]
        self.free = np.flatnonzero(~self.basis.held)
        self.line = scratch.film_line.numpy()[0, spans["point"]]
        self.node_line = scratch.film_node_line.numpy()[0, spans["node"]][: self.rough]
        full = state.film_full.numpy()[0, 1, spans["function"]][self.free] != 0
        pressure = state.film_pressure.numpy()[0, 1, spans["function"]][self.free]
        touches = (state.film_asperity.numpy()[0, 1, spans["node"]][: self.rough] > 0.0) | (
            self.node_line[:, int(sampling.PRESSED)] > 0.0
        )
        self.is_void = ~full
        self.full = np.concatenate([full, touches])
        acts = full & ~((self.rule == int(sampling.HALF)) & (pressure < 0.0))
        self.acts = np.concatenate([acts, touches])
        basis = self.basis
        points = len(basis.weight)
        place = np.repeat(np.arange(points), basis.function.shape[1]), basis.function.ravel()
        at = place[1] >= 0
        self.value, self.x, self.z = (
            sp.csr_matrix((v.ravel()[at], (place[0][at], place[1][at])), shape=(points, basis.functions))[:, self.free]
            for v in (basis.value, basis.around, basis.along)
        )
        self.between = _gathered(basis.grid_node, basis.between, self.grid_nodes)
        self.seats = self._seats()

    def _table(self, name: str, rows: int, columns: int) -> Array:
        films = self.engine.compiled.films
        start = int(getattr(films, f"{name}_start").numpy()[self.film])
        return getattr(films, name).numpy()[start : start + rows * columns].reshape(rows, columns)

    def _column(self, name: int, count: int = 1) -> Array:
        return self.line[:, int(name) : int(name) + count]

    def _seats(self) -> Any:
        """(points and nodes, nodes of the second surface), of a compliant one."""
        if not self.second_nodes:
            return None
        scratch, span = self.engine.scratch, self.spans["seat"]
        seat, at = scratch.film_seat.numpy()[0, span], scratch.film_seat_at.numpy()[0, span]
        node = np.stack([seat[:, c // 2] + c % 2 for c in range(4)], axis=1)
        part = np.stack(
            [np.prod([np.maximum(1.0 - np.abs(at[:, k] - (c // 2, c % 2)[k]), 0.0) for k in (0, 1)], axis=0)
             for c in range(4)], axis=1,
        )  # fmt: skip
        return _gathered(node, part, self.second_nodes)

    def _openings(self) -> tuple[Array | None, Array]:
        """Opening at the points, then at the nodes, by the unknowns (x), None of rigid bodies, and by the columns."""
        films, trial, m = self.engine.compiled.films, self.engine.scratch, self.engine.compiled.model
        lines = len(self.full)
        to = sp.vstack([self.between, sp.identity(self.grid_nodes)]).tocsr()
        compliance = self._table("compliance", lines, self.grid_nodes)
        E = to @ compliance.T if compliance.any() or self.seats is not None else None
        normal = np.concatenate([self._column(sampling.NORMAL, 3),
                                 self.node_line[:, int(sampling.NODE_NORMAL) :][:, :3]])  # fmt: skip
        place = np.concatenate([films.point_place.numpy()[self.spans["point"]],
                                films.node_place.numpy()[self.spans["node"]][: self.rough]])  # fmt: skip
        body = m.surfaces.body.numpy()[list(self.surfaces)]
        axes = [np.eye(3) if b < 0 else trial.axes.numpy()[0, b] for b in body]
        origin = [np.zeros(3) if b < 0 else trial.r1.numpy()[0, b] for b in body]
        world = normal @ axes[0].T
        arm = origin[0] - origin[1] + place @ axes[0].T
        rigid = np.hstack([world, np.cross(place, normal), -world, -np.cross(arm, world) @ axes[1]])
        rows = len(rigid)
        E, to = None if E is None else E[:rows], to[:rows]
        L = np.hstack([rigid, -(to @ self._table("shape", self.grid_nodes, self.modes))])
        if self.seats is not None:
            shape = self._table("second_shape", self.second_nodes, self.second_modes)
            D = self._table("second_compliance", self.second_nodes, self.second_nodes)
            E = E + self.seats[:rows] @ (D @ self._pressed().T)
            L = np.hstack([L, -(self.seats[:rows] @ shape)])
        return None if E is None else E * self.acts, L

    def _pressed(self) -> Array:
        """Loads (x, nodes) [m2] on the nodes of the compliant second surface."""
        films, press = self.engine.compiled.films, self.spans["press"]
        function, value = films.press_function.numpy()[press], films.press_value.numpy()[press]
        loads = _gathered(function, value, self.basis.functions).T  # (functions, places)
        on = loads @ self.seats[films.press_seat.numpy()[press]]
        dense = on.toarray()
        return np.vstack([dense[self.free], dense[self.basis.node_function][: self.rough]])

    def _derivative(self, around: int, along: int, filling: int) -> Any:
        """(x, points) of R, from values of the points for both flows and the filling."""
        return (self.x.T @ sp.diags(self.line[:, int(around)]) + self.z.T @ sp.diags(self.line[:, int(along)])
                + self.value.T @ sp.diags(self.line[:, int(filling)]))  # fmt: skip

    def by_gap(self) -> Any:
        """H (x, points)."""
        return self._derivative(sampling.AROUND_BY_GAP, sampling.ALONG_BY_GAP, sampling.FILLING_BY_GAP)

    def system(self) -> tuple[Array, Array]:
        """J (x, x) and B (x, columns)."""
        n, points = len(self.free), len(self.line)
        E, L = self._openings()
        H = self.by_gap()
        A = self._derivative(sampling.AROUND_BY_PRESSURE, sampling.ALONG_BY_PRESSURE, sampling.FILLING_BY_PRESSURE)
        A = A @ self.value
        wide = self.line[:, int(sampling.CONDUCTANCE)]
        A = A + self.x.T @ sp.diags(wide) @ self.x
        A = A + self.z.T @ sp.diags(wide * self.line[:, int(sampling.EVENNESS)]) @ self.z
        J = np.zeros((n + self.rough, n + self.rough))
        J[:n, :n] = A.toarray() * ~self.is_void
        if E is not None:
            J[:n] += H @ E[:points]
        J[:n, :n] -= self._cavities()[:, self.free][self.free].toarray() * self.is_void
        stiff = self.node_line[:, int(sampling.STIFFNESS), None]
        touches = self.full[n:, None]
        if E is not None:
            J[n:] = touches * stiff * E[points:]
        J[n + np.arange(self.rough), n + np.arange(self.rough)] += 1.0
        return J, np.vstack([H @ L[:points], touches * stiff * L[points:]])

    def _cavities(self) -> Any:
        """a_0 m + T over all functions; with the Reynolds rule its diagonal."""
        basis: Basis = self.basis
        scratch = self.engine.scratch
        T = transport(basis, scratch.film_carried.numpy()[0, self.spans["function"]])
        T = T + sp.diags(float(scratch.film_rates.numpy()[0, 0]) * basis.area)
        return sp.csr_matrix(sp.diags(T.diagonal()) if self.rule == int(sampling.REYNOLDS) else T)

    def loads(self) -> Array:
        """P (x, columns)."""
        points = len(self.line)
        _, L = self._openings()
        weight = self.basis.weight
        by_point = (self.value.T @ sp.diags(weight * ~self._negative())).tocsr()
        at_nodes = _gathered(self.basis.grid_node, self.basis.between, self.grid_nodes).T @ sp.diags(weight)
        rigid = slice(0, int(unknowns.RIGID))
        of_nodes = sp.csr_matrix(at_nodes)[: self.rough]
        P = [np.vstack([by_point @ L[:points, rigid], of_nodes @ L[:points, rigid]])]
        moment = self._table("moment", self.modes, self.basis.functions)[:, self.free]
        P.append(-np.hstack([moment, self._table("rough_moment", self.modes, self.rough)]).T)
        if self.seats is not None:
            shape = self._table("second_shape", self.second_nodes, self.second_modes)
            P.append(-self._pressed() @ shape)
        return np.hstack(P) * self.acts[:, None]

    def _negative(self) -> Array:
        """Points at which a negative pressure exerts no load."""
        return (self.rule == int(sampling.HALF)) & (self.line[:, int(sampling.PRESSURE)] <= 0.0)

    def coordinates(self, count: int) -> Array:
        """(columns, count): the columns among the displacements, rotations and modes of all bodies."""
        m, rigid = self.engine.compiled.model, int(unknowns.RIGID)
        found = np.zeros((rigid + self.modes + self.second_modes, count))
        body, start = m.surfaces.body.numpy(), rigid
        for side, (surface, modes) in enumerate(zip(self.surfaces, (self.modes, self.second_modes), strict=True)):
            if body[surface] >= 0:
                found[6 * side : 6 * side + 6, 6 * body[surface] : 6 * body[surface] + 6] = np.eye(6)
            first = 6 * m.bodies.count + int(m.surfaces.modal_start.numpy()[surface])
            found[start : start + modes, first : first + modes] = np.eye(modes)
            start += modes
        return found


def _gathered(place: Array, part: Array, columns: int) -> Any:
    """Matrix (rows, columns) with the entries `part` (rows, some) at `place`, -1 for none."""
    row = np.repeat(np.arange(len(place)), place.shape[1])
    at = place.ravel() >= 0
    return sp.csr_matrix((part.ravel()[at], (row[at], place.ravel()[at])), shape=(len(place), columns))
