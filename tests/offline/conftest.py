"""Small bodies that the tests of the reduction share."""

from __future__ import annotations

import pytest
from offline_bodies import STEEL

from warpffrf.model.material import Material
from warpffrf.model.mesh import roller


@pytest.fixture(scope="session")
def steel() -> Material:
    return STEEL


@pytest.fixture(scope="session")
def small_roller():
    """Linear hexahedra, 18 sectors: an even number, so that harmonic N/2 exists."""
    return roller(0.05, 0.015, 0.02, sectors=18, layers=2, axial=2, order=1)


@pytest.fixture(scope="session")
def curved_roller():
    """Quadratic hexahedra, 9 sectors: odd, two planes a sector."""
    return roller(0.05, 0.015, 0.02, sectors=9, layers=1, axial=1, order=2)
