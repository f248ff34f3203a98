"""Runs to a wanted accuracy: what they choose, that they keep it, and what they refuse."""

from __future__ import annotations

import re
from functools import lru_cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from scenes.rollers import PAIR, guided_pair, roller_body
from studies.accuracy.budget_check import driven_mass, pendulum
from studies.hard_cases.suite import CASES
from warpffrf.model import joints, signals
from warpffrf.model.errors import InputError
from warpffrf.online.history.history import BudgetLine
from warpffrf.online.settings import Settings
from warpffrf.output.accuracy.choose import A_RISE, FEWEST, Stuck, first_setting
from warpffrf.output.accuracy.demands import (
    FINER,
    LEAST_TOLERANCE,
    MOST,
    TIGHTER,
    energy_tolerance_wanted,
    steps_wanted,
)
from warpffrf.output.accuracy.limits import Limits
from warpffrf.output.budget import time_step
from warpffrf.output.budget.contacts import OF, SOURCE, energy_lines
from warpffrf.output.budget.quantities import quantities
from warpffrf.output.simulate import simulate

REFERENCE = 8  # times the steps of the run: its own error is 1/64 of the run's


def off(result: wf.Result, scene: Any, duration: float, **options: Any) -> dict[str, float]:
    """Root mean square errors of a run compared with one of the same scene with an eighth of the step."""
    steps = len(result.time) - 1
    fine = simulate(
        scene,
        duration,
        step=duration / steps / REFERENCE,
        options=wf.RunOptions(save_every=REFERENCE),
        progress=False,
        **options,
    )
    own, other = quantities(result.history), quantities(fine.history)
    return {
        name: float(np.sqrt(np.mean(quantity.apart(other[name].values) ** 2))) / quantity.size
        for name, quantity in own.items()
    }


@lru_cache
def roller(contact_fixed: bool) -> wf.ReducedBody:
    """A coarse roller, with cells or without."""
    return roller_body(
        120 if contact_fixed else 180, layers=4, axial=2, grading=1.6, order=1, modes=4, contact_fixed=contact_fixed
    )


def pressed(contact_fixed: bool = False, **options: Any) -> wf.Scene:
    """A pair of rollers pressed by 20 kN."""
    scene = guided_pair(roller(contact_fixed), roller(contact_fixed), load=20e3, speed=0.0, ramp=0.02)
    for name, value in options.items():
        setattr(scene.contact(PAIR), name, value)
    return scene


@pytest.mark.parametrize("accuracy", [0.02, 1e-3])
@pytest.mark.parametrize(("build", "duration"), [(pendulum, 2.0), (driven_mass, 4.0)])
def test_the_wanted_accuracy_is_kept(build: Any, duration: float, accuracy: float) -> None:
    """Compared with a run with an eighth of the step; and not by brute force: a quarter of the steps would not do."""
    result = simulate(build(), duration, accuracy=accuracy, progress=False)
    assert result.status == "completed"
    errors = off(result, build(), duration)
    assert max(errors.values()) < accuracy
    if len(result.time) - 1 > FEWEST + 1:
        assert 16.0 * max(errors.values()) > accuracy  # second order: with a quarter of the steps


def test_the_scene_is_left_alone_and_choices_are_reported() -> None:
    scene = pressed()
    before = scene.content_hash()
    result = simulate(scene, 0.02, accuracy=0.05, start="equilibrium", progress=False)
    assert scene.content_hash() == before
    notes = [note for note in result.history.notes if note.startswith("accuracy 0.05")]
    step = result.time[1] - result.time[0]
    assert f"step={step:.6g} was chosen" in notes[0]
    assert any("inertia=" in note and "'lower'" in note for note in notes)
    assert result.scene.body("lower").level in ("constant", "deformed", "gyroscopic", "full")
    assert result.history.counters["accuracy_runs"] >= 1


def test_the_same_call_chooses_the_same() -> None:
    found = [simulate(driven_mass(), 1.0, accuracy=0.01, progress=False) for _ in range(2)]
    assert np.array_equal(found[0].time, found[1].time)
    assert np.array_equal(found[0].body("bob").position, found[1].body("bob").position)
    assert found[0].history.notes == found[1].history.notes


def test_what_the_user_has_set_is_kept() -> None:
    scene = pressed()
    scene.body("lower").level = "full"
    result = simulate(scene, 0.01, accuracy=0.1, start="equilibrium", progress=False)
    assert result.scene.body("lower").level == "full"
    assert result.scene.body("upper").level == "constant"  # nothing turns


def test_a_given_step_is_the_longest() -> None:
    result = simulate(driven_mass(), 1.0, step=1e-3, accuracy=0.1, progress=False)
    assert np.diff(result.time).max() < 1e-3 * (1.0 + 1e-9)


def test_a_run_that_goes_on_has_the_options_of_the_one_before() -> None:
    first = simulate(pressed(), 0.01, accuracy=0.05, start="equilibrium", progress=False)
    second = simulate(first.scene, 0.01, accuracy=0.05, start=first, progress=False)
    assert second.status == "completed"
    assert second.scene.content_hash() == first.scene.content_hash()
    assert second.time[-1] == pytest.approx(0.02)


def test_results_are_written(tmp_path: Path) -> None:
    path = tmp_path / "run.h5"
    result = simulate(driven_mass(), 0.5, accuracy=0.05, results=path, progress=False)
    stored = wf.Result.load(path)
    assert np.array_equal(stored.time, result.time)
    assert stored.history.notes == result.history.notes
    assert [p.name for p in tmp_path.iterdir()] == ["run.h5"]
    with pytest.raises(InputError, match="read from a file"):
        _ = stored.scene


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"accuracy": 0.5}, "for one per cent give 0.01"),
        ({"accuracy": 1e-9}, "from 1e-05"),
        ({"accuracy": 0.01, "options": wf.RunOptions(step_error=1e-4)}, "one of the two"),
        ({"accuracy": 0.01, "options": wf.RunOptions(integrator=wf.integrators.RungeKutta4())}, "error budgets"),
        ({"accuracy": 0.01, "resume": True, "results": "x.h5"}, "not kept on the way"),
        ({"accuracy": 0.01, "step": -1.0}, "step"),
    ],
)
def test_what_does_not_go_together_is_refused(options: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        simulate(pendulum(), 0.1, progress=False, **options)
    with pytest.raises(InputError, match="accuracy= is that of one run"):
        simulate(pendulum(), [wf.Stage("a", 0.1, 0.01)], accuracy=0.01, progress=False)


def line(size: float) -> list[BudgetLine]:
    """A budget of one line."""
    return [BudgetLine(time_step.SOURCE, "motion", size, "found")]


def test_steps_follow_second_order() -> None:
    limits = Limits.of(0.01)
    assert steps_wanted(100, line(limits.force), limits)[0] == 100
    assert steps_wanted(100, line(4.0 * limits.force), limits)[0] == pytest.approx(200 * FINER, abs=2)
    assert steps_wanted(100, line(1e6), limits)[0] == 100 * MOST
    assert steps_wanted(100, line(np.nan), limits)[0] == 200


def only_energy(**counters: int) -> Any:
    """History of a run without contacts, joints and forces."""
    scene = SimpleNamespace(lumped_contacts=[])
    parts = ("bodies", "contacts", "films", "joints", "forces", "lumped_contacts")
    return SimpleNamespace(scene=scene, counters=counters, **{part: {} for part in parts})


def test_energy_from_nowhere_asks_for_more_steps() -> None:
    """Lines of the ledger that fall and rise again: what counts is the rise."""
    ledger = {"numerical": np.array([0.0, 0.1, -0.2, 0.05]), "contact_grid": np.array([0.0, 0.0, 0.0, 0.01])}
    history = only_energy(rejected_steps=3)

    def lines_of(scale: float) -> list[BudgetLine]:
        return energy_lines(SimpleNamespace(energy=ledger, energy_scale=scale, history=history))

    (found,) = lines_of(2.0)
    assert found.size == pytest.approx(0.26 / 2.0, rel=1e-12)
    assert found.basis == "gained by line numerical" and found.cure == "a smaller step, or energy_tolerance="
    assert lines_of(0.0) == []
    history.scene.lumped_contacts = ["ball"]  # what is lost counts as well
    assert lines_of(2.0)[0].size == pytest.approx(0.3 / 2.0, rel=1e-12)
    assert lines_of(2.0)[0].basis == "lost by line numerical"
    ledger["numerical"][1] = np.nan  # not booked
    assert lines_of(2.0) == []
    limits = Limits.of(0.01)
    lines = [*line(0.1 * limits.force), BudgetLine(SOURCE, OF, 4.0 * limits.force, "found")]
    assert steps_wanted(100, lines, limits)[0] == pytest.approx(200 * FINER, abs=2)
    run = SimpleNamespace(history=history)
    assert energy_tolerance_wanted(None, run, lines, limits) == pytest.approx(TIGHTER * Settings.energy_tolerance)
    assert energy_tolerance_wanted(2.0 * LEAST_TOLERANCE, run, lines, limits) == 2.0 * LEAST_TOLERANCE
    assert energy_tolerance_wanted(None, run, line(1.0), limits) is None
    history.counters["rejected_steps"] = 0  # the step rules the energy
    assert energy_tolerance_wanted(None, run, lines, limits) is None


@pytest.mark.parametrize(
    ("numerical", "grid", "gained", "named", "cures"),
    [  # [J], of 10 J at hand; in the last row 13 % of the gain need no cure
        ([0.0, -1.0, -1.0], [0.0, 0.0, 3.0], 3.0, "line contact_grid", ("a finer contact grid",)),
        ([0.0, 3.0, 3.0], [0.0, 0.0, -1.0], 3.0, "line numerical", ("a smaller step",)),
        ([0.0, 1.0, 2.0], [0.0, 2.0, 3.0], 5.0, "lines contact_grid and numerical", ("a finer", "a smaller step")),
        ([0.0, 0.0, 0.4], [0.0, 2.0, 2.6], 3.0, "line contact_grid", ("a finer contact grid",)),
    ],
)
def test_energy_from_nowhere_is_cured_where_it_came_from(
    numerical: list[float], grid: list[float], gained: float, named: str, cures: tuple[str, ...]
) -> None:
    ledger = {"numerical": np.array(numerical), "contact_grid": np.array(grid)}
    (found,) = energy_lines(SimpleNamespace(energy=ledger, energy_scale=10.0, history=only_energy()))
    assert found.size == pytest.approx(gained / 10.0)
    assert found.basis == f"gained by {named}"
    said = found.cure.split("; ")
    assert len(said) == len(cures) and all(text.startswith(cure) for text, cure in zip(said, cures, strict=True))


def bounces(**options: Any) -> wf.Result:
    """The first bounces of a ball on a hard plane, a lumped contact."""
    case = CASES["bounces to rest"]
    return simulate(case.build(), 0.2 * case.duration, progress=False, **{**case.options, **options})


def test_energy_of_impacts_is_kept_by_its_tolerance() -> None:
    """Steps of impacts are halved to the energy tolerance, so that more steps would not help; the notes name it, and
    with it the run comes again."""
    accuracy = 1e-3
    found = bounces(accuracy=accuracy)
    note = next(note for note in found.history.notes if "energy_tolerance=" in note)
    (tolerance,) = (float(value) for value in re.findall(r"energy_tolerance=(\S+)", note))
    assert tolerance < Settings.energy_tolerance
    (ledger,) = (line for line in found.error_budget() if line.source == SOURCE)
    assert ledger.size <= 0.5 * accuracy
    again = bounces(step=found.time[-1] / (len(found.time) - 1), options=wf.RunOptions(energy_tolerance=tolerance))
    assert np.array_equal(again.history.energy["numerical"], found.history.energy["numerical"])


def test_it_gives_up_where_errors_do_not_fall() -> None:
    stuck = Stuck()
    found = [stuck.look(steps, line(size)) for steps, size in ((100, 0.1), (200, 0.2), (400, 0.1), (800, 0.09))]
    assert found == [False, False, False, False]  # it fell once
    assert not stuck.look(1600, line(0.1)) and stuck.look(3200, line(0.09))
    same = Stuck()  # what stays as it is is given up sooner than what rises
    assert [same.look(steps, line(0.1)) for steps in (100, 200, 400)] == [False, False, True]


def test_short_pulses_are_seen() -> None:
    scene = pendulum()
    pulse = signals.Table([0.0, 1.0, 1.01, 1.02, 2.0], [0.0, 0.0, 5.0, 0.0, 0.0])
    scene.add(wf.forces.PointForce(scene.body("bob").at((0, 0, 0)), (pulse, (1, 0, 0))))
    setting = first_setting(scene, 0.0, 2.0, None, "quasi_static", Limits.of(0.01))
    assert setting.steps == A_RISE * 2.0 / 0.01


def test_a_scene_that_turns_begins_with_shorter_steps() -> None:
    scene = wf.Scene()
    wheel = scene.add_rigid_body(1.0, (1.0, 1.0, 1.0), name="wheel")
    axle = scene.add(joints.Revolute(scene.ground, wheel.at((0, 0, 0)), axis=(0, 0, 1)))
    scene.add(joints.Drive(axle, signals.Constant(100.0), quantity="velocity"))
    assert first_setting(scene, 0.0, 1.0, None, "quasi_static", Limits.of(0.01)).steps == 200


def test_cells_are_never_forced() -> None:
    """What the program takes by itself, or nodes: other contacts and conformal surfaces may rule cells out."""
    scene = pressed(contact_fixed=True)
    result = simulate(scene, 0.01, accuracy=0.1, start="equilibrium", progress=False)
    assert result.scene.contact(PAIR).grid in ("auto", "body_fixed")


def test_what_signals_do_too_quickly_is_reported() -> None:
    scene = driven_mass()
    pulse = signals.Table([0.0, 0.5, 0.50001, 0.50002, 1.0], [0.0, 0.0, 5.0, 0.0, 0.0])
    scene.add(wf.forces.PointForce(scene.body("bob").at((0, 0, 0)), (pulse, (1, 0, 0))))
    result = simulate(scene, 1.0, accuracy=0.2, progress=False)
    assert any("to see all of them" in note for note in result.history.notes)
