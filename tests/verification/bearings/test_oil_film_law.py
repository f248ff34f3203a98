"""The law of films alone, on nodes, compared with closed forms, quadrature and finite volumes."""

from __future__ import annotations

import numpy as np
import pytest

from references.closed_forms.cavitation import PartingPlates, ruptured_slider
from references.closed_forms.films import (
    HALF_CYLINDER,
    REYNOLDS_CYLINDER,
    JournalBearing,
    falling_time,
    plane_slider,
    short_bearing_coefficients,
    squeezed_disc,
    squeezed_plate,
    stability_threshold,
)
from references.films.finite_volumes import steady_journal
from references.films.journal import JournalFilm
from references.films.pads import pad, square_plate
from references.films.pads import plates as film_plates
from studies.films import oil_film
from warpffrf.model.errors import InputError

RADIUS, CLEARANCE, VISCOSITY, SPEED = 0.025, 25e-6, 0.01, 300.0  # m, m, Pa s, rad/s
ROUND_OFF = 1e-9
PUBLISHED = 1e-6  # digits of the tables of the closed forms
LONG = 2e-3  # of the force of a long bearing on 128 columns at an eccentricity of 0.9: 1.4e-3 measured
SHORT = 0.02  # of a short one of L/D 0.02 on 9 rows: the parabola along the axis, and end flow that goes around
FINE = (
    # of force and peak on 128 x 17 shape functions compared with 360 x 64 volumes; 4 to 6e-3 measured, of second order
    7e-3
)
FINE_ATTITUDE = np.radians(0.1)
FRONT = 0.06  # of a threshold of stability: the film of the short bearing ends between two columns


def journal(length: float, columns: int, rows: int, **options) -> JournalFilm:
    return JournalFilm(RADIUS, length, CLEARANCE, VISCOSITY, SPEED, columns, rows, **options)


@pytest.mark.parametrize(
    ("eccentricity", "long", "short", "attitude"),
    [(0.2, 3.772205, 0.1725467, 75.4312), (0.5, 9.673597, 0.7503811, 53.6802), (0.8, 19.039955, 5.731328, 30.5002)],
)
def test_closed_forms_are_those_of_the_tables(eccentricity, long, short, attitude) -> None:
    unit = JournalBearing(1.0, 1.0, 1.0, 1.0, 1.0)
    assert unit.long(eccentricity) == pytest.approx(long, rel=PUBLISHED)
    load, angle = unit.short(eccentricity)
    assert load == pytest.approx(short, rel=PUBLISHED)
    assert np.degrees(angle) == pytest.approx(attitude, abs=1e-3)


def test_other_closed_forms() -> None:
    assert plane_slider(2.188705, 1.0, 1.0, viscosity=1.0, speed=1.0) == pytest.approx(0.1602431, rel=PUBLISHED)
    assert squeezed_plate(1.0, 1e3) / 1e3 == pytest.approx(1.0, rel=2e-3)  # ends of the long plate, 1e-3 of its length
    assert squeezed_disc(2.0) == pytest.approx(24.0 * np.pi, rel=ROUND_OFF)
    assert falling_time(2.0, 3.0, 5.0, 1.0, 0.5) == pytest.approx(5.0, rel=ROUND_OFF)
    with pytest.raises(InputError, match="narrow"):
        plane_slider(1.0, 2.0, 1.0, viscosity=1.0, speed=1.0)
    with pytest.raises(InputError, match="eccentricity"):
        JournalBearing(1.0, 1.0, 1.0, 1.0, 1.0).long(1.0)


def test_coefficients_of_the_short_bearing_are_derivatives_of_its_forces() -> None:
    """By place and speed in fixed axes, central differences."""
    unit, rest, step = JournalBearing(1.0, 1.0, 1.0, 1.0, 1.0), np.array([0.5, 0.0]), 1e-6

    def force(place: np.ndarray, speed: np.ndarray) -> np.ndarray:
        e = float(np.hypot(*place))
        along = place / e
        across = np.array([-along[1], along[0]])
        F = unit.short_forces(e, float(speed @ along), float(speed @ across) / e)
        return F[0] * along + F[1] * across

    load, none = unit.short(0.5)[0], np.zeros(2)
    K, D = short_bearing_coefficients(0.5)
    for k, d in enumerate(np.eye(2)):
        by_place = (force(rest - step * d, none) - force(rest + step * d, none)) / (2.0 * step)
        by_speed = (force(rest, -step * d) - force(rest, step * d)) / (2.0 * step)
        assert np.allclose(K[:, k], by_place / load, rtol=1e-7, atol=1e-8)
        assert np.allclose(D[:, k], by_speed / load, rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize("eccentricity", [0.2, 0.5, 0.8, 0.9])
def test_a_long_bearing(eccentricity: float) -> None:
    """Two rows whose ends are not held; one column is, as only slopes of the pressure are determined."""
    film = journal(1.0, 128, 2, mode="full_sommerfeld")
    film.held[:] = False
    film.held[:2] = True
    force = film.force(film.steady(np.array([eccentricity * CLEARANCE, 0.0])))
    closed = JournalBearing(RADIUS, 1.0, CLEARANCE, VISCOSITY, SPEED * RADIUS).long(eccentricity)
    assert np.hypot(*force) == pytest.approx(closed, rel=LONG)
    assert abs(force[0]) < LONG * closed  # across the line of centres


@pytest.mark.parametrize("eccentricity", [0.2, 0.5, 0.8])
def test_a_short_bearing(eccentricity: float) -> None:
    length = 0.02 * 2.0 * RADIUS
    film = journal(length, 128, 9, mode="reynolds")
    force = film.force(film.steady(np.array([eccentricity * CLEARANCE, 0.0])))
    load, attitude = JournalBearing(RADIUS, length, CLEARANCE, VISCOSITY, SPEED * RADIUS).short(eccentricity)
    assert np.hypot(*force) == pytest.approx(load, rel=SHORT)
    assert np.arctan2(force[1], -force[0]) == pytest.approx(attitude, abs=SHORT)


@pytest.mark.parametrize("ratio", [0.5, 1.0])
@pytest.mark.parametrize("eccentricity", [0.2, 0.8])
def test_a_finite_bearing_compared_with_finite_volumes(ratio: float, eccentricity: float) -> None:
    length = ratio * 2.0 * RADIUS
    film = journal(length, 128, 17, mode="reynolds")
    state = film.steady(np.array([eccentricity * CLEARANCE, 0.0]))
    force = film.force(state)
    volumes = steady_journal(
        RADIUS, length, CLEARANCE, VISCOSITY, SPEED, eccentricity, columns=240, rows=48, mode="reynolds"
    )
    assert np.hypot(*force) == pytest.approx(volumes.load, rel=FINE)
    assert np.arctan2(force[1], -force[0]) == pytest.approx(volumes.attitude, abs=FINE_ATTITUDE)
    assert state.pressure.max() == pytest.approx(volumes.largest, rel=FINE)


def test_mass_is_conserved_as_in_finite_volumes() -> None:
    """With a feed where the film is widest: the void behind the rupture is carried there."""
    eccentricity, length = 0.6, 0.5 * 2.0 * RADIUS
    film = journal(length, 128, 17, feeds=(64,))
    state = film.steady(np.array([eccentricity * CLEARANCE, 0.0]))
    force = film.force(state)
    volumes = steady_journal(
        RADIUS, length, CLEARANCE, VISCOSITY, SPEED, eccentricity, columns=240, rows=48, mode="jfo",
        feed=np.pi,
    )  # fmt: skip
    assert state.void.max() > 0.0
    assert np.hypot(*force) == pytest.approx(volumes.load, rel=FINE)
    assert np.arctan2(force[1], -force[0]) == pytest.approx(volumes.attitude, abs=FINE_ATTITUDE)


def test_torques_balance_and_losses_are_the_power() -> None:
    film = journal(0.025, 64, 9, feeds=(32,))
    place = np.array([0.6, 0.2]) * CLEARANCE
    state = film.steady(place)
    force = film.force(state)
    on_shaft, on_bore = film.torques(place, state)
    # the film is at rest: its forces at the places of both centres add up to nothing
    assert on_shaft + on_bore == pytest.approx(-(place[0] * force[1] - place[1] * force[0]), rel=ROUND_OFF)
    assert -on_shaft * SPEED == pytest.approx(sum(film.losses(place, state)), rel=1e-6)  # void that refills: 2e-8


# --- pads


def test_a_plane_slider() -> None:
    found = pad(lambda x: 2.0 - x, np.linspace(0.0, 1.0, 65), speed=1.0, mode="full_sommerfeld")
    assert found.force == pytest.approx(plane_slider(2.0, 1.0, 1.0, viscosity=1.0, speed=1.0), rel=1e-3)


def test_a_slider_that_ruptures_and_fills_again() -> None:
    length, narrow, wide, speed, viscosity, outlet = 76.2e-3, 25.4e-6, 50.8e-6, 4.57, 0.04, 0.336e6

    def gap(x):
        return narrow + (wide - narrow) * (2.0 * x / length - 1.0) ** 2

    exact = ruptured_slider(
        gap, length, 0.5 * length, viscosity=viscosity, speed=speed, inlet=0.0, outlet=outlet
    )  # fmt: skip
    assert exact.rupture / length == pytest.approx(0.67893, abs=5e-6)
    assert exact.refill / length == pytest.approx(0.97657, abs=5e-6)
    assert exact.force == pytest.approx(104250.0, rel=1e-5)
    x = np.linspace(0.0, length, 129)
    found = pad(gap, x, speed=speed, mode="jfo", viscosity=viscosity, ends=(0.0, outlet))
    void = np.flatnonzero(found.void > 0.0)
    assert found.force == pytest.approx(exact.force, rel=5e-4)
    assert x[void[0]] == pytest.approx(exact.rupture, abs=x[1])
    assert x[void[-1]] == pytest.approx(exact.refill, abs=x[1])
    assert found.inflow[0] == pytest.approx(exact.flux, rel=1e-4)
    assert sum(found.inflow) == pytest.approx(0.0, abs=ROUND_OFF * exact.flux)


@pytest.mark.parametrize(("mode", "closed"), [("reynolds", REYNOLDS_CYLINDER), ("half_sommerfeld", HALF_CYLINDER)])
def test_a_cylinder_on_a_plane(mode: str, closed: float) -> None:
    """The inlet is cut at 13 root(2 R h_0), which is 1.4 to 1.9 % of the force."""
    t = np.linspace(-1.0, 1.0, 201)
    x = 13.0 * np.sqrt(2e-3) * np.sign(t) * np.abs(t) ** 2.5
    found = pad(lambda x: 1e-3 + 0.5 * x**2, x, speed=2.0, mode=mode)
    assert found.force * 1e-3 == pytest.approx(closed, rel=0.02)


def test_a_square_plate_is_squeezed() -> None:
    errors = [square_plate(n) / squeezed_plate(1.0, 1.0) - 1.0 for n in (16, 32)]
    assert abs(errors[1]) < 2e-3
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)  # of second order


def test_plates_that_part_and_meet() -> None:
    """The largest cavity within a cell, its collapse within a step."""
    plates = PartingPlates(5e-3, 25e-6, 10e-6, 0.02, 0.015, 1e5)
    time, half = plates.cavity()
    assert half.max() / plates.half_width == pytest.approx(0.6614, abs=5e-5)
    assert time[-1] / plates.period == pytest.approx(1.1782, abs=5e-5)
    cells, steps = 100, 400
    found = film_plates(plates, cells, steps)
    assert found.cavity.max() == pytest.approx(half.max(), abs=plates.half_width / cells)
    assert found.time[found.cavity > 0.0][-1] == pytest.approx(time[-1], abs=1.5 * plates.period / steps)


# --- motion


@pytest.mark.slow
def test_a_load_that_turns_is_a_steady_one_at_another_speed() -> None:
    """Whirl speed w and shaft speed omega: as at |omega - 2 w| under a load that stands."""
    grid_nodes = (32, 7)
    found, iterations = oil_film.turning(3000.0, grid_nodes, 60)
    assert found == pytest.approx(oil_film.standing(3000.0, grid_nodes), rel=5e-3)  # columns that the load passes
    assert iterations < 8


def test_threshold_of_stability_of_a_short_bearing() -> None:
    length = 0.02 * 2.0 * RADIUS
    film = journal(length, 128, 9, mode="half_sommerfeld")
    place = np.array([0.5 * CLEARANCE, 0.0])
    state = film.steady(place)
    K, D = film.coefficients(place, state)
    load = np.hypot(*film.force(state))
    mass, whirl = stability_threshold(K * CLEARANCE / load, D * CLEARANCE * SPEED / load)
    exact = stability_threshold(*short_bearing_coefficients(0.5))
    assert exact == pytest.approx((6.4604, 0.51464), rel=1e-4)
    assert mass == pytest.approx(exact[0], rel=FRONT)
    assert whirl == pytest.approx(exact[1], rel=FRONT)


def test_what_cannot_be_is_named() -> None:
    with pytest.raises(InputError, match="touches"):
        journal(0.025, 16, 5).steady(np.array([1.1 * CLEARANCE, 0.0]))
    with pytest.raises(InputError, match="cavitation"):
        journal(0.025, 16, 5, mode="gumbel").steady(np.array([0.5 * CLEARANCE, 0.0]))
