"""Mesh files: the tetrahedral roller in the repository, files written here, and bad files."""

from __future__ import annotations

import importlib.util
import logging
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from warpffrf import examples
from warpffrf.model import mesh as wfmesh
from warpffrf.model import surfaces
from warpffrf.model.errors import InputError
from warpffrf.model.mesh.elements import cell_kind

DATA = Path(__file__).resolve().parents[2] / "data"
TET_ROLLER = examples.path("roller") / "roller.msh"
MESHIO_CELL = {"hex8": "hexahedron", "hex27": "hexahedron27"}
MESHIO_FACET = {"quad4": "quad", "quad9": "quad9"}


def generator() -> Any:
    """The script that made the file, for the dimensions it used (gmsh itself is imported only by its main)."""
    spec = importlib.util.spec_from_file_location("make_roller", TET_ROLLER.with_name("make_roller.py"))
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def write(path: Path, mesh: wfmesh.Mesh, *, flip: bool = False, name: str = "rim", **data: Any) -> Path:
    """A mesh with its rim facets as a VTU file; `flip` turns the facets inside out."""
    facets = mesh.facets("rim")
    nodes = facets.single[1]
    if flip:
        nodes = nodes[:, [0, 3, 2, 1]] if facets.single[0] == "quad4" else nodes[:, [0, 3, 2, 1, 7, 6, 5, 4, 8]]
    cells: list[Any] = [(MESHIO_CELL[mesh.single[0]], mesh.single[1]), (MESHIO_FACET[facets.single[0]], nodes)]
    marks = [np.zeros(len(mesh.single[1]), int), np.ones(len(nodes), int)]
    arrays: dict[str, Any] = {name: marks, **data}
    meshio.Mesh(mesh.points, cells, cell_data=arrays).write(path)
    return path


def roller(order: int = 1) -> wfmesh.Mesh:
    return wfmesh.roller(0.05, 0.015, 0.02, sectors=8, layers=1, axial=1, order=order)


def test_tetrahedral_roller_of_gmsh() -> None:
    assert TET_ROLLER.stat().st_size < 1_000_000
    made = generator()
    mesh = wfmesh.read(TET_ROLLER, length_unit="mm")
    assert mesh.single[0] == "tet10" and set(mesh.sets) == {"rim", "bore", "ends"} and mesh.cyclic is None
    axis = np.array(made.AXIS) / np.linalg.norm(made.AXIS)
    for name, radius in (("rim", made.OUTER_RADIUS), ("bore", made.BORE_RADIUS)):
        shape = surfaces.Cylinder().fitted(mesh.points[mesh.facets(name).node_set])
        assert shape.radius == pytest.approx(1e-3 * radius, rel=1e-9)
        assert abs(shape.e_a @ axis) == pytest.approx(1.0, abs=1e-12)
        np.testing.assert_allclose(shape.axis_point, 1e-3 * np.array(made.CENTER), atol=1e-9)
    exact = np.pi * (made.OUTER_RADIUS**2 - made.BORE_RADIUS**2) * made.WIDTH * 1e-9
    assert mesh.volume() == pytest.approx(exact, rel=1e-4)  # quadratic cells of about 0.15 rad: error of order 0.15^4


def test_facets_of_the_file_enclose_it() -> None:
    mesh = wfmesh.read(TET_ROLLER, length_unit="mm")
    cell = cell_kind("tet10")
    # degree-4 rule on the triangle from the tensor rule: the integrand x.n dA of quadratic facets has degree 2 + 2
    x, w = np.polynomial.legendre.leggauss(4)
    x, w = 0.5 * (x + 1), 0.5 * w
    xi = np.array([(a, (1 - a) * b, 0.0) for a in x for b in x])
    weight = np.array([wa * wb * (1 - a) for a, wa in zip(x, w, strict=True) for wb in w])
    face = [0, 1, 2, 4, 5, 6]  # nodes of the face zeta = 0 in the order of a quadratic triangle
    N, dN = cell.shape(xi)
    total = 0.0
    for facets in mesh.facet_sets.values():
        X = mesh.points[facets.single[1]]
        position = np.einsum("qa,maj->mqj", N[:, face], X)
        t1, t2 = (np.einsum("qa,maj->mqj", dN[:, face, d], X) for d in (0, 1))
        total += np.einsum("q,mqj,mqj->", weight, position, np.cross(t1, t2)) / 3.0
    assert total == pytest.approx(mesh.volume(), rel=1e-12)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("flip", [False, True])
def test_vtu_round_trip_orients_the_facets(tmp_path: Path, order: int, flip: bool) -> None:
    mesh = roller(order)
    again = wfmesh.read(write(tmp_path / "r.vtu", mesh, flip=flip), length_unit="m")
    np.testing.assert_allclose(again.points, mesh.points)
    np.testing.assert_array_equal(again.single[1], mesh.single[1])
    rows = {tuple(sorted(row)): row for row in mesh.facets("rim").single[1].tolist()}
    for row in again.facets("rim").single[1].tolist():
        assert row == rows[tuple(sorted(row))]


def test_vtu_array_with_several_values_makes_several_sets(tmp_path: Path) -> None:
    mesh = roller()
    number = np.arange(mesh.sets["rim"]) % 3
    marks = [np.zeros(len(mesh.single[1]), int), number]
    again = wfmesh.read(write(tmp_path / "r.vtu", mesh, side=marks), length_unit="m")
    assert again.sets == {"rim": 8, "side_1": int(np.sum(number == 1)), "side_2": int(np.sum(number == 2))}


@pytest.mark.parametrize(("unit", "factor"), [("mm", 1e-3), ("in", 0.0254), ("cm", 1e-2)])
def test_length_units(tmp_path: Path, unit: str, factor: float) -> None:
    path = write(tmp_path / "r.vtu", roller())
    assert np.ptp(wfmesh.read(path, length_unit=unit).points, axis=0)[1] == pytest.approx(0.02 * factor)
    with pytest.raises(InputError, match="length unit 'furlong'.*'mm'"):
        wfmesh.read(path, length_unit="furlong")


def test_wrong_unit_is_warned_about(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING, logger="warpffrf"):
        wfmesh.read(write(tmp_path / "r.vtu", roller()), length_unit="mm")
    assert "length unit" in caplog.text


def test_missing_unreadable_and_unknown_files(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nothing.msh' does not exist; check the path"):
        wfmesh.read(tmp_path / "nothing.msh", length_unit="mm")
    for suffix in (".msh", ".vtu"):
        bad = tmp_path / f"bad{suffix}"
        for content in (b"", b"this is no mesh\n" * 3, TET_ROLLER.read_bytes()[:5000]):
            bad.write_bytes(content)
            with pytest.raises(InputError, match=f"bad{suffix}: cannot be read.*export it again"):
                wfmesh.read(bad, length_unit="mm")
    other = tmp_path / "mesh.stp"
    other.write_text("solid")
    with pytest.raises(InputError, match="unknown format"):
        wfmesh.read(other, length_unit="mm")


def test_no_volume_cells(tmp_path: Path) -> None:
    mesh = roller()
    path = tmp_path / "surface.vtu"
    meshio.Mesh(mesh.points, [("quad", mesh.facets("rim").single[1])]).write(path)
    with pytest.raises(InputError, match="no volume cells.*quad"):
        wfmesh.read(path, length_unit="m")
    meshio.Mesh(np.random.default_rng(0).random((18, 3)), [("wedge18", np.arange(18)[None])]).write(path)
    with pytest.raises(InputError, match="wedge18 cells are not supported.*hexahedron20.*SecondOrderIncomplete = 1"):
        wfmesh.read(path, length_unit="m")


def test_arguments_of_the_wrong_type(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="mesh.read: a path is needed, got None"):
        wfmesh.read(None, length_unit="m")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="length unit .'mm'. does not exist; known: 'm', 'cm', 'mm'"):
        wfmesh.read(tmp_path / "mesh.vtu", length_unit=["mm"])  # type: ignore[arg-type]


def test_inverted_cell(tmp_path: Path) -> None:
    mesh = roller()
    cells = mesh.single[1].copy()
    cells[2] = cells[2][[4, 5, 6, 7, 0, 1, 2, 3]]
    path = tmp_path / "inverted.vtu"
    meshio.Mesh(mesh.points, [("hexahedron", cells)]).write(path)
    with pytest.raises(InputError, match="inverted.vtu.*1 inverted hex8.*number 2"):
        wfmesh.read(path, length_unit="m")


def test_two_parts_and_choosing_one(tmp_path: Path) -> None:
    mesh = roller()
    n = len(mesh.points)
    points = np.concatenate([mesh.points, mesh.points + [0.0, 0.0, 1.0]])
    path = tmp_path / "two.vtu"
    meshio.Mesh(points, [("hexahedron", np.concatenate([mesh.single[1], mesh.single[1] + n]))]).write(path)
    with pytest.raises(InputError, match="2 disconnected parts.*part=0"):
        wfmesh.read(path, length_unit="m")
    second = wfmesh.read(path, length_unit="m", part=1)
    np.testing.assert_allclose(second.points, points[n:])
    with pytest.raises(InputError, match="part 2 does not exist"):
        wfmesh.read(path, length_unit="m", part=2)
    with pytest.raises(InputError, match="volume group 'gear'"):
        wfmesh.read(path, length_unit="m", part="gear")


def test_volume_group_of_gmsh_by_name() -> None:
    whole = wfmesh.read(TET_ROLLER, length_unit="mm")
    assert wfmesh.read(TET_ROLLER, length_unit="mm", part="roller").content_hash() == whole.content_hash()
    with pytest.raises(InputError, match="'wheel'.*'roller'"):
        wfmesh.read(TET_ROLLER, length_unit="mm", part="wheel")


RING = (0.010, 0.015, 0.020, 0.005)  # m: radii and width of the quarter rings of make_gmsh_kinds.py, three cells around


@pytest.mark.parametrize("kind", ["hex8", "hex20", "hex27", "wedge6", "wedge15"])
def test_curved_cells_of_gmsh(kind: str) -> None:
    """Volume of a polygon or of parabolas through three nodes of each arc, middle nodes on the circles, groups."""
    mesh = wfmesh.read(DATA / f"gmsh_{kind}.msh", length_unit="mm")
    assert mesh.single[0] == kind and mesh.sets == {"rim": 3}
    half = np.pi / 12
    arc = np.sin(half) * np.cos(half)  # triangle of each cell over the square of its radius
    if mesh.single[1].shape[1] > 8:
        arc += 4.0 / 3.0 * np.sin(half) * (1.0 - np.cos(half))  # parabola over its chord
    exact = 3.0 * arc * (RING[2] ** 2 - RING[0] ** 2) * RING[3]
    assert mesh.volume() == pytest.approx(exact, rel=1e-12)
    rim = mesh.points[mesh.facets("rim").node_set]
    np.testing.assert_allclose(np.hypot(rim[:, 0], rim[:, 1]), RING[2], rtol=1e-12)
    centers = np.hypot(*mesh.points[mesh.single[1][:, : cell_kind(kind).corner_count]].mean(axis=1)[:, :2].T)
    inner = np.flatnonzero(centers < 0.97 * RING[1])
    np.testing.assert_array_equal(mesh.cell_sets["inner"], inner)
    assert len(mesh.cell_sets["inner"]) == len(mesh.cell_sets["outer"]) == mesh.cell_count // 2
    part = wfmesh.read(DATA / f"gmsh_{kind}.msh", length_unit="mm", part="inner")
    assert part.cell_count == mesh.cell_count // 2 and set(part.cell_sets) == {"inner"} and not part.sets


def mixed() -> wfmesh.Mesh:
    """Two cubes along x, the second one cut into two wedges."""
    x = np.array([(i, j, k) for i in range(3) for j in range(2) for k in range(2)], float)
    cube = np.array([0, 4, 6, 2, 1, 5, 7, 3])
    wedges = (cube + 4)[np.array([(0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)])]
    return wfmesh.Mesh(x, {"hex8": cube[None], "wedge6": wedges}).check()


@pytest.mark.parametrize("suffix", [".vtu", ".vtk", ".msh"])
def test_several_kinds_of_cells_and_facets(tmp_path: Path, suffix: str) -> None:
    mesh = mixed()
    cells: list[Any] = [
        ("quad", np.array([[1, 5, 7, 3]])),
        ("triangle", np.array([[5, 9, 11], [5, 7, 11]])),  # one of them inside out
        ("wedge", mesh.cells["wedge6"]),
        ("hexahedron", mesh.cells["hex8"]),
    ]
    path = tmp_path / f"mixed{suffix}"
    if suffix == ".msh":
        tags = [np.array(v) for v in ([1], [1, 1], [2, 3], [3])]
        data: Any = {"gmsh:physical": tags, "gmsh:geometrical": tags}
        names = {"top": np.array([1, 2]), "alu": np.array([2, 3]), "steel": np.array([3, 3])}
        meshio.Mesh(mesh.points, cells, cell_data=data, field_data=names).write(path, "gmsh22", binary=False)
    else:
        data = {
            "top": [np.array(v) for v in ([1], [1, 1], [0, 0], [0])],
            "alu": [np.array(v) for v in ([0], [0, 0], [1, 0], [0])],
            "steel": [np.array(v) for v in ([0], [0, 0], [0, 1], [1])],
            "cell": [np.array(v) for v in ([7], [7, 7], [2, 0], [4])],
        }
        meshio.Mesh(mesh.points, cells, cell_data=data).write(path, binary=False)
    again = wfmesh.read(path, length_unit="m")
    assert again.volume() == pytest.approx(2.0) and set(again.cells) == {"hex8", "wedge6"}
    top = again.facets("top")
    assert {kind: len(nodes) for kind, nodes in top.blocks.items()} == {"quad4": 1, "tri3": 2}
    for nodes in top.corners.values():
        x = again.points[nodes]
        assert np.all(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])[:, 2] > 0.0)
    # wedges come first in the file and keep their numbers
    assert list(again.cells) == ["wedge6", "hex8"]
    found = {name: members.tolist() for name, members in again.cell_sets.items()}
    expected = {"alu": [0], "steel": [1, 2]}
    if suffix != ".msh":
        expected |= {"cell_2": [0], "cell_0": [1], "cell_4": [2]}
    assert found == expected


def test_array_of_numbers_makes_no_sets(tmp_path: Path) -> None:
    mesh = wfmesh.roller(0.05, 0.015, 0.02, sectors=72, layers=2, axial=2, order=1)
    marks = [np.arange(mesh.cell_count), np.zeros(mesh.sets["rim"], int)]
    again = wfmesh.read(write(tmp_path / "r.vtu", mesh, number=marks), length_unit="m")
    assert again.sets == {"rim": mesh.sets["rim"]}
    assert not again.cell_sets and any("'number' has 288 values" in note for note in again.notes)


def test_binary_vtk_with_data(tmp_path: Path) -> None:
    mesh = roller()
    path = tmp_path / "r.vtk"
    cells: list[Any] = [("hexahedron", mesh.single[1])]
    data: dict[str, Any] = {"half": [np.arange(mesh.cell_count) // 4 + 1]}
    meshio.Mesh(mesh.points, cells, point_data={"a": mesh.points[:, 0]}, cell_data=data).write(path)
    again = wfmesh.read(path, length_unit="m")
    np.testing.assert_array_equal(again.points, mesh.points)
    assert {name: list(members) for name, members in again.cell_sets.items()} == {
        "half_1": [0, 1, 2, 3],
        "half_2": [4, 5, 6, 7],
    }
    assert again.notes == ("arrays that are not used: a (points)",)


def test_deck_of_abaqus_is_read_by_our_own_reader(tmp_path: Path) -> None:
    path = tmp_path / "cube.inp"
    corners = "\n".join(f"{i + 1}, {', '.join(map(str, x))}" for i, x in enumerate(cell_kind("hex8").nodes))
    path.write_text(f"*Node\n{corners}\n*Element, type=C3D8R\n1, 1, 2, 3, 4, 5, 6, 7, 8\n")
    mesh = wfmesh.read(path, length_unit="mm")
    assert mesh.volume() == pytest.approx(8e-9) and any("C3D8R" in note for note in mesh.notes)


def test_facet_off_the_cells(tmp_path: Path) -> None:
    mesh = roller()
    path = tmp_path / "odd.vtu"
    quads = mesh.facets("rim").single[1].copy()
    quads[0, 0] = quads[3, 2]
    marks: Any = [np.zeros(len(mesh.single[1]), int), np.ones(len(quads), int)]
    meshio.Mesh(mesh.points, [("hexahedron", mesh.single[1]), ("quad", quads)], cell_data={"rim": marks}).write(path)
    with pytest.raises(InputError, match="'rim' has a facet that is no face of a cell"):
        wfmesh.read(path, length_unit="m")
