"""Shells and plane elements on the surface of a deck's cells: their sets become facet sets, nothing else of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.files.inp import read_inp
from warpffrf.model.mesh.files.inp.model import is_volume, kind_of, shell_kind_of

# two unit cubes, one on the other, and two nodes next to them
NODES = "*NODE\n" + "".join(
    f"{10 * (z + 1) + i}, {x}, {y}, {z}\n"
    for z in range(3)
    for i, (x, y) in enumerate([(0, 0), (1, 0), (1, 1), (0, 1)])
)
CELLS = "*ELEMENT, TYPE=C3D8, ELSET=BODY\n1, 10,11,12,13,20,21,22,23\n2, 20,21,22,23,30,31,32,33\n"
SHELLS = """*ELEMENT, TYPE=CPS4, ELSET=TOP
101, 30, 31, 32, 33
*ELEMENT, TYPE=S4R, ELSET=SIDES
102, 10, 20, 21, 11
103, 20, 21, 31, 30
*ELEMENT, TYPE=M3D4, ELSET=BETWEEN
104, 20, 21, 22, 23
*ELEMENT, TYPE=STRI65, ELSET=ELSEWHERE
105, 90, 91, 92, 93, 94, 95
*ELSET, ELSET=SKIN
TOP, SIDES, BETWEEN
*ELSET, ELSET=MIXED
1, 101
"""


def read(tmp_path: Path, text: str) -> Mesh:
    path = tmp_path / "deck.inp"
    path.write_text(text)
    return read_inp(path, length_unit="m")


def test_sets_of_shells_are_facet_sets_oriented_outwards(tmp_path: Path) -> None:
    mesh = read(tmp_path, NODES + CELLS + SHELLS)
    assert mesh.sets == {"TOP": 1, "SIDES": 2, "SKIN": 3}
    assert mesh.cell_sets.keys() == {"BODY", "MIXED"} and mesh.cell_sets["MIXED"].tolist() == [0]
    top = mesh.facets("TOP")
    assert set(top.node_set) == {8, 9, 10, 11} and top.centers(mesh.points).tolist() == [[0.5, 0.5, 2.0]]
    outer = {tuple(row) for row in mesh.outer_facets().blocks["quad4"].tolist()}  # node order and so the normal
    assert {tuple(row) for row in mesh.facets("SKIN").blocks["quad4"].tolist()} <= outer
    said = "\n".join(mesh.notes)
    assert "their stiffness and mass, are left out: 1 CPS4, 2 S4R, 1 M3D4, 1 STRI65" in said
    assert "'BETWEEN': 1 shells inside the body" in said and "'SKIN': 1 shells inside the body" in said
    assert "ELSEWHERE" not in said and mesh.volume() == pytest.approx(2.0)


def test_surfaces_go_before_shells_and_shells_before_node_sets(tmp_path: Path) -> None:
    more = "*NSET, NSET=SIDES\n10, 11, 12, 13\n*NSET, NSET=top\n30, 31, 32, 33\n"
    mesh = read(tmp_path, NODES + CELLS + SHELLS + "*SURFACE, NAME=TOP\n2, S3\n" + more)
    assert mesh.facets("TOP").centers(mesh.points).tolist() == [[0.5, 0.0, 1.5]] and mesh.sets["SIDES"] == 2
    assert sum("is not used, a surface has that name" in note for note in mesh.notes) == 1  # SIDES has others


def test_a_shell_cut_off_names_its_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="deck.inp, line 23: the element has 2 of 3 nodes; is the deck truncated"):
        read(tmp_path, NODES + CELLS + "*ELEMENT, TYPE=S3, ELSET=A\n" + "\n" * 5 + "1, 10, 11,\n")


@pytest.mark.parametrize(
    ("name", "kind"),
    [("S3", "tri3"), ("S4R5", "quad4"), ("STRI65", "tri6"), ("s8r", "quad8"), ("CPS6M", "tri6"), ("SFM3D4R", "quad4"),
     ("SPRINGA", None), ("SC8R", None), ("C3D8", None), ("B31", None), ("S9R5", None)],
)  # fmt: skip
def test_names_of_shells(name: str, kind: str | None) -> None:
    assert shell_kind_of(name) == kind
    assert kind is None or not (is_volume(name) or kind_of(name))


def test_an_instance_without_solids_is_called_so(tmp_path: Path) -> None:
    parts = f"*PART, NAME=P\n{NODES}{CELLS}*END PART\n*PART, NAME=Q\n{NODES}{SHELLS}*END PART\n"
    placed = "".join(f"*INSTANCE, NAME={n}-1, PART={n}\n*END INSTANCE\n" for n in "PQ")
    path = tmp_path / "deck.inp"
    path.write_text(parts + "*ASSEMBLY, NAME=A\n" + placed + "*END ASSEMBLY\n")
    assert read_inp(path, length_unit="m").name == "deck:P-1"
    with pytest.raises(InputError, match="'Q-1' has no solid elements .element types: .*; select one with part="):
        read_inp(path, length_unit="m", part="Q-1")
