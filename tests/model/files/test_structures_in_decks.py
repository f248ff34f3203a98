"""Shells, beams, masses, springs and rigid bodies of Abaqus, CalculiX and Nastran decks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Beam, Mesh, PointMass, RigidLink, Shell, Spring, read
from warpffrf.offline import reduce

MATERIAL = "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n*DENSITY\n7.85E-9\n"
NODES = """*NODE
1, 0., 0., 0.
2, 100., 0., 0.
3, 100., 50., 0.
4, 0., 50., 0.
5, 200., 0., 0.
6, 200., 50., 0.
7, 300., 0., 0.
8, 300., 0., 40.
"""
INP = (
    NODES
    + """*ELEMENT, TYPE=S4, ELSET=PLATE
1, 1, 2, 3, 4
*ELEMENT, TYPE=S3, ELSET=PLATE
2, 2, 5, 6
3, 2, 6, 3
*ELEMENT, TYPE=B31, ELSET=ARM
4, 5, 7
*ELEMENT, TYPE=MASS, ELSET=LUMP
5, 8
*ELEMENT, TYPE=ROTARYI, ELSET=TURN
6, 8
*ELEMENT, TYPE=SPRINGA, ELSET=SPRING
7, 6, 7
*NSET, NSET=TIP
7
*NSET, NSET=SPIDER
8
"""
    + MATERIAL
    + """*SHELL SECTION, ELSET=PLATE, MATERIAL=STEEL, OFFSET=0.5
4.
*BEAM SECTION, ELSET=ARM, MATERIAL=STEEL, SECTION=RECT
10., 20.
0., 1., 0.
*MASS, ELSET=LUMP
0.002
*ROTARY INERTIA, ELSET=TURN
3., 4., 5.
*SPRING, ELSET=SPRING

1000.
*RIGID BODY, REF NODE=7, NSET=SPIDER
"""
)
BDF = """BEGIN BULK
GRID,1,,0.,0.,0.
GRID,2,,100.,0.,0.
GRID,3,,100.,50.,0.
GRID,4,,0.,50.,0.
GRID,5,,200.,0.,0.
GRID,6,,200.,50.,0.
GRID,7,,300.,0.,0.
GRID,8,,300.,0.,40.
CQUAD4,1,1,1,2,3,4,,-2.
CTRIA3,2,1,2,5,6,,-2.
CTRIA3,3,1,2,6,3,,-2.
PSHELL,1,1,4.,1,,1
CBAR,4,2,5,7,0.,1.,0.
PBARL,2,1,,BAR
,20.,10.
CONM2,5,8,,0.002
,3.,,4.,,,5.
CBUSH,7,3,6,7,0.,0.,1.
PBUSH,3,K,1000.
RBE2,8,7,123456,8
MAT1,1,210000.,,0.3,7.85-9
ENDDATA
"""


def deck(folder: Path, text: str, name: str = "deck.inp") -> Mesh:
    (folder / name).write_text(text)
    return read(folder / name, length_unit="mm")


@pytest.mark.parametrize(("text", "name"), [(INP, "deck.inp"), (BDF, "deck.bdf")])
def test_both_decks_give_the_same_structure_in_si(tmp_path: Path, text: str, name: str) -> None:
    mesh = deck(tmp_path, text, name)
    assert mesh.points == pytest.approx(1e-3 * np.loadtxt(NODES.splitlines()[1:], delimiter=",")[:, 1:])
    shells, (beam,) = mesh.structure.of(Shell), mesh.structure.of(Beam)
    assert sorted((s.kind, len(s.nodes)) for s in shells) == [("quad4", 1), ("tri3", 2)]
    assert all(s.thickness == pytest.approx(0.004) and s.offset == pytest.approx(-0.002) for s in shells)
    assert shells[0].material.youngs_modulus == pytest.approx(210e9)
    assert shells[0].material.density == pytest.approx(7850.0)
    assert beam.nodes.tolist() == [[4, 6]] and beam.direction[0].tolist() == [0.0, 1.0, 0.0]
    assert beam.section.I_z == pytest.approx(0.02 * 0.01**3 / 12.0)  # 10 mm along y, 20 along z
    assert beam.section.I_y == pytest.approx(0.01 * 0.02**3 / 12.0)
    (mass,) = mesh.structure.of(PointMass)
    assert mass.node == 7 and mass.mass == pytest.approx(2.0)
    assert mass.inertia == pytest.approx(1e-3 * np.diag([3.0, 4.0, 5.0]))  # t mm2 is 1e-3 kg m2
    (spring,) = mesh.structure.of(Spring)
    along = (mesh.points[6] - mesh.points[5]) / np.linalg.norm(mesh.points[6] - mesh.points[5])
    assert spring.axes[:, 0] == pytest.approx(along)
    assert spring.stiffness[0, 0] == pytest.approx(1e6) and np.sum(spring.stiffness) == pytest.approx(1e6)
    (link,) = mesh.structure.of(RigidLink)
    assert link.nodes.tolist() == [6, 7] and link.name in mesh.node_sets
    name = "PLATE" if name.endswith(".inp") else "property_1"
    assert len(mesh.facet_sets[name]) == 3
    if name == "PLATE":
        assert mesh.node_sets["TIP"].tolist() == [6]
    assert not any("left out" in note for note in mesh.notes)
    body = reduce(mesh.check(), modes=2, interfaces={link.name: "rigid"}, cache=False, progress=False)
    plate, arm = 0.004 * (0.2 * 0.05) * 7850.0, 0.01 * 0.02 * 0.1 * 7850.0
    assert body.mass == pytest.approx(plate + arm + 2.0)


HEX = """*NODE
1, 0., 0., 0.
2, 10., 0., 0.
3, 10., 10., 0.
4, 0., 10., 0.
5, 0., 0., 10.
6, 10., 0., 10.
7, 10., 10., 10.
8, 0., 10., 10.
9, 20., 0., 10.
10, 20., 10., 10.
11, 50., 0., 0.
12, 60., 0., 0.
13, 60., 10., 0.
*ELEMENT, TYPE=C3D8, ELSET=BLOCK
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=S4, ELSET=COVER
2, 5, 8, 7, 6
*ELEMENT, TYPE=S4, ELSET=WING
3, 6, 9, 10, 7
*ELEMENT, TYPE=S3, ELSET=APART
4, 11, 12, 13
"""
SECTIONS = "".join(f"*SHELL SECTION, ELSET={name}, MATERIAL=STEEL\n1.\n" for name in ("COVER", "WING", "APART"))


def test_shells_on_a_solid_keep_its_normals_and_unconnected_ones_are_counted(tmp_path: Path) -> None:
    mesh = deck(tmp_path, HEX + MATERIAL + "*SOLID SECTION, ELSET=BLOCK, MATERIAL=STEEL\n" + SECTIONS)
    assert mesh.cell_count == 1 and len(mesh.points) == 10
    assert mesh.structure.counts() == {"quad4 shell": 2}
    cover = mesh.facet_sets["COVER"]
    normal = cover.node_normals(mesh.points)
    assert normal == pytest.approx(np.tile([0.0, 0.0, 1.0], (4, 1)))  # outward, whatever the shell's own side is
    assert len(mesh.facet_sets["WING"]) == 1 and "APART" not in mesh.facet_sets
    assert any("not connected with the solids are left out: 1 tri3 shell" in note for note in mesh.notes)
    assert not any("WING" in note or "elements that fill no volume" in note for note in mesh.notes)


def test_shells_without_a_section_only_name_faces(tmp_path: Path) -> None:
    mesh = deck(tmp_path, HEX + MATERIAL + "*SOLID SECTION, ELSET=BLOCK, MATERIAL=STEEL\n")
    assert not mesh.structure.parts and list(mesh.facet_sets)[0] == "COVER"
    assert any("left out: 2 S4, 1 S3" in note for note in mesh.notes)


def test_a_part_of_a_deck_is_read_without_its_structure(tmp_path: Path) -> None:
    (tmp_path / "deck.inp").write_text(HEX + MATERIAL + SECTIONS)
    mesh = read(tmp_path / "deck.inp", length_unit="mm", part=0)
    assert not mesh.structure.parts and mesh.cell_count == 1


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("OFFSET=0.5\n4.", "COMPOSITE\n4.", "COMPOSITE is not read"),
        ("OFFSET=0.5\n4.", "OFFSET=0.5\n0.", "thickness"),
        ("OFFSET=0.5\n4.", "OFFSET=0.5", "needs a data line"),
        ("SECTION=RECT", "SECTION=HEX", "SECTION=HEX is not read"),
        ("0., 1., 0.\n*MASS", "0., 0., 0.\n*MASS", "zero length"),
        ("ELSET=PLATE, MATERIAL=STEEL", "ELSET=PLATE, MATERIAL=IRON", "there is no material 'IRON'"),
        ("*DENSITY\n7.85E-9\n", "", "needs isotropic|Density"),
        ("3., 4., 5.", "3., 4., 50.", "no body has the inertia"),
        ("\n\n1000.", "", "needs the line"),
        ("REF NODE=7, NSET=SPIDER", "REF NODE=77, NSET=SPIDER", "does not exist"),
        ("3, 2, 6, 3", "3, 2, 6, 33", "does not exist"),
        ("3, 2, 6, 3", "3, 2, 6, 6", "a node twice"),
    ],
)
def test_faults_of_an_inp_deck_name_the_line(tmp_path: Path, old: str, new: str, text: str) -> None:
    assert old in INP
    with pytest.raises(InputError, match=text) as error:
        deck(tmp_path, INP.replace(old, new))
    assert "deck.inp" in str(error.value)


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("PSHELL,1,1,4.", "PSHELL,1,1,0.", "PSHELL.*thickness"),
        ("PBARL,2,1,,BAR", "PBARL,2,1,,HAT", "type HAT"),
        ("CBAR,4,2,5,7,0.,1.,0.", "CBAR,4,2,5,7,0.,1.,0.,,\n,456", "pin flags"),
        ("CONM2,5,8,,0.002", "CONM2,5,8,3,0.002", "coordinate system 3"),
        ("RBE2,8,7,123456,8", "RBE2,8,7,123456", "no dependent"),
        ("CONM2,5,8,", "CONM2,5,88,", "grid point 88 does not exist"),
    ],
)
def test_faults_of_bulk_data_name_the_card(tmp_path: Path, old: str, new: str, text: str) -> None:
    assert old in BDF
    with pytest.raises(InputError, match=text) as error:
        deck(tmp_path, BDF.replace(old, new), "deck.bdf")
    assert "deck.bdf" in str(error.value)


def test_what_bulk_data_holds_beyond_that_is_counted(tmp_path: Path) -> None:
    text = BDF.replace("RBE2,8,7,123456,8", "RBE2,8,7,123,8\nCELAS2,9,5.,3,3\nRBE2,10,7,123456,8")
    mesh = deck(tmp_path, text, "deck.bdf")
    (note,) = [note for note in mesh.notes if note.startswith("structural elements that are not read")]
    assert "RBE2 of components 123 (1)" in note and "CELAS2 to the ground" in note
