"""The same mesh in CalculiX: its matrices, written by version 2.20, and the frequencies that follow from them.

`tests/data/calculix/arc_*.inp` are two curved, crooked cells of an arc; the matrices next to them come from
`*FREQUENCY, SOLVER=MATRIXSTORAGE`. CalculiX integrates C3D8 by 2 x 2 x 2 and C3D20 by 3 x 3 x 3 points.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import scipy.linalg as sla

from warpffrf.model.mesh import from_matrices, read
from warpffrf.offline import reduce
from warpffrf.offline.fe import assign, fe_matrices

FOLDER = Path(__file__).parents[1] / "data" / "calculix"
PROMISED = 1e-6  # relative, of the frequencies
WRITTEN_DIGITS = 1e-12  # CalculiX writes 14 digits


@pytest.mark.parametrize("kind", ["hex8", "hex20"])
def test_matrices_and_frequencies_are_those_of_calculix(kind: str) -> None:
    mesh = read(FOLDER / f"arc_{kind}.inp", length_unit="m")
    assert list(mesh.cells) == [kind] and list(mesh.materials)
    stem = FOLDER / f"arc_{kind}"
    theirs = from_matrices(stem.with_suffix(".mas"), stem.with_suffix(".sti"), mesh.points)
    assert theirs.matrices is not None
    K, M = fe_matrices(mesh, assign(mesh, mesh.materials))
    for mine, other in ((K, theirs.matrices.stiffness), (M, theirs.matrices.mass)):
        assert abs(mine - other).max() < WRITTEN_DIGITS * abs(other).max()
    values = sla.eigvalsh(theirs.matrices.stiffness.toarray(), theirs.matrices.mass.toarray())[6:16]
    body = reduce(mesh, mesh.materials, modes=10, cache=False, progress=False)
    assert body.frequencies == pytest.approx(np.sqrt(values) / (2.0 * np.pi), rel=PROMISED)
