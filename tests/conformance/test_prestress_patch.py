"""Every cell kind: under a constant stress s, linear modes a x, b x have the geometric stiffness V tr(a s b^T)."""

from __future__ import annotations

import numpy as np
from element_meshes import crooked_block, each_formulation

from warpffrf.model.material import Material
from warpffrf.offline.fe import assign
from warpffrf.offline.inertia.invariants import prestress_stiffness

VOLUME = 1.0 * 0.8 * 0.6  # m3, of the block
ROUND_OFF = 1e-11  # relative: sums of some hundred terms


@each_formulation
def test_constant_prestress(kind: str, material: Material) -> None:
    mesh = crooked_block(kind)
    rng = np.random.default_rng(6)
    loads, modes = rng.normal(size=(2, 3, 3)), rng.normal(size=(4, 3, 3))
    static = np.stack([(mesh.points @ a.T).ravel() for a in loads], axis=1)
    U = np.stack([(mesh.points @ a.T).ravel() for a in modes], axis=1)
    lam, mu = material.lame
    s = np.stack([lam * np.trace(a) * np.eye(3) + mu * (a + a.T) for a in loads])
    expected = VOLUME * np.einsum("iab,lbc,jac->lij", modes, s, modes)
    found = prestress_stiffness(mesh.points, mesh.cells, assign(mesh, material), static, U)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=ROUND_OFF * np.abs(expected).max())
