"""Oil films whose second surface yields too: a steel shaft in a steel sleeve."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from film_scenes import (
    CLEARANCE,
    LENGTH,
    RADIUS,
    ROWS,
    SPEED,
    Array,
    bearing,
    bore_body,
    reference,
    shaft_body,
    turning_load,
)
from scipy.spatial import KDTree

from references.films.elastic import held_compliance
from warpffrf.model import films
from warpffrf.model.films.film import places_around
from warpffrf.model.laws import ExponentialAsperities
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.online import run
from warpffrf.online.diagnosis.film_notes import film_notes
from warpffrf.online.run import find_equilibrium
from warpffrf.online.vibrations.eigenmodes import find_modes
from warpffrf.output.result import Result

STIFFER = 1e5  # times steel
DIRECTIONS = CLEARANCE / RADIUS  # both surfaces' normals and nodes, which the reference does not tell apart
TURN = 2.0 * np.pi / SPEED


def places(surface: ContactSurface) -> Array:
    """(nodes, 3) m."""
    theta, z = (v.ravel() for v in np.meshgrid(places_around(surface), surface.grid.z, indexing="ij"))
    return np.asarray(surface.shape.point(theta, z))


def of_shaft() -> Array:
    """Hats of the shaft that lie opposite those of the bore, while it has not rotated."""
    bore, rim = bore_body().contact_surfaces["bore"], shaft_body().contact_surfaces["rim"]
    away, found = KDTree(places(rim)).query(places(bore))
    np.testing.assert_allclose(away, CLEARANCE, rtol=1e-6)
    return np.asarray(found)


@pytest.mark.parametrize("load", [2e3, 20e3])
def test_compliances_of_both_add_up(load: float) -> None:
    """Compared with the dense reference with the sum of both, whose nodes lie opposite each other at rest."""
    found = find_equilibrium(bearing((load, 0.0), yielding=shaft_body()))
    assert found.status == "completed", found.message
    opposite, expected = of_shaft(), reference()
    more = held_compliance(shaft_body(), "rim", "bore")[np.ix_(opposite, opposite)]
    both = replace(expected, compliance=expected.compliance + more)
    settled = both.settle(np.array([0.3 * CLEARANCE, 0.0]), np.array([load, 0.0]))
    film, alone = found.films["film"], find_equilibrium(bearing((load, 0.0))).films["film"]
    change = abs(film.largest_pressure[-1] / alone.largest_pressure[-1] - 1.0)
    assert film.largest_pressure[-1] == pytest.approx(settled.state.pressure.max(), rel=2.0 * DIRECTIONS)
    assert film.smallest_gap[-1] == pytest.approx(both.gap(settled.state).min(), rel=2.0 * DIRECTIONS)
    if load > 10e3:
        assert change > 50.0 * DIRECTIONS  # the shaft matters
    # loads on the second surface are those of the film, along its normals
    grid = shaft_body().contact_surfaces["rim"]
    theta, z = (v.ravel() for v in np.meshgrid(places_around(grid), grid.grid.z, indexing="ij"))
    assert film.load_second is not None
    push = -film.load_second[-1].ravel() @ grid.shape.normal(theta, z)
    np.testing.assert_allclose(push, -film.force[-1], atol=10.0 * DIRECTIONS * load)  # nodes stand for their middles


def test_a_stiff_shaft_is_a_rigid_one() -> None:
    stiff = find_equilibrium(bearing((20e3, 0.0), yielding=shaft_body(STIFFER * 210e9))).films["film"]
    rigid = find_equilibrium(bearing((20e3, 0.0))).films["film"]
    assert stiff.smallest_gap[-1] == pytest.approx(rigid.smallest_gap[-1], rel=1.0 / STIFFER)
    assert stiff.largest_pressure[-1] == pytest.approx(rigid.largest_pressure[-1], rel=1.0 / STIFFER)


def test_the_film_may_stand_on_either() -> None:
    """Hats of both lie on the same places at rest; the film is as thick whichever carries its equations."""
    bore, shaft = (
        find_equilibrium(
            bearing((20e3, 0.0), yielding=shaft_body(), on_shaft=on, cavitation="reynolds", feeds=[])
        ).films["film"]
        for on in (False, True)
    )
    assert shaft.smallest_gap[-1] == pytest.approx(bore.smallest_gap[-1], rel=2.0 * DIRECTIONS)
    np.testing.assert_allclose(shaft.force[-1], -bore.force[-1], atol=1e-3 * 20e3)


@pytest.mark.parametrize("on_shaft", [False, True])
def test_the_ledger_closes_while_one_turns_through_the_load(on_shaft: bool) -> None:
    """What is left over is of the steps, a quarter in halved ones; the nodes of one turn past those of the other."""
    left = []
    for part in (60, 120):
        step, steps = TURN / part, part // 2
        scene = bearing(
            turning_load(step, steps), yielding=shaft_body(), on_shaft=on_shaft, at=(0.4 * CLEARANCE, 0.4 * CLEARANCE),
            cavitation="reynolds", feeds=[],
        )  # fmt: skip
        found = run(scene, steps * step, step=step, start="equilibrium", progress=False)
        assert found.status == "completed", found.message
        assert found.counters["rejected_steps"] == 0 and found.counters["max_iterations"] <= 6
        energy = found.energy
        left.append(abs(energy["numerical"][-1]) / energy["drive_work"][-1])
    assert left[0] < 5e-4 and left[1] < 0.4 * left[0]


def test_asperities_press_both() -> None:
    law = ExponentialAsperities(2e9, 1e-6)
    found = find_equilibrium(bearing((20e3, 0.0), yielding=shaft_body(), mixed=films.MixedLubrication(law)))
    assert found.status == "completed", found.message
    opposite, expected = of_shaft(), reference(asperities=law.curve)
    more = held_compliance(shaft_body(), "rim", "bore")[np.ix_(opposite, opposite)]
    both = replace(expected, compliance=expected.compliance + more)
    settled = both.settle(np.array([0.3 * CLEARANCE, 0.0]), np.array([20e3, 0.0]))
    film = found.films["film"]
    assert film.asperity_force[-1] > 0.1 * 20e3
    assert film.largest_asperity_pressure[-1] == pytest.approx(settled.state.asperity.max(), rel=5.0 * DIRECTIONS)
    assert film.smallest_gap[-1] == pytest.approx(both.gap(settled.state).min(), rel=5.0 * DIRECTIONS)


def test_profiles_along_press_both() -> None:
    strips = find_equilibrium(bearing((20e3, 0.0), yielding=shaft_body(), quadrature="reduced", axial_degrees=(0, 2)))
    expected = reference(powers=(0, 2))
    opposite = of_shaft()
    more = held_compliance(shaft_body(), "rim", "bore")[np.ix_(opposite, opposite)]
    both = replace(expected, compliance=expected.compliance + more)
    settled = both.settle(np.array([0.3 * CLEARANCE, 0.0]), np.array([20e3, 0.0]))
    assert strips.status == "completed", strips.message
    (note,) = [
        note for note in strips.notes if "not compared with all nodes, as its second surface is compliant" in note
    ]
    rough = bearing(
        (20e3, 0.0),
        quadrature="reduced",
        axial_degrees=(0, 2),
        mixed=films.MixedLubrication(roughness_a=films.Roughness(0.2e-6)),
    )
    (note,) = [note for note in find_equilibrium(rough).notes if "not compared with all nodes" in note]
    assert "as its walls are rough" in note
    pressure = both.basis.to_nodes @ settled.state.pressure
    np.testing.assert_allclose(
        strips.films["film"].pressure[-1].ravel(), pressure, atol=5.0 * DIRECTIONS * pressure.max()
    )


def test_modes_are_what_a_small_disturbance_does_to_both() -> None:
    """Decay and whirl of a heavy shaft that is pushed, in steps of one degree."""
    heavy, speed, step, steps = shaft_body(density=5e5), 1e-4, np.radians(1.0) / SPEED, 240
    (first, second) = find_modes(bearing((2e3, 0.0), yielding=heavy), 2).eigenvalues
    runs = [
        run(
            bearing((2e3, 0.0), yielding=heavy, velocity=v), steps * step, step=step, start="equilibrium",
            progress=False,
        )
        for v in ((0.0, 0.0), (speed, 0.0))
    ]  # fmt: skip
    x = runs[1].bodies["shaft"].position[:, [0, 2]] - runs[0].bodies["shaft"].position[:, [0, 2]]
    basis = [np.exp(root * runs[0].time) for root in (first, second) if root.imag >= 0.0]
    columns = np.array([part for e in basis for part in ([e.real, e.imag] if np.any(e.imag) else [e.real])]).T[40:]
    for values in x.T:  # late, when motions of oil alone have died away
        left = values[40:] - columns @ np.linalg.lstsq(columns, values[40:], rcond=None)[0]
        assert np.abs(left).max() < 0.02 * np.abs(values).max()


def test_a_film_beyond_the_grid_of_the_second_surface_is_reported() -> None:
    """A shaft as long as its bore, pushed along it by two and a half cells; nodes at its end span one more."""
    found = find_equilibrium(bearing((2e3, 0.0), yielding=shaft_body()))
    assert not any("beyond the grid" in note for note in found.notes)
    cell = LENGTH / (ROWS - 1)
    for row in found.bodies["shaft"].position:
        row[1] += 2.5 * cell
    (note,) = [note for note in film_notes(found.scene, found) if "beyond the grid" in note]
    assert f"up to {1.5 * cell:.3g} m beyond the grid of shaft['rim']" in note


def test_results_load_and_deform_both(tmp_path: Path) -> None:
    """The rim of the shaft, whose nodes are the nodes' places, is pressed in by what its nodes' forces do."""
    step = TURN / 60.0
    found = run(bearing((20e3, 0.0), yielding=shaft_body()), 4 * step, step=step, start="equilibrium", progress=False)
    result = Result.load(Result(found).save(tmp_path / "run.h5"))
    film, surface = result.film("film"), shaft_body().contact_surfaces["rim"]
    loads = film.load_second
    assert loads is not None and loads.shape == (5, surface.grid.columns, surface.grid.rows)
    skin = result.skins()["shaft"]
    away, nodes = KDTree(skin.points).query(places(surface))
    assert away.max() < 1e-9
    theta, z = (v.ravel() for v in np.meshgrid(places_around(surface), surface.grid.z, indexing="ij"))
    normal = np.asarray(surface.shape.normal(theta, z))
    D = surface.compliance(np.arange(surface.grid.columns))
    for row in (0, -1):
        u = surface.mode_normal.reshape(len(theta), -1) @ found.bodies["shaft"].modal[row] - D @ loads[row].ravel()
        seen = np.sum(skin.displacement(row)[nodes] * normal, axis=1)
        assert np.abs(seen - u).max() < 0.05 * np.abs(u).max()  # nodes mean over their areas
    pressure = skin.pressure(-1)[nodes]
    assert pressure.max() == pytest.approx(film.largest_pressure[-1], rel=0.2)  # even over each node
    other = result.to_xarray()["film_load_second_film"]
    np.testing.assert_array_equal(other, loads)


def test_a_form_of_the_shaft_turns_its_torque() -> None:
    """A lobed shaft that turns in a bore: pressure pushes its lobes, and the work of its drive is what the oil takes.
    What is left over is of the steps."""
    left = []
    for part in (40, 80):
        step = TURN / part
        scene = bearing(
            (500.0, 0.0), form_b=films.LobedForm(4e-6, 2), ambient_pressure=1.0, cavitation="full_sommerfeld", feeds=[]
        )
        found = run(scene, TURN, step=step, progress=False)
        assert found.status == "completed", found.message
        left.append(abs(found.energy["numerical"][-1]) / found.energy["drive_work"][-1])
    assert left[0] < 2e-3 and left[1] < 0.4 * left[0]
