"""Heat conduction and free thermal expansion of a box by scikit-fem: all nodes, all eigenmodes, no reduction.

Faces: flux(x, y) [W/m2] enters at the top, z = size[2]; convection h [W/(m2 K)] at z = 0; the rest is insulated.
Trilinear hexahedra; temperatures are those above the surroundings, at which the box has its dimensions.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
import scipy.linalg as sla
import scipy.sparse as sp
import skfem as scikit_fem
from scipy.sparse.linalg import spsolve
from skfem import helpers

Array = np.ndarray
skfem: Any = scikit_fem  # its types are those of its callers
ddot, div, dot, eye, grad, sym_grad, trace = (
    getattr(helpers, name) for name in ("ddot", "div", "dot", "eye", "grad", "sym_grad", "trace")
)


class HeatedBox:
    def __init__(
        self, size: tuple[float, float, float], counts: tuple[int, int, int], *, youngs_modulus: float,
        poisson_ratio: float, density: float, conductivity: float, heat_capacity: float, expansion: float, h: float,
    ) -> None:  # fmt: skip
        axes = [np.linspace(0.0, length, n + 1) for length, n in zip(size, counts, strict=True)]
        self.mesh = skfem.MeshHex.init_tensor(*axes)
        self.top = size[2]
        element = skfem.ElementHex1()
        self.scalar = skfem.Basis(self.mesh, element, intorder=4)
        self.vector = self.scalar.with_element(skfem.ElementVector(element))
        low = skfem.FacetBasis(self.mesh, element, facets=self.mesh.facets_satisfying(lambda x: x[2] < 1e-12))
        self.high = skfem.FacetBasis(
            self.mesh, element, facets=self.mesh.facets_satisfying(lambda x: x[2] > size[2] - 1e-12), intorder=6
        )
        mass = skfem.BilinearForm(lambda u, v, w: u * v)
        conduction = skfem.BilinearForm(lambda u, v, w: dot(grad(u), grad(v)))
        self.K = conductivity * conduction.assemble(self.scalar) + h * mass.assemble(low)
        self.C = density * heat_capacity * mass.assemble(self.scalar)
        mu = youngs_modulus / (2.0 * (1.0 + poisson_ratio))
        lam = youngs_modulus * poisson_ratio / ((1.0 + poisson_ratio) * (1.0 - 2.0 * poisson_ratio))

        def stress(u, v, w):
            e = sym_grad(u)
            return ddot(2.0 * mu * e + lam * eye(trace(e), 3), sym_grad(v))

        self.elastic = skfem.BilinearForm(stress).assemble(self.vector)
        self.inertia = density * skfem.BilinearForm(lambda u, v, w: dot(u, v)).assemble(self.vector)
        self.bulk = (3.0 * lam + 2.0 * mu) * expansion
        self.divergence = skfem.BilinearForm(lambda u, v, w: u * div(v)).assemble(self.scalar, self.vector)

    @property
    def points(self) -> Array:
        """(n, 3) m, in the order of all fields."""
        return self.scalar.doflocs.T

    def load(self, flux: Callable[[Array, Array], Array]) -> Array:
        """(n,) W."""
        return skfem.LinearForm(lambda v, w: flux(w.x[0], w.x[1]) * v).assemble(self.high)

    def steady(self, load: Array) -> Array:
        """(n,) K."""
        return np.asarray(spsolve(self.K.tocsc(), load))

    @cached_property
    def _eigen(self) -> tuple[Array, Array]:
        return sla.eigh(self.K.toarray(), self.C.toarray())

    def after(self, time: float, load: Array) -> Array:
        """(n,) K after a step of the flux at time zero."""
        rates, V = self._eigen
        return V @ ((1.0 - np.exp(-rates * time)) / rates * (V.T @ load))

    def expansion(self, theta: Array) -> Array:
        """(n, 3) m, M-orthogonal to rigid motion."""
        f = self.bulk * (self.divergence @ theta)
        dofs = self.vector.nodal_dofs  # (3, vertices)
        at = self.mesh.p - self.mesh.p.mean(axis=1, keepdims=True)
        R = np.zeros((len(f), 6))
        for i in range(3):
            R[dofs[i], i] = 1.0
            R[dofs[(i + 1) % 3], 3 + i], R[dofs[(i + 2) % 3], 3 + i] = -at[(i + 2) % 3], at[(i + 1) % 3]
        L = self.inertia @ R
        system = sp.bmat([[self.elastic, L], [L.T, None]], format="csc")
        u = np.asarray(spsolve(system, np.concatenate([f, np.zeros(6)])))[: len(f)]
        found = np.zeros((self.mesh.p.shape[1], 3))
        for i in range(3):
            found[:, i] = u[dofs[i]]
        return found[np.argsort(self.scalar.nodal_dofs[0])]
