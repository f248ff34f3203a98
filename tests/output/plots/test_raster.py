"""Triangles as pixels: which one is in front, where they meet, and values between their corners."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.output.geometry.solids import ball
from warpffrf.output.plots import raster
from warpffrf.output.plots.raster import colored, facing, lit, rasterized

LOW, HIGH, SHAPE = np.array([-1.0, -0.75]), np.array([1.0, 0.75]), (80, 60)


def centers() -> tuple[np.ndarray, np.ndarray]:
    """x and y (height, width) of the centres of the pixels."""
    x, y = (LOW[k] + (np.arange(SHAPE[k]) + 0.5) * (HIGH[k] - LOW[k]) / SHAPE[k] for k in (0, 1))
    return np.meshgrid(x, y)


def square(slope: float, reach: float = 2.0) -> np.ndarray:
    """Corners (2, 3, 3) of a square of which depth is `slope` times x."""
    a, b, c, d = ([x, y, slope * x] for x, y in ((-reach, -reach), (reach, -reach), (reach, reach), (-reach, reach)))
    return np.array([[a, b, c], [a, c, d]])


@pytest.mark.parametrize("chunk", [50, 1_000_000])
def test_planes_that_cross_hide_each_other_on_either_side(monkeypatch: pytest.MonkeyPatch, chunk: int) -> None:
    """z = x and z = -x: the nearer one is drawn at every pixel, at the depth |x|."""
    monkeypatch.setattr(raster, "CHUNK", chunk)
    x, _ = centers()
    depth, face, weights = rasterized(np.concatenate([square(1.0), square(-1.0)]), LOW, HIGH, SHAPE)
    assert depth.reshape(x.shape) == pytest.approx(np.abs(x), abs=1e-12)
    assert np.array_equal(face.reshape(x.shape) < 2, x > 0.0)
    assert weights.sum(axis=1) == pytest.approx(1.0) and weights.min() > -1e-8


def test_values_are_linear_and_the_light_multiplies_them() -> None:
    x, y = centers()
    points = square(0.3).reshape(-1, 3)
    values = 2.0 * points[:, 0] - points[:, 1]
    faces = lit(
        points, np.arange(6).reshape(2, 3), np.eye(3), values, lambda v: np.stack([v, 0.0 * v, 1.0 + 0.0 * v], 1)
    )
    _, found, rgb = colored([faces], LOW, HIGH, SHAPE)
    assert found == pytest.approx(2.0 * x - y, abs=1e-12)
    assert rgb[..., 0] == pytest.approx(found * rgb[..., 2]) and np.ptp(rgb[..., 2]) < 1e-12
    assert raster.AMBIENT < rgb[0, 0, 2] <= 1.0


def test_a_triangle_covers_the_pixels_whose_centers_it_contains() -> None:
    """Also one that reaches beyond the picture, and none that is seen edge-on."""
    x, y = centers()
    corners = np.array(
        [[[-3.0, -0.5, 0.0], [0.6, -0.55, 1.0], [0.1, 2.0, 2.0]], [[0.0, 0.0, 5.0], [1.0, 1.0, 5.0], [2.0, 2.0, 5.0]]]
    )
    _, face, _ = rasterized(corners, LOW, HIGH, SHAPE)
    a, b, c = corners[0, :, :2]
    inside = np.ones(x.shape, dtype=bool)
    for p, q in ((a, b), (b, c), (c, a)):
        inside &= (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]) >= 0.0
    assert np.array_equal(face.reshape(x.shape) == 0, inside) and 0.2 < inside.mean() < 0.8 and np.all(face < 1)


def test_a_ball_has_no_holes_and_half_of_it_is_seen() -> None:
    x, y = centers()
    mesh = ball((0.0, 0.0, 0.0), np.eye(3), 0.7)
    corners = mesh.points[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    near = facing(corners, normals)
    assert near.mean() == pytest.approx(0.5, abs=0.02)
    assert np.array_equal(facing(corners[:, ::-1], -normals), near)  # inside out
    assert np.all(facing(corners[:50], normals[:50]))  # an open part
    depth, face, _ = rasterized(corners[near], LOW, HIGH, SHAPE)
    r = np.hypot(x, y)
    assert np.all((face.reshape(r.shape) >= 0)[r < 0.69]) and np.all((face.reshape(r.shape) < 0)[r > 0.7])
    inner = r < 0.6
    assert depth.reshape(r.shape)[inner] == pytest.approx(np.sqrt(0.49 - r[inner] ** 2), abs=2e-3)


def test_classes_are_not_mixed() -> None:
    points = square(0.0).reshape(-1, 3)
    state = np.array([0.0, 2.0, 2.0, 0.0, 2.0, 0.0])
    faces = lit(points, np.arange(6).reshape(2, 3), np.eye(3), state, lambda v: np.stack([v] * 3, axis=1), nearest=True)
    _, found, _ = colored([faces], LOW, HIGH, SHAPE)
    assert set(np.unique(found)) == {0.0, 2.0}
