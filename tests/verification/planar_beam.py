r"""A beam that bends, stretches and shears in a plane without limit of its turns, in finite elements of its own.

Places r(s) = (x, y) of the axis and turns theta(s) of the sections, by s along the undeformed axis (E. Reissner, ZAMP
23, 1972; J. C. Simo and L. Vu-Quoc, J. Appl. Mech. 53, 1986), t = (cos theta, sin theta), n = (-sin theta, cos theta):

    strains     e = r'.t - 1,     g = r'.n,     k = theta',
    energy      1/2 int EA e^2 + GA g^2 + EI k^2 ds,
    kinetic     1/2 int rhoA |r_dot|^2 + rhoI theta_dot^2 ds.

Elements have three nodes and two points, which is exact of what is of first order in the strains and locks in neither
stretch nor shear. One end is held at the origin and rotated; time goes by generalized-alpha. Nothing of the package is
used.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import lu_factor, lu_solve

Array = np.ndarray
POINTS = np.array([-1.0, 1.0]) / np.sqrt(3.0)
SHAPE = np.stack([0.5 * POINTS * (POINTS - 1.0), 1.0 - POINTS**2, 0.5 * POINTS * (POINTS + 1.0)])  # (node, point)
SLOPE = np.stack([POINTS - 0.5, -2.0 * POINTS, POINTS + 0.5])
MASS = np.array([[4.0, 2.0, -1.0], [2.0, 16.0, 2.0], [-1.0, 2.0, 4.0]]) / 30.0  # int N_a N_b over a unit length
BALANCED = 1e-6  # of the largest force, or of 1 N: round-off of EA is 1e-9 N
ITERATIONS = 12


@dataclass(frozen=True)
class PlanarBeam:
    """Length [m], EA and GA [N], EI [N m2], mass rhoA [kg/m] and rhoI [kg m], number of elements."""

    length: float
    EA: float
    GA: float
    EI: float
    rhoA: float
    rhoI: float
    elements: int

    @property
    def nodes(self) -> Array:
        """s (n,) [m]."""
        return np.linspace(0.0, self.length, 2 * self.elements + 1)

    def mass(self) -> Array:
        """(3 n, 3 n), dofs x, y, theta of a node."""
        h, n = self.length / self.elements, 2 * self.elements + 1
        M = np.zeros((n, 3, n, 3))
        for e in range(self.elements):
            for c, density in enumerate((self.rhoA, self.rhoA, self.rhoI)):
                M[2 * e : 2 * e + 3, c, 2 * e : 2 * e + 3, c] += density * h * MASS
        return M.reshape(3 * n, 3 * n)

    def forces(self, q: Array) -> tuple[Array, Array]:
        """Derivative (3 n,) of the energy and its tangent (3 n, 3 n)."""
        h, n = self.length / self.elements, 2 * self.elements + 1
        rows = 3 * (2 * np.arange(self.elements)[:, None] + np.repeat(np.arange(3), 3)) + np.tile(np.arange(3), 3)
        local = q[rows].reshape(-1, 3, 3)  # element, node, component
        f, K = np.zeros((self.elements, 9)), np.zeros((self.elements, 9, 9))
        stiffness = np.array([self.EA, self.GA, self.EI])
        for p in range(2):
            N, D = SHAPE[:, p], SLOPE[:, p] * 2.0 / h
            theta, rate = np.einsum("a,eac->ec", N, local)[:, 2], np.einsum("a,eac->ec", D, local)
            t = np.stack([np.cos(theta), np.sin(theta)], axis=1)
            turned = np.stack([-t[:, 1], t[:, 0]], axis=1)
            along, across = (rate[:, :2] * t).sum(axis=1), (rate[:, :2] * turned).sum(axis=1)
            force = np.stack([along - 1.0, across, rate[:, 2]], axis=1) * stiffness
            B = np.zeros((self.elements, 3, 3, 3))  # strain, node, component
            B[:, 0, :, :2] = np.einsum("ec,a->eac", t, D)
            B[:, 1, :, :2] = np.einsum("ec,a->eac", turned, D)
            B[:, 0, :, 2], B[:, 1, :, 2] = np.outer(across, N), np.outer(-along, N)
            B[:, 2, :, 2] = D
            B = B.reshape(-1, 3, 9)
            f += 0.5 * h * np.einsum("es,esi->ei", force, B)
            K += 0.5 * h * np.einsum("esi,s,esj->eij", B, stiffness, B)
            # second derivatives of the strains: de/(dr' dtheta) = n, dg/(dr' dtheta) = -t, and those by theta twice
            G = np.zeros((self.elements, 3, 3, 3, 3))
            mixed = force[:, :1] * turned - force[:, 1:2] * t
            pair = np.einsum("ec,a,b->eacb", mixed, D, N)
            G[:, :, :2, :, 2] += pair
            G[:, :, 2, :, :2] += pair.transpose(0, 3, 1, 2)
            G[:, :, 2, :, 2] += np.einsum("e,a,b->eab", -force[:, 0] * along - force[:, 1] * across, N, N)
            K += 0.5 * h * G.reshape(-1, 9, 9)
        forces, tangent = np.zeros(3 * n), np.zeros((3 * n, 3 * n))
        np.add.at(forces, rows, f)
        np.add.at(tangent, (rows[:, :, None], rows[:, None, :]), K)
        return forces, tangent

    def spun(self, angle: Callable[[float], float], duration: float, step: float, rho: float = 0.8) -> Array:
        """Places and turns (T, 3) of the end, from rest along x, as the section at the origin turns by `angle`(t)."""
        alpha_m, alpha_f = (2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0)
        gamma = 0.5 - alpha_m + alpha_f
        beta = 0.25 * (0.5 + gamma) ** 2
        M, n = self.mass(), 2 * self.elements + 1
        q = np.zeros((n, 3))
        q[:, 0] = self.nodes
        q, v, a, algorithmic = q.ravel(), *np.zeros((3, 3 * n))
        free = slice(3, None)
        acc = (1.0 - alpha_m) / (beta * step**2 * (1.0 - alpha_f))
        ends = [q[-3:].copy()]
        for i in range(round(duration / step)):
            start = q + step * v + step**2 * (0.5 - beta) * algorithmic
            # increments by the algorithmic acceleration: (1 - am) A1 + am A0 = (1 - af) a1 + af a0
            old = (alpha_f * a - alpha_m * algorithmic) / (1.0 - alpha_m)
            q1 = start + step**2 * beta * (old + (1.0 - alpha_f) / (1.0 - alpha_m) * a)
            q1[:3] = 0.0, 0.0, angle((i + 1) * step)
            for _ in range(ITERATIONS):
                a1 = ((q1 - start) / (step**2 * beta) - old) * (1.0 - alpha_m) / (1.0 - alpha_f)
                f, K = self.forces(q1)
                rest = (M @ a1 + f)[free]
                if np.abs(rest).max() < BALANCED * max(np.abs(f).max(), 1.0):
                    break
                q1[free] -= lu_solve(lu_factor(acc * M[free, free] + K[free, free]), rest)
            else:
                raise ArithmeticError(f"planar beam: no balance in step {i + 1}")
            new = (q1 - start) / (step**2 * beta)
            v = v + step * ((1.0 - gamma) * algorithmic + gamma * new)
            q, a, algorithmic = q1, a1, new
            ends.append(q[-3:].copy())
        return np.array(ends)
