r"""Inertia forces of a body and their tangent, rigid part and the terms of deformation.

With w the angular velocity in body axes, J0 the inertia and the arrays J1 (k, 3, 3), J2 (k, k, 3, 3), G (k, k, 3) of
`warpffrf.model.reduced.inertia` for the first k modes (those of the body's level; the others zero),

    P_j = J1_j + 2 sum_i J2_ij q_i,   g_j = sum_i q_i G_ij,   g'_j, g''_j the same with qdot, qddot,
    dJ = sum_i q_i (P_i + J1_i)/2,    dJ' = sum_i qdot_i P_i,   h = sum_j g_j qdot_j,

    torque    (J0 + dJ) wdot + dJ' w + sum_j g_j qddot_j + w x ((J0 + dJ) w + h),
    mode j    2 w.g'_j + wdot.g_j - w.P_j w/2.

Geometric stiffening by rotation, K_c = sum_ab w_a w_b Kc_ab, is the energy q.K_c q/2 that bending takes from the
rotation because the body becomes shorter, so it enters J2 as -Kc.

Tangent. By a step's formulas dqdot = VEL dq, dqddot = ACC dq, and with the body rotated by dtheta about its own axes
dw = VEL T^-1 dtheta, dwdot = ACC T^-1 dtheta. As G_ij = -G_ji and P'_j = 2 sum_i J2_ij qdot_i is the slope of dJ' by
q_j,

    d torque/dq_j   = P_j wdot + (VEL P_j + P'_j) w + ACC g_j - g''_j + w x (P_j w + VEL g_j - g'_j),
    d torque/dw     = VEL (dJ' + w^ J - (J w + h)^) + ACC J                       (ACC from dwdot),
    d mode_j/dw     = VEL (2 g'_j - P_j w) + ACC g_j,
    d mode_j/dq_i   = 2 VEL w.G_ij + wdot.G_ij - w.J2_ij w.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from references.monolithic.core.rotation import hat
from warpffrf.model.reduced.inertia import InertiaTerms


@dataclass(frozen=True, eq=False)
class DeformationTerms:
    """J1, J2 and G of a body's level, the stiffening by rotation in J2, flattened for products with q."""

    first: np.ndarray  # (k, 9)
    second: np.ndarray  # (k, k, 9)
    gyroscopic: np.ndarray  # (k, k, 3)

    @property
    def count(self) -> int:
        """Modes with inertia terms."""
        return len(self.first)


def deformation_terms(terms: InertiaTerms | None, level: str, stiffened: bool) -> DeformationTerms | None:
    """The arrays of `terms` retained by `level`; None if there are none."""
    if terms is None or (level == "constant" and not stiffened):
        return None
    k = terms.modes
    first, second, gyroscopic = terms.kept(level, stiffened=stiffened)
    return DeformationTerms(first.reshape(k, 9), second.reshape(k, k, 9), gyroscopic)


@dataclass(frozen=True, eq=False)
class InertiaForces:
    """Torque (3,) in body axes, modal forces (k,), and the blocks of the tangent: torque by rotation (3, 3) and modes
    (3, k), modes by rotation (k, 3) and modes (k, k), the rotation before T^-1; `energy` w.J w/2 + w.h."""

    torque: np.ndarray
    modal: np.ndarray
    turn_turn: np.ndarray
    turn_modes: np.ndarray
    modes_turn: np.ndarray
    modes_modes: np.ndarray
    energy: float


def inertia_forces(
    J0: np.ndarray,
    terms: DeformationTerms | None,
    w: np.ndarray,
    w_rate: np.ndarray,
    q: np.ndarray,
    qd: np.ndarray,
    qdd: np.ndarray,
    vel: float,
    acc: float,
) -> InertiaForces:
    """Forces and tangent of the module docstring; q, qd, qdd are those of all modes of the body."""
    if terms is None:
        Jw = J0 @ w
        W = hat(w)
        S = acc * J0 + vel * (W @ J0 - hat(Jw))
        none, torque = np.zeros((3, 0)), J0 @ w_rate + W @ Jw
        return InertiaForces(torque, np.zeros(0), S, none, none.T, np.zeros((0, 0)), 0.5 * float(w @ Jw))
    k = terms.count
    q, qd, qdd = q[:k], qd[:k], qdd[:k]
    bend = np.tensordot(q, terms.second, 1)
    P = (terms.first + 2.0 * bend).reshape(k, 3, 3)
    P_rate = (2.0 * np.tensordot(qd, terms.second, 1)).reshape(k, 3, 3)
    g, g1, g2 = (np.tensordot(x, terms.gyroscopic, 1) for x in (q, qd, qdd))
    J = J0 + np.tensordot(q, (terms.first + bend).reshape(k, 3, 3), 1)
    J_rate = np.tensordot(qd, P, 1)
    h, h_rate = qd @ g, qdd @ g
    L = J @ w + h
    W = hat(w)
    Pw = P @ w
    modal = 2.0 * g1 @ w + g @ w_rate - 0.5 * Pw @ w
    turn = vel * (J_rate + W @ J - hat(L)) + acc * J
    by_modes = P @ w_rate + vel * Pw + P_rate @ w + acc * g - g2 + np.cross(w, Pw + vel * g - g1)
    by_turn = vel * (2.0 * g1 - Pw) + acc * g
    pairs = terms.gyroscopic @ (2.0 * vel * w + w_rate) - terms.second @ np.outer(w, w).ravel()
    pairs = pairs.T.copy()  # line j, column i
    energy = 0.5 * float(w @ J @ w) + float(w @ h)
    return InertiaForces(J @ w_rate + J_rate @ w + h_rate + W @ L, modal, turn, by_modes.T, by_turn, pairs, energy)
