"""Mesh files: the tetrahedral roller in the repository, files written here, and bad files."""

from __future__ import annotations

import importlib.util
import logging
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

from warpffrf.model import mesh as wfmesh
from warpffrf.model import surfaces
from warpffrf.model.errors import InputError
from warpffrf.model.mesh.elements import cell_kind

DATA = Path(__file__).resolve().parents[1] / "data"
TET_ROLLER = DATA / "tet_roller.msh"
MESHIO_CELL = {"hex8": "hexahedron", "hex27": "hexahedron27"}
MESHIO_FACET = {"quad4": "quad", "quad9": "quad9"}


def generator() -> Any:
    """The script that made the file, for the dimensions it used (gmsh itself is imported only by its main)."""
    spec = importlib.util.spec_from_file_location("make_tet_roller", DATA / "make_tet_roller.py")
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
    meshio.Mesh(np.random.default_rng(0).random((20, 3)), [("hexahedron20", np.arange(20)[None])]).write(path)
    with pytest.raises(InputError, match="hexahedron20 cells are not supported"):
        wfmesh.read(path, length_unit="m")


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


def test_facet_off_the_cells(tmp_path: Path) -> None:
    mesh = roller()
    path = tmp_path / "odd.vtu"
    quads = mesh.facets("rim").single[1].copy()
    quads[0, 0] = quads[3, 2]
    marks: Any = [np.zeros(len(mesh.single[1]), int), np.ones(len(quads), int)]
    meshio.Mesh(mesh.points, [("hexahedron", mesh.single[1]), ("quad", quads)], cell_data={"rim": marks}).write(path)
    with pytest.raises(InputError, match="'rim' has a facet that is no face of a cell"):
        wfmesh.read(path, length_unit="m")
