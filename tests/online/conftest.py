"""Small bodies for tests of the engine."""

from __future__ import annotations

import pytest

from scenes.rollers import roller_body
from warpffrf.model.reduced.body import ReducedBody


@pytest.fixture(scope="session")
def plain_body() -> ReducedBody:
    """Linear cells, 120 around, four rows of nodes, a few global modes."""
    return roller_body(120, layers=4, axial=3, grading=1.6, order=1, max_frequency=15e3, cache=False)


@pytest.fixture(scope="session")
def other_body() -> ReducedBody:
    """Another radius, another number of cells around and along, another width: the grids never match."""
    return roller_body(
        84, layers=3, axial=2, grading=1.8, order=1, outer_radius=0.035, inner_radius=0.012, width=0.026,
        max_frequency=15e3, cache=False,
    )  # fmt: skip


@pytest.fixture(scope="session")
def crowned_body() -> ReducedBody:
    """A crowned rim: the patch is an ellipse that ends inside the width."""
    return roller_body(
        90,
        layers=3,
        axial=5,
        grading=1.8,
        order=1,
        outer_radius=0.04,
        crown_radius=0.6,
        max_frequency=15e3,
        cache=False,
    )
