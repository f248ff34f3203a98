"""Decks with parts, instances, sets, surfaces, sections and included files, against meshes written down by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import FacetSet, Mesh
from warpffrf.model.mesh.files.inp import read_inp

DATA = Path(__file__).resolve().parents[2] / "data"
ASSEMBLY, FLAT = DATA / "assembly.inp", DATA / "flat.inp"
BRICK = np.array([(x, y, z) for z in (0, 10, 20) for x, y in ((0, 0), (10, 0), (10, 10), (0, 10))], float)  # mm
BRICK_CELLS = np.array([[0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 6, 7, 8, 9, 10, 11]])


def rows(facets: FacetSet) -> set[tuple[int, ...]]:
    """The facets as sets of nodes."""
    return {tuple(sorted(row)) for nodes in facets.blocks.values() for row in nodes.tolist()}


def test_an_instance_equals_the_mesh_made_by_hand() -> None:
    mesh = read_inp(ASSEMBLY, length_unit="mm", part="Brick-1")
    by_hand = Mesh(1e-3 * BRICK, {"hex8": BRICK_CELLS})
    np.testing.assert_allclose(mesh.points, by_hand.points, rtol=0, atol=1e-10)
    np.testing.assert_array_equal(mesh.cells["hex8"], by_hand.cells["hex8"])
    assert mesh.volume() == pytest.approx(2e-6, rel=1e-12)


def test_an_instance_with_clashing_numbers_is_another_body() -> None:
    peg = read_inp(ASSEMBLY, length_unit="mm", part="peg-1")
    assert list(peg.cells) == ["tet10"] and len(peg.points) == 10
    assert peg.volume() == pytest.approx(4.0**3 / 6 * 1e-9, rel=1e-12)
    assert peg.points[:, 2].min() == pytest.approx(0.05)  # moved by 50 mm
    assert rows(peg.facets("Peg foot")) == {(0, 1, 2, 4, 5, 6)} and set(peg.facet_sets) == {"Peg foot"}
    assert peg.cell_sets["All"].tolist() == [0]


def test_translation_goes_before_rotation() -> None:
    mesh = read_inp(ASSEMBLY, length_unit="mm", part="Brick-2")
    # by hand: moved by (20, 0, 0), then 90 degrees about the line x = 10, y = 0 along +z:
    # (x, y) -> (10 - y, x - 10) of the moved point, so the origin goes to (20, 0) and then to (10, 10)
    x, y, z = BRICK.T
    np.testing.assert_allclose(mesh.points, 1e-3 * np.stack([10 - y, (x + 20) - 10, z], axis=1), atol=1e-16)


def test_the_only_instance_of_a_part_may_be_named_by_the_part() -> None:
    mesh = read_inp(ASSEMBLY, length_unit="mm", part="Peg")
    assert mesh.content_hash() == read_inp(ASSEMBLY, length_unit="mm", part="Peg-1").content_hash()


def test_several_bodies_must_be_distinguished() -> None:
    with pytest.raises(InputError, match=r"3 bodies, select one with part=, one of 'Brick-1', 'Brick-2', 'Peg-1'"):
        read_inp(ASSEMBLY, length_unit="mm")
    with pytest.raises(InputError, match=r"'brick' is placed more than once, select one .* 'Brick-1', 'Brick-2'"):
        read_inp(ASSEMBLY, length_unit="mm", part="brick")
    with pytest.raises(InputError, match=r"no body 'wheel'; known: 'Brick-1'"):
        read_inp(ASSEMBLY, length_unit="mm", part="wheel")


def test_sets_by_range_nested_and_of_the_assembly() -> None:
    mesh = read_inp(ASSEMBLY, length_unit="mm", part="Brick-1")
    foot, head = (0, 1, 2, 3), (8, 9, 10, 11)
    assert rows(mesh.facets("Foot")) == {foot}
    assert rows(mesh.facets("Foot and edge")) == {foot}  # nested, with a quoted name
    assert rows(mesh.facets("Top")) == {head}  # of the assembly: instance=, two definitions
    assert rows(mesh.facets("Both ends")) == {foot, head}  # of the assembly: a set there and one inside the instance
    assert mesh.cell_sets["All"].tolist() == [0, 1] and mesh.cell_sets["assembly.All"].tolist() == [0]
    assert mesh.cell_sets["Upper"].tolist() == [1]
    assert not {"Edge", "Reference", "_Head_S2", "_Sides_S3"} & {*mesh.sets, *mesh.cell_sets}
    second = read_inp(ASSEMBLY, length_unit="mm", part="Brick-2")
    assert rows(second.facets("Top")) == {head} and rows(second.facets("Both ends")) == {head}
    assert second.cell_sets["Upper"].tolist() == [1] and "assembly.All" not in second.cell_sets


def test_surfaces_of_the_part_and_of_the_assembly() -> None:
    mesh = read_inp(ASSEMBLY, length_unit="mm", part="Brick-1")
    assert rows(mesh.facets("Head")) == {(8, 9, 10, 11)}
    assert rows(mesh.facets("assembly.Head")) == {(0, 1, 2, 3)}  # the face between the cells is inside: left out
    assert rows(mesh.facets("Sides")) == {(0, 1, 4, 5), (4, 5, 8, 9)}
    assert rows(mesh.facets("TopNodes")) == {(8, 9, 10, 11)}
    assert "Skin" not in mesh.sets
    assert any("surface 'Head': 1 faces inside" in note for note in mesh.notes)
    skin = read_inp(ASSEMBLY, length_unit="mm", part="Brick-2").facets("Skin")
    assert rows(skin) == rows(mesh.outer_facets()) and len(skin) == 10


def test_materials_and_notes() -> None:
    brick = read_inp(ASSEMBLY, length_unit="mm", part="Brick-1")
    steel = brick.materials["All"]
    assert isinstance(steel, Material)
    assert (steel.youngs_modulus, steel.poisson_ratio, steel.name) == (pytest.approx(2.1e11), 0.3, "Steel")
    assert steel.density == pytest.approx(7850.0)
    notes = "\n".join(brick.notes)
    for said in (
        "2 C3D8R cells are integrated fully, as hex8",
        "MPa and t/mm3",
        "*BOUNDARY (1), *ENDSTEP (1), *PREPRINT (1), *STATIC (1), *STEP (1)",
        "instance 'Brick-1' of part 'Brick'",
        "node sets without a complete free face are not used: 'Edge'",
        "'assembly.All'",
    ):
        assert said in notes, said
    peg = read_inp(ASSEMBLY, length_unit="mm", part="Peg-1")
    assert not peg.materials
    notes = "\n".join(peg.notes)
    assert "1 C3D10M cells are not modified here, as tet10" in notes
    assert "'Soft stuff'" in notes and "it has no *Density" in notes and "at temperature 20" in notes
    inches = read_inp(ASSEMBLY, length_unit="in", part="Brick-1")
    assert not inches.materials and any("not used: with lengths in in" in note for note in inches.notes)
    assert np.ptp(inches.points[:, 2]) == pytest.approx(20 * 0.0254)


def test_flat_deck_with_two_kinds_two_materials_and_an_included_file() -> None:
    mesh = read_inp(FLAT, length_unit="m")
    points = [
        (0, 0, 0),
        (1, 0, 0),
        (1, 1, 0),
        (0, 1, 0),
        (0, 0, 1),
        (1, 0, 1),
        (1, 1, 1),
        (0, 1, 1),
        (0, 0, 2),
        (0, 1, 2),
    ]
    by_hand = Mesh(np.array(points, float), {"hex8": np.arange(8)[None], "wedge6": np.array([[4, 8, 5, 7, 9, 6]])})
    np.testing.assert_allclose(mesh.points, by_hand.points, rtol=0, atol=1e-10)
    for kind, nodes in by_hand.cells.items():
        np.testing.assert_array_equal(mesh.cells[kind], nodes)
    assert mesh.volume() == pytest.approx(1.5, rel=1e-12)
    assert {name: cells.tolist() for name, cells in mesh.cell_sets.items()} == {
        "LOWER": [0], "UPPER": [1], "WHOLE": [0, 1]
    }  # fmt: skip
    lower = mesh.materials["LOWER"]
    assert isinstance(lower, Material) and lower.youngs_modulus == 2.1e11 and mesh.materials["UPPER"].density == 2700.0
    assert rows(mesh.facets("FOOT")) == rows(mesh.facets("FEET")) == {(0, 1, 2, 3)}
    assert rows(mesh.facets("SLOPE")) == {(5, 6, 8, 9)}
    assert rows(mesh.facets("SHELL")) == rows(mesh.facets("NALL")) == rows(mesh.outer_facets())
    assert "INSIDE" not in mesh.sets
    notes = "\n".join(mesh.notes)
    assert "1 nodes belong to no solid cell" in notes and "left out: 1 SPRINGA" in notes


def test_a_body_of_a_flat_deck_by_its_element_set_or_number() -> None:
    wedge = read_inp(FLAT, length_unit="m", part="upper")
    assert list(wedge.cells) == ["wedge6"] and len(wedge.points) == 6 and set(wedge.materials) == {"UPPER"}
    assert rows(wedge.facets("SHELL")) == rows(wedge.outer_facets())
    assert read_inp(FLAT, length_unit="m", part=0).cell_count == 2
    with pytest.raises(InputError, match="no element set 'middle' for part=; known: 'LOWER', 'UPPER'"):
        read_inp(FLAT, length_unit="m", part="middle")
    with pytest.raises(InputError, match="1 connected part"):
        read_inp(FLAT, length_unit="m", part=1)


def test_two_parts_of_a_flat_deck_by_number(tmp_path: Path) -> None:
    nodes = "\n".join(f"{i + 1}, {x}, {y}, {z}" for i, (x, y, z) in enumerate([*BRICK[:8], *BRICK[:8] + 100.0]))
    cells = "1, 1,2,3,4,5,6,7,8\n2, 9,10,11,12,13,14,15,16"
    path = tmp_path / "two.inp"
    path.write_text(f"*NODE\n{nodes}\n*ELEMENT, TYPE=C3D8, ELSET=E\n{cells}\n")
    with pytest.raises(InputError, match="two.inp.*2 disconnected parts"):
        read_inp(path, length_unit="mm")
    second = read_inp(path, length_unit="mm", part=1)
    np.testing.assert_allclose(second.points, 1e-3 * (BRICK[:8] + 100.0))
    assert second.cell_sets["E"].tolist() == [0]


def test_case_blanks_quotes_comments_and_windows_lines(tmp_path: Path) -> None:
    text = FLAT.read_text().replace("*INCLUDE, INPUT=flat_nodes.inp", (DATA / "flat_nodes.inp").read_text())
    changed = text.replace("*ELSET, ELSET=WHOLE", '  * el set ,elset = "whole"').replace("*NODE", "*node , ")
    changed = changed.replace("LOWER", "lower").replace("\n", "\n** a comment, with *STAR\n\n").replace("\n", "\r\n")
    changed = changed.replace("*ELEMENT, TYPE=C3D6,\r\n** a comment, with *STAR\r\n\r\n", "*ELEMENT, TYPE=C3D6,\r\n")
    path = tmp_path / "odd.inp"
    path.write_bytes(changed.encode())
    mesh, plain = read_inp(path, length_unit="m"), read_inp(FLAT, length_unit="m")
    assert {k.lower(): v.tolist() for k, v in mesh.cell_sets.items()} == {
        k.lower(): v.tolist() for k, v in plain.cell_sets.items()
    }
    np.testing.assert_array_equal(mesh.points, plain.points)
    assert mesh.sets == plain.sets


def test_data_lines_in_another_file(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    nodes = (DATA / "flat_nodes.inp").read_text().split("\n", 1)[1]
    (tmp_path / "sub" / "nodes.txt").write_text(nodes)
    (tmp_path / "sub" / "more.inp").write_text("*NODE, INPUT=nodes.txt, NSET=NALL\n")
    text = FLAT.read_text().replace("flat_nodes.inp", '"sub\\more.inp"')  # next to the including file
    (tmp_path / "a.inp").write_text(text)
    (tmp_path / "b.inp").write_text(
        text.replace('*INCLUDE, INPUT="sub\\more.inp"', "*NODE,NSET=NALL\n*INCLUDE,INPUT=sub/nodes.txt")
    )
    expected = read_inp(FLAT, length_unit="m").content_hash()
    assert read_inp(tmp_path / "a.inp", length_unit="m").content_hash() == expected
    assert read_inp(tmp_path / "b.inp", length_unit="m").content_hash() == expected
