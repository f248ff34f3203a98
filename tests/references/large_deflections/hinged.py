r"""Rigid patches of nodes that rotate about fixed axes, on a body of full finite elements: at rest, in motion.

Node a of patch p, at X_a, follows the rotation theta_p about the unit axis n_p through c_p (Rodrigues, s = X_a - c_p):

    u_a = sin(theta) n x s + (1 - cos(theta)) n x (n x s),
    u_a' = cos(theta) n x s + sin(theta) n x (n x s),      u_a'' = -sin(theta) n x s + cos(theta) n x (n x s).

With the unknowns y of free dofs and rotations, J = du/dy, equilibrium J^T (p g - f(u)) = 0 has the tangent

    J^T K J + diag over rotations of (f - p g).u''.

In motion M udd, udd = J ydd + u'' thetad^2, is added to f; y is integrated by the trapezoidal rule, with the
tangent at the beginning of the step for all its iterations.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from references.finite_elements.meshes import Sparse
from references.large_deflections.body import StVenantKirchhoffBody
from references.large_deflections.statics import BALANCED, ITERATIONS, State
from warpffrf.model.errors import InputError, require_array

Array = np.ndarray


@dataclass(frozen=True, eq=False)
class Hinge:
    """The nodes of the facet set `name` rotate as one about the `axis` (3,) through `point` (3,) [m]."""

    name: str
    point: Array | tuple[float, float, float]
    axis: Array | tuple[float, float, float]


class HingedBody:
    """A `body` supported by its `hinges` alone. Raises `InputError` for patches that share nodes."""

    def __init__(self, body: StVenantKirchhoffBody, hinges: Sequence[Hinge]) -> None:
        self.body, self.hinges = body, tuple(hinges)
        self.dofs, self.levers, self.bows = [], [], []
        for hinge in self.hinges:
            dofs = body.held(hinge.name)
            axis = require_array(np.asarray(hinge.axis, float), "hinge: axis", (3,))
            axis = axis / np.linalg.norm(axis)
            s = body.mesh.points.ravel()[dofs].reshape(-1, 3) - np.asarray(hinge.point, float)
            lever = np.cross(axis, s)
            self.dofs.append(dofs)
            self.levers.append(lever.ravel())
            self.bows.append(np.cross(axis, lever).ravel())
        held = np.concatenate(self.dofs)
        if len(np.unique(held)) < len(held):
            raise InputError("hinged body: patches share nodes; give patches that lie apart")
        self.free = body.free(held)

    def displacement(self, y: Array) -> Array:
        """u (3 n,) [m] of the free dofs [m] followed by the rotations [rad]."""
        u = np.zeros(self.body.size)
        u[self.free] = y[: len(self.free)]
        for dofs, lever, bow, turn in zip(self.dofs, self.levers, self.bows, self._turns(y), strict=True):
            u[dofs] = np.sin(turn) * lever + (1.0 - np.cos(turn)) * bow
        return u

    def slope(self, y: Array) -> Sparse:
        """J (3 n, size of y)."""
        J = sp.lil_matrix((self.body.size, len(y)))
        J[self.free, np.arange(len(self.free))] = 1.0
        for i, (dofs, lever, bow) in enumerate(zip(self.dofs, self.levers, self.bows, strict=True)):
            turn = self._turns(y)[i]
            J[dofs, len(self.free) + i] = np.cos(turn) * lever + np.sin(turn) * bow
        return J.tocsr()

    def bent(self, y: Array) -> Array:
        """u'' (3 n, hinges) by the rotations."""
        found = np.zeros((self.body.size, len(self.hinges)))
        for i, (dofs, lever, bow) in enumerate(zip(self.dofs, self.levers, self.bows, strict=True)):
            turn = self._turns(y)[i]
            found[dofs, i] = np.cos(turn) * bow - np.sin(turn) * lever
        return found

    def at_rest(self, load: Array, factors: Sequence[float] | Array) -> list[State]:
        """States under the dead `load` (3 n,) [N] times each of the `factors`, each from the one before.

        Raises `InputError` if Newton's method does not converge.
        """
        y, states = np.zeros(len(self.free) + len(self.hinges)), []
        for factor in factors:
            residuals = []
            for _ in range(ITERATIONS):
                u = self.displacement(y)
                unbalanced = factor * load - self.body.forces(u)
                rest = self.slope(y).T @ unbalanced
                residuals.append(float(np.linalg.norm(rest) / np.linalg.norm(factor * load)))
                if residuals[-1] < BALANCED or not np.isfinite(residuals[-1]):
                    break
                y += splu(self._tangent(y, unbalanced), permc_spec="MMD_AT_PLUS_A").solve(rest)
            _require_balance(residuals, f"load factor {factor:g}")
            states.append(State(self.displacement(y), factor, residuals))
        return states

    def released(self, load: Array, step: float, steps: int) -> Iterator[Array]:
        """u (3 n,) [m] after each of `steps` steps of `step` [s], from rest undeformed under the dead `load` (3 n,)
        [N] that acts from the beginning. Raises `InputError` as `at_rest`."""
        M, first = self.body.M, len(self.free)
        y = np.zeros(first + len(self.hinges))
        v, J = np.zeros(len(y)), self.slope(y)
        a = splu(sp.csc_matrix(J.T @ M @ J)).solve(J.T @ load)
        for n in range(steps):
            before, acc = y.copy(), 4.0 / step**2
            inertia = sp.csc_matrix(acc * (J.T @ M @ J))
            unbalanced = load - self.body.forces(self.displacement(y))
            factor = splu(self._tangent(y, unbalanced) + inertia, permc_spec="MMD_AT_PLUS_A")
            y = y + step * v + 0.5 * step**2 * a  # keeps the acceleration
            residuals = []
            for _ in range(ITERATIONS):
                J, d = self.slope(y), y - before
                a1, v1 = acc * (d - step * v) - a, 2.0 * d / step - v
                pushed = M @ (J @ a1 + self.bent(y) @ v1[first:] ** 2)
                rest = J.T @ (load - self.body.forces(self.displacement(y)) - pushed)
                residuals.append(float(np.linalg.norm(rest) / np.linalg.norm(load)))
                if residuals[-1] < BALANCED or not np.isfinite(residuals[-1]):
                    break
                y = y + factor.solve(rest)
            _require_balance(residuals, f"step {n + 1}")
            a, v = a1, v1
            yield self.displacement(y)

    def _tangent(self, y: Array, unbalanced: Array) -> sp.csc_matrix:
        J = self.slope(y)
        turns = np.zeros(len(y))
        turns[len(self.free) :] = -unbalanced @ self.bent(y)
        return sp.csc_matrix(J.T @ self.body.tangent(self.displacement(y)) @ J + sp.diags(turns))

    def _turns(self, y: Array) -> Array:
        return y[len(self.free) :]


def _require_balance(residuals: list[float], where: str) -> None:
    if not residuals[-1] < BALANCED:
        raise InputError(f"hinged body: no balance found at {where}, residual {residuals[-1]:.2g}; take smaller steps")
