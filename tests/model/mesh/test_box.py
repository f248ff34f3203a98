"""Structured boxes and grids: volume, orientation, sides, what is left out, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh, box, grid
from warpffrf.model.mesh.shapes.boxes import SIDES

ROUND_OFF = 1e-12


@pytest.mark.parametrize("order", [1, 2])
def test_a_box_has_its_volume_and_its_six_sides(order: int) -> None:
    size, center = np.array([0.4, 0.03, 0.02]), np.array([1.0, 2.0, 3.0])
    mesh = box(size, (5, 2, 1), center=center, order=order)
    mesh.check()
    assert mesh.volume() == pytest.approx(size.prod(), rel=ROUND_OFF)
    for n, side in enumerate(SIDES):
        axis, upper = divmod(n, 2)
        ((_, nodes),) = mesh.facets(side).blocks.items()
        at = center[axis] + (upper - 0.5) * size[axis]
        assert mesh.points[nodes][..., axis] == pytest.approx(at, abs=ROUND_OFF)
        others = np.delete((5, 2, 1), axis)
        assert len(nodes) == others.prod()
    outer = sum(len(mesh.facets(side)) for side in SIDES)
    assert len(mesh.outer_facets()) == outer  # the six sides are the whole surface


@pytest.mark.parametrize("order", [1, 2])
def test_sides_point_outwards(order: int) -> None:
    mesh = box((1.0, 2.0, 3.0), (2, 1, 1), order=order)
    for n, side in enumerate(SIDES):
        axis, upper = divmod(n, 2)
        ((_, nodes),) = mesh.facets(side).blocks.items()
        a, b, c = (mesh.points[nodes[:, i]] for i in range(3))
        normal = np.cross(b - a, c - a)
        assert np.all(np.argmax(np.abs(normal), axis=1) == axis)
        assert np.all(np.sign(normal[:, axis]) == 2 * upper - 1)


def test_a_frame_holds_only_the_filled_cells() -> None:
    """A window frame: the box less its hole, uneven grid lines."""
    x, z = np.array([0.0, 0.1, 0.5, 0.9, 1.0]), np.array([0.0, 0.2, 0.4, 0.6, 0.8])
    filled = np.ones((4, 1, 4), dtype=bool)
    filled[1:3, :, 1:3] = False
    mesh = grid(x, [0.0, 0.05], z, filled=filled, order=1)
    mesh.check()
    assert mesh.volume() == pytest.approx((1.0 * 0.8 - 0.8 * 0.4) * 0.05, rel=ROUND_OFF)
    assert mesh.cell_count == 12
    # 5 x 5 lines of a plane, less the one node inside the hole, two planes
    assert len(mesh.points) == 2 * (5 * 5 - 1)


def test_the_sides_of_a_frame_are_those_of_its_used_planes() -> None:
    filled = np.zeros((3, 1, 1), dtype=bool)
    filled[1] = True
    mesh = grid([0.0, 1.0, 2.0, 3.0], [0.0, 1.0], [0.0, 1.0], filled=filled, order=1)
    ((_, nodes),) = mesh.facets("x_max").blocks.items()
    assert mesh.points[nodes][..., 0] == pytest.approx(2.0)


def test_pieces_that_do_not_touch_are_refused_by_the_check() -> None:
    filled = np.array([True, False, True])[:, None, None]
    mesh: Mesh = grid([0.0, 1.0, 2.0, 3.0], [0.0, 1.0], [0.0, 1.0], filled=filled)
    with pytest.raises(InputError, match="part"):
        mesh.check()


def test_bad_input_is_named() -> None:
    with pytest.raises(InputError, match="size must be greater than zero"):
        box((1.0, 0.0, 1.0), (1, 1, 1))
    with pytest.raises(InputError, match="counts along y"):
        box((1.0, 1.0, 1.0), (1, 0, 1))
    with pytest.raises(InputError, match="three numbers of cells"):
        box((1.0, 1.0, 1.0), 4)
    with pytest.raises(InputError, match="order must be 1"):
        box((1.0, 1.0, 1.0), (1, 1, 1), order=3)
    with pytest.raises(InputError, match="grid: y: at least two grid lines"):
        grid([0.0, 1.0], [0.0, 0.0], [0.0, 1.0])
    with pytest.raises(InputError, match=r"bool array \(1, 1, 1\)"):
        grid([0.0, 1.0], [0.0, 1.0], [0.0, 1.0], filled=np.ones((2, 1, 1), dtype=bool))
    with pytest.raises(InputError, match="no cell is filled"):
        grid([0.0, 1.0], [0.0, 1.0], [0.0, 1.0], filled=np.zeros((1, 1, 1), dtype=bool))
