"""The general and the cyclic path compute the same body: 1e-9 of the largest entry on small rollers."""

from __future__ import annotations

import numpy as np
import pytest
from offline_bodies import reduced, skin_order

from warpffrf.model.mesh import Mesh, roller
from warpffrf.model.surfaces import CrownedCylinder

AGREE = 1e-9
SINGLE = 2e-6  # the display transfer is stored in single precision


def relative(a, b) -> float:
    return float(np.abs(a - b).max() / np.abs(b).max())


def assert_same(cyclic, general):
    assert (cyclic.report["path"], general.report["path"]) == ("cyclic", "general")
    assert relative(cyclic.frequencies, general.frequencies) < AGREE
    assert relative(cyclic.inertia, general.inertia) < AGREE
    a, b = cyclic.contact_surfaces["rim"], general.contact_surfaces["rim"]
    assert np.allclose(a.grid.theta, b.grid.theta) and np.allclose(a.grid.z, b.grid.z)
    columns = np.arange(a.grid.columns)
    assert relative(a.compliance(columns), b.compliance(columns)) < AGREE
    # modes are compared through products that a rotation within equal frequencies leaves alone
    assert relative(a.mode_normal @ a.mode_normal.T, b.mode_normal @ b.mode_normal.T) < AGREE
    p, q = cyclic.interfaces["bore"].modes, general.interfaces["bore"].modes
    assert relative(p.T @ p, q.T @ q) < AGREE
    assert relative(a.mode_normal @ p, b.mode_normal @ q) < AGREE
    i, j = skin_order(cyclic), skin_order(general)
    assert np.allclose(cyclic.surface.points[i], general.surface.points[j])
    forces = np.random.default_rng(1).standard_normal((a.grid.columns, a.grid.rows))
    assert relative(a.recover(forces)[i], b.recover(forces)[j]) < SINGLE
    u, v = (np.einsum("mnd,mk->nkd", s.surface.modes, m) for s, m in ((cyclic, p), (general, q)))
    assert relative(u[i], v[j]) < SINGLE


@pytest.mark.parametrize("modes", [0, 5, 60])
def test_linear_roller(small_roller, modes):
    assert_same(reduced(small_roller, modes=modes), reduced(small_roller, modes=modes, general=True))


def test_curved_roller(curved_roller):
    assert_same(reduced(curved_roller, modes=8), reduced(curved_roller, modes=8, general=True))


def test_crowned_roller():
    mesh = roller(0.05, 0.015, 0.02, crown_radius=0.8, sectors=12, layers=2, axial=4, order=1)
    settings = {"max_frequency": 20e3, "contact": {"rim": CrownedCylinder()}}
    assert_same(reduced(mesh, **settings), reduced(mesh, general=True, **settings))


def test_body_without_interface(small_roller):
    free = {"interfaces": {}, "modes": 6}
    cyclic, general = reduced(small_roller, **free), reduced(small_roller, general=True, **free)
    assert relative(cyclic.frequencies, general.frequencies) < AGREE
    a, b = cyclic.contact_surfaces["rim"], general.contact_surfaces["rim"]
    columns = np.arange(a.grid.columns)
    assert relative(a.compliance(columns), b.compliance(columns)) < AGREE


def test_two_interfaces(small_roller):
    """Both ends as one set would touch the bore; two disjoint parts of the wall serve instead."""
    mesh = small_roller.select("left", "ends", lambda c: (c[:, 1] < 0.0) & (np.hypot(c[:, 0], c[:, 2]) > 0.034))
    settings = {"interfaces": {"bore": "rigid", "left": "rigid"}, "modes": 4, "contact": {}}
    cyclic, general = reduced(mesh, **settings), reduced(mesh, general=True, **settings)
    assert cyclic.report["path"] == "cyclic"
    assert relative(cyclic.frequencies, general.frequencies) < AGREE
    for name in ("bore", "left"):
        p, q = cyclic.interfaces[name].modes, general.interfaces[name].modes
        assert relative(p.T @ p, q.T @ q) < AGREE
    assert cyclic.interfaces["left"].point[1] == pytest.approx(-0.01)


def test_compliance_is_symmetric_and_definite(small_roller):
    body = reduced(small_roller, modes=10)
    s = body.contact_surfaces["rim"]
    D = s.compliance(np.arange(s.grid.columns))
    assert np.abs(D - D.T).max() < 1e-13 * np.abs(D).max()
    assert np.linalg.eigvalsh(D)[0] > 0.0


def test_the_path_is_reported_with_its_reason(small_roller):
    assert "repeat" in reduced(small_roller).report["path_reason"]
    points = small_roller.points.copy()
    points[100, 1] += 1e-9  # a nanometre breaks the periodicity
    moved = type(small_roller)(points, small_roller.cells, small_roller.facet_sets, small_roller.cyclic)
    body = reduced(moved)
    assert body.report["path"] == "general" and "rotated sectors differ" in body.report["path_reason"]
    assert body.contact_surfaces["rim"].lags.shape[0] == 1


def test_periodicity_of_a_read_mesh_is_found() -> None:
    """A mesh that does not say that it is periodic, numbered at random: the cyclic path, and the same body."""
    known = roller(0.05, 0.015, 0.02, sectors=14, layers=2, axial=2, order=1)
    order = np.random.default_rng(5).permutation(len(known.points))
    number = np.argsort(order)
    mesh = Mesh(
        known.points[order],
        {kind: number[nodes] for kind, nodes in known.cells.items()},
        {name: facets.renumbered(number) for name, facets in known.facet_sets.items()},
    )
    found, general, stated = reduced(mesh, modes=6), reduced(mesh, general=True, modes=6), reduced(known, modes=6)
    assert found.report["path"] == "cyclic" and general.report["path"] == "general"
    assert any("found to be periodic: 14 sectors" in note for note in found.report["notes"])
    for other in (general, stated):
        assert found.frequencies == pytest.approx(other.frequencies, rel=1e-9)  # eigenvalues of one matrix
    D, D_stated = (b.contact_surfaces["rim"].compliance(np.arange(14)) for b in (found, stated))
    assert np.linalg.eigvalsh(D) == pytest.approx(np.linalg.eigvalsh(D_stated), rel=1e-8, abs=1e-12 * D.max())
