r"""A full finite element solution of plane frictionless contact as a reference for reduced models.

Plane strain, curved quadratic (9-node) cells of scikit-fem, no modes, no functions of the engine: each body is
condensed exactly to the normal displacements of its contact nodes by one factorisation.

**Contact.** Pressure s_j of linear functions on the corner nodes of the first surface, f = B s on its nodes, B_ij =
int N_i psi_j (the quadratic N with linear psi passes the inf-sup test, so that the pressure does not oscillate). The
second surface is an exact circle; a node of the first at x_i meets it at angle phi_i under the normal e_i, where the
displacement of the second body is interpolated with its own quadratic functions. With the flexibilities A of both

    g = g0 + A f - c delta >= 0 weakly,   0 <= s  _|_  B^T g >= 0,     c^T f = P/2

delta the displacement of the first body, c_i = e_i . x. The active set is updated until it repeats: s > 0 stays, a
negative weak gap outside enters (primal-dual, M. Hintermueller, K. Ito, K. Kunisch, SIAM J. Optim. 13 (2003) 865).

**A floating body** is supported by a uniform body force that balances the contact forces; with b that load of unit
resultant, F = E - b c^T balances itself, A = F^T K^-1 F is independent of the support of K, and delta is the b-weighted
mean of the body's displacement.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu
from skfem import Basis, ElementQuad2, ElementVector, LinearForm, MeshQuad, MeshQuad2
from skfem.models.elasticity import linear_elasticity

from warpffrf.model.errors import InputError
from warpffrf.model.material import Material

Array = np.ndarray
SETS = 60  # active sets tried; 5 to 15 are needed
SAME_PLACE = 1e-9  # of the outer radius: nodes this close to a circle or line lie on it


class HalfRing:
    """The upper half (y >= 0, u_y = 0 on y = 0) of a ring about the origin in curved quadratic cells.

    material; radii (m,), angles (k,) [m, rad] of the grid lines, angles from 0 to pi, both ascending.
    """

    def __init__(self, material: Material, radii: Array, angles: Array) -> None:
        flat = MeshQuad2.from_mesh(MeshQuad.init_tensor(radii, angles))
        r, theta = np.asarray(flat.doflocs)
        self.mesh = MeshQuad2(np.stack([r * np.cos(theta), r * np.sin(theta)]), flat.t)
        self.basis = Basis(self.mesh, ElementVector(ElementQuad2()), intorder=5)
        self.K = csc_matrix(linear_elasticity(*material.lame).assemble(self.basis))
        self.x = self.basis.doflocs
        dof = np.arange(self.basis.N)
        scalar = np.zeros(self.basis.N, dtype=int)
        for rows in (self.basis.nodal_dofs, self.basis.facet_dofs, self.basis.interior_dofs):
            if rows is not None:
                scalar[rows[0]], scalar[rows[1]] = 0, 1
        self.component = scalar
        tiny = SAME_PLACE * radii[-1]
        self.symmetry = dof[(np.abs(self.x[1]) < tiny) & (scalar == 1)]
        self.radius = np.hypot(*self.x)
        self.angle = np.arctan2(np.abs(self.x[1]), self.x[0])  # of y = -0 it would be -pi
        self.tiny = tiny

    def on_circle(self, radius: float) -> tuple[Array, Array]:
        """Angles (n,) ascending of the nodes on the circle, and their dofs (n, 2)."""
        on = np.abs(self.radius - radius) < self.tiny
        dofs = []
        for k in range(2):
            rows = np.flatnonzero(on & (self.component == k))
            dofs.append(rows[np.argsort(self.angle[rows])])
        return self.angle[dofs[0]], np.stack(dofs, axis=1)

    def body_force(self) -> Array:
        """b: a uniform force along x of unit resultant, over the dofs."""
        load = LinearForm(lambda v, w: v[0]).assemble(self.basis)
        return load / load.sum()

    def flexibility(self, loads: Array, held: Array) -> Array:
        """loads^T K^-1 loads (n, n) with the dofs `held` and the line of symmetry fixed; loads (dofs, n)."""
        free = np.setdiff1d(np.arange(self.basis.N), np.union1d(held, self.symmetry))
        solution = splu(self.K[free][:, free].tocsc()).solve(loads[free])
        A = loads[free].T @ solution
        return 0.5 * (A + A.T)


def quadratic_rows(angles: Array, places: Array) -> Array:
    """Values (p, n) at `places` [rad] of the quadratic functions of nodes at `angles` (n,), corner, middle, ..."""
    corners = angles[::2]
    cell = np.clip(np.searchsorted(corners, places, side="right") - 1, 0, len(corners) - 2)
    t = (places - corners[cell]) / (corners[cell + 1] - corners[cell])
    rows = np.zeros((len(places), len(angles)))
    at = np.arange(len(places))
    rows[at, 2 * cell] = (1.0 - t) * (1.0 - 2.0 * t)
    rows[at, 2 * cell + 1] = 4.0 * t * (1.0 - t)
    rows[at, 2 * cell + 2] = t * (2.0 * t - 1.0)
    return rows


def pressure_rows(angles: Array, radius: float) -> Array:
    """B (n, (n + 1)/2) [m] of the module: nodes by pressure functions on the corners."""
    n = len(angles)
    B = np.zeros((n, n // 2 + 1))
    arc = radius * np.diff(angles[::2])
    for k, length in enumerate(arc):
        B[2 * k : 2 * k + 3, k] += length * np.array([1.0, 2.0, 0.0]) / 6.0
        B[2 * k : 2 * k + 3, k + 1] += length * np.array([0.0, 2.0, 1.0]) / 6.0
    return B


@dataclass(frozen=True, eq=False)
class Solved:
    """angles (k,) [rad] of the pressure nodes, pressure (k,) [Pa], weak gap (k,) [m2], delta [m], sets tried."""

    angles: Array
    pressure: Array
    gap: Array
    approach: float
    sets: int

    @property
    def peak_pressure(self) -> float:
        """Pressure [Pa] in the middle."""
        return float(self.pressure[0])

    @property
    def moment_angle(self) -> float:
        """Twice the root of the second moment of the pressure over the angle [rad], the half-angle for Hertz's."""
        t, p = self.angles, self.pressure
        middle, mean = 0.5 * (t[1:] + t[:-1]), 0.5 * (p[1:] + p[:-1])
        squares = (t[:-1] ** 2 * p[:-1] + 4.0 * middle**2 * mean + t[1:] ** 2 * p[1:]) / 6.0  # Simpson: exact
        return float(2.0 * np.sqrt(np.diff(t) @ squares / (np.diff(t) @ mean)))

    @property
    def edge(self) -> tuple[float, float]:
        """Last node under pressure and the next one [rad]: the patch ends between them."""
        last = int(np.flatnonzero(self.pressure > 0.0)[-1])
        return float(self.angles[last]), float(self.angles[last + 1])


def active_set(
    A: Array, gap: Array, c: Array, B: Array, load: float, guards: Sequence[int] = (-1,)
) -> tuple[Array, Array, float, int]:
    """Pressure s, weak gap, delta and the number of sets of the module.

    load: the resultant c^T B s, of the modelled half; guards: outermost nodes that can carry pressure, which the
    patch must not reach (InputError). RuntimeError if no set is stationary.
    """
    G, g0, lever = B.T @ A @ B, B.T @ gap, B.T @ c
    weight = B.sum(axis=0)
    active = np.argsort(np.argsort(g0 / weight)) < 2  # the two that are nearest
    seen = []
    for count in range(1, SETS + 1):
        on = np.flatnonzero(active)
        system = np.block([[G[np.ix_(on, on)], -lever[on, None]], [lever[None, on], np.zeros((1, 1))]])
        found = np.linalg.solve(system, np.append(-g0[on], load))
        s = np.zeros(len(g0))
        s[on], delta = found[:-1], float(found[-1])
        weak = g0 + G @ s - lever * delta
        weak[on] = 0.0
        new = np.where(active, s > 0.0, weak < 0.0)
        if np.array_equal(new, active):
            if active[list(guards)].any():
                raise InputError("contact reaches the end of what can carry pressure: give more of the surface")
            return s, weak / weight, delta, count
        if any(np.array_equal(new, old) for old in seen):
            new = active & (s > 0.0)  # a cycle: release tension only
        seen.append(active)
        active = new
    raise RuntimeError(f"active set of the contact did not settle in {SETS} changes")
