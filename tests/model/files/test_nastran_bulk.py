"""Nastran bulk data: the three formats of a card, node orders, coordinate systems, materials, and bad lines."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import meshio
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from warpffrf.model import mesh as wfmesh
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh.elements import cell_kind

KINDS = {"hex8": "hexahedron", "hex20": "hexahedron20", "wedge6": "wedge", "wedge15": "wedge15"}
KINDS |= {"tet4": "tetra", "tet10": "tetra10"}
CUBE = cell_kind("hex8").nodes + 1.0  # corners of [0, 2]^3

Read = Callable[..., wfmesh.Mesh]


@pytest.fixture
def read(tmp_path: Path) -> Read:
    """Write a deck and read it."""

    def made(text: str, unit: str = "m", **more) -> wfmesh.Mesh:
        (tmp_path / "deck.bdf").write_text(text)
        return wfmesh.read(tmp_path / "deck.bdf", length_unit=unit, **more)

    return made


def grids(points: np.ndarray, system: str = "") -> str:
    return "".join(f"GRID,{10 * i + 10},{system},{x},{y},{z}\n" for i, (x, y, z) in enumerate(points.tolist()))


def cube(property_: int = 3) -> str:
    """A hexahedron in free format, its continuation automatic."""
    return f"CHEXA,1,{property_},10,20,30,40,50,60\n,70,80\n"


@pytest.mark.parametrize("kind", list(KINDS))
@pytest.mark.parametrize("point_format", ["fixed-large", "free"])
def test_node_orders_as_meshio_writes_them(tmp_path: Path, kind: str, point_format: str) -> None:
    """Middle nodes off the straight edges, each in its own way, so that no two may change places."""
    from meshio._mesh import topological_dimension
    from meshio.nastran._nastran import write

    topological_dimension.setdefault("wedge15", 3)
    nodes = cell_kind(kind).nodes
    bent = nodes + 0.05 * np.sin(np.arange(nodes.size) + 1.0).reshape(nodes.shape)
    points = np.round(bent, 6)  # longer numbers do not fit meshio's fields
    path = tmp_path / f"{kind}.bdf"
    write(path, meshio.Mesh(points, [(KINDS[kind], np.arange(len(nodes))[None])]), point_format)
    path.write_text(path.read_text().replace("A_", "A "))  # meshio's own names of quadratic cells
    mesh = wfmesh.read(path, length_unit="m")
    assert mesh.single[0] == kind
    np.testing.assert_allclose(mesh.points[mesh.single[1][0]], points, atol=1e-15)


def test_small_field_format(read: Read) -> None:
    text = "SOL 103\nCEND\nBEGIN BULK\n$ a comment\n"
    for i, x in enumerate(CUBE):
        text += f"GRID    {i + 1:8d}        {x[0]:8.3f}{x[1]:8.3f}{x[2]:8.3f}   $ corner\n"
    text += "CHEXA   " + "".join(f"{v:8d}" for v in (1, 7, 1, 2, 3, 4, 5, 6)) + "+A\n+A      " + f"{7:8d}{8:8d}\n"
    mesh = read(text + "ENDDATA\nGRID, rubbish\n", "mm")
    assert mesh.volume() == pytest.approx(8e-9) and mesh.cell_sets["property_7"].tolist() == [0]


def test_large_field_format(read: Read) -> None:
    text = ""
    for i, x in enumerate(CUBE):
        text += f"GRID*   {i + 1:16d}{'':16s}{x[0]:16.3f}{x[1]:16.3f}*\n*       {x[2]:16.3f}\n"
    text += "CHEXA*  " + "".join(f"{v:16d}" for v in (1, 7, 1, 2)) + "*\n"
    text += "*       " + "".join(f"{v:16d}" for v in (3, 4, 5, 6)) + "*\n*       " + f"{7:16d}{8:16d}\n"
    assert read(text).volume() == pytest.approx(8.0)


@pytest.mark.parametrize("text", ["1.5-2", "1.5e-2", "1.5D-2", ".015", "+15.-3"])
def test_numbers_as_nastran_writes_them(read: Read, text: str) -> None:
    points = grids(CUBE).replace("2.0", text)
    assert read(points + cube()).points.max() == pytest.approx(0.015, rel=1e-15)


def test_local_coordinate_systems(read: Read) -> None:
    """A cube given in a cylindrical system that is given in a rotated one; spherical radii of its corners."""
    turned = "CORD2R,1,0,1.,0.,0.,1.,0.,1.\n,1.,1.,0.\n"  # e_1 = y, e_2 = -x, e_3 = z, origin (1, 0, 0)
    cylinder = "CORD2C,2,1,0.,0.,0.5,0.,0.,1.5\n,1.,0.,0.5\n"  # the same axes, 0.5 up
    r, theta = np.hypot(CUBE[:, 0], CUBE[:, 1]), np.degrees(np.arctan2(CUBE[:, 1], CUBE[:, 0]))
    mesh = read(turned + cylinder + grids(np.stack([r, theta, CUBE[:, 2]], axis=1), "2") + cube())
    expected = np.stack([1.0 - CUBE[:, 1], CUBE[:, 0], CUBE[:, 2] + 0.5], axis=1)
    np.testing.assert_allclose(mesh.points, expected, atol=1e-14)
    x = CUBE + 1.0
    R = np.linalg.norm(x, axis=1)
    angles = np.degrees(np.stack([np.arccos(x[:, 2] / R), np.arctan2(x[:, 1], x[:, 0])], axis=1))
    ball = "CORD2S,5,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n"
    mesh = read(ball + grids(np.column_stack([R, angles]), "5") + cube())
    np.testing.assert_allclose(mesh.points, x, atol=1e-14)


def test_shells_are_surfaces_and_strays_are_noted(read: Read) -> None:
    shells = "CQUAD4,5,8,50,60,70,80,30.,\nCTRIA3,6,9,10,20,70\n"
    mesh = read(grids(CUBE) + cube() + shells)
    assert mesh.sets == {"property_8": 1}
    assert np.all(mesh.points[mesh.facets("property_8").node_set][:, 2] == 2.0)
    assert any("'property_9': 1 facets that are no faces" in note for note in mesh.notes)


def test_properties_and_materials(read: Read) -> None:
    two = np.concatenate([CUBE, CUBE + [2.0, 0.0, 0.0]])
    other = "CHEXA,2,4,20,100,110,30,60,140\n,150,70\n"
    cards = "PSOLID,3,1\nPSOLID,4,2\nMAT1,1,2.1+5,,.3,7.85-9\nMAT1,2,70000.,26000.,,2.7-9\nSPC1,1,123,10\n"
    deck = grids(two[[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15]]) + cube() + other + cards
    mesh = read(deck, "mm")
    assert set(mesh.cell_sets) == {"property_3", "property_4"}
    steel, alu = mesh.materials["property_3"], mesh.materials["property_4"]
    assert isinstance(steel, Material) and isinstance(alu, Material)
    assert steel.youngs_modulus == pytest.approx(210e9) and steel.density == pytest.approx(7850.0)
    assert alu.poisson_ratio == pytest.approx(70000 / 52000 - 1)
    assert any("MPa and t/mm3" in note for note in mesh.notes) and any("SPC1 (1)" in note for note in mesh.notes)
    report = mesh.report()
    assert report.mass == pytest.approx(8e-9 * (7850 + 2700))
    inches = read(deck, "in")
    assert not inches.materials and any("are not used" in note for note in inches.notes)


def test_include(read: Read, tmp_path: Path) -> None:
    (tmp_path / "nodes.inc").write_text(grids(CUBE))
    assert read("INCLUDE 'nodes.inc'\n" + cube()).cell_count == 1
    with pytest.raises(InputError, match="deck.bdf, line 2: INCLUDE 'lost.inc' does not exist"):
        read("$\nINCLUDE 'lost.inc'\n")
    with pytest.raises(InputError, match="nodes.inc, line 1.*includes itself"):
        (tmp_path / "nodes.inc").write_text("INCLUDE 'deck.bdf'\n")
        read("INCLUDE 'nodes.inc'\n" + cube())


WEDGES = "".join(
    f"GRID,{3 * k + i + 1},,{x},{k}.\n" for k in range(5) for i, x in enumerate(("0.,0.", "1.,0.", "0.,1."))
)


@pytest.mark.parametrize(
    ("copies", "count"),
    [
        ("=,*1,=,*3,*3,*3,*3,*3,*3\n", 2),
        ("=,*(1),=,*(3),*3,*3,*3,*3,*3\n=(2)\n", 4),
        ("=,*1,=,*3,*3,*3,*3,*3,*3\n=1\n=,*1,==\n", 4),  # the last one is where the one before it is
        ("=       *1      =       *3      *3      *3      *3      *3      *3\n", 2),
    ],
)
def test_cards_by_replication(read: Read, copies: str, count: int) -> None:
    deck = "CPENTA,1,1,1,2,3,4,5,6\n" + copies + WEDGES
    if "==" in copies:
        with pytest.raises(InputError, match="have the corners of another one, the first are element 3 and 4"):
            read(deck)
    else:
        assert read(deck).volume() == pytest.approx(0.5 * count, rel=1e-14)


def test_grid_points_by_replication(read: Read) -> None:
    """Four cubes in a row: nodes and cells of five and four lines, continuations copied with their cards."""
    face = ("0.,0.", "1.,0.", "1.,1.", "0.,1.")
    grid = "".join(f"GRID,{i},,{x},0.\n=,*10,==\n" for i, x in enumerate(face, start=1))
    grid = "".join(f"GRID,{i},,{x},0.\n=,*10,=,=,=,*1.0\n=3\n" for i, x in enumerate(face, start=1))
    cells = "CHEXA,1,1,1,2,3,4,11,12\n,13,14\n=,*1,=,*10,*10,*10,*10,*10,*10\n,*10,*10\n=2\n"
    mesh = read(grid + cells)
    assert mesh.cell_count == 4 and mesh.volume() == pytest.approx(4.0, rel=1e-14)
    with pytest.raises(InputError, match="it gives 8 of the 10 fields of CHEXA; write == for the rest"):
        read(grid + cells.replace(",*10,*10\n=2", "=2"))


def test_weights_become_densities(read: Read) -> None:
    text = grids(CUBE) + cube() + "PSOLID,3,1\nMAT1,1,3.2+9,,.38,11180.\n"
    for before, after in (("", "PARAM,WTMASS,.10197\n"), ("PARAM,WTMASS,.10197\nBEGIN BULK\n", "")):
        mesh = read(before + text + after)
        assert mesh.materials["property_3"].density == pytest.approx(0.10197 * 11180.0, rel=1e-14)
        assert any("PARAM,WTMASS 0.10197" in note for note in mesh.notes)
    with pytest.raises(InputError, match="PARAM,WTMASS is given as .0.1, 0.2."):
        read(text + "PARAM,WTMASS,.1\nPARAM,WTMASS,.2\n")


@pytest.mark.parametrize("kind", ["CTETRA", "CPENTA", "CHEXA"])
def test_cells_of_either_hand(read: Read, kind: str) -> None:
    """Mirrored cells have the volume of the others, and are noted."""
    nodes = cell_kind({"CTETRA": "tet4", "CPENTA": "wedge6", "CHEXA": "hex8"}[kind]).nodes
    row = [10 * i + 10 for i in range(len(nodes))]
    card = f"{kind},7,1,{','.join(map(str, row[:6]))}\n" + (f",{row[6]},{row[7]}\n" if len(row) > 6 else "")
    right, left = read(grids(nodes) + card), read(grids(nodes * [1.0, 1.0, -1.0]) + card)
    assert left.volume() == pytest.approx(right.volume(), rel=1e-14)
    assert not right.notes and "with nodes in reversed order are corrected" in left.notes[0]
    # a cell that is no cell either way is named by its number
    with pytest.raises(InputError, match="inverted .* the first is element 7"):
        read(grids(nodes * [1.0, 1.0, 0.0]) + card)


def test_names_of_continuations_are_compared(read: Read) -> None:
    card = "CHEXA,1,3,10,20,30,40,50,60,{}\n{},70,80\n"
    for behind, before in (("+A", "+A"), ("", "+"), ("+A", "+"), ("", "+A")):
        assert read(grids(CUBE) + card.format(behind, before)).cell_count == 1
    with pytest.raises(InputError, match="deck.bdf, line 10: continuation '.B' is found where '.A' .* is expected"):
        read(grids(CUBE) + card.format("+A", "+B"))
    fixed = "CHEXA   1       3       10      20      30      40      50      60      {}\n{}70      80\n"
    assert read(grids(CUBE) + fixed.format("+A", "+A      ")).cell_count == 1
    with pytest.raises(InputError, match="continuation"):
        read(grids(CUBE) + fixed.format("+A", "+B      "))


def test_other_solids_are_not_passed_over(read: Read) -> None:
    with pytest.raises(InputError, match="CHEXP: solids of this name are not read"):
        read(grids(CUBE) + cube() + "CHEXP,2,1,10,20\n")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (grids(CUBE), "no volume cells"),
        (grids(CUBE[:-1]) + cube(), "line 8: CHEXA: grid point 80 does not exist"),
        (grids(CUBE) + "CHEXA,1,1,10,20\n", "line 9: CHEXA: field 6 must be an integer"),
        (grids(CUBE) + "CHEXA,1,1,10,20,30,40,50,60\n,70,80,90\n", "line 9: CHEXA: 11 of its mid-side nodes"),
        ("GRID,1,,a,0.,0.\n", "line 1: GRID: field 4 must be a number, got 'a'"),
        ("GRID,1,,1e999,0.,0.\n", "must be a number"),
        ("GRID,1,,1_0,0.,0.\n", "field 4 must be a number, got '1_0'"),
        ("GRID,1_0,,1.,0.,0.\n", "field 2 must be an integer, got '1_0'"),
        ("GRID,1,,nan,0.,0.\n", "must be a number"),
        (grids(CUBE, "9") + cube(), "line 1: GRID: coordinate system 9"),
        ("CORD2R,9,9,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n" + grids(CUBE, "9") + cube(), "coordinate system 9.*itself"),
        ("CORD2R,9,,0.,0.,0.,0.,0.,1.\n,0.,0.,2.\n" + grids(CUBE, "9") + cube(), "on one line"),
        ("CPYRAM,1,1,1,2,3,4,5\n", "pyramids are not supported"),
        ("GRDSET,,3\n", "default coordinate system"),
        ("+A,1,2\n", "line 1: a continuation without a card"),
        (
            grids(CUBE) + "GRID,20,,9.,0.,0.\n" + cube(),
            "line 9: GRID: grid point 20 is defined twice, at different positions",
        ),
        (grids(CUBE) + cube() + cube(), "line 11: CHEXA: element 1 is defined twice"),
    ],
)
def test_bad_decks(read: Read, text: str, message: str) -> None:
    with pytest.raises(InputError, match=f"deck.bdf.*{message}"):
        read(text)


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_garbage_is_refused_by_name(tmp_path: Path, data: st.DataObject) -> None:
    deck = "PSOLID,3,1\nMAT1,1,2.1+5,,.3,7.85-9\nCORD2R,1,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n" + grids(CUBE, "1") + cube()
    at = data.draw(st.integers(0, len(deck)))
    kind = data.draw(st.sampled_from(["cut", "put", "noise"]))
    put = data.draw(st.text(alphabet="0123456789.,+-*$eE \n\tGRIDCHEXA'", max_size=12))
    text = {"cut": deck[:at], "put": deck[:at] + put + deck[at + len(put) :], "noise": put * 5}[kind]
    path = tmp_path / "deck.dat"
    path.write_text(text)
    try:
        wfmesh.read(path, length_unit="mm").check()
    except InputError as error:
        assert "deck.dat" in str(error)
