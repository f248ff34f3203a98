"""Hertz's contacts in nodes, bounds made of them, and mean displacements of cells."""

from __future__ import annotations

import numpy as np
import pytest

from references.closed_forms import LineContact, PointContact, contact_modulus
from references.half_space.influence import influence_3d, mean_2d, mean_3d, strip_displacement
from references.half_space.node_pressures import bounding, edge_beyond, line_pressures, point_pressures
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material

STEEL = Material(210e9, 0.3, 7800.0, name="steel")
LINE = LineContact(1e5, 0.025, contact_modulus(STEEL, STEEL))
POINT = PointContact(100.0, 0.01, contact_modulus(STEEL))
DEPTH = 10.0  # half-widths
EDGE = 0.06  # columns: how well the ratio of the last two pressures shows where the patch ends
MOMENT = 0.6  # of the second moment, over the square of the cells in a half-width; either sign, by the phase
GAUSS = 1e-5  # of 16 points in a cell compared with logarithms at its ends


def row(cells: float, phase: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Nodes, coefficients and spacing of the line."""
    w = LINE.half_width / cells
    n = int(np.ceil(cells)) + 3
    x = w * (np.arange(-n, n + 1) + phase)
    return x, line_pressures(LINE, x, DEPTH * LINE.half_width), w


@pytest.mark.parametrize("phase", [0.0, 0.2, 0.5, 0.9])
@pytest.mark.parametrize("cells", [6, 8, 12])
def test_line_has_hertz_s_load_moment_and_edge(cells: int, phase: float) -> None:
    x, p, w = row(cells, phase)
    a = LINE.half_width
    assert p.sum() * w == pytest.approx(LINE.load, rel=1e-12)
    middle = p @ x / p.sum()
    second = p @ ((x - middle) ** 2 + w * w / 6.0) / p.sum()
    assert second == pytest.approx(0.25 * a * a, rel=MOMENT / cells**2)
    edge = x[0] + w * edge_beyond(p)
    assert abs(edge - a) < EDGE * w


def test_point_has_hertz_s_load_and_moment() -> None:
    a = POINT.half_width
    w = a / 6.0
    k = w * np.arange(-9, 10)
    nodes = np.stack(np.meshgrid(k, k, indexing="ij"), axis=-1)
    p = point_pressures(POINT, nodes)
    assert p.sum() * w * w == pytest.approx(POINT.load, rel=1e-12)
    assert np.allclose(p, p.T, rtol=1e-9, atol=1e-9 * p.max())
    # int r^2 p = 2/5 a^2 of the load
    second = (p * ((nodes**2).sum(axis=2) + w * w / 3.0)).sum() / p.sum()
    assert second == pytest.approx(0.4 * a * a, rel=MOMENT)


def test_bounds_lie_half_way_to_the_mean_over_the_cell_and_keep_the_load() -> None:
    x, p, w = row(8, 0.3)
    found = bounding(p)
    assert found.sum() == pytest.approx(p.sum(), rel=1e-14)
    parts = (np.arange(40) + 0.5) / 40 - 0.5  # exact for what is linear in either half of a cell
    means = np.mean([np.interp(x + w * t, x, p) for t in parts], axis=0)
    assert np.allclose(found, 0.5 * (p + means), rtol=1e-12, atol=1e-12 * p.max())
    grid = np.outer(p, p)
    assert bounding(grid).sum() == pytest.approx(grid.sum(), rel=1e-13)
    assert np.allclose(bounding(grid), bounding(grid).T)


def test_mean_displacements_are_averages_of_those_at_points() -> None:
    t, weight = np.polynomial.legendre.leggauss(16)
    t, weight = 0.5 * t, 0.5 * weight
    offset = np.subtract.outer(np.arange(6.0), np.arange(6.0))
    wanted = sum(g * strip_displacement(offset + s, 1.0, 3.0, 9.0) for g, s in zip(weight, t, strict=True))
    assert np.allclose(mean_2d(6, 1.0, 3.0, 9.0), wanted, rtol=0.0, atol=GAUSS * np.abs(wanted).max())
    # cells of unequal sides: those seen are points of one grid with the loaded ones
    size = (0.2, 0.3)
    nodes = np.stack(np.meshgrid(size[0] * np.arange(3), size[1] * np.arange(3), indexing="ij"), axis=-1).reshape(-1, 2)
    found = mean_3d(nodes, size, STEEL)
    averaged = np.zeros((18, 18))
    for g, s in zip(weight, t, strict=True):
        for f, r in zip(weight, t, strict=True):
            both = np.concatenate([nodes + (s * size[0], r * size[1]), nodes])
            averaged += g * f * influence_3d(both, size, STEEL)[:18, 18:]
    assert np.allclose(found, averaged, rtol=0.0, atol=10.0 * GAUSS * np.abs(averaged).max())
    assert np.allclose(found, found.T, rtol=0.0, atol=1e-12 * np.abs(found).max())
    assert np.linalg.eigvalsh(found).min() > 0.0


def test_a_grid_that_the_patch_leaves_is_refused() -> None:
    x = LINE.half_width / 8.0 * np.arange(-3, 4)
    with pytest.raises(InputError, match="give nodes beyond it"):
        line_pressures(LINE, x, DEPTH * LINE.half_width)
