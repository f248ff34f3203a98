"""The roller bearing, whole; its references against closed forms and a thick ring that is as good as a housing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind

from demos import roller_bearing as demo
from references.finite_elements.ring_on_feet import RingOnFeet


@pytest.mark.slow
def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    checks = left_behind(tmp_path / "out", "roller_bearing", "stiff")
    loads = [checks[f"on feet: {name}"]["computed"] for name in ("roller under the load", "the next one")]
    assert loads[0] < 0.75 * loads[1]  # in a stiff housing the first carries the most


def test_loads_in_a_stiff_housing_are_the_published_ones() -> None:
    loads = demo.rigid_loads()
    np.testing.assert_allclose(loads[:2], (1956.0, 1384.0), rtol=demo.PUBLISHED)
    assert np.count_nonzero(loads) == 3


def test_a_ring_without_compliance_is_a_stiff_housing() -> None:
    """Whose local approach is Palmgren's, once more."""
    phi = 2.0 * np.pi * np.arange(demo.COUNT) / demo.COUNT

    class Stiff(RingOnFeet):
        def local(self, Q: np.ndarray) -> np.ndarray:
            return demo.palmgren(Q)

    ring = Stiff(np.zeros((14, 14)), phi, 6e-3, 0.012, 5.8e-3, demo.CLEARANCE, demo.STEEL, demo.palmgren)
    shift, loads = ring.solve(demo.LOAD, 1e-4)
    np.testing.assert_allclose(loads, demo.rigid_loads(), atol=1e-6 * demo.LOAD)
    assert shift > 0.5 * demo.CLEARANCE


def test_the_compliance_is_symmetric_and_bends_the_ring_between_its_feet() -> None:
    """A coarse ring, one layer of one cell along the axis: bore and outside differ by what the wall gives."""
    C = demo.reference(demo.Size(sectors=28, axial=1, layers=1)).compliance
    assert np.abs(C - C.T).max() < 0.01 * np.abs(C).max()
    assert C[0, 0] == np.diag(C)[:2].max() and C[0, 1] > 0.0 > C[0, 4]
