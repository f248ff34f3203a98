"""Surfaces of revolution: chart, normals, distance, and the fit."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from warpffrf.model import mesh as wfmesh
from warpffrf.model import surfaces
from warpffrf.model.errors import InputError

AXIS = np.array([0.3, 0.8, -0.5]) / np.linalg.norm([0.3, 0.8, -0.5])
CENTER = np.array([0.1, -0.2, 0.3])
SHAPES = [
    surfaces.Cylinder(radius=0.05, axis_point=CENTER, axis_direction=AXIS),
    surfaces.CrownedCylinder(radius=0.05, axis_point=CENTER, axis_direction=AXIS, crown_radius=0.4),
]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda s: s.kind)
def test_chart_point_and_normal_agree(shape) -> None:
    rng = np.random.default_rng(3)
    theta, z = rng.uniform(-3.1, 3.1, 50), rng.uniform(-0.01, 0.01, 50)
    x, n = shape.point(theta, z), shape.normal(theta, z)
    back_theta, back_z, distance = shape.chart(x)
    np.testing.assert_allclose(back_theta, theta, atol=1e-13)
    np.testing.assert_allclose(back_z, z, atol=1e-15)
    np.testing.assert_allclose(distance, 0.0, atol=1e-15)
    np.testing.assert_allclose(np.linalg.norm(n, axis=1), 1.0, rtol=1e-14)
    # the normal is perpendicular to both tangents (central differences), and distance grows along it by what one moves
    h = 1e-6
    for tangent in (
        shape.point(theta + h, z) - shape.point(theta - h, z),
        shape.point(theta, z + h) - shape.point(theta, z - h),
    ):
        assert np.max(np.abs(np.einsum("ij,ij->i", n, tangent))) < 1e-8 * np.max(np.linalg.norm(tangent, axis=1))
    for step in (-1e-3, 1e-6, 2e-3):
        np.testing.assert_allclose(shape.chart(x + step * n)[2], step, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(
        shape.slope_at(z), (shape.radius_at(z + h) - shape.radius_at(z - h)) / (2 * h), atol=1e-9
    )


def test_crown_against_the_defining_formula() -> None:
    Rc, z = 0.4, np.linspace(-0.01, 0.01, 7)
    np.testing.assert_allclose(SHAPES[1].radius_at(z), 0.05 - (Rc - np.sqrt(Rc**2 - z**2)), rtol=1e-14)


def test_frame_of_a_roller() -> None:
    shape = surfaces.Cylinder(radius=0.05, axis_point=(0, 0, 0), axis_direction=(0, 2.0, 0))
    np.testing.assert_array_equal(shape.frame, [[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    for s in SHAPES:
        np.testing.assert_allclose(s.frame @ s.frame.T, np.eye(3), atol=1e-15)
        assert np.linalg.det(s.frame) == pytest.approx(1.0)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("crown_radius", [None, 0.25])
@pytest.mark.parametrize("arc", [False, True])
def test_roller_rims_are_recovered(order: int, crown_radius: float | None, arc: bool) -> None:
    mesh = wfmesh.roller(0.05, 0.015, 0.02, sectors=24, layers=2, axial=3, order=order, crown_radius=crown_radius)
    mesh = mesh.select("tread", "rim", lambda x: x[:, 0] > (0.035 if arc else -1.0))
    points = mesh.points[mesh.facets("tread").node_set]
    shape = (surfaces.Cylinder() if crown_radius is None else surfaces.CrownedCylinder()).fitted(points)
    assert shape.radius == pytest.approx(0.05, rel=1e-10)
    np.testing.assert_allclose(shape.frame, [[1, 0, 0], [0, 0, -1], [0, 1, 0]], atol=1e-10)
    np.testing.assert_allclose(shape.axis_point, 0.0, atol=1e-10)
    assert shape.deviation < 1e-12
    if crown_radius is not None:
        assert shape.crown_radius == pytest.approx(crown_radius, rel=1e-7)


@settings(max_examples=30, deadline=None)
@given(
    direction=st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda d: np.linalg.norm(d) > 0.1),
    width=st.floats(0.02, 0.4),
    radius=st.floats(0.01, 0.2),
    center=st.tuples(*[st.floats(-1.0, 1.0)] * 3),
)
def test_any_full_cylinder_is_recovered(direction, width, radius, center) -> None:
    true = surfaces.Cylinder(radius=radius, axis_point=center, axis_direction=direction)
    theta, z = np.meshgrid(np.linspace(0, 2 * np.pi, 24, endpoint=False), np.linspace(-0.5, 0.5, 4) * width)
    shape = surfaces.Cylinder().fitted(true.point(theta.ravel(), z.ravel()))
    assert shape.radius == pytest.approx(radius, rel=1e-9)
    assert abs(shape.e_a @ true.e_a) == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_allclose(shape.axis_point, true.axis_point, atol=1e-9)


def test_noise_is_reported_as_deviation_and_refused_above_the_tolerance() -> None:
    rng = np.random.default_rng(5)
    theta, z = rng.uniform(-3, 3, 300), rng.uniform(-0.01, 0.01, 300)
    noise = rng.uniform(-1e-5, 1e-5, 300)
    points = SHAPES[0].point(theta, z) + noise[:, None] * SHAPES[0].normal(theta, z)
    shape = surfaces.Cylinder(fit_tolerance=2e-5).fitted(points)
    assert 0.8e-5 < shape.deviation < 1.2e-5
    assert shape.radius == pytest.approx(0.05, abs=3e-6)
    with pytest.raises(InputError, match="do not fit.*fit_tolerance"):
        surfaces.Cylinder().fitted(points)


def test_facets_of_another_shape_are_refused() -> None:
    mesh = wfmesh.roller(0.05, 0.015, 0.02, sectors=12, layers=1, axial=2, crown_radius=0.2)
    rim = mesh.points[mesh.facets("rim").node_set]
    with pytest.raises(InputError, match="do not fit"):
        surfaces.Cylinder().fitted(rim)
    with pytest.raises(InputError, match="do not fit|no surface of revolution fits"):
        surfaces.CrownedCylinder(radius=0.04).fitted(rim)
    straight = wfmesh.roller(0.05, 0.015, 0.02, sectors=12, layers=1, axial=2)
    rim = straight.points[straight.facets("rim").node_set]
    # a crown through a cylinder has curvature at round-off: either no crown, or one that is flat to the eye
    try:
        shape = surfaces.CrownedCylinder().fitted(rim)
    except InputError as error:
        assert "no crown" in str(error)
    else:
        assert shape.crown_radius > 1e6
    with pytest.raises(InputError, match="points cannot determine"):
        surfaces.Cylinder().fitted(rim[:2])


def test_given_parts_are_kept() -> None:
    theta, z = np.meshgrid(np.linspace(-1, 1, 9), np.linspace(-0.01, 0.01, 5))
    points = SHAPES[1].point(theta.ravel(), z.ravel())
    shape = surfaces.CrownedCylinder(axis_direction=AXIS, radius=0.05).fitted(points)
    np.testing.assert_array_equal(shape.axis_direction, AXIS)
    np.testing.assert_allclose(shape.axis_point, CENTER, atol=1e-9)
    assert shape.radius == 0.05 and shape.crown_radius == pytest.approx(0.4, rel=1e-8)
    flipped = surfaces.Cylinder(axis_direction=-AXIS, axis_point=CENTER).fitted(
        SHAPES[0].point(theta, z).reshape(-1, 3)
    )
    np.testing.assert_array_equal(flipped.e_a, -AXIS)


def test_description_goes_both_ways() -> None:
    for shape in SHAPES:
        again = surfaces.from_description(shape.describe())
        assert type(again) is type(shape) and again.describe() == shape.describe()


def test_border() -> None:
    with pytest.raises(InputError, match="radius"):
        surfaces.Cylinder(radius=-1.0)
    with pytest.raises(InputError, match="axis_direction has zero length"):
        surfaces.Cylinder(axis_direction=(0, 0, 0))
    with pytest.raises(InputError, match="crown_radius"):
        surfaces.CrownedCylinder(crown_radius=0.0)
    with pytest.raises(InputError, match="fitted"):
        surfaces.Cylinder().point(0.0, 0.0)
    with pytest.raises(InputError, match="NaN"):
        surfaces.Cylinder().fitted([[0.0, np.nan, 1.0]] * 8)
