r"""Bodies by full finite elements of scikit-fem, in the numbering of their meshes, with supports, loads and springs.

Dofs are 3 (offset of the body + node) + component, body after body. A load distributed evenly over a set of facets
is a vector a of nodal forces int N dA/A; a^T u is then the mean displacement of the set, and a spring of stiffness k on
the difference of two such means is K + k a a^T.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from references.finite_elements.meshes import facet_shares, matrices
from warpffrf.model.errors import InputError, require_array
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.facets import rigid_modes

Array = np.ndarray
Sparse = Any  # scipy.sparse
HELD = 1e-9  # of the largest entry of K: least stiffness of a constrained rigid motion; round-off is 1e-14


@dataclass(frozen=True, eq=False)
class Part:
    """A body of the model: mesh (in the common frame), material, fixed facet sets."""

    mesh: Mesh
    material: Material
    held: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class FullModel:
    """Several bodies; `springs`: pairs of a vector a (dofs,) and a stiffness k [N/m], see the module docstring.

    Raises `InputError` for sets that a mesh does not have.
    """

    parts: Sequence[Part]
    springs: tuple[tuple[Array, float], ...] = ()

    @cached_property
    def offsets(self) -> Array:
        """First node of each body, and the number of all nodes."""
        return np.concatenate([[0], np.cumsum([len(p.mesh.points) for p in self.parts])])

    @property
    def size(self) -> int:
        """Number of dofs, including fixed ones."""
        return 3 * int(self.offsets[-1])

    @cached_property
    def points(self) -> Array:
        """All nodes (n, 3) [m]."""
        return np.concatenate([p.mesh.points for p in self.parts])

    @cached_property
    def _matrices(self) -> tuple[Sparse, Sparse]:
        K, M = zip(*(matrices(p.mesh, p.material) for p in self.parts), strict=True)
        return sp.csr_matrix(sp.block_diag(K)), sp.csr_matrix(sp.block_diag(M))

    @cached_property
    def K(self) -> Sparse:
        """Stiffness (dofs, dofs) [N/m], springs included."""
        K = self._matrices[0]
        for a, k in self.springs:
            column = sp.csr_matrix(a[:, None])
            K = K + k * (column @ column.T)
        return sp.csr_matrix(K)

    @property
    def M(self) -> Sparse:
        """Mass (dofs, dofs) [kg]."""
        return self._matrices[1]

    @cached_property
    def free(self) -> Array:
        """Dofs that are not fixed."""
        held = [
            self.offsets[i] + part.mesh.facets(name).node_set for i, part in enumerate(self.parts) for name in part.held
        ]
        fixed = np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *held]))
        return np.setdiff1d(np.arange(self.size), (3 * fixed[:, None] + np.arange(3)).ravel())

    def factor(self, A: Sparse) -> Any:
        """Solver of free dofs with the symmetric definite A (dofs, dofs): an object with `solve(F)`."""
        block = sp.csc_matrix(A[self.free][:, self.free])
        return splu(block, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})

    @cached_property
    def _static(self) -> Any:
        for i, part in enumerate(self.parts):
            if not part.held:
                self._require_springs(i, part)
        return self.factor(self.K)

    def _require_springs(self, i: int, part: Part) -> None:
        """Raises `InputError` if springs do not constrain an otherwise unsupported body."""
        x = part.mesh.points
        R = rigid_modes(x, x.mean(axis=0))
        R[:, 3:] /= np.ptp(x, axis=0).max()  # rotations times a length are displacements
        dofs = slice(3 * int(self.offsets[i]), 3 * int(self.offsets[i + 1]))
        held = np.linalg.eigvalsh(R.T @ (self.K[dofs, dofs] @ R))[0]
        if held < HELD * abs(self.K[dofs, dofs]).max():
            raise InputError(
                f"full model: nothing holds body {i} ({part.mesh.name or 'unnamed'}) against all rigid motions; hold a "
                "facet set of it, or add springs"
            )

    def solve(self, F: Any) -> Array:
        """K^-1 F (dofs, m) with the supports; F (dofs, m), dense or sparse."""
        F = F.toarray() if sp.issparse(F) else np.asarray(F, dtype=float)
        U = np.zeros(F.shape)
        U[self.free] = self._static.solve(np.ascontiguousarray(F[self.free]))
        return U

    def spread(self, part: int, name: str, direction: Any) -> Array:
        """a (dofs,): the force `direction` (3,) [N] distributed evenly over a facet set of a body."""
        vector = require_array(direction, f"load on {name!r}", (3,))
        mesh = self.parts[part].mesh
        share = np.zeros(len(mesh.points))
        for kind, nodes in mesh.facets(name).blocks.items():
            np.add.at(share, nodes, facet_shares(kind, mesh.points[nodes])[0])
        a = np.zeros((int(self.offsets[-1]), 3))
        a[self.offsets[part] : self.offsets[part + 1]] = share[:, None] / share.sum() * vector
        return a.ravel()

    def body_force(self, acceleration: Any) -> Array:
        """Loads (dofs,) [N] of a uniform acceleration (3,) [m/s2] of all bodies."""
        field = np.tile(require_array(acceleration, "acceleration", (3,)), int(self.offsets[-1]))
        return self.M @ field

    def with_springs(self, *springs: tuple[Array, float]) -> FullModel:
        """The same with more springs. Raises `InputError` for a stiffness that is not positive."""
        for _, k in springs:
            if not k > 0.0:
                raise InputError(f"full model: the stiffness of a spring must be positive, got {k:g}")
        return replace(self, springs=(*self.springs, *springs))
