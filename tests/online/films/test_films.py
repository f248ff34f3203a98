"""Oil films in the engine, compared with references that share no code with it, invariants and convergence."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from film_scenes import (
    CLEARANCE,
    COLUMNS,
    LENGTH,
    RADIUS,
    ROWS,
    SHEAR,
    SPEED,
    STEEL,
    VISCOSITY,
    Array,
    bearing,
    bore_body,
    place,
    reference,
    turning_load,
)

from references.films.grid import FilmGrid
from references.films.journal import JournalFilm
from warpffrf.model import films, forces, joints, oils, signals, surfaces
from warpffrf.model.errors import InputError
from warpffrf.model.films import Film
from warpffrf.model.integrators import GeneralizedAlpha
from warpffrf.model.laws import ExponentialAsperities, GreenwoodTripp
from warpffrf.model.mesh import box, roller
from warpffrf.model.scene import Scene
from warpffrf.offline import reduce
from warpffrf.online import run
from warpffrf.online.diagnosis.film_notes import alternation_notes, film_notes
from warpffrf.online.history.films import narrowest
from warpffrf.online.run import find_equilibrium
from warpffrf.online.vibrations.eigenmodes import find_modes

SOLVED = 1e-8  # of the flows: the iteration ends at 1e-9


# --- at rest


@pytest.mark.parametrize(
    ("load", "oil"),
    [
        (2e3, oils.Newtonian(VISCOSITY)),
        (20e3, oils.Newtonian(VISCOSITY)),
        (20e3, oils.Barus(VISCOSITY, coefficient=1.5e-8)),
        (20e3, oils.Roelands(VISCOSITY, coefficient=1.5e-8)),
    ],
    ids=["light", "heavy", "barus", "roelands"],
)
def test_a_steady_bearing_is_that_of_the_dense_reference(load: float, oil: oils.Oil) -> None:
    found = find_equilibrium(bearing((load, 0.0), oil=oil))
    assert found.status == "completed", found.message
    film, expected = found.films["film"], reference(oil)
    settled = expected.settle(np.array([0.3 * CLEARANCE, 0.0]), np.array([load, 0.0]))
    assert np.abs(place(found) - settled.state.place / CLEARANCE).max() < SHEAR
    assert film.largest_pressure[-1] == pytest.approx(settled.state.pressure.max(), rel=SHEAR)
    h = expected.gap(settled.state).min()
    assert film.smallest_gap[-1] == pytest.approx(h, rel=3.0 * SHEAR)  # the place over the smallest film


@pytest.mark.parametrize("powers", [(0, 2), (0, 1, 2)])
def test_profiles_along_are_those_of_the_dense_reference(powers: tuple[int, ...]) -> None:
    """Of quadrature "reduced", compared with the same ones there and compared with all nodes."""
    found = find_equilibrium(bearing((20e3, 0.0), quadrature="reduced", axial_degrees=powers))
    assert found.status == "completed", found.message
    film, expected = found.films["film"], reference(powers=powers)
    settled = expected.settle(np.array([0.3 * CLEARANCE, 0.0]), np.array([20e3, 0.0]))
    assert np.abs(place(found) - settled.state.place / CLEARANCE).max() < SHEAR
    largest = (expected.basis.to_nodes @ settled.state.pressure).max()
    assert film.largest_pressure[-1] == pytest.approx(largest, rel=SHEAR)
    at_nodes = expected.gap_at_nodes(settled.state).reshape(1, COLUMNS, ROWS)  # the ends with them
    assert film.smallest_gap[-1] == pytest.approx(narrowest(at_nodes, periodic=True)[0], rel=3.0 * SHEAR)
    grid_nodes = find_equilibrium(bearing((20e3, 0.0)))  # of few rows
    assert np.abs(place(found) - place(grid_nodes)).max() < 0.01
    assert film.largest_pressure[-1] == pytest.approx(grid_nodes.films["film"].largest_pressure[-1], rel=0.06)


def test_a_groove_under_pressure_feeds_profiles_too() -> None:
    feeds = [films.AxialGroove(np.pi, 1e-4, 3e5)]
    grid_nodes, strips = (
        find_equilibrium(bearing((2e3, 0.0), feeds=feeds, quadrature=e, axial_degrees=(0, 2, 4)))
        for e in ("full", "reduced")
    )
    np.testing.assert_allclose(place(strips), place(grid_nodes), atol=0.01)
    column, other = (found.films["film"].pressure[-1, COLUMNS // 2] for found in (grid_nodes, strips))
    assert other[0] == other[-1] == 0.0
    assert other[1:-1].mean() == pytest.approx(column[1:-1].mean(), rel=0.1)  # a constant, by three powers
    assert np.isnan(strips.films["film"].feed_flow).all()


@pytest.mark.parametrize("speed", [300.0, 30.0, 3.0])
def test_asperities_carry_what_the_film_does_not(speed: float) -> None:
    """Compared with the dense reference, from a film that carries to dry contact; no more iterations than there."""
    law = ExponentialAsperities(2e9, 0.2e-6, 2.8e-6)
    found = find_equilibrium(bearing((60e3, 0.0), speed=speed, mixed=films.MixedLubrication(law)))
    assert found.status == "completed", found.message
    film, expected = found.films["film"], reference(asperities=law.curve, speed=speed)
    settled = expected.settle(np.array([0.3 * CLEARANCE, 0.0]), np.array([60e3, 0.0]))
    by_asperities = np.abs(expected.force(settled.state)[1]).max() / 60e3
    assert by_asperities > {300.0: 0.005, 30.0: 0.3, 3.0: 0.9}[speed]
    assert film.largest_asperity_pressure[-1] == pytest.approx(settled.state.asperity.max(), rel=0.02)
    np.testing.assert_allclose(
        film.asperity[-1].ravel(), settled.state.asperity, atol=0.02 * settled.state.asperity.max()
    )
    assert np.abs(film.eccentricity[-1] - settled.state.place).max() < 0.02 * CLEARANCE  # the sleeve moves, too
    assert found.counters["mean_iterations"] * found.counters["steps"] <= 60


@pytest.mark.parametrize("speed", [300.0, 30.0, 3.0])
def test_gaussian_asperities_carry_what_the_film_does_not(speed: float) -> None:
    """The same with the law of Greenwood and Tripp; and, nearly dry, compared with an exponential law with its pressure
    and slope where the pressure is largest."""
    law = GreenwoodTripp.from_products(0.8e-6, 0.08, 0.02, 115e9)  # 0.4 GPa at zero gap
    found = find_equilibrium(bearing((60e3, 0.0), speed=speed, mixed=films.MixedLubrication(law)))
    assert found.status == "completed", found.message
    film, expected = found.films["film"], reference(asperities=law.curve, speed=speed)
    settled = expected.settle(np.array([0.3 * CLEARANCE, 0.0]), np.array([60e3, 0.0]))
    by_asperities = np.abs(expected.force(settled.state)[1]).max() / 60e3
    assert by_asperities > {300.0: 0.02, 30.0: 0.3, 3.0: 0.9}[speed]
    largest = settled.state.asperity.max()
    np.testing.assert_allclose(film.asperity[-1].ravel(), settled.state.asperity, atol=0.02 * largest)
    assert np.abs(film.eccentricity[-1] - settled.state.place).max() < 0.02 * CLEARANCE
    assert found.counters["mean_iterations"] * found.counters["steps"] <= 60
    if speed == 3.0:
        gap = expected.gap_at_nodes(settled.state)[np.argmax(settled.state.asperity)]
        decay = float(law.pressure(gap) / law.curve.slope(-gap))
        fitted = ExponentialAsperities(float(law.pressure(gap)) * np.exp(gap / decay), decay)
        other = find_equilibrium(bearing((60e3, 0.0), speed=speed, mixed=films.MixedLubrication(fitted))).films["film"]
        assert other.largest_asperity_pressure[-1] == pytest.approx(largest, rel=0.02)
        assert other.smallest_gap[-1] == pytest.approx(film.smallest_gap[-1], abs=0.02 * law.deviation)


def test_asperities_rub() -> None:
    """With a coefficient: the torque of dry contact, and its loss, compared with the drag of the oil."""
    law, mu = ExponentialAsperities(2e9, 0.2e-6, 2.8e-6), 0.1
    smooth, rubbing = (
        find_equilibrium(bearing((60e3, 0.0), speed=3.0, mixed=films.MixedLubrication(law, f))) for f in (0.0, mu)
    )
    more = -(rubbing.films["film"].torque_second[-1][1] - smooth.films["film"].torque_second[-1][1])
    dry = mu * rubbing.films["film"].asperity_force[-1] * RADIUS
    assert more == pytest.approx(dry, rel=0.01)  # the drag changes with the place
    lost = rubbing.films["film"].friction_power[-1] - smooth.films["film"].friction_power[-1]
    assert lost == pytest.approx(3.0 * dry, rel=0.01)


def test_a_shaft_that_the_rigid_bore_would_not_hold_comes_to_rest() -> None:
    """An eccentricity above one, of a bore that yields."""
    found = find_equilibrium(bearing((60e3, 0.0)))
    assert found.status == "completed", found.message
    assert np.hypot(*place(found)) > 1.05
    assert found.films["film"].smallest_gap[-1] > 0.0


def test_oil_is_balanced_by_operators_of_their_own() -> None:
    """The flow of each node by pressures, gaps and voids of the engine, with the matrices of the verification."""
    found = find_equilibrium(bearing((20e3, 0.0)))
    film, grid = found.films["film"], bore_body().contact_surfaces["bore"].grid
    own = FilmGrid(RADIUS * (grid.theta - grid.theta[0]), grid.z, period=2.0 * np.pi * RADIUS)
    p, D = film.pressure[-1].ravel(), film.void[-1].ravel()
    assert np.all(p >= 0.0) and np.all(D >= -1e-12 * CLEARANCE) and np.all(p * D == 0.0)
    # between nodes the gap is that of a circle in a circle, with the nodes' displacement
    angle = own.at[:, 0] / RADIUS + grid.theta[0]
    journal, axis = RADIUS - CLEARANCE, film.eccentricity[-1]  # in the sleeve, which yields with its interface

    def undeformed(theta: Array) -> Array:
        point = RADIUS * np.stack([np.cos(theta), np.sin(theta)], axis=-1) - axis
        return np.hypot(*point.T) - journal

    opened = film.gap[-1].ravel() - np.repeat(undeformed(grid.theta), ROWS)
    h = undeformed(angle) + own.value @ opened
    # half of the sliding at a place of the bore, along theta: the shaft turns about its own axis
    U = 0.5 * SPEED * (RADIUS - (np.cos(angle) * axis[0] + np.sin(angle) * axis[1]))
    R = own.diffusion(h**3 / (12.0 * VISCOSITY)) @ p - own.carried(h, U)
    at_nodes = 0.5 * SPEED * (RADIUS - (np.cos(grid.theta) * axis[0] + np.sin(grid.theta) * axis[1]))
    carried = 0.5 * (at_nodes + np.roll(at_nodes, -1))[:, None] * own.long[None, :] * film.void[-1]
    R -= (carried - np.roll(carried, 1, axis=0)).ravel()
    free = np.ones((COLUMNS, ROWS), dtype=bool)
    free[:, [0, -1]] = False
    free[COLUMNS // 2] = False
    scale = np.abs(own.slope_x.T @ (own.weights * h * np.abs(U))).max()
    assert np.abs(R[free.ravel()]).max() < SOLVED * scale
    # what is recorded of the flows: all that comes in through the groove leaves at the ends, steadily
    groove = R.reshape(COLUMNS, ROWS)[COLUMNS // 2, 1:-1].sum()
    assert film.feed_flow[-1] == pytest.approx(groove, rel=1e-6, abs=SOLVED * scale)
    assert film.end_flow[-1] == pytest.approx(film.feed_flow[-1], rel=1e-5)


def test_forces_on_both_bodies_are_opposite_and_along_one_line() -> None:
    found = find_equilibrium(bearing((20e3, 1e3)))
    film = found.films["film"]
    shaft = found.bodies["shaft"].position[-1]
    sleeve_at = found.bodies["sleeve"].position[-1]
    whole = film.torque[-1] + film.torque_second[-1] + np.cross(sleeve_at - shaft, film.force[-1])
    assert np.abs(whole).max() < 1e-12 * np.abs(film.force[-1]).max()
    # about its own axis the pressure does nothing to the shaft: what is left is the power of sliding
    assert -film.torque_second[-1][1] * SPEED == pytest.approx(film.friction_power[-1] + film.pressure_loss[-1])
    np.testing.assert_allclose(film.force[-1], [20e3, 0.0, -1e3], rtol=1e-6, atol=1e-6 * 20e3)


def test_with_a_groove_where_the_film_is_thickest_both_rules_of_cavities_agree() -> None:
    """Oil reforms nowhere but at the groove: Reynolds' condition is the conserving one there."""
    feeds = [films.AxialGroove(1.25 * np.pi, 1e-4, 0.0)]  # within half a degree of the largest gap
    kept = find_equilibrium(bearing((2e3, 0.0), feeds=feeds, cavitation="jfo"))
    lost = find_equilibrium(bearing((2e3, 0.0), feeds=feeds, cavitation="reynolds"))
    np.testing.assert_allclose(place(lost), place(kept), atol=1e-3)  # of the half degree


def test_without_cavities_the_shaft_is_moved_across_the_load() -> None:
    """Sommerfeld's film: pressures that pull, and an attitude of 90 degrees."""
    found = find_equilibrium(bearing((2e3, 0.0), cavitation="full_sommerfeld", feeds=[], ambient_pressure=1.0))
    x = place(found)
    assert abs(x[0]) < 0.03 * x[1]  # deformation, and c/R of shear
    half = find_equilibrium(bearing((2e3, 0.0), cavitation="half_sommerfeld", feeds=[], ambient_pressure=1.0))
    full = find_equilibrium(bearing((2e3, 0.0)))
    assert np.hypot(*place(half)) == pytest.approx(np.hypot(*place(full)), rel=0.05)
    assert np.hypot(*x) < 0.9 * np.hypot(*place(full))


def test_the_film_may_stand_on_the_shaft() -> None:
    """A steel shaft in a rigid bore compared with a steel bore around a rigid shaft, both hardly deformed."""
    mesh = roller(RADIUS - CLEARANCE, 0.005, LENGTH, sectors=COLUMNS, layers=2, order=1, axial=ROWS - 1)
    stiff = replace(STEEL, youngs_modulus=100.0 * 210e9)
    body = reduce(
        mesh, stiff, interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()}, modes=4, cache=False,
        progress=False,
    )  # fmt: skip
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    shaft = scene.add_body(body, name="shaft", position=(0.3 * CLEARANCE, 0.0, 0.0), angular_velocity=(0.0, SPEED, 0.0))
    housing = scene.ground.surface(
        surfaces.Bore(radius=RADIUS, axis_point=(0, 0, 0), axis_direction=(0, 1, 0)), name="housing"
    )
    plane = scene.add(joints.Planar(scene.ground.at((0, 0, 0)), shaft["bore"], axis=(0, 1, 0), name="plane"))
    scene.add(joints.Drive(plane, signals.Constant(SPEED), quantity="velocity"))
    scene.add(forces.PointForce(shaft["bore"], (2e3, 0.0, 0.0)))
    film = {"oil": oils.Newtonian(VISCOSITY), "cavitation": "reynolds", "name": "film"}
    scene.add(Film(shaft["rim"], housing, **film))
    found = find_equilibrium(scene)
    assert found.status == "completed", found.message
    other = find_equilibrium(bearing((2e3, 0.0), body=bore_body(COLUMNS, 100.0 * 210e9), cavitation="reynolds"))
    np.testing.assert_allclose(place(found), place(other), atol=5e-3)  # columns stand elsewhere against the load
    assert found.films["film"].largest_pressure[-1] == pytest.approx(other.films["film"].largest_pressure[-1], rel=0.01)


# --- in motion


def test_a_steady_state_stays_and_the_ledger_closes() -> None:
    step = 2.0 * np.pi / SPEED / 60.0
    found = run(bearing((20e3, 0.0)), 30 * step, step=step, start="equilibrium", progress=False)
    assert found.status == "completed", found.message
    drift = np.ptp(found.bodies["shaft"].position, axis=0).max()
    assert drift < 1e-7 * CLEARANCE  # what the equilibrium leaves
    change = {name: float(values[-1] - values[0]) for name, values in found.energy.items()}
    assert change["drive_work"] == pytest.approx(change["damping"] - change["friction"], rel=1e-6)
    assert abs(change["numerical"]) < 1e-6 * change["drive_work"]


def test_no_oil_is_lost() -> None:
    """Its rates by BDF2 add up to what is in the film: what comes in, less what leaves, is what it has more."""
    step, steps = 2.0 * np.pi / SPEED / 60.0, 60
    scene = bearing(turning_load(step, steps), at=(0.4 * CLEARANCE, 0.4 * CLEARANCE))
    found = run(scene, steps * step, step=step, start="equilibrium", progress=False)
    assert found.status == "completed", found.message
    assert found.counters["rejected_steps"] == 0
    film, V = found.films["film"], found.films["film"].oil_volume
    inflow = film.feed_flow - film.end_flow
    rate = np.concatenate([[V[1] - V[0]], 1.5 * V[2:] - 2.0 * V[1:-1] + 0.5 * V[:-2]]) / step
    assert np.ptp(V) > 1e-3 * V[0]
    assert np.abs(rate - inflow[1:]).max() < 1e-6 * np.abs(film.end_flow).max()


def test_profiles_follow_a_load_that_turns() -> None:
    """Compared with all nodes, in as many steps; and their ledger closes as well."""
    step, steps = 2.0 * np.pi / SPEED / 60.0, 60
    found = {}
    for quadrature in ("full", "reduced"):
        scene = bearing(
            turning_load(step, steps),
            at=(0.4 * CLEARANCE, 0.4 * CLEARANCE),
            quadrature=quadrature,
            axial_degrees=(0, 2),
        )
        found[quadrature] = run(scene, steps * step, step=step, start="equilibrium", progress=False)
        assert found[quadrature].status == "completed", found[quadrature].message
        energy = found[quadrature].energy
        assert abs(energy["numerical"][-1]) < 0.01 * energy["drive_work"][-1]
    grid_nodes, strips = (found[name].films["film"].smallest_gap for name in ("full", "reduced"))
    assert np.abs(strips / grid_nodes - 1.0).max() < 0.05  # seven rows of nodes are coarse


def test_steps_are_of_second_order() -> None:
    """Of a light shaft, whose motion is the film's: halved steps leave a quarter of the error."""
    period = 2.0 * np.pi / SPEED
    ends = {}
    for steps in (15, 30, 60, 240):
        step = 0.5 * period / steps
        scene = bearing(
            turning_load(step, steps), cavitation="full_sommerfeld", feeds=[], ambient_pressure=1.0, mass=0.1
        )
        found = run(scene, 0.5 * period, step=step, start="equilibrium", progress=False)
        assert found.status == "completed", found.message
        ends[steps] = place(found)
    errors = [np.abs(ends[n] - ends[240]).max() for n in (15, 30, 60)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(orders > 1.7), (orders, errors)


def test_a_start_in_motion_has_the_pressure_of_the_squeeze() -> None:
    """A heavy shaft that is thrown into a film at rest: Reynolds' equation is linear in the velocity, and the
    acceleration that a run begins with is that of its force. (A bore that yields takes the squeeze at first.)"""
    found, mass = {}, 1e3
    for v in (1e-3, 2e-3):
        scene = bearing(
            (0.0, 0.0), body=bore_body(COLUMNS, 1e6 * 210e9), speed=0.0, velocity=(v, 0.0), at=(0.0, 0.0), mass=mass,
            cavitation="full_sommerfeld", feeds=[], ambient_pressure=1.0,
        )  # fmt: skip
        found[v] = run(scene, 1e-4, step=1e-4, progress=False)
        assert found[v].status == "completed", found[v].message
    first, second = (found[v].films["film"].force[0][0] for v in found)  # on the sleeve
    assert second == pytest.approx(2.0 * first, rel=1e-3)
    short = np.pi * VISCOSITY * RADIUS * (LENGTH / CLEARANCE) ** 3 * 1e-3  # of a short bearing, centred
    assert 0.7 * short < first < short  # that of L/D = 1/2
    assert found[1e-3].bodies["shaft"].acceleration[0][0] == pytest.approx(-first / mass, rel=1e-6)


def test_a_run_goes_on_bit_for_bit() -> None:
    step = 2.0 * np.pi / SPEED / 60.0
    scene = bearing(turning_load(step, 20))
    whole = run(scene, 20 * step, step=step, start="equilibrium", progress=False)
    half = run(scene, 10 * step, step=step, start="equilibrium", progress=False)
    rest = run(scene, 10 * step, step=step, start=half, progress=False)
    np.testing.assert_array_equal(rest.films["film"].pressure[-1], whole.films["film"].pressure[-1])
    np.testing.assert_array_equal(rest.bodies["shaft"].position[-1], whole.bodies["shaft"].position[-1])


def test_form_deviations_of_either_surface_are_where_they_are() -> None:
    """Of a bore, and of a shaft that has rotated by a quarter."""
    oval = films.LobedForm(4e-6, 2)
    flat = find_equilibrium(bearing((10.0, 0.0), ambient_pressure=1.0, cavitation="full_sommerfeld"))
    bored = find_equilibrium(bearing((10.0, 0.0), form_a=oval, ambient_pressure=1.0, cavitation="full_sommerfeld"))
    theta = bore_body().contact_surfaces["bore"].grid.theta
    opened = bored.films["film"].gap[-1].mean(axis=1) - flat.films["film"].gap[-1].mean(axis=1)
    part = np.array([np.cos(2.0 * theta), np.sin(2.0 * theta)]) @ opened * 2.0 / COLUMNS
    np.testing.assert_allclose(part, [4e-6, 0.0], atol=4e-8)  # displacements by what pressures change
    step = 0.5 * np.pi / SPEED / 20.0
    scene = bearing((10.0, 0.0), form_b=oval, ambient_pressure=1.0, cavitation="full_sommerfeld")
    turned = run(scene, 20 * step, step=step, progress=False)
    assert turned.status == "completed", turned.message
    for row, sign in ((0, 1.0), (-1, -1.0)):
        opened = turned.films["film"].gap[row].mean(axis=1)
        part = np.array([np.cos(2.0 * theta), np.sin(2.0 * theta)]) @ opened * 2.0 / COLUMNS
        np.testing.assert_allclose(part, [sign * 4e-6, 0.0], atol=1e-7)


# --- small motions


@pytest.mark.parametrize("share", [0.85, 1.15])
def test_whirl_is_that_of_the_coefficients_of_a_rigid_film(share: float) -> None:
    """Eight coefficients of a film that is kept wet where it is widest, so that no void moves anything, and a mass on
    either side of the threshold: eigenvalues of the engine's modes compared with those of M, C, K (2, 2)."""
    groove = films.AxialGroove(np.radians(247.5), 1e-4, 0.0)
    body = bore_body(COLUMNS, 1e3 * 210e9)
    at = place(find_equilibrium(bearing((2e3, 0.0), body=body, feeds=[groove]))) * CLEARANCE
    rigid = JournalFilm(RADIUS, LENGTH, CLEARANCE, VISCOSITY, SPEED, COLUMNS, ROWS, feeds=(22,))
    K, C = rigid.coefficients(at, rigid.steady(at))
    k = (K[0, 0] * C[1, 1] + K[1, 1] * C[0, 0] - K[0, 1] * C[1, 0] - K[1, 0] * C[0, 1]) / np.trace(C)
    square = ((K[0, 0] - k) * (K[1, 1] - k) - K[0, 1] * K[1, 0]) / np.linalg.det(C)  # of the whirl at the threshold
    mass = share * k / square
    expected = np.linalg.eigvals(np.block([[np.zeros((2, 2)), np.eye(2)], [-K / mass, -C / mass]]))
    expected: Any = np.sort_complex(expected[expected.imag > 0.0])
    modes = find_modes(bearing((2e3, 0.0), body=body, feeds=[groove], mass=mass), 6)
    found: Any = np.sort_complex(modes.eigenvalues[:2])
    assert np.abs(found - expected).max() < 1e-3 * SPEED  # c/R, of shear that the coefficients leave out
    assert (found.real.max() > 0.0) == (share > 1.0)
    assert np.abs(modes.eigenvalues[2:]).min() > 10.0 * np.abs(expected).max()  # the sleeve, and nothing of the oil
    assert any("oil films keep their cavities" in note for note in modes.notes)


def test_modes_are_what_a_small_disturbance_does() -> None:
    """With voids that travel: rates of decay and whirl of a shaft that is pushed, in steps of one degree."""
    mass, speed = 20.0, 1e-4
    (first, second), step = find_modes(bearing((2e3, 0.0), mass=mass), 2).eigenvalues, np.radians(1.0) / SPEED
    steps = 240
    runs = [
        run(bearing((2e3, 0.0), mass=mass, velocity=v), steps * step, step=step, start="equilibrium", progress=False)
        for v in ((0.0, 0.0), (speed, 0.0))
    ]
    x = runs[1].bodies["shaft"].position[:, [0, 2]] - runs[0].bodies["shaft"].position[:, [0, 2]]
    basis: Any = [np.exp(root * runs[0].time) for root in (first, second) if root.imag > 0.0]
    columns = [part for e in basis for part in (e.real, e.imag)]
    columns += [np.exp(root.real * runs[0].time) for root in (first, second) if root.imag == 0.0]
    late = slice(40, None)  # motions of oil alone have died away
    for values in x.T:
        coefficients = np.linalg.lstsq(np.array(columns).T[late], values[late], rcond=None)[0]
        left = values[late] - np.array(columns).T[late] @ coefficients
        assert np.abs(left).max() < 0.02 * np.abs(values).max()


def test_modes_do_not_depend_on_the_start_or_on_how_stiff_a_stiff_bore_is() -> None:
    """Voids that travel are a chain, whose eigenvalues are not to be had of a matrix: none of it may get into a mode.
    Compared with a run after a push, in which oil has come around once before its decay is taken."""
    mass, step = 60.0, np.radians(1.5) / SPEED
    found = [
        find_modes(bearing((2e3, 0.0), body=bore_body(COLUMNS, E), mass=mass, at=(c * CLEARANCE, s * CLEARANCE)), 3)
        for E, (c, s) in ((210e12, (0.2, 0.1)), (210e12, (-0.1, 0.4)), (21e12, (-0.1, 0.4)))
    ]
    rigid, again, less = (modes.eigenvalues for modes in found)
    np.testing.assert_allclose(again, rigid, rtol=1e-6)
    np.testing.assert_allclose(less[0], rigid[0], rtol=2e-3)  # a steel bore, 100 times softer still, changes 5 %
    assert max(value.real for modes in found for value in modes.eigenvalues) < -150.0
    pushed = bearing((2e3, 0.0), body=bore_body(COLUMNS, 210e12), mass=mass, velocity=(1e-5, 0.0))
    ran = run(pushed, 440 * step, step=step, start="equilibrium", progress=False)
    late = np.diff(ran.bodies["shaft"].position[220::10, [0, 2]], axis=0)  # about wherever it rests
    a, b = np.linalg.lstsq(np.stack([late[1:-1].ravel(), late[:-2].ravel()], axis=1), late[2:].ravel(), rcond=None)[0]
    decay = np.log(max(np.roots([1.0, -a, -b]), key=np.imag)) / (10.0 * step)
    assert abs(decay - rigid[0]) < 4e-3 * abs(decay)  # shear that is left out, c/R, and steps of 1.5 degrees


# --- planes


def test_a_pad_that_slides_on_a_wedge_of_oil() -> None:
    """Compared with the same Reynolds equation by matrices of the verification, with a grid that ends on all sides."""
    mesh = box((0.04, 0.04, 0.01), (16, 8, 2))
    body = reduce(
        mesh, replace(STEEL, youngs_modulus=1e5 * 210e9), interfaces={"z_min": "rigid"},
        contact={"z_max": surfaces.Plane()}, modes=2, cache=False, progress=False,
    )  # fmt: skip
    port = body.contact_surfaces["z_max"]
    grid, shape = port.grid, port.shape
    low, tilt, speed = 20e-6, 1e-3, 5.0
    form = films.MeasuredForm(
        grid.theta, grid.z, np.broadcast_to(tilt * (grid.theta - grid.theta[0])[:, None], (grid.columns, grid.rows)),
        periodic=False,
    )  # fmt: skip
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    pad = scene.add_body(body, name="pad")
    scene.add(joints.Fixed(scene.ground, pad["z_min"], axis=(0, 0, 1), name="held"))
    along = np.asarray(shape.e_1)
    runner = scene.add_rigid_body(
        1.0, (1, 1, 1), name="runner", velocity=tuple(-speed * along),
        surfaces={"face": surfaces.Plane(origin=(0, 0, 0.01 + low), outward=(0, 0, -1), direction=(0, 1, 0))},
    )  # fmt: skip
    guide = scene.add(joints.Prismatic(scene.ground, runner.at((0, 0, 0)), axis=tuple(along), name="guide"))
    scene.add(joints.Drive(guide, signals.Constant(-speed), quantity="velocity"))
    origin = np.asarray(shape.axis_point)
    top = float(origin[2])
    scene.add(
        Film(
            pad["z_max"], runner["face"], oil=oils.Newtonian(VISCOSITY), ambient_pressure=1.0, form_a=form, name="film"
        )
    )
    found = find_equilibrium(scene)
    assert found.status == "completed", found.message
    own = FilmGrid(grid.theta - grid.theta[0], grid.z)
    h = 0.01 + low - top + tilt * own.at[:, 0]
    A = own.diffusion(h**3 / (12.0 * VISCOSITY)).toarray()
    right = own.carried(h, -0.5 * speed)
    free = np.zeros((grid.columns, grid.rows), dtype=bool)
    free[1:-1, 1:-1] = True
    p = np.where(free, 0.0, 1.0).ravel()
    inside = free.ravel()
    p[inside] = np.linalg.solve(A[np.ix_(inside, inside)], right[inside] - A[np.ix_(inside, ~inside)] @ p[~inside])
    assert p.min() > 0.0  # no cavity
    np.testing.assert_allclose(found.films["film"].pressure[-1].ravel(), p, rtol=1e-4)  # of what the pad yields
    force = float(own.integral(np.ones(len(own.weights))) @ p)
    assert abs(found.films["film"].force[-1][2]) == pytest.approx(force, rel=1e-4)


def test_a_load_that_no_film_carries_is_reported() -> None:
    found = find_equilibrium(bearing((90e3, 0.0)))
    assert found.status == "no_equilibrium"
    assert found.message.startswith("equilibrium: film 'film' is squeezed to")
    assert (
        "give it more speed" in found.message
        and "mixed=films.MixedLubrication(laws.ExponentialAsperities" in found.message
    )


def test_a_film_without_sliding_is_reported_to_carry_nothing_at_rest() -> None:
    """It is no mechanism, and no spring is the cure."""
    found = find_equilibrium(bearing((2e3, 0.0), speed=0.0, quadrature="reduced", axial_degrees=(0, 2)))
    assert found.status == "no_equilibrium" and not len(found.time)
    assert found.message.startswith("equilibrium: film 'film' is squeezed to")
    assert "nothing slides and it carries no load at rest" in found.message and "a velocity" in found.message


def test_a_half_film_says_that_its_ledger_does_not_close() -> None:
    step, steps = 2.0 * np.pi / SPEED / 60.0, 30
    scene = bearing(turning_load(step, steps), feeds=[], ambient_pressure=1.0, cavitation="half_sommerfeld")
    found = run(scene, steps * step, step=step, start="equilibrium", progress=False)
    assert found.status == "completed", found.message
    assert any("the ledger does not close" in note for note in found.notes)


# --- notes


def test_columns_too_coarse_for_the_smallest_film_are_reported() -> None:
    """The rule at 128 columns and an eccentricity of 0.9 says what nodes compared with fine volumes have there."""
    found = find_equilibrium(bearing((20e3, 0.0)))
    (note,) = [n for n in found.notes if "too thin for columns" in n]
    assert "film 'film'" in note and "too thin for columns of 11.2 degrees" in note and "columns per revolution" in note
    scene = bearing((2e3, 0.0))
    gap = np.full((1, COLUMNS, ROWS), CLEARANCE)
    history: Any = SimpleNamespace(films={"film": SimpleNamespace(smallest_gap=np.array([0.1 * CLEARANCE]), gap=gap)})
    (note,) = film_notes(scene, history)
    pitch = 2.0 * np.pi / COLUMNS
    told = float(re.search(r"an error of ([0-9.]+)%", note).group(1))  # pyright: ignore[reportOptionalMemberAccess]
    assert told * (COLUMNS / 128.0) ** 2 == pytest.approx(0.43, abs=0.02)  # docs/studies/oil_film.md: 0.46 % at most
    assert told == pytest.approx(100.0 * 0.01 * (6.0 * pitch) ** 2 / 0.2, abs=0.05)
    history.films["film"].smallest_gap = np.array([0.9 * CLEARANCE])
    assert not film_notes(scene, history)
    gap[0, 3, 0] = -1e-6
    (note,) = film_notes(scene, history)
    assert "its walls overlap by up to 1e-06 m at theta = 0.589, z = -0.0125 m" in note and "films.BarrelForm" in note
    assert "GeneralizedAlpha(0.5)" in alternation_notes(scene, GeneralizedAlpha())[0]
    assert not alternation_notes(scene, GeneralizedAlpha(0.5)) and not alternation_notes(Scene(), GeneralizedAlpha())
    assert not film_notes(scene, SimpleNamespace(films={}))  # pyright: ignore[reportArgumentType]


# --- refusals


def test_what_films_do_not_do_is_refused() -> None:
    with pytest.raises(InputError, match=r"film 'film': .*overlap at the start by .*move a body"):
        find_equilibrium(bearing(at=(1.1 * CLEARANCE, 0.0)))
