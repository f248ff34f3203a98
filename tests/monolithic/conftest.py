"""Bodies of these tests."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from scenes.rollers import roller_body
from warpffrf.model.reduced.body import ReducedBody

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(scope="session")
def roller() -> ReducedBody:
    """96 shape functions around, four along, eight global modes."""
    return roller_body(96, layers=4, axial=3, grading=1.6, order=1, max_frequency=15e3, cache=False)


@pytest.fixture(scope="session")
def other_roller() -> ReducedBody:
    """Crowned, another radius and grid."""
    return roller_body(
        70, layers=3, axial=3, grading=1.8, order=1, outer_radius=0.04, crown_radius=0.6, max_frequency=15e3,
        cache=False,
    )  # fmt: skip
