"""The online check of films of quadrature "reduced" compared with runs with all nodes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from scenes.film_bearing import CLEARANCE, GROOVE, LENGTH, RADIUS, SPEED, TURN, VISCOSITY, Load, bearing, bore
from studies.films.film_acceptance import FACE, above, of_x, plate, sliding
from warpffrf.model import films, joints, oils, signals, surfaces
from warpffrf.model.films import Film
from warpffrf.model.scene import Scene
from warpffrf.online import History, run
from warpffrf.online.diagnosis.film_notes import SAMPLED, FilmCheck
from warpffrf.online.history.films import narrowest
from warpffrf.online.run import find_equilibrium
from warpffrf.output.budget.contacts import film_lines

GRID_NODES = (32, 17)
SAME = 2e-3  # of a quantity: two iterations that end at 1e-4 of the pressure, and a load that shear carries c/R of
OF_FLOWS = 5e-3  # what the place under a load that differs, and the end of the iteration, make of flows

Array = np.ndarray


def found(scene: Scene) -> History:
    history = find_equilibrium(scene)
    assert history.status == "completed", history.message
    return history


def compared(full: History, reduced: History) -> tuple[float, float]:
    """What all nodes change of the smallest gap at nodes, and of the largest pressure, in the last row."""
    a, b = full.films["film"], reduced.films["film"]
    least = narrowest(a.gap[-1:], periodic=True)[0]
    return float(least / b.smallest_gap[-1] - 1.0), float(a.largest_pressure[-1] / b.largest_pressure[-1] - 1.0)


@pytest.mark.parametrize(("load", "powers"), [(2e3, (0,)), (20e3, (0, 2)), (20e3, (0, 2, 4)), (60e3, (0, 2, 4))])
def test_the_check_of_an_equilibrium_is_what_all_nodes_change(load: float, powers: tuple[int, ...]) -> None:
    """Of another equilibrium, with the shaft where the load moves it."""
    full, reduced = (
        found(bearing(bore(GRID_NODES), (load, 0.0), feeds=[GROOVE], quadrature=e, axial_degrees=powers))
        for e in ("full", "reduced")
    )
    check: FilmCheck = reduced.film_checks["film"]
    gap, pressure = compared(full, reduced)
    assert check.gaps[0] == pytest.approx(gap, abs=SAME)
    assert check.pressures[0] == pytest.approx(pressure, abs=SAME)
    assert check.feed_flow[0] == pytest.approx(full.films["film"].feed_flow[-1], rel=OF_FLOWS + check.force)
    assert check.end_flow[0] == pytest.approx(check.feed_flow[0], rel=OF_FLOWS)
    assert not full.film_checks
    (note,) = [n for n in reduced.notes if "compared with all nodes in 1 states" in n]
    assert f"{check.gap:.2%} of the smallest gap and {check.pressure:.2%} of the largest pressure" in note
    assert ("or quadrature='full'" in note) == check.too_large


def tilted(tilt: float, **film: Any) -> Scene:
    """A shaft at half the clearance whose axis leans by `tilt` [rad] in the plane of that, and turns about itself."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    held = scene.add_body(bore(GRID_NODES), name="sleeve")
    scene.add(joints.Fixed(scene.ground, held["outside"], axis=(0, 1, 0), name="held"))
    axis = (np.sin(tilt), np.cos(tilt), 0.0)
    place = (0.5 * CLEARANCE, 0.0, 0.0)
    journal = surfaces.Cylinder(radius=RADIUS - CLEARANCE, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    shaft = scene.add_rigid_body(
        1.0, (1e-3, 1e-3, 1e-3), name="shaft", position=place, surfaces={"journal": journal},
        rotation=(0.0, 0.0, -np.sin(0.5 * tilt), np.cos(0.5 * tilt)),
        angular_velocity=tuple(SPEED * np.array(axis)),
    )  # fmt: skip
    joint = scene.add(joints.Revolute(scene.ground.at(place), shaft.at((0, 0, 0)), axis=axis, name="axis"))
    scene.add(joints.Drive(joint, signals.Constant(SPEED), quantity="velocity", name="speed"))
    scene.add(Film(held["bore"], shaft["journal"], oil=oils.Newtonian(VISCOSITY), feeds=[GROOVE], name="film", **film))
    return scene


def test_a_shaft_that_tilts_needs_odd_powers() -> None:
    """By a quarter of the clearance at each end: with even powers, however many, the check says that the film is
    another, with odd ones it finds a fraction of that. The shaft is held where it is."""
    tilt = 0.25 * CLEARANCE / (0.5 * LENGTH)
    full = found(tilted(tilt))
    wrong = {}
    for powers in ((0, 2, 4), (0, 1, 2)):
        reduced = found(tilted(tilt, quadrature="reduced", axial_degrees=powers))
        check = reduced.film_checks["film"]
        gap, pressure = compared(full, reduced)
        assert check.held_gaps[0] == pytest.approx(gap, abs=SAME)
        assert check.held_pressures[0] == pytest.approx(pressure, abs=SAME)
        wrong[powers] = check
    even, odd = wrong[0, 2, 4], wrong[0, 1, 2]
    assert even.too_large and even.force > 0.1 and even.pressure > 0.1
    assert "odd ones too where the shaft tilts" in even.note(
        tilted(tilt, quadrature="reduced", axial_degrees=(0, 2)).films[0]
    )
    assert odd.force < 0.1 * even.force and abs(odd.held_pressures[0]) < 0.1 * abs(even.held_pressures[0])


def test_a_film_that_nearly_closes_at_its_ends_needs_more_powers() -> None:
    """60 kN press the ends of the film shut: two powers miss that, three nearly do not, and one finds a film where
    there is none."""
    gaps = {}
    for powers in ((0, 2), (0, 2, 4), (0,)):
        scene = bearing(bore((64, 17)), (60e3, 0.0), feeds=[GROOVE], quadrature="reduced", axial_degrees=powers)
        history = found(scene)
        gaps[powers] = history.film_checks["film"]
        (note,) = [n for n in history.notes if "quadrature 'reduced', axial_degrees" in n]
        assert "or quadrature='full'" in note
    assert gaps[0, 2].gap > 20.0 * gaps[0, 2, 4].gap and gaps[0, 2, 4].gap < 0.01
    assert gaps[0, 2].too_large and gaps[0, 2, 4].too_large  # the force where the shaft is: 0.5 and 1.8 %
    assert gaps[0,].missed == 1 and gaps[0,].too_large and np.isnan(gaps[0,].gap)
    lines = film_lines(find_equilibrium(bearing(bore(GRID_NODES), (2e3, 0.0), feeds=[GROOVE], quadrature="reduced")))
    assert [line.of for line in lines] == [
        f"{of} of film 'film'" for of in ("force", "smallest gap", "largest pressure")
    ]
    assert all(line.found and line.size < 0.02 for line in lines)


def test_states_of_a_run_are_looked_at_where_it_was() -> None:
    """A light shaft under a load that turns, compared with a run with all nodes at the same times. The check moves the
    shaft at the velocity that it has, and knows nothing of the time before: what it finds is of the size of what
    differs."""
    steps, load, histories = 60, 5e3, {}
    step = TURN / 60.0
    t = step * np.arange(-20, steps + 21)
    along, across = (
        Load(t, load * f(0.25 * SPEED * t), cubic=True) for f in (np.cos, np.sin)
    )  # fmt: skip
    for quadrature in ("full", "reduced"):
        scene = bearing(
            bore(GRID_NODES), (along, across), mass=1e-3, feeds=[GROOVE], quadrature=quadrature, axial_degrees=(0,)
        )  # fmt: skip
        histories[quadrature] = run(scene, steps * step, step=step, start="equilibrium", progress=False)
        assert histories[quadrature].status == "completed", histories[quadrature].message
    check: FilmCheck = histories["reduced"].film_checks["film"]
    assert 3 <= len(check.time) <= SAMPLED and check.missed == 0
    full, reduced = (history.films["film"] for history in histories.values())
    rows = [int(np.argmin(np.abs(histories["reduced"].time - time))) for time in check.time]
    gap = narrowest(full.gap[rows], periodic=True) / reduced.smallest_gap[rows] - 1.0
    pressure = full.largest_pressure[rows] / reduced.largest_pressure[rows] - 1.0
    print(np.round(gap, 4), np.round(check.gaps, 4), np.round(pressure, 4), np.round(check.pressures, 4))
    for real, told in ((gap, check.gaps), (pressure, check.pressures)):
        assert 0.5 * np.abs(real).max() < np.abs(told).max() < 2.0 * np.abs(real).max()


def test_a_pad_is_looked_at_too() -> None:
    """A plane, which does not go around: a square slider in its place, where all nodes change what the check finds."""
    length, low, speed = 0.02, 20e-6, 1.0
    body, states = plate(length, length, (24, 12)), {}
    for quadrature in ("full", "reduced"):
        form = of_x(body, lambda x: low * (0.5 - x / length))
        scene, guide = above(
            body, FACE, height=low, velocity=(speed, 0, 0), cavitation="full_sommerfeld", form_a=form,
                quadrature=quadrature,
            axial_degrees=(0,), feeds=[films.AxialGroove(-0.5 * length, 1e-4, 0.0)],
        )  # fmt: skip
        states[quadrature] = sliding(scene, guide, speed)
    full, reduced = (history.films["film"] for history in states.values())
    check: FilmCheck = states["reduced"].film_checks["film"]
    pressure = float(full.largest_pressure[-1] / reduced.largest_pressure[-1] - 1.0)
    force = float(np.linalg.norm(full.force[-1] - reduced.force[-1]) / np.linalg.norm(reduced.force[-1]))
    assert check.held_pressures[0] == pytest.approx(pressure, abs=SAME)
    assert check.force == pytest.approx(force, abs=SAME)
    assert abs(pressure) > 5.0 * SAME  # one profile is few
    assert check.held_gaps[0] == pytest.approx(0.0, abs=1e-6)
