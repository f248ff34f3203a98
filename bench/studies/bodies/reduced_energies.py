r"""Strain energies of large deflections in few coordinates, in NumPy: what the engine has beside what is published.

A body of St. Venant-Kirchhoff's material (`verification.large_deflections.body`), some dofs held, vibration modes Phi
of what is left. With fields whose dot product is that of strains in the energy, and products r of the coordinates q,

    V = |Y_1 q + Y_2 r|^2/2 = q.K_2 q/2 + q.K_3 r + r.K_4 r        of u = Phi q.

f_2 = int grad N . C E_2 + (H_i sigma_j + H_j sigma_i)/2 is what a pair of modes pushes nodes with, its first part a.

* *Galerkin on modes*: V as it is. Modes bend, and are stretched by the square of that.
* *Modal derivatives as coordinates*: Phi and K^-1 f_2 of all pairs (the static ones; P. Tiso, E. Jansen, M. Abdalla,
  AIAA J. 49 (2011) 2295), independent ones of them, and V of these.
* *Modal derivatives slaved*: u = Phi q - (K^-1 f_2) r, V up to fourth order; V_4 = r.(K_4 - f_2.K^-1 f_2/2) r.
* *Sum of squares*, the engine's: u = Phi q - (K^-1 a) r, V = q.K_2 q/2 + r.(K_4 - a.K^-1 a/2) r by eigenvalues above a
  hundredth of the largest (`offline.inertia.membrane`).
* *Ends free*: the same of a body whose clamped end is a rigid interface that moves, d(q) = F^T (Phi q + Theta r), and
  is held by multipliers, lambda.d'' being what thrust does to the stiffness; so the engine does it, whose interfaces
  do not know what will hold them. Where an end does not turn, rigid nodes need no lift of second order.
* *ECSW* (C. Farhat, P. Avery, T. Chapman, J. Cortial, Int. J. Num. Meth. Eng. 98 (2014) 625): forces of modal
  derivatives as coordinates from few cells, with weights w >= 0 that give the work of forces in states of training.

Loads p g work on u, so that with slaved motion their potential is -p g.(Phi q + Theta r).
"""

from __future__ import annotations

import copy
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_matrix, csr_matrix
from scipy.sparse.linalg import eigsh, splu

from references.large_deflections.body import FIRST, SECOND, StVenantKirchhoffBody

Array = np.ndarray
HALF = np.where(np.arange(6) < 3, 0.5, 1.0)
BALANCED = 1e-9  # of the load
TINY = 1e-15  # m, rad: no motion
ITERATIONS = 60
INDEPENDENT = 1e-8  # of the largest eigenvalue of normed shapes, in energy
KEPT = 1e-2  # of the largest eigenvalue of V4, as `offline.inertia.membrane.TRUNCATION`
TRAINED = 1e-3  # of the forces of training: where the choice of cells ends
POINT = 27 * 9  # multiply-adds of a displacement gradient at a point of hex27


@dataclass(frozen=True, eq=False)
class Ends:
    """Motion C q + q.D q/2 = 0 of what is held: `C` (k, n), `D` (k, n, n)."""

    C: Array
    D: Array


class Energy(ABC):
    """A reduced energy of `coordinates` q, its forces and tangents, counted in multiply-adds; the work of the load is
    `linear`.q + q.`bend` q/2. `definite`: least over largest eigenvalue of V4 on pairs at unit energy of bending, None
    where nobody forms it."""

    name: str
    coordinates: int
    solves: int
    linear: Array
    bend: Array
    ends: Ends | None = None
    definite: float | None = None
    force_operations: int
    tangent_operations: int

    @abstractmethod
    def force(self, q: Array) -> Array:
        """dV/dq."""

    @abstractmethod
    def tangent(self, q: Array) -> Array:
        """d2V/dq2."""

    def load(self, q: Array) -> Array:
        """Derivative (n,) of the work of the load of factor 1."""
        return self.linear + self.bend @ q

    def way(self, q: Array) -> float:
        """That work: load . u [J]."""
        return float(self.linear @ q + 0.5 * q @ self.bend @ q)


@dataclass(frozen=True, eq=False)
class Structure:
    """A body, dofs `held`, a `load` (3 n,) [N] and the factors p up to which it grows; `still`: held dofs that only fix
    a rigid translation, which modes may have; `end`: nodes of a clamped end across x, of a structure in the x-z plane.
    """

    name: str
    body: StVenantKirchhoffBody
    held: Array
    load: Array
    factors: Array
    still: Array = field(default_factory=lambda: np.zeros(0, dtype=int))
    end: Array = field(default_factory=lambda: np.zeros(0, dtype=int))

    @cached_property
    def free(self) -> Array:
        """Dofs that are not held."""
        return self.body.free(self.held)

    @cached_property
    def _solver(self):
        return splu(csc_matrix(self.body.K[self.free][:, self.free]))

    def solve(self, f: Array) -> Array:
        """K^-1 f (3 n, k) of loads on nodes."""
        u = np.zeros(f.shape)
        u[self.free] = self._solver.solve(np.ascontiguousarray(f[self.free]))
        return u

    def modes(self, count: int) -> Array:
        """The lowest vibration modes (3 n, count) that the load works on."""
        if len(self.still):
            moving = np.union1d(self.free, self.still)
        else:
            moving = self.free
        K, M = (csc_matrix(A[moving][:, moving]) for A in (self.body.K, self.body.M))
        extra = count + 1 + len(self.still)
        shift = -1e-3 * float(K.diagonal().max() / M.diagonal().max())
        omega2, V = eigsh(K, extra, M, sigma=shift, v0=np.ones(len(moving)))
        order = np.argsort(omega2)[len(self.still) :][:count]
        U = np.zeros((self.body.size, count))
        U[moving] = V[:, order]
        for dof in self.still:  # a translation along the component of this dof
            U[dof % 3 :: 3] -= U[dof]
        return U


class Fields:
    """Strain of a basis (3 n, m) and of its pairs i <= j."""

    def __init__(self, body: StVenantKirchhoffBody, basis: Array) -> None:
        self.body, self.basis = body, basis
        m = basis.shape[1]
        self.i, self.j = np.triu_indices(m)
        self.H = [body.gradient(u) for u in basis.T]
        self.root = np.linalg.cholesky(body.hooke)
        self.Y1 = np.stack([self.field(HALF * (H + H.swapaxes(2, 3))[..., FIRST, SECOND]) for H in self.H], axis=1)

    def field(self, E: Array) -> Array:
        """A strain (e, q, 6) as a vector whose square is twice its energy."""
        return ((E @ self.root) * np.sqrt(self.body.weight)[..., None]).ravel()

    def pair(self, k: int) -> Array:
        """Strain (e, q, 6) of second order of pair k, with its coefficient."""
        i, j = self.i[k], self.j[k]
        X = np.matmul(self.H[i].swapaxes(2, 3), self.H[j])
        return (0.5 if i == j else 1.0) * HALF * (X + X.swapaxes(2, 3))[..., FIRST, SECOND]

    @cached_property
    def Y2(self) -> Array:
        """Fields (points, pairs)."""
        return np.stack([self.field(self.pair(k)) for k in range(len(self.i))], axis=1)

    def pushes(self, *, turning: bool) -> Array:
        """a (3 n, pairs) [N], with `turning` f_2."""
        found = np.empty((self.body.size, len(self.i)))
        place = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
        sigma = [(HALF * (H + H.swapaxes(2, 3))[..., FIRST, SECOND]) @ self.body.hooke for H in self.H]
        for k, (i, j) in enumerate(zip(self.i, self.j, strict=True)):
            P = (self.pair(k) @ self.body.hooke)[..., place]
            if turning:
                both = np.matmul(self.H[i], sigma[j][..., place]) + np.matmul(self.H[j], sigma[i][..., place])
                P = P + (0.5 if i == j else 1.0) * both
            local = np.einsum("eqcd,eqad,eq->eac", P, self.body.slopes, self.body.weight, optimize=True)
            found[:, k] = np.bincount(self.body.dofs.ravel(), local.ravel(), minlength=self.body.size)
        return found

    def strain(self, u: Array) -> Array:
        """Fields (points, k) of displacements (3 n, k)."""
        gradients = (self.body.gradient(x) for x in u.T)
        return np.stack([self.field(HALF * (H + H.swapaxes(2, 3))[..., FIRST, SECOND]) for H in gradients], axis=1)


class Quartic(Energy):
    """V = q.K2 q/2 + q.K3 r + r.K4 r, r the products of q; the load works on `linear` q and `square` r."""

    def __init__(
        self, name: str, K2: Array, K3: Array, K4: Array, linear: Array, square: Array | None, solves: int, of: int
    ) -> None:
        self.name, self.K2, self.K3, self.K4, self.linear, self.solves = name, K2, K3, K4, linear, solves
        self.coordinates = len(K2)
        self.i, self.j = np.triu_indices(self.coordinates)
        self.bend = np.zeros((len(K2), len(K2))) if square is None else _form(square, len(K2))
        n, P = self.coordinates, len(self.i)
        self.force_operations = P + n**2 + 2 * n * P + P**2 + 2 * P
        self.tangent_operations = P + n * P + P**2 + P * n**2 + n**3 + 2 * n * n * n
        self.definite = _definiteness(K4, K2, of)

    def force(self, q: Array) -> Array:
        r = q[self.i] * q[self.j]
        return self.K2 @ q + self.K3 @ r + _form(self.K3.T @ q + 2.0 * (self.K4 @ r), len(q)) @ q

    def tangent(self, q: Array) -> Array:
        r = q[self.i] * q[self.j]
        D = self._slopes(q)
        X = self.K3 @ D
        return self.K2 + X + X.T + _form(self.K3.T @ q + 2.0 * (self.K4 @ r), len(q)) + D.T @ (2.0 * (self.K4 @ D))

    def _slopes(self, q: Array) -> Array:
        """dr/dq (pairs, n)."""
        D, k = np.zeros((len(self.i), self.coordinates)), np.arange(len(self.i))
        D[k, self.i] += q[self.j]
        D[k, self.j] += q[self.i]
        return D


class Squares(Energy):
    """V = q.K2 q/2 + sum e_r^2/2, e_r = q.L_r q/2, of V4 = r.K4 r."""

    def __init__(self, name: str, K2: Array, K4: Array, linear: Array, square: Array, solves: int) -> None:
        self.name, self.K2, self.linear, self.solves = name, K2, linear, solves
        m = self.coordinates = len(K2)
        i, j = np.triu_indices(m)
        scale = 1.0 / np.sqrt(np.diag(K2))
        weight = scale[i] * scale[j] * np.where(i == j, 1.0, np.sqrt(0.5))
        values, vectors = np.linalg.eigh(2.0 * K4 * np.outer(weight, weight))
        self.definite = float(values[0] / values[-1])
        kept = values > KEPT * values[-1]
        forms = (vectors[:, kept] * np.sqrt(values[kept]) / weight[:, None]).T
        self.L = np.zeros((len(forms), m, m))
        self.L[:, i, j] += forms
        self.L[:, j, i] += forms
        self.bend = _form(square, m)
        R = len(forms)
        self.force_operations = m**2 + R * m**2 + 2 * R * m
        self.tangent_operations = R * m**2 + R * m + 2 * R * m**2

    def move(self, work: float, ends: Ends) -> None:
        """Take in one more coordinate, a rigid translation on which the load does `work`, and what holds it."""
        self.K2, self.bend = np.pad(self.K2, (0, 1)), np.pad(self.bend, (0, 1))
        self.linear = np.append(self.linear, work)
        self.L = np.pad(self.L, ((0, 0), (0, 1), (0, 1)))
        self.ends, self.coordinates = ends, self.coordinates + 1

    def force(self, q: Array) -> Array:
        y = self.L @ q
        return self.K2 @ q + (0.5 * (y @ q)) @ y

    def tangent(self, q: Array) -> Array:
        y = self.L @ q
        return self.K2 + y.T @ y + np.tensordot(0.5 * (y @ q), self.L, 1)


class FewCells(Energy):
    """Forces of `basis` (3 n, n) from the cells with a weight above zero."""

    def __init__(self, name: str, body: StVenantKirchhoffBody, basis: Array, weights: Array, load: Array, solves: int):
        self.name, self.coordinates, self.solves = name, basis.shape[1], solves
        self.bend = np.zeros((basis.shape[1], basis.shape[1]))
        cells = np.flatnonzero(weights > 0.0)
        nodes, local = np.unique(body.nodes[cells], return_inverse=True)
        few = copy.copy(body)
        few.nodes = local.reshape(len(cells), -1)
        few.slopes, few.weight = body.slopes[cells], body.weight[cells] * weights[cells, None]
        few.size = 3 * len(nodes)
        few.dofs = (3 * few.nodes[:, :, None] + np.arange(3)).reshape(len(cells), -1)
        self.body, self.cells, self.linear = few, len(cells), basis.T @ load
        self.basis = basis[(3 * nodes[:, None] + np.arange(3)).ravel()]
        n, (points, a) = self.coordinates, body.slopes.shape[1:3]
        self.force_operations = len(cells) * (6 * a * n + points * (2 * POINT + 90))
        dofs = 3 * a
        made = points * (6 * 6 * dofs + 6 * dofs**2 // 2 + 4 * a**2)
        self.tangent_operations = len(cells) * (3 * a * n + points * (POINT + 90) + made + dofs**2 * n + dofs * n**2)

    def force(self, q: Array) -> Array:
        return self.basis.T @ self.body.forces(self.basis @ q)

    def tangent(self, q: Array) -> Array:
        return self.basis.T @ (self.body.tangent(self.basis @ q) @ self.basis)


def _form(t: Array, m: int) -> Array:
    """Second derivative (m, m) of t.r by m coordinates."""
    G = np.zeros((m, m))
    G[np.triu_indices(m)] = t
    return G + G.T


def _definiteness(K4: Array, K2: Array, of: int) -> float:
    """Least over largest eigenvalue of V4 on the products of the first `of` coordinates, each at unit energy."""
    i, j = np.triu_indices(len(K2))
    here = (i < of) & (j < of)
    scale = 1.0 / np.sqrt(np.diag(K2))
    weight = (scale[i] * scale[j] * np.where(i == j, 1.0, np.sqrt(0.5)))[here]
    values = np.linalg.eigvalsh(K4[np.ix_(here, here)] * np.outer(weight, weight))
    return float(values[0] / values[-1])


def galerkin(structure: Structure, basis: Array, name: str, solves: int = 0, of: int | None = None) -> Quartic:
    """V on a basis; `of`: coordinates that V4's definiteness is told of."""
    fields = Fields(structure.body, basis)
    K2, K3, K4 = fields.Y1.T @ fields.Y1, fields.Y1.T @ fields.Y2, 0.5 * fields.Y2.T @ fields.Y2
    return Quartic(name, K2, K3, K4, basis.T @ structure.load, None, solves, of or basis.shape[1])


def squares(structure: Structure, modes: Array) -> Squares:
    """The engine's energy."""
    fields = Fields(structure.body, modes)
    theta = -structure.solve(fields.pushes(turning=False))
    E2 = fields.Y2 + fields.strain(theta)
    K4 = 0.5 * E2.T @ E2
    g = structure.load
    return Squares("sum of squares", fields.Y1.T @ fields.Y1, K4, modes.T @ g, theta.T @ g, theta.shape[1])


def free_ends(structure: Structure, count: int) -> Squares:
    """The engine's energy of a body with one end that moves: `count` vibration modes, three static responses of the
    end, and the rigid translation along z as the last coordinate."""
    body, end, size = structure.body, structure.end, structure.body.size
    x = body.mesh.points[end] - body.mesh.points[end].mean(axis=0)
    outside = np.setdiff1d(structure.free, (3 * end[:, None] + np.arange(3)).ravel())
    n = len(outside)
    rows = np.concatenate([outside, 3 * end, 3 * end + 2, 3 * end])
    k = len(end)
    columns = np.concatenate([np.arange(n), np.full(k, n), np.full(k, n + 1), np.full(k, n + 2)])
    T = csr_matrix((np.concatenate([np.ones(n + 2 * k), x[:, 2]]), (rows, columns)), shape=(size, n + 3))
    K, M = csc_matrix(T.T @ body.K @ T), csc_matrix(T.T @ body.M @ T)
    rigid = np.concatenate([(outside % 3 == 2).astype(float), [0.0, 1.0, 0.0]])
    weight = M @ rigid / (rigid @ (M @ rigid))
    moving = np.delete(np.arange(n + 3), n + 1)
    solver = splu(csc_matrix(K[moving][:, moving]))

    def flexibility(f: Array) -> Array:
        f = f - np.outer(weight, rigid @ f)
        u = np.zeros(f.shape)
        u[moving] = solver.solve(np.ascontiguousarray(f[moving]))
        return u - np.outer(rigid, weight @ u)

    shift = -1e-3 * float(K.diagonal().max() / M.diagonal().max())
    omega2, V = eigsh(K, count + 1, M, sigma=shift, v0=np.ones(n + 3))
    V = V[:, np.argsort(omega2)[1:]]
    Q = np.concatenate([V - np.outer(rigid, weight @ V), flexibility(np.eye(n + 3)[:, n:])], axis=1)
    Q = Q / np.sqrt(np.sum(Q * (K @ Q), axis=0))
    omega2, Z = eigh(Q.T @ (K @ Q), Q.T @ (M @ Q))
    modes = Q @ Z
    fields = Fields(body, T @ modes)
    theta = -flexibility(T.T @ fields.pushes(turning=False))
    E2 = fields.Y2 + fields.strain(T @ theta)
    g, m = T.T @ structure.load, modes.shape[1]
    K2, solves = fields.Y1.T @ fields.Y1, theta.shape[1] + 3
    found = Squares("sum of squares, ends free", K2, 0.5 * E2.T @ E2, modes.T @ g, theta.T @ g, solves)
    C = np.concatenate([modes[n:], rigid[n:, None]], axis=1)
    D = np.stack([np.pad(_form(theta[c], m), (0, 1)) for c in range(n, n + 3)])
    found.move(float(rigid @ g), Ends(C, D))
    return found


def slaved(structure: Structure, modes: Array) -> Quartic:
    """Modal derivatives that follow the modes, up to fourth order: V3 = q.K3 r - q.Phi^T f_2 r = -2 q.K3 r."""
    fields = Fields(structure.body, modes)
    f = fields.pushes(turning=True)
    theta = -structure.solve(f)
    K2, K3 = fields.Y1.T @ fields.Y1, fields.Y1.T @ fields.Y2
    K4 = 0.5 * fields.Y2.T @ fields.Y2 + 0.5 * f.T @ theta
    g = structure.load
    work = theta.T @ g
    return Quartic("derivatives slaved", K2, -2.0 * K3, 0.5 * (K4 + K4.T), modes.T @ g, work, f.shape[1], len(K2))


def with_derivatives(structure: Structure, modes: Array) -> Array:
    """Phi and the independent ones of its static modal derivatives (3 n, n)."""
    f = Fields(structure.body, modes).pushes(turning=True)
    theta = structure.solve(f)
    K = structure.body.K
    modes = modes / np.sqrt(np.sum(modes * (K @ modes), axis=0))
    theta = theta - modes @ (modes.T @ (K @ theta))
    size = np.sqrt(np.sum(theta * (K @ theta), axis=0))
    theta = theta[:, size > 1e-9 * size.max()] / size[size > 1e-9 * size.max()]
    values, vectors = eigh(theta.T @ (K @ theta))
    kept = values > INDEPENDENT * values[-1]
    return np.concatenate([modes, theta @ (vectors[:, kept] / np.sqrt(values[kept]))], axis=1)


def few_cells(structure: Structure, basis: Array, states: list[Array], solves: int) -> FewCells:
    """Cells and weights for the forces of the `states` (n,), a block of rows a state, normed by its forces."""
    body, rows, sums = structure.body, [], []
    for q in states:
        u = basis @ q
        P = np.matmul(body.gradient(u) + np.eye(3), body.stress(u)[..., np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])])
        local = np.einsum("eqcd,eqad,eq->eac", P, body.slopes, body.weight, optimize=True).reshape(len(body.nodes), -1)
        G = np.einsum("ek,ekn->ne", local, basis[body.dofs])
        size = np.linalg.norm(G.sum(axis=1))
        rows.append(G / size)
        sums.append(G.sum(axis=1) / size)
    weights = few_weights(np.concatenate(rows), np.concatenate(sums), TRAINED)
    return FewCells("ECSW", body, basis, weights, structure.load, solves)


def few_weights(G: Array, b: Array, tolerance: float) -> Array:
    """w >= 0 with |G w - b| <= tolerance |b|, few of them not zero: C. L. Lawson and R. J. Hanson's active sets, ended
    early."""
    w, active = np.zeros(G.shape[1]), np.zeros(G.shape[1], dtype=bool)
    for _ in range(3 * G.shape[1]):
        rest = b - G @ w
        if np.linalg.norm(rest) <= tolerance * np.linalg.norm(b) or active.all():
            break
        slope = np.where(active, -np.inf, G.T @ rest)
        active[int(np.argmax(slope))] = True
        while True:
            at = np.flatnonzero(active)
            x = np.linalg.lstsq(G[:, at], b, rcond=None)[0]
            if np.all(x > 0.0):
                w[:] = 0.0
                w[at] = x
                break
            low = x <= 0.0
            steps = w[at][low] / np.maximum(w[at][low] - x[low], 1e-300)
            w[at] += float(steps.min()) * (x - w[at])
            w[w <= 1e-14 * w.max(initial=0.0)] = 0.0
            active &= w > 0.0
            if not active.any():
                break
    return w


def equilibria(energy: Energy, factors: Array) -> list[Array]:
    """q at every factor of the load, each from the one before; NaN from where none is found."""
    n = energy.coordinates
    ends = energy.ends or Ends(np.zeros((0, n)), np.zeros((0, n, n)))
    q, holds, found = np.zeros(n), np.zeros(len(ends.C)), []
    for factor in factors:
        for _ in range(ITERATIONS):
            slope = ends.C + ends.D @ q
            rest = factor * energy.load(q) - energy.force(q) - slope.T @ holds
            off = -(ends.C @ q + 0.5 * (ends.D @ q) @ q)
            still = np.abs(off).max(initial=0.0) <= BALANCED * np.abs(ends.C @ q).max(initial=0.0) + TINY
            if not np.isfinite(rest).all():
                break
            if still and np.linalg.norm(rest) <= BALANCED * factor * np.linalg.norm(energy.linear):
                break
            H = energy.tangent(q) - factor * energy.bend + np.tensordot(holds, ends.D, 1)
            both = np.block([[H, slope.T], [slope, np.zeros((len(holds), len(holds)))]])
            step = np.linalg.solve(both, np.concatenate([rest, off]))
            q, holds = q + step[:n], holds + step[n:]
        else:
            q = np.full_like(q, np.nan)
        found.append(q.copy())
    return found
