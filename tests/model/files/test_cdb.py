"""Ansys databases: blocks, degenerate solids, components, materials, faults; files that mapdl-archive reads too."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from warpffrf.model import mesh as wfmesh
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh.files.columns import Lines

HEX20 = [*range(20)]  # Ansys numbers the nodes of a hexahedron as VTK does
STEEL = ["MPTEMP,R5.0, 1, 1,  0.00000000    ,", "MPDATA,R5.0, 1,EX  ,       1, 1,  210000.000    ,",
         "MPDATA,R5.0, 1,PRXY,       1, 1, 0.300000000    ,", "MP,DENS,1,7.85E-09"]  # fmt: skip


def real(x: float) -> str:
    mantissa, exponent = f"{x:.13E}".split("E")
    return f"{mantissa}E{int(exponent):+04d}".rjust(21)


def nblock(points: np.ndarray, numbers: Sequence[int] | None = None) -> list[str]:
    """Nodes as CDWRITE writes them: trailing zeros are left out."""
    lines = [f"NBLOCK,6,SOLID,{len(points)},{len(points)}", "(3i9,6e21.13e3)"]
    for number, x in zip(numbers or range(1, len(points) + 1), points.tolist(), strict=True):
        while x and x[-1] == 0.0:
            x = x[:-1]
        lines.append(f"{number:9d}{0:9d}{0:9d}" + "".join(map(real, x)))
    return [*lines, "N,R5.3,LOC,       -1,"]


def eblock(rows: Sequence[tuple[int, int, Sequence[int]]], first: int = 1) -> list[str]:
    """Elements of (type, material, nodes), numbered from `first`; more than eight nodes take two lines."""
    lines = [f"EBLOCK,19,SOLID,{len(rows)},{len(rows)}", "(19i9)"]
    for number, (type_, material, nodes) in enumerate(rows, start=first):
        head = [material, type_, 1, 1, 0, 0, 0, 0, len(nodes), 0, number]
        lines.append("".join(f"{n:9d}" for n in [*head, *nodes[:8]]))
        if len(nodes) > 8:
            lines.append("".join(f"{n:9d}" for n in nodes[8:]))
    return [*lines, "       -1"]


def cmblock(name: str, kind: str, items: Sequence[int]) -> list[str]:
    rows = ["".join(f"{n:10d}" for n in items[k : k + 8]) for k in range(0, len(items), 8)]
    return [f"CMBLOCK,{name:8},{kind:4},{len(items):8d}  ! users component definition", "(8i10)", *rows]


def written(path: Path, *parts: Sequence[str]) -> Path:
    path.write_text("\n".join(["/PREP7", "/TITLE,a test", *(line for part in parts for line in part), "FINISH", ""]))
    return path


def box_deck(path: Path, order: int = 1) -> tuple[Path, wfmesh.Mesh]:
    box = wfmesh.box((2, 1, 1), (3, 2, 2), order=order)
    cells = (box.cells["hex8"] if order == 1 else box.cells["hex27"][:, :20]) + 1
    held = np.unique(box.facet_sets["x_min"].node_set + 1).tolist()
    skin = next(iter(box.facet_sets["x_max"].corners.values())) + 1
    rows = [(1, 2 if n < 4 else 1, cell) for n, cell in enumerate(cells.tolist())]
    surface = [(2, 1, row) for row in skin.tolist()]
    parts = [
        ["ET,1,SOLID186" if order == 2 else "ET,        1,185", "ET,2,154"],
        nblock(box.points),
        eblock([*rows, *surface]),
        cmblock("HELD", "NODE", held),
        cmblock("FRONT", "ELEM", [1, -4]),
        cmblock("LOADED", "ELEM", [13, 14, -16]),
        STEEL,
    ]
    return written(path, *parts), box


@pytest.mark.parametrize("order", [1, 2])
def test_a_box_is_read_with_components_and_material(tmp_path: Path, order: int) -> None:
    path, box = box_deck(tmp_path / "box.cdb", order)
    mesh = wfmesh.read(path, length_unit="mm")
    ((kind, cells),) = mesh.cells.items()
    ((_, own),) = box.cells.items()
    assert kind == ("hex8" if order == 1 else "hex20")
    assert np.max(np.abs(mesh.points[cells] - 1e-3 * box.points[own[:, : cells.shape[1]]])) < 1e-16  # 13 digits
    assert mesh.volume() == pytest.approx(2e-9, rel=1e-12)
    for name, twin in (("HELD", "x_min"), ("LOADED", "x_max"), ("type_2", "x_max")):
        ((_, mine),), ((_, theirs),) = mesh.facets(name).corners.items(), box.facets(twin).corners.items()
        both = (np.sort(x.mean(axis=1), axis=0) for x in (1e3 * mesh.points[mine], box.points[theirs]))
        assert np.allclose(*both, rtol=0.0, atol=1e-12)
    assert mesh.cell_sets["FRONT"].tolist() == mesh.cell_sets["material_2"].tolist() == [0, 1, 2, 3]
    assert len(mesh.cell_sets["material_1"]) == 8
    steel = mesh.materials["material_1"]
    assert isinstance(steel, Material)
    assert (steel.youngs_modulus, steel.poisson_ratio) == (210e9, 0.3) and steel.density == pytest.approx(7850.0)


def test_solids_with_repeated_nodes_are_what_remains(tmp_path: Path) -> None:
    """As Ansys documents them: wedge K = L, O = P; tetrahedron K = L, M = N = O = P; with their mid-side nodes."""
    x = wfmesh.box((1, 1, 1), (1, 1, 1), order=1)
    nodes = (x.cells["hex8"][0] + 1).tolist()
    a, b, c, d, e, f, g, h = nodes
    # two wedges fill the box
    rows = [(1, 1, [a, b, c, c, e, f, g, g]), (1, 1, [a, c, d, d, e, g, h, h])]
    mesh = wfmesh.read(written(tmp_path / "w.cdb", ["ET,1,185"], nblock(x.points), eblock(rows)), length_unit="m")
    assert list(mesh.cells) == ["wedge6"] and mesh.volume() == pytest.approx(1.0, rel=1e-13)
    assert "2 hex8 cells with repeated nodes are read as wedge6" in mesh.notes
    row = [(1, 1, [a, b, c, c, e, e, e, e])]
    mesh = wfmesh.read(written(tmp_path / "t.cdb", ["ET,1,45"], nblock(x.points), eblock(row)), length_unit="m")
    assert list(mesh.cells) == ["tet4"] and mesh.volume() == pytest.approx(1.0 / 6.0, rel=1e-13)
    # SOLID186 as a tetrahedron: corners 1 2 3 5, middles after them
    pairs = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
    corner = x.points[np.array([a, b, c, e]) - 1]
    points = np.concatenate([corner, [0.5 * (corner[i] + corner[j]) for i, j in pairs]])
    i, j, k, m, ij, jk, ki, im, jm, km = range(1, 11)
    long = [i, j, k, k, m, m, m, m, ij, jk, k, ki, m, m, m, m, im, jm, km, km]
    deck = written(tmp_path / "q.cdb", ["ET,1,186"], nblock(points), eblock([(1, 1, long)]))
    mesh = wfmesh.read(deck, length_unit="m")
    assert list(mesh.cells) == ["tet10"] and mesh.volume() == pytest.approx(1.0 / 6.0, rel=1e-12)


def test_a_quadratic_solid_without_middles_is_linear(tmp_path: Path) -> None:
    box = wfmesh.box((1, 1, 1), (1, 1, 1), order=1)
    row = [(1, 1, [*(box.cells["hex8"][0] + 1).tolist(), *[0] * 12])]
    deck = written(tmp_path / "l.cdb", ["ET,1,186"], nblock(box.points), eblock(row))
    mesh = wfmesh.read(deck, length_unit="m")
    assert list(mesh.cells) == ["hex8"] and any("no mid-side nodes" in note for note in mesh.notes)


def test_blocks_of_workbench(tmp_path: Path) -> None:
    """Without SOLID an element has its number first, its type by TYPE; the block of nodes ends with -1."""
    box = wfmesh.box((1, 1, 1), (1, 1, 1), order=1)
    nodes = "".join(f"{n:9d}" for n in (box.cells["hex8"][0] + 1).tolist())
    head = ["et,3,185", "et,4,154", "nblock,3,,8", "(1i9,3e20.9e3)"]
    points = [f"{n:9d}" + "".join(f"{v:.9E}"[:-2].rjust(17) + f"0{f'{v:.9E}'[-2:]}" for v in x)
              for n, x in enumerate(box.points.tolist(), start=1)]  # fmt: skip
    lines = [
        *head,
        *points,
        "-1",
        "type,3 $ mat,1",
        "eblock,13,,,1",
        "(15i9)",
        f"{7:9d}{1:9d}{1:9d}{5:9d}{0:9d}{nodes}",
    ]
    skin = "".join(f"{n:9d}" for n in (box.facet_sets["z_max"].blocks["quad4"][0] + 1).tolist())
    lines += ["-1", "type,4", "eblock,9,,,1", "(15i9)", f"{8:9d}{1:9d}{1:9d}{6:9d}{0:9d}{skin}", "-1"]
    mesh = wfmesh.read(written(tmp_path / "ds.cdb", lines), length_unit="m")
    assert mesh.volume() == pytest.approx(1.0) and mesh.cell_sets["material_5"].tolist() == [0]
    assert np.array_equal(mesh.facets("type_4").node_set, box.facets("z_max").node_set)


def test_what_is_left_out_is_reported_by_count_and_name(tmp_path: Path) -> None:
    box = wfmesh.box((1, 1, 1), (1, 1, 1), order=1)
    cell = (box.cells["hex8"][0] + 1).tolist()
    rows = [(1, 1, cell), (2, 1, cell[:2]), (2, 1, cell[2:4])]
    more = [
        "TB,PLAS,1,1,3,",
        "RLBLOCK,1,1,1,7",
        "(2i8,6g16.9)",
        "(7g16.9)",
        "       1       1  1.00000000",
        "TB,BISO,1",
    ]
    sets = [*cmblock("BOLT", "ELEM", [1, 2]), *cmblock("POINT", "NODE", [1])]
    mesh = wfmesh.read(
        written(
            tmp_path / "b.cdb", ["ET,1,185", "ET,2,14"], nblock(box.points), eblock(rows), more, sets, ["MP,EX,9,1"]
        ),
        length_unit="mm",
    )
    notes = "\n".join(mesh.notes)
    assert "elements that are not used: type 14 (2)" in notes
    assert "commands that are not used: TB (2), RLBLOCK (1)" in notes
    assert "component 'BOLT': 1 of 2 elements are not read" in notes
    assert "node sets without a complete outer facet are not used: 'POINT' (1 nodes)" in notes
    assert "material 9 is not used" in notes


def box_lines(tmp_path: Path) -> list[str]:
    return box_deck(tmp_path / "sound.cdb")[0].read_text().splitlines()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t.replace("SOLID,36,36", "SOLID,37,37"), "line 5: NBLOCK declares 37 nodes, 36 follow"),
        (lambda t: t.replace("(3i9,6e21.13e3)", ""), "line 6: NBLOCK: a format such as"),
        (lambda t: t.replace("N,R5.3,LOC,       -1,\n", "N,40,1.0,2.0\n"), "line 43: N is not read"),
        (lambda t: t.replace("ET,        1,185\n", ""), "element 1 is of type 1, which no ET defines"),
        (lambda t: t.replace("ET,2,154", "ET,2,THICK"), "line 4: 'ET,2,THICK' names no element type"),
        (lambda t: t.replace("        1        0        0", "        2        0        0", 1), "node 2 is given twice"),
        (lambda t: t.replace("       36        0        0", "       99        0        0"), "node 36 of element"),
        (lambda t: t.replace("NODE,       9", "NODE,      10"), "do not hold 10 numbers"),
        (lambda t: t.replace("MP,DENS,1,7.85E-09", "MP,DENS,1,7_85"), "'7_85' is no number"),
        (lambda t: t[: t.rindex("       -1\n")], "the end of EBLOCK is missing"),
        (lambda t: t.replace("EBLOCK,19,SOLID", "NOTHING,19,SOLID"), "'(19i9)' is no command"),
        (lambda t: t.replace("E-001", "X-001", 1), "is no number"),
        (lambda t: t.replace("        14       -16", "        1a       -16"), "column 2 is no integer"),
    ],
)  # fmt: skip
def test_a_wrong_file_is_refused_with_the_line(tmp_path: Path, change, message: str) -> None:
    text = "\n".join(box_lines(tmp_path)) + "\n"
    path = tmp_path / "wrong.cdb"
    path.write_text(change(text))
    assert path.read_text() != text
    with pytest.raises(InputError) as error:
        wfmesh.read(path, length_unit="mm")
    assert message in str(error.value) and "wrong.cdb" in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(
    "text", ["1.5D6", " .5E-3", "-2.", "1.0-101", "+1.25e+2", "123456789.123456789E+001", "1.0000000000000E-300"]
)
def test_reals_are_those_of_fortran(tmp_path: Path, text: str) -> None:
    (tmp_path / "t").write_text(f"{'1.0E+0':>30}\n{text:>30}\n")
    _, found = Lines(tmp_path / "t", "file").table(np.arange(2), [], [30])
    plain = "1.0E-101" if text == "1.0-101" else text.replace("D", "E")
    assert found[1, 0] == float(plain)


def test_numbers_in_columns_are_exact(tmp_path: Path) -> None:
    """Fourteen digits, as CDWRITE writes them, are the numbers that Python reads, to the bit."""
    rng = np.random.default_rng(1)
    values = rng.standard_normal(5000) * 10.0 ** rng.integers(-25, 25, 5000)
    words = [real(v) for v in values]
    (tmp_path / "t").write_text("".join(f"{n - 2500:9d}{w}\n" for n, w in enumerate(words)))
    whole, found = Lines(tmp_path / "t", "file").table(np.arange(5000), [9], [21])
    assert np.array_equal(whole[:, 0], np.arange(5000) - 2500)
    assert np.array_equal(found[:, 0], np.array([float(w) for w in words]))


@pytest.mark.parametrize("name", ["HexBeam", "TetBeam", "sector", "academic_rotor"])
def test_files_of_others_agree_with_mapdl_archive(name: str) -> None:
    """Counts, volume and components of the examples that mapdl-archive brings."""
    archive = pytest.importorskip("mapdl_archive")
    path = Path(archive.__file__).parent / "examples" / f"{name}.cdb"
    mesh, theirs = wfmesh.read(path, length_unit="m"), archive.Archive(str(path))
    grid = theirs.grid
    assert sum(map(len, mesh.cells.values())) == grid.n_cells
    assert mesh.volume() == pytest.approx(grid.compute_cell_sizes()["Volume"].sum(), rel=1e-6)
    labels = theirs.enum.tolist()
    for key, members in theirs.element_components.items():
        assert [labels[i] for i in mesh.cell_sets[key]] == sorted(members.tolist())
    numbers = np.isin(theirs.nnum, next(iter(theirs.node_components.values()), []))
    if numbers.any():
        key = next(iter(theirs.node_components))
        own = mesh.points[mesh.facets(key).node_set]
        apart = np.linalg.norm(own[:, None] - theirs.nodes[numbers, :3][None], axis=2).min(axis=1)
        assert apart.max() < 1e-12  # it rounds reals
