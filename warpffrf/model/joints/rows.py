"""The scalar functions that joints are made of, and how they pull.

A row is a function c of two markers a and b: positions x_a, x_b and axes u_i (of a), w_j (of b), all in the world.

    translation    c = u_i . (x_b - x_a)
    distance       c = |x_b - x_a|
    direction      c = u_i . w_j
    angle          c = angle of w_j about u_i, from u_j towards u_i x u_j
    second_angle   c = angle of w_j about w_i, measured against u_j
    twist          c = turn of b against a about the axis i, whatever the axis of b does (swing and twist)

With dx_a, dx_b the displacements of the material points of either body that lie at x_b, and dTheta their turns, every
variation is dc = f.(dx_b - dx_a) + t.(dTheta_b - dTheta_a). A multiplier therefore pulls with the wrench -lambda (f, t)
at x_b on the second body and with its exact opposite on the first. Two angles need a derivation. With P = p.e, Q = q.e
for a vector e of one body in the orthonormal directions p, q of the other, c = atan2(P, Q) and
dc = (Q dP - P dQ)/(P^2 + Q^2). For `angle` e = w_j turns against p = u_i x u_j, q = u_j, so that
t = e x (Q p - P q)/(P^2 + Q^2); for `second_angle` p = w_j x w_i, q = w_j turn against e = u_j, and t is the opposite
of the same expression. On the joint (e perpendicular to the axis) t is the axis itself.

Where nothing holds the axis these angles are those of one vector, which another would not share: to first order in the
tilt they depend on which was chosen. The *twist* does not. With the quaternion (q_v, q_0) of A_a^T A_b it is
2 atan2(q_i, q_0): the shortest turn that brings u_i to w_i is taken off, what is left is a turn about u_i. In the
markers' axes, p and q the two after i,

    c = atan2(u_q.w_p - u_p.w_q, u_p.w_p + u_q.w_q),      as q_i q_0 and q_0^2 - q_i^2 are 1/4 and 1/2 of these,

and with omega the angular velocity of b against a, q_0' = -omega.q_v/2 and q_v' = (q_0 omega + omega x q_v)/2,

    c' = (u_i + w_i).omega/(1 + u_i.w_i),      t = (u_i + w_i)/(1 + u_i.w_i).

It fails only where w_i = -u_i; without a tilt it is the angle, and a tilt alone (omega perpendicular to u_i + w_i) is
no twist.

`warpffrf_kernels.constraints.rows` computes the same on the device; this is the independent copy that checks of scenes,
recorded coordinates and tests use."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.errors import unknown_name

KINDS = ("translation", "direction", "angle", "distance", "second_angle", "twist")
_AXES = "xyz"


@dataclass(frozen=True)
class Row:
    """One scalar function of two markers: its kind (see the module), axis i of marker a and axis j of marker b. Raises
    `InputError` for a kind that the kernels do not evaluate."""

    kind: str
    i: int = 0
    j: int = 0

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise unknown_name("joints.Row: kind", self.kind, KINDS)

    @property
    def is_length(self) -> bool:
        """True where the function is a length [m], else it is an angle or a direction cosine."""
        return self.kind in ("translation", "distance")

    @property
    def held(self) -> str:
        """What is held where the row is a constraint, in words; axes are those of the joint."""
        if self.kind == "translation":
            return f"translation along {_AXES[self.i]}"
        if self.kind == "distance":
            return "distance"
        about = 3 - self.i - self.j if self.kind == "direction" else self.i
        return f"rotation about {_AXES[about]}"


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.einsum("...k,...k->...", a, b)


def _angle(row: Row, A_a: np.ndarray, A_b: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """e, p, q and the sign of the torque (see the module)."""
    first = row.kind == "angle"
    held, turned = (A_a, A_b) if first else (A_b, A_a)
    q = held[..., row.j]
    p = np.cross(held[..., row.i], q) if first else np.cross(q, held[..., row.i])
    return turned[..., row.j], p, q, 1.0 if first else -1.0


def value(row: Row, x_a: np.ndarray, A_a: np.ndarray, x_b: np.ndarray, A_b: np.ndarray) -> np.ndarray:
    """c (...) of markers at x (..., 3) with axes A (..., 3, 3), columns x, y, z; angles in (-pi, pi]."""
    if row.kind == "translation":
        return _dot(A_a[..., row.i], x_b - x_a)
    if row.kind == "distance":
        return np.linalg.norm(x_b - x_a, axis=-1)
    if row.kind == "direction":
        return _dot(A_a[..., row.i], A_b[..., row.j])
    if row.kind == "twist":
        p, q = (row.i + 1) % 3, (row.i + 2) % 3
        across = _dot(A_a[..., q], A_b[..., p]) - _dot(A_a[..., p], A_b[..., q])
        return np.arctan2(across, _dot(A_a[..., p], A_b[..., p]) + _dot(A_a[..., q], A_b[..., q]))
    e, p, q, _ = _angle(row, A_a, A_b)
    return np.arctan2(_dot(p, e), _dot(q, e))


def gradient(
    row: Row, x_a: np.ndarray, A_a: np.ndarray, x_b: np.ndarray, A_b: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """f (..., 3) and t (..., 3), world axes, of dc = f.(dx_b - dx_a) + t.(dTheta_b - dTheta_a) at x_b."""
    zero = np.zeros(np.broadcast_shapes(np.shape(x_a), np.shape(x_b)))
    if row.kind == "translation":
        return zero + A_a[..., row.i], zero
    if row.kind == "distance":
        return (x_b - x_a) / np.linalg.norm(x_b - x_a, axis=-1)[..., None], zero
    if row.kind == "direction":
        return zero, zero + np.cross(A_b[..., row.j], A_a[..., row.i])
    if row.kind == "twist":
        u, w = A_a[..., row.i], A_b[..., row.i]
        return zero, zero + (u + w) / (1.0 + _dot(u, w))[..., None]
    e, p, q, sign = _angle(row, A_a, A_b)
    P, Q = _dot(p, e)[..., None], _dot(q, e)[..., None]
    return zero, zero + sign * np.cross(e, Q * p - P * q) / (P * P + Q * Q)
