"""What a step of the monolithic solver takes and leaves, and the layout of its one system of unknowns."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np

from references.monolithic.core.description import SceneData
from warpffrf.model import rotation as rot


@dataclass
class State:
    """Accepted state. Rates come as velocity, acceleration and algorithmic acceleration.

    r (B, 3) m: centres of mass; p (B, 4): quaternions (x, y, z, w); v, v_rate, v_alg (B, 3) world axes; w, w_rate,
    w_alg (B, 3) body axes; q, qd, qdd, q_alg (n,): global modes of all bodies, then all local coordinates; lam (rows,):
    multipliers of the rigid rows; stretch: last values of all spring coordinates, which count revolutions; active (per
    pair): contact pressures by number of grid node or FE node; nodes (all nodes of pairs by their true shapes, k):
    memory of the law at nodes (`nodal.pair`); lost (2,) [J]: by friction and by layers, so far; locked (t, 2): of each
    pretension whether its length is locked, and the length [m]; film_nodes (functions of all films, 4), film_points
    (points, 2), film_step (1,) [s]: memory of oil films (`films.film`); pulls (markers, 6), lag (2, modes): memory of
    forces whose mean is given (`mean_work`).
    """

    time: float
    r: np.ndarray
    p: np.ndarray
    v: np.ndarray
    v_rate: np.ndarray
    v_alg: np.ndarray
    w: np.ndarray
    w_rate: np.ndarray
    w_alg: np.ndarray
    q: np.ndarray
    qd: np.ndarray
    qdd: np.ndarray
    q_alg: np.ndarray
    lam: np.ndarray
    stretch: np.ndarray
    active: list[dict[int, float]] = field(default_factory=list)
    nodes: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    lost: np.ndarray = field(default_factory=lambda: np.zeros(2))
    locked: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    film_nodes: np.ndarray = field(default_factory=lambda: np.zeros((0, 4)))
    film_points: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    film_step: np.ndarray = field(default_factory=lambda: np.zeros(1))
    pulls: np.ndarray = field(default_factory=lambda: np.zeros((0, 6)))
    lag: np.ndarray = field(default_factory=lambda: np.zeros((2, 0)))

    def copy(self) -> State:
        """An independent copy."""
        values = {}
        for f in fields(self):
            value = getattr(self, f.name)
            values[f.name] = value.copy() if isinstance(value, np.ndarray) else value
        values["active"] = [dict(a) for a in self.active]
        return State(**values)

    def rest(self) -> None:
        """All rates to zero."""
        for name in ("v", "v_rate", "v_alg", "w", "w_rate", "w_alg", "qd", "qdd", "q_alg"):
            getattr(self, name)[:] = 0.0


@dataclass(frozen=True, eq=False)
class Layout:
    """Numbers of unknowns: 6 per body (translation in world, rotation in body axes), global modes, `local`, rows.

    `mode_start` (B + 1,): first global mode of each body; `local_start`: first local coordinate of each contact
    surface, counted in `q`, and `local_count`: surfaces of one body can share theirs.
    """

    bodies: int
    mode_start: np.ndarray
    local: int
    local_start: tuple[int, ...]
    local_count: tuple[int, ...]
    rows: int

    @property
    def modes(self) -> int:
        """Global modes of all bodies."""
        return int(self.mode_start[-1])

    @property
    def flexible(self) -> int:
        """Global modes and local coordinates."""
        return self.modes + self.local

    @property
    def retained(self) -> int:
        """Rigid coordinates and global modes."""
        return 6 * self.bodies + self.modes

    @property
    def coordinates(self) -> int:
        """All unknowns but multipliers."""
        return 6 * self.bodies + self.flexible

    @property
    def size(self) -> int:
        """All unknowns but contact forces."""
        return self.coordinates + self.rows

    def body_modes(self, body: int) -> np.ndarray:
        """Indices in `q` of the global modes of a body."""
        return np.arange(self.mode_start[body], self.mode_start[body + 1])

    def of_body(self, body: int, flexible: bool) -> np.ndarray:
        """Unknowns of a body: its six rigid ones, and its global modes if `flexible`."""
        if body < 0:
            return np.zeros(0, dtype=np.intp)
        rigid = 6 * body + np.arange(6)
        if not flexible:
            return rigid
        return np.concatenate([rigid, 6 * self.bodies + self.body_modes(body)])

    def of_surface(self, surface: int) -> np.ndarray:
        """Unknowns of the local coordinates of a contact surface."""
        return 6 * self.bodies + self.local_start[surface] + np.arange(self.local_count[surface])


def layout_of(data: SceneData, counts: list[int], system_of: list[int]) -> Layout:
    """Layout of a scene with these numbers of local coordinates in each system, and of every contact surface the number
    of its system."""
    mode_start = np.cumsum([0] + [len(b.stiffness) for b in data.bodies])
    starts = int(mode_start[-1]) + np.cumsum([0, *counts])
    return Layout(
        len(data.bodies), mode_start, sum(counts), tuple(int(starts[s]) for s in system_of),
        tuple(counts[s] for s in system_of), len(data.constraints),
    )  # fmt: skip


def initial_state(scene: Any, data: SceneData, layout: Layout, pairs: int) -> State:
    """The scene's initial poses and velocities, undeformed."""
    B, n = layout.bodies, layout.flexible
    r, p, v, w = np.zeros((B, 3)), np.zeros((B, 4)), np.zeros((B, 3)), np.zeros((B, 3))
    for i, body in enumerate(scene.bodies):
        A = rot.matrix(body.rotation)
        arm = A @ body.center_of_mass
        r[i], p[i] = body.position + arm, body.rotation
        v[i] = body.velocity + np.cross(body.angular_velocity, arm)
        w[i] = A.T @ body.angular_velocity
    zero = np.zeros((B, 3))
    stretch = np.zeros(sum(len(s.coordinates) for s in data.springs))
    return State(
        0.0, r, p, v, zero.copy(), zero.copy(), w, zero.copy(), zero.copy(),
        np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(layout.rows), stretch, [{} for _ in range(pairs)],
        locked=np.zeros((len(data.tensions), 2)), pulls=np.zeros((len(data.markers), 6)),
        lag=np.zeros((2, layout.modes)),
    )  # fmt: skip
