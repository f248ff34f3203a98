"""What a run says of its own errors, compared with the errors that it has."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.online.history.history import BudgetLine
from warpffrf.online.samples import SAMPLES, WHOLE
from warpffrf.output.budget.budget import budget_text, largest_of_each, percent
from warpffrf.output.budget.contacts import _beside
from warpffrf.output.budget.figures import NEGLIGIBLE
from warpffrf.output.budget.quantities import LIGHT, STILL, quantities, shares
from warpffrf.output.budget.time_step import SOURCE, at_end, frequency

FACTOR = 3.0  # by which an estimate may be off, as the budget promises
TOO_LARGE = 10.0  # windows shorter than a period cannot tell what is forced from what is free, and take the mean
FINER = 8  # times the step of a run that stands for the exact one: its own error is 1/64 of it
MOTION = "motion of body 'bob'"


def pendulum() -> wf.Scene:
    scene = wf.Scene(gravity=(0, 0, -9.81))
    bob = scene.add_rigid_body(2.0, (0.01, 0.01, 0.01), name="bob", position=(0.5, 0.0, 0.0))
    scene.add(wf.joints.Revolute(scene.ground, bob.at((-0.5, 0.0, 0.0)), axis=(0, 1, 0)))
    return scene


def driven_mass() -> wf.Scene:
    """A damped mass on a spring under a force of half its frequency: what is left of the start dies out."""
    scene = wf.Scene()
    bob = scene.add_rigid_body(1.0, (0.01, 0.01, 0.01), name="bob")
    guide = scene.add(wf.joints.Prismatic(scene.ground, bob.at((0, 0, 0)), axis=(1, 0, 0)))
    scene.add(wf.forces.JointSpringDamper(guide, 400.0, 4.0))
    t = np.linspace(0.0, 5.0, 1001)
    push = wf.signals.Table(t, 100.0 * np.sin(10.0 * t), cubic=True)
    scene.add(wf.forces.PointForce(bob.at((0, 0, 0)), (push, (1, 0, 0))))
    return scene


def run(scene: wf.Scene, duration: float, step: float, **options: Any) -> wf.Result:
    return wf.simulate(scene, duration, step=step, progress=False, **options)


def true_error(scene: wf.Scene, result: wf.Result, step: float) -> float:
    """Root mean square of the error of the motion of the bob over its size."""
    own = quantities(result.history)[MOTION]
    finer = quantities(
        run(scene, float(result.time[-1]), step / FINER, options=wf.RunOptions(save_every=FINER)).history
    )[MOTION]
    return float(np.sqrt(np.mean(own.apart(finer.values) ** 2))) / own.size


def test_a_body_that_rests_is_compared_with_the_machine() -> None:
    """Errors of nanometres of a body that is to rest are not compared with its own nanometres where another goes a
    metre."""
    scene = wf.Scene()
    scene.add_rigid_body(1.0, (0.01, 0.01, 0.01), name="goer", velocity=(1.0, 0.0, 0.0))
    scene.add_rigid_body(1.0, (0.01, 0.01, 0.01), name="creeper", position=(0, 1, 0), velocity=(1e-9, 0.0, 0.0))
    scene.add_rigid_body(1.0, (0.01, 0.01, 0.01), name="still", position=(0, 2, 0))
    found = quantities(run(scene, 1.0, 0.1).history)
    assert found["motion of body 'goer'"].size == pytest.approx(0.5, rel=1e-9)
    assert found["motion of body 'creeper'"].size == pytest.approx(0.5 * STILL, rel=1e-9)
    assert "of the largest displacement" in found["motion of body 'creeper'"].beside
    assert found["motion of body 'goer'"].beside == ""
    (line,) = (line for line in run(scene, 1.0, 0.1).error_budget() if line.of == "motion of body 'creeper'")
    assert "of the largest displacement" in line.basis
    assert "motion of body 'still'" not in found


def test_a_contact_that_carries_little_is_compared_with_the_machine() -> None:
    """Hertz lines of 2 N and 20 kN: of the first errors are compared with 20 N, its pressures compared with those of 20
    N."""
    forces = {"heavy": 2e4, "some": 20.0, "light": 2.0}
    contacts = {name: SimpleNamespace(force=np.full((3, 1), F)) for name, F in forces.items()}
    scene = SimpleNamespace(bodies=[])
    history: Any = SimpleNamespace(
        contacts=contacts, lumped_contacts={}, films={}, small_sliding={}, scene=scene, bodies={}, energy={}
    )
    found = quantities(history)
    assert [found[f"force of contact {name!r}"].size for name in forces] == pytest.approx([2e4, 20.0, 20.0])
    assert [bool(found[f"force of contact {name!r}"].beside) for name in forces] == [False, False, True]
    assert shares(history) == pytest.approx({"heavy": 1.0, "some": 1.0, "light": 2.0 / (LIGHT * 2e4)})
    line = BudgetLine("contact grid", "force", 0.05, "found")
    assert _beside(line, 0.1).size == pytest.approx(0.005) and "carries less" in _beside(line, 0.1).basis
    assert _beside(line, 1.0) is line


def size(result: wf.Result, source: str, of: str) -> float:
    return next(line.size for line in result.error_budget() if (line.source, line.of) == (source, of))


@pytest.mark.parametrize("step", [1e-2, 4e-4], ids=["whole", "windows"])
@pytest.mark.parametrize("scene", [pendulum, driven_mass])
def test_the_error_of_the_step_is_found(scene: Any, step: float) -> None:
    machine = scene()
    result = run(machine, 4.0, step)
    assert (round(4.0 / step) <= WHOLE) == (step == 1e-2)
    true, found = true_error(machine, result, step), size(result, "time step", MOTION)
    assert true / FACTOR < found < true * (FACTOR if step == 1e-2 else TOO_LARGE)


def run_up(shaft: wf.ReducedBody, off: float) -> wf.Result:
    """A shaft with a disc of `off` [m] of unbalance runs up by a ramp, whose jump makes its torsion ring."""
    scene = wf.Scene(gravity=(0, 0, 0))
    body = scene.add_body(shaft, name="shaft")
    disc = scene.add_rigid_body(8.0, (0.02, 0.04, 0.02), name="disc", center_of_mass=(off, 0, 0))
    scene.add(wf.joints.Fixed(body["seat"], disc))
    turn = scene.add(wf.joints.Revolute(scene.ground.at((0, -0.25, 0)), body["end_low"], axis=(0, 1, 0)))
    scene.add(wf.joints.Drive(turn, wf.signals.Ramp(0.0, 150.0, duration=1.0)))
    scene.add(wf.joints.PointOnLine(scene.ground.at((0, 0.25, 0)), body["end_high"], axis=(0, 1, 0)))
    return run(scene, 1.0, 1e-3)


def test_torsion_that_rings_is_not_the_largest_error_of_a_run_up() -> None:
    """It has 3e-5 of the energy; the motions that count err by less than a thousandth."""
    y = np.array([-0.25, -0.13, -0.01, 0.01, 0.13, 0.25])
    mesh = wf.mesh.roller(0.01, 0.0, 0.5, sectors=8, layers=1, axial=y)
    mesh = mesh.select("seat", "rim", lambda x: abs(x[:, 1]) < 0.01)
    steel = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
    interfaces = {"end_low": "rigid", "end_high": "rigid", "seat": "average"}
    shaft = wf.reduce(mesh, steel, interfaces=interfaces, modes=4, cache=False, progress=False)
    result = run_up(shaft, 5e-5)
    lines = result.error_budget()
    rings = next(line for line in lines if (line.source, line.of) == (SOURCE, "deformation of body 'shaft'"))
    assert rings.size > 0.1 and rings.share < NEGLIGIBLE
    text = "\n".join(budget_text(lines))
    assert (
        f"small deformations          {percent(rings.size)} of the deformation of body 'shaft' (time step; it has"
        in text
    )
    assert "all estimates are < 0.1 %" in text
    assert "of the motion and energy)" in result.report(progress=False).split("estimated error of each result")[1]
    counted = [line if line is not rings else replace(line, share=2.0 * NEGLIGIBLE) for line in lines]
    assert f"largest                     time step, {percent(rings.size)}" in "\n".join(budget_text(counted))


def test_it_falls_with_the_square_of_the_step() -> None:
    found = [size(run(pendulum(), 2.0, step), "time step", MOTION) for step in (4e-3, 2e-3, 1e-3)]
    assert np.allclose(np.divide(found[:-1], found[1:]), 4.0, rtol=0.02)  # second order, to the next term


def test_a_continued_run_and_sparse_rows_have_one() -> None:
    scene = pendulum()
    first = run(scene, 1.0, 2e-3)
    rest = run(scene, 1.0, 2e-3, start=first, options=wf.RunOptions(save_every=5))
    true = true_error_from(scene, first, rest)
    assert true / FACTOR < size(rest, "time step", MOTION) < true * FACTOR


def true_error_from(scene: wf.Scene, first: wf.Result, rest: wf.Result) -> float:
    """As `true_error`, of a run that goes on: its own part alone, from the state that it begins with."""
    own = quantities(rest.history)[MOTION]
    finer = run(scene, 1.0, 2e-3 / FINER, start=first, options=wf.RunOptions(save_every=5 * FINER))
    return float(np.sqrt(np.mean(own.apart(quantities(finer.history)[MOTION].values) ** 2))) / own.size


def test_the_run_itself_is_not_changed() -> None:
    result, other = run(pendulum(), 0.5, 1e-3), run(pendulum(), 0.5, 1e-3)
    result.error_budget()
    for name, values in vars(result.body("bob")).items():
        assert np.array_equal(values, getattr(other.body("bob"), name)), name


@pytest.mark.parametrize(("power", "expected"), [(0, 0.0), (1, 100.0), (2, 100.0)])
def test_what_grows_goes_on_growing(power: int, expected: float) -> None:
    """A window of a hundredth: differences t^0, t and, of a quantity that turns by one radian in the window, t^2."""
    t = np.linspace(0.0, 1.0, 201)[1:]
    assert at_end(t**power, 1.0, 100.0, 1.0 if power == 2 else 100.0) == pytest.approx(expected, rel=0.15)  # LAST


def test_frequency_of_a_sine() -> None:
    t = np.linspace(0.0, 2.0 * np.pi, 1001)
    assert frequency(t, np.sin(5.0 * t)[:, None]) == pytest.approx(5.0, rel=1e-3)  # of differences


def test_a_file_keeps_it(tmp_path: Path) -> None:
    result = run(pendulum(), 0.2, 1e-2)
    before, after = tmp_path / "before.h5", tmp_path / "after.h5"
    result.save(before)
    lines = result.error_budget()
    result.save(after)
    assert repr(wf.Result.load(after).error_budget()) == repr(lines)
    (line,) = wf.Result.load(before).error_budget()
    assert np.isnan(line.size) and line.basis.startswith("not made: it requires the process of the run")
    assert "error budget      not made" in wf.Result.load(before).report()


def test_stages_have_the_largest_of_each() -> None:
    scene = pendulum()
    result = wf.simulate(scene, [wf.Stage("a", 0.2, 1e-2), wf.Stage("b", 0.2, 2e-3)], progress=False)
    each = [size(part, "time step", MOTION) for part in result.stages.values()]  # type: ignore[attr-defined]
    assert size(result, "time step", MOTION) == max(each)


def test_the_largest_is_named_with_its_cure() -> None:
    lines = [
        BudgetLine("time step", "force", 2e-5, "again", "a smaller step"),
        BudgetLine("contact grid", "force", 0.031, "the rule", "a finer grid"),
        BudgetLine("contact grid", "force of another", 0.011, "the rule", "a finer grid"),
        BudgetLine("FE mesh", "force", np.nan, "needs another mesh", "mesh_error"),
    ]
    text = "\n".join(budget_text(lines))
    assert "time step                   < 0.1 % of the force" in text
    assert "not found: needs another mesh; mesh_error" in text
    assert text.splitlines()[-1].split() == "largest contact grid, 3.1 %; cure: a finer grid".split()


def test_of_two_runs_the_larger_counts() -> None:
    small, large = BudgetLine("a", "b", 1e-3, ""), BudgetLine("a", "b", 2e-3, "")
    unknown = BudgetLine("a", "b", np.nan, "")
    assert largest_of_each([unknown, small, large, unknown]) == [large]


def test_a_run_of_one_step_says_so() -> None:
    lines = [line for line in run(pendulum(), 1e-3, 1e-3).error_budget() if line.source == SOURCE]
    assert [line.found for line in lines] == [False] and "too short" in lines[0].basis


def test_long_runs_leave_so_many_states() -> None:
    result = run(pendulum(), 5.0, 1e-3)
    assert len(result.history.samples.states) == SAMPLES
