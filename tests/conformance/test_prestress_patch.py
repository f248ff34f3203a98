"""Every cell kind: under a constant stress s, linear modes a x, b x have the geometric stiffness V tr(a s b^T)."""

from __future__ import annotations

import numpy as np
import pytest
from element_meshes import crooked_block

from warpffrf.model.material import Material
from warpffrf.model.mesh.elements import CELL_KINDS
from warpffrf.offline.fe.materials import assign
from warpffrf.offline.inertia.stiffening import prestress_stiffness

STEEL = Material(210e9, 0.3, 7850.0)
VOLUME = 1.0 * 0.8 * 0.6  # m3, of the block
ROUND_OFF = 1e-11  # relative: sums of some hundred terms


@pytest.mark.parametrize("kind", CELL_KINDS)
def test_constant_prestress(kind) -> None:
    mesh = crooked_block(kind)
    rng = np.random.default_rng(6)
    loads, modes = rng.normal(size=(2, 3, 3)), rng.normal(size=(4, 3, 3))
    static = np.stack([(mesh.points @ a.T).ravel() for a in loads], axis=1)
    U = np.stack([(mesh.points @ a.T).ravel() for a in modes], axis=1)
    lam, mu = STEEL.lame
    s = np.stack([lam * np.trace(a) * np.eye(3) + mu * (a + a.T) for a in loads])
    expected = VOLUME * np.einsum("iab,lbc,jac->lij", modes, s, modes)
    found = prestress_stiffness(mesh.points, mesh.cells, assign(mesh, STEEL), static, U)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=ROUND_OFF * np.abs(expected).max())
