r"""Position of the nodes of a first surface over the true shape of a second one, with all derivatives.

With X the position of a node about A's centre of mass, C = A_B^T A_A and the second body's axes for everything on it,

    y = A_B^T (r_A - r_B) + C X,        its foot x_f = y - d n,  d the signed distance, n = grad d the normal there
                                        (`Shape.chart`: any shape, of a body that moves or of the ground).

A change dy moves the foot by b_j b_j.dy/(1 + kappa_j d) along the tangents b_j (kappa_j the curvatures, positive if
B is convex) and rotates the normal by kappa_j times that: for a sphere of radius R the foot moves R/(R + d) as far.

    g    = d - u_A - N(x_f).u_B                        gap: normal displacements along the own normals
    S    = (x_f + l - U_B) . C t_i  +  u_A,i           position of A's node on B's material, along A's tangents t_i
    l    = sum_j b_j (b_j . C n_A) u_A/(1 + kappa_j d),    U_B  = sum_j b_j N(x_f).u_B,j

are functions of the state alone. The slip of a step is the difference of x_f + l - U_B between its ends along C t_i at
the new one, and that of u_A,i: the displacement of the node over B's material in the *whole* step, also if a node
enters, and never a velocity of a local mode. N are B's shape functions. Chords replace arcs: an error of (s/R)^2/24 of
the displacement s.

The term l is the motion of the foot due to u_A along A's normal n_A. Without it a node that lies delta deep in a
cylinder R would move on the radius R - delta: a creep of delta/R, 1 % of Carter's at a tenth of the friction. Of its
derivatives those by u_A are kept; those by the positions are kappa u_A, 1e-5, of that of the foot.

b_j rotate as the foot moves: b_1 = e_theta by -side e_r dtheta (constant on a plane), b_2 = n x b_1 by dn x b_1 + n x
db_1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from references.monolithic.core.rotation import hat
from references.monolithic.line_of_centres.frame import SLACK
from references.monolithic.line_of_centres.sampling import cells_of
from references.monolithic.nodal.surface import NodeSide, PartnerSide

RIGID = 12
NEAREST_CENTRE = 0.1  # lower limit of 1 + kappa d, for points far behind a concave surface; none is in contact


@dataclass(frozen=True, eq=False)
class Opposite:
    """All nodes over the second surface: y, foot and normal n (n, 3), tangents b (2, n, 3), d (n,), whether they face
    each other; position on B's grid as `cells_of` (None for a rigid B), and C (3, 3)."""

    y: np.ndarray
    foot: np.ndarray
    theta: np.ndarray
    z: np.ndarray
    normal: np.ndarray
    d: np.ndarray
    faces: np.ndarray
    cells: tuple[np.ndarray, ...] | None
    C: np.ndarray


def opposite(
    a: NodeSide, b: PartnerSide, r_a: np.ndarray, A_a: np.ndarray, r_b: np.ndarray, A_b: np.ndarray
) -> Opposite:
    """Nodes of `a` over `b` for bodies with centres of mass at r, rotated by A; for the ground 0 and 1."""
    C = A_b.T @ A_a
    y = A_b.T @ (r_a - r_b) + a.place @ C.T
    theta, z, d = b.shape.chart(y + b.center)
    n = b.shape.normal(theta, z)
    faces = np.einsum("ki,ki->k", a.normal @ C.T, n) < 0.0
    foot = b.shape.point(theta, z) - b.center
    cells = None
    if b.grid is not None:
        x = _column(b, theta)
        slack = SLACK * (b.grid.z[-1] - b.grid.z[0])
        faces &= (z >= b.grid.z[0] - slack) & (z <= b.grid.z[-1] + slack)
        if not b.grid.periodic:
            faces &= (x >= -1.0) & (x <= b.grid.columns)
        cells = cells_of(b.grid, x, z)
    return Opposite(y, foot, theta, z, n, d, faces, cells, C)


def _column(b: PartnerSide, theta: np.ndarray) -> np.ndarray:
    grid = b.grid
    x = (theta - b.offset - grid.theta_start) / grid.pitch
    if b.shape.profile().planar or grid.periodic:
        return x
    turn = 2.0 * np.pi / grid.pitch
    return x - turn * np.floor((x - 0.5 * (grid.columns - 1)) / turn + 0.5)


def nodes_at(b: PartnerSide, cells: tuple[np.ndarray, ...], by: str = "") -> sparse.csr_matrix:
    """N (k, nodes of B) in cells `cells`, or its derivative `by` "x" (column) or "z" [1/m]."""
    column, row, u, v, slope = cells
    grid, k = b.grid, len(column)
    around = ((0, -np.ones(k)), (1, np.ones(k))) if by == "x" else ((0, 1.0 - u), (1, u))
    along = ((0, -slope), (1, slope)) if by == "z" else ((0, 1.0 - v), (1, v))
    data, i, j = [], [], []
    for step, part in around:
        at = column + step
        inside = np.ones(k, dtype=bool) if grid.periodic else (at >= 0) & (at < grid.columns)
        for up, piece in along:
            i.append(np.flatnonzero(inside))
            j.append((np.mod(at, grid.columns) * grid.rows + row + up)[inside])
            data.append((part * piece)[inside])
    shape = (k, grid.columns * grid.rows)
    return sparse.csr_matrix((np.concatenate(data), (np.concatenate(i), np.concatenate(j))), shape=shape)


@dataclass(frozen=True, eq=False)
class Motion:
    """Derivatives at k nodes by the twelve rigid coordinates (dr_A, dtheta_A, dr_B, dtheta_B; world translations,
    rotations in body axes): y, foot, n, grid column and axial position of the foot on B; tangents b (2, k, 3)."""

    y: np.ndarray  # (k, 3, 12)
    foot: np.ndarray
    normal: np.ndarray
    column: np.ndarray  # (k, 12), zero for a rigid B
    axial: np.ndarray
    tangents: np.ndarray
    turned: np.ndarray  # (2, k, 3, 12) of the tangents


def tangents_at(b: PartnerSide, over: Opposite, at: np.ndarray) -> np.ndarray:
    """b (2, k, 3) at the feet of the nodes `at` (k,)."""
    theta, z = over.theta[at], over.z[at]
    return np.stack([b.shape.around(theta), b.shape.along(theta, z)])


def leaning(a: NodeSide, b: PartnerSide, over: Opposite, at: np.ndarray) -> np.ndarray:
    """l/u_A (k, 3) of the nodes `at` (k,): motion of the foot when the node moves along A's normal."""
    b_j = tangents_at(b, over, at)
    m = a.normal[at] @ over.C.T
    out = np.zeros((len(at), 3))
    for direction, kappa in zip(b_j, b.shape.curvatures(over.theta[at], over.z[at]), strict=True):
        scale = np.maximum(1.0 + kappa * over.d[at], NEAREST_CENTRE)
        out += direction * (np.einsum("ki,ki->k", direction, m) / scale)[:, None]
    return out


def motion(a: NodeSide, b: PartnerSide, over: Opposite, at: np.ndarray, A_b: np.ndarray) -> Motion:
    """Motion of the feet of the nodes `at` (k,) with the two bodies."""
    k, C = len(at), over.C
    y, theta, z, d = over.y[at], over.theta[at], over.z[at], over.d[at]
    dy = np.zeros((k, 3, RIGID))
    dy[:, :, 0:3] = A_b.T
    dy[:, :, 3:6] = -C @ hat(a.place[at])
    dy[:, :, 6:9] = -A_b.T
    dy[:, :, 9:12] = hat(y)
    b_j = tangents_at(b, over, at)
    foot, normal = np.zeros_like(dy), np.zeros_like(dy)
    ways = []
    for direction, kappa in zip(b_j, b.shape.curvatures(theta, z), strict=True):
        scale = 1.0 / np.maximum(1.0 + kappa * d, NEAREST_CENTRE)
        way = np.einsum("ki,kic->kc", direction, dy) * scale[:, None]
        foot += direction[:, :, None] * way[:, None, :]
        normal += direction[:, :, None] * (kappa[:, None] * way)[:, None, :]
        ways.append(way)
    column = axial = np.zeros((k, RIGID))
    turned = np.zeros((2, *dy.shape))
    if b.grid is not None:  # the tangents are needed for a flexible B only
        profile = b.shape.profile()
        column, axial = ways[0] / b.grid.pitch, ways[1]
        if not profile.planar:
            angle = profile.side * ways[0] / b.shape.radius_at(z)[:, None]
            column, axial = angle / b.grid.pitch, ways[1] / np.sqrt(1.0 + b.shape.slope_at(z)[:, None] ** 2)
            turned[0] = -profile.side * b.shape.radial(theta)[:, :, None] * angle[:, None, :]
            turned[1] = np.cross(normal, b_j[0][:, :, None], axis=1)
            turned[1] += np.cross(over.normal[at][:, :, None], turned[0], axis=1)
    return Motion(dy, foot, normal, column, axial, b_j, turned)
