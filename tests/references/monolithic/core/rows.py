r"""Rows of joints and springs: value, generalised force and the exact derivatives of both, in NumPy.

A row is a scalar function c of two markers (kinds in `warpffrf.model.joints.base` and `model.forces.laws`). A marker
is fixed to a body, or to an interface that moves by (u, theta) = Phi^T q about its point X_f:

    x = r + A (X + u + theta x (X - X_f)),      R = A exp(theta^) L.

Coordinates y of a body are dr (world), dtheta (body axes; the world rotation is A dtheta) and dq. With T_l the left
tangent of the rotation group,

    dx = dr - (x - r)^ A dtheta + A (Phi_t^T dq - (X - X_f)^ Phi_r^T dq),   rotation of R = A dtheta + A T_l Phi_r^T dq.

Every kind has a force f and a torque t with dc = f.(dx_b - dx_a) + t.(rot_b - rot_a) for displacements of the
material points at x_b. The generalised force is that wrench at x_b on b and its opposite on a,

    (f,  A^T ((x_b - r) x f + t),  Phi (A^T f,  A^T ((x_b - x) x f + t) + (X - X_f) x A^T f)),

as in the separated solver: the torque t acts on the interface itself, so that the modal part is the gradient of c to
first order in theta. With geometric stiffness the interface moves by Phi^T q - q.K_k q/2 and Phi - K_k q replaces Phi.
Both derivatives below are those of these formulas: `slope` of c, and `turning` of the generalised force.
d(A^T M) = A^T (dM + M^ A dtheta); the kinds' df and dt follow from du = rotation x u of an axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from references.monolithic.core.rotation import (
    cross,
    hat,
    left_tangent,
    rotation_vector,
    tangent_inverse,
    tangent_inverse_change,
)
from warpffrf.model.rotation import rotation_vector_matrix

NO_COLUMNS = np.zeros((3, 0))
NO_LENGTH = 1e-300  # m: a distance of zero has no direction, and makes no NaN


@dataclass(frozen=True, eq=False)
class MarkerPlace:
    """A marker fixed to body `body` (-1: the ground) at `point` (3,) with `axes` (3, 3), body axes about the centre of
    mass; `modes` (m, 6) and `pivot` (3,) of its interface, or None; `stiffening` (6, k, k) of the interface or None."""

    body: int
    point: np.ndarray
    axes: np.ndarray
    modes: np.ndarray | None = None
    pivot: np.ndarray | None = None
    stiffening: np.ndarray | None = None

    def slope(self, q: np.ndarray) -> np.ndarray:
        """Derivative (m, 6) of the interface's motion by the modes: Phi - K_k q."""
        slope = np.array(self.modes, dtype=np.float64)
        if self.stiffening is None:
            return slope
        k = self.stiffening.shape[1]
        slope[:k] -= (self.stiffening @ q[:k]).T
        return slope

    def motion(self, q: np.ndarray) -> np.ndarray:
        """Translation and rotation (6,) of the interface, body axes: Phi^T q - q.K_k q/2."""
        return 0.5 * q @ (self.modes + self.slope(q))


@dataclass(frozen=True, eq=False)
class MarkerState:
    """Position of a marker: x, R, origin r and axes A of its body, and their derivatives by its body's coordinates:
    `moved` (3, n) of x, `turned` (3, n) of R, `carried` (3, n) rotation of the body, all in world axes."""

    place: MarkerPlace
    x: np.ndarray
    R: np.ndarray
    r: np.ndarray
    A: np.ndarray
    moved: np.ndarray
    turned: np.ndarray
    carried: np.ndarray
    slope: np.ndarray | None = None


def marker_state(place: MarkerPlace, r: np.ndarray, A: np.ndarray, q: np.ndarray) -> MarkerState:
    """The marker on its body at `r` with axes `A` (3, 3) and modal coordinates `q`; for the ground all are ignored."""
    if place.body < 0:
        zero = np.zeros(3)
        return MarkerState(place, place.point, place.axes, zero, np.eye(3), NO_COLUMNS, NO_COLUMNS, NO_COLUMNS)
    m = 0 if place.modes is None else len(q)
    moved, turned, carried = np.zeros((3, 6 + m)), np.zeros((3, 6 + m)), np.zeros((3, 6 + m))
    arm, R, slope = place.point, A @ place.axes, None
    if place.modes is not None:
        lever = place.point - place.pivot
        slope, motion = place.slope(q), place.motion(q)
        arm = place.point + motion[:3] + cross(motion[3:], lever)
        bent = rotation_vector_matrix(motion[3:])
        R = A @ bent @ place.axes
        moved[:, 6:] = A @ (slope[:, :3].T - hat(lever) @ slope[:, 3:].T)
        turned[:, 6:] = A @ left_tangent(motion[3:]) @ slope[:, 3:].T
    moved[:, :3] = np.eye(3)
    moved[:, 3:6] = -hat(A @ arm) @ A
    turned[:, 3:6] = carried[:, 3:6] = A
    return MarkerState(place, r + A @ arm, R, r, A, moved, turned, carried, slope)


@dataclass(frozen=True, eq=False)
class RowStates:
    """k rows of two markers at a pose: c (k,), `slope` dc/dy (k, n), the generalised `force` (k, n) of unit multipliers
    and its `turning` (k, n, n); y are the coordinates of a's body, then those of b's. `wrench` (k, 6): f and t on b at
    x_b, world axes."""

    value: np.ndarray
    slope: np.ndarray
    force: np.ndarray
    turning: np.ndarray
    wrench: np.ndarray

    def of_one_body(self) -> RowStates:
        """The rows if both markers are on one body, and y is its coordinates (n/2,) once: by the chain rule the
        contributions of both markers are added, and the rigid-body part cancels."""
        n = self.slope.shape[1] // 2
        first, second = slice(n), slice(n, 2 * n)
        turning = sum(self.turning[:, i, j] for i in (first, second) for j in (first, second))
        slope, force = (x[:, first] + x[:, second] for x in (self.slope, self.force))
        return RowStates(self.value, slope, force, np.asarray(turning), self.wrench)


Function = tuple[str, int, int, Any]  # kind, axis i of a, axis j of b, vector (6,) of a bushing coordinate


def row_states(functions: list[Function], a: MarkerState, b: MarkerState) -> RowStates:
    """The rows `functions` of the markers a and b."""
    n_a, n_b = a.moved.shape[1], b.moved.shape[1]
    k, n = len(functions), n_a + n_b
    X_a, X_b, T_a, T_b, B_a, B_b = np.zeros((6, 3, n))
    X_a[:, :n_a], T_a[:, :n_a], B_a[:, :n_a] = a.moved, a.turned, a.carried
    X_b[:, n_a:], T_b[:, n_a:], B_b[:, n_a:] = b.moved, b.turned, b.carried
    d = b.x - a.x
    value, slope, f, t = np.zeros(k), np.zeros((k, n)), np.zeros((k, 3)), np.zeros((k, 3))
    df, dt = np.zeros((k, 3, n)), np.zeros((k, 3, n))
    for m, (kind, i, j, vector) in enumerate(functions):
        if kind == "translation":
            f[m] = a.R[:, i]
            df[m] = -hat(f[m]) @ T_a
            value[m] = f[m] @ d
            slope[m] = f[m] @ (X_b - X_a) + d @ df[m]
        elif kind == "distance":
            length = float(np.sqrt(d @ d))
            value[m] = length
            f[m] = d / max(length, NO_LENGTH)
            relative = X_b - X_a
            slope[m] = f[m] @ relative
            df[m] = (relative - np.outer(f[m], slope[m])) / max(length, NO_LENGTH)
        elif kind == "direction":
            u, w = a.R[:, i], b.R[:, j]
            du, dw = -hat(u) @ T_a, -hat(w) @ T_b
            value[m] = u @ w
            t[m] = cross(w, u)
            dt[m] = hat(w) @ du - hat(u) @ dw
            slope[m] = u @ dw + w @ du
        elif kind in ("angle", "second_angle"):
            held, T_h, turned, T_e, sign = (a, T_a, b, T_b, 1.0) if kind == "angle" else (b, T_b, a, T_a, -1.0)
            e, q = turned.R[:, j], held.R[:, j]
            p = sign * cross(held.R[:, i], q)
            P, Q = float(p @ e), float(q @ e)
            de, dp, dq = -hat(e) @ T_e, -hat(p) @ T_h, -hat(q) @ T_h
            dP, dQ = p @ de + e @ dp, q @ de + e @ dq
            value[m] = np.arctan2(P, Q)
            N = P * P + Q * Q
            v = Q * p - P * q
            t[m] = sign / N * cross(e, v)
            dv = np.outer(p, dQ) + Q * dp - np.outer(q, dP) - P * dq
            dt[m] = sign / N * (hat(e) @ dv - hat(v) @ de) - np.outer(t[m], 2.0 * (P * dP + Q * dQ) / N)
            slope[m] = (Q * dP - P * dQ) / N
        elif kind == "twist":
            o, p = (i + 1) % 3, (i + 2) % 3
            A = a.R.T @ b.R
            value[m] = np.arctan2(A[p, o] - A[o, p], A[o, o] + A[p, p])
            u, w = a.R[:, i], b.R[:, i]
            du, dw = -hat(u) @ T_a, -hat(w) @ T_b
            N = 1.0 + u @ w
            t[m] = (u + w) / N
            dt[m] = (du + dw) / N - np.outer(t[m], w @ du + u @ dw) / N
            slope[m] = t[m] @ (T_b - T_a)
        elif kind == "bushing":
            along, about = vector[:3], vector[3:]
            phi = rotation_vector(a.R.T @ b.R)
            inverse = tangent_inverse(phi)
            dphi = inverse.T @ a.R.T @ (T_b - T_a)
            f[m], t[m] = a.R @ along, a.R @ (inverse @ about)
            df[m] = -hat(f[m]) @ T_a
            dt[m] = -hat(t[m]) @ T_a + a.R @ tangent_inverse_change(phi, about) @ dphi
            value[m] = f[m] @ d + about @ phi
            slope[m] = f[m] @ (X_b - X_a) + d @ df[m] + about @ dphi
        else:
            raise ValueError(f"row kind {kind!r} has no NumPy counterpart")
    force, turning = np.zeros((k, n)), np.zeros((k, n, n))
    change = (X_b, df, dt)
    _enter(force[:, n_a:], turning[:, n_a:], b, n_a, b.x, f, t, change, X_b, B_b, 1.0)
    _enter(force[:, :n_a], turning[:, :n_a], a, 0, b.x, f, t, change, X_a, B_a, -1.0)
    return RowStates(value, slope, force, turning, np.hstack([f, t]))


def _enter(
    force: np.ndarray,
    turning: np.ndarray,
    side: MarkerState,
    start: int,
    x: np.ndarray,
    f: np.ndarray,
    t: np.ndarray,
    change: tuple[np.ndarray, np.ndarray, np.ndarray],
    dx_marker: np.ndarray,
    carried: np.ndarray,
    sign: float,
) -> None:
    """Generalised forces of the wrenches (f at x, t) (k, 3) on one side, and their derivatives; `force` (k, m) and
    `turning` (k, m, n) are views. `change` are the derivatives of x, f and t, `start` is the column of the body's first
    coordinate.
    """
    if not force.shape[1]:
        return
    dx, df, dt = change
    A = sign * side.A
    F = hat(f)
    d = x - side.r
    dd = dx.copy()
    dd[:, start : start + 3] -= np.eye(3)
    D = hat(d)
    M = f @ D.T + t
    force[:, :3] = sign * f
    force[:, 3:6] = M @ A
    turning[:, :3] = sign * df
    turning[:, 3:6] = A.T @ (D @ df - F @ dd + dt + hat(M) @ carried)
    slope = side.slope
    if slope is None:
        return
    place = side.place
    L, D = hat(place.point - place.pivot), hat(x - side.x)
    M = f @ D.T + t
    fb = f @ A
    pull = np.hstack([fb, M @ A + fb @ L.T])
    dfb = A.T @ (df + F @ carried)
    dtb = A.T @ (D @ df - F @ (dx - dx_marker) + dt + hat(M) @ carried) + L @ dfb
    force[:, 6:] = pull @ slope.T
    turning[:, 6:] = slope[:, :3] @ dfb + slope[:, 3:] @ dtb
    if place.stiffening is not None:
        k = place.stiffening.shape[1]
        at = start + 6
        turning[:, 6 : 6 + k, at : at + k] -= np.tensordot(pull, place.stiffening, 1)
