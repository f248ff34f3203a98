"""Small bodies that the tests of the reduction share."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from warpffrf.model.material import Material
from warpffrf.model.mesh import roller
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline import reduce

STEEL = Material(210e9, 0.3, 7850.0)


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


def reduced(mesh, *, general: bool = False, **settings):
    """`reduce` with a rigid bore and a contact rim, without cache; `general` hides the periodicity."""
    given = {"interfaces": {"bore": "rigid"}, "contact": {"rim": Cylinder()}, "cache": False, "progress": False}
    return reduce(replace(mesh, cyclic=None) if general else mesh, STEEL, **{**given, **settings})


def skin_order(body) -> np.ndarray:
    """Permutation that sorts skin points by place, to compare bodies that number them differently."""
    return np.lexsort(np.round(body.surface.points, 9).T)
