"""Every kind of contact surface: chart, normals, distance by brute force, curvature, fit, and what is refused."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

from warpffrf.model import surfaces
from warpffrf.model.errors import InputError

AXIS = np.array([0.3, 0.8, -0.5]) / np.linalg.norm([0.3, 0.8, -0.5])
CENTER = np.array([0.1, -0.2, 0.3])
PLACED = {"axis_point": CENTER, "axis_direction": AXIS}
Z_TABLE = np.array([-0.012, -0.008, -0.003, 0.0, 0.004, 0.009, 0.013])
DROP = np.array([4e-4, 9e-5, 0.0, 0.0, 0.0, 1.1e-4, 6e-4])

ANGLES = 2.0 * np.pi * np.arange(1200) / 1200
OVAL = surfaces.Curve.through(np.stack([0.05 * np.cos(ANGLES), 0.04 * np.sin(ANGLES)], axis=1), closed=True)

SHAPES = [
    surfaces.Cylinder(radius=0.05, **PLACED),
    surfaces.CrownedCylinder(radius=0.05, crown_radius=0.4, **PLACED),
    surfaces.ProfiledCylinder(radius=0.05, table=(Z_TABLE, DROP), **PLACED),
    surfaces.ProfiledCylinder.logarithmic(radius=0.05, length=0.03, amplitude=2e-5, end_drop=1e-4, **PLACED),
    surfaces.Groove(radius=0.03, groove_radius=0.015, **PLACED),
    surfaces.Sphere(radius=0.02, **PLACED),
    surfaces.Cone(radius=0.05, half_angle=np.radians(20.0), **PLACED),
    surfaces.Plane(origin=CENTER, outward=AXIS, direction=(1.0, 0.2, 0.0)),
    surfaces.Bore(radius=0.05, **PLACED),
    surfaces.Ring(radius=0.05, groove_radius=0.015, **PLACED),
    surfaces.Cup(radius=0.02, **PLACED),
    surfaces.ConicalBore(radius=0.05, half_angle=np.radians(-35.0), **PLACED),
    surfaces.Extruded(curve=OVAL, x_direction=(1.0, 0.0, 0.0), **PLACED),
]
LENGTHS = ("plane", "extruded")  # kinds whose theta is a length
every_shape = pytest.mark.parametrize("shape", SHAPES, ids=lambda s: s.kind)


def sample(shape, count: int = 40, seed: int = 3) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    low, high = {"plane": (-0.1, 0.1), "extruded": (0.01, 0.2)}.get(shape.kind, (-3.1, 3.1))
    return rng.uniform(low, high, count), rng.uniform(-0.01, 0.01, count)


def test_every_kind_is_here() -> None:
    """But one over a plane, whose chart is oblique (`test_free_forms`)."""
    assert {shape.kind for shape in SHAPES} | {surfaces.MeshSurface.kind} == set(surfaces.SHAPES)


@every_shape
def test_chart_point_and_normal_agree(shape) -> None:
    theta, z = sample(shape)
    x, n = shape.point(theta, z), shape.normal(theta, z)
    np.testing.assert_allclose(np.linalg.norm(n, axis=1), 1.0, rtol=1e-14)
    # perpendicular to both tangents by central differences
    h = 1e-6
    for tangent in (
        shape.point(theta + h, z) - shape.point(theta - h, z),
        shape.point(theta, z + h) - shape.point(theta, z - h),
    ):
        assert np.max(np.abs(np.einsum("ij,ij->i", n, tangent))) < 1e-8 * np.max(np.linalg.norm(tangent, axis=1))
    # from a point off the surface along the normal the chart comes back, and the distance is what one moved
    for step in (0.0, -1e-4, 1e-6, 2e-3):
        back_theta, back_z, distance = shape.chart(x + step * n)
        np.testing.assert_allclose(back_theta, theta, atol=1e-12)
        np.testing.assert_allclose(back_z, z, atol=1e-13)
        np.testing.assert_allclose(distance, step, rtol=1e-9, atol=1e-15)


@every_shape
def test_frame_and_tangents_are_right_handed(shape) -> None:
    np.testing.assert_allclose(shape.frame @ shape.frame.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(shape.frame) == pytest.approx(1.0)
    theta, z = sample(shape)
    n, around, along = shape.normal(theta, z), shape.around(theta), shape.along(theta, z)
    np.testing.assert_allclose(np.cross(around, along), n, atol=1e-14)
    h = 1e-7
    moved = shape.point(theta + h, z) - shape.point(theta - h, z)
    # e_theta counts with theta where the material is inside, against it where it is outside
    np.testing.assert_allclose(around, shape.side * moved / np.linalg.norm(moved, axis=1)[:, None], atol=1e-7)
    up = shape.point(theta, z + h) - shape.point(theta, z - h)
    np.testing.assert_allclose(along, up / np.linalg.norm(up, axis=1)[:, None], atol=1e-6)


@every_shape
def test_normal_points_away_from_the_material(shape) -> None:
    theta, z = sample(shape)
    x = shape.point(theta, z) + 1e-3 * shape.normal(theta, z)
    away = np.linalg.norm((x - CENTER) - np.outer((x - CENTER) @ shape.e_a, shape.e_a), axis=1)
    if shape.kind == "plane":
        np.testing.assert_allclose((x - CENTER) @ AXIS, 1e-3)
    elif shape.kind == "extruded":
        assert np.all(np.linalg.norm((x - CENTER) @ shape.frame[:2].T / (0.05, 0.04), axis=1) > 1.0)
    elif shape.kind in ("bore", "ring", "cup", "conical_bore"):
        assert np.all(away < shape.radius_at(z))
    else:
        assert np.all(away > shape.radius_at(z))


@every_shape
def test_distance_is_that_of_the_nearest_point(shape) -> None:
    rng = np.random.default_rng(11)
    theta, z = sample(shape, 6)
    off = rng.uniform(-2e-3, 4e-3, 6)
    x = shape.point(theta, 0.8 * z) + off[:, None] * rng.normal(size=(6, 3)) / 1.7
    found = shape.chart(x)
    span = 0.01 if shape.kind in LENGTHS else 0.4
    for k in range(6):
        nearest = np.inf
        for dt in (-0.3, 0.0, 0.3):  # several starts: the search is local

            def squared(q, k=k):
                return 1e6 * float(np.sum((shape.point(theta[k] + span * q[0], 0.01 * q[1]) - x[k]) ** 2))

            best = minimize(squared, [dt, z[k] / 0.01], method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-18})
            nearest = min(nearest, 1e-3 * float(np.sqrt(best.fun)))
        assert abs(found[2][k]) == pytest.approx(nearest, rel=1e-6, abs=1e-9)
        foot = shape.point(found[0][k], found[1][k])
        np.testing.assert_allclose(x[k] - foot, found[2][k] * shape.normal(found[0][k], found[1][k]), atol=1e-12)


@every_shape
def test_curvatures_are_how_the_normal_turns(shape) -> None:
    # kappa = (dn/ds).t, central differences along each direction
    theta, z = sample(shape)
    z = z[np.min(np.abs(z[:, None] - Z_TABLE), axis=1) > 1e-4] if shape.kind == "profiled_cylinder" else z
    theta, h = theta[: len(z)], 1e-6
    for found, (dt, dz) in zip(shape.curvatures(theta, z), ((h, 0.0), (0.0, h)), strict=True):
        dn = shape.normal(theta + dt, z + dz) - shape.normal(theta - dt, z - dz)
        dx = shape.point(theta + dt, z + dz) - shape.point(theta - dt, z - dz)
        turned = np.einsum("ij,ij->i", dn, dx) / np.einsum("ij,ij->i", dx, dx)
        np.testing.assert_allclose(found, turned, rtol=1e-4, atol=1e-6)


@every_shape
def test_measure_is_the_area(shape) -> None:
    theta, z = sample(shape)
    h = 1e-6
    across = (shape.point(theta + h, z) - shape.point(theta - h, z)) / (2 * h)
    along = (shape.point(theta, z + h) - shape.point(theta, z - h)) / (2 * h)
    area = np.linalg.norm(np.cross(across, along), axis=1)
    np.testing.assert_allclose(shape.measure_at(z), area, rtol=1e-7)
    np.testing.assert_allclose(shape.radius_at(z), np.linalg.norm(across, axis=1), rtol=1e-8)
    slope = (shape.radius_at(z + h) - shape.radius_at(z - h)) / (2 * h)
    np.testing.assert_allclose(shape.slope_at(z), slope, atol=1e-6)


@every_shape
def test_description_goes_both_ways(shape) -> None:
    again = surfaces.from_description(json.loads(json.dumps(shape.describe())))
    assert type(again) is type(shape) and again.describe() == shape.describe()
    x = shape.point(*sample(shape)) + 1e-3
    np.testing.assert_array_equal(again.chart(x)[2], shape.chart(x)[2])


def test_nodes_off_a_curve_are_noticed() -> None:
    shape = SHAPES[-1]
    points = shape.point(*sample(shape)) + np.array([[1e-4], *[[0.0]] * 39]) * shape.normal(0.05, 0.0)
    assert 1e-6 < replace(shape, fit_tolerance=2e-4).fitted(points).deviation < 1.01e-4
    with pytest.raises(InputError, match="the facets do not fit the shape"):
        shape.fitted(points)


@pytest.mark.parametrize("shape", SHAPES[:-1], ids=lambda s: s.kind)  # a curve is not fitted
@pytest.mark.parametrize("arc", [0.4, 3.14])
def test_nodes_are_recovered(shape, arc) -> None:
    theta, z = np.meshgrid(np.linspace(-arc, arc, 17)[:-1], np.linspace(-0.009, 0.011, 7), indexing="ij")
    if shape.kind == "plane":
        theta = 0.05 * theta
    points, normals = shape.point(theta, z).reshape(-1, 3), shape.normal(theta, z).reshape(-1, 3)
    kept = {"axis_point": None, "axis_direction": None}
    if shape.kind == "plane":
        kept = {"origin": None, "outward": None}
    else:
        kept["radius"] = None
    if shape.kind == "profiled_cylinder":
        kept.pop("axis_direction")  # a table need not be symmetric
    for name in ("crown_radius", "groove_radius", "half_angle"):
        if hasattr(shape, name):
            kept[name] = None
    found = replace(shape, **kept).fitted(points, normals)
    assert found.deviation < 1e-11
    np.testing.assert_allclose(found.chart(points)[2], 0.0, atol=1e-11)
    probe = shape.point(theta, 0.9 * z) + 1e-3 * shape.normal(theta, 0.9 * z)
    np.testing.assert_allclose(found.chart(probe)[2], 1e-3, rtol=1e-5)
    if shape.kind != "plane":
        same = found.e_a @ shape.e_a > 0.0
        assert float(found.radius) == pytest.approx(
            float(shape.radius_at((found.axis_point - shape.axis_point) @ shape.e_a)), rel=1e-7
        )
        if shape.kind in ("cone", "conical_bore"):
            assert found.half_angle == pytest.approx(shape.half_angle if same else -shape.half_angle, rel=1e-7)


@every_shape
def test_the_other_side_is_noticed(shape) -> None:
    theta, z = np.meshgrid(np.linspace(-0.5, 0.5, 9), np.linspace(-0.009, 0.009, 5), indexing="ij")
    points, normals = shape.point(theta, z).reshape(-1, 3), shape.normal(theta, z).reshape(-1, 3)
    shape.fitted(points, normals)
    cure = "reverse the order" if shape.kind == "extruded" else "Bore"
    with pytest.raises(InputError, match=f"point to the wrong side of this surface.*{cure}"):
        shape.fitted(points, -normals)


def test_a_cone_is_put_where_its_radius_is() -> None:
    shape = surfaces.Cone(radius=0.05, half_angle=0.3, **PLACED)
    theta, z = np.meshgrid(np.linspace(-2, 2, 9), np.linspace(0.01, 0.03, 5), indexing="ij")
    found = surfaces.Cone(radius=0.05, axis_direction=AXIS).fitted(shape.point(theta, z).reshape(-1, 3))
    np.testing.assert_allclose(found.axis_point, CENTER, atol=1e-10)


def test_a_plane_lies_as_its_facets_do() -> None:
    points = np.array([[x, y, 0.2] for x in (0.0, 0.3, 1.0) for y in (-0.1, 0.0, 0.5)])
    up = np.tile([0.0, 0.0, 1.0], (9, 1))
    for sign in (1.0, -1.0):
        plane = surfaces.Plane().fitted(points, sign * up)
        np.testing.assert_allclose(plane.outward, [0, 0, sign], atol=1e-15)
        np.testing.assert_allclose(plane.origin, [0.5, 0.2, 0.2], atol=1e-12)
        np.testing.assert_allclose(plane.e_1, [1, 0, 0], atol=1e-15)  # theta runs along x
    with pytest.raises(InputError, match="determine the side of the material; give outward"):
        surfaces.Plane().fitted(points)
    np.testing.assert_allclose(surfaces.Plane(outward=(0, 0, 3)).fitted(points).origin, [0.5, 0.2, 0.2], atol=1e-12)


def test_a_table_keeps_its_values_and_goes_straight_on() -> None:
    shape = surfaces.ProfiledCylinder(radius=0.05, table=(Z_TABLE, DROP), **PLACED)
    np.testing.assert_allclose(0.05 - shape.radius_at(Z_TABLE), DROP, atol=1e-17)
    fine = np.linspace(-0.012, 0.013, 2001)
    assert np.all(np.diff(0.05 - shape.radius_at(fine))[fine[:-1] > 0.004] >= 0.0)  # no overshoot
    np.testing.assert_allclose(shape.radius_at(np.linspace(-0.003, 0.004, 9)), 0.05, rtol=1e-15)
    for end in (Z_TABLE[0], Z_TABLE[-1]):
        assert shape.slope_at(end + 1e-12) == pytest.approx(float(shape.slope_at(end - 1e-12)), abs=1e-6)
        outside = end + np.sign(end) * np.array([0.01, 0.02, 0.05])
        np.testing.assert_allclose(shape.slope_at(outside), shape.slope_at(end), rtol=1e-12)


def test_logarithmic_profile_against_its_formula() -> None:
    L, A, e = 0.03, 2e-5, 1e-4
    shape = surfaces.ProfiledCylinder.logarithmic(radius=0.05, length=L, amplitude=A, end_drop=e, **PLACED)
    z = np.linspace(-0.5 * L, 0.5 * L, 5001)
    exact = A * np.log(1.0 / (1.0 - (1.0 - np.exp(-e / A)) * (2.0 * z / L) ** 2))
    np.testing.assert_allclose(0.05 - shape.radius_at(z), exact, atol=1e-4 * e)
    assert exact[0] == pytest.approx(e)


def test_a_tight_groove_ends_where_it_ends() -> None:
    # a ball's far side, beyond the centre of the groove, must not count as near: there is no surface there
    groove = surfaces.Groove(radius=0.03, groove_radius=0.01, **PLACED)
    e_r = groove.radial(0.4)
    _, z, distance = groove.chart(CENTER + (0.03 + 0.0195) * e_r)
    assert distance == pytest.approx(np.hypot(0.0095, 0.01)) and abs(z) == pytest.approx(0.01)
    ring = surfaces.Ring(radius=0.05, groove_radius=0.01, **PLACED)
    assert ring.chart(CENTER + (0.05 - 0.0195) * e_r)[2] == pytest.approx(np.hypot(0.0095, 0.01))


def test_profile_numbers_are_the_shape() -> None:
    # what the device is given is enough to rebuild R(z)
    z = np.linspace(-0.009, 0.009, 9)
    for shape in SHAPES:
        p = shape.profile()
        assert p.planar == (shape.kind in LENGTHS) and p.flat == (shape.kind == "plane") and p.side == shape.side
        R = p.radius + p.tangent * z
        if p.crown:
            R = R - (p.crown - np.sign(p.crown) * np.sqrt(p.crown**2 - z**2))
        if len(p.breaks):
            k = np.clip(np.searchsorted(p.breaks, z, side="right") - 1, 0, len(p.coefficients) - 1)
            R = R - sum(p.coefficients[k, i] * (z - p.breaks[k]) ** i for i in range(4))
        np.testing.assert_allclose(shape.radius_at(z), R, rtol=1e-14)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: surfaces.Sphere(radius=-1.0), "surface sphere: radius must be greater than zero"),
        (lambda: surfaces.Bore(radius=0.0), "surface bore: radius must be greater than zero"),
        (lambda: surfaces.Ring(groove_radius=-0.1), "surface ring: groove_radius"),
        (lambda: surfaces.Groove(groove_radius=float("nan")), "surface groove: groove_radius must be finite"),
        (lambda: surfaces.Cone(half_angle=np.radians(90.0)), "must lie between -89.99 and 89.99 degrees.*Plane"),
        (lambda: surfaces.ConicalBore(half_angle=0.0), "half_angle.*not be 0.*use Bore"),
        (lambda: surfaces.Plane(outward=(0, 0, 0)), "outward has zero length"),
        (lambda: surfaces.Plane(outward=(0, 0, 1), direction=(0, 0, 2)), "direction must not be parallel"),
        (lambda: surfaces.Plane(origin=(0, 0)), "origin must have shape"),
        (lambda: surfaces.ProfiledCylinder(radius=0.05), "table is missing"),
        (lambda: surfaces.ProfiledCylinder(table=3.0), r"table must be \(z, drop\)"),
        (lambda: surfaces.ProfiledCylinder(table=([0, 1], [0, 1, 2])), "one length, got 2 of z and 3 of drop"),
        (lambda: surfaces.ProfiledCylinder(table=([0, 1], [0, 1], [0])), "2 of z and 2 of drop and 1 of slope"),
        (lambda: surfaces.ProfiledCylinder(table=([0, 1], ["a", "b"])), "table must be an array"),
        (lambda: surfaces.ProfiledCylinder(table=([0.0], [0.0])), "at least two points"),
        (
            lambda: surfaces.ProfiledCylinder(table=([-0.01, 0.002, 0.001, 0.01], [0, 0, 0, 0])),
            "is not monotonic: z must increase, but entry 3 is 0.001 m after 0.002 m",
        ),
        (lambda: surfaces.ProfiledCylinder(table=([0.0, 0.01, 0.0101], [0, 0, 0.01])), "too steep at z"),
        (
            lambda: surfaces.ProfiledCylinder(table=([-0.02, -0.01, 0.01, 0.02], [5e-3, 5e-3, 0.0, 0.0]), radius=4e-3),
            "drops by 0.005 m, more than the radius",
        ),
        (
            lambda: surfaces.ProfiledCylinder(table=([-2e-3, -1e-4, 0.0, 1e-4, 2e-3], [0.0, 1e-3, 1.05e-3, 1e-3, 0.0])),
            "intersects itself: near z = .* its normals cross",
        ),
        (lambda: surfaces.ProfiledCylinder.logarithmic(length=0.0, amplitude=1e-5, end_drop=1e-4), "length"),
        (
            lambda: surfaces.ProfiledCylinder.logarithmic(length=0.03, amplitude=2e-5, end_drop=2e-4),
            "end_drop must be below .* too steep",
        ),
        (
            lambda: surfaces.ProfiledCylinder.logarithmic(length=0.02, amplitude=1e-6, end_drop=9.5e-6),
            "end_drop 9.5e-06 m is too much for an amplitude of 1e-06 m.*smaller end_drop or a greater amplitude",
        ),
        (
            lambda: surfaces.ProfiledCylinder.logarithmic(length=0.5, amplitude=1e-2, end_drop=1e-2, radius=5e-3),
            "end_drop must be below the radius",
        ),
    ],
)
def test_border(make, match) -> None:
    with pytest.raises(InputError, match=match):
        make()


def test_a_cone_that_is_nearly_a_disc_is_for_no_mesh() -> None:
    disc = surfaces.Cone(radius=0.05, half_angle=np.radians(85.0), axis_point=(0, 0, 0), axis_direction=AXIS)
    theta, z = np.meshgrid(np.linspace(0.0, 6.0, 20), [0.0, 1e-4, 2e-4])
    with pytest.raises(InputError, match="of a mesh the half_angle must lie between -80 and 80 degrees"):
        disc.fitted(disc.point(theta, z).reshape(-1, 3))


def test_nodes_that_do_not_determine_or_do_not_fit() -> None:
    with pytest.raises(InputError, match="sphere: 3 points cannot determine 4 unknowns"):
        surfaces.Sphere().fitted(np.eye(3))
    with pytest.raises(InputError, match="lie in one plane and determine no sphere"):
        surfaces.Sphere().fitted([[np.cos(t), np.sin(t), 0.0] for t in range(8)])
    line = [[0.1 * k, 0.0, 0.0] for k in range(6)]
    with pytest.raises(InputError, match="on a line|on one line"):
        surfaces.Plane().fitted(line, np.tile([0.0, 0, 1], (6, 1)))
    cylinder = SHAPES[0].point(*np.meshgrid(np.linspace(-3, 3, 12), np.linspace(-0.01, 0.01, 4))).reshape(-1, 3)
    with pytest.raises(InputError, match="do not fit the shape"):
        surfaces.Sphere().fitted(cylinder)
    with pytest.raises(InputError, match="show no cone.*Cylinder"):
        surfaces.Cone(axis_direction=AXIS).fitted(cylinder)
    with pytest.raises(InputError, match="show no groove.*Cylinder|do not fit"):
        surfaces.Groove(axis_direction=AXIS).fitted(
            SHAPES[1].point(*np.meshgrid(np.linspace(-3, 3, 12), np.linspace(-0.01, 0.01, 5))).reshape(-1, 3)
        )
    wide = surfaces.ProfiledCylinder(radius=0.05, table=([-0.005, 0.0, 0.005], [0.0, 0.0, 0.0]), **PLACED)
    with pytest.raises(InputError, match="the facets reach from .* the table only"):
        wide.fitted(cylinder)
    with pytest.raises(InputError, match="not determined yet; call fitted"):
        surfaces.Plane().point(0.0, 0.0)
    with pytest.raises(InputError, match="half_angle is not determined yet"):
        surfaces.Cone(radius=1.0, **PLACED).radius_at(0.0)
    with pytest.raises(InputError, match="surface 'ball' does not exist; known: 'cylinder'"):
        surfaces.from_description({"kind": "ball"})
