"""Cuts along a plane: what is doubled and what is not, which way faces look, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh, box, grid, roller
from warpffrf.model.mesh.facets import outer_faces

LINES = np.array([0.0, 5.0, 10.0, 20.0, 25.0, 30.0]) * 1e-3  # a shank of 10 x 10 mm, air around it, walls
HEIGHT = np.array([0.0, 5.0, 10.0, 20.0, 30.0, 35.0, 40.0]) * 1e-3
MIDDLE = (15e-3, 15e-3, 20e-3)


def clamp(order: int = 1) -> Mesh:
    """Two plates held apart by walls, with a shank in the middle and air around it."""
    filled = np.ones((5, 5, 6), dtype=bool)
    filled[1:4, 1:4, 2:4] = False
    filled[2, 2, :] = True
    return grid(LINES, LINES, HEIGHT, filled=filled, order=order)


def area_vector(mesh: Mesh, name: str) -> np.ndarray:
    total = np.zeros(3)
    for corners in mesh.facets(name).corners.values():
        x = mesh.points[corners]
        total += 0.5 * np.cross(x[:, 2] - x[:, 0], x[:, -1] - x[:, 1]).sum(axis=0)
    return total


@pytest.mark.parametrize("order", [1, 2])
def test_faces_look_at_each_other_and_the_body_stays_whole(order: int) -> None:
    mesh = clamp(order)
    parted = mesh.cut("shank", point=MIDDLE, normal=(0, 0, 2.0), radius=8e-3).check()
    new = len(parted.points) - len(mesh.points)
    assert new == (order + 1) ** 2  # the nodes of one face
    np.testing.assert_allclose(area_vector(parted, "shank_low"), (0, 0, 1e-4), atol=1e-18)
    np.testing.assert_allclose(area_vector(parted, "shank_high"), (0, 0, -1e-4), atol=1e-18)
    low, high = (parted.facets(f"shank_{side}") for side in ("low", "high"))
    assert not set(low.node_set) & set(high.node_set)
    np.testing.assert_array_equal(
        np.unique(parted.points[low.node_set], axis=0), np.unique(parted.points[high.node_set], axis=0)
    )
    assert parted.volume() == pytest.approx(mesh.volume(), rel=1e-14)
    outer = outer_faces(parted.cells)
    assert len(outer) == len(outer_faces(mesh.cells)) + 2  # both faces of the cut are outside now
    np.testing.assert_array_equal(parted.facets("z_max").node_set, mesh.facets("z_max").node_set)


def test_a_cell_set_limits_a_cut_as_a_radius_does() -> None:
    mesh = clamp()
    center = np.concatenate([mesh.points[nodes].mean(axis=1) for nodes in mesh.cells.values()])
    bolt = np.flatnonzero(np.all(np.abs(center[:, :2] - 15e-3) < 1e-3, axis=1))
    named = Mesh(mesh.points, mesh.cells, mesh.facet_sets, cell_sets={"bolt": bolt})
    by_set = named.cut("a", point=(0, 0, 20e-3), normal=(0, 0, 1), cells="bolt")
    by_radius = named.cut("a", point=MIDDLE, normal=(0, 0, 1), radius=8e-3)
    assert by_set.content_hash() == by_radius.content_hash()


def test_nodes_on_the_rim_inside_the_body_stay_one() -> None:
    mesh = box((0.03, 0.03, 0.02), (6, 6, 2), order=1)
    slit = mesh.cut("slit", point=(0, 0, 0), normal=(0, 0, 1), radius=11.5e-3)
    assert len(slit.facets("slit_low")) == 12  # of the 4 x 4 around the point those that reach no corner at 14 mm
    assert len(slit.points) - len(mesh.points) == 5  # the point and its four neighbours have such faces only
    slit.check()


def test_facet_sets_follow_their_side() -> None:
    """A cut from the side: facets next to it belong to the cell that they are on."""
    mesh = box((0.04, 0.01, 0.02), (4, 1, 2), order=1)
    split = mesh.cut("slit", point=(0.02, 0, 0), normal=(0, 0, 1), radius=0.0225)
    assert len(split.points) - len(mesh.points) == 4  # two columns of nodes: the third holds
    split.check()
    number = {tuple(np.sort(f)) for f in outer_faces(split.cells).blocks["quad4"]}
    for name in split.facet_sets:
        assert all(tuple(np.sort(f)) in number for f in split.facets(name).blocks["quad4"]), name


def test_refusals() -> None:
    mesh, up = clamp(), (0, 0, 1)
    with pytest.raises(
        InputError, match=r"'bolt': the plane goes through 1 cells.*nearest corner of the cells is 0.004 m off.*move"
    ):
        mesh.cut("bolt", point=(15e-3, 15e-3, 24e-3), normal=up, radius=8e-3)
    with pytest.raises(InputError, match="leaves parts of .* cells that are not connected.*radius"):
        mesh.cut("bolt", point=MIDDLE, normal=up)
    with pytest.raises(
        InputError, match="no faces between two cells lie on the plane.*nearest corner of the cells is 0.01 m off"
    ):
        mesh.cut("bolt", point=(15e-3, 15e-3, 50e-3), normal=up)
    with pytest.raises(InputError, match="no node is within 0.001"):
        mesh.cut("bolt", point=(5e-2, 15e-3, 20e-3), normal=up, radius=1e-3)
    solid = box((0.04, 0.04, 0.02), (8, 8, 2), order=1)
    with pytest.raises(InputError, match="connects all nodes of its 1 faces"):
        solid.cut("bolt", point=(2.5e-3, 2.5e-3, 0), normal=up, radius=4e-3)
    with pytest.raises(InputError, match="no faces between two cells.*no whole face.*larger radius"):
        solid.cut("bolt", point=(0, 0, 0), normal=up, radius=1e-3)
    with pytest.raises(InputError, match="unknown|cell set"):
        mesh.cut("bolt", point=MIDDLE, normal=up, cells="shank")
    named = mesh.cut("bolt", point=MIDDLE, normal=up, radius=8e-3)
    with pytest.raises(InputError, match="'bolt_low' exists"):
        named.cut("bolt", point=MIDDLE, normal=up, radius=8e-3)


def test_a_periodic_body_is_periodic_no_more() -> None:
    ring = roller(outer_radius=0.03, inner_radius=0.01, width=0.02, sectors=12, layers=2, axial=2, order=1)
    cut = ring.cut("slit", point=(0.02, 0, 0), normal=(0, 0, 1), radius=0.015)
    assert cut.cyclic is None and "periodic" in cut.notes[-1]
