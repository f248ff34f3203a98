r"""The pressure of the mixed formulation converges and does not waver: a block whose volume hardly changes, held all
around, with body forces of a known solution.

Stokes' problem with u = curl(0, 0, psi), psi = (x (1-x) y (1-y) z (1-z))^2, at rest on the surface, and a pressure p of
zero mean; f = grad p - mu Laplace u. That div u is 0 and not -p/lambda is a difference of mu/lambda = 2e-4.
"""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse.linalg as spla
from element_meshes import RUBBER, lattice_mesh

from warpffrf.model.mesh.elements import CELL_KINDS, cell_kind
from warpffrf.offline.fe import WAVERING, assemble, assign
from warpffrf.offline.stress.operator import Slots, nodal_stress

MU = RUBBER.lame[1]
STRENGTH = 100.0  # of the motion, so that its shear stresses are as large as the pressure
KINDS = [kind for kind in CELL_KINDS if cell_kind(kind).dilatation is not None]
COUNTS = {1: (6, 12), 2: (4, 8)}  # cells along an edge
PRESSURE = 0.15  # at the finer mesh; measured at most 0.1
RATE = 1.0  # orders of the pressure; measured 1.7 to 3.2
SECOND = 1.6  # orders of the displacement; with constant pressures two, measured 1.7


def crooked(x: np.ndarray) -> np.ndarray:
    """Places in the unit cube, its surface kept."""
    bump = np.prod(np.sin(np.pi * x), axis=1)[:, None]
    return x + 0.06 * bump * np.array([1.0, -0.7, 0.5])


def polynomial(x: np.ndarray) -> list[np.ndarray]:
    """(x (1 - x))^2 and its first three derivatives."""
    return [
        x**2 - 2.0 * x**3 + x**4, 2.0 * x - 6.0 * x**2 + 4.0 * x**3, 2.0 - 12.0 * x + 12.0 * x**2, -12.0 + 24.0 * x
    ]  # fmt: skip


def exact(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Displacement (n, 3), pressure (n,) and body force (n, 3)."""
    (a, a1, a2, a3), (b, b1, b2, b3), (c, _, c2, _) = (polynomial(points[:, i]) for i in range(3))
    u = STRENGTH * np.stack([a * b1 * c, -a1 * b * c, 0.0 * a], axis=1)
    laplace = [a2 * b1 * c + a * b3 * c + a * b1 * c2, -(a3 * b * c + a1 * b2 * c + a1 * b * c2), 0.0 * a]
    cos, sin = np.cos(np.pi * points), np.sin(np.pi * points)
    p = MU * np.prod(cos, axis=1)
    slope = -MU * np.pi * np.stack([sin[:, i] * cos[:, (i + 1) % 3] * cos[:, (i + 2) % 3] for i in range(3)], axis=1)
    return u, p, slope - MU * STRENGTH * np.stack(laplace, axis=1)


def errors(kind: str, count: int) -> tuple[float, float]:
    """Root mean squares over the nodes: of the displacement, of the pressure, over those of the solution."""
    mesh = lattice_mesh(kind, (count, count, count), crooked)
    assignment = assign(mesh, RUBBER)
    K, M = assemble(mesh.points, mesh.cells, assignment)
    u, p, force = exact(mesh.points)
    held = np.zeros(3 * len(mesh.points), dtype=bool)
    held[(3 * mesh.outer_facets().node_set[:, None] + np.arange(3)).ravel()] = True
    free = np.flatnonzero(~held)
    found = np.zeros(len(held))
    load = M @ force.ravel() / RUBBER.density
    found[free] = np.asarray(spla.spsolve(K[free][:, free].tocsc(), load[free]))
    every = Slots(np.arange(len(mesh.points)), np.zeros(len(mesh.points), dtype=int))
    stress = (nodal_stress(mesh.points, mesh.cells, assignment, every) @ found).reshape(-1, 6)
    pressure = -stress[:, :3].mean(axis=1)
    return float(np.linalg.norm(found - u.ravel()) / np.linalg.norm(u)), float(
        np.linalg.norm(pressure - p) / np.linalg.norm(p)
    )


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_displacement_and_pressure_converge(kind: str) -> None:
    """Of quadratic tetrahedra the displacement alone: `reduce` warns of their mean stress."""
    coarse, fine = (errors(kind, count) for count in COUNTS[cell_kind(kind).degree])
    rates = np.log2(np.array(coarse) / fine)
    print(f"{kind}: displacement {fine[0]:.2%}, rate {rates[0]:.2f}; pressure {fine[1]:.1%}, rate {rates[1]:.2f}")
    assert rates[0] > SECOND
    if kind != WAVERING:
        assert fine[1] < PRESSURE and rates[1] > RATE
