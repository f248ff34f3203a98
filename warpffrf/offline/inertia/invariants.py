r"""Inertia invariants from any mass matrix and modes at all nodes (`warpffrf.model.reduced.inertia` says what they
mean).

A turn about axis a moves the nodes by `R_a u`, `e_a x u` at every node. The kinetic energy of the nodal velocities
`R_w (X + U q) + U qdot` is a quadratic form of M, without lumping it:

    w.J1_i w = 2 (R_w X)^T M (R_w phi_i),     w.J2_ij w = (R_w phi_i)^T M (R_w phi_j),
    2 e_a.G_ij = (R_a phi_i)^T M phi_j - (R_a phi_j)^T M phi_i,

J2 made symmetric in its axes, which is all that w.J2_ij w tells of it. Of the mass matrix of finite elements, or any
other that has no direction of its own, G is antisymmetric in itself. With `(R_a u)^T y = -u^T (R_a y)` only M times
turned modes is ever formed, a block of modes at a time; `BLOCK` bounds the memory beside the modes themselves.

The consistent mass of finite elements is one scalar matrix m for all three components. All then follows from the
moments `int X phi_i^T dm` and `int phi_i phi_j^T dm` with three products by m, at a tenth of the cost (`from_moments`).
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model.mesh.rigid import rigid_modes
from warpffrf.model.reduced.inertia import InertiaTerms
from warpffrf.offline.bases.modes import whole_multiples

Array = np.ndarray
MODES = 60  # covered unless more are asked for: tables grow with the square, and modes above follow turning at rest
BLOCK = 16  # modes turned at a time


def covered_modes(omega: Array, asked: int | None) -> int:
    """How many of the modes `omega` (m,) [rad/s] get inertia terms: the number `asked` for, None: `MODES`; raised where
    it would cut a multiple frequency apart, so that the terms of a round body stay round."""
    return whole_multiples(omega, MODES if asked is None else asked)


def inertia_terms(M: Any, U: Array, points: Array, center: Array) -> InertiaTerms:
    """Invariants of the modes `U` (3 n, k) at the nodes `points` (n, 3) [m]; `M` (3 n, 3 n) [kg] sparse mass matrix,
    `center` (3,) [m] of mass."""
    if (m := scalar_mass(M)) is not None:
        return from_moments(*moments(m, U, points - center))
    k = U.shape[1]
    RX = rigid_modes(points, center)[:, 3:]
    first, second, gyroscopic = np.zeros((k, 3, 3)), np.zeros((k, k, 3, 3)), np.zeros((k, k, 3))
    for start in range(0, k, BLOCK):
        part = slice(start, start + BLOCK)
        block = U[:, part]
        MU = M @ block
        for b in range(3):
            gyroscopic[:, part, b] = -(U.T @ turned(MU, b))
            turn = M @ turned(block, b)
            first[part, :, b] = turn.T @ RX
            for a in range(b + 1):
                second[:, part, a, b] = -(U.T @ turned(turn, a))
    for a, b in ((0, 1), (0, 2), (1, 2)):
        mixed = 0.5 * (second[:, :, a, b] + second[:, :, a, b].T)
        second[:, :, a, b] = second[:, :, b, a] = mixed
    return InertiaTerms(
        first + first.transpose(0, 2, 1),
        0.5 * (second + second.transpose(1, 0, 2, 3)),
        0.5 * (gyroscopic - gyroscopic.transpose(1, 0, 2)),
    )


def turned(U: Array, axis: int) -> Array:
    """e_axis x u at every node, of fields (3 n, k)."""
    a, b = (axis + 1) % 3, (axis + 2) % 3
    out = np.zeros_like(U)
    out[a::3], out[b::3] = -U[b::3], U[a::3]
    return out


def scalar_mass(M: Any) -> Any | None:
    """m (n, n) csr where M (3 n, 3 n) is m for every component and couples none, else None."""
    M = sp.csr_matrix(M)
    entries = M.tocoo()
    apart = entries.row % 3 != entries.col % 3
    if np.any(entries.data[apart] != 0.0):
        return None
    m = M[0::3][:, 0::3]
    alike = all((m != M[c::3][:, c::3]).nnz == 0 for c in (1, 2))
    return m if alike else None


def moments(m: Any, U: Array, X: Array) -> tuple[Array, Array]:
    """int X phi_i^T dm (k, 3, 3) [kg m] and int phi_i phi_j^T dm (k, k, 3, 3) [kg] of the modes `U` (3 n, k) with the
    scalar mass matrix `m` (n, n) [kg]; `X` (n, 3) [m] about the centre of mass."""
    k = U.shape[1]
    first, second = np.zeros((k, 3, 3)), np.zeros((k, k, 3, 3))
    for b in range(3):
        moving = m @ U[b::3]
        first[:, :, b] = moving.T @ X
        for a in range(b + 1):
            second[:, :, a, b] = U[a::3].T @ moving
            second[:, :, b, a] = second[:, :, a, b].T
    return first, second


def from_moments(first: Array, second: Array) -> InertiaTerms:
    """Invariants from the moments `first` (k, 3, 3) = int X phi_i^T dm [kg m] about the centre of mass and `second`
    (k, k, 3, 3) = int phi_i phi_j^T dm [kg]: the definitions with a mass that has no direction of its own."""
    one = np.eye(3)
    trace_1 = np.trace(first, axis1=1, axis2=2)[:, None, None]
    trace_2 = np.trace(second, axis1=2, axis2=3)[:, :, None, None]
    J1 = 2.0 * trace_1 * one - first - first.transpose(0, 2, 1)
    J2 = trace_2 * one - 0.5 * (second + second.transpose(0, 1, 3, 2))
    skew = second - second.transpose(0, 1, 3, 2)
    G = np.stack([skew[:, :, 1, 2], skew[:, :, 2, 0], skew[:, :, 0, 1]], axis=2)
    return InertiaTerms(J1, 0.5 * (J2 + J2.transpose(1, 0, 2, 3)), 0.5 * (G - G.transpose(1, 0, 2)))
