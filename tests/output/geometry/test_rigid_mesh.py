"""Meshes of rigid bodies against exact geometry: radii of vertices, watertightness, volumes."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.output.geometry.rigid_mesh import CAGE, RigidMesh, rigid_meshes
from warpffrf.output.geometry.scene_view import BodyView, SceneView
from warpffrf.output.geometry.solids import AROUND, TriangleMesh, rod

ROUND_OFF = 1e-12  # of the size
POLYGON = AROUND / (2.0 * np.pi) * np.sin(2.0 * np.pi / AROUND)  # area of the polygon over that of its circle
D, PITCH, LENGTH, END, PLAY = 0.01, 0.06, 0.012, 0.05, 2e-4  # m


def is_watertight(mesh: TriangleMesh) -> bool:
    """Whether every edge belongs to two triangles, in opposite directions."""
    same = np.unique(np.round(mesh.points, 10) + 0.0, axis=0, return_inverse=True)[1].reshape(-1)
    t = same[mesh.triangles]
    edges = np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
    there, count = np.unique(edges, axis=0, return_counts=True)
    back = {tuple(e) for e in there[:, ::-1].tolist()}
    return bool(np.all(count == 1)) and back == {tuple(e) for e in there.tolist()}


def run(scene: wf.Scene) -> wf.Result:
    return wf.simulate(scene, 1e-6, step=1e-6, start="initial", progress=False)


def across(points: np.ndarray) -> np.ndarray:
    """Distances from the y axis."""
    return np.hypot(points[:, 0], points[:, 2])


@pytest.fixture(scope="module")
def balls() -> wf.Result:
    scene = wf.Scene()
    geometry = wf.bearings.BallGeometry(
        elements=8, ball_diameter=D, pitch_diameter=PITCH, contact_angle=np.radians(20.0), bore=0.035, width=0.016
    )
    bearing = scene.add_bearing("b", geometry, outer=scene.ground, position=(0.1, 0.2, 0.3))
    scene.add(wf.joints.Fixed(scene.ground, bearing.inner, axis=(0, 1, 0)))
    return run(scene)


@pytest.fixture(scope="module")
def rollers() -> wf.Result:
    scene = wf.Scene()
    geometry = wf.bearings.RollerGeometry(
        elements=10, roller_diameter=D, roller_length=LENGTH, pitch_diameter=PITCH, profile=2.0, clearance=1e-5
    )
    flanges = wf.bearings.Flanges(PLAY, inner="front", end_radius=END)
    bearing = scene.add_bearing("r", geometry, outer=scene.ground, flanges=flanges)
    scene.add(wf.joints.Fixed(scene.ground, bearing.inner, axis=(0, 1, 0)))
    return run(scene)


@pytest.fixture(scope="module", params=[0.5 * np.pi, -0.5 * np.pi])
def thrust(request: pytest.FixtureRequest) -> wf.Result:
    scene = wf.Scene()
    geometry = wf.bearings.BallGeometry(
        elements=8, ball_diameter=D, pitch_diameter=PITCH, contact_angle=request.param, bore=0.042, width=0.016
    )
    bearing = scene.add_bearing("t", geometry, outer=scene.ground)
    scene.add(wf.joints.Fixed(scene.ground, bearing.inner, axis=(0, 1, 0)))
    return run(scene)


def test_washers_have_grooves(thrust: wf.Result) -> None:
    meshes = rigid_meshes(thrust)
    geometry: Any = thrust.bearing("t").geometry
    for side, name, sense in (("inner", "t inner ring", -1.0), ("outer", "ground", 1.0)):
        points = meshes[name].points
        R, z = geometry.arc_centre(side, geometry.tracks[0])
        on_arc = np.abs(np.hypot(across(points) - R, points[:, 1] - z) - geometry.groove(side)) < 1e-12
        assert on_arc.sum() >= 33 * AROUND and across(points).min() == pytest.approx(0.021, rel=ROUND_OFF)
        along = sense * np.sign(geometry.contact_angle) * points[:, 1]
        assert along.min() > 0.0 and along.max() == pytest.approx(0.008, rel=ROUND_OFF)
        assert along[on_arc].max() == pytest.approx(0.5 * D, rel=1e-9)


def test_every_mesh_is_watertight_and_looks_outwards(balls: wf.Result, rollers: wf.Result, thrust: wf.Result) -> None:
    for result in (balls, rollers, thrust):
        for name, mesh in rigid_meshes(result).items():
            assert is_watertight(mesh), name
            assert mesh.volume > 0.0 and not mesh.marker, name


def test_a_ball_has_its_radius_and_nearly_its_volume(balls: wf.Result) -> None:
    mesh = rigid_meshes(balls)["b ball 3"]
    assert np.linalg.norm(mesh.points, axis=1) == pytest.approx(0.5 * D, rel=ROUND_OFF)
    assert mesh.volume == pytest.approx(np.pi * D**3 / 6.0, rel=2e-3)  # facets lie within
    assert np.einsum("ni,ni->n", mesh.normals, mesh.points) == pytest.approx(0.5 * D, rel=2e-3)


def test_rings_of_a_ball_bearing_have_the_raceways(balls: wf.Result) -> None:
    meshes, geometry = rigid_meshes(balls), wf.bearings.BallGeometry(
        elements=8, ball_diameter=D, pitch_diameter=PITCH, contact_angle=np.radians(20.0)
    )  # fmt: skip
    inner, outer = meshes["b inner ring"].points, meshes["ground"].points - [0.1, 0.2, 0.3]
    assert across(inner).min() == pytest.approx(0.0175, rel=ROUND_OFF)  # the given bore
    assert np.abs(inner[:, 1]).max() == pytest.approx(0.008, rel=ROUND_OFF)
    for side, points in (("inner", inner), ("outer", outer)):
        R, z = geometry.arc_centre(side, geometry.tracks[0])
        r = geometry.groove(side)
        within = np.abs(np.hypot(across(points) - R, points[:, 1] - z) - r) < 1e-9
        assert within.sum() >= 33 * AROUND  # vertices on the torus of the groove, the others beyond its shoulders
        # no vertex of a ring lies within a ball in its middle position
        middle = 0.5 * PITCH
        assert np.hypot(across(points) - middle, points[:, 1]).min() >= 0.5 * D - 1e-9


def test_a_roller_has_its_crown_and_its_ends(rollers: wf.Result) -> None:
    points = rigid_meshes(rollers)["r roller 4"].points
    z, rho = points[:, 1], across(points)
    assert np.abs(z).max() == pytest.approx(0.5 * LENGTH, rel=ROUND_OFF)  # the tops of both spherical ends
    skin = np.abs(rho - (0.5 * D - (2.0 - np.sqrt(4.0 - z**2)))) < 1e-12
    ends = np.abs(np.hypot(rho, np.abs(z) - (0.5 * LENGTH - END)) - END) < 1e-12
    assert np.all(skin | ends) and skin.sum() > AROUND and ends.sum() > AROUND
    assert rho.max() == pytest.approx(0.5 * D, rel=ROUND_OFF)


def test_ribs_stand_next_to_the_rollers(rollers: wf.Result) -> None:
    meshes = rigid_meshes(rollers)
    inner, outer = meshes["r inner ring"].points, meshes["ground"].points
    bottom = 0.5 * (PITCH - D) - 0.25e-5
    assert across(inner)[inner[:, 1] < 0.4 * LENGTH].max() == pytest.approx(bottom, rel=ROUND_OFF)
    assert across(inner)[inner[:, 1] > 0.51 * LENGTH].max() > bottom + 0.2 * D  # the front rib alone
    for sign in (-1.0, 1.0):
        assert across(outer)[sign * outer[:, 1] > 0.51 * LENGTH].min() < 0.5 * (PITCH + D) - 0.2 * D


def test_the_cage_is_a_band_of_exact_volume(balls: wf.Result) -> None:
    height, width = CAGE[0] * D, CAGE[1] * D
    exact = np.pi * PITCH * 2.0 * height * 2.0 * width
    assert rigid_meshes(balls)["b cage"].volume == pytest.approx(POLYGON * exact, rel=1e-9)


def drawn(geometry: Any) -> dict[str, RigidMesh]:
    scene = wf.Scene()
    bearing = scene.add_bearing("b", geometry, outer=scene.ground)
    scene.add(wf.joints.Fixed(scene.ground, bearing.inner, axis=(0, 1, 0)))
    return rigid_meshes(run(scene))


@pytest.mark.parametrize("designation", ["32008", "22208", "C 2210", "3208", "QJ 208", "81110", "29320"])
def test_every_kind_is_watertight_and_looks_outwards(designation: str) -> None:
    for name, mesh in drawn(wf.bearings.catalogue(designation)).items():
        assert is_watertight(mesh) and mesh.volume > 0.0 and not mesh.marker, name


def test_the_outer_ring_of_self_aligning_balls_is_hollowed_once() -> None:
    """By the sphere of both rows: the rings of the outline, whose radii are those of the vertices over z."""
    alpha, diameter, pitch = np.radians(14.0), 0.01, 0.05
    meshes = drawn(wf.bearings.BallGeometry(
        elements=12, ball_diameter=diameter, pitch_diameter=pitch, contact_angle=-alpha, rows=2,
        osculation=(0.52, 0.5 + 0.5 * pitch / np.cos(alpha) / diameter), row_spacing=pitch * np.tan(alpha),
    ))  # fmt: skip
    mesh = meshes["ground"]
    z, r = np.round(mesh.points[:, 1], 9), across(mesh.points)
    levels = np.unique(z)
    bore = np.array([r[z == level].min() for level in levels])
    hollow = np.sum(np.diff(levels) * (bore[1:] ** 2 + bore[1:] * bore[:-1] + bore[:-1] ** 2)) / 3.0
    assert is_watertight(mesh)
    exact = POLYGON * np.pi * (r.max() ** 2 * np.ptp(levels) - hollow)
    assert mesh.volume == pytest.approx(exact, rel=1e-6)
    assert bore.max() == pytest.approx(0.5 * (pitch / np.cos(alpha) + diameter), rel=1e-3)


def test_a_cylinder_has_the_length_of_its_inertia() -> None:
    """A solid cylinder of radius R, length L on a plane: I = m R^2/2 about its axis, m (3 R^2 + L^2)/12 across it."""
    R, L, m = 0.02, 0.07, 3.0
    scene = wf.Scene()
    skin = wf.surfaces.Cylinder(radius=R, axis_point=(0, 0, 0), axis_direction=(0, 1, 0))
    across_axis = m * (3.0 * R**2 + L**2) / 12.0
    body = scene.add_rigid_body(
        m, (across_axis, 0.5 * m * R**2, across_axis), name="roll", position=(0, 0, R), surfaces={"skin": skin}
    )
    floor = scene.ground.surface(wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)), name="floor")
    scene.add(wf.LumpedContact(body["skin"], floor, law=wf.laws.PalmgrenLine(L), name="on"))
    scene.add_rigid_body(1.0, (1e-3,) * 3, name="bare", position=(0.1, 0, 0.1))
    meshes = rigid_meshes(run(scene))
    roll = meshes["roll"]
    assert roll.volume == pytest.approx(POLYGON * np.pi * R**2 * L, rel=1e-9)
    assert np.abs(roll.points[:, 1]).max() == pytest.approx(0.5 * L, rel=1e-9)
    assert meshes["ground"].points[:, 2].max() == pytest.approx(0.0, abs=1e-15)  # the plate ends at the plane
    assert is_watertight(meshes["ground"]) and is_watertight(roll)
    assert meshes["bare"].marker and np.ptp(meshes["bare"].points, axis=0).max() < 0.1 * L


def test_a_sleeve_is_hollow() -> None:
    """A body with a bore and an outside form about one axis: one ring between them."""
    scene = wf.Scene()
    axis: dict[str, Any] = {"axis_point": (0, 0, 0), "axis_direction": (0, 1, 0)}
    sleeve = scene.add_rigid_body(1.0, (1e-3,) * 3, name="sleeve", surfaces={
        "bore": wf.surfaces.Bore(radius=0.02, **axis), "outside": wf.surfaces.Cylinder(radius=0.03, **axis),
    })  # fmt: skip
    pin = scene.ground.surface(wf.surfaces.Sphere(radius=0.019, axis_point=(1e-3, 0, 0)), name="pin")
    pad = scene.ground.surface(wf.surfaces.Sphere(radius=0.01, axis_point=(0, 0, 0.04)), name="pad")
    for surface, other in (("bore", pin), ("outside", pad)):
        law = wf.laws.PowerForce(1e6, 1.0)
        scene.add(wf.LumpedContact(sleeve[surface], other, law=law, name=surface))
    mesh = rigid_meshes(run(scene))["sleeve"]
    length = np.ptp(mesh.points[:, 1])
    assert is_watertight(mesh)
    assert mesh.volume == pytest.approx(POLYGON * np.pi * (0.03**2 - 0.02**2) * length, rel=1e-9)


def test_a_rod_reaches_from_end_to_end() -> None:
    mesh = rod(np.array([1.0, 2.0, 3.0]), np.array([1.0, 2.0, 7.0]), 0.1, 8)
    assert mesh.volume == pytest.approx(4.0 * np.sin(np.pi / 4.0) * 0.1**2 * 4.0, rel=1e-12)
    assert is_watertight(mesh) and np.ptp(mesh.points[:, 2]) == pytest.approx(4.0)


AXIS: dict[str, Any] = {"axis_point": (0.01, 0.0, 0.0), "axis_direction": (0.0, 1.0, 0.0)}
X, Y = (v.ravel() for v in np.meshgrid(np.linspace(-0.02, 0.02, 21), np.linspace(-0.01, 0.01, 11), indexing="ij"))
SHAPES = {
    "mesh": wf.surfaces.MeshSurface(outward=(0.0, 0.0, 1.0)).fitted(np.column_stack([X, Y, 3.0 * X * Y - 4.0 * Y**2])),
    "cylinder": wf.surfaces.Cylinder(radius=0.02, **AXIS),
    "crowned": wf.surfaces.CrownedCylinder(radius=0.02, crown_radius=0.5, **AXIS),
    "profiled": wf.surfaces.ProfiledCylinder(radius=0.02, table=([-0.01, 0.0, 0.01], [1e-4, 0.0, 1e-4]), **AXIS),
    "groove": wf.surfaces.Groove(radius=0.02, groove_radius=0.006, **AXIS),
    "sphere": wf.surfaces.Sphere(radius=0.02, **AXIS),
    "cone": wf.surfaces.Cone(radius=0.02, half_angle=0.2, **AXIS),
    "plane": wf.surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.6, 0.0, 0.8)),
    "bore": wf.surfaces.Bore(radius=0.02, **AXIS),
    "ring": wf.surfaces.Ring(radius=0.02, groove_radius=0.006, **AXIS),
    "cup": wf.surfaces.Cup(radius=0.02, **AXIS),
    "conical bore": wf.surfaces.ConicalBore(radius=0.02, half_angle=0.2, **AXIS),
}


@pytest.mark.parametrize("kind", SHAPES)
def test_a_body_of_every_surface_is_a_solid_that_ends_at_it(kind: str) -> None:
    shape = SHAPES[kind]
    body = BodyView("body", None, 1.0, np.zeros(3), 1e-4 * np.eye(3), {"skin": shape})
    history = SimpleNamespace(bodies={}, contacts={}, lumped_contacts={})
    result = SimpleNamespace(view=SceneView("hash", {"body": body}), history=history, time=np.zeros(1))
    mesh = rigid_meshes(result, 0.1)["body"]
    assert is_watertight(mesh) and mesh.volume > 0.0 and not mesh.marker
    distance = shape.chart(mesh.points)[2]
    on = np.abs(distance) < 1e-9
    assert distance.max() < 1e-9  # no vertex lies in the free space
    assert np.sum(on) >= (4 if kind == "plane" else AROUND)
    corners = mesh.triangles[np.all(on[mesh.triangles], axis=1)]  # triangles of the surface itself look outwards
    middle = mesh.points[corners].mean(axis=1)
    area = np.cross(mesh.points[corners[:, 1]] - mesh.points[corners[:, 0]],
                    mesh.points[corners[:, 2]] - mesh.points[corners[:, 0]])  # fmt: skip
    theta, z, _ = shape.chart(middle)
    assert np.all(np.einsum("ti,ti->t", area, shape.normal(theta, z)) > 0.0)
