"""Pictures of the unwrapped patch: which value lands in which pixel."""

from __future__ import annotations

import numpy as np
import pytest
from shape_runs import contact_of, ellipsoid, grid_of

from warpffrf.model.surfaces import Bore, Cylinder, Plane, Sphere
from warpffrf.output.recording.patch_map import MapWindow, cell_map, map_window, node_map, pixels

R, AXIS = 0.03, (0.0, 1.0, 0.0)
SPACING = 1e-4
Z = np.array([-0.01, -0.004, 0.0, 0.006, 0.01])
A = 4e-4


def line(side: float = 1.0):
    shape = (Cylinder if side > 0.0 else Bore)(radius=R, axis_point=(0, 0, 0), axis_direction=AXIS)
    grid = grid_of(shape, SPACING / R, 21, Z)
    floor = Plane(origin=(R, 0, 0), outward=(-1.0, 0.0, 0.0))
    return contact_of(shape, grid, floor, lambda t, z: ellipsoid(A, 1.0, 1e9)(R * t, 0.0 * z))


def test_a_window_holds_the_patch() -> None:
    contact = line()
    window = map_window(contact, np.array([0]))
    assert window.reach == pytest.approx(3.0 * contact.half_width[0])
    assert (window.low, window.high) == (Z[0], Z[-1])
    ball = Sphere(radius=R, axis_point=(0, 0, 0), axis_direction=AXIS)
    z = np.linspace(-3e-3, 3e-3, 61)
    spot = contact_of(
        ball, grid_of(ball, SPACING / R, 21, z), Plane(origin=(R, 0, 0), outward=(-1.0, 0.0, 0.0)),
        lambda t, z: ellipsoid(A, 2 * A, 1e9)(R * t, z - 5e-4),
    )  # fmt: skip
    found = map_window(spot, np.array([0]))
    width = spot.half_widths[0, 1]
    assert (found.low, found.high) == pytest.approx((5e-4 - 3.0 * width, 5e-4 + 3.0 * width), rel=1e-2)


def test_a_pair_that_never_touches_shows_its_window() -> None:
    contact = line()
    contact.history.pressure[:] = 0.0
    assert map_window(contact, np.array([0])).reach == pytest.approx(0.5 * 21 * SPACING)


def test_nodes_are_bilinear_and_cells_constant() -> None:
    contact = line()
    window = MapWindow(8.0 * SPACING, float(Z[0]), float(Z[-1]))
    values = np.random.default_rng(3).random((21, 5))
    shape = (200, 320)
    x, z = window.x(shape[1]), window.z(shape[0])
    arc = contact.arc[0]
    grid_nodes, cells = node_map(contact, 0, values, window, shape), cell_map(contact, 0, values, window, shape)
    for row, column in ((3, 5), (60, 200), (120, 17), (199, 319)):
        assert np.sum(np.abs(x[column] - arc) <= 0.5 * SPACING) >= 1
        nearest = values[np.argmin(np.abs(arc - x[column])), np.argmin(np.abs(Z - z[row]))]
        assert cells[row, column] == nearest
        along = [np.interp(x[column], arc, v) for v in values.T]
        assert grid_nodes[row, column] == pytest.approx(np.interp(z[row], Z, along))


def test_nothing_beyond_the_grid_s_window() -> None:
    contact = line()
    wide = MapWindow(30.0 * SPACING, float(Z[0]), float(Z[-1]))
    picture = cell_map(contact, 0, np.ones((21, 5), dtype=np.int8), wide, (4, 120))
    filled = np.flatnonzero(picture[0])
    assert wide.x(120)[filled].max() < 10.5 * SPACING and wide.x(120)[filled].min() > -10.5 * SPACING
    assert picture.dtype == np.int8 and len(filled) == 42


def test_an_inside_form_is_mirrored() -> None:
    values = np.random.default_rng(4).random((21, 5))
    window = MapWindow(8.0 * SPACING, float(Z[0]), float(Z[-1]))
    outside, inside = (cell_map(line(side), 0, values, window, (10, 96)) for side in (1.0, -1.0))
    assert np.array_equal(outside[:, ::-1], inside)


def test_pixels_of_the_nodes() -> None:
    contact = line()
    window = MapWindow(10.0 * SPACING, float(Z[0]), float(Z[-1]))
    at = pixels(contact, 0, window, (100, 200))
    assert at.shape == (21, 5, 2)
    assert at[10, 2] == pytest.approx([100.0, 50.0]) and at[0, 0] == pytest.approx([0.0, 100.0])
    assert at[20, 4] == pytest.approx([200.0, 0.0])
