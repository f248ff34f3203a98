r"""How gaps, slips and forces of a pair with the law at nodes change with its unknowns.

With L (m k, columns) what unit forces of the k active nodes load (one block of k along the normal and, with friction,
one along each tangent), R (m k, columns) the gradients of gap and slips, and phi, M of `pair`,

    d(force) = L^T M R dz + (dL)^T phi,

the second part, by rigid coordinates, is `turning`. On the coordinates of both bodies L and R are the same but for
the lean of slips; on the rigid ones they are not: the force has what `frame` adds, and leaves out how the place on
B's hats moves. With C = A_B^T A_A, tangents t of A and what a force F in A's axes is on both bodies,

    d(C t) = C (dtheta_A x t) - dtheta_B x C t,      d(C^T n) = C^T (dn + dtheta_B x n) - dtheta_A x C^T n,
    (A_A F, X x F, -A_A F, -y x C F).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from warpffrf.monolithic.core.rotation import hat
from warpffrf.monolithic.nodal.gap import RIGID, hats_at, motion

if TYPE_CHECKING:
    from warpffrf.monolithic.nodal.pair import NodePairState


class NodeTangent:
    """Derivatives at the active nodes of `pair`."""

    def __init__(self, pair: NodePairState) -> None:
        self.pair = pair
        self.motion = motion(pair.data.a, pair.data.b, pair.over, pair.active, pair.sight.A_b)
        self._known: tuple[np.ndarray, np.ndarray] | None = None

    def rows(self) -> tuple[np.ndarray, np.ndarray]:
        """`_rows`, found once."""
        if self._known is None:
            self._known = self._rows()
        return self._known

    def _rows(self) -> tuple[np.ndarray, np.ndarray]:
        """L and R (m k, columns) of the active nodes, one block of k for the gap and, with friction, one a tangent."""
        pair = self.pair
        a, b, at, C, A_a = pair.data.a, pair.data.b, pair.active, pair.over.C, pair.sight.A_a
        moves, lines, k = self.motion, pair.lines, len(at)
        parts = 1 if pair.traction is None else 3
        rigid = pair.data.rigid
        load, gradient = np.zeros((parts, k, RIGID)), np.zeros((parts, k, RIGID))
        for c in range(parts):
            load[c, :, :3] = lines[c] @ A_a.T
            load[c, :, 3:6] = np.cross(a.place[at], lines[c])
            load[c, :, 6:9] = -load[c, :, :3]
            load[c, :, 9:] = -np.cross(pair.over.y[at], lines[c] @ C.T)
        load[0] += pair.extra_rows
        gradient[0] = np.einsum("ki,kic->kc", pair.over.normal[at], moves.y)
        own = [-a.field[0][at]] + [a.field[i][at] for i in range(1, parts)]
        by_a = np.concatenate(own)
        by_b = np.zeros((parts * k, b.field.shape[2]))
        stretch = np.zeros((3, k, RIGID))  # of u_B along normal and tangents with the foot
        if pair.over.cells is not None:
            cells = tuple(x[at] for x in pair.over.cells)
            values = (b.field @ pair.sight.q_b).T
            by_x, by_z = (np.asarray(hats_at(b, cells, by) @ values) for by in ("x", "z"))
            stretch = by_x.T[:, :, None] * moves.column + by_z.T[:, :, None] * moves.axial
            N = hats_at(b, cells)
            traces = [np.asarray(N @ b.field[c]) for c in range(parts)]
            by_b[:k] = -traces[0]
            turn = pair.turn()
            for i in range(1, parts):
                by_b[i * k : (i + 1) * k] = -np.einsum("jk,jkc->kc", turn[i - 1], np.stack(traces[1:]))
        gradient[0] -= stretch[0]
        leant = by_a.copy()
        for i in range(1, parts):
            t, dt = lines[i] @ C.T, _turned(lines[i], C)
            gradient[i] = np.einsum("ki,kic->kc", t, moves.foot) + np.einsum("ki,kic->kc", pair.moved, dt)
            leant[i * k : (i + 1) * k] += np.einsum("ki,ki->k", t, pair.lean)[:, None] * a.field[0][at]
            for j in range(2):
                gradient[i] -= np.einsum("ki,ki->k", t, moves.tangents[j])[:, None] * stretch[1 + j]
                gradient[i] -= np.einsum("ki,kic->kc", t, moves.turned[j]) * pair.other[1 + j, at, None]
        L = np.hstack([load.reshape(parts * k, RIGID)[:, :rigid], by_a, by_b])
        R = np.hstack([gradient.reshape(parts * k, RIGID)[:, :rigid], leant, by_b])
        return L, R

    def turning(self) -> np.ndarray:
        """Derivative (columns, rigid) of the forces by the rigid coordinates at fixed phi."""
        pair = self.pair
        a, b, at, C, A_a = pair.data.a, pair.data.b, pair.active, pair.over.C, pair.sight.A_a
        moves, lines, phi, k = self.motion, pair.lines, pair.loads, len(pair.active)
        F = np.einsum("kc,ckx->kx", phi, lines)
        m = pair.over.normal[at] @ C
        dm = np.einsum("xi,kic->kxc", C.T, moves.normal)
        dm[:, :, 3:6] += hat(m)
        dm[:, :, 9:] += -C.T @ hat(pair.over.normal[at])
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
        out[9:] = np.einsum("kxi,kic->xc", hat(on_b), moves.y) - np.einsum("kxi,kic->xc", hat(pair.over.y[at]), d_on_b)
        rigid = pair.data.rigid
        if pair.extra is not None:
            out[:, :rigid] += pair.extra.slope(pair.poses, phi[:, 0], rigid)
        by_b = np.zeros((b.field.shape[2], RIGID))
        if pair.over.cells is not None and k:
            by_b = self._second_turning(phi, lines)
        by_a = np.zeros((a.field.shape[2], RIGID))
        return np.vstack([out[:rigid], by_a, by_b])[:, :rigid]

    def _second_turning(self, phi: np.ndarray, lines: np.ndarray) -> np.ndarray:
        """Derivative (columns of B, 12) of the loads on B's coordinates: hats at the feet, and A's tangents in B's."""
        pair, moves = self.pair, self.motion
        b, at, C = pair.data.b, pair.active, pair.over.C
        cells = tuple(x[at] for x in (pair.over.cells or ()))
        N, by_x, by_z = (hats_at(b, cells, by) for by in ("", "x", "z"))

        def spread(forces: np.ndarray) -> np.ndarray:
            return by_x.T @ (forces[:, None] * moves.column) + by_z.T @ (forces[:, None] * moves.axial)

        out = -(b.field[0].T @ spread(phi[:, 0]))
        if pair.traction is None:
            return out
        turn = pair.turn()
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


def _turned(t: np.ndarray, C: np.ndarray) -> np.ndarray:
    """d(C t) (k, 3, 12) of vectors t (k, 3) that are fixed in A, by the rigid coordinates."""
    out = np.zeros((len(t), 3, RIGID))
    out[:, :, 3:6] = -C @ hat(t)
    out[:, :, 9:] = hat(t @ C.T)
    return out
