"""Studies of speed against error: times, errors, fronts, orders, going on, refusals."""

import re
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.cli.study import choices_of
from warpffrf.model.errors import InputError
from warpffrf.model.half_space import Boxes, squares
from warpffrf.model.integrators import HHT, GeneralizedAlpha, Newmark
from warpffrf.study.speed_against_error.choices import text_of
from warpffrf.study.speed_against_error.errors import common_interval, common_rows, relative, relative_largest
from warpffrf.study.speed_against_error.front import fastest, front, orders
from warpffrf.study.speed_against_error.machines import stated, unit_of
from warpffrf.study.speed_against_error.outcome import front_table, full_table, order_table, shortened
from warpffrf.study.speed_against_error.picture import pareto_figure, steps_figure
from warpffrf.study.speed_against_error.runs import Row

ROUND_OFF = 1e-12


def pendulum(arm: float = 0.5) -> wf.Scene:
    scene = wf.Scene(gravity=(0.0, 0.0, -9.81))
    bob = scene.add_rigid_body(2.0, (0.01, 0.01, 0.01), name="bob", position=(arm, 0.0, 0.0))
    scene.add(wf.joints.Revolute(scene.ground, bob.at((-arm, 0.0, 0.0)), axis=(0, 1, 0), name="hinge"))
    return scene


def in_time(duration: float, step: float = 2e-3) -> partial:
    return partial(wf.simulate, duration=duration, step=step)


def test_times_are_common_multiples_and_none_is_made_up() -> None:
    assert common_interval([2e-3, 1e-3, 1.5e-3], 0.1) == pytest.approx(6e-3, rel=ROUND_OFF)
    time = np.array([0.0, 0.5, 1.0, 1.7, 2.0])
    rows = common_rows(time, 1.0, 2.0)
    assert rows is not None and rows.tolist() == [0, 2, 4]
    assert common_rows(time[:4], 1.0, 2.0) is None
    with pytest.raises(InputError, match="no common times"):
        common_interval([1e-3, 1e-3 / np.pi], 1.0)


def test_errors_of_histories_in_closed_form() -> None:
    t = np.arange(64) / 64.0
    ref = np.stack([np.sin(2 * np.pi * t), 0 * t, np.cos(2 * np.pi * t)], axis=1)
    assert relative(1.03 * ref, ref) == pytest.approx(0.03, rel=1e-10)
    bumped = ref.copy()
    bumped[5, 1] += 0.2
    assert relative_largest(bumped, ref) == pytest.approx(0.2, rel=1e-10)
    assert relative(bumped, ref) == pytest.approx(0.2 / 8.0, rel=1e-10)  # |ref| = sqrt(64)


def means_of_a_ramp(lines: np.ndarray) -> Boxes:
    """p = x as means over boxes, on two rows."""
    return Boxes(lines, np.array([0.0, 0.5, 2.0]), np.outer(0.5 * (lines[1:] + lines[:-1]), np.ones(2)))


@pytest.mark.parametrize("coarse", [np.linspace(0.0, 1.0, 5), np.array([0.0, 0.1, 0.5, 1.0])])
def test_pressure_on_two_grids_of_one_field_is_the_same(coarse: np.ndarray) -> None:
    """Lines of the fine grid are those of the coarse one and some between them: means of means are means."""
    fine = np.sort(np.concatenate([coarse, coarse[:-1] + 0.3 * np.diff(coarse), coarse[:-1] + 0.7 * np.diff(coarse)]))
    for one, other in ((coarse, fine), (fine, coarse)):
        apart, size = squares(means_of_a_ramp(one), means_of_a_ramp(other))
        assert apart < ROUND_OFF
        expected = 2.0 * float(np.diff(coarse) @ (0.5 * (coarse[1:] + coarse[:-1])) ** 2)
        assert size == pytest.approx(expected, rel=ROUND_OFF)


def test_pressure_where_only_one_run_has_cells_is_an_error() -> None:
    """p = 1 over [0, 1], and over [0, 3] in the reference, on boxes of 0.5 and 0.75: 2 of 3 are missing, less what one
    box shares."""
    z = np.array([0.0, 1.0])
    one, other = (Boxes(np.linspace(0.0, end, 1 + n), z, np.ones((n, 1))) for end, n in ((1.0, 2), (3.0, 4)))
    apart, size = squares(one, other)
    assert size == pytest.approx(3.0, rel=ROUND_OFF)
    assert apart == pytest.approx(0.75 * (2.0 / 3.0) ** 2 + 1.5, rel=ROUND_OFF)  # a third of the second box is pressed


def test_front_is_that_of_brute_force() -> None:
    numbers = np.random.default_rng(1).random((40, 2))
    rows = [Row({"step": float(i)}, "completed", errors={"force": e}, walls=[w]) for i, (w, e) in enumerate(numbers)]
    beaten = [any((numbers[j] <= numbers[i]).all() and j != i for j in range(40)) for i in range(40)]
    assert {id(r) for r in front(rows, "force")} == {id(r) for r, b in zip(rows, beaten, strict=True) if not b}
    best = fastest(rows, 0.3, ["force"])
    assert best is not None
    assert best.fastest == min(w for w, e in numbers if e <= 0.3)
    alike = [Row({"step": w}, "completed", errors={"force": e}, walls=[w]) for w, e in ((1.0, 0.1), (2.0, 0.0999999))]
    assert front(alike, "force") == alike[:1]


@pytest.mark.slow
def test_order_two_of_a_pendulum_and_going_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from warpffrf.study.speed_against_error import study as room

    how = {"run": in_time(0.4), "choices": {"step": [8e-3, 4e-3, 2e-3]}, "rounds": 2, "progress": False}
    whole = wf.study.speed_error(pendulum, **how)
    (order,) = whole.orders()
    assert np.all(np.abs(order.orders - 2.0) < 0.15)  # next term is of third order in the step
    steps, errors = zip(*((r.setting["step"], r.errors["displacement"]) for r in whole.rows), strict=True)
    assert errors[0] > errors[1] > errors[2]
    assert steps[0] == 8e-3
    run, calls = room.run_setting, []

    def interrupted(*args):
        calls.append(args)
        if len(calls) == 5:
            raise KeyboardInterrupt
        return run(*args)

    monkeypatch.setattr(room, "run_setting", interrupted)
    with pytest.raises(KeyboardInterrupt):
        wf.study.speed_error(pendulum, out=tmp_path, **how)
    resumed = wf.study.speed_error(pendulum, out=tmp_path, **how)
    assert len(calls) == 2 + 2 * 3 + 1
    assert [r.label for r in resumed.rows] == [r.label for r in whole.rows]
    assert [r.errors for r in resumed.rows] == [r.errors for r in whole.rows]
    assert all(len(r.walls) == 2 for r in resumed.rows)
    with pytest.raises(InputError, match="another scene"):
        wf.study.speed_error(pendulum, out=tmp_path, parameters={"arm": 0.4}, **how)
    apart, least = whole.reference["apart"]["displacement"], min(errors)
    assert apart < least
    with pytest.raises(InputError, match="least reached"):
        whole.recommended(0.5 * (apart + least))
    with pytest.raises(InputError, match=re.escape(f"differs from twice its own step by {apart:.2g}")):
        whole.recommended(0.9 * apart)
    assert [len(found.sittings) for found in (whole, resumed)] == [1, 2]
    again = wf.study.speed_error(pendulum, out=tmp_path, **how)
    assert again.sittings == resumed.sittings  # nothing was timed
    (facts,) = whole.sittings
    assert f"U = {facts['unit_seconds'] * 1e6:.4g} us" in whole.report()
    assert f"warpffrf {facts['versions']['warpffrf']}" in whole.report()
    head, lines = whole.table()
    in_units = [float(line[head.index("step U")]) for line in lines]
    wanted = [r.fastest * r.setting["step"] / facts["unit_seconds"] for r in whole.rows]
    assert in_units == pytest.approx(wanted, rel=0.01)  # shown with three digits


def test_tables_group_runs_and_leave_out_what_says_nothing() -> None:
    def row(grid: str, step: float, error: float) -> Row:
        return Row(
            {"step": step, "grid": grid, "local_modes": "quasi_static"}, "completed", errors={"force": error},
            walls=[1e-4 / step], graphs=[0.9e-4 / step], set_up=[0.1], after=[0.2], offline=3.0,
        )  # fmt: skip

    rows = [row("patch", 1e-4, 0.02), row("material", 1e-4, 0.1), row("patch", 2e-4, 0.08), row("material", 2e-4, 0.4)]
    head, lines = full_table(rows, ["force"], 5e-5)
    assert head[:3] == ["grid", "step", "force [%]"]
    assert [line[:2] for line in lines] == [
        ["patch", "0.0002"], ["patch", "0.0001"], ["material", "0.0002"], ["material", "0.0001"],
    ]  # fmt: skip
    assert [line[head.index("step U")] for line in lines] == ["2"] * 4  # 1e-4 s a step, U = 50 us
    short, kept, same = shortened(head, lines)
    assert "median" not in short and not set(same) & set(short) and len(kept) == len(rows)
    assert {"status", "offline s", "step U"} <= set(same) and same["offline s"] == "3"
    by_front = front_table(rows, ["force"], 5e-5)[1]
    assert [line[:2] for line in by_front] == [["patch", "0.0002"], ["patch", "0.0001"]]
    more = [*rows, row("patch", 4e-4, 0.32), row("material", 4e-4, 1.6)]
    series = {r.label: {"force": np.array([1.0 + r.errors["force"]]), "half": np.array([0.5])} for r in more}
    head, lines = order_table(orders(more, series))
    assert head == ["runs", "steps [s]", "force", "half"] and len(lines) == 2
    # errors fall by four: the differences of runs too; what does not change has no order
    assert lines[0] == ["grid=patch", "0.0004 to 0.0001", "2.00", "-"]


def test_a_sitting_states_what_else_ran() -> None:
    on = {"processor": "P", "cores": 2, "platform": "L", "python": "3"}
    facts = {"machine": on, "versions": {"numpy": "2"}, "unit_seconds": 4e-5, "load_before": 0.1}
    assert "quiet machine" in stated(facts)
    assert "preliminary" in stated({**facts, "load_before": 1.7})
    assert "is unknown" in stated({**facts, "load_before": None})
    assert unit_of([facts, {**facts, "unit_seconds": 5e-5}]) == 4e-5
    assert unit_of([facts, {**facts, "machine": {**on, "processor": "Q"}}]) is None


@pytest.mark.slow
def test_pictures_hold_the_rows_and_the_reference(tmp_path: Path) -> None:
    found = wf.study.speed_error(
        pendulum, in_time(0.4), choices={"step": [8e-3, 4e-3, 2e-3], "arm": [0.4, 0.5]},
        reference={"arm": 0.5}, measures=["displacement"], rounds=1, progress=False,
    )  # fmt: skip
    files = [file.name for file in found.write(tmp_path)]
    assert files == ["speed_error.csv", "speed_error.md", "speed_error.png", "speed_error_steps.png"]
    assert all((tmp_path / name).stat().st_size for name in files)
    about = found.rows, found.measures, found.reference["apart"]
    figures = {"fastest": pareto_figure(*about, "t"), "step": steps_figure(*about, found.orders(), "t")}
    for name, figure in figures.items():
        (ax,) = figure.axes
        drawn = {(float(x), float(y)) for line in ax.lines[:2] for x, y in line.get_xydata()}
        wanted = [
            (r.setting["step"] if name == "step" else r.fastest, 100.0 * r.errors["displacement"]) for r in found.rows
        ]
        assert drawn == set(wanted)
        assert ax.get_xscale() == ax.get_yscale() == "log"
        assert ax.lines[-1].get_ydata()[0] == 100.0 * found.reference["apart"]["displacement"]
    circled = {float(x) for x in figures["fastest"].axes[0].lines[2].get_xdata()}
    assert circled == {row.fastest for row in found.front("displacement")}
    assert "quasi_static: order" in figures["step"].axes[0].get_title()
    alone = wf.study.speed_error(pendulum, in_time(0.1), choices={"arm": [0.5, 0.4]}, rounds=1, progress=False)
    assert steps_figure(alone.rows, alone.measures, alone.reference["apart"], [], "t") is None


def test_refusals_name_the_thing_and_the_cure() -> None:
    with pytest.raises(InputError, match="no contact; add a Contact"):
        wf.study.speed_error(pendulum, in_time(0.1, 1e-3), measures=["force"], progress=False)
    with pytest.raises(InputError, match="more than 200"):
        wf.study.speed_error(pendulum, in_time(0.1, 1e-3), choices={"step": [1e-3] + [1e-3 / n for n in range(2, 300)]})
    with pytest.raises(InputError, match="give duration and step"):
        wf.study.speed_error(pendulum, progress=False)
    with pytest.raises(InputError, match="must be a run in time"):
        wf.study.speed_error(pendulum, wf.equilibrium, progress=False)
    with pytest.raises(InputError, match="cannot be chosen for a Scene"):
        wf.study.speed_error(pendulum(), in_time(0.1, 1e-3), choices={"arm": [0.4, 0.5]}, progress=False)


@pytest.mark.slow
def test_command_runs_a_scene_file_and_refuses_in_one_line(tmp_path: Path) -> None:
    from typer.testing import CliRunner

    from warpffrf.cli import app

    file = tmp_path / "bob.toml"
    file.write_text(
        "[scene]\ngravity = [0, 0, -9.81]\n[bodies.bob]\nmass = 2.0\ninertia_tensor = [0.01, 0.01, 0.01]\n"
        "[simulate]\nduration = 0.02\nstep = 1e-3\n"
    )
    out = tmp_path / "out"
    args = [
        "study",
        "speed-error",
        str(file),
        "--out",
        str(out),
        "--choice",
        "simulate.step=2e-3,1e-3",
        "--choice",
        "integrator=hht",
        "--rounds",
        "1",
    ]
    found = CliRunner().invoke(app, args)
    assert found.exit_code == 0, found.output
    assert (out / "speed_error.csv").is_file() and "Reference: step=0.00025" in found.output
    assert "integrator=HHT()" in found.output
    refused = CliRunner().invoke(app, [*args, "--measure", "force"])
    assert refused.exit_code == 1


def test_choices_name_integrators_and_the_step_as_scene_files_do() -> None:
    found = choices_of(['integrator={kind="hht", alpha=-0.3}, "generalized_alpha"', "simulate.step=2e-3,1e-3"])
    assert found == {"integrator": [HHT(alpha=-0.3), GeneralizedAlpha()], "step": [2e-3, 1e-3]}
    assert choices_of(["integrator=hht,newmark", "local_modes=hht"]) == {
        "integrator": [HHT(), Newmark()],
        "local_modes": ["hht"],
    }
    assert choices_of(["bodies.bob.mass=1,2"]) == {"bodies.bob.mass": [1, 2]}
    with pytest.raises(InputError, match="'hhtt'.*generalized_alpha"):
        choices_of(["integrator=hhtt"])
    with pytest.raises(InputError, match="given twice"):
        choices_of(["step=1e-3", "simulate.step=2e-3"])
    with pytest.raises(InputError, match="alfa"):
        choices_of(['integrator={kind="hht", alfa=-0.3}'])
    assert text_of(HHT(alpha=-0.3)) == "HHT(alpha=-0.3)"
