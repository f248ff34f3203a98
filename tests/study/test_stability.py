"""The suite of hard cases: how runs are judged, and that the quick ones are right."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from warpffrf.model.errors import InputError
from warpffrf.study.stability.case import Case
from warpffrf.study.stability.cases import CASES
from warpffrf.study.stability.cases.redundant_loop import CASE as LOOP
from warpffrf.study.stability.classes import CLASSES, Judged, judge, missed
from warpffrf.study.stability.suite import page, picture, stability

QUICK = ["stiffness ratio 1e6", "mass ratio 1e6", "friction 0 to 10", "redundant loop", "mm-N-t beside SI"]


def with_error(size: float) -> Case:
    """A case that says to be wrong by `size`."""
    return replace(LOOP, error=lambda _scene, _result: size, good=0.01, usable=0.1)


@pytest.mark.parametrize(("size", "verdict"), [(1e-3, "pass"), (0.05, "degraded"), (0.5, "silent"), (np.nan, "silent")])
def test_a_run_is_judged_by_its_error(size: float, verdict: str) -> None:
    assert judge(with_error(size), 1e-2).verdict == verdict


def test_a_run_that_fails_or_is_refused_says_so() -> None:
    def impossible():
        scene = LOOP.build()
        scene.bodies[0].velocity = np.array([0.0, 0.0, 5.0])  # against its pivots
        return scene

    judged = judge(replace(LOOP, build=impossible), 1e-2)
    assert judged.verdict == "refused" and "velocit" in judged.said


def test_joints_that_part_are_seen() -> None:
    import warpffrf as wf

    scene = LOOP.build()
    result = wf.simulate(scene, 0.05, step=1e-3, progress=False)
    assert missed(scene, result) < 1e-9  # of positions held by the iteration
    result.body("coupler").position[-1] += (0.0, 0.0, 0.01)
    assert missed(scene, result) > 0.01


@pytest.mark.parametrize("name", QUICK)
def test_quick_cases_pass_at_some_step(name: str) -> None:
    assert "pass" in [judge(CASES[name], step).verdict for step in CASES[name].steps()[-2:]]


def test_steps_go_into_the_duration_and_are_not_too_many() -> None:
    for case in CASES.values():
        assert case.steps() and all(1 <= round(case.duration / h) <= case.most for h in case.steps()), case.name


def test_an_unknown_case_is_refused() -> None:
    with pytest.raises(InputError, match="redundant loop"):
        stability(["redundant lop"], progress=False)


def test_page_and_picture_show_every_class(tmp_path: Path) -> None:
    found = [
        Judged(LOOP.name, step, verdict, 0.5, "why")
        for step, verdict in zip((1e-5, 1e-4, 1e-3, 1e-2, 1e-6), CLASSES, strict=True)
    ]
    text = page(found)
    assert all(f"1 {verdict}" in text for verdict in CLASSES) and "redundant loop, 0.01 s: why" in text
    picture(found, tmp_path / "map.png")
    assert (tmp_path / "map.png").stat().st_size > 0
