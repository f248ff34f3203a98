"""Universal files: nodes, elements, groups and systems, faults; files of Gmsh compared with its .msh, and pyuff."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from warpffrf.model import mesh as wfmesh
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh

DATA = Path(__file__).parents[2] / "data"


def dataset(number: int, lines: Sequence[str]) -> list[str]:
    return ["    -1", f"{number:6d}", *lines, "    -1"]


def integers(*values: int) -> str:
    return "".join(f"{v:10d}" for v in values)


def nodes_2411(points: np.ndarray) -> list[str]:
    rows = [(integers(n, 1, 1, 11), "".join(f"{v:25.16E}" for v in x)) for n, x in enumerate(points.tolist(), start=1)]
    return dataset(2411, [line.replace("E", "D") for row in rows for line in row])


def elements_2412(rows: Sequence[tuple[int, int, int, Sequence[int]]]) -> list[str]:
    """Elements of (number, kind, property, nodes)."""
    lines = []
    for number, kind, of, nodes in rows:
        lines.append(integers(number, kind, of, 1, 7, len(nodes)))
        if kind == 21:
            lines.append(integers(0, 1, 1))
        lines += [integers(*nodes[k : k + 8]) for k in range(0, len(nodes), 8)]
    return dataset(2412, lines)


def group(number: int, name: str, code: int, items: Sequence[int]) -> list[str]:
    rows = [integers(*(v for n in items[k : k + 2] for v in (code, n, 0, 0))) for k in range(0, len(items), 2)]
    return [integers(number, 0, 0, 0, 0, 0, 0, len(items)), name, *rows]


def box_lines() -> tuple[list[str], Mesh]:
    box = wfmesh.box((2, 1, 1), (3, 2, 2), order=1)
    rows = [(n, 115, 1 + (n > 4), cell) for n, cell in enumerate((box.cells["hex8"] + 1).tolist(), start=1)]
    skin = box.facet_sets["x_max"].blocks["quad4"] + 1
    rows += [(n, 94, 3, facet) for n, facet in enumerate(skin.tolist(), start=13)]
    groups = group(1, "held", 7, (box.facet_sets["x_min"].node_set + 1).tolist())
    groups += group(2, "loaded", 8, [13, 14, 15, 16]) + group(3, "first half", 8, [1, 2, 3])
    units = [
        f"{5:10d}{'mm (newton)':20}{2:10d}",
        *["".join(f"{v:25.17E}" for v in x) for x in ((1e3, 1, 1), (273.15,))],
    ]
    lines = dataset(164, units) + nodes_2411(box.points) + elements_2412(rows) + dataset(2467, groups)
    return lines, box


def written(path: Path, lines: Sequence[str]) -> Path:
    path.write_text("\n".join([*lines, ""]))
    return path


def test_a_box_is_read_with_its_groups(tmp_path: Path) -> None:
    lines, box = box_lines()
    mesh = wfmesh.read(written(tmp_path / "box.unv", lines), length_unit="mm")
    assert np.array_equal(mesh.points, 1e-3 * box.points) and np.array_equal(mesh.cells["hex8"], box.cells["hex8"])
    for name, twin in (("held", "x_min"), ("loaded", "x_max"), ("property_3", "x_max")):
        assert np.array_equal(mesh.facets(name).node_set, box.facets(twin).node_set)
    assert mesh.cell_sets["first half"].tolist() == [0, 1, 2] and mesh.cell_sets["property_1"].tolist() == [0, 1, 2, 3]
    assert "the file states lengths in mm (dataset 164)" in mesh.notes
    assert mesh.points.shape == (36, 3) and written(tmp_path / "box.uff", lines).exists()
    assert wfmesh.read(tmp_path / "box.uff", length_unit="mm").content_hash() == mesh.content_hash()


@pytest.mark.parametrize("kind", ["hex20", "wedge15", "tet10"])
def test_files_of_gmsh_are_as_its_own(kind: str) -> None:
    """The same mesh as .unv and as .msh: points, cells up to their order, volume and sets."""
    mesh, own = (wfmesh.read(DATA / f"gmsh_{kind}{ending}", length_unit="mm") for ending in (".unv", ".msh"))
    assert list(mesh.cells) == list(own.cells) == [kind]
    assert mesh.volume() == pytest.approx(own.volume(), rel=1e-12)
    for one, other in ((mesh.points, own.points), (mesh.points[mesh.cells[kind]], own.points[own.cells[kind]])):
        assert np.allclose(np.sort(one.ravel()), np.sort(other.ravel()), atol=1e-15)
    for name in ("inner", "outer"):
        of, theirs = (m.points[m.cells[kind][m.cell_sets[name]]].mean(axis=1) for m in (mesh, own))
        assert len(of) and np.allclose(np.sort(of, axis=0), np.sort(theirs, axis=0), atol=1e-15)
    of, theirs = (m.facets("rim").centers(m.points) for m in (mesh, own))
    assert len(of) == len(theirs) and np.allclose(np.sort(of, axis=0), np.sort(theirs, axis=0), atol=1e-15)


def test_nodes_of_dataset_15_lie_in_their_system(tmp_path: Path) -> None:
    """A system whose first axis is y and third one z, and one of 2420: the box is rotated and moved."""
    box = wfmesh.box((1, 1, 1), (1, 1, 1), order=1)
    old = [
        integers(1, 0, 0, 1, 1),
        "CS",
        "".join(f"{v:13.5E}" for v in (1, 2, 3, 1, 3, 3)),
        "".join(f"{v:13.5E}" for v in (1, 2, 9)),
    ]
    new = [integers(1), "part", integers(2, 0, 1), "CS2", *["".join(f"{v:25.16E}" for v in row)
           for row in ((0, 1, 0), (-1, 0, 0), (0, 0, 1), (1, 2, 3))]]  # fmt: skip
    cell = [(1, 115, 1, (box.cells["hex8"][0] + 1).tolist())]
    R, origin = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]]), np.array([1.0, 2.0, 3.0])
    for number, systems in ((1, dataset(18, old)), (2, dataset(2420, new))):
        nodes = dataset(15, [integers(n, number, 0, 1) + "".join(f"{v:13.5E}" for v in x)
                             for n, x in enumerate(box.points.tolist(), start=1)])  # fmt: skip
        mesh = wfmesh.read(written(tmp_path / "s.unv", systems + nodes + elements_2412(cell)), length_unit="m")
        assert np.allclose(mesh.points, box.points @ R + origin, atol=1e-14)
        with pytest.raises(InputError, match=f"coordinate system {number}, which no dataset"):
            wfmesh.read(written(tmp_path / "n.unv", nodes + elements_2412(cell)), length_unit="m")


def test_nodes_of_elements_that_are_missing_are_counted(tmp_path: Path) -> None:
    """A file of two datasets of elements, of which one was removed."""
    box = wfmesh.box((2, 1, 1), (3, 2, 2), order=1)
    cells = box.cells["hex8"]
    near = cells[box.points[cells][:, :, 0].max(axis=1) < 0.4]
    rows = [(n, 115, 1, cell) for n, cell in enumerate((near + 1).tolist(), start=1)]
    mesh = wfmesh.read(written(tmp_path / "half.unv", nodes_2411(box.points) + elements_2412(rows)), length_unit="m")
    missing = len(box.points) - len(np.unique(near))
    assert missing > 0 and f"{missing} of {len(box.points)} nodes belong to no element that is read" in mesh.notes
    whole = wfmesh.read(written(tmp_path / "box.unv", box_lines()[0]), length_unit="mm")
    assert not any("belong to no element" in note for note in whole.notes)


def test_what_is_left_out_is_reported_by_count_and_name(tmp_path: Path) -> None:
    lines, _ = box_lines()
    lines += elements_2412([(50, 21, 1, [1, 2]), (51, 21, 1, [2, 3])]) + dataset(2414, ["results"])
    lines += dataset(2477, [*group(7, "bolt", 8, [1, 50]), *group(8, "curve", 3, [1, 2]), *group(9, "tip", 7, [1, 99])])
    notes = "\n".join(wfmesh.read(written(tmp_path / "b.unv", lines), length_unit="mm").notes)
    assert "datasets and elements that are not used: elements of kind 21 (2), 2414 (1)" in notes
    assert "group 'bolt': 1 of 2 elements are not read" in notes
    assert "group 'curve': 2 entities that are neither nodes nor elements are not used" in notes
    assert "group 'tip': 1 of 2 nodes do not exist" in notes and "'tip' (1 nodes)" in notes


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (f"\n{integers(1, 1, 1, 11)}\n", "\n", "line 79: dataset 2411: a node has two lines"),
        (integers(13, 94, 3, 1, 7, 4), integers(13, 94, 3, 1, 7, 3), "element 13 of kind 94 needs 4 nodes"),
        (integers(13, 94, 3, 1, 7, 4), integers(12, 94, 3, 1, 7, 4), "element 12 is given twice"),
        (integers(2, 1, 1, 11), integers(88, 1, 1, 11), "node 2 of element 1 is in no dataset of nodes"),
        (integers(2, 0, 0, 0, 0, 0, 0, 4), integers(2, 0, 0, 0, 0, 0, 0, 40), "a name or entities are missing"),
        ("D+00", "X+00", "is no number"),
        ("  2467\n", "  word\n", "'word' is no number of a dataset"),
        ("    -1\n  2467", "\n  2467", "datasets begin and end with one"),
        ("  2411\n", "  2499\n", "there are no nodes (dataset 2411 or 15)"),
    ],
)
def test_a_wrong_file_is_refused_with_the_line(tmp_path: Path, old: str, new: str, message: str) -> None:
    text = "\n".join([*box_lines()[0], ""])
    assert old in text
    (tmp_path / "wrong.unv").write_text(text.replace(old, new, 1))
    with pytest.raises(InputError) as error:
        wfmesh.read(tmp_path / "wrong.unv", length_unit="mm")
    assert message in str(error.value) and "wrong.unv" in str(error.value) and "\n" not in str(error.value)


def test_pyuff_finds_the_same() -> None:
    """Nodes, elements and groups; pyuff reads no elements of more than eight nodes."""
    pyuff = pytest.importorskip("pyuff")
    path = DATA / "box.unv"
    sets = {s["type"]: s for s in pyuff.UFF(str(path)).read_sets()}
    mesh = wfmesh.read(path, length_unit="m")
    assert np.array_equal(mesh.points, np.stack([sets[2411][axis] for axis in "xyz"], axis=1))
    cells = [e["nodes_nums"] for rows in sets[2412].values() if isinstance(rows, list)
             for e in rows if e["fe_descriptor"] == 115]  # fmt: skip
    assert np.array_equal(np.array(cells, dtype=int) - 1, mesh.cells["hex8"])
    found = {g["group_name"].strip(): g["entity_tag"] for g in sets[2467]["groups"]}
    assert [int(n) - 1 for n in found["first half"]] == mesh.cell_sets["first half"].tolist()
    assert [int(n) - 1 for n in found["held"]] == mesh.facets("held").node_set.tolist()
