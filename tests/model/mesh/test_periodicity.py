"""Rotational periodicity: bodies whose numbering was shuffled, cut into tetrahedra, bent, rounded, or spoilt."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from warpffrf import examples
from warpffrf.model import mesh as wfmesh
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import periodicity
from warpffrf.model.mesh.facets import FacetSet, outer_faces
from warpffrf.offline.cyclic.sector import periodicity_fault

R, R_I, WIDTH = 0.05, 0.015, 0.02
TET_ROLLER = examples.path("roller") / "roller.msh"
# the six tetrahedra about the diagonal 0-6 of a hexahedron: opposite faces are cut alike, so neighbours fit
TETS = np.array([(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)])


def roller(order: int = 1, sectors: int = 12, layers: int = 2, axial: int = 2) -> wfmesh.Mesh:
    return wfmesh.roller(R, R_I, WIDTH, sectors=sectors, layers=layers, axial=axial, order=order)


def shuffled(mesh: wfmesh.Mesh, seed: int = 0) -> wfmesh.Mesh:
    """The same body with nodes, cells and facets in random order, and no periodicity."""
    rng = np.random.default_rng(seed)
    old = rng.permutation(len(mesh.points))
    new = np.argsort(old)
    cells, cell_sets, start = {}, {}, 0
    new_cell = np.empty(mesh.cell_count, dtype=np.int64)
    for kind, nodes in mesh.cells.items():
        order = rng.permutation(len(nodes))
        cells[kind] = new[nodes][order]
        new_cell[start + order] = start + np.arange(len(nodes))
        start += len(nodes)
    cell_sets = {name: new_cell[members] for name, members in mesh.cell_sets.items()}
    facet_sets = {
        name: FacetSet({k: new[n][rng.permutation(len(n))] for k, n in facets.blocks.items()})
        for name, facets in mesh.facet_sets.items()
    }
    return replace(mesh, points=mesh.points[old], cells=cells, facet_sets=facet_sets, cell_sets=cell_sets, cyclic=None)


def bent(mesh: wfmesh.Mesh, sectors: int, amount: float, seed: int = 3) -> wfmesh.Mesh:
    """Nodes moved at random by a fraction of a cell, alike in `sectors` sectors; amounts of angle, radius, height."""
    rng = np.random.default_rng(seed)
    x, z = mesh.points[:, 0], mesh.points[:, 2]
    nn = len(mesh.points) // sectors
    noise = np.tile(rng.uniform(-1.0, 1.0, (nn, 3)), (sectors, 1)) * amount
    theta = np.arctan2(-z, x) + noise[:, 0] * 2 * np.pi / mesh.cyclic.sectors  # pyright: ignore
    r = np.hypot(x, z) * (1.0 + 0.1 * noise[:, 1])
    points = np.stack([r * np.cos(theta), mesh.points[:, 1] * (1.0 + 0.1 * noise[:, 2]), -r * np.sin(theta)], axis=1)
    return replace(mesh, points=points)


def in_tets(mesh: wfmesh.Mesh) -> wfmesh.Mesh:
    cells = {"tet4": mesh.cells["hex8"][:, TETS].reshape(-1, 4)}
    return wfmesh.Mesh(mesh.points, cells, {"skin": outer_faces(cells)}, name="tets")


def moved(mesh: wfmesh.Mesh) -> tuple[wfmesh.Mesh, np.ndarray, np.ndarray]:
    """The body tilted and away from the origin, with its axis point and direction."""
    Q = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    Q *= np.sign(np.linalg.det(Q))
    shift = np.array([0.3, -0.2, 0.7])
    return replace(mesh, points=mesh.points @ Q.T + shift), shift, Q[:, 1]


def check_numbering(mesh: wfmesh.Mesh, sectors: int) -> None:
    """The contract of docs/architecture.md, with a rotation written out by Rodrigues' formula."""
    assert mesh.cyclic is not None and mesh.cyclic.sectors == sectors
    a, c = mesh.cyclic.axis_direction, mesh.cyclic.axis_point
    phi, n = 2 * np.pi / sectors, len(mesh.points)
    nn = n // sectors
    x = mesh.points - c
    turned = x * np.cos(phi) + np.cross(a, x) * np.sin(phi) + np.outer(x @ a, a) * (1 - np.cos(phi))
    np.testing.assert_allclose(np.roll(x, -nn, axis=0), turned, atol=1e-12 * np.abs(x).max())
    for nodes in mesh.cells.values():
        per = len(nodes) // sectors
        assert nodes[:per].max() < 2 * nn and np.all((nodes[:per] < nn).any(axis=1))
        for s in range(sectors):
            np.testing.assert_array_equal(nodes[s * per : (s + 1) * per], (nodes[:per] + s * nn) % n)
    assert periodicity_fault(mesh, list(mesh.facet_sets)) is None
    mesh.check()


def same_body(a: wfmesh.Mesh, b: wfmesh.Mesh, node: np.ndarray, atol: float = 1e-14) -> None:
    """`a` is `b` with other numbers: same places, same cells and facets by the nodes they hold."""
    np.testing.assert_allclose(a.points, b.points[node], atol=atol)

    def rows(nodes: np.ndarray) -> list[list[int]]:
        return sorted(np.sort(nodes, axis=1).tolist())

    for kind, nodes in a.cells.items():
        assert rows(node[nodes]) == rows(b.cells[kind])
    for name, facets in a.facet_sets.items():
        for kind, nodes in facets.blocks.items():
            assert rows(node[nodes]) == rows(b.facet_sets[name].blocks[kind])
    assert a.volume() == pytest.approx(b.volume(), rel=1e-4 if atol > 1e-10 else 1e-12)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("sectors", [3, 12, 25])
def test_a_shuffled_roller_gets_its_own_numbering_back(order: int, sectors: int) -> None:
    mesh = roller(order, sectors)
    found = periodicity.detect(shuffled(mesh))
    assert found.mesh is not None, found.reason
    check_numbering(found.mesh, sectors)
    np.testing.assert_allclose(found.mesh.points, mesh.points, atol=1e-15)  # the same nodes under the same numbers
    assert {tuple(sorted(r)) for r in found.mesh.single[1].tolist()} == {
        tuple(sorted(r)) for r in mesh.single[1].tolist()
    }
    same_body(found.mesh, shuffled(mesh), found.node)
    assert found.largest_move < 1e-15 and f"{sectors} equal sectors" in found.mesh.notes[-1]


def test_axis_anywhere() -> None:
    mesh, point, axis = moved(shuffled(roller(1, 9)))
    cyclic = mesh.find_periodicity()
    assert cyclic is not None and cyclic.sectors == 9
    assert abs(cyclic.axis_direction @ axis) == pytest.approx(1.0, abs=1e-14)
    np.testing.assert_allclose(np.cross(cyclic.axis_point - point, axis), 0.0, atol=1e-15)
    check_numbering(mesh.with_periodicity(), 9)
    check_numbering(mesh.with_periodicity(axis_point=point, axis_direction=axis, sectors=3), 3)


@pytest.mark.parametrize("around", [7, 21])
@pytest.mark.parametrize("amount", [0.1, 0.25])
def test_tetrahedra_without_node_planes(around: int, amount: float) -> None:
    """7 sectors of 1 or 3 cells around: with 1, cells are wider than a sector and only a bent cut will do."""
    body = shuffled(in_tets(bent(roller(1, around, 3, 3), 7, amount)).check())
    theta = np.arctan2(body.points[:, 2], body.points[:, 0])[body.single[1]]
    width = np.max(np.abs((theta - theta[:, :1] + np.pi) % (2 * np.pi) - np.pi))
    assert (width > 2 * np.pi / 7) == (around == 7)
    found = periodicity.detect(body)
    assert found.mesh is not None, found.reason
    check_numbering(found.mesh, 7)
    same_body(found.mesh, body, found.node)


def test_several_kinds_and_their_sets() -> None:
    """Wedges in the inner layer, hexahedra outside; the sets follow their cells and facets."""
    mesh = roller(1, 10)
    inner = np.hypot(*mesh.points[mesh.single[1]].mean(axis=1)[:, [0, 2]].T) < 0.5 * (R + R_I)
    hexes, cut = mesh.single[1][~inner], mesh.single[1][inner]
    wedges = np.concatenate([cut[:, [0, 1, 2, 4, 5, 6]], cut[:, [0, 2, 3, 4, 6, 7]]])
    mixed = wfmesh.Mesh(mesh.points, {"wedge6": wedges, "hex8": hexes}).check()
    top = np.flatnonzero(np.concatenate([mesh.points[n].mean(axis=1)[:, 1] > 0 for n in mixed.cells.values()]))
    some = mixed.outer_facets()
    on_arc = some.centers(mixed.points)[:, 0] > 0.0
    mixed = replace(mixed, facet_sets={"skin": some, "arc": some.kept(on_arc)}, cell_sets={"top": top})
    body = shuffled(mixed)
    found = periodicity.detect(body)
    assert found.mesh is not None, found.reason
    check_numbering(replace(found.mesh, facet_sets={"skin": found.mesh.facets("skin")}), 10)
    same_body(found.mesh, body, found.node)
    assert np.all(found.mesh.facets("arc").centers(found.mesh.points)[:, 0] > 0.0)
    centers = np.concatenate([found.mesh.points[n].mean(axis=1) for n in found.mesh.cells.values()])
    np.testing.assert_array_equal(np.flatnonzero(centers[:, 1] > 0), found.mesh.cell_sets["top"])


def test_sets_that_must_turn_into_themselves() -> None:
    mesh = roller(1, 12)
    third = np.flatnonzero(np.arange(mesh.cell_count) // 4 % 3 == 0)  # the cells of every third sector
    body = shuffled(replace(mesh, cell_sets={"third": third}))
    assert periodicity.detect(body).mesh.cyclic.sectors == 12  # pyright: ignore
    found = periodicity.detect(body, whole=["third"])
    assert found.mesh is not None
    check_numbering(found.mesh, 4)
    half = mesh.select("half", "rim", lambda x: x[:, 0] > 0)
    assert periodicity.detect(half, whole=["half"]).mesh is None
    with pytest.raises(InputError, match="'tread' is neither"):
        periodicity.detect(mesh, whole=["tread"])


@pytest.mark.parametrize("digits", [5, 8])
def test_nodes_of_a_file_with_few_digits_are_moved_and_reported(digits: int) -> None:
    exact = moved(shuffled(in_tets(bent(roller(1, 18, 2, 2), 6, 0.3))))[0]
    rounded = replace(exact, points=np.round(exact.points / R, digits + 1) * R)  # error up to half the last digit
    found = periodicity.detect(rounded)
    assert found.mesh is not None, found.reason
    check_numbering(found.mesh, 6)
    assert 0.1 * 10.0**-digits / 20 < found.largest_move / R < 10.0**-digits
    same_body(found.mesh, rounded, found.node, atol=10.0**-digits * R)
    assert f"{found.largest_move:.2g} m" in found.mesh.notes[-1]


def spoilt(change: Callable[[np.ndarray], None]) -> wfmesh.Mesh:
    mesh = shuffled(roller(1, 12))
    points = mesh.points.copy()
    change(points)
    return replace(mesh, points=points)


def test_bodies_that_are_not_periodic() -> None:
    def shift_one(points: np.ndarray) -> None:
        points[3] += 1e-4

    def stretch(points: np.ndarray) -> None:
        points[:, 0] *= 1.001

    def taper(points: np.ndarray) -> None:  # moments stay symmetric
        theta = np.arctan2(points[:, 2], points[:, 0])
        points[:, 1] *= 1.0 + 0.1 * np.cos(5 * theta) * np.cos(4 * theta)

    for change in (shift_one, stretch, taper):
        mesh = spoilt(change)
        assert mesh.find_periodicity() is None
        with pytest.raises(InputError, match="is not rotationally periodic: "):
            mesh.with_periodicity()
    assert "second moments" in periodicity.detect(spoilt(stretch)).reason
    assert wfmesh.read(TET_ROLLER, length_unit="mm").find_periodicity() is None


def test_a_node_on_the_axis_belongs_to_no_sector() -> None:
    """A solid disc of wedges about its axis."""
    N = 8
    rim = np.array([(np.cos(t), np.sin(t)) for t in 2 * np.pi * np.arange(N) / N]) * R
    flat = np.concatenate([[[0.0, 0.0]], rim])
    points = np.concatenate([np.insert(flat, 2, z, axis=1) for z in (0.0, 0.004)])
    i = np.arange(N)
    bottom = np.stack([0 * i, 1 + i, 1 + (i + 1) % N], axis=1)
    disc = wfmesh.Mesh(points, {"wedge6": np.concatenate([bottom, bottom + N + 1], axis=1)}).check()
    with pytest.raises(InputError, match="2 of its nodes lie on the axis"):
        disc.with_periodicity()


def test_wanted_sectors_and_axis() -> None:
    mesh = shuffled(roller(2, 12))
    check_numbering(mesh.with_periodicity(sectors=4), 4)
    no_match: list[Any] = [{"sectors": 5}, {"sectors": 24}]
    no_match += [{"axis_direction": (0, 0, 1)}, {"axis_point": (0.001, 0, 0)}]
    for wrong in no_match:
        with pytest.raises(InputError, match="not rotationally periodic"):
            mesh.with_periodicity(**wrong)
    no_sense: list[Any] = [{"sectors": 2}, {"axis_direction": (0, 0, 0)}, {"axis_point": (0, 0)}]
    for wrong in no_sense:
        with pytest.raises(InputError, match="periodicity: "):
            mesh.with_periodicity(**wrong)


def test_a_generated_mesh_knows_already() -> None:
    mesh = roller()
    assert mesh.find_periodicity() is mesh.cyclic
