"""Solid rollers in `reduce`: patch test across the transitions, a torsion wave, and the path that is taken."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.model.mesh import roller
from warpffrf.offline import reduce
from warpffrf.offline.fe import assemble, assign


@pytest.mark.parametrize("order", [1, 2])
def test_patch_of_transitions_and_core_is_exact(order, steel):
    """Under a linear field no force acts on a node inside: every cell meets its neighbours on whole faces.

    Curved cells are isoparametric, so that linear fields are theirs too; what is left is round-off of the sums, and of
    the quadrature of curved cells, whose integrand is rational.
    """
    mesh = roller(0.05, 0, 0.02, sectors=28, layers=4, axial=2, order=order)
    K, _ = assemble(mesh.points, mesh.cells, assign(mesh, steel))
    G = np.array([[1.0, 0.3, -0.2], [0.5, -0.7, 0.1], [0.2, 0.4, 0.6]])
    force = (K @ (mesh.points @ G.T).ravel()).reshape(-1, 3)
    inside = np.setdiff1d(np.arange(len(mesh.points)), mesh.outer_facets().node_set)
    largest = np.abs(force).max()
    assert np.abs(force[inside]).max() < (1e-11 if order == 1 else 1e-6) * largest


def test_torsion_of_a_shaft(steel):
    """A free round shaft of length L twists at sqrt(G/rho)/(2 L), exactly; quadratic cells a sixteenth of the wave long
    are right to 1e-4, with the polygon's round-off of the circle in addition."""
    length = 0.4
    mesh = roller(0.02, 0, length, sectors=16, layers=1, axial=8)
    body = reduce(mesh, steel, interfaces={}, contact={}, max_frequency=5e3, progress=False)
    G = steel.youngs_modulus / (2.0 * (1.0 + steel.poisson_ratio))
    expected = np.sqrt(G / steel.density) / (2.0 * length)
    assert np.abs(body.frequencies / expected - 1.0).min() < 1e-4


@pytest.mark.parametrize("kind", ["rigid", "average"])
def test_held_on_its_end_faces(kind, steel):
    """The general path, and it says why; a rigid journal leaves the rim free, an average one may be the whole face."""
    part = "journal" if kind == "rigid" else "end"
    held = {f"{part}_low": kind, f"{part}_high": kind}
    mesh = roller(0.05, 0, 0.02, sectors=16, layers=2, axial=2, order=1)
    body = reduce(mesh, steel, interfaces=held, contact={"rim": None}, modes=2, progress=False)
    assert body.report["path"] == "general"
    assert "on the axis" in body.report["path_reason"] or kind == "average"
    for name, y in zip(held, (-0.01, 0.01), strict=True):
        np.testing.assert_allclose(body.interfaces[name].point, [0.0, y, 0.0], atol=1e-12)
    assert body.contact_surfaces["rim"].shape.kind == "cylinder"
