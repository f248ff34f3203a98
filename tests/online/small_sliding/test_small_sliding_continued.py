"""Runs with small-sliding contacts that go on from a checkpoint: their tableaus are made anew, the numbers agree to the
solve."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_sliding_scenes import two_blocks

from warpffrf.model import signals
from warpffrf.model.messages.checkpoints import Source, Unfinished
from warpffrf.model.scene import Scene
from warpffrf.online import run
from warpffrf.online.engine import Engine
from warpffrf.online.history.history import History
from warpffrf.online.load_steps import run_static
from warpffrf.output.result import Result
from warpffrf.output.simulate import simulate, static
from warpffrf_kernels.matched.status_words import ANEW, READY, STANDS

AGREES = 1e-8  # of the largest: steps balance to 1e-9, and what they leave adds up
CYCLE, STEPS = 1e-3, 40  # s, load steps or steps of a cycle that slides


def rubbing() -> Scene:
    t = np.linspace(0.0, 1.0, 41)
    return two_blocks(pull=signals.Table(CYCLE * np.append(t, 1e3), np.append(595.0 * np.sin(2.0 * np.pi * t), 0.0)))


def numbers(history: History) -> dict[str, np.ndarray]:
    lap, top = history.small_sliding["lap"], history.bodies["top"]
    found = {name: getattr(lap, name) for name in ("pressure", "traction", "slip", "gap", "loss")}
    return found | {"position": top.position - (0.0, 0.0, 0.03), "modal": top.modal}


def assert_same_rows(whole: History, rest: History) -> None:
    """The rows of `rest` are the last of `whole`, to the solve."""
    count = len(rest.time)
    np.testing.assert_allclose(rest.time, whole.time[-count:], rtol=1e-12)
    for name, values in numbers(whole).items():
        np.testing.assert_allclose(
            numbers(rest)[name], values[-count:], rtol=0.0, atol=AGREES * np.abs(values).max(), err_msg=name
        )
    assert np.mean(rest.small_sliding["lap"].state == whole.small_sliding["lap"].state[-count:]) > 0.99
    assert np.sum(whole.small_sliding["lap"].state == 2) > 20 and whole.small_sliding["lap"].loss[-1].sum() > 0.0


@pytest.mark.parametrize("kind", ["dynamic", "static"])
def test_a_run_goes_on_from_its_file(kind: str, tmp_path: Path) -> None:
    call = static if kind == "static" else simulate
    options: dict[str, Any] = {"step": CYCLE / STEPS, "progress": False}
    scene, half = rubbing(), 0.5 * CYCLE
    whole = call(scene, CYCLE, start="equilibrium", **options)
    file = tmp_path / "first.h5"
    call(scene, half, start="equilibrium", results=file, **options)
    rest = call(scene, half, start=Result.load(file), **options)
    assert_same_rows(whole.history, rest.history)


class _Keeps:
    """Takes what a run gives out at its first look."""

    def __init__(self) -> None:
        self.found: list[Unfinished] = []

    def begin(self, source: Source) -> None:
        pass

    def clear(self) -> None:
        pass

    def due(self) -> bool:
        return not self.found

    def keep(self, unfinished: Unfinished) -> None:
        self.found.append(unfinished)


@pytest.mark.parametrize("go", [run, run_static])
def test_an_unfinished_run_goes_on(go: Callable[..., History]) -> None:
    keeps, options = _Keeps(), {"step": CYCLE / STEPS, "start": "equilibrium", "progress": False}
    whole = go(rubbing(), CYCLE, keeper=keeps, **options)
    assert 1 <= len(keeps.found[0].rows[-1]["saved_time"]) < STEPS
    rest = go(rubbing(), CYCLE, **options | {"start": keeps.found[0]})
    assert len(rest.time) == len(whole.time)
    assert_same_rows(whole, rest)


def test_numbers_of_laps_are_made_anew() -> None:
    """They belong to what an engine has evaluated last; of a tableau, a state that is put back leaves the table."""
    engine = Engine(rubbing())
    engine.evaluate_here()
    assert np.all(engine.scratch.matched_words.numpy()[..., int(READY)] == int(STANDS))
    engine.resume(engine.checkpoint())
    assert np.all(engine.scratch.matched_words.numpy()[..., int(READY)] == int(ANEW))
