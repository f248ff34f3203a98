"""Patches that run off a body, with friction: a tilted roller over its end, a ball over an edge and over a corner."""

from __future__ import annotations

import numpy as np
import pytest

from scenes.over_the_edge import DURATION, ball_over_slab, long_roller_body, roller_off_its_end, slab_body
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate

REACTION = 1e-10
BOUNDED = 2.5  # of the peak of the whole patch: half of the material is gone at an edge, three quarters at a corner
STEP = 2e-4  # s
GAIN = 1e-9


@pytest.fixture(scope="module")
def slab() -> ReducedBody:
    return slab_body()


def judged(result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Force (T,) and peak (T,); pressures, reaction and friction as they must be."""
    assert result.status == "completed", result.message
    c = result.history.contacts["pair"]
    F, peak = np.linalg.norm(c.force, axis=1), c.pressure.max(axis=(1, 2))
    assert c.pressure.min() >= 0.0
    assert np.isfinite(c.pressure).all()
    assert np.abs(c.force + c.force_second).max() < REACTION * F.max()
    work = result.energy["friction"]
    assert np.all(np.diff(work) <= GAIN * abs(work[-1]))
    print(
        f"largest peak over the first {peak.max() / peak[0]:.2f}, rejected {result.history.counters['rejected_steps']}"
    )
    return F, peak


@pytest.mark.parametrize("way", [(1.0, 0.0), (0.0, 1.0), (0.8, 0.8), (-1.0, 0.3)])
def test_a_ball_slides_over_edge_and_corner(slab: ReducedBody, way: tuple[float, float]) -> None:
    """A rigid ball, 40 um deep, leaves the slab over each kind of its edges, and over the corner."""
    result = simulate(ball_over_slab(slab, way), DURATION, step=STEP, start="equilibrium", progress=False)
    F, peak = judged(result)
    assert F[0] > 1e3 and F[-1] == 0.0
    assert peak.max() < BOUNDED * peak[0]


@pytest.mark.slow
def test_a_tilted_roller_runs_off_its_end() -> None:
    """Tilted by 0.5 mrad against a rigid barrel that it slides along until it has left it over its end, and turning."""
    result = simulate(roller_off_its_end(long_roller_body()), DURATION, step=STEP, start="equilibrium", progress=False)
    F, peak = judged(result)
    assert F[0] > 1e3 and F[-1] == 0.0
    assert peak.max() < BOUNDED * peak[0]
