"""Hard cases: the classes of constructed runs, every quick case at one setting, folders and refusals."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studies.hard_cases import stability
from studies.hard_cases import suite as suites
from studies.hard_cases.case import Case, Finding, Ledger, Setting
from studies.hard_cases.cases import CASES
from studies.hard_cases.classes import DEGRADED, FAIL, JOINTS, PASS, REFUSED, SILENT, joint_violation, judge
from studies.hard_cases.memory import STATM, MemoryWatch, resident
from studies.hard_cases.run import run_case
from studies.hard_cases.suite import chosen, run_suite
from warpffrf.model import joints
from warpffrf.model.errors import InputError
from warpffrf.model.scene import Scene
from warpffrf.online.run import run
from warpffrf.output.result import Result

RIGHT, ROUGH, WRONG = (Finding("place", error, 1e-3, 1e-1) for error in (1e-4, 1e-2, 1.0))
STEP = 1e-3


def pendulum() -> Scene:
    scene = Scene(gravity=(0.0, 0.0, -9.81))
    bob = scene.add_rigid_body(1.0, (0.01,) * 3, name="bob", position=(0.3, 0.0, 0.0))
    scene.add(joints.Revolute(scene.ground, bob.at((-0.3, 0.0, 0.0)), axis=(0, 1, 0), name="pivot"))
    return scene


@pytest.fixture(scope="module")
def swing() -> Result:
    return Result(run(pendulum(), 40 * STEP, step=STEP, progress=False))


def changed(result: Result, **changes: Any) -> Result:
    """The same run with another history, of which no budget can be made."""
    return Result(replace(result.history, samples=None, budget=[], **changes))


def with_ledger(result: Result, moved: float) -> Result:
    """A run whose ledger gains (or loses) `moved` of the energy at hand in the middle."""
    numerical = np.zeros(len(result.time))
    numerical[len(numerical) // 2 :] = moved * result.energy_scale
    return changed(result, energy={**result.energy, "numerical": numerical})


@pytest.mark.parametrize(
    ("own", "moved", "notes", "kind"),
    [
        ([], 0.0, [], PASS),
        ([RIGHT], 0.0, [], PASS),
        ([RIGHT, ROUGH], 0.0, [], DEGRADED),
        ([WRONG], 0.0, [], SILENT),
        ([WRONG], 0.0, ["3 steps were halved (energy)"], SILENT),  # states what was done, not that it is wrong
        ([WRONG], 0.0, ["the integrator dissipated 1 J ...: use a smaller step"], FAIL),
        ([Finding("place", float("nan"), 1e-3, 1e-1)], 0.0, [], SILENT),
        ([], 5e-3, [], DEGRADED),
        ([], 5e-2, [], SILENT),
        ([], -5e-2, [], DEGRADED),
        ([], -5e-1, [], SILENT),
    ],
)
def test_class_of_a_completed_run(
    swing: Result, own: Sequence[Finding], moved: float, notes: list[str], kind: str
) -> None:
    result = changed(with_ledger(swing, moved), notes=notes)
    found = judge(result, own, Ledger())
    assert found.kind == kind
    assert bool(found.why) == (kind != PASS)


def test_an_error_budget_is_a_word(swing: Result) -> None:
    """An error that the run itself states is none that it is silent about."""
    stated = max(line.size for line in swing.error_budget() if line.found)
    own = [Finding("place", 2.0 * stated, 1e-12, 1.5 * stated)]
    assert judge(swing, own, Ledger()).kind == FAIL
    assert judge(swing, [replace(own[0], error=min(1e3 * stated, 0.9))], Ledger()).kind == SILENT


def test_a_run_that_ends_early_fails(swing: Result) -> None:
    result = changed(swing, status="not_converged", message="reduce step")
    found = judge(result, [RIGHT], Ledger())
    assert found.kind == FAIL and "reduce step" in found.why


def test_joints_that_come_apart_are_seen(swing: Result) -> None:
    assert joint_violation(swing) < JOINTS[0]
    bob = swing.history.bodies["bob"]
    moved = replace(bob, position=bob.position + 3e-5 * np.linspace(0.0, 1.0, len(swing.time))[:, None])
    result = changed(swing, bodies={"bob": moved})
    assert joint_violation(result) == pytest.approx(1e-4, rel=0.1)  # of 0.3 m
    assert judge(result, [], Ledger()).kind == SILENT


def test_a_drive_that_is_not_followed_is_seen() -> None:
    scene = pendulum()
    scene.gravity = np.zeros(3)
    speed = 3.0
    body = scene.bodies[0]
    body.velocity, body.angular_velocity = np.array([0.0, 0.0, -0.9]), np.array([0.0, speed, 0.0])
    scene.add(joints.Drive(scene.joint("pivot"), speed))
    result = Result(run(scene, 20 * STEP, step=STEP, progress=False))
    assert joint_violation(result) < JOINTS[0]
    joint = result.history.joints["pivot"]
    late = replace(joint, coordinate=joint.coordinate * 0.9, coordinate_names=("rotation",))
    assert joint_violation(changed(result, joints={"pivot": late})) == pytest.approx(0.1 * speed * 20 * STEP, rel=1e-6)


def test_energy_at_hand_has_a_floor(swing: Result) -> None:
    result = with_ledger(swing, 5e-2)
    assert judge(result, [], Ledger(floor=1e3 * swing.energy_scale)).kind == PASS


def test_settings_of_a_case() -> None:
    case = replace(CASES["mass ratio"], steps=(1e-3, 1e-2), tolerances=(1e-6,), energies=(1e-5,), errors=(1e-4,))
    columns = [setting.column for setting in case.settings()]
    assert columns == ["0.001 s", "0.01 s", "tolerance 1e-06", "energy 1e-05", "error 0.0001", "accuracy 0.001"]
    assert [setting.step for setting in case.settings(quick=True)] == [case.middle, 1e-2]
    assert case.step_count(1e-9) == case.most_steps and case.step_count(1e3) == 5
    with pytest.raises(InputError, match="middle must be one of its steps"):
        replace(case, middle=1.0)


@pytest.mark.parametrize("name", [case.name for case in CASES.values() if case.quick])
def test_a_quick_case_runs_and_is_not_silent(name: str) -> None:
    """At its middle step, for a tenth of its steps."""
    case = CASES[name]
    row = run_case(replace(case, duration=0.1 * case.duration), Setting(case.middle))[1]
    assert row.kind in (PASS, DEGRADED), row.why
    assert row.findings


def test_every_case_says_what_it_tests() -> None:
    for name, case in CASES.items():
        assert name == case.name and len(case.tests) > 20 and case.tests.endswith(".")
        assert case.middle in case.steps
        assert len({s.column for s in case.settings()}) == len(case.settings())


# --- the suite


def counted(count: list[str], **options: Any) -> Case:
    def check(_: Result) -> list[Finding]:
        count.append("run")
        return [RIGHT]

    return Case(
        "swing", "A pendulum, for tests only.", pendulum, 20 * STEP, check, steps=(STEP, 1e-2), middle=STEP, **options
    )


@pytest.mark.slow
def test_a_suite_goes_on_in_its_folder(tmp_path: Path) -> None:
    count: list[str] = []
    case = counted(count)
    first = run_suite(tmp_path, [case], quick=True, overwrite=False, progress=False)
    assert len(count) == 2 and len(first.of(PASS)) == 2
    again = run_suite(tmp_path, [case], quick=True, overwrite=False, progress=False)
    assert len(count) == 2 and again.rows == first.rows
    run_suite(tmp_path, [case], quick=False, overwrite=False, progress=False)
    assert len(count) == 2 + len(case.settings()) - 2
    run_suite(tmp_path, [replace(case, duration=30 * STEP)], quick=True, overwrite=False, progress=False)
    assert len(count) == len(case.settings()) + 1  # 5 steps of 1e-2 s either way
    run_suite(tmp_path, [case], quick=True, overwrite=True, progress=False)
    assert len(count) == len(case.settings()) + 3


def test_an_interrupted_suite_keeps_what_it_has(tmp_path: Path) -> None:
    count: list[str] = []
    case = counted(count)

    def stop(_: Result) -> list[Finding]:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_suite(
            tmp_path, [case, replace(case, name="stopped", check=stop)], quick=True, overwrite=False, progress=False
        )
    kept = json.loads((tmp_path / suites.ROWS).read_text())
    assert len(kept["rows"]) == 2
    found = run_suite(tmp_path, [case], quick=True, overwrite=False, progress=False)
    assert len(count) == 2 and len(found.rows) == 2


def test_page_table_and_map(tmp_path: Path) -> None:
    case = counted([])
    found = run_suite(None, [case], quick=True, overwrite=False, progress=False)
    paths = found.write(tmp_path)
    assert [path.name for path in paths] == [suites.PAGE, suites.TABLE, suites.MAP]
    text = paths[0].read_text()
    assert "2 runs: 2 pass" in text and "| swing | pass | pass |" in text and case.tests in text
    assert len(paths[1].read_text().splitlines()) == 4
    assert paths[2].read_bytes().startswith(b"\x89PNG")
    with pytest.raises(InputError, match="exists"):
        found.write(tmp_path)


@pytest.mark.slow
def test_rows_of_other_cases_stay_in_the_report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first, second = (replace(counted([]), name=name) for name in ("first", "second"))
    monkeypatch.setattr(suites, "CASES", {case.name: case for case in (first, second)})
    run_suite(tmp_path, [second], quick=False, overwrite=False, progress=False)
    found = run_suite(tmp_path, [first], quick=False, overwrite=False, progress=False)
    assert [case.name for case in found.cases] == ["first", "second"]
    assert len(found.rows) == len(first.settings()) + len(second.settings())
    assert [c.name for c in run_suite(None, [second], quick=True, overwrite=False, progress=False).cases] == ["second"]


def test_memory_that_grows_after_the_first_quarter_counts() -> None:
    watch = MemoryWatch()
    assert np.isnan(watch.grown)
    watch.samples = [(0.0, 100.0), (0.5, 150.0), (1.5, 151.0), (3.0, 180.0), (4.0, 170.0)]  # s, MB
    assert watch.grown == 29.0
    if Path(STATM).exists():
        size = resident()
        assert size is not None and 10.0 < size < 1e6
        with watch:
            pass
        assert len(watch.samples) > 5


def test_memory_is_judged_where_a_case_asks_for_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(MemoryWatch, "grown", 50.0)
    kinds = [run_case(counted([], memory=limits), Setting(STEP))[1].kind for limits in (None, (60.0, 90.0), (1.0, 9.0))]
    assert kinds == [PASS, PASS, SILENT]


def test_refused_input_is_a_class() -> None:
    def build() -> Scene:
        raise InputError("scene: no bodies")

    row = run_case(replace(counted([]), build=build), Setting(STEP))[1]
    assert row.kind == REFUSED and row.why == "scene: no bodies"


def test_a_program_that_breaks_down_is_a_fail() -> None:
    def build() -> Scene:
        raise IndexError("out of range")

    assert run_case(replace(counted([]), build=build), Setting(STEP))[1].kind == FAIL


def test_unknown_names_and_other_folders_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="mass ratio"):
        stability(tmp_path, cases=["mas ratio"], progress=False)
    file = tmp_path / "file"
    file.write_text("x")
    with pytest.raises(InputError, match="is a file"):
        stability(file, cases=["mass ratio"], progress=False)
    (tmp_path / suites.ROWS).write_text("{}")
    with pytest.raises(InputError, match="no stability study"):
        stability(tmp_path, cases=["mass ratio"], progress=False)


def test_slow_cases_are_run_where_they_are_named() -> None:
    slow = {case.name for case in CASES.values() if case.slow}
    assert not slow & {case.name for case in chosen(None, quick=False)}
    assert {case.name for case in chosen(list(slow), quick=False)} == slow
