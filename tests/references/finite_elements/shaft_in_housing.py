r"""A shaft in two bearings in a housing: full finite elements of both, rigid-ring laws of the bearings.

K of shaft and housing are assembled by scikit-fem on their meshes. The motion q (6) of a seat is the rigid one nearest
to that of its facets, q = F^T u with F = W R (R^T W R)^-1, R its rigid motions about the middle and W the areas of its
nodes; a force f on it is F f on the nodes. With weak springs S at some seats of the free shaft, which are subtracted
again, the compliances are

    C = F^T (K + F S F^T)^-1 F,        q = C (f + S q).

A bearing presses the seats of shaft and housing by +-f(q_shaft - q_housing) of five motions of its inner ring, three
displacements u and two tilts t, with the angle phi of each element about the axis a and e its direction from there:

- balls (ISO/TS 16281): X = A cos alpha_0 + v.e, Y = Y_0 + v.a, v = u + t x r, r = R_i e + z a the groove centre of the
  inner ring, A = r_i + r_e - D, cos alpha_0 = 1 - s/(2 A), Q = c_P (sqrt(X^2 + Y^2) - A)^1.5 along (X, Y), which acts
  on the inner ring at r; z and Y_0 are 0 of a deep-groove bearing, whose grooves are opposite each other;
- rollers: laminae at x along a of q = c_L/n (u.e - s/2 + x (t x a).e - 2 P(x))^(10/9), with the profile of the
  standard, which act at x a.

Newton's method with differences solves q = C (f + S q) for all seats at once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.optimize import root
from scipy.sparse.linalg import splu

from references.closed_forms.ball_bearing import BallBearing
from references.closed_forms.rolling_bearings import iso_profiles
from references.finite_elements.meshes import facet_shares, matrices
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh

Array = np.ndarray
WEAK = 1e7  # N/m, and N m/rad over a squared length of 0.1 m: springs that make K of a free body regular
SCALES = np.array([1e-6] * 3 + [1e-5] * 3)  # m and rad, of the unknowns


def rigid(x: Array, middle: Array) -> Array:
    """(3 n, 6): displacements of nodes (n, 3) in translations and rotations about the middle."""
    r = x - middle
    R = np.zeros((len(x), 3, 6))
    R[:, :, :3] = np.eye(3)
    for k in range(3):
        R[:, :, 3 + k] = np.cross(np.eye(3)[k], r)
    return R.reshape(-1, 6)


def seat(mesh: Mesh, name: str, middle: Array) -> Array:
    """F (3 nodes, 6) of a facet set."""
    area = np.zeros(len(mesh.points))
    for kind, facets in mesh.facet_sets[name].blocks.items():
        np.add.at(area, facets, facet_shares(kind, mesh.points[facets])[0])
    R = rigid(mesh.points, middle)
    W = np.repeat(area, 3)[:, None] * R
    return np.asarray(W @ np.linalg.inv(R.T @ W))


@dataclass(frozen=True)
class Elastic:
    """Compliance C (6 n, 6 n) between n seats, and the springs S (6 n,) that it contains."""

    compliance: Array
    springs: Array

    @classmethod
    def of(cls, mesh: Mesh, material: Material, seats: Mapping[str, Array], fixed: str = "") -> Elastic:
        """Of a mesh with seats {facet set: middle (3,)}, fixed at a facet set, or, without one, free."""
        K, _ = matrices(mesh, material)
        F = np.hstack([seat(mesh, name, middle) for name, middle in seats.items()])
        held = np.zeros(len(mesh.points), dtype=bool)
        springs = np.zeros(F.shape[1])
        if fixed:
            held[mesh.facet_sets[fixed].node_set] = True
        else:
            springs[:] = np.tile([WEAK] * 3 + [1e-2 * WEAK] * 3, len(seats))
            B = sp.csr_matrix(F * np.sqrt(springs))
            K = K + B @ B.T
        free = np.flatnonzero(np.repeat(~held, 3))
        return cls(F[free].T @ splu(K[free][:, free].tocsc()).solve(F[free]), springs)


Law = Callable[[Array], tuple[Array, Array]]  # motion (6,) of an inner ring -> force and moment on it (6,), loads (n,)


def balls(bearing: BallBearing, axis: Array, first: Array, *, place: float = 0.0, apart: float = 0.0) -> Law:
    """Of a row of balls; place z, apart Y_0 [m]: of the groove centres along the axis."""
    e = np.cos(bearing.angles)[:, None] * first + np.sin(bearing.angles)[:, None] * np.cross(axis, first)
    closed, r = bearing.reach * np.cos(bearing.free_angle), bearing.lever * e + place * axis

    def law(q: Array) -> tuple[Array, Array]:
        v = q[:3] + np.cross(q[3:], r)
        Q, alpha = bearing.balls(closed + np.sum(v * e, axis=1), apart + v @ axis)
        f = -Q[:, None] * (np.cos(alpha)[:, None] * e + np.sin(alpha)[:, None] * axis)
        return np.concatenate([f.sum(axis=0), np.cross(r, f).sum(axis=0)]), Q

    return law


def rollers(
    count: int, diameter: float, length: float, clearance: float, axis: Array, first: Array, laminae: int = 30
) -> Law:
    """Of a cylindrical roller bearing, lengths in m."""
    phi = 2.0 * np.pi * np.arange(count) / count
    e = np.cos(phi)[:, None] * first + np.sin(phi)[:, None] * np.cross(axis, first)
    x, P = length * ((np.arange(laminae) + 0.5) / laminae - 0.5), iso_profiles(length, diameter, laminae)
    c = 35948.0 * (1e3 * length) ** (8.0 / 9.0) / laminae

    def law(q: Array) -> tuple[Array, Array]:
        depth = (e @ q[:3] - 0.5 * clearance)[:, None] + np.outer(e @ np.cross(q[3:], axis), x) - P
        loads = c * (1e3 * np.maximum(depth, 0.0)) ** (10.0 / 9.0)
        Q, along = loads.sum(axis=1), loads @ x
        moment = np.cross(axis, -along[:, None] * e).sum(axis=0)
        return np.concatenate([-(Q[:, None] * e).sum(axis=0), moment]), Q

    return law


def solve(
    shaft: Elastic, housing: Elastic, laws: list[Law], load: Array, twist: float, guess: Array
) -> tuple[Array, list[Array]]:
    """Motions (n + m, 6) of the seats of shaft and housing and loads of the elements of each bearing. Bearing i joins
    their seats i; load (6 n,) on the seats of the shaft; twist [N m/rad]: stiffness about y at its last seat. Raises
    RuntimeError where no equilibrium is found."""
    count = len(shaft.compliance)

    def forces(q: Array) -> Array:
        a, b = q[:count].reshape(-1, 6), q[count:].reshape(-1, 6)
        on_a, on_b = load.reshape(-1, 6).copy(), np.zeros_like(b)
        for i, law in enumerate(laws):
            f = law(a[i] - b[i])[0]
            on_a[i] += f
            on_b[i] -= f
        on_a[-1, 4] -= twist * a[-1, 4]
        return np.concatenate([on_a.ravel() + shaft.springs * q[:count], on_b.ravel() + housing.springs * q[count:]])

    scale = np.tile(SCALES, len(guess) // 6)

    def lacking(y: Array) -> Array:
        q = scale * y
        f = forces(q)
        return np.concatenate([shaft.compliance @ f[:count], housing.compliance @ f[count:]]) / scale - y

    found = root(lacking, guess / scale, method="hybr", tol=1e-10, options={"maxfev": 20000})
    if np.abs(lacking(found.x)).max() > 1e-6:
        raise RuntimeError(f"no equilibrium of the shaft in its housing: {found.message}")
    q = (scale * found.x).reshape(-1, 6)
    n = count // 6
    return q, [law(q[i] - q[n + i])[1] for i, law in enumerate(laws)]
