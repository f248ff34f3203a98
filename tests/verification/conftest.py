"""Bodies shared by the tests of physics."""

from __future__ import annotations

import pytest

from scenes.rollers import roller_body
from warpffrf.model.reduced.body import ReducedBody


@pytest.fixture(scope="session")
def fine_body() -> ReducedBody:
    """Curved quadratic cells, 720 around, five rows of nodes: 4 elements in a half-width of 1.7 mm. Three seconds."""
    return roller_body(720, layers=8, axial=2, grading=1.5, order=2, modes=0, cache=False)


@pytest.fixture(scope="session")
def small_body() -> ReducedBody:
    """Curved quadratic cells, 180 around, five rows of nodes, ten global modes: for dynamics."""
    return roller_body(180, layers=5, axial=2, grading=1.6, order=2, cache=False)
