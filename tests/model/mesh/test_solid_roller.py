"""A roller without bore: cross section, volume, sets, quality of the cells, and what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh, roller
from warpffrf.model.mesh.periodicity import detect
from warpffrf.model.mesh.shapes.disc import CORE, disc
from warpffrf.model.mesh.shapes.revolved import layer_depths

R, WIDTH = 0.05, 0.02
STEEL = Material(210e9, 0.3, 7850.0)
ROUND_OFF = 1e-12
SOUND = 0.5  # sine of the angles: those of a transition are 45 degrees, less a few where four do not divide a ring
SLENDER = 5.0  # longest over shortest edge: a layer takes a second transition at 4.8, its last cells are the longest


def solid(order: int = 2, **more: Any) -> Mesh:
    return roller(R, 0, WIDTH, **{"sectors": 96, "layers": 5, "axial": 2, "order": order, **more})


def polygon(n: int, order: int) -> float:
    """Area of the unit circle's polygon; of order 2 each side is a parabola through the middle of its arc."""
    a = np.pi / n
    return n * (np.sin(a) * np.cos(a) + (0.0 if order == 1 else 4.0 / 3.0 * np.sin(a) * (1.0 - np.cos(a))))


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("sectors", [8, 12, 60, 96])
def test_volume_is_that_of_the_polygon(sectors: int, order: int) -> None:
    """Exact: only the sides at the rim, chords or parabolas, leave the circle."""
    mesh = solid(order, sectors=sectors, layers=3).check()
    assert mesh.volume() == pytest.approx(polygon(sectors, order) * R**2 * WIDTH, rel=ROUND_OFF)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("more", [{}, {"crown_radius": 0.2}, {"tread": 0.005}, {"axial": [-0.01, 0.002, 0.01]}])
def test_rim_is_that_of_a_hollow_roller(order: int, more: dict) -> None:
    """The same facets in the same places, whatever is inside; equal to round-off of the radii."""
    hollow = roller(R, 0.3 * R, WIDTH, **{"sectors": 96, "layers": 5, "axial": 2, "order": order, **more})
    mesh = solid(order, **more)
    for name in ("rim", "tread")[: 2 if "tread" in more else 1]:
        assert np.abs(_places(mesh, name) - _places(hollow, name)).max() < ROUND_OFF * R


def _places(mesh: Mesh, name: str) -> np.ndarray:
    return mesh.points[mesh.facets(name).single[1]]


def test_sets_on_the_end_faces() -> None:
    """Both ends are the whole faces, journals the circles of 0.4 R with nodes all around, mid nodes included."""
    mesh = solid()
    assert set(mesh.sets) == {"rim", "ends", "end_low", "end_high", "journal_low", "journal_high"}
    for name, y, reach in (
        ("end_low", -1, 1.0),
        ("end_high", 1, 1.0),
        ("journal_low", -1, CORE),
        ("journal_high", 1, CORE),
    ):
        x = mesh.points[mesh.facets(name).node_set]
        assert np.all(x[:, 1] == 0.5 * y * WIDTH)
        radius = np.hypot(x[:, 0], x[:, 2])
        edge = radius > (1.0 - 1e-9) * reach * R
        assert radius.max() == pytest.approx(reach * R, rel=ROUND_OFF)
        angle = np.sort(np.arctan2(x[edge, 2], x[edge, 0]))
        np.testing.assert_allclose(np.diff(angle), 2.0 * np.pi / edge.sum(), rtol=1e-9)
        normals = mesh.facets(name).node_normals(mesh.points)
        np.testing.assert_allclose(normals, np.broadcast_to([0.0, y, 0.0], normals.shape), atol=ROUND_OFF)


def test_mass_and_inertia_are_those_of_a_cylinder() -> None:
    """Equal about both cross axes to round-off, for all quarters are alike; else what 96 parabolas leave, 4e-8."""
    report = solid().report(STEEL)
    mass = STEEL.density * np.pi * R**2 * WIDTH
    across = mass * (3.0 * R**2 + WIDTH**2) / 12.0
    assert report.mass == pytest.approx(mass, rel=1e-7)
    assert report.inertia is not None and report.center is not None
    np.testing.assert_allclose(np.diag(report.inertia), [across, 0.5 * mass * R**2, across], rtol=2e-7)
    assert abs(report.inertia[0, 0] - report.inertia[2, 2]) < ROUND_OFF * across
    np.testing.assert_allclose(report.center, 0.0, atol=ROUND_OFF * R)


@pytest.mark.parametrize("order", [1, 2])
def test_a_solid_barrel(order: int) -> None:
    """A ball with flat ends, crown as large as the radius: mid nodes of the crown are on it, the volume is closed."""
    mesh = roller(0.01, 0, 0.012, crown_radius=0.01, sectors=96, layers=5, axial=8, order=order).check()
    x = mesh.points[mesh.facets("rim").node_set]
    assert np.abs(np.linalg.norm(x, axis=1) - 0.01).max() < ROUND_OFF * 0.01
    exact = np.pi * (0.01**2 * 0.012 - 2.0 * 0.006**3 / 3.0)
    # chords leave out (2 pi/96)^2/6 = 7e-4 around and 4.9e-3 in eight rows along; parabolas the fourth power of angles
    assert mesh.volume() == pytest.approx(exact, rel=6e-3 if order == 1 else 1e-5)


@pytest.mark.parametrize("quarter", [2, 3, 5, 6, 7, 11, 25, 50, 75, 137, 151, 301])
@pytest.mark.parametrize(("layers", "grading"), [(None, None), (None, 1.2), (4, None), (12, None)])
def test_cells_are_well_shaped(quarter: int, layers: int | None, grading: float | None) -> None:
    """Angles of all cells, whether or not four divide a ring's count; no long ones where layers are chosen."""
    sectors = 4 * quarter
    section = disc(sectors, 1.0 - layer_depths(1.0 - CORE, layers, grading, 2.0 * np.pi / sectors), 1)
    x = section.points[section.cells[:, [0, 1, 1, 0], [0, 0, 1, 1]]]
    edge = np.roll(x, -1, axis=1) - x
    length = np.linalg.norm(edge, axis=-1)
    before, size = np.roll(edge, 1, axis=1), length * np.roll(length, 1, axis=1)
    sine = (before[..., 0] * edge[..., 1] - before[..., 1] * edge[..., 0]) / size
    assert sine.min() > SOUND
    if layers is None:
        assert (length.max(axis=1) / length.min(axis=1)).max() < SLENDER


def test_cells_are_few_in_the_middle() -> None:
    """A fine rim does not make a fine core: a core of 600 x 600 cells would be 150 columns a sector."""
    section = disc(2400, 1.0 - layer_depths(1.0 - CORE, None, None, 2.0 * np.pi / 2400), 1)
    assert len(section.cells) < 8 * 2400 and len(section.cells) - section.core < 200


@pytest.mark.parametrize(
    ("sectors", "order", "reason"), [(32, 1, "on the axis"), (12, 2, "on the axis"), (12, 1, "more than two sectors")]
)
def test_it_is_not_periodic(sectors: int, order: int, reason: str) -> None:
    """The axis passes through nodes, or with an odd number of linear cells in the core through a cell."""
    mesh = solid(order, sectors=sectors, layers=2, axial=4)
    found = detect(mesh)
    assert mesh.cyclic is None and found.mesh is None and reason in found.reason


def test_counts_follow_the_half_width() -> None:
    for order, cells in ((1, 2.0), (2, 1.0)):
        mesh = roller(R, 0, WIDTH, half_width=2e-3, order=order)
        sectors = len(mesh.facets("rim")) * order // (len(np.unique(mesh.points[:, 1])) - 1)
        wanted = 2.0 * np.pi * R * cells / 2e-3
        assert sectors % 4 == 0 and wanted <= sectors < wanted + 4


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"sectors": 30}, "multiple of 4, got 30; use 32"),
        ({"sectors": 4}, "sectors.*at least 8"),
        ({"layers": 0}, "layers.*at least 1"),
        ({"order": 3}, "order"),
        ({"profile": lambda y: 0.0 * y}, "no wall"),
        ({"half_width": 0.07}, "as large as the wall"),
    ],
)
def test_impossible_rollers_are_refused(change: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        solid(**change)


def test_a_negative_bore_is_refused() -> None:
    with pytest.raises(InputError, match="inner_radius must not be negative"):
        roller(R, -0.01, WIDTH, half_width=1e-3)
