"""Kinds of rolling bearings against closed-form load distributions: two rows, four points, tapered, spherical, toroidal
and thrust bearings, whose rings move in parallel."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq, root

import warpffrf as wf
from references.closed_forms.ball_bearing import BallBearing
from references.closed_forms.rolling_bearings import Rows, iso_profiles, lamina_force, sjoevall, tapered
from scenes.bearing_kinds import (
    ALPHA,
    COUNT,
    LENGTH,
    MM,
    OF_TWO_ROWS,
    PITCH,
    RIB,
    UM,
    D,
    barrels,
    barrels_in_rows,
    book_of,
    solved,
    tapered_bearing,
    tapered_row,
    thrust_balls,
    two_rows_of_balls,
)
from warpffrf.model.bearings import BallGeometry, RollerGeometry
from warpffrf.model.bearings.life import edge_factor
from warpffrf.model.bearings.modified_life import modified_life

ROUND_OFF = 1e-9
LOADS = 1e-2  # of the largest load: promised
EXACT = 2e-3  # of the largest load: contact angles that change by a tenth of a degree
MANY = 5e-3  # of the largest load: sums over 40 elements, of integrals


@pytest.mark.parametrize("force", [(2000.0, 0.0), (0.0, 2000.0), (2000.0, 1500.0)])
@pytest.mark.parametrize("angle", [30.0, -30.0])
def test_two_rows_of_balls(force: tuple[float, float], angle: float) -> None:
    geometry = BallGeometry(**OF_TWO_ROWS, contact_angle=np.radians(angle), row_spacing=15 * MM)
    _, found = solved(geometry, force)
    exact = two_rows_of_balls(geometry, *force)
    for load in (found.inner_load[-1], found.outer_load[-1]):
        assert np.abs(load - exact).max() < EXACT * exact.max()
    opposite = np.sign(angle) * np.repeat([1.0, -1.0], 12)
    assert np.all(np.nan_to_num(found.outer_angle[-1]) * opposite >= 0.0)


def test_thrust_on_two_rows_presses_one() -> None:
    """That of the positive angle, under thrust along the axis."""
    geometry = BallGeometry(
        elements=8, ball_diameter=10 * MM, pitch_diameter=50 * MM, contact_angle=0.5, rows=2, row_spacing=15 * MM
    )
    _, found = solved(geometry, (0.0, 1000.0))
    assert found.outer_load[-1][:8].min() > 0.0
    assert found.outer_load[-1][8:].max() < 1e-6 * found.outer_load[-1].max()


def test_self_aligning_balls() -> None:
    """A spherical outer raceway: loads as of two rows, and no moment against a tilt of the inner ring."""
    alpha, D, pitch = np.radians(14.0), 10 * MM, 50 * MM
    geometry = BallGeometry(
        elements=12, ball_diameter=D, pitch_diameter=pitch, osculation=(0.52, 0.5 + 0.5 * pitch / np.cos(alpha) / D),
        contact_angle=-alpha, rows=2, row_spacing=pitch * np.tan(alpha),
    )  # fmt: skip
    assert geometry.self_aligning
    with pytest.raises(wf.InputError, match="overlap"):
        BallGeometry(
            elements=12, ball_diameter=D, pitch_diameter=pitch, contact_angle=-alpha, rows=2, row_spacing=0.5 * D
        )
    _, found = solved(geometry, (2000.0, 0.0))
    exact = two_rows_of_balls(geometry, 2000.0, 0.0)
    assert np.abs(found.outer_load[-1] - exact).max() < EXACT * exact.max()


def test_four_points_under_thrust_and_radial_load() -> None:
    """Under thrust one pair of arcs, as of an angular-contact bearing; under radial load all four, in a balance of each
    ball between them."""
    alpha, D, pitch, f = np.radians(35.0), 10 * MM, 50 * MM, 0.52
    one = BallGeometry(elements=12, ball_diameter=D, pitch_diameter=pitch, contact_angle=alpha)
    geometry = BallGeometry(elements=12, ball_diameter=D, pitch_diameter=pitch, contact_angle=alpha, four_point=True)
    _, found = solved(geometry, (0.0, 2000.0))
    _, wanted = solved(one, (0.0, 2000.0))
    np.testing.assert_allclose(found.outer_load[-1][:12], wanted.outer_load[-1], rtol=1e-6)
    np.testing.assert_allclose(found.displacement[-1], wanted.displacement[-1], atol=1e-6 * 2e-5)
    assert found.outer_load[-1][12:].max() < 1e-6 * found.outer_load[-1].max()
    book, beyond = book_of(one), (f - 0.5) * D
    K = book.one_contact(f * D, 1.0), book.one_contact(f * D, -1.0)
    phi = one.angles

    def ball(shift: float) -> tuple[float, float]:
        """Radial forces [N] of a ball whose inner ring comes nearer by `shift` [m]."""

        def pressed(x: float, stiffness: float) -> float:
            across = beyond * np.cos(alpha) + x
            depth = np.hypot(across, beyond * np.sin(alpha)) - beyond
            return 2.0 * stiffness * max(depth, 0.0) ** 1.5 * across / np.hypot(across, beyond * np.sin(alpha))

        x: Any = brentq(lambda x: pressed(shift - x, K[0]) - pressed(x, K[1]), 0.0, max(shift, 1e-15))
        return pressed(shift - float(x), K[0]), float(x)

    def carried(shift: float) -> np.ndarray:
        return np.array([ball(shift * np.cos(p))[0] if np.cos(p) > 0.01 else 0.0 for p in phi])

    _, found = solved(geometry, (2000.0, 0.0))
    shift: Any = brentq(lambda d: float(np.sum(carried(d) * np.cos(phi))) - 2000.0, 0.0, 1e-4, xtol=1e-12)
    assert found.displacement[-1][0] == pytest.approx(shift, rel=LOADS)
    both = found.outer_load[-1].reshape(2, 12) * np.cos(np.nan_to_num(found.outer_angle[-1])).reshape(2, 12)
    exact = carried(shift)
    assert np.abs(both.sum(axis=0) - exact).max() < EXACT * exact.max()


def test_tapered_rollers_under_thrust() -> None:
    """Raceways and ribs in the balance of a roller."""
    geometry, found = tapered_bearing((0.0, 5000.0))
    alpha_e, tau, nu = ALPHA, geometry.inclination, float(geometry.taper or 0.0)
    assert np.tan(nu) == pytest.approx(D * np.sin(tau) / PITCH, rel=ROUND_OFF)
    assert tau + nu == pytest.approx(ALPHA, rel=ROUND_OFF)
    np.testing.assert_allclose(found.outer_load[-1], 5000.0 / (COUNT * np.sin(alpha_e)), rtol=EXACT)
    R = 0.9 * 0.5 * PITCH / np.sin(tau)
    lean = np.arcsin((0.5 * D - RIB) / R)
    beta = np.arctan2(np.cos(lean) * np.cos(tau) + np.sin(lean) * np.sin(tau),
                      -np.cos(lean) * np.sin(tau) + np.sin(lean) * np.cos(tau))  # fmt: skip
    Q_i, F = tapered(float(found.outer_load[-1][0]), tau - nu, alpha_e, float(beta))
    np.testing.assert_allclose(found.inner_load[-1], Q_i, rtol=EXACT)
    ribs = np.array([found.history.lumped_contacts[f"b flange inner back {i}"].normal_force[-1] for i in range(1, 17)])
    np.testing.assert_allclose(ribs, F, rtol=LOADS)


def test_tapered_rollers_under_combined_load() -> None:
    """Sjoevall's distribution, of 40 rollers of a long thin bearing: outer loads as those of a row at alpha_e."""
    _, found = tapered_bearing((6000.0, 4000.0), count=20)
    _, exact = tapered_row(20).solve(6000.0, 4000.0, (10 * UM, 20 * UM))
    load = found.outer_load[-1]
    print(load, exact[0])
    assert np.abs(load - exact[0]).max() < LOADS * exact.max()


def test_sums_of_many_rollers_are_the_integrals() -> None:
    """Of the reference itself: F_r/(Z Q_max cos alpha) and F_a/(Z Q_max sin alpha) of power laws."""
    for exponent, eps in ((1.5, 0.7), (10.0 / 9.0, 0.5), (10.0 / 9.0, 1.2)):
        row = Rows(400, (0.3,), 0.0, lambda d, t=exponent: 1e10 * np.maximum(d, 0.0) ** t)
        axial = (2.0 * eps - 1.0) * 10 * UM / np.tan(0.3)
        Q = row.loads(10 * UM, axial)[0]
        phi = 2.0 * np.pi * np.arange(400) / 400
        J_r, J_a = sjoevall(eps, exponent)
        assert np.mean(Q * np.cos(phi)) / Q.max() == pytest.approx(J_r, rel=MANY)
        assert np.mean(Q) / Q.max() == pytest.approx(J_a, rel=MANY)


@pytest.mark.parametrize(("alpha", "thrust"), [(0.0, 0.0), (10.0, 0.0), (10.0, 1500.0)])
def test_barrel_shaped_rollers(alpha: float, thrust: float) -> None:
    """Toroidal, one row between arcs, and spherical, two rows in a sphere, with play, under radial load and thrust."""
    geometry = barrels(alpha)
    assert geometry.self_aligning == bool(alpha)
    _, found = solved(geometry, (10e3, thrust))
    shift, exact = barrels_in_rows(geometry).solve(10e3, thrust, (50 * UM, 0.0))
    load = found.outer_load[-1]
    assert np.abs(load - exact.ravel()).max() < LOADS * exact.max()
    assert found.displacement[-1][0] == pytest.approx(shift[0], rel=LOADS)


def test_thrust_rollers() -> None:
    geometry = RollerGeometry(
        elements=12, roller_diameter=D, roller_length=LENGTH, pitch_diameter=80 * MM, contact_angle=0.5 * np.pi
    )
    _, found = solved(geometry, (0.0, 10e3))
    np.testing.assert_allclose(found.outer_load[-1], 10e3 / 12, rtol=1e-6)
    row = Rows(12, (0.5 * np.pi,), 0.0, lamina_force(LENGTH, iso_profiles(LENGTH, D)))
    approach: Any = brentq(lambda d: float(row.loads(0.0, d).sum()) - 10e3, 0.0, 1e-4, xtol=1e-14)
    assert found.displacement[-1][2] == pytest.approx(approach, rel=1e-4)
    q, C = found.lamina_load["inner"][-1][0], geometry.dynamic_rating
    rating = C / (0.73 * 12) * 2.0 ** (2.0 / 9.0) * len(q) ** (-7.0 / 9.0)  # both washers are alike
    life = (2.0 * np.sum((edge_factor(len(q)) * q / rating) ** 4.5)) ** (-8.0 / 9.0)
    assert found.reference_life().revolutions == pytest.approx(life, rel=1e-4)
    assert found.basic_life().revolutions == pytest.approx((C / 10e3) ** (10.0 / 3.0), rel=1e-6)
    modified = found.modified_life(kappa=1.0, contamination=0.5)
    as_radial = modified_life("roller", modified.basic, modified.fatigue_limit, 1.0, 0.5)
    assert modified.revolutions < as_radial.revolutions


def between_washers(geometry: BallGeometry) -> Rows:
    """Balls on grooves that are straight in the direction of rolling, as of an infinite pitch circle."""
    r, D = geometry.groove("inner"), geometry.diameter
    K = BallBearing(1, D, 1e6, r, r, 0.0, 210e9).one_contact(r, 1.0)
    return Rows(
        geometry.elements, (geometry.contact_angle,), 0.0, lambda d: K * np.maximum(0.5 * np.asarray(d), 0.0) ** 1.5
    )


def test_thrust_balls() -> None:
    geometry = thrust_balls()
    _, found = solved(geometry, (0.0, 6e3))
    for load, angle in ((found.inner_load, found.inner_angle), (found.outer_load, found.outer_angle)):
        np.testing.assert_allclose(load[-1], 6e3 / 12, rtol=1e-6)
        np.testing.assert_allclose(angle[-1], 0.5 * np.pi, rtol=1e-9)
    row = between_washers(geometry)
    approach: Any = brentq(lambda d: float(row.loads(0.0, d).sum()) - 6e3, 0.0, 1e-4, xtol=1e-14)
    assert found.displacement[-1][2] == pytest.approx(approach, rel=1e-4)


@pytest.mark.parametrize("share", [0.2, 0.5, 0.7])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_thrust_balls_under_an_eccentric_load(share: float, sense: float) -> None:
    """Sjoevall's distribution: the lever of the force over the pitch radius is J_r/J_a, at 0.6 with half the balls. The
    sums over the balls are exact."""
    geometry, R = replace(thrust_balls(16), contact_angle=sense * 0.5 * np.pi), 30 * MM
    scene = wf.Scene()
    bearing = scene.add_bearing("b", geometry, first=(0, 0, 1), outer=scene.ground)
    slide = scene.add_rigid_body(1.0, np.eye(3), name="slide")
    scene.add(wf.joints.Prismatic(scene.ground.at((0, 0, 0)), slide.at((0, 0, 0)), axis=(0, 1, 0)))
    scene.add(wf.joints.Revolute(slide.at((0, 0, 0)), bearing.inner.at((0, 0, 0)), axis=(1, 0, 0)))
    scene.add(wf.forces.PointForce(bearing.inner.at((0, 0, share * R)), (0.0, sense * 6e3, 0.0)))
    result = wf.equilibrium(scene)
    assert result.status == "completed", result.message
    load, phi = result.bearing("b").outer_load[-1], geometry.angles
    row = between_washers(geometry)

    def taken(x: np.ndarray) -> np.ndarray:
        return row.force(1e-5 * (x[0] + x[1] * np.cos(phi)))

    def lacking(x: np.ndarray) -> list[float]:
        return [np.sum(taken(x)) / 6e3 - 1.0, np.sum(taken(x) * np.cos(phi)) / 6e3 - share]

    exact = taken(root(lacking, (1.0, 0.5), tol=1e-12).x)
    assert np.abs(load - exact).max() < EXACT * exact.max()
    eps: Any = brentq(lambda e: np.divide(*sjoevall(e, 1.5)) - share, 0.05, 5.0)
    assert np.sum(load) / 16 / load.max() == pytest.approx(sjoevall(eps, 1.5)[1], rel=LOADS)


def test_flexible_washers_of_balls_are_refused() -> None:
    with pytest.raises(wf.InputError, match="contact_angle must lie between -1.4 and 1.4 rad, or be pi/2"):
        replace(thrust_balls(), contact_angle=1.5)
    scene = wf.Scene()
    body = scene.add_rigid_body(1.0, np.eye(3), name="body")
    shape = wf.surfaces.Groove(radius=0.02, groove_radius=5.35 * MM, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    washer = body.surface(shape, name="washer")
    with pytest.raises(wf.InputError, match="balls between washers have lumped contacts; mount rigid washers"):
        scene.add_bearing("b", thrust_balls(), inner=washer)


@pytest.mark.parametrize("balls", [False, True])
@pytest.mark.parametrize("angle", [14.0, -14.0, 0.0, 90.0])
def test_elements_roll_without_slip(angle: float, balls: bool) -> None:
    """On both raceways: tapered rollers along their whole length, those of thrust bearings, and balls, in their
    middle."""
    scene = wf.Scene()
    common: Any = {"elements": 8, "pitch_diameter": PITCH, "contact_angle": np.radians(angle)}
    geometry: Any = RollerGeometry(roller_diameter=D, roller_length=LENGTH, **common)
    if balls:
        geometry = BallGeometry(ball_diameter=D, **common)
    bearing = scene.add_bearing("b", geometry, axis=(0, 0, 1))
    bearing.roll(inner=100.0, outer=-30.0)
    element, tau, nu = bearing.elements[0], geometry.inclination, float(getattr(geometry, "taper", None) or 0.0)
    out = bearing.place.outward(0.0)
    axis = np.cos(tau) * bearing.place.axis - np.sin(tau) * out
    across = np.cos(tau) * out + np.sin(tau) * bearing.place.axis
    for x in (0.0,) if angle == 90.0 or balls else (-0.5 * LENGTH, 0.0, 0.5 * LENGTH):
        radius = 0.5 * D - np.sign(angle) * np.tan(nu) * x
        for sign, speed in ((-1.0, 100.0), (1.0, -30.0)):
            lever = x * axis + sign * radius * across
            moved = element.velocity + np.cross(element.angular_velocity, lever)
            ring = np.cross(speed * bearing.place.axis, element.position + lever)
            np.testing.assert_allclose(moved, ring, atol=1e-12 * 100.0 * PITCH)


BAD = {
    "rows=2 and their distance": {"rows": 2},
    "barrel-shaped": {"raceway_radii": 0.05},
    "reaches the axis": {"raceway_radii": 0.5, "profile": 0.4, "contact_angle": 0.9},
    "below the contact": {"taper": 0.1, "contact_angle": 0.05},
    "pi/2": {"contact_angle": 14.0},
    "profile of their contact law": {"contact_angle": 0.2, "profile": 1.0},
}


@pytest.mark.parametrize("message", list(BAD))
def test_geometries_that_do_not_fit(message: str) -> None:
    with pytest.raises(wf.InputError, match=message):
        RollerGeometry(elements=12, roller_diameter=D, roller_length=LENGTH, pitch_diameter=PITCH, **BAD[message])
    with pytest.raises(wf.InputError, match="one row and a positive"):
        BallGeometry(elements=8, ball_diameter=10 * MM, pitch_diameter=50 * MM, four_point=True)
