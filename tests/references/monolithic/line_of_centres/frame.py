r"""Contact frame of two surfaces of revolution at axial sections of the first, with all derivatives.

The geometry is that of the separated solver (`warpffrf_kernels.kinematics.line_of_centres`): in the axial section z of
A, `a = O_A + z e_A`; b is where B's axis pierces the section; d = |b - a|, c = (b - a)/d, t = e_A x c. The gap
along c at the angle xi from c and the wrench of a unit pressure are

    g = d - sqrt(R_B^2 - y^2) - R_A cos xi,   y = R_A sin xi,
    f on B at b, -f on A,     f = c - e_A (c.e_B)/(e_A.e_B) + e_A R_B'/(e_A.e_B).

All quantities are differentiated by the twelve rigid coordinates of the pair, dr_A, dtheta_A, dr_B, dtheta_B (world
translations, rotations in body axes), by the chain rule: an axis e of a body changes by `A dtheta x e`. Derivatives are
in the last axis of the arrays called d_*.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from references.monolithic.core.rotation import hat

RIGID = 12
SLACK = 1e-9  # of the width: nodes at the very ends of equal surfaces face each other despite round-off


@dataclass(frozen=True, eq=False)
class Side:
    """A contact surface on its body, about the centre of mass: body number, chart origin (3,) and frame (3, 3, columns
    e_0 of the grid, e_1, e_a), shape, grid, and columns of a full revolution (0 on an arc)."""

    body: int
    origin: np.ndarray
    frame: np.ndarray
    shape: Any
    grid: Any
    turn: int


def side_of(port: Any) -> Side:
    """The side of a contact that a `SurfacePort` names."""
    surface, body = port.surface, port.body
    grid, shape = surface.grid, surface.shape
    e_a = np.asarray(shape.e_a)
    frame = np.stack([grid.e_0, np.cross(e_a, grid.e_0), e_a], axis=1)
    sectors, block = len(surface.lags), surface.lags.shape[1] // grid.rows
    turn = sectors * block if sectors > 1 or grid.periodic else 0
    return Side(body.index, np.asarray(shape.axis_point) - body.center_of_mass, frame, shape, grid, turn)


@dataclass(frozen=True, eq=False)
class Stations:
    """At S sections: distance d, grid column of the line of centres on A and B, axial place on B, t.e_B, c.e_B, whether
    B is opposite, and the generalised force (S, 12) of a unit pressure integral; derivatives (S, 12), (S, 12, 12)."""

    d: np.ndarray
    x_a: np.ndarray
    x_b: np.ndarray
    axial: np.ndarray
    te: np.ndarray
    ce: np.ndarray
    faces: np.ndarray
    sense: float
    force: np.ndarray
    d_d: np.ndarray
    d_x_a: np.ndarray
    d_x_b: np.ndarray
    d_axial: np.ndarray
    d_te: np.ndarray
    d_ce: np.ndarray
    d_force: np.ndarray


def _column(u: np.ndarray, du: np.ndarray, grid: Any) -> tuple[np.ndarray, np.ndarray]:
    """Grid column of the direction u (S, 3, chart axes) and its derivative."""
    x = (np.arctan2(u[:, 1], u[:, 0]) - grid.theta_start) / grid.pitch
    turned = u[:, 0, None] * du[:, 1] - u[:, 1, None] * du[:, 0]
    return x, turned / ((u[:, 0] ** 2 + u[:, 1] ** 2)[:, None] * grid.pitch)


def _near(x: np.ndarray, pitch: float, middle: float) -> np.ndarray:
    """Columns x on the branch nearest to `middle`, without jumps between sections."""
    turn = 2.0 * np.pi / pitch
    first = x[0] - turn * np.floor((x[0] - middle) / turn + 0.5)
    return x - turn * np.floor((x - first) / turn + 0.5)


def stations(
    a: Side, b: Side, z: np.ndarray, r_a: np.ndarray, A_a: np.ndarray, r_b: np.ndarray, A_b: np.ndarray
) -> Stations:
    """Contact frame at the axial positions z (S,) of A for bodies at r, A (see the module)."""
    S = len(z)
    F_a, F_b = A_a @ a.frame, A_b @ b.frame
    e_a, e_b = F_a[:, 2], F_b[:, 2]
    turn_a, turn_b = np.zeros((3, RIGID)), np.zeros((3, RIGID))
    turn_a[:, 3:6], turn_b[:, 9:12] = A_a, A_b
    move_a, move_b = np.zeros((3, RIGID)), np.zeros((3, RIGID))
    move_a[:, :3], move_b[:, 6:9] = np.eye(3), np.eye(3)
    de_a, de_b = -hat(e_a) @ turn_a, -hat(e_b) @ turn_b
    arm_a, arm_b = A_a @ a.origin, A_b @ b.origin
    O_b, dO_b = r_b + arm_b, move_b - hat(arm_b) @ turn_b
    p = r_a + arm_a + z[:, None] * e_a
    dp = (move_a - hat(arm_a) @ turn_a) + z[:, None, None] * de_a
    cosine = float(e_a @ e_b)
    dcosine = e_b @ de_a + e_a @ de_b
    off = p - O_b
    axial = off @ e_a / cosine
    d_axial = (np.einsum("i,sij->sj", e_a, dp - dO_b) + off @ de_a - axial[:, None] * dcosine) / cosine
    q = O_b + axial[:, None] * e_b
    dq = dO_b + e_b[:, None] * d_axial[:, None, :] + axial[:, None, None] * de_b
    v, dv = q - p, dq - dp
    d = np.linalg.norm(v, axis=1)
    c = v / d[:, None]
    d_d = np.einsum("si,sij->sj", c, dv)
    dc = (dv - c[:, :, None] * d_d[:, None, :]) / d[:, None, None]
    t = np.cross(e_a, c)
    dt = -np.einsum("sij,jk->sik", hat(c), de_a) + np.einsum("ij,sjk->sik", hat(e_a), dc)
    ce, te = c @ e_b, t @ e_b
    d_ce = np.einsum("i,sij->sj", e_b, dc) + c @ de_b
    d_te = np.einsum("i,sij->sj", e_b, dt) + t @ de_b
    du = np.einsum("ia,sij->saj", F_a, dc + np.einsum("sij,jk->sik", hat(c), turn_a))
    x_a, d_x_a = _column(c @ F_a, du, a.grid)
    du = -np.einsum("ia,sij->saj", F_b, dc + np.einsum("sij,jk->sik", hat(c), turn_b))
    x_b, d_x_b = _column(-c @ F_b, du, b.grid)
    ga, gb = a.grid, b.grid
    x_a = _near(x_a, ga.pitch, 0.5 * (ga.columns - 1))
    x_b = _near(x_b, gb.pitch, 0.5 * (gb.columns - 1))
    slope, bend = _slope(b.shape, axial)
    k = (slope - ce) / cosine
    dk = (bend[:, None] * d_axial - d_ce - k[:, None] * dcosine) / cosine
    f = c + k[:, None] * e_a
    df = dc + e_a[:, None] * dk[:, None, :] + k[:, None, None] * de_a
    force, d_force = np.zeros((S, RIGID)), np.zeros((S, RIGID, RIGID))
    for first, r, A, move, turn, sign in ((0, r_a, A_a, move_a, turn_a, -1.0), (6, r_b, A_b, move_b, turn_b, 1.0)):
        arm = q - r
        M = np.cross(arm, f)
        dM = np.einsum("sij,sjk->sik", hat(arm), df) - np.einsum("sij,sjk->sik", hat(f), dq - move)
        dM = dM + np.einsum("sij,jk->sik", hat(M), turn)
        force[:, first : first + 3], force[:, first + 3 : first + 6] = sign * f, sign * M @ A
        d_force[:, first : first + 3] = sign * df
        d_force[:, first + 3 : first + 6] = sign * np.einsum("ia,sij->saj", A, dM)
    z_b = gb.z
    slack = SLACK * (z_b[-1] - z_b[0])
    faces = (axial >= z_b[0] - slack) & (axial <= z_b[-1] + slack)
    return Stations(
        d, x_a, x_b, axial, te, ce, faces, -float(np.sign(cosine)), force,
        d_d, d_x_a, d_x_b, d_axial, d_te, d_ce, d_force,
    )  # fmt: skip


def _slope(shape: Any, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """R'(z) and R''(z): 0 of a cylinder, of a crown -z/s and -Rc^2/s^3 with s^2 = Rc^2 - z^2."""
    kappa = shape.curvature
    if kappa == 0.0:
        return np.zeros_like(z), np.zeros_like(z)
    s = np.sqrt(1.0 / kappa**2 - z * z)
    return -z / s, -1.0 / (kappa**2 * s**3)
