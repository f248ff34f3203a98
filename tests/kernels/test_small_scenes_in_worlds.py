"""The small scenes together with others in the worlds of one graph: the bits that each has alone, whatever it needs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from small_scenes import CASES, STEPS, Case

from same_histories import unlike
from warpffrf.online import run
from warpffrf.online.history.history import History
from warpffrf.online.worlds import side_by_side

RUNS = (
    "chain, projected", "bead", "wheel", "plates", "rollers, asperities", "rollers, patch with friction",
    "rollers, patch of many cells with friction",
    "three rollers, friction", "ball, impulsive and exact", "roller in a ring, friction", "journal, both yield",
    "small sliding", "too deep", "too fast",
)  # fmt: skip


def run_of(case: Case, gravity: float, **more: Any) -> History:
    """The run of a case, in another gravity."""
    scene = case.build()
    scene.gravity = scene.gravity - np.array([0.0, 0.0, gravity])
    return run(scene, STEPS * case.step, step=case.step, progress=False, **case.options, **more)


@pytest.mark.slow
@pytest.mark.parametrize("name", RUNS)
def test_worlds_do_what_each_scene_does_alone(name: str) -> None:
    case, gravities = CASES[name], (0.0, 0.7, 3.0)
    alone = [run_of(case, gravity) for gravity in gravities]
    beside = side_by_side(
        [lambda engine_of, g=g: run_of(case, g, engine_of=engine_of) for g in gravities], STEPS, progress=False
    )
    assert [history.status for history in beside] == [history.status for history in alone]
    assert [unlike(a, b) for a, b in zip(alone, beside, strict=True)] == [[], [], []]
