"""Mesh data, cells and the structured roller."""

import logging
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from warpffrf.model import mesh as wfmesh
from warpffrf.model.errors import InputError
from warpffrf.model.mesh.elements import CELL_KINDS, cell_kind, facet_kind
from warpffrf.model.mesh.facets import row_numbers

R, R_I, WIDTH = 0.05, 0.015, 0.02


def small(order: int = 2, **more):
    return wfmesh.roller(R, R_I, WIDTH, **{"sectors": 12, "layers": 2, "axial": 2, "order": order, **more})


def facet_flux(mesh, name: str) -> float:
    """(1/3) of the integral of x.n over a facet set: its share of the volume by the divergence theorem.

    Facets are isoparametric, interpolated by their own shape functions.
    """
    kind, nodes = mesh.facets(name).single
    x, w = np.polynomial.legendre.leggauss(4)
    xi = np.array([(a, b) for a in x for b in x])
    weight = np.array([a * b for a in w for b in w])
    N, dN = facet_kind(kind).shape(xi)
    X = mesh.points[nodes]
    position = np.einsum("qa,maj->mqj", N, X)
    t1, t2 = (np.einsum("qa,maj->mqj", dN[:, :, d], X) for d in (0, 1))
    return float(np.einsum("q,mqj,mqj->", weight, position, np.cross(t1, t2)) / 3.0)


@pytest.mark.parametrize("kind", CELL_KINDS)
def test_shape_functions(kind: str) -> None:
    cell = cell_kind(kind)
    xi = np.random.default_rng(1).uniform(0.0, 0.3, (6, 3))
    N, dN = cell.shape(xi)
    np.testing.assert_allclose(cell.shape(cell.nodes)[0], np.eye(len(cell.nodes)), atol=1e-13)
    np.testing.assert_allclose(N.sum(axis=1), 1.0, atol=1e-13)  # partition of unity
    np.testing.assert_allclose(N @ cell.nodes, xi, atol=1e-13)  # linear fields are reproduced
    np.testing.assert_allclose(np.einsum("qad,aj->qdj", dN, cell.nodes), np.eye(3) + np.zeros((6, 3, 3)), atol=1e-12)
    assert cell.quadrature_weights.sum() == pytest.approx({"hex": 8.0, "wedge": 1.0, "tet": 1.0 / 6.0}[cell.domain])


@pytest.mark.parametrize("kind", CELL_KINDS)
def test_faces_point_outwards_and_close(kind: str) -> None:
    cell = cell_kind(kind)
    total = np.zeros(3)
    for facet, faces in cell.faces.items():
        corners = facet_kind(facet).corner_count
        for face in faces:
            x = cell.nodes[face[:corners]]
            area = sum(0.5 * np.cross(x[i] - x[0], x[i + 1] - x[0]) for i in range(1, corners - 1))
            assert area @ (x.mean(axis=0) - cell.nodes.mean(axis=0)) > 0.0
            total += area
            if len(face) > corners:  # middle nodes lie between their corners
                middles = 0.5 * (x + np.roll(x, -1, axis=0))
                np.testing.assert_allclose(cell.nodes[face[corners : 2 * corners]], middles, atol=1e-15)
    np.testing.assert_allclose(total, 0.0, atol=1e-14)


def test_volume_converges_with_the_order_of_the_cells() -> None:
    exact = np.pi * (R**2 - R_I**2) * WIDTH
    for order, rate in ((1, 2.0), (2, 4.0)):
        errors = [abs(small(order, sectors=n).volume() / exact - 1.0) for n in (12, 24)]
        assert np.log2(errors[0] / errors[1]) == pytest.approx(rate, abs=0.1)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("crown_radius", [None, 0.2])
def test_facets_enclose_the_volume_outwards(order: int, crown_radius: float | None) -> None:
    mesh = small(order, crown_radius=crown_radius, grading=1.5).check()
    flux = {name: facet_flux(mesh, name) for name in mesh.sets}
    assert sum(flux.values()) == pytest.approx(mesh.volume(), rel=1e-12)
    assert flux["rim"] > 0.0 > flux["bore"]


@pytest.mark.parametrize("order", [1, 2])
def test_cyclic_numbering(order: int) -> None:
    mesh = small(order)
    assert mesh.cyclic is not None
    N = mesh.cyclic.sectors
    nn, nc = len(mesh.points) // N, len(mesh.single[1]) // N
    angle = 2.0 * np.pi / N
    about_y = np.array([[np.cos(angle), 0.0, np.sin(angle)], [0.0, 1.0, 0.0], [-np.sin(angle), 0.0, np.cos(angle)]])
    np.testing.assert_allclose(mesh.points[nn : 2 * nn], mesh.points[:nn] @ about_y.T, atol=1e-16)
    for arrays, per in [(mesh.single[1], nc)] + [(f.single[1], len(f) // N) for f in mesh.facet_sets.values()]:
        assert arrays[:per].max() < 2 * nn
        for s in range(N):
            np.testing.assert_array_equal(arrays[s * per : (s + 1) * per], (arrays[:per] + s * nn) % len(mesh.points))
    first_plane = mesh.points[: nn // order]
    assert np.all(first_plane[:, 0] > 0.0) and np.all(first_plane[:, 2] == 0.0)
    columns = 2 * order + 1
    np.testing.assert_allclose(np.diff(first_plane[:columns, 1]), WIDTH / (columns - 1))  # axial index fastest


def test_crown_and_true_circles() -> None:
    Rc = 0.2
    mesh = small(crown_radius=Rc)
    x = mesh.points[mesh.facets("rim").node_set]
    expected = R - (Rc - np.sqrt(Rc**2 - x[:, 1] ** 2))
    np.testing.assert_allclose(np.hypot(x[:, 0], x[:, 2]), expected, rtol=1e-14)
    bore = mesh.points[mesh.facets("bore").node_set]
    np.testing.assert_allclose(np.hypot(bore[:, 0], bore[:, 2]), R_I, rtol=1e-14)


@pytest.mark.parametrize("order", [1, 2])
def test_counts_chosen_from_the_half_width(order: int) -> None:
    b = 2e-3
    mesh = wfmesh.roller(R, R_I, WIDTH, half_width=b, order=order)
    assert mesh.cyclic is not None
    around = 2.0 * np.pi * R / mesh.cyclic.sectors
    assert 0.9 * b / (2 / order) <= around <= b / (2 / order)
    thickness = layer_thicknesses(mesh, order)
    assert thickness[0] <= around * 1.01
    np.testing.assert_allclose(thickness[1:] / thickness[:-1], thickness[1] / thickness[0], rtol=1e-6)


def test_given_layers_start_with_the_wanted_size() -> None:
    b = 1e-3
    mesh = wfmesh.roller(R, R_I, WIDTH, sectors=24, axial=1, layers=8, half_width=b, order=1)
    radii = np.unique(np.round(np.hypot(mesh.points[:, 0], mesh.points[:, 2]), 12))[::-1]
    assert radii[0] - radii[1] == pytest.approx(b / 2, rel=1e-9)


def layer_thicknesses(mesh, order: int) -> np.ndarray:
    """Thicknesses of the layers of cells [m], from the rim inwards."""
    radii = np.unique(np.round(np.hypot(mesh.points[:, 0], mesh.points[:, 2]), 12))[::-1]
    return -np.diff(radii[::order])


@pytest.mark.parametrize("order", [1, 2])
def test_layers_are_graded_towards_the_rim_by_themselves(order: int) -> None:
    graded = layer_thicknesses(small(order, sectors=120, layers=5), order)
    assert graded[0] == pytest.approx(2.0 * np.pi * R / 120, rel=1e-8)  # as deep as a cell is wide around
    np.testing.assert_allclose(graded[1:] / graded[:-1], graded[1] / graded[0], rtol=1e-6)
    assert graded[1] > graded[0] and graded.sum() == pytest.approx(R - R_I)


@pytest.mark.parametrize("growth", [1.0, 1.3])
def test_a_given_grading_wins(growth: float) -> None:
    for more in ({}, {"half_width": 1e-3}):
        given = layer_thicknesses(small(1, sectors=120, layers=5, grading=growth, **more), 1)
        np.testing.assert_allclose(given[1:] / given[:-1], growth, rtol=1e-8)


def test_layers_already_shallow_stay_uniform() -> None:
    np.testing.assert_allclose(layer_thicknesses(small(1, sectors=12, layers=4), 1), (R - R_I) / 4, rtol=1e-9)


def test_too_few_layers_are_warned_about(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING, logger="warpffrf"):
        small(1, sectors=360, layers=3)
        assert "layers=3" in caplog.text and "use layers >= 6" in caplog.text
        caplog.clear()
        small(1, sectors=360, layers=6)  # 0.87 mm times 2^6 - 1 reaches through 35 mm
        small(1, sectors=360, layers=3, grading=1.0)
        assert not caplog.text


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"sectors": None}, "sectors.*half_width"),
        ({"layers": None, "axial": None}, "layers, axial.*half_width"),
        ({"order": 3}, "order"),
        ({"sectors": 2}, "sectors.*at least 3"),
        ({"layers": 1.5}, "layers.*whole"),
        ({"grading": -1.0}, "grading"),
        ({"half_width": -1e-3}, "half_width"),
        ({"crown_radius": 0.009}, "crown_radius"),
    ],
)
def test_impossible_rollers_are_refused(change: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        small(**change)


def test_radii_in_the_wrong_order() -> None:
    with pytest.raises(InputError, match="inner_radius"):
        wfmesh.roller(0.015, 0.05, 0.02, half_width=1e-3)
    with pytest.raises(InputError, match="width"):
        wfmesh.roller(R, R_I, 0.0, half_width=1e-3)


def test_select_adds_a_set_and_leaves_the_mesh_alone() -> None:
    mesh = small()
    tread = mesh.select("tread", "rim", lambda x: x[:, 0] > 0.03)
    assert set(tread.sets) == {"rim", "bore", "ends", "tread"} and "tread" not in mesh.sets
    assert 0 < tread.sets["tread"] < tread.sets["rim"]
    assert tread.content_hash() != mesh.content_hash()
    with pytest.raises(InputError, match="'tire'.*'rim', 'bore', 'ends'"):
        mesh.select("tread", "tire", lambda x: x[:, 0] > 0)
    with pytest.raises(InputError, match="exists already"):
        mesh.select("bore", "rim", lambda x: x[:, 0] > 0)
    with pytest.raises(InputError, match="no facet"):
        mesh.select("none", "rim", lambda x: x[:, 0] > 1.0)
    with pytest.raises(InputError, match="booleans"):
        mesh.select("bad", "rim", lambda x: x)


def test_report_warns_about_the_size() -> None:
    report = small().report()
    assert not report.warnings and report.sets["rim"] == 24
    assert "24 facets" in str(report) and "12 sectors" in str(report)
    for factor in (1e-3, 1e3):
        big = replace(small(), points=small().points * factor)
        assert any("length unit" in w for w in big.report().warnings)


def test_content_hash_sees_a_nanometre_and_nothing_else() -> None:
    mesh = small()
    assert mesh.content_hash() == small().content_hash()
    points = mesh.points.copy()
    points[17, 2] += 1e-9
    assert replace(mesh, points=points).content_hash() != mesh.content_hash()
    assert replace(mesh, cyclic=None).content_hash() != mesh.content_hash()
    assert replace(mesh, name="other").content_hash() == mesh.content_hash()


def test_arrays_are_checked_and_frozen() -> None:
    mesh = small()
    with pytest.raises(ValueError, match="read-only"):
        mesh.points[0, 0] = 1.0
    bad = mesh.points.copy()
    bad[3, 1] = np.nan
    with pytest.raises(InputError, match="points"):
        replace(mesh, points=bad)
    with pytest.raises(InputError, match="0 to"):
        replace(mesh, points=mesh.points[:-1], cyclic=None)
    with pytest.raises(InputError, match="sectors"):
        replace(mesh, cyclic=wfmesh.Cyclic(7, np.zeros(3), np.array([0.0, 1.0, 0.0])))
    with pytest.raises(InputError, match="no volume cells"):
        wfmesh.Mesh(mesh.points, {})
    with pytest.raises(InputError, match="cell kind 'hex21'"):
        wfmesh.Mesh(mesh.points, {"hex21": np.zeros((1, 21), int)})
    with pytest.raises(InputError, match="no volume cells"):
        wfmesh.Mesh(mesh.points, {"hex27": np.zeros((0, 27), int)})


def test_bad_geometry_is_found() -> None:
    mesh = small(1)
    cells = mesh.single[1].copy()
    cells[5, [0, 1]] = cells[5, [1, 0]]
    with pytest.raises(InputError, match="1 inverted hex8.*number 5"):
        replace(mesh, cells={"hex8": cells}).check()
    apart = wfmesh.Mesh(
        np.concatenate([mesh.points, mesh.points + 1.0]),
        {"hex8": np.concatenate([mesh.single[1], mesh.single[1] + len(mesh.points)])},
    )
    with pytest.raises(InputError, match="2 disconnected parts"):
        apart.check()
    twice = np.concatenate([mesh.single[1], mesh.single[1][[3]]])
    with pytest.raises(
        InputError, match=f"1 cell.* corners of another one, the first are number 3 and {len(twice) - 1}"
    ):
        wfmesh.Mesh(mesh.points, {"hex8": twice}).check()
    with pytest.raises(InputError, match="belong to no cell"):
        wfmesh.Mesh(np.concatenate([mesh.points, [[1.0, 1.0, 1.0]]]), {"hex8": mesh.single[1]}).check()


@settings(max_examples=25, deadline=None)
@given(
    order=st.sampled_from([1, 2]),
    sectors=st.integers(4, 9),
    layers=st.integers(1, 3),
    axial=st.integers(1, 3),
    grading=st.floats(1.0, 2.5),
    ratio=st.floats(0.1, 0.9),
)
def test_every_roller_has_positive_jacobians(order, sectors, layers, axial, grading, ratio) -> None:
    mesh = wfmesh.roller(
        0.04, 0.04 * ratio, 0.02, sectors=sectors, layers=layers, axial=axial, grading=grading, order=order
    )
    assert mesh.check() is mesh


@pytest.mark.parametrize("shape", [(0, 3), (1, 4), (500, 2), (500, 4)])
def test_row_numbers(shape: tuple[int, int]) -> None:
    rows = np.random.default_rng(3).integers(-1, 5, shape)
    np.testing.assert_array_equal(row_numbers(rows), np.unique(rows, axis=0, return_inverse=True)[1].ravel())


def test_selection_needs_a_function() -> None:
    with pytest.raises(InputError, match="select 'half': the predicate must be a function of the facet centres, got 3"):
        small(1).select("half", "rim", 3)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="mesh report: a Material or .cell set: Material. is needed, got 'steel'"):
        small(1).report("steel")  # type: ignore[arg-type]
