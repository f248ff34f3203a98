"""Hats on an arc: their whole static flexibility, global modes and local ones, is that of the same nodes of the
turn."""

from __future__ import annotations

import numpy as np
import pytest
from offline_bodies import reduced

from warpffrf.model.mesh import Mesh, roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.surfaces import Cylinder
from warpffrf.online.compile.compliance_tables import modal_moments, node_gram, product

ROUND_OFF = 1e-9  # of the largest entry: two paths, or two sets of modes, that are exact both
COARSE = {"spacing": 0.019}  # a column every second of the 24 sectors


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    made = roller(0.05, 0.015, 0.02, sectors=24, layers=2, axial=2, order=1)
    return made.select("pad", "rim", lambda c: (c[:, 0] > 0.0) & (np.abs(c[:, 2]) < 0.04))


def blocks(lags: np.ndarray, columns: np.ndarray, per_sector: int) -> np.ndarray:
    """Entries (columns rows, columns rows) of a block-circulant operator between `columns` of its turn."""
    c, rows = per_sector, lags.shape[1] // per_sector
    sector, part = columns // c, columns % c
    parts = lags.reshape(len(lags), c, rows, c, rows)
    lag = (sector[:, None] - sector[None, :]) % len(lags)
    return parts[lag, part[:, None], :, part[None, :], :].transpose(0, 2, 1, 3).reshape(len(columns) * rows, -1)


def flexibility(body: ReducedBody, name: str, columns: np.ndarray) -> np.ndarray:
    """Weak displacement [m^3] of node i under a unit pressure hat j, of global and local modes."""
    surface = body.contact_surfaces[name]
    moments = modal_moments(surface)[columns].reshape(len(columns) * surface.grid.rows, -1)
    omega = 2.0 * np.pi * body.frequencies
    M = node_gram(surface)
    local = product(M, surface.lags, M)
    return (moments / omega**2) @ moments.T + blocks(local, columns, surface.grid.columns_per_sector)


@pytest.mark.parametrize("modes", [0, 6])
@pytest.mark.parametrize("grid", [{}, COARSE], ids=["a column a sector", "coarser"])
def test_an_arc_is_as_soft_as_the_same_nodes_of_the_turn(mesh, modes, grid) -> None:
    whole = reduced(mesh, modes=modes, **grid)
    arc = reduced(mesh, modes=modes, contact={"pad": Cylinder()}, **grid)
    assert arc.report["path"] == whole.report["path"] == "cyclic"
    a, b = arc.contact_surfaces["pad"].grid, whole.contact_surfaces["rim"].grid
    assert not a.periodic and b.periodic and a.columns >= 3
    first = int(np.rint((a.theta_start - b.theta_start) % (2.0 * np.pi) / b.pitch))
    among = (first + np.arange(a.columns)) % b.columns
    expected = flexibility(whole, "rim", among)
    found = flexibility(arc, "pad", np.arange(a.columns))
    assert np.abs(found - expected).max() < ROUND_OFF * np.abs(expected).max()


def test_an_arc_is_as_soft_on_both_paths(mesh) -> None:
    cyclic, general = (
        reduced(mesh, modes=6, contact={"pad": Cylinder()}, general=general) for general in (False, True)
    )
    a, b = cyclic.contact_surfaces["pad"].grid, general.contact_surfaces["pad"].grid
    assert a.columns == b.columns
    np.testing.assert_allclose(a.theta, b.theta, atol=1e-9)
    columns = np.arange(a.columns)
    expected = flexibility(general, "pad", columns)
    found = flexibility(cyclic, "pad", columns)
    assert np.abs(found - expected).max() < ROUND_OFF * np.abs(expected).max()
