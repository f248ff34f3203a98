"""Patches on surfaces of every kind: half-widths from moments, relative curvatures, and what Hertz is asked for."""

from __future__ import annotations

import numpy as np
import pytest
from shape_runs import PLANE_STRAIN, contact_of, ellipsoid, grid_of, still

from warpffrf.model.surfaces import Bore, CrownedCylinder, Cylinder, Plane, Ring, Sphere
from warpffrf.output.contact.hertz import HertzLine, HertzPoint, hertz_point
from warpffrf.output.contact.result import ContactResult

BALL, AXIS = 0.01, (0.0, 1.0, 0.0)
FLOOR = Plane(origin=(BALL, 0.0, 0.0), outward=(-1.0, 0.0, 0.0))
FINE = 0.02  # of a half-width: spacing of the grids below
SAMPLED = 6e-3  # error of a half-width from samples of a root at the rim: about FINE^1.5


def ball_on(second: object, a: float, b: float, peak: float, **more: object) -> ContactResult:
    """A ball about the origin, in contact at +x with `second`, under an ellipsoid of pressure."""
    shape = Sphere(radius=BALL, axis_point=(0, 0, 0), axis_direction=AXIS)
    step = FINE * min(a, b)
    z = np.arange(-1.3 * b, 1.3 * b, step)
    columns = int(2.6 * a / step)
    grid = grid_of(shape, step / BALL, columns, z)
    pressure = ellipsoid(a, b, peak)
    return contact_of(shape, grid, second, lambda theta, z: pressure(BALL * theta, z), **more)  # type: ignore[arg-type]


def test_a_ball_on_a_rigid_plane_is_hertz() -> None:
    load = 40.0
    a = float(np.cbrt(0.75 * load * BALL / PLANE_STRAIN))
    contact = ball_on(FLOOR, a, a, 1.5 * load / (np.pi * a * a))
    assert contact.patch_kind == "point"
    assert contact.curvature(0) == pytest.approx(np.eye(2) / BALL, rel=1e-9, abs=1e-6)
    # dA is not flat: (a/R)^2 = 6e-5; the kink at the rim costs the rest
    assert contact.normal_load[0] == pytest.approx(load, rel=1e-3)
    assert contact.half_widths[0] == pytest.approx([a, a], rel=1e-3)
    assert contact.half_width[0] == contact.half_widths[0, 0]
    assert contact.patch_area[0] == pytest.approx(np.pi * a * a, rel=2 * FINE)
    assert contact.effective_modulus == pytest.approx(PLANE_STRAIN)
    found = contact.hertz(0)
    assert isinstance(found, HertzPoint)
    assert found.semi_axes == pytest.approx((a, a), rel=1e-3)
    assert found.peak_pressure == pytest.approx(contact.peak_pressure[0], rel=2e-3)
    x = np.linspace(-a, a, 4001)
    section = np.trapezoid(contact.hertz_pressure(0, x), x)
    assert section == pytest.approx(0.5 * np.pi * found.peak_pressure * a, rel=2e-3)


def test_a_ball_in_a_groove_has_the_groove_s_curvatures() -> None:
    """An outer ring about y whose groove has radius 0.0104 around the ball: 1/R = 1/Rb - 1/Rring, 1/Rb - 1/Rgroove."""
    ring, groove = 0.05, 0.0104
    shape = Ring(radius=ring, axis_point=(BALL - ring, 0, 0), axis_direction=AXIS, groove_radius=groove)
    a, b = 2e-4, 1.5e-3
    contact = ball_on(shape, a, b, 1e9)
    expected = np.diag([1.0 / BALL - 1.0 / ring, 1.0 / BALL - 1.0 / groove])
    assert contact.curvature(0) == pytest.approx(expected, rel=1e-7, abs=1e-6)
    assert contact.patch_kind == "point"
    assert contact.half_widths[0] == pytest.approx([a, b], rel=SAMPLED)
    assert contact.semi_axes[0] == pytest.approx([b, a], rel=SAMPLED)
    assert abs(contact.patch_angle[0]) == pytest.approx(0.5 * np.pi, abs=1e-6)


def test_crossed_cylinders_turn_the_ellipse() -> None:
    """Two cylinders of radius R whose axes cross at 40 degrees: K = (1 + c^2, s c; s c, s^2)/R."""
    R, cross = 0.02, np.deg2rad(40.0)
    first = Cylinder(radius=R, axis_point=(0, 0, 0), axis_direction=AXIS)
    second = Cylinder(radius=R, axis_point=(0, 0, 0), axis_direction=AXIS)
    turn = np.array([np.sin(0.5 * cross), 0.0, 0.0, np.cos(0.5 * cross)])  # about x, the common normal
    bodies = {"a": still(), "b": still((2.0 * R, 0.0, 0.0), turn)}
    z = np.linspace(-2e-3, 2e-3, 161)
    grid = grid_of(first, 2e-5 / R, 121, z)
    pressure = ellipsoid(1.2e-3, 4e-4, 1e9, turn=1.2)
    contact = contact_of(first, grid, second, lambda t, z: pressure(R * t, z), bodies=bodies, second_grid=grid)
    values, axes = np.linalg.eigh(contact.curvature(0))
    # Johnson 4.1: (1/R' + 1/R'') = 2/R, (1/R'' - 1/R') = 2 cos(cross)/R for two alike cylinders
    assert values * R == pytest.approx([1.0 - np.cos(cross), 1.0 + np.cos(cross)])
    # the long axis halves the angle between the two axes of the cylinders
    angle = np.arctan2(axes[1, 0], axes[0, 0]) % np.pi
    assert abs(angle - 0.5 * np.pi) == pytest.approx(0.5 * cross)
    assert contact.patch_kind == "point"
    assert contact.semi_axes[0] == pytest.approx([1.2e-3, 4e-4], rel=5e-3)
    assert contact.patch_angle[0] == pytest.approx(1.2, abs=2e-3)


def test_a_roller_on_a_plane_is_a_line() -> None:
    R = 0.05
    first = Cylinder(radius=R, axis_point=(0, 0, 0), axis_direction=AXIS)
    floor = Plane(origin=(R, 0.0, 0.0), outward=(-1.0, 0.0, 0.0))
    a, peak = 3e-4, 4e8
    grid = grid_of(first, FINE * a / R, 131, np.linspace(-0.01, 0.01, 5))
    contact = contact_of(first, grid, floor, lambda t, z: ellipsoid(a, 1.0, peak)(R * t, 0.0 * z))
    assert contact.patch_kind == "line"
    assert contact.effective_radius == pytest.approx(R)
    assert contact.half_widths[0] == pytest.approx([a, 0.01], rel=SAMPLED)
    line = contact.hertz(0)
    assert isinstance(line, HertzLine)
    assert line.line_load == pytest.approx(0.5 * np.pi * a * peak, rel=SAMPLED)
    assert line.half_width**2 == pytest.approx(4.0 * line.line_load * R / (np.pi * PLANE_STRAIN))


def test_a_plane_carries_the_patch_in_metres() -> None:
    """A flexible block under a rigid ball: theta of the plane is a length."""
    block = Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0))
    ball = Sphere(radius=BALL, axis_point=(0, 0, BALL), axis_direction=AXIS)
    a, away = 2e-4, 0.3e-4
    step = FINE * a
    z = np.arange(-1.3 * a, 1.3 * a, step)
    grid = grid_of(block, step, 131, z)
    contact = contact_of(block, grid, ball, lambda t, z: ellipsoid(a, a, 1e9)(t - away, z + 2.0 * away))
    assert contact.mid_radius == 1.0 and contact.patch_kind == "point"
    assert contact.half_widths[0] == pytest.approx([a, a], rel=SAMPLED)
    assert contact.center_of_pressure[0] == pytest.approx([away, -2.0 * away], rel=1e-3)
    assert contact.center[0] == pytest.approx(away, rel=1e-3)
    # off the common normal the ball's tangent plane is rotated by 7e-3 from the block's
    assert contact.curvature(0) == pytest.approx(np.eye(2) / BALL, rel=1e-4, abs=1e-4 / BALL)
    assert contact.mid_peak_pressure[0] == pytest.approx(1e9, rel=1e-3)


def test_a_roller_across_a_narrow_block_is_a_line_along_its_arc() -> None:
    block = Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0), direction=AXIS)
    roller = Cylinder(radius=BALL, axis_point=(0, 0, BALL), axis_direction=(1.0, 0.0, 0.0))
    a = 2e-4
    grid = grid_of(block, 5e-4, 21, np.arange(-1.3 * a, 1.3 * a, FINE * a))
    contact = contact_of(block, grid, roller, lambda t, z: ellipsoid(1.0, a, 1e9)(0.0 * t, z))
    assert contact.patch_kind == "line_around"
    assert contact.half_width[0] == contact.half_widths[0, 1] == pytest.approx(a, rel=SAMPLED)
    assert contact.half_widths[0, 0] == pytest.approx(5.25e-3, rel=2e-3)  # the last node's other half lies beyond
    assert "the line lies along the arc" in contact.hertz(0).reason


def test_a_long_ellipse_is_small_against_the_radii_in_its_own_directions() -> None:
    """A crowned roller, R 10 mm, crown 20 m: its ellipse is 7 mm long, which is small against the crown alone."""
    crown, peak = 20.0, 1e9
    shape = CrownedCylinder(radius=BALL, crown_radius=crown, axis_point=(0, 0, 0), axis_direction=AXIS)
    expected = hertz_point(2e3, np.diag([1.0 / BALL, 1.0 / crown]), PLANE_STRAIN)
    b, a = expected.half_width, expected.half_width_along
    assert a > 0.25 * BALL
    grid = grid_of(shape, FINE * b / BALL, int(2.6 / FINE), np.linspace(-1.3 * a, 1.3 * a, 131))
    pressure = ellipsoid(b, a, peak)
    found = contact_of(shape, grid, FLOOR, lambda theta, z: pressure(BALL * theta, z)).hertz(0)
    assert isinstance(found, HertzPoint) and found.reason == ""
    assert found.semi_axes[0] / found.semi_axes[1] == pytest.approx(a / b, rel=1e-6)


def test_a_pin_in_a_bore_is_too_conformal_for_hertz() -> None:
    R, clearance = 0.02, 2e-5
    pin = Cylinder(radius=R, axis_point=(0, 0, 0), axis_direction=AXIS)
    bore = Bore(radius=R + clearance, axis_point=(-clearance, 0, 0), axis_direction=AXIS)
    grid = grid_of(pin, 0.02, 131, np.linspace(-0.005, 0.005, 3))
    contact = contact_of(pin, grid, bore, lambda t, z: 1e8 * np.sqrt(np.maximum(0.0, 1.0 - t**2)) + 0.0 * z)
    assert contact.patch_kind == "line"
    assert 1.0 / contact.effective_radius == pytest.approx(1.0 / R - 1.0 / (R + clearance), rel=1e-6)
    found = contact.hertz(0)
    assert "the surfaces conform" in found.reason and np.isnan(found.peak_pressure)
    assert contact.half_width[0] == pytest.approx(R, rel=SAMPLED)  # one radian of arc


def test_inside_forms_count_theta_against_e_theta() -> None:
    R = 0.03
    ring = Bore(radius=R, axis_point=(0, 0, 0), axis_direction=AXIS)
    roller = Cylinder(radius=0.01, axis_point=(R - 0.01, 0, 0), axis_direction=AXIS)
    grid = grid_of(ring, 1e-5 / R, 101, np.linspace(-0.01, 0.01, 3))
    contact = contact_of(ring, grid, roller, lambda t, z: ellipsoid(2e-4, 1.0, 1e9)(R * t, 0.0 * z))
    assert contact.side == -1.0 and np.all(np.diff(contact.arc[0]) > 0.0)
    assert 1.0 / contact.effective_radius == pytest.approx(1.0 / 0.01 - 1.0 / R)
    assert contact.half_width[0] == pytest.approx(2e-4, rel=SAMPLED)


def test_flat_faces_are_no_hertz_contact() -> None:
    block = Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0))
    table = Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, -1.0))
    z = np.linspace(-0.01, 0.01, 21)
    grid = grid_of(block, 1e-3, 31, z)
    contact = contact_of(block, grid, table, lambda t, z: np.where(np.abs(t) < 0.0095, 1e6, 0.0) + 0.0 * z)
    assert contact.patch_kind == "flat"
    assert contact.half_widths[0] == pytest.approx([0.01, 0.01], rel=0.05)  # the nodes at the rim reach beyond it
    assert "the faces are flat" in contact.hertz(0).reason
    assert np.isnan(contact.effective_radius)


def test_a_pair_that_never_touches_has_zeros() -> None:
    contact = ball_on(FLOOR, 1e-4, 1e-4, 0.0)
    assert not contact.touching[0] and contact.patch_area[0] == 0.0 and contact.normal_load[0] == 0.0
    assert np.all(contact.half_widths == 0.0) and contact.half_width[0] == 0.0
    assert contact.patch_kind == "point" and contact.peak_pressure[0] == 0.0
