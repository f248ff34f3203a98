r"""Two arms of full finite elements, coupled by joints, and their response to harmonic forces by dense matrices.

The elements are triquadratic hexahedra of scikit-fem. With u = T q for all nodes of an arm, where the nodes of an end
face move as a rigid body about the middle of the face, u = t + theta x (x - x_0), and with q of both arms in common,

    (K + i omega D - omega^2 M) q = P_e^T,      H_r = P_r q,      K = sum_arms T^T K_arm T + K_bushing, M, D likewise.

The first arm is clamped at its beginning; the ends of the arms at the hinge have t and the two rotations across its
axis in common. A bushing with damping holds the far end of the second arm, by which alone the frame is damped.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray


@dataclass(frozen=True)
class Arm:
    """A bar along its x axis, from x = 0 to `size[0]`, with `counts` elements."""

    size: tuple[float, float, float]
    counts: tuple[int, int, int]
    youngs_modulus: float
    poisson_ratio: float
    density: float

    def matrices(self) -> tuple[Array, Array, Array, Array]:
        """K and M (n, n), dense, places (n, 3) and components (n,) of the coordinates."""
        from skfem import Basis, BilinearForm, ElementHex2, ElementVector, MeshHex
        from skfem.models.elasticity import lame_parameters, linear_elasticity

        a, b, c = self.size
        sides = ((0.0, a), (-0.5 * b, 0.5 * b), (-0.5 * c, 0.5 * c))
        lines = [np.linspace(*side, n + 1) for side, n in zip(sides, self.counts, strict=True)]
        basis = Basis(MeshHex.init_tensor(*lines), ElementVector(ElementHex2()), intorder=4)
        rho = self.density

        @BilinearForm
        def mass(u: Any, v: Any, _: Any) -> Any:
            return rho * sum(u[i] * v[i] for i in range(3))

        K = linear_elasticity(*lame_parameters(self.youngs_modulus, self.poisson_ratio)).assemble(basis)
        component = np.zeros(basis.N, dtype=int)
        for dofs in (basis.nodal_dofs, basis.edge_dofs, basis.facet_dofs, basis.interior_dofs):
            component[dofs] = np.arange(3)[:, None]
        return K.toarray(), mass.assemble(basis).toarray(), basis.doflocs.T, component


def frame_response(arm: Arm, stiffness: Array, damping: Array, frequencies: Array) -> Array:
    """(2, 3, 2, 3, f): displacements [m/N] of the hinge and of the far end along the world's axes per force on the
    hinge and on the far end. The first arm lies along x, the second from its end along y; the hinge's axis is z.
    `stiffness`, `damping` (6,): diagonals of the bushing, world axes."""
    length = arm.size[0]
    K, M, place, component = arm.matrices()
    ends = [np.abs(place[:, 0] - x) < 1e-9 * length for x in (0.0, length)]
    inner = np.flatnonzero(~(ends[0] | ends[1]))
    n = len(inner)
    # first arm, t and theta of its end, second arm, its own rotation at the hinge, t and theta of the far end
    hinge, second, own, far = n, n + 6, 2 * n + 6, 2 * n + 7
    count = far + 6
    turn = np.array(
        [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    )  # columns: axes of the second arm in the world

    def rigid(at: Array, middle: float, axes: Array) -> Array:
        """(dofs of the face, 6) per t and theta in world axes."""
        r = (place[at] - (middle, 0.0, 0.0)) @ axes.T
        e = axes.T[component[at]]  # direction of each coordinate, in the world
        return np.hstack([e, np.cross(r, e)])  # e . (theta x r) = theta . (r x e)

    T = np.zeros((2, len(place), count))
    T[0, inner, np.arange(n)] = 1.0
    T[0, ends[1], hinge : hinge + 6] = rigid(ends[1], length, np.eye(3))
    T[1, inner, second + np.arange(n)] = 1.0
    begin = rigid(ends[0], 0.0, turn)
    T[1, ends[0], hinge : hinge + 5] = begin[:, :5]
    T[1, ends[0], own] = begin[:, 5]
    T[1, ends[1], far:] = rigid(ends[1], length, turn)
    k, m = (T[0].T @ A @ T[0] + T[1].T @ A @ T[1] for A in (K, M))
    d = np.zeros((count, count))
    k[far:, far:] += np.diag(stiffness)
    d[far:, far:] += np.diag(damping)
    ports = np.r_[hinge : hinge + 3, far : far + 3]
    loads = np.zeros((count, 6))
    loads[ports, np.arange(6)] = 1.0
    w = 2.0 * np.pi * np.asarray(frequencies)
    H = np.stack([np.linalg.solve(k + 1j * x * d - x**2 * m, loads)[ports] for x in w], axis=-1)
    return H.reshape(2, 3, 2, 3, len(w))
