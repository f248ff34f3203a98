"""An engine stopped inside a step, so that its work arrays can be rebuilt in NumPy."""

from __future__ import annotations

import numpy as np
import pytest

from scenes.rollers import Path, prescribed_pair, roller_body
from warpffrf.online import Engine, Settings
from warpffrf_kernels.core import control as k


@pytest.fixture(scope="session")
def engine() -> Engine:
    """Two unlike rollers, tilted by 4 mrad, pressed 1.5 mm into each other: a static step, and all contact kernels run
    once more on the accepted state with every slot fresh."""
    first = roller_body(120, layers=3, axial=3, grading=1.6, max_frequency=15e3, cache=False)
    second = roller_body(
        84, layers=3, axial=2, grading=1.8, outer_radius=0.035, inner_radius=0.012, width=0.026, max_frequency=15e3,
        cache=False,
    )  # fmt: skip
    scene = prescribed_pair(first, second, Path.of([1500e-6], 0.021, -0.013), tilt=4e-3)
    engine = Engine(scene, settings=Settings(window_strain=0.5))
    engine.control(mode=int(k.STATIC), step=0, sub=0, level=0, target=1)
    engine.clock(user_step=1.0)
    engine.replay(1)
    assert engine.word("status")[0] == 0
    engine.control(run=1, moved=1, reassemble=1, refresh=1, recenter=0, iteration=0, failure=0)
    engine.graph.iterate()
    assert engine.word("failure")[0] == 0 and engine.word("active")[0] > 10
    assert np.count_nonzero(engine.compiled.model.pairs.coupled_count.numpy()) == 1
    return engine
