"""Plane curves, cams and extruded surfaces against circles, dense samples and the motion of a follower."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial import KDTree

from warpffrf.model import signals
from warpffrf.model.errors import InputError
from warpffrf.model.placement.nearest import curvatures_on
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Curve, Cylinder, Extruded, cam, from_description

R = 0.05  # m
ANGLES = 2.0 * np.pi * np.arange(200) / 200
CIRCLES = {
    "through points": Curve.through(R * np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=1), closed=True),
    "of an arc": Curve.arcs((R, 0.0), 0.5 * np.pi, [(2.0 * np.pi * R, R)], closed=True),
}
HERMITE = 3e-9  # of the radius: phi^4/384 with 200 points on a circle, and as much of the arc length
BENT = 1e-4  # of the curvature: phi^2/12
NEAR_EVOLUTE = 1e-10  # m, where 1 + kappa d is 0.03 and Newton's method slow
TRACED = 2e-9  # m, of a cam with knots half a degree apart


@pytest.mark.parametrize("name", list(CIRCLES))
def test_a_circle(name: str) -> None:
    curve, rng = CIRCLES[name], np.random.default_rng(1)
    angle, rho = rng.uniform(-np.pi, np.pi, 500), R * rng.uniform(0.7, 1.3, 500)
    u, distance = curve.foot(rho[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1))
    assert np.abs(curve.length / (2.0 * np.pi * R) - 1.0) < HERMITE
    assert np.abs(distance - (rho - R)).max() < HERMITE * R
    assert np.abs(np.angle(np.exp(1j * (u / R - angle)))).max() < 1e-5
    assert np.abs(curve.curvature(u) * R - 1.0).max() < BENT


def test_the_error_of_a_spline_falls_with_the_fourth_power() -> None:
    """Of points on an ellipse: 2^4 for half the distance."""

    def error(count: int) -> float:
        a = 2.0 * np.pi * np.arange(count) / count
        curve = Curve.through(np.stack([0.05 * np.cos(a), 0.03 * np.sin(a)], axis=1), closed=True)
        x, y = curve.at(np.linspace(0.0, curve.length, 3001)).T
        return float(np.abs(np.hypot(x / 0.05, y / 0.03) - 1.0).max())

    assert 3.7 < np.log2(error(40) / error(80)) < 4.3


def test_feet_are_the_nearest_points() -> None:
    """Of 20,000 points around a lobed curve: none is nearer to any of 40,000 samples than to its foot."""
    r = 0.04 + 0.01 * np.cos(ANGLES) + 0.003 * np.cos(3.0 * ANGLES)
    curve = Curve.through(r[:, None] * np.stack([np.cos(ANGLES), np.sin(ANGLES)], axis=1), closed=True)
    points = np.random.default_rng(0).uniform(-0.06, 0.06, (20000, 2))
    u, distance = curve.foot(points)
    sampled = KDTree(curve.at(np.linspace(0.0, curve.length, 40001))).query(points)[0]
    assert np.all(np.abs(distance) <= sampled + NEAR_EVOLUTE)
    assert np.allclose(np.abs(distance), np.linalg.norm(points - curve.at(u), axis=1), rtol=0.0, atol=1e-10)


def test_arcs_continue_one_another() -> None:
    """A stadium: two half circles and two lines close, with the curvature of each."""
    line, half = 0.04, np.pi * R
    curve = Curve.arcs((0.0, -R), 0.0, [(line, np.inf), (half, R), (line, np.inf), (half, R)], closed=True)
    assert curve.length == pytest.approx(2.0 * (line + half), rel=1e-12)
    kappa = curve.curvature(np.array([0.5 * line, line + 0.5 * half, 1.5 * line + half]))
    assert kappa == pytest.approx([0.0, 1.0 / R, 0.0], abs=1e-3)
    assert curve.normal(0.5 * line) == pytest.approx([0.0, -1.0])  # away from the material, to the left


def test_an_open_curve_continues_along_its_tangents() -> None:
    curve = Curve.arcs((0.0, 0.0), 0.0, [(0.02, R)])
    x, y = -0.013, 0.002
    u, distance = curve.foot([x, y])
    assert float(u) == pytest.approx(x, abs=1e-12) and float(distance) == pytest.approx(-y, abs=1e-12)


def test_ends_are_edges_and_depths_are_limits() -> None:
    """A quarter of a circle about the origin: beyond its ends, and below its depth, is free space."""
    curve = Curve.arcs((R, 0.0), 0.5 * np.pi, [(0.5 * np.pi * R, R)])
    thin = replace(curve, depth=0.3 * R)
    points = np.array([[0.8 * R, 0.1 * R], [0.5 * R, 0.1 * R], [0.9 * R, -0.02 * R], [R, 0.3 * R]])
    radius = np.linalg.norm(points, axis=1) - R
    end = np.linalg.norm(points[2] - [R, 0.0])
    assert curve.gap(points) == pytest.approx([radius[0], radius[1], end, radius[3]], abs=HERMITE * R)
    assert thin.gap(points) == pytest.approx([radius[0], -radius[1], end, radius[3]], abs=HERMITE * R)
    pieces = thin.seeds[2]
    assert pieces.min() < 0 and np.all(curve.seeds[2] >= 0)
    with pytest.raises(InputError, match="a closed curve has no depth"):
        replace(CIRCLES["of an arc"], depth=0.1 * R)


def test_an_extruded_circle_has_the_chart_of_a_cylinder() -> None:
    direction, at = np.array([0.2, 1.0, -0.3]), (0.01, 0.02, -0.01)
    cylinder = Cylinder(radius=R, axis_point=at, axis_direction=direction)
    extruded = Extruded(curve=CIRCLES["of an arc"], axis_point=at, axis_direction=direction)
    points = cylinder.point(*np.random.default_rng(2).uniform(-0.03, 0.03, (2, 50))) + 1e-3
    theta, z, distance = cylinder.chart(points)
    u, z_own, distance_own = extruded.chart(points)
    assert np.allclose(np.angle(np.exp(1j * (u / R - theta))), 0.0, atol=1e-7)
    assert np.allclose(z_own, z, atol=1e-15) and np.allclose(distance_own, distance, rtol=0.0, atol=HERMITE * R)
    assert np.allclose(extruded.normal(u, z), cylinder.normal(theta, z), atol=1e-7)
    assert np.allclose(extruded.around(u), cylinder.around(theta), atol=1e-7)
    assert np.allclose(extruded.along(u, z), cylinder.along(theta, z), atol=1e-7)
    assert from_description(extruded.describe()).describe() == extruded.describe()


def lifting(height: float = 0.01, rise: float = 1.5) -> signals.Polynomial:
    """Dwell, rise, dwell, fall, dwell; 3-4-5."""
    c = np.zeros((5, 8))
    up = height * np.array([10.0, -15.0, 6.0]) / rise ** np.arange(3, 6)
    c[1, 3:6], c[2, 0], c[3, 0], c[3, 3:6] = up, height, height, -up
    return signals.Polynomial(np.array([0.0, 0.3, 0.3 + rise, 2.4, 2.4 + rise, 2.0 * np.pi]), c)


@pytest.mark.parametrize("roller", [0.01, None])
def test_a_cam_carries_its_follower(roller: float | None) -> None:
    """In every position the follower that is lifted by the law touches the cam, and does not cut it."""
    law, base = lifting(), 0.03
    section = cam(law, base_radius=base, roller_radius=roller)
    samples = section.at(np.linspace(0.0, section.length, 20001))
    for phi in np.linspace(0.0, 2.0 * np.pi, 37):
        direction = np.array([np.cos(phi), np.sin(phi)])
        if roller is None:
            gap = base + law(phi) - (samples @ direction).max()
        else:
            gap = section.foot((base + roller + law(phi)) * direction)[1] - roller
        assert abs(float(gap)) < TRACED


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Curve.through([(0, 0), (1, 0), (1, 1), (0.5, -1)]), "curve: it intersects itself at"),
        (lambda: Curve.through([(0, 0), (1, 0)]), "three points or more"),
        (lambda: Curve.through([(0, 0), (1, 0), (1, 0), (2, 1)]), "points 1 and the next are the same"),
        (lambda: Curve(knots=[0, 1], points=[(0, 0), (1, 0)], tangents=[(1, 0), (2, 0)]), "number 1 has 2"),
        (lambda: Curve(knots=[1, 0], points=[(0, 0), (1, 0)], tangents=[(1, 0), (1, 0)]), "knots must increase"),
        (lambda: Curve.arcs((0, 0), 0.0, [(1.0, np.inf)], closed=True), "must end where it starts"),
        (lambda: Curve.arcs((0, 0), 0.0, [(1.0, 0.0)]), "piece 0: radius must be a number other than 0"),
        (lambda: cam(lifting(0.03, 0.5), base_radius=0.01, roller_radius=0.02), "the follower undercuts the cam"),
        (lambda: cam(signals.Ramp(0.0, 1e-3, duration=1.0), base_radius=0.01), "must return to its value"),
        (lambda: Extruded(curve=3), "curve must be a surfaces.Curve"),
        (lambda: Extruded(curve=CIRCLES["of an arc"], x_direction=(0, 1, 0)), "must not be parallel"),
    ],
)  # fmt: skip
def test_bad_curves_are_refused(make, message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        make()


def test_relative_curvatures_of_two_curves() -> None:
    """Where they are nearest: an ellipse's vertex on an arc, wherever the curves begin; beyond an end, that of the
    end."""
    phi = np.linspace(0.0, 2.0 * np.pi, 201)[:-1] + 1.0
    ellipse = Curve.through(np.stack([0.03 * np.cos(phi), 0.02 * np.sin(phi)], axis=1), closed=True)
    arc = Curve.arcs((0.01, 0.0), 0.5 * np.pi + np.arcsin(0.2), [(0.02, 0.05)])  # its middle faces up and left
    scene = Scene(gravity=(0, 0, 0))
    axis: Any = {"axis_direction": (0, 0, 1), "x_direction": (1, 0, 0)}
    one = scene.add_rigid_body(1.0, (1.0,) * 3, name="one", surfaces={"face": Extruded(curve=ellipse, **axis)})
    middle = arc.at(0.5 * arc.length)
    normal = arc.normal(0.5 * arc.length)
    turned = np.arctan2(normal[0], -normal[1])  # the normal of the middle then points down
    rotation = {"axis": (0, 0, 1), "angle": -turned}
    c, s = np.cos(-turned), np.sin(-turned)
    at = np.array([c * middle[0] - s * middle[1], s * middle[0] + c * middle[1]])
    above = np.array([0.0, 0.02 + 1e-3]) - at
    other = scene.add_rigid_body(
        1.0, (1.0,) * 3, name="other", position=(*above, 0.0), rotation=rotation,
        surfaces={"face": Extruded(curve=arc, **axis)},
    )  # fmt: skip
    ports = one["face"], other["face"]
    expected = 0.02 / 0.03**2 + 1.0 / 0.05
    for a, b in (ports, ports[::-1]):
        assert curvatures_on(a, b) == pytest.approx((expected, 0.0), rel=1e-3)
    other.position = other.position + np.array([0.05, 0.0, 0.0])  # the arc ends before the ellipse
    assert curvatures_on(*ports)[0] > 1.0 / 0.05
