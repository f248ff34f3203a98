"""VTU and VTK files: pieces, pixels and voxels, cells left out, sets by integers, compression, and sizes that lie."""

from __future__ import annotations

import base64
import struct
import zlib
from pathlib import Path

import pytest

from warpffrf.model import mesh as wfmesh
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh

TWO = "0 0 0 1 0 0 0 1 0 0 0 1 1 1 1"  # points of two tetrahedra on one face: 1/6 and 1/3 m3


def array(kind: str, name: str, text: str, more: str = 'format="ascii"') -> str:
    return f'<DataArray type="{kind}" Name="{name}" {more}>{text}</DataArray>'


def piece(points: str, nodes: str, ends: str, types: str, data: str = "") -> str:
    x = f'<DataArray type="Float64" NumberOfComponents="3" format="ascii">{points}</DataArray>'
    cells = array("Int64", "connectivity", nodes) + array("Int64", "offsets", ends) + array("UInt8", "types", types)
    counts = f'NumberOfPoints="{len(points.split()) // 3}" NumberOfCells="{len(types.split())}"'
    return f"<Piece {counts}><Points>{x}</Points><Cells>{cells}</Cells><CellData>{data}</CellData></Piece>"


def read(tmp_path: Path, *pieces: str, head: str = "", **more) -> Mesh:
    grid = f"<UnstructuredGrid>{''.join(pieces)}</UnstructuredGrid>"
    text = f'<VTKFile type="UnstructuredGrid" byte_order="LittleEndian" {head}>{grid}</VTKFile>'
    (tmp_path / "m.vtu").write_text(text)
    return wfmesh.read(tmp_path / "m.vtu", length_unit="m", **more)


def two(data: str = "") -> str:
    return piece(TWO, "0 1 2 3 1 2 3 4", "4 8", "10 10", data)


def sets(mesh: Mesh) -> dict[str, list[int]]:
    return {name: members.tolist() for name, members in mesh.cell_sets.items()}


def test_pieces_are_one_grid(tmp_path: Path) -> None:
    first = piece(TWO, "0 1 2 3", "4", "10", array("Int32", "grp", "1"))
    second = piece("1 0 0 0 1 0 0 0 1 1 1 1", "0 1 2 3", "4", "10", array("Int32", "grp", "2"))
    mesh = read(tmp_path, first, second)
    assert mesh.volume() == pytest.approx(0.5, rel=1e-14) and len(mesh.points) == 5
    assert sets(mesh) == {"grp_1": [0], "grp_2": [1]}
    assert mesh.notes == ("the file has 2 pieces: 4 points at their seams are those of another piece",)
    with pytest.raises(InputError, match="'grp' is in some of its 2 pieces only"):
        read(tmp_path, first, piece(TWO, "0 1 2 3", "4", "10"))
    with pytest.raises(InputError, match="2 disconnected parts"):
        read(tmp_path, first, second.replace("1 0 0 0 1 0 0 0 1 1 1 1", "5 0 0 0 5 0 0 0 5 5 5 5"))


def test_pixels_and_voxels(tmp_path: Path) -> None:
    points = "0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1"
    held = array("UInt8", "held", "0 1")
    mesh = read(tmp_path, piece(points, "0 1 2 3 4 5 6 7 0 1 2 3", "8 12", "11 8", held))
    assert mesh.volume() == pytest.approx(1.0) and mesh.sets == {"held": 1}


@pytest.mark.parametrize(
    ("types", "nodes", "ends", "message"),
    [
        ("10 14", "0 1 2 3 0 1 2 3 4", "4 9", "1 pyramid cells are not supported"),
        ("10 42", "0 1 2 3 0 1 2 3 4", "4 9", "1 polyhedron cells are not supported"),
        ("10 1", "0 1 2 3 1 2 3 4", "4 8", "cell 1 of type points has 4 nodes, not 1"),
        ("10 12", "0 1 2 3 1 2 3 4", "4 8", "cell 1 of type hex8 has 4 nodes, not 8"),
        ("10 99", "0 1 2 3 1 2 3 4", "4 8", "type 99, which is not supported"),
        ("10 10", "0 1 2 3 1 2 3 5", "4 8", "a node that the file does not contain"),
        ("10 10", "0 1 2 3 1 2 3", "4 8", "connectivity has 7 numbers, not 8"),
        ("10 10", "0 1 2 3 1 2 3 4", "8 4", "offsets do not ascend"),
    ],
)
def test_cells_that_would_be_lost_are_refused(tmp_path: Path, types: str, nodes: str, ends: str, message: str) -> None:
    with pytest.raises(InputError, match=rf"m\.vtu.*{message}"):
        read(tmp_path, piece(TWO, nodes, ends, types))


def test_cells_without_volume_are_counted(tmp_path: Path) -> None:
    mesh = read(tmp_path, piece(TWO, "0 1 2 3 1 2 3 4 0 1 2", "4 8 9 11", "10 10 1 3"))
    assert mesh.notes == ("cells without volume are left out: 1 points, 1 lines",)


@pytest.mark.parametrize(
    ("values", "width", "expected"),
    [
        ("0 1", "", {"grp_0": [0], "grp": [1]}),
        ("1 2", "", {"grp_1": [0], "grp_2": [1]}),
        ("1 2", ' NumberOfComponents="1"', {"grp_1": [0], "grp_2": [1]}),
        ("-1 3", "", {"grp_-1": [0], "grp_3": [1]}),
        ("0 0", "", {}),
    ],
)
def test_sets_by_integers(tmp_path: Path, values: str, width: str, expected: dict[str, list[int]]) -> None:
    data = array("Int32", "grp", values, 'format="ascii"' + width)
    assert sets(read(tmp_path, two(data))) == expected


def test_arrays_that_make_no_sets_are_named(tmp_path: Path) -> None:
    mesh = read(tmp_path, two(array("Float64", "stress", "1.5 2.5")))
    assert mesh.notes == ("arrays that are not used: stress (cells)",)
    with pytest.raises(InputError, match="1 cells are copies or hidden"):
        read(tmp_path, two(array("UInt8", "vtkGhostType", "0 1")))


def packed(values: bytes, *, said: int | None = None) -> str:
    """An inline array in one block of zlib that says its size, or another one."""
    data, size = zlib.compress(values), len(values) if said is None else said
    return (base64.b64encode(struct.pack("<4I", 1, size, size, len(data))) + base64.b64encode(data)).decode()


def test_compressed_arrays_and_their_sizes(tmp_path: Path) -> None:
    head = 'header_type="UInt32" compressor="vtkZLibDataCompressor"'
    good = struct.pack("<2i", 1, 2)
    data = array("Int32", "grp", packed(good), 'format="binary"')
    assert sets(read(tmp_path, two(data), head=head)) == {"grp_1": [0], "grp_2": [1]}
    for values, said in ((good, 2**31), (good, 4), (bytes(10**6), 8), (good[:6], 8)):
        lie = array("Int32", "grp", packed(values, said=said), 'format="binary"')
        with pytest.raises(InputError, match="array 'grp' does not have 8 bytes"):
            read(tmp_path, two(lie), head=head)
    with pytest.raises(InputError, match="vtkLZ4DataCompressor, which is not read: save it with vtkZLib"):
        read(tmp_path, two(data), head='compressor="vtkLZ4DataCompressor"')


def test_more_than_a_file_can_hold(tmp_path: Path) -> None:
    head = 'header_type="UInt32" compressor="vtkZLibDataCompressor"'
    with pytest.raises(InputError, match="far more than fit into it"):
        read(tmp_path, two().replace('NumberOfCells="2"', 'NumberOfCells="2000000000"'), head=head)


LEGACY = """# vtk DataFile Version 3.0
t
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 5 double
0 0 0 1 0 0 0 1 0 0 0 1 1 1 1
CELLS 2 10
4 0 1 2 3
4 1 2 3 4
CELL_TYPES 2
{types}
CELL_DATA 2
{data}
"""


@pytest.mark.parametrize(
    "data", ["SCALARS grp int 1\nLOOKUP_TABLE default\n1\n2", "SCALARS grp long\n1 2", "FIELD f 1\ngrp 1 2 int\n1 2"]
)
def test_sets_of_legacy_files(tmp_path: Path, data: str) -> None:
    (tmp_path / "m.vtk").write_text(LEGACY.format(types="10\n10", data="VECTORS v float\n1 2 3 4 5 6\n" + data))
    mesh = wfmesh.read(tmp_path / "m.vtk", length_unit="m")
    assert mesh.volume() == pytest.approx(0.5) and sets(mesh) == {"grp_1": [0], "grp_2": [1]}
    assert mesh.notes == ("arrays that are not used: v (cells)",)


def test_a_cell_whose_type_changed_is_not_dropped(tmp_path: Path) -> None:
    (tmp_path / "m.vtk").write_text(LEGACY.format(types="10\n1", data=""))
    with pytest.raises(InputError, match="cell 1 of type points has 4 nodes, not 1"):
        wfmesh.read(tmp_path / "m.vtk", length_unit="m")
