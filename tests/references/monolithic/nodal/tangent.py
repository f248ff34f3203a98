r"""Derivatives of gaps, slips and forces of a pair with the law at nodes by its unknowns.

With L (m k, columns) the generalised forces of unit forces of the k active nodes (one block of k along the normal and,
with friction, one along each tangent), R (m k, columns) the gradients of gap and slips, and phi, M of `pair`,

    d(force) = L^T M R dz + (dL)^T phi,

the second part, by rigid coordinates, is `turning`. On the coordinates of both bodies L and R are equal except for
the term l of slips; on the rigid ones they differ: the force includes the part of `frame`, and omits the motion of the
point on B's grid. With C = A_B^T A_A, tangents t of A and the effect of a force F in A's axes on both bodies,

    d(C t) = C (dtheta_A x t) - dtheta_B x C t,      d(C^T n) = C^T (dn + dtheta_B x n) - dtheta_A x C^T n,
    (A_A F, X x F, -A_A F, -y x C F).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from references.monolithic.core.rotation import hat
from references.monolithic.nodal.gap import RIGID, Motion, motion, nodes_at
from references.monolithic.nodal.pair import NodePairState


class LinearisedPair(NodePairState):
    """A pair at a trial state with the derivatives at its active nodes."""

    @cached_property
    def moves(self) -> Motion:
        """Motion of feet, normals and tangents with the rigid coordinates."""
        return motion(self.data.a, self.data.b, self.over, self.active, self.sight.A_b)

    @cached_property
    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """L and R (m k, columns) of the active nodes, a block of k for the gap and, with friction, one per tangent."""
        a, b, at, C, A_a = self.data.a, self.data.b, self.active, self.over.C, self.sight.A_a
        moves, lines, k = self.moves, self.lines, len(at)
        parts = 1 if self.traction is None else 3
        rigid = self.data.rigid
        load, gradient = np.zeros((parts, k, RIGID)), np.zeros((parts, k, RIGID))
        for c in range(parts):
            load[c, :, :3] = lines[c] @ A_a.T
            load[c, :, 3:6] = np.cross(a.place[at], lines[c])
            load[c, :, 6:9] = -load[c, :, :3]
            load[c, :, 9:] = -np.cross(self.over.y[at], lines[c] @ C.T)
        load[0] += self.extra_rows
        gradient[0] = np.einsum("ki,kic->kc", self.over.normal[at], moves.y)
        own = [-a.field[0][at]] + [a.field[i][at] for i in range(1, parts)]
        by_a = np.concatenate(own)
        by_b = np.zeros((parts * k, b.field.shape[2]))
        stretch = np.zeros((3, k, RIGID))  # of u_B along normal and tangents with the foot
        if self.over.cells is not None:
            cells = tuple(x[at] for x in self.over.cells)
            values = (b.field @ self.sight.q_b).T
            by_x, by_z = (np.asarray(nodes_at(b, cells, by) @ values) for by in ("x", "z"))
            stretch = by_x.T[:, :, None] * moves.column + by_z.T[:, :, None] * moves.axial
            N = nodes_at(b, cells)
            traces = [np.asarray(N @ b.field[c]) for c in range(parts)]
            by_b[:k] = -traces[0]
            turn = self.turn()
            for i in range(1, parts):
                by_b[i * k : (i + 1) * k] = -np.einsum("jk,jkc->kc", turn[i - 1], np.stack(traces[1:]))
        gradient[0] -= stretch[0]
        leant = by_a.copy()
        for i in range(1, parts):
            t, dt = lines[i] @ C.T, _turned(lines[i], C)
            gradient[i] = np.einsum("ki,kic->kc", t, moves.foot) + np.einsum("ki,kic->kc", self.moved, dt)
            leant[i * k : (i + 1) * k] += np.einsum("ki,ki->k", t, self.lean)[:, None] * a.field[0][at]
            for j in range(2):
                gradient[i] -= np.einsum("ki,ki->k", t, moves.tangents[j])[:, None] * stretch[1 + j]
                gradient[i] -= np.einsum("ki,kic->kc", t, moves.turned[j]) * self.other[1 + j, at, None]
        L = np.hstack([load.reshape(parts * k, RIGID)[:, :rigid], by_a, by_b])
        R = np.hstack([gradient.reshape(parts * k, RIGID)[:, :rigid], leant, by_b])
        return L, R

    def turning(self) -> np.ndarray:
        """Derivative (columns, rigid) of the forces by the rigid coordinates at fixed phi."""
        a, b, at, C, A_a = self.data.a, self.data.b, self.active, self.over.C, self.sight.A_a
        moves, lines, phi, k = self.moves, self.lines, self.loads, len(self.active)
        F = np.einsum("kc,ckx->kx", phi, lines)
        m = self.over.normal[at] @ C
        dm = np.einsum("xi,kic->kxc", C.T, moves.normal)
        dm[:, :, 3:6] += hat(m)
        dm[:, :, 9:] += -C.T @ hat(self.over.normal[at])
        dF = phi[:, 0, None, None] * dm
        world = np.einsum("xi,kic->kxc", A_a, dF)
        world[:, :, 3:6] += -A_a @ hat(F)
        on_b = F @ C.T
        d_on_b = np.einsum("xi,kic->kxc", C, dF)
        d_on_b[:, :, 3:6] += -C @ hat(F)
        d_on_b[:, :, 9:] += hat(on_b)
        out = np.zeros((RIGID, RIGID))
        out[:3] = world.sum(axis=0)
        out[3:6] = np.einsum("kxi,kic->xc", hat(a.place[at]), dF)
        out[6:9] = -out[:3]
        out[9:] = np.einsum("kxi,kic->xc", hat(on_b), moves.y) - np.einsum("kxi,kic->xc", hat(self.over.y[at]), d_on_b)
        rigid = self.data.rigid
        if self.extra is not None:
            out[:, :rigid] += self.extra.slope(self.poses, phi[:, 0], rigid)
        by_b = np.zeros((b.field.shape[2], RIGID))
        if self.over.cells is not None and k:
            by_b = self._second_turning(phi, lines)
        by_a = np.zeros((a.field.shape[2], RIGID))
        return np.vstack([out[:rigid], by_a, by_b])[:, :rigid]

    def _second_turning(self, phi: np.ndarray, lines: np.ndarray) -> np.ndarray:
        """Derivative (columns of B, 12) of the loads on B's coordinates: functions at the feet, A's tangents in B's."""
        moves = self.moves
        b, at, C = self.data.b, self.active, self.over.C
        cells = tuple(x[at] for x in (self.over.cells or ()))
        N, by_x, by_z = (nodes_at(b, cells, by) for by in ("", "x", "z"))

        def spread(forces: np.ndarray) -> np.ndarray:
            return by_x.T @ (forces[:, None] * moves.column) + by_z.T @ (forces[:, None] * moves.axial)

        out = -(b.field[0].T @ spread(phi[:, 0]))
        if self.traction is None:
            return out
        turn = self.turn()
        for j in range(2):
            force = np.einsum("ki,ik->k", phi[:, 1:], turn[:, j])
            change = np.zeros((len(at), RIGID))
            for i in range(2):
                dt = _turned(lines[1 + i], C)
                by_j = np.einsum("ki,kic->kc", moves.tangents[j], dt)
                by_j += np.einsum("ki,kic->kc", lines[1 + i] @ C.T, moves.turned[j])
                change += phi[:, 1 + i, None] * by_j
            out -= b.field[1 + j].T @ (spread(force) + N.T @ change)
        return out

    # --- what a Newton iteration takes

    def weighted(self, R: np.ndarray) -> np.ndarray:
        """-M R: the rows R times the stiffness that goes into the Jacobian."""
        k, M = len(self.active), self.stiffness
        parts = len(R) // k if k else 0
        by_node = R.reshape(parts, k, -1)
        return -np.einsum("kij,jkc->ikc", M[:, :parts, :parts], by_node).reshape(R.shape)

    def constant(self) -> np.ndarray:
        """Generalised force (columns,) of the part of the change of tau that does not depend on the unknowns."""
        if self.traction is None or not len(self.active):
            return np.zeros(len(self.data.columns))
        L, _ = self.rows
        a = self.data.a.share[self.active]
        return (a[:, None] * self.traction.constant).T.ravel() @ L[len(self.active) :]

    def updated(self, dz: np.ndarray) -> np.ndarray:
        """The next iterate (n, 3): g^, and tractions after the linearised change for the unknowns'
        changes dz (columns,)."""
        out = np.zeros((self.data.count, 3))
        out[:, 0] = self.law_gap
        if self.traction is not None and len(self.active):
            _, R = self.rows
            change = (R @ dz).reshape(3, -1)
            t = self.traction
            out[self.active, 1:] = t.traction + t.constant + t.by_pressure * (self.slope * change[0])[:, None]
            out[self.active, 1:] += np.einsum("kij,jk->ki", t.by_slip, change[1:])
        return out


def _turned(t: np.ndarray, C: np.ndarray) -> np.ndarray:
    """d(C t) (k, 3, 12) of vectors t (k, 3) that are fixed in A, by the rigid coordinates."""
    out = np.zeros((len(t), 3, RIGID))
    out[:, :, 3:6] = -C @ hat(t)
    out[:, :, 9:] = hat(t @ C.T)
    return out
