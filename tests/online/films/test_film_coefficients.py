"""Stiffness and damping of a film and its whirl, compared with published ones, a closed form, an implementation of its
own that moves the shaft to and fro, and the modes of a shaft in the film."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from film_scenes import bearing as elastic_bearing
from film_scenes import bore_body, shaft_body
from numpy.testing import assert_allclose

import warpffrf as wf
from references.closed_forms.films import short_bearing_coefficients, stability_threshold
from references.films.journal import JournalFilm
from scenes.film_bearing import CLEARANCE, GROOVE, LENGTH, RADIUS, RIGID, SPEED, VISCOSITY, bearing, bore, pressed
from warpffrf.model import films
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.body import ReducedBody

FAST = 1500.0  # rad/s
PUBLISHED = 0.02  # of the largest coefficient of a row: two decimals, and 72 x 9 nodes
ATTITUDE = 0.5  # degrees
LUND = {  # S: eccentricity, attitude [degrees], Kxx, Kxy, Kyx, Kyy, Bxx, Bxy, Byy; x along the load
    0.991: (0.150, 70.58, 1.56, 7.29, -2.16, 1.52, 14.66, 1.58, 4.49),
    0.635: (0.224, 63.54, 1.62, 5.33, -1.57, 1.56, 10.80, 1.70, 3.41),
    0.235: (0.460, 49.27, 2.19, 3.57, -0.80, 1.55, 7.36, 1.89, 2.19),
    0.159: (0.559, 44.33, 2.73, 3.36, -0.48, 1.48, 6.94, 1.78, 1.74),
    0.108: (0.650, 39.72, 3.45, 3.34, -0.23, 1.44, 6.89, 1.72, 1.43),
}
DRAG = 1e-3  # damping ratio of the modes: what velocities of small motions add to the shear, and cavities to theirs
REFERENCE = 0.01  # of the largest: the time step
PERIODS, STEPS = 3, 160
TIGHT = 1e-4 * RADIUS  # shear is (R/L)^2 c/R of the pressures
TRUE = 3.0  # an estimate is good for the figure's order: within this factor

Array = np.ndarray


@pytest.fixture(scope="module")
def rigid() -> ReducedBody:
    """A sleeve that hardly gives way."""
    return bore((64, 9), stiffer=RIGID)


def at_rest(scene: wf.Scene) -> Any:
    return wf.equilibrium(scene, progress=False)


def test_published_coefficients_of_a_bearing_with_two_grooves() -> None:
    """J. W. Lund and K. K. Thomsen, A calculation method and data for the dynamic coefficients of oil-lubricated
    journal bearings (1978): pads of 160 degrees, L = D, cavities without transport."""
    R, c, L, mu, n = 0.05, 100e-6, 0.1, 0.02, 50.0
    hole = wf.surfaces.Bore(radius=R, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    body = wf.rigid_film_body(
        1.0, (1e-3,) * 3, contact={"bore": hole}, extent=(-0.5 * L, 0.5 * L), nodes=(72, 9),
        points={"outside": (0, 0, 0)},
    )  # fmt: skip
    grooves = [films.AxialGroove(side * 0.5 * np.pi, 1.001 * np.radians(20.0) * R, 0.0) for side in (1.0, -1.0)]
    for S, (eps, attitude, *published) in LUND.items():
        W, omega = mu * n * L * 2.0 * R * (R / c) ** 2 / S, 2.0 * np.pi * n
        scene = bearing(
            body, (W, 0.0), at=(0.2, 0.2), radius=R, clearance=c, speed=omega, oil=wf.oils.Newtonian(mu),
            feeds=grooves, cavitation="reynolds",
        )  # fmt: skip
        film = at_rest(scene).film("film")
        e, found = film.eccentricity[-1] / c, film.coefficients()
        assert np.hypot(*e) == pytest.approx(eps, abs=4e-3)
        assert np.degrees(np.arctan2(e[1], e[0])) == pytest.approx(attitude, abs=ATTITUDE)
        K, B = found.stiffness * c / W, found.damping * c * omega / W
        ours = np.array([*K.ravel(), B[0, 0], 0.5 * (B[0, 1] + B[1, 0]), B[1, 1]])
        off = np.abs(ours - published).max() / np.abs(published).max()
        print(f"S {S}: off by {off:.4f} of the largest, {ours.round(2)}")
        assert off < PUBLISHED
        assert abs(B[0, 1] - B[1, 0]) < 2e-3 * B.max()  # without transport of cavities


def test_a_bearing_that_becomes_short_has_the_coefficients_of_the_closed_form() -> None:
    """Differences fall with the square of the length over the diameter, to 1/64, that of the rows along."""
    eps, off = 0.4, []
    for length in (RADIUS, 0.5 * RADIUS, 0.25 * RADIUS):
        body = bore((64, 9), length, RIGID)
        film = at_rest(bearing(body, None, at=(eps, 0.0), clearance=TIGHT, cavitation="half_sommerfeld")).film("film")
        found = film.coefficients()
        scale = TIGHT / np.linalg.norm(pressed(body, np.maximum(film.pressure[-1], 0.0)))
        K, D = scale * found.stiffness, scale * SPEED * found.damping
        pairs = zip((K, D), short_bearing_coefficients(eps), strict=True)
        off.append(max(float(np.abs(ours - closed).max() / np.abs(closed).max()) for ours, closed in pairs))
        mass, whirl = stability_threshold(K, D)
        assert found.critical_mass == pytest.approx(mass / (scale * SPEED**2), rel=1e-3)
        assert found.whirl_ratio == pytest.approx(whirl, rel=1e-3)
    print("off by", off)
    assert off[0] > 2.5 * off[1] and off[1] > 2.5 * off[2] and off[2] < 0.02


@pytest.mark.parametrize("rule", ["jfo", "reynolds"])
def test_stiffness_is_the_difference_of_the_forces_of_held_shafts(rule: str) -> None:
    """Of a short bearing, where shear contributes."""
    body, d = bore((64, 9), 0.5 * RADIUS, RIGID), 1e-4
    given: dict[str, Any] = {"cavitation": rule, "feeds": [GROOVE] if rule == "jfo" else []}
    film = at_rest(bearing(body, (150.0, 0.0), **given)).film("film")
    place, columns = film.eccentricity[-1] / CLEARANCE, []
    for way in d * np.eye(2):
        ends = [at_rest(bearing(body, None, at=tuple(place + sign * way), **given)).film("film").force[-1]
                for sign in (1.0, -1.0)]  # fmt: skip
        columns.append((ends[0] - ends[1])[[0, 2]] * (1.0, -1.0) / (2.0 * d * CLEARANCE))
    expected = np.stack(columns, axis=1)
    assert_allclose(film.coefficients().stiffness, expected, atol=2e-3 * np.abs(expected).max())


def test_cavities_that_conserve_oil_follow_the_motion_with_a_delay(rigid: ReducedBody) -> None:
    """Force of the reference on a shaft that moves to and fro, at half of the speed; between groove and film are
    cavities, which keep what the motion leaves there."""
    film = at_rest(bearing(rigid, (2e3, 0.0), speed=FAST, feeds=[GROOVE])).film("film")
    found = film.coefficients(0.5 * FAST / (2.0 * np.pi))
    slow = film.coefficients()
    e, rate, steps = film.eccentricity[-1], 0.5 * FAST, STEPS
    h = 2.0 * np.pi / (rate * steps)
    moved, dynamic = 1e-3 * CLEARANCE, np.zeros((2, 2), complex)
    for k in range(2):
        other = JournalFilm(RADIUS, LENGTH, CLEARANCE, VISCOSITY, FAST, 64, 9, feeds=(32,))
        other.begin(e, other.steady(e))
        forces = [
            other.force(other.advance(e + moved * np.sin(rate * n * h) * np.eye(2)[k], h))
            for n in range(1, PERIODS * steps + 1)
        ]
        turn = np.exp(-1j * rate * h * np.arange((PERIODS - 1) * steps + 1, PERIODS * steps + 1))
        dynamic[:, k] = -2.0j * np.mean(np.array(forces)[-steps:] * turn[:, None], axis=0) / moved
    for ours, theirs in ((found.stiffness, np.real(dynamic)), (found.damping, np.imag(dynamic) / rate)):
        print(ours, theirs)
        assert np.abs(ours - theirs).max() < REFERENCE * np.abs(theirs).max()
    assert abs(slow.stiffness - found.stiffness).max() > 0.3 * np.abs(found.stiffness).max()


@pytest.mark.parametrize("rule", ["jfo", "reynolds"])
def test_a_shaft_of_the_critical_mass_neither_comes_to_rest_nor_departs(rigid: ReducedBody, rule: str) -> None:
    """Its complex mode; a lighter shaft comes to rest, a heavier one does not."""
    given: dict[str, Any] = {"speed": FAST, "cavitation": rule, "feeds": [GROOVE] if rule == "jfo" else []}
    found = at_rest(bearing(rigid, (2e3, 0.0), **given)).film("film").coefficients()
    for share, sign in ((1.0, 0.0), (0.9, 1.0), (1.1, -1.0)):
        scene = bearing(rigid, (2e3, 0.0), mass=share * found.critical_mass, **given)
        modes = wf.eigenmodes(scene, 1, about=at_rest(scene), progress=False)
        if sign:
            assert sign * modes.damping_ratios[0] > 5.0 * DRAG
        else:
            assert abs(modes.damping_ratios[0]) < DRAG
            assert modes.frequencies[0] == pytest.approx(found.whirl_frequency, rel=DRAG)
    assert 0.45 < found.whirl_ratio < 0.55
    assert found.whirl_ratio == pytest.approx(2.0 * np.pi * found.whirl_frequency / FAST)


def test_errors_of_the_grid_are_true_within_a_factor_of_three(rigid: ReducedBody) -> None:
    """Of the largest coefficients, on two grids at the same place."""
    film = at_rest(bearing(bore((32, 7), stiffer=RIGID), (2e3, 0.0), cavitation="reynolds")).film("film")
    found, e = film.coefficients(), film.eccentricity[-1]
    exact = []
    for columns, rows in ((32, 7), (128, 25)):
        other = JournalFilm(RADIUS, LENGTH, CLEARANCE, VISCOSITY, SPEED, columns, rows, mode="reynolds")
        exact.append(other.coefficients(e, other.steady(e)))
    for said, coarse, fine in zip((found.stiffness_error, found.damping_error), *exact, strict=True):
        true = float(np.abs(coarse - fine).max())
        assert true / TRUE < said.max() < TRUE * true


def test_coefficients_over_speed() -> None:
    """Of many equilibria at once as of each alone; over the Sommerfeld number K c/W is a property of the bearing."""
    scenes = [bearing(bore((32, 7), stiffer=RIGID), (load, 0.0), speed=speed, feeds=[GROOVE])
              for load, speed in ((2e3, 300.0), (4e3, 600.0), (2e3, 600.0))]  # fmt: skip
    found = [result.film("film").coefficients() for result in wf.equilibria(scenes, progress=False)]
    alone = at_rest(scenes[2]).film("film").coefficients()
    assert_allclose(found[2].stiffness, alone.stiffness, rtol=1e-6)
    assert found[2].critical_mass == pytest.approx(alone.critical_mass, rel=1e-6)
    assert_allclose(found[1].stiffness, 2.0 * found[0].stiffness, rtol=5e-3, atol=5e-3 * found[1].stiffness.max())
    assert found[1].critical_mass == pytest.approx(0.5 * found[0].critical_mass, rel=5e-3)


def test_a_yielding_sleeve_is_softer_and_a_state_of_a_run_has_coefficients() -> None:
    soft, hard = (
        at_rest(elastic_bearing((20e3, 0.0), body=bore_body(modulus=E))).film("film").coefficients().stiffness
        for E in (210e9, 1e5 * 210e9)
    )
    assert soft[0, 0] < 0.8 * hard[0, 0]
    run = wf.simulate(elastic_bearing((2e3, 0.0)), 1e-3, step=2e-4, start="equilibrium", progress=False)
    moving = run.film("film").coefficients()
    still = at_rest(elastic_bearing((2e3, 0.0))).film("film").coefficients()
    assert_allclose(moving.stiffness, still.stiffness, rtol=0.02, atol=0.02 * still.stiffness.max())
    assert np.isnan(moving.stiffness_error).all() and np.isfinite(still.stiffness_error).all()


def test_what_has_no_coefficients_says_so(tmp_path: Any) -> None:
    on_shaft = at_rest(elastic_bearing((2e3, 0.0), yielding=shaft_body(), on_shaft=True))
    with pytest.raises(InputError, match="rotates, and the grid of the film with it"):
        on_shaft.film("film").coefficients()
    found = at_rest(elastic_bearing((2e3, 0.0)))
    with pytest.raises(InputError, match=r"frequency \[Hz\]"):
        found.film("film").coefficients(-1.0)
    found.save(tmp_path / "found.h5")
    with pytest.raises(InputError, match="read from a file"):
        wf.Result.load(tmp_path / "found.h5").film("film").coefficients()
