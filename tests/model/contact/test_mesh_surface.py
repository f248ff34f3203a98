"""Smooth surfaces through the nodes of a mesh: accuracy, nearest points by brute force, curvatures, what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial import KDTree

import warpffrf as wf
from warpffrf.model import surfaces
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh, box

RADIUS = 0.05  # m
LENGTH, WIDTH = 0.02, 0.014  # m, of the face
COUNTS = (11, 8, 3)  # cells: facets of 1.8 mm


def dome(x: Any, y: Any) -> Any:
    return np.sqrt(RADIUS**2 - x**2 - y**2) - RADIUS


def dome_normals(points: np.ndarray) -> np.ndarray:
    return (points + [0.0, 0.0, RADIUS]) / RADIUS


def wavy(x: Any, y: Any) -> Any:
    """A saddle with waves, of a smallest radius of 7 mm."""
    return 8.0 * x**2 - 5.0 * y**2 + 2.0 * x * y + 1.5e-4 * np.sin(900.0 * x) * np.cos(700.0 * y)


def block(height: Any, *, order: int = 2) -> Mesh:
    """A block whose face `top` has the form z = height(x, y); nodes that are moved along the face by a third of a
    cell."""
    flat = box((LENGTH, WIDTH, 5e-3), COUNTS, center=(0.0, 0.0, -2.5e-3), order=order)
    x, y, z = flat.points.T
    inner = np.cos(np.pi * x / LENGTH) * np.cos(np.pi * y / WIDTH)
    x, y = x + 6e-4 * inner * np.sin(500.0 * y), y + 6e-4 * inner * np.cos(600.0 * x)
    points = np.column_stack([x, y, z + (1.0 + z / 5e-3) * height(x, y)])
    return Mesh(points, flat.cells, {"top": flat.facet_sets["z_max"], "sides": flat.facet_sets["x_max"]}, name="block")


def grid_of(height: Any, count: int = 61) -> np.ndarray:
    x, y = (v.ravel() for v in np.meshgrid(*(np.linspace(-0.01, 0.01, count),) * 2, indexing="ij"))
    return np.column_stack([x, y, height(x, y)])


UP: Any = {"outward": (0.0, 0.0, 1.0), "direction": (0.0, 1.0, 0.0)}
CAP = surfaces.MeshSurface(**UP).fitted(grid_of(wavy))


def places(shape: Any, count: int, part: float = 0.95) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(2)
    theta, z = (rng.uniform(-part * a, part * a, count) for a in shape.half)
    return theta, z


@pytest.mark.parametrize("order", [1, 2])
def test_it_is_the_sphere_that_the_nodes_lie_on(order: int) -> None:
    """Between nodes it lies within 20 nm of the sphere, whose facets are off by 8 um, and its normals and curvatures
    are those of it."""
    shape = surfaces.MeshSurface.of(block(dome, order=order), "top")
    assert shape.deviation < 1e-9
    theta, z = places(shape, 2000)
    away = shape.point(theta, z) + [0.0, 0.0, RADIUS]
    assert np.abs(np.linalg.norm(away, axis=1) - RADIUS).max() < 2e-8
    assert np.abs(shape.normal(theta, z) - away / RADIUS).max() < 1e-4
    for curvature in shape.curvatures(*places(shape, 2000, 0.7)):
        assert curvature == pytest.approx(1.0 / RADIUS, rel=0.01)


def test_frame_and_tangents() -> None:
    """e_theta is the tangent along theta, and e_theta, t_z and the normal are right-handed."""
    theta, z = places(CAP, 100)
    n, around, along = CAP.normal(theta, z), CAP.around(theta, z), CAP.along(theta, z)
    np.testing.assert_allclose(np.cross(around, along), n, atol=1e-14)
    step = 1e-7
    moved = CAP.point(theta + step, z) - CAP.point(theta - step, z)
    np.testing.assert_allclose(around, moved / np.linalg.norm(moved, axis=1)[:, None], atol=1e-7)
    up = CAP.point(theta, z + step) - CAP.point(theta, z - step)
    assert np.abs(np.sum(up * n, axis=1)).max() < 1e-8 * step + 1e-16


def test_the_tensor_of_curvatures_is_how_the_normal_turns() -> None:
    theta, z = places(CAP, 200)
    tensor, step = CAP.curvature_tensor(theta, z), 1e-7
    assert np.abs(np.einsum("nij,nj->ni", tensor, CAP.normal(theta, z))).max() < 1e-9
    for d_theta, d_z in ((step, 0.0), (0.0, step)):
        turned = CAP.normal(theta + d_theta, z + d_z) - CAP.normal(theta - d_theta, z - d_z)
        moved = CAP.point(theta + d_theta, z + d_z) - CAP.point(theta - d_theta, z - d_z)
        assert np.abs(np.einsum("nij,nj->ni", tensor, moved) - turned).max() < 1e-5 * np.abs(turned).max()


def test_no_nearest_point_is_missed() -> None:
    """Of 100,000 random points up to 4 mm off a saddle with waves, also next to it, none is nearer to any of 63,001
    points of the surface than to the one found, and the chart leads back to it."""
    rng = np.random.default_rng(4)
    x = rng.uniform([-0.011, -0.011, -0.004], [0.011, 0.011, 0.004], (100_000, 3))
    fine = np.linspace(-1.0, 1.0, 251)
    theta, z = (v.ravel() for v in np.meshgrid(CAP.half[0] * fine, CAP.half[1] * fine, indexing="ij"))
    sampled, _ = KDTree(CAP.point(theta, z)).query(x)
    assert np.max(np.abs(CAP.gap(x)) - sampled) < 1e-12
    theta, z = places(CAP, 1000)
    for off in (-1e-4, 1e-6, 1e-3):
        back = CAP.chart(CAP.point(theta, z) + off * CAP.normal(theta, z))
        np.testing.assert_allclose(back, np.broadcast_arrays(theta, z, off), atol=1e-12)


def test_beyond_the_border_is_free_space() -> None:
    corner = CAP.point(*CAP.half)
    assert CAP.gap(corner + [1e-3, 2e-3, 0.0]) == pytest.approx(np.hypot(1e-3, 2e-3), rel=1e-6)
    assert CAP.gap(CAP.point(CAP.half[0], 0.0) + [1e-3, 0.0, -5e-4]) > 1e-3
    theta, _, distance = CAP.chart(corner + [1e-3, 0.0, -5e-4])  # the chart continues
    assert theta > CAP.half[0] and distance < 0.0


def test_the_description_goes_both_ways() -> None:
    again = surfaces.from_description(json.loads(json.dumps(CAP.describe())))
    assert type(again) is surfaces.MeshSurface and again.describe() == CAP.describe()
    x = CAP.point(*places(CAP, 50)) + 1e-3
    np.testing.assert_array_equal(again.chart(x)[2], CAP.chart(x)[2])


def test_a_rigid_surface_is_that_of_a_mesh() -> None:
    scene = wf.Scene()
    scene.ground.surface(surfaces.MeshSurface.of(block(dome), "top"), name="floor")
    with pytest.raises(InputError, match=r"use MeshSurface\.of\(mesh, facet_set\)"):
        scene.ground.surface(surfaces.MeshSurface(), name="other")


def rough() -> np.ndarray:
    """Nodes of which two lie above each other."""
    points = grid_of(dome)
    return np.concatenate([points, points[1860:1861] + [0.0, 0.0, 1e-6]])


def folded() -> np.ndarray:
    angle, y = np.meshgrid(np.linspace(-2.0, 2.0, 21), np.linspace(-0.01, 0.01, 11), indexing="ij")
    return np.column_stack([0.01 * np.sin(angle).ravel(), y.ravel(), 0.01 * np.cos(angle).ravel()])


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: surfaces.MeshSurface(**UP).fitted(grid_of(dome, 3)), "9 nodes determine no smooth surface"),
        (lambda: surfaces.MeshSurface(**UP).fitted(grid_of(lambda x, y: 0.3 * np.abs(x))), "an edge lies within"),
        (lambda: surfaces.MeshSurface(**UP, spacing=4e-4).fitted(rough()), "do not fit the shape"),
        (
            lambda: surfaces.MeshSurface(**UP).fitted(folded(), folded() * [100.0, 0.0, 100.0]),
            "115 degrees steep to the plane.*or fold over it; choose fewer facets",
        ),
        (lambda: surfaces.MeshSurface(**UP).fitted(grid_of(dome), 0.0 * grid_of(dome)), "have no normal"),
        (lambda: surfaces.MeshSurface(spacing=-1.0), "spacing must be greater than zero"),
        (lambda: surfaces.MeshSurface(half=(1.0, 1.0)), "half and coefficients belong together"),
        (lambda: replace(CAP, coefficients=np.zeros((3, 4))), r"coefficients \(4, 4\) at least"),
        (lambda: surfaces.MeshSurface().chart(np.zeros(3)), "are not determined yet"),
        (lambda: surfaces.MeshSurface.of(block(dome), "bottom"), "bottom"),
    ],
)
def test_what_is_refused(make: Any, match: str) -> None:
    with pytest.raises(InputError, match=match):
        make()


def test_the_side_of_the_material_is_noticed() -> None:
    points = grid_of(dome)
    up, down = dome_normals(points), -dome_normals(points)
    assert surfaces.MeshSurface().fitted(points, up).e_0 @ [0.0, 0.0, 1.0] > 0.99
    assert surfaces.MeshSurface().fitted(points, down).e_0 @ [0.0, 0.0, 1.0] < -0.99
    with pytest.raises(InputError, match="steep to the plane"):
        surfaces.MeshSurface(**UP).fitted(points, down)


def test_it_is_in_scene_files() -> None:
    from warpffrf.scene_file.load import scene_of

    text = (
        '[meshes.block]\nkind = "box"\nsize = [0.02, 0.02, 0.01]\ncounts = [5, 5, 2]\n'
        '[ground.floor]\nkind = "mesh_surface"\nmesh = "block"\nfacet_set = "z_max"\ndirection = [0, 1, 0]\n'
    )
    mesh = box((0.02, 0.02, 0.01), (5, 5, 2))
    made = surfaces.MeshSurface.of(mesh, "z_max", direction=(0, 1, 0))
    assert scene_of(text).scene.ground["floor"].surface.shape.describe() == made.describe()
    with pytest.raises(InputError, match="mesh and facet_set belong together"):
        _ = scene_of(text.replace('facet_set = "z_max"\n', "")).scene
