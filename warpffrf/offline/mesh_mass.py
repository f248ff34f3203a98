r"""Mass properties of a mesh: `m = int rho dV`, `c = int rho x dV / m`, `J = int rho (d.d 1 - d d^T) dV`, `d = x - c`.

The quadrature is that of the consistent mass matrix, so the numbers are those of the finite-element model.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.errors import require_number
from warpffrf.model.mesh import Mesh
from warpffrf.offline.assembly import MASS_DEGREE, rule

CHUNK = 20_000  # cells taken together: some tens of MB


def mesh_mass(mesh: Mesh, density: float) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass [kg], centre (3,) [m] and inertia about it (3, 3) [kg m2], axes of the mesh, for `density` [kg/m3]."""
    density = require_number(density, "density", positive=True)
    origin = mesh.points.mean(axis=0)  # near the body: no cancellation for a mesh far from its origin
    volume, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for kind, cells in mesh.cells.items():
        r = rule(kind, MASS_DEGREE[kind])
        for start in range(0, len(cells), CHUNK):
            x = mesh.points[cells[start : start + CHUNK]] - origin
            J = np.einsum("eai,qaj->eqij", x, r.gradients)
            weight = np.linalg.det(J) * r.weights
            at = np.einsum("qa,eai->eqi", r.values, x)
            volume += float(weight.sum())
            first += np.einsum("eq,eqi->i", weight, at)
            second += np.einsum("eq,eqi,eqj->ij", weight, at, at)
    c = first / volume
    spread = second - volume * np.outer(c, c)
    return density * volume, origin + c, density * (np.trace(spread) * np.eye(3) - spread)
