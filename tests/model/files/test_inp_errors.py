"""Bad decks: each fault names the file, the line, the thing and the cure; garbage raises nothing but `InputError`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.files.inp import read_inp

DATA = Path(__file__).resolve().parents[2] / "data"
NODES = """*NODE, NSET=ALL
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 0, 1
6, 1, 0, 1
7, 1, 1, 1
8, 0, 1, 1
"""
CELL = "*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"
GOOD = NODES + CELL  # lines 1 to 11
PLACED = "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P\n"


def part(text: str, name: str = "P") -> str:
    return f"*PART, NAME={name}\n{text}*END PART\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no solid elements"),
        ("solid garbage\n" + GOOD, "bad.inp, line 1: text before the first keyword"),
        (NODES.replace("3, 1, 1, 0", "3, 1, one, 0") + CELL, "bad.inp, line 4: a node is .* got '3, 1, one"),
        (NODES.replace("3, 1, 1, 0", "3, 1, nan, 0") + CELL, "line 4: a node is .* finite"),
        (NODES.replace("3, 1, 1, 0", "3, 1, 1e999, 0") + CELL, "line 4: a node is .* finite"),
        (NODES.replace("3, 1, 1, 0", "3.5, 1, 1, 0") + CELL, "line 4: a node"),
        (NODES.replace("3, 1, 1, 0", "-3, 1, 1, 0") + CELL, "line 4: a node"),
        (NODES.replace("3, 1, 1, 0", ", 1, 1, 0") + CELL, "line 4: a node"),
        (NODES.replace("3, 1, 1, 0", "3, 1_0, 1, 0") + CELL, "line 4: a node"),
        (NODES.replace("*NODE", "*NODE, SYSTEM=C"), "line 1: .Node with SYSTEM=C is not supported"),
        (GOOD.replace("7, 8\n", "7, 99\n").replace("7, 1, 1, 1", "70, 1, 1, 1"), "line 11: .* 1 refers to node 7"),
        (CELL, "line 2: element 1 refers to node 1, but there are none"),
        (GOOD.replace(", 6, 7, 8\n", ",\n6, 7\n"), "line 11: the element has 7 of 8 nodes; is the deck truncated"),
        (GOOD.replace("6, 7, 8\n", "6, 7, 8, 9\n"), "line 11: .* C3D8 has a number and 8 nodes, got 10 values"),
        (GOOD.replace("6, 7, 8\n", "6, x, 8\n"), "line 11: element and node numbers are whole"),
        (GOOD + "1, 1, 2, 3, 4, 5, 6, 7, 8\n", "line 12: element 1 is defined already, in bad.inp, line 11"),
        (GOOD.replace(", TYPE=C3D8", ""), "line 10: .ELEMENT needs TYPE="),
        (GOOD + "*NSET, NSET=N\nNOTHING\n", "line 13: there is no node set 'NOTHING'; known: 'ALL', 'N'"),
        (GOOD + "*ELSET, ELSET=A\nB\n*ELSET, ELSET=B\nA\n", "element set '[AB]' contains itself"),
        (GOOD + "*NSET, NSET=N, GENERATE\n8, 1\n", "line 13: a generated range is"),
        (GOOD + "*NSET, NSET=N, GENERATE\n1, 8, 0\n", "line 13: a generated range is"),
        (GOOD + "*NSET, NSET=N\n1, -2\n", "line 13: a member of a set is"),
        (GOOD + "*NSET\n1\n", "line 12: .NSET needs NSET="),
        (GOOD + "*SURFACE, NAME=S\nF, S1\n", "line 13: there is no element set 'F'; known: 'E'"),
        (GOOD + "*SURFACE, NAME=S\nE, S7\n", "line 13: surface 'S': 'S7' is no face"),
        (GOOD + "*SURFACE, NAME=S\n2, S1\n", "line 13: there is no element 2"),
        (GOOD + "*SURFACE, NAME=S, TYPE=NODE\n12\n", "line 13: there is no node 12"),
        (GOOD + "*SURFACE, NAME=S\nE\n*SURFACE, NAME=s\nE\n", "line 14: surface 's' is defined .* line 12"),
        (GOOD + "*SOLID SECTION, ELSET=E, MATERIAL=M\n", "line 12: there is no material 'M'; known: none"),
        (GOOD + "*MATERIAL, NAME=M\n*SOLID SECTION, ELSET=F, MATERIAL=M\n", "line 13: there is no element set 'F'"),
        (GOOD + "*ELASTIC\n1, 0.3\n", "line 12: .Elastic without a .Material"),
        (GOOD + "*MATERIAL, NAME=M\n*ELASTIC\n1,\n", "line 14: .Elastic .* needs 2 finite"),
        (GOOD + "*MATERIAL, NAME=M\n*DENSITY\n", "line 13: .Density has no data line"),
        (GOOD + "*MATERIAL, NAME=M\n*DENSITY\nheavy\n", "line 14: .Density needs 1 finite"),
        (GOOD + "*NGEN\n1, 8, 1\n", "line 12: .NGEN is not supported; write the mesh out"),
        (GOOD + "*SYSTEM\n1, 0, 0\n", "line 12: .SYSTEM is not supported"),
        (GOOD + "*INCLUDE, INPUT=nowhere.inp\n", "line 12: the included file 'nowhere.inp' does not exist"),
        (GOOD + "*INCLUDE, INPUT=bad.inp\n", "line 12: 'bad.inp' includes itself"),
        (GOOD + "*INCLUDE\n", "line 12: .INCLUDE needs INPUT="),
        (GOOD + "*INCLUDE, INPUT=" + 3000 * "x", "line 12: the included file .* cannot be read"),
        ("*PART, NAME=P\n" + GOOD, "line 1: .PART has no .End Part; is the deck truncated"),
        ("*PART\n" + GOOD, "line 1: .PART needs NAME="),
        (GOOD + "*END PART\n", "line 12: .End Part without .Part"),
        (part(GOOD) + part(GOOD, "p"), "line 14: part 'p' is defined already, in bad.inp, line 1"),
        ("*PART, NAME=P\n*PART, NAME=Q\n", "line 2: .PART inside the .PART of bad.inp, line 1"),
        (part(GOOD) + part(GOOD, "Q"), "2 bodies, select one with part=, one of 'P', 'Q'"),
        (part(GOOD) + "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=Q\n*END INSTANCE\n*END ASSEMBLY\n",
         "line 15: there is no part 'Q'; known: 'P'"),
        (part(GOOD) + PLACED + "0, 0\n1,0,0, 1,0,0, 5\n*END INSTANCE\n*END ASSEMBLY\n",
         "line 17: the two points of the rotation axis coincide"),
        (part(GOOD) + PLACED + "0, 0\n1,0,0\n*END INSTANCE\n*END ASSEMBLY\n",
         "line 17: the rotation of an instance .* needs 7 finite"),
        (part(GOOD) + PLACED + "*END INSTANCE\n*NSET, NSET=N, INSTANCE=J\n1\n*END ASSEMBLY\n",
         "line 17: there is no instance 'J'; known: 'I'"),
        (part(GOOD) + GOOD, "line 23: solid elements outside the parts"),
        (GOOD.replace("5, 6, 7, 8\n", "8, 7, 6, 5\n"), "bad.inp: mesh: 1 inverted hex8 .* the first is element 1 "),
        (GOOD.replace("C3D8", "C3DX8"), "line 10: solid elements of type C3DX8 are not supported; use C3D4 to C3D20"),
    ],
)  # fmt: skip
def test_faults_name_file_and_line(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "bad.inp"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        read_inp(path, length_unit="m")


def test_wrong_arguments(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="nothing.inp' does not exist; check the path"):
        read_inp(tmp_path / "nothing.inp", length_unit="m")
    path = tmp_path / "good.inp"
    path.write_text(GOOD)
    with pytest.raises(InputError, match="length unit 'furlong'"):
        read_inp(path, length_unit="furlong")
    with pytest.raises(InputError, match="part must be"):
        read_inp(path, length_unit="m", part=1.5)  # type: ignore[arg-type]


def test_a_fault_in_an_included_file_is_named_there(tmp_path: Path) -> None:
    (tmp_path / "nodes.txt").write_text(NODES.replace("6, 1, 0, 1", "6, 1, 0, ?"))
    (tmp_path / "deck.inp").write_text("*HEADING\nnodes elsewhere\n*INCLUDE, INPUT=nodes.txt\n" + CELL)
    with pytest.raises(InputError, match="^nodes.txt, line 7: a node is"):
        read_inp(tmp_path / "deck.inp", length_unit="m")
    (tmp_path / "nodes.txt").write_text(NODES)
    (tmp_path / "deck.inp").write_text("*INCLUDE, INPUT=nodes.txt\n" + CELL.replace("7, 8", "7, 9"))
    with pytest.raises(InputError, match="^deck.inp, line 3: element 1 refers to node 9"):
        read_inp(tmp_path / "deck.inp", length_unit="m")
    (tmp_path / "nodes.txt").write_text("*INCLUDE, INPUT=deck.inp\n")
    with pytest.raises(InputError, match="^nodes.txt, line 1: 'deck.inp' includes itself"):
        read_inp(tmp_path / "deck.inp", length_unit="m")


def test_what_a_set_names_in_vain_is_reported(tmp_path: Path) -> None:
    path = tmp_path / "deck.inp"
    path.write_text(GOOD + "*NSET, NSET=N, GENERATE\n1, 1000000000000, 1\n*ELSET, ELSET=F\n1, 5\n")
    mesh = read_inp(path, length_unit="m")
    assert mesh.sets == {"ALL": 6, "N": 6} and mesh.cell_sets["F"].tolist() == [0]
    assert any("'F' (1), 'N' (999999999992)" in note for note in mesh.notes)
    path.write_text(NODES + "8, 0, 1, 1.5\n" + CELL)
    mesh = read_inp(path, length_unit="m")
    assert mesh.points[7].tolist() == [0, 1, 1.5] and any("defined twice" in note for note in mesh.notes)


def read_garbage(path: Path) -> None:
    """A deck is read or refused; every other exception is a fault of the reader."""
    for part_name in (None, "Brick-1"):
        try:
            with np.errstate(all="ignore"):
                assert isinstance(read_inp(path, length_unit="mm", part=part_name), Mesh)
        except InputError as error:
            assert str(error)


DECKS = [(DATA / name).read_text() for name in ("assembly.inp", "flat.inp", "flat_nodes.inp")]
DECKS[1] = DECKS[1].replace("*INCLUDE, INPUT=flat_nodes.inp\n", DECKS.pop())
TOKENS = ["*", "**", ",", ",,", "=", '"', "\n", "-", "1e400", "0", "99999999999999999999", "S1", "S9", "*PART",
          "*END PART", "*INCLUDE, INPUT=garbage.inp\n", "*NODE\n", "*ELEMENT, TYPE=C3D4\n", "GENERATE", "Top", ".",
          "Brick-1.", "\x00", "é", "*NSET, NSET=Top\nTop\n", "*END INSTANCE\n", "C3D20", "1.5D-3",
          "_", "nan"]  # fmt: skip


@settings(max_examples=300, deadline=None)
@given(data=st.data())
def test_mutated_decks_raise_only_input_errors(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    text = data.draw(st.sampled_from(DECKS))
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(text)))
        length = data.draw(st.sampled_from([0, 1, 2, 10, 60]))
        text = text[:start] + data.draw(st.sampled_from(["", *TOKENS])) + text[start + length :]
    path = tmp_path_factory.getbasetemp() / "garbage.inp"
    path.write_text(text, encoding="utf-8")
    read_garbage(path)


@settings(max_examples=80, deadline=None)
@given(text=st.sampled_from(DECKS), cut=st.floats(0, 1))
def test_truncated_decks_raise_only_input_errors(
    tmp_path_factory: pytest.TempPathFactory, text: str, cut: float
) -> None:
    path = tmp_path_factory.getbasetemp() / "garbage.inp"
    path.write_text(text[: int(cut * len(text))])
    read_garbage(path)


@settings(max_examples=80, deadline=None)
@given(
    content=st.one_of(
        st.binary(max_size=200), st.lists(st.sampled_from(TOKENS), max_size=60).map(lambda t: "".join(t).encode())
    )
)
def test_random_bytes_raise_only_input_errors(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    path = tmp_path_factory.getbasetemp() / "garbage.inp"
    path.write_bytes(content)
    read_garbage(path)


def test_a_surface_of_nodes_with_the_name_of_one_of_faces(tmp_path: Path) -> None:
    text = GOOD + "*SURFACE, NAME=S, TYPE=NODE\n1\n*SURFACE, NAME=S\nE, S2\n"
    (tmp_path / "m.inp").write_text(text)
    mesh = read_inp(tmp_path / "m.inp", length_unit="m")
    assert mesh.sets["S"] == 1
    assert "surface 'S' of nodes is not used, a surface of element faces has that name" in mesh.notes


def test_a_step_that_generates_a_substructure_is_a_step(tmp_path: Path) -> None:
    (tmp_path / "m.inp").write_text(
        GOOD + "*STEP\n*SUBSTRUCTURE GENERATE\n*RETAINED NODAL DOFS\nALL, 1, 3\n*END STEP\n"
    )
    mesh = read_inp(tmp_path / "m.inp", length_unit="m")
    assert mesh.cell_count == 1 and "*SUBSTRUCTUREGENERATE (1)" in mesh.notes[-1]
