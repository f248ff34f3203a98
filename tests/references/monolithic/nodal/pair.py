r"""A contact pair with the law at the FE nodes of its first surface: forces on both bodies and their derivatives.

Node k with the share a of the area has the normal force a p and the tangential forces a tau_i, i = 1, 2 its tangents
t_i, p and tau of the laws (`layer_slopes`, `friction`) at the gap and the slip of `gap`. Virtual work gives the forces:

    F    = a p f + sum_i a tau_i t_i                       on A at the node's position X,  -F on B at the same point y
    A    -a p u_A-row + sum_i a tau_i (u_A,i-row)          on the coordinates of A (modes and local coordinates)
    B    -a p N Phi_B  - sum_ij a tau_i c_ij N Psi_B,j     c_ij = C t_i . b_j

with f = n the normal of B at the foot, in A's axes. Force and opposite force act along one line through one point:
action equals reaction exactly. The torque of a normal force on a body of revolution about its own axle is removed,
with opposite wrenches on both (`frame`).

phi = a (p, tau_1, tau_2) depends on the node's gap and slips alone, M = dphi/d(g, s) (3, 3) with dtau/dp dp/dg in its
first column: not symmetric. The dependence of gaps, slips and forces on the unknowns is in `tangent`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from references.monolithic.nodal.frame import Extra, Poses
from references.monolithic.nodal.friction import NodeTraction, node_traction
from references.monolithic.nodal.gap import RIGID, Opposite, leaning, nodes_at, opposite, tangents_at
from references.monolithic.nodal.layer_slopes import followed, layer_pressure
from references.monolithic.nodal.surface import NodeSide, PartnerSide

# columns of the memory of a node: gap, force of the layer, foot with l (3), u_A along t_i (2), U_B (3),
# traction (2)
GAP, FORCE, FOOT, OWN, OTHER, TRACTION = 0, 1, slice(2, 5), slice(5, 7), slice(7, 10), slice(10, 12)
REMEMBERED = 12
ITERATE = [0, 10, 11]  # those from which an iteration starts: gap and traction


@dataclass(eq=False)
class NodePairData:
    """The constant data of a pair. `columns`: its unknowns, rigid ones of A, of B unless B is the ground, then A's
    and B's coordinates; `rigid`: the number of rigid ones; `first`: its first row in `State.nodes`."""

    name: str
    a: NodeSide
    b: PartnerSide
    law: Any
    friction: Any
    stick: float  # Pa/m
    search: float  # Pa/m, c of `friction`
    columns: np.ndarray
    rigid: int
    first: int

    @property
    def count(self) -> int:
        """Number of nodes."""
        return len(self.a.share)

    @property
    def rows(self) -> slice:
        """The pair's rows of `State.nodes`."""
        return slice(self.first, self.first + self.count)

    @cached_property
    def extent(self) -> float:
        """The smaller radius [m] of the two shapes, between planes the extent of the nodes."""
        radii = [side.shape.size for side in (self.a, self.b) if side.shape.size > 0.0]
        return min(radii, default=float(np.ptp(self.a.place, axis=0).max()))

    @property
    def rough(self) -> bool:
        return self.friction.acts


@dataclass(frozen=True, eq=False)
class Sight:
    """The evaluation point of a pair: poses (r, A) of both bodies (for the ground 0 and 1), their coordinates q, the
    memory `before` (n, REMEMBERED), step size h [s], whether bodies are `moving` (else: no rates and no friction), and
    the previous iterate, gaps g^ of `layer_slopes` and tractions (n, 3), None for the laws themselves."""

    r_a: np.ndarray
    A_a: np.ndarray
    r_b: np.ndarray
    A_b: np.ndarray
    q_a: np.ndarray
    q_b: np.ndarray
    before: np.ndarray
    h: float
    moving: bool
    iterate: np.ndarray | None = None


class NodePairState:
    """A pair at a trial state: gap (n,), force (n,) [N] of the layer at each node, and derived quantities."""

    def __init__(self, data: NodePairData, sight: Sight) -> None:
        self.data, self.sight = data, sight
        a, b = data.a, data.b
        self.over: Opposite = opposite(a, b, sight.r_a, sight.A_a, sight.r_b, sight.A_b)
        self.rigid_gap = self.over.d
        self.own = own = a.field @ sight.q_a
        self.other = np.zeros((3, data.count))
        if self.over.cells is not None:
            self.other = np.asarray(nodes_at(b, self.over.cells) @ (b.field @ sight.q_b).T).T
        self.gap = self.over.d - own[0] - self.other[0]
        self.law_gap = self.gap if sight.iterate is None else followed(data.law, self.gap, sight.iterate[:, 0])
        layer = layer_pressure(data.law, self.law_gap, sight.before[:, GAP], sight.h, moving=sight.moving)
        linear = np.maximum(layer.pressure + layer.slope * (self.gap - self.law_gap), 0.0)
        self.pressure = np.where(self.over.faces, linear, 0.0)
        self.force = a.share * self.pressure
        self.active = np.flatnonzero(self.force > 0.0)
        at = self.active
        self.slope = layer.slope[at]
        self.layer_energy = float(a.share[at] @ layer.energy[at])
        self.layer_lost = float(a.share[self.over.faces] @ layer.lost[self.over.faces])
        self.slip = np.zeros((len(at), 2))
        self.traction: NodeTraction | None = None
        self.moved = self.lean = np.zeros((0, 3))
        if data.rough and sight.moving:
            self._rub()

    def _rub(self) -> None:
        """Slips and tractions of the active nodes; the stored deflection of released ones is lost."""
        at, sight, before = self.active, self.sight, self.sight.before
        b_j = tangents_at(self.data.b, self.over, at)
        lifted = np.einsum("jki,jk->ki", b_j, self.other[1:, at])
        self.lean = leaning(self.data.a, self.data.b, self.over, at)
        stands = self.over.foot[at] + self.lean * self.own[0, at, None]
        self.moved = stands - lifted - before[at, FOOT] + before[at, OTHER]
        directions = self.data.a.tangent[:, at] @ self.over.C.T
        self.slip = np.einsum("iks,ks->ki", directions, self.moved) + self.own[1:, at].T - before[at, OWN]
        tau = None if sight.iterate is None else sight.iterate[at, 1:]
        self.traction = node_traction(
            self.data.friction, self.pressure[at], self.slip, before[at, TRACTION], tau, stick=self.data.stick,
            search=self.data.search, h=sight.h,
        )  # fmt: skip

    # --- what the laws give

    @property
    def loads(self) -> np.ndarray:
        """phi (k, 3) [N] of the active nodes: normal force, tangential forces on A along t_i."""
        at = self.active
        tau = np.zeros((len(at), 2)) if self.traction is None else self.traction.traction
        return self.data.a.share[at, None] * np.column_stack([self.pressure[at], tau])

    @property
    def stiffness(self) -> np.ndarray:
        """M (k, 3, 3) [N/m] of the module docstring."""
        at = self.active
        M = np.zeros((len(at), 3, 3))
        M[:, 0, 0] = self.slope
        if self.traction is not None:
            M[:, 1:, 0] = self.traction.by_pressure * self.slope[:, None]
            M[:, 1:, 1:] = self.traction.by_slip
        return self.data.a.share[at, None, None] * M

    @property
    def stored(self) -> float:
        """Energy [J] of the layer and of the stretch of nodes that stick."""
        if self.traction is None:
            return self.layer_energy
        return self.layer_energy + float(self.data.a.share[self.active] @ self.traction.stored)

    @property
    def friction_lost(self) -> float:
        """Dissipation of friction in the step [J], never negative; includes the deflection of released nodes."""
        if self.traction is None:
            return 0.0
        share, before = self.data.a.share, self.sight.before[:, TRACTION]
        gone = np.ones(self.data.count, dtype=bool)
        gone[self.active] = False
        held = 0.0
        if not self.data.friction.creep_limit:
            held = float(share[gone] @ np.einsum("ki,ki->k", before[gone], before[gone])) / (2.0 * self.data.stick)
        return float(share[self.active] @ self.traction.lost) + held

    def remembered(self) -> np.ndarray:
        """Memory for the next step (n, REMEMBERED)."""
        out = np.zeros((self.data.count, REMEMBERED))
        out[:, GAP], out[:, FORCE], out[:, FOOT] = self.gap, self.force, self.over.foot
        out[:, OWN] = self.own[1:].T
        every = np.arange(self.data.count)
        if self.data.rough:
            out[:, FOOT] += leaning(self.data.a, self.data.b, self.over, every) * self.own[0, :, None]
        if self.data.rough and self.over.cells is not None:
            out[:, OTHER] = np.einsum("jki,jk->ki", tangents_at(self.data.b, self.over, every), self.other[1:])
        if self.traction is not None:
            out[self.active, TRACTION] = self.traction.traction
        return out

    # --- forces

    @property
    def lines(self) -> np.ndarray:
        """f, t_1, t_2 (3, k, 3) of the active nodes in A's axes."""
        a, at = self.data.a, self.active
        return np.concatenate([(self.over.normal[at] @ self.over.C)[None], a.tangent[:, at]])

    @cached_property
    def extra(self) -> Extra | None:
        """Effect of the normal forces in addition to those along the normals; None for a plane."""
        if self.data.a.shape.profile().planar or not len(self.active):
            return None
        nearest = int(self.active[np.argmin(self.over.d[self.active])])
        return Extra(self.data.a, self.data.b, self.active, nearest)

    @property
    def poses(self) -> Poses:
        """Of both bodies."""
        return Poses(self.sight.r_a, self.sight.A_a, self.sight.r_b, self.sight.A_b)

    @cached_property
    def extra_rows(self) -> np.ndarray:
        """Generalised force (k, 12) that a unit normal force of each active node adds."""
        if self.extra is None:
            return np.zeros((len(self.active), RIGID))
        return self.extra.rows(self.poses)

    def wrench(self) -> np.ndarray:
        """Generalised force (12,) on the rigid coordinates of A and of B (for the ground about its origin)."""
        C, at = self.over.C, self.active
        F = np.einsum("ck,ckx->kx", self.loads.T, self.lines)
        out, on_b = np.zeros(RIGID), F @ C.T
        out[:3] = self.sight.A_a @ F.sum(axis=0)
        out[3:6] = np.cross(self.data.a.place[at], F).sum(axis=0)
        out[6:9] = -out[:3]
        out[9:] = -np.cross(self.over.y[at], on_b).sum(axis=0)
        return out + self.loads[:, 0] @ self.extra_rows

    def second_loads(self) -> np.ndarray:
        """Loads (3, nodes of B) [N] on B's grid along its normal (positive inwards) and tangents."""
        b, at = self.data.b, self.active
        if self.over.cells is None:
            return np.zeros((3, 0))
        N = nodes_at(b, tuple(c[at] for c in self.over.cells))
        phi = self.loads
        along = -np.einsum("ki,ijk->jk", phi[:, 1:], self.turn())
        return np.stack([N.T @ phi[:, 0], N.T @ along[0], N.T @ along[1]])

    def turn(self) -> np.ndarray:
        """c_ij (2, 2, k): A's tangents in those of B."""
        at = self.active
        return np.einsum(
            "ikx,jkx->ijk", self.data.a.tangent[:, at] @ self.over.C.T, tangents_at(self.data.b, self.over, at)
        )

    def total(self) -> np.ndarray:
        """Generalised force (columns,) on the pair's unknowns."""
        a, b, phi = self.data.a, self.data.b, self.loads
        field = a.field[:, self.active]
        on_a = -(phi[:, 0] @ field[0])
        if self.traction is not None:
            on_a = on_a + phi[:, 1] @ field[1] + phi[:, 2] @ field[2]
        on_b = self.second_loads()
        by_b = -(on_b[0] @ b.field[0])
        if self.traction is not None:
            by_b = by_b + on_b[1] @ b.field[1] + on_b[2] @ b.field[2]
        return np.concatenate([self.wrench()[: self.data.rigid], on_a, by_b])

    @property
    def off(self) -> float:
        """Residual of pressures and tractions relative to the laws [N]."""
        away = 0.0 if self.traction is None else float(self.data.a.share[self.active] @ self.traction.off)
        if self.law_gap is self.gap:
            return away
        sight = self.sight
        true = layer_pressure(self.data.law, self.gap, sight.before[:, GAP], sight.h, moving=sight.moving).pressure
        return away + float(self.data.a.share @ np.where(self.over.faces, np.abs(true - self.pressure), 0.0))
