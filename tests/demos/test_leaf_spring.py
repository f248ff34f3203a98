"""The leaf spring, whole; what is said of its clamp, and that other friction is told from it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from demo_files import left_behind

from demos import leaf_spring as demo

BONDED = 0.02  # softer than beams with leaves that are bonded in the clamp: 1.7 % was seen
SHARE = 0.29  # of the loss of the tips: what the clamp adds
SAME = 0.02  # of that share


def bent(size: demo.Size) -> demo.Bent:
    return demo.Bent(demo.run(demo.build(size, progress=False), size, progress=False), size)


@pytest.fixture(scope="module")
def quick() -> demo.Bent:
    return bent(demo.QUICK)


def test_the_whole_demo_passes_and_writes_its_files(tmp_path: Path) -> None:
    assert demo.main(tmp_path / "out", quick=True, progress=False) == 0
    checks = left_behind(tmp_path / "out", "leaf_spring", "coarse")
    assert len(checks) == 14
    grows, falls, stuck = (
        checks[f"stiffness, {what}"]["computed"] for what in ("load grows", "load falls", "all stuck")
    )
    assert falls < grows < 0.25 * stuck


def test_leaves_open_between_clamp_and_tips(quick: demo.Bent) -> None:
    for name in demo.JOINTS:
        lap = quick.result.lap(name)
        x = np.abs(lap.points[:, 0])
        tips = x > x.max() - 0.5 * demo.QUICK.cell
        loaded = lap.state[1:] != 0
        assert loaded[:, tips].all()
        assert not loaded[:, (x > demo.CLAMP + 2.5 * demo.THICK) & ~tips].any()
        assert lap.gap.max() > 1e-5


def test_both_sides_of_the_spring_are_alike(quick: demo.Bent) -> None:
    """To what the residual of an equilibrium leaves, 1e-9 of the loads."""
    low, high = (quick.result.sensor(end).values[:, 2] for end in demo.ENDS)
    assert np.abs(low - high).max() < 1e-8 * quick.deflection.max()


@pytest.mark.slow
def test_the_clamp_is_what_makes_it_softer_than_beams(monkeypatch: pytest.MonkeyPatch) -> None:
    size = demo.Size(steps=4)
    clamped = bent(size)
    tips, rim = np.sum([clamped.loss(name) for name in demo.JOINTS], axis=0)
    assert rim / tips == pytest.approx(SHARE, abs=SAME)
    monkeypatch.setattr(demo, "DOWEL", demo.CLAMP)
    bonded = bent(size)
    for row, sense in ((size.steps, 1.0), (2 * size.steps, -1.0)):
        softer = [1.0 - run.slope(row) / demo.BEAMS.stiffness(sense) for run in (bonded, clamped)]
        print(f"{sense:+g}: softer by {softer[0]:.2%} bonded, {softer[1]:.2%} clamped")
        assert 0.0 < softer[0] < BONDED < 0.5 * softer[1]


def test_other_friction_is_told_from_it(quick: demo.Bent, monkeypatch: pytest.MonkeyPatch) -> None:
    assert all(check.passed for check in demo.checks(quick))
    monkeypatch.setattr(demo, "FRICTION", 0.303)
    found = demo.reference_checks(quick, demo.followed(demo.QUICK))
    assert not any(check.passed for check in found)
    monkeypatch.setattr(demo, "BEAMS", replace(demo.BEAMS, friction=0.35))
    failed = [check.name for check in demo.checks(quick) if not check.passed]
    assert sum("loss per cycle" in name for name in failed) == 3
