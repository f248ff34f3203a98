"""The snapping arch, whole; equilibria by load on both sides of the limit; limits and works of a path."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind

import warpffrf as wf
from demos import snapping_arch as demo


def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    checks = left_behind(tmp_path / "out", "snapping_arch", "driven")
    assert len(checks) == 12
    assert checks["by load: snaps through at"]["computed"] > checks["by displacement: limit load"]["computed"]


def test_limits_and_work_of_a_path_that_is_a_cubic() -> None:
    """F = w^3/3 - 3 w^2/2 + 2 w: limits at 1 and 2, loads 5/6 and 2/3; it comes to these again at 5/2 and 1/2, and as
    each jump is by 3/2 from a double root, both leave int (3/2 - s) s^2/3 ds = 9/64."""
    w = np.linspace(0.0, 3.0, 31)
    path = demo.EquilibriumPath(w, w**3 / 3.0 - 1.5 * w**2 + 2.0 * w)
    assert path.limits == pytest.approx((1.0, 2.0), abs=1e-9)
    assert path.loads == pytest.approx((5.0 / 6.0, 2.0 / 3.0), abs=1e-9)
    assert path.rising(5.0 / 6.0, behind=True) == pytest.approx(2.5, abs=1e-9)
    assert path.rising(2.0 / 3.0, behind=False) == pytest.approx(0.5, abs=1e-9)
    assert path.work_of_a_cycle == pytest.approx(2.0 * 9.0 / 64.0, abs=1e-9)


@pytest.fixture(scope="module")
def exact() -> demo.EquilibriumPath:
    return demo.full_model(demo.QUICK).path


@pytest.mark.parametrize("share", [0.9, 0.97, 1.03])
def test_equilibrium_finds_the_arch_before_its_limit_and_snapped(exact: demo.EquilibriumPath, share: float) -> None:
    """0.4 % where the tangent is a third of that of the arch at rest, as in the snapped state."""
    force = share * exact.loads[0]
    rest = demo.clamped(demo.QUICK, progress=False)
    height = rest.body("arch")["crown"].point[2]
    rest.add(wf.forces.PointForce(rest.body("arch")["crown"], (0.0, 0.0, -force)))
    found = wf.equilibrium(rest)
    assert found.status == "completed", found.message
    w = height - found.sensor("crown").values[-1, 2]
    assert w == pytest.approx(exact.rising(force, behind=share > 1.0), rel=demo.LANDS)
