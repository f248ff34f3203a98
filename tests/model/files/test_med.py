"""MED files: those of Gmsh compared with its .msh, those of meshio, groups, faults."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import meshio
import numpy as np
import pytest

from warpffrf.model import mesh as wfmesh
from warpffrf.model.errors import InputError

DATA = Path(__file__).parents[2] / "data"
VOLUMES = ("hexahedron20", "tetra10")
TIME = "-0000000000000000001-0000000000000000001"


@pytest.mark.parametrize("kind", ["hex20", "wedge15", "tet10"])
def test_files_of_gmsh_are_as_its_own(kind: str) -> None:
    """The same mesh as .med and as .msh: volume, cells and sets; nothing needed a correction."""
    mesh, own = (wfmesh.read(DATA / f"gmsh_{kind}{ending}", length_unit="mm") for ending in (".med", ".msh"))
    assert list(mesh.cells) == list(own.cells) == [kind] and not mesh.notes
    assert mesh.volume() == pytest.approx(own.volume(), rel=1e-12)
    assert {**mesh.cell_sets}.keys() == {**own.cell_sets}.keys() and [*mesh.facet_sets] == [*own.facet_sets]
    for name in ("inner", "outer"):
        of, theirs = (m.points[m.cells[kind][m.cell_sets[name]]].mean(axis=1) for m in (mesh, own))
        assert len(of) and np.allclose(np.sort(of, axis=0), np.sort(theirs, axis=0), atol=1e-15)
    of, theirs = (m.facets("rim").centers(m.points) for m in (mesh, own))
    assert len(of) == len(theirs) and np.allclose(np.sort(of, axis=0), np.sort(theirs, axis=0), atol=1e-15)


@pytest.mark.parametrize("kind", ["hex20", "tet10"])  # it fails at groups of wedge15
def test_meshio_finds_the_same(kind: str) -> None:
    path = DATA / f"gmsh_{kind}.med"
    mesh, theirs = wfmesh.read(path, length_unit="m"), meshio.read(path)
    assert np.array_equal(np.unique(mesh.points, axis=0), np.unique(theirs.points, axis=0))
    assert sum(len(block.data) for block in theirs.cells if block.type in VOLUMES) == len(mesh.cells[kind])
    names: dict[int, list[str]] = theirs.cell_tags  # pyright: ignore[reportAttributeAccessIssue]
    for block, tags in zip(theirs.cells, theirs.cell_data["cell_tags"], strict=True):
        for number, (name,) in names.items():
            count = int(np.sum(tags == number))
            if count:
                assert count == (len(mesh.cell_sets[name]) if block.type in VOLUMES else len(mesh.facets(name)))


def test_a_file_of_meshio_with_groups_of_nodes(tmp_path: Path) -> None:
    """Cells in the orientation of VTK, as meshio writes them, are corrected with a note."""
    box = wfmesh.box((2, 1, 1), (3, 2, 2), order=1)
    tags = np.zeros(len(box.points), dtype=int)
    tags[box.facet_sets["x_min"].node_set] = 3
    written = meshio.Mesh(box.points, [("hexahedron", box.cells["hex8"])], point_data={"point_tags": tags})
    written.point_tags = {3: ["held", "clamped"]}  # pyright: ignore[reportAttributeAccessIssue]
    written.write(tmp_path / "box.med")
    mesh = wfmesh.read(tmp_path / "box.med", length_unit="m")
    assert np.array_equal(mesh.points, box.points) and mesh.volume() == pytest.approx(2.0)
    assert "12 hex8 cells with nodes in reversed order are corrected" in mesh.notes
    for name in ("held", "clamped"):
        assert np.array_equal(mesh.facets(name).node_set, box.facets("x_min").node_set)


def change(path: Path, how: Callable[[Any], Any]) -> None:
    with h5py.File(path, "r+") as file:
        how(file)


def shorter(file: Any, name: str) -> None:
    values = file[name][()]
    del file[name]
    file[name] = values[:-1]


@pytest.mark.parametrize(
    ("how", "message"),
    [
        (lambda f: f.create_group("ENS_MAA/second"), "it holds 2 meshes"),
        (
            lambda f: shorter(f, f"ENS_MAA/untitled/{TIME}/MAI/H20/NOD"),
            "H20/NOD: its numbers are not those of 20 nodes",
        ),
        (lambda f: shorter(f, f"ENS_MAA/untitled/{TIME}/NOE/COO"), "NOE/COO: three finite coordinates"),
        (lambda f: shorter(f, f"ENS_MAA/untitled/{TIME}/MAI/H20/FAM"), "FAM: it has 5 numbers, not 6"),
        (lambda f: f.move(f"ENS_MAA/untitled/{TIME}/MAI/H20", f"ENS_MAA/untitled/{TIME}/MAI/PY5"), "pyramids are not"),
        (lambda f: f.__delitem__("ENS_MAA"), "it holds 0 meshes"),
    ],
)
def test_a_wrong_file_is_refused(tmp_path: Path, how: Callable[[Any], Any], message: str) -> None:
    path = tmp_path / "wrong.med"
    shutil.copy(DATA / "gmsh_hex20.med", path)
    change(path, how)
    with pytest.raises(InputError) as error:
        wfmesh.read(path, length_unit="mm")
    assert message in str(error.value) and "wrong.med" in str(error.value) and "\n" not in str(error.value)


def test_what_is_left_out_is_reported(tmp_path: Path) -> None:
    path = tmp_path / "more.med"
    shutil.copy(DATA / "gmsh_hex20.med", path)

    def more(file: Any) -> None:
        file[f"ENS_MAA/untitled/{TIME}/MAI/SE2/NOD"] = np.array([1, 2, 2, 3])
        file[f"ENS_MAA/untitled/{TIME}/MAI/SE2/FAM"] = np.array([-9, -9])
        family = file.create_group("FAS/untitled/ELEME/edges")
        family.attrs["NUM"] = -9
        file["FAS/untitled/ELEME/edges/GRO/NOM"] = np.frombuffer(b"edge".ljust(80, b"\0"), dtype=np.int8)[None]
        file.create_group("CHA/displacement")

    change(path, more)
    notes = wfmesh.read(path, length_unit="mm").notes
    assert "elements that are not used: SE2 (2)" in notes and "results that are not used: displacement" in notes
    assert "group 'edge' is empty, or of elements that are not used" in notes
