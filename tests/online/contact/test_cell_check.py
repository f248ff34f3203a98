"""What a run says of the error that its cells add, compared with many more of them, and how many an error asks for."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from studies.contact import coarse_rollers as cr
from warpffrf.model.errors import InputError
from warpffrf.model.half_space import Boxes, squares
from warpffrf.online.compile.patches.plan import CROWNED_ERROR, STRIPS_ERROR, PatchPlan
from warpffrf.online.diagnosis import cell_check
from warpffrf.online.diagnosis.cell_check import MANY, check_cells
from warpffrf.online.engine import Engine
from warpffrf.online.history.record import history_from_rows
from warpffrf.online.run import find_equilibrium, run

APPROACH = 2e-5
AGAIN = 1e-5  # of forces at poses, modes and times put back: 1e-6 by the width of the patch, which settles in steps
SAME = 2e-6  # of forces evaluated again compared with those of an equilibrium, whose bodies rest to 1e-6
BESIDE = 0.1  # of errors next to another patch of few cells, which err by 3 % of a force that moves faces little
WITHIN = 3.0  # errors go up and down with the number of cells, by their place under the edge of the patch
BELOW = 1.5  # times the rule that an error may be: the rule is what errors stay below on its own page


@pytest.fixture(scope="module")
def straight():
    return cr.reduced(cr.hexahedra(8e-3, 1))


@pytest.fixture(scope="module")
def crowned():
    return cr.reduced(cr.hexahedra(8e-3, 2, 0.14), 0.14)


def at_rest(scene):
    found = find_equilibrium(scene).contacts[cr.PAIR]
    return np.array([np.linalg.norm(found.force[-1]), found.pressure[-1].max()])


def field(scene) -> Boxes:
    """Pressures in the state of rest."""
    found = find_equilibrium(scene).contacts[cr.PAIR]
    assert found.cells is not None
    z, half = found.cells.z[-1], 0.5 * found.cells.length[-1]
    x = found.cells.half_width[-1] * np.linspace(-1.0, 1.0, found.pressure.shape[1] + 1)
    return Boxes(x, np.append(z - half, z[-1] + half[-1]), found.pressure[-1])


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["straight", "crowned"])
def test_error_compared_with_many_cells(kind, request) -> None:
    """A coarse patch errs by what its note says, and by what was asked for."""
    body, error = request.getfixturevalue(kind), 0.012
    scene = cr.held(body, body, APPROACH, cell_error=error)
    history = find_equilibrium(scene)
    said = check_cells(Engine(scene), history)[0]
    assert said.finer and said.rows == (0,)
    many = cr.held(body, body, APPROACH, cells=(31, 31))
    true = np.abs(at_rest(scene) / at_rest(many) - 1.0)
    apart, size = squares(field(scene), field(many))
    assert np.sqrt(apart / size) / WITHIN < said.field < np.sqrt(apart / size) * WITHIN
    assert np.all(true < BELOW * error)
    assert max(true) / WITHIN < max(said.force, said.pressure) < max(true) * WITHIN
    assert any("7 x" in note and "adds errors" in note for note in history.notes)


def test_coarser_cells_say_the_same(straight) -> None:
    """Of many cells fewer ones give the error: it is small, and found within the same factor of safety."""
    cells = (21, 41)
    assert np.prod(cells) > MANY
    scene = cr.held(straight, straight, APPROACH, cells=cells)
    said = check_cells(Engine(scene), find_equilibrium(scene))[0]
    assert not said.finer
    assert 0.0 < max(said.force, said.pressure) < BELOW * STRIPS_ERROR / cells[0] ** 2


def test_evaluated_again_as_in_the_run(straight, monkeypatch) -> None:
    """On the run's own cells the forces at saved steps of turning rollers are those that were saved."""
    scene = cr.held(straight, straight, APPROACH, turning=2.0)
    history = run(scene, 2e-3, step=1e-4, start="equilibrium", progress=False)
    monkeypatch.setattr(PatchPlan, "spread", lambda plan, *_: plan)
    engine = Engine(scene)
    forces = np.linalg.norm(history.contacts[cr.PAIR].force, axis=1)
    rows = [3, 12, 20]
    again = cell_check._at_rest(engine, history, rows, 0, engine.compiled.patches)
    for t in rows:
        assert again[t].force == pytest.approx(forces[t], rel=AGAIN)
    said = check_cells(engine, history)[0]
    assert (said.force, said.pressure) == (0.0, 0.0)
    assert at_rest(cr.held(straight, straight, APPROACH))[0] == pytest.approx(forces[0], rel=SAME)


def test_a_run_without_rows_has_nothing_to_check(straight) -> None:
    """Of an equilibrium that was not found, or one that nothing loads, there is no error to tell."""
    scene = cr.held(straight, straight, -APPROACH)
    assert check_cells(Engine(scene), find_equilibrium(scene)) == {}
    engine = Engine(scene)
    assert check_cells(engine, history_from_rows(engine.compiled, engine.saved())) == {}


def test_next_to_another_patch(straight, monkeypatch) -> None:
    """What few cells of the other patch do to the faces cancels: the errors are those with the other one's own
    cells."""
    scene, small = wf.Scene(gravity=(0, 0, 0)), 0.1 * cr.R
    body = scene.add_body(straight, name="lower")
    scene.add(wf.joints.Fixed(scene.ground, body["bore"]))
    for n, (angle, approach) in enumerate(((-0.2, APPROACH), (0.2, 0.5 * APPROACH))):
        place = (cr.R + small - approach) * np.array([np.sin(angle), 0.0, np.cos(angle)])
        shape = wf.surfaces.Cylinder(radius=small, axis_point=place, axis_direction=(0, 1, 0))
        port = scene.ground.surface(shape, name=f"small {n}")
        scene.add(wf.Contact(body["rim"], port, grid="contact_fixed", name=f"pair {n}", cells=(11, 21)))
    history, engine = find_equilibrium(scene), Engine(scene)
    few = check_cells(engine, history)
    monkeypatch.setattr(cell_check, "FEW", (11, 21))
    own = check_cells(engine, history)
    for i in (0, 1):
        assert few[i].field == pytest.approx(own[i].field, rel=BESIDE)
        assert abs(few[i].force - own[i].force) < BESIDE * BELOW * STRIPS_ERROR / 11**2


@pytest.mark.parametrize(
    ("error", "straight_cells", "crowned_cells"), [(0.005, (11, 21), (11, 11)), (0.02, (7, 13), (7, 7))]
)
def test_cells_for_an_error(straight, crowned, error, straight_cells, crowned_cells) -> None:
    for body, cells in ((straight, straight_cells), (crowned, crowned_cells)):
        (contact,) = cr.held(body, body, APPROACH, cell_error=error).contacts
        plan = PatchPlan.of(contact)
        assert (plan.columns, len(plan.z)) == cells


def test_rows_of_a_crown_for_an_error() -> None:
    """27 rows on a crown of 2 m for 0.5 %, their number with the third root of it."""
    body = cr.reduced(cr.hexahedra(8e-3, 2, 2.0), 2.0)
    for error, rows in ((0.005, 27), (0.02, 17)):
        (contact,) = cr.held(body, body, APPROACH, cell_error=error).contacts
        assert len(PatchPlan.of(contact).z) == rows
        assert CROWNED_ERROR / rows**3 == pytest.approx(error, rel=0.1)


@pytest.mark.parametrize("value", [0.0, -0.01, 1e-5, 0.2, np.nan, "fine"])
def test_bad_errors(straight, value) -> None:
    with pytest.raises(InputError, match="contact 'pair': cell_error"):
        cr.held(straight, straight, APPROACH, cell_error=value)
