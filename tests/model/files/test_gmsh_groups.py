"""Gmsh files of all versions: groups by entity, partitions, nodes with parameters, and what else a file has."""

from __future__ import annotations

from pathlib import Path

import pytest

from warpffrf.model import mesh as wfmesh
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh

# a tetrahedron with two of its facets; {} takes the groups of the two surfaces and of the volume
FILE = """$MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
2 7 "{name}"
3 1 "body"
$EndPhysicalNames
$Entities
0 0 2 1
1 0 0 0 1 1 1 {first} 0
2 0 0 0 1 1 1 {second} 0
1 0 0 0 1 1 1 {volume} 0
$EndEntities
$Nodes
1 4 1 4
2 1 {parametric} 4
1
2
3
4
0 0 0{uv}
1 0 0{uv}
0 1 0{uv}
0 0 1{uv}
$EndNodes
$Elements
3 3 1 3
2 1 2 1
1 1 3 2
2 2 2 1
2 1 2 4
3 1 4 1
3 1 2 3 4
$EndElements
"""


def read(tmp_path: Path, text: str) -> Mesh:
    (tmp_path / "m.msh").write_text(text)
    return wfmesh.read(tmp_path / "m.msh", length_unit="m")


def filled(**changes: str) -> str:
    values = {"name": "foot", "first": "1 7", "second": "0", "volume": "1 1", "parametric": "0", "uv": ""}
    return FILE.format(**(values | changes))


@pytest.mark.parametrize(
    ("changes", "sets", "cells"),
    [
        ({}, {"foot": 1}, {"body"}),
        ({"first": "1 -7"}, {"foot": 1}, {"body"}),  # reversed in its group
        ({"second": "1 -7"}, {"foot": 2}, {"body"}),
        ({"second": "2 7 9"}, {"foot": 2, "surface_9": 1}, {"body"}),
        ({"name": "body"}, {"body": 1}, {"body"}),  # a surface and a volume of one name
        ({"volume": "0"}, {"foot": 1}, set()),
        ({"volume": "2 1 -4"}, {"foot": 1}, {"body", "volume_4"}),
        ({"parametric": "1", "uv": " 0.25 0.5"}, {"foot": 1}, {"body"}),
    ],
)
def test_groups_of_entities(tmp_path: Path, changes: dict[str, str], sets: dict[str, int], cells: set[str]) -> None:
    mesh = read(tmp_path, filled(**changes))
    assert mesh.sets == sets and set(mesh.cell_sets) == cells
    assert mesh.volume() == pytest.approx(1.0 / 6.0, rel=1e-15)


def test_a_partition_has_the_groups_of_what_it_was_cut_from(tmp_path: Path) -> None:
    parts = "$PartitionedEntities\n2\n0\n0 0 1 1\n11 2 1 1 1 0 0 0 1 1 1 0 0\n12 3 1 1 2 0 0 0 1 1 1 0 0\n"
    text = filled().replace("$Nodes", parts + "$EndPartitionedEntities\n$Nodes", 1)
    mesh = read(tmp_path, text.replace("2 1 2 1\n1 1 3 2", "2 11 2 1\n1 1 3 2").replace("3 1 4 1\n", "3 12 4 1\n"))
    assert mesh.sets == {"foot": 1} and set(mesh.cell_sets) == {"body"}


def test_what_else_a_file_has(tmp_path: Path) -> None:
    """Data on some of the cells, names without elements: left out by name."""
    data = '$ElementData\n1\n"x"\n1\n0\n3\n0\n1\n1\n3 1.5\n$EndElementData\n'
    text = filled().replace('2\n2 7 "foot"', '3\n1 5 "edge"\n2 7 "foot"') + data
    assert read(tmp_path, text).notes == (
        "groups without cells or facets are left out: edge",
        "sections that are not used: $ElementData (1)",
    )


OLD = (
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n$Elements\n3\n"
    "1 2 2 -7 1 1 3 2\n2 4 2 1 1 1 2 3 4\n3 4 2 2 1 1 2 3 4\n$EndElements\n"
)


def test_version_2_gives_a_cell_once_for_each_of_its_groups(tmp_path: Path) -> None:
    mesh = read(tmp_path, OLD)
    assert mesh.cell_count == 1 and mesh.sets == {"surface_7": 1} and set(mesh.cell_sets) == {"volume_1", "volume_2"}


@pytest.mark.parametrize("digits", [20, 5000])
@pytest.mark.parametrize("old", ["\n4\n0 0 0", "0 0 1\n$End", "1 4 1 4", "3 1 2 3 4"])
def test_long_numbers(tmp_path: Path, digits: int, old: str) -> None:
    """The conversion of Python ends at 4,300 digits; a pattern that goes back took minutes at 40,000."""
    long = old.replace("4", digits * "9", 1) if "4" in old else old.replace("1", digits * "9" + "x", 1)
    with pytest.raises(InputError, match=r"m\.msh"):
        read(tmp_path, filled().replace(old, long, 1))


@pytest.mark.parametrize(
    ("text", "named"),
    [
        (filled().replace("4.1 0 8", "3.0 0 8"), "version 3.0"),
        (filled().replace("4.1 0 8", "4 0 8"), "version 4"),
        (filled().replace("4.1 0 8", "4.0 1 8"), "version 4.0"),
        ("$NOD\n4\n", "version 1"),
        (OLD.replace("Nodes", "ParametricNodes"), "nodes with parameters"),
    ],
)
def test_other_versions_say_how_to_save(tmp_path: Path, text: str, named: str) -> None:
    with pytest.raises(InputError, match=rf"m\.msh: {named} .*not read; .*Mesh\.MshFileVersion = 4\.1"):
        read(tmp_path, text)
