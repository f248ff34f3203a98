"""Solid elements in decks: node order, formulations, and faces S1 to S6, checked by geometry.

Corners and edges are the tables of the Abaqus and CalculiX manuals, written here again.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.elements import facet_kind
from warpffrf.model.mesh.files.inp import read_inp
from warpffrf.model.mesh.files.inp.model import kind_of

HEX = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]
WEDGE = [(0, 0, -1), (1, 0, -1), (0, 1, -1), (0, 0, 1), (1, 0, 1), (0, 1, 1)]
TET = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
HEX_EDGES = "1-2 2-3 3-4 4-1 5-6 6-7 7-8 8-5 1-5 2-6 3-7 4-8"
WEDGE_EDGES = "1-2 2-3 3-1 4-5 5-6 6-4 1-4 2-5 3-6"
TET_EDGES = "1-2 2-3 3-1 1-4 2-4 3-4"
CELLS = {
    "C3D8": (HEX, ""),
    "C3D20": (HEX, HEX_EDGES),
    "C3D6": (WEDGE, ""),
    "C3D15": (WEDGE, WEDGE_EDGES),
    "C3D4": (TET, ""),
    "C3D10": (TET, TET_EDGES),
}
# planes n.x = d of the faces S1, S2, ... of the reference cells, n outwards
PLANES = {
    8: [((0, 0, -1), 1), ((0, 0, 1), 1), ((0, -1, 0), 1), ((1, 0, 0), 1), ((0, 1, 0), 1), ((-1, 0, 0), 1)],
    6: [((0, 0, -1), 1), ((0, 0, 1), 1), ((0, -1, 0), 0), ((1, 1, 0), 1), ((-1, 0, 0), 0)],
    4: [((0, 0, -1), 0), ((0, -1, 0), 0), ((1, 1, 1), 1), ((-1, 0, 0), 0)],
}
VOLUME = {8: 8.0, 6: 1.0, 4: 1.0 / 6.0}


def nodes_of(element_type: str) -> np.ndarray:
    """Nodes in the order of the manual: corners, then the middles of the edges."""
    corners, edges = CELLS[element_type]
    x = np.array(corners, float)
    middles = [0.5 * (x[int(e[0]) - 1] + x[int(e[2]) - 1]) for e in edges.split()]
    return np.concatenate([x, np.array(middles).reshape(-1, 3)])


def deck(path: Path, element_type: str, points: np.ndarray) -> Path:
    """One element of a type with a surface for each of its faces."""
    count = len(points)
    lines = ["*NODE", *(f"{i + 5}, {x!r}, {y!r}, {z!r}" for i, (x, y, z) in enumerate(points.tolist()))]
    numbers = ["7", *(str(i + 5) for i in range(count))]
    rows = [", ".join(numbers[i : i + 16]) for i in range(0, len(numbers), 16)]
    lines += [f"*ELEMENT, TYPE={element_type}", ",\n".join(rows)]
    for s in range(1, len(PLANES[len(CELLS[element_type.rstrip("RHIMST")][0])]) + 1):
        lines += [f"*SURFACE, NAME=S{s}", f"7, S{s}"]
    path.write_text("\n".join(lines) + "\n")
    return path


def flux(mesh: Mesh, name: str) -> float:
    """The integral of x.n / 3 over a facet set, by a Gauss rule exact for quadratic facets."""
    total = 0.0
    x, w = np.polynomial.legendre.leggauss(4)
    for kind, nodes in mesh.facets(name).blocks.items():
        if kind.startswith("quad"):
            xi = np.array([(a, b) for a in x for b in x])
            weight = np.array([wa * wb for wa in w for wb in w])
        else:  # the unit triangle by Duffy's map
            a, b = 0.5 * (x + 1), 0.5 * (x + 1)
            xi = np.array([(p, (1 - p) * q) for p in a for q in b])
            weight = np.array([0.25 * wa * wb * (1 - p) for p, wa in zip(a, w, strict=True) for wb in w])
        N, dN = facet_kind(kind).shape(xi)
        X = mesh.points[nodes]
        position = np.einsum("qa,maj->mqj", N, X)
        t1, t2 = (np.einsum("qa,maj->mqj", dN[:, :, d], X) for d in (0, 1))
        total += float(np.einsum("q,mqj,mqj->", weight, position, np.cross(t1, t2))) / 3.0
    return total


@pytest.mark.parametrize("element_type", CELLS)
def test_faces_lie_where_the_manual_says_and_look_outwards(tmp_path: Path, element_type: str) -> None:
    points = nodes_of(element_type)
    mesh = read_inp(deck(tmp_path / "one.inp", element_type, points), length_unit="m")
    corners = len(CELLS[element_type][0])
    np.testing.assert_array_equal(mesh.points, points)
    assert len(mesh.sets) == len(PLANES[corners])
    for s, (normal, distance) in enumerate(PLANES[corners], start=1):
        ((kind, nodes),) = mesh.facets(f"S{s}").blocks.items()
        x = mesh.points[nodes[0]]
        np.testing.assert_allclose(x @ normal, distance, atol=1e-15)
        on_plane = np.sum(np.isclose(points @ normal, distance))
        assert len(set(nodes[0].tolist())) == on_plane  # all nodes of the cell that lie on the face
        assert np.cross(x[1] - x[0], x[2] - x[0]) @ normal > 0
        middles = x[facet_kind(kind).corner_count :]
        for i, middle in enumerate(middles):  # in the order of the edges of the facet
            after = (i + 1) % facet_kind(kind).corner_count
            np.testing.assert_allclose(middle, 0.5 * (x[i] + x[after]))


@pytest.mark.parametrize("element_type", CELLS)
def test_faces_of_a_curved_cell_enclose_its_volume(tmp_path: Path, element_type: str) -> None:
    reference = nodes_of(element_type)
    affine = np.array([[1.1, 0.2, -0.1], [0.05, 0.9, 0.15], [0.1, -0.2, 1.2]])
    points = reference @ affine.T + 0.03 * np.random.default_rng(3).standard_normal(reference.shape) + 5.0
    mesh = read_inp(deck(tmp_path / "one.inp", element_type, points), length_unit="m")
    total = sum(flux(mesh, name) for name in mesh.sets)
    assert total == pytest.approx(mesh.volume(), rel=1e-11)
    straight = read_inp(deck(tmp_path / "two.inp", element_type, reference @ affine.T), length_unit="m")
    assert straight.volume() == pytest.approx(VOLUME[len(CELLS[element_type][0])] * np.linalg.det(affine), rel=1e-12)


@pytest.mark.parametrize(
    ("element_type", "kind", "said"),
    [
        ("C3D8R", "hex8", "integrated fully"),
        ("C3D8I", "hex8", "incompatible modes"),
        ("C3D8H", "hex8", "hybrid where the material"),
        ("C3D20RH", "hex20", "integrated fully and are hybrid where the material requires it"),
        ("C3D10M", "tet10", "not modified"),
        ("C3D10MH", "tet10", "not modified here and are hybrid where"),
        ("C3D10HS", "tet10", "stress points"),
        ("C3D15H", "wedge15", "hybrid where the material"),
        ("C3D4H", "tet4", "hybrid where the material"),
    ],
)
def test_formulations_become_the_plain_cell_and_are_reported(
    tmp_path: Path, element_type: str, kind: str, said: str
) -> None:
    path = deck(tmp_path / "one.inp", element_type, nodes_of(element_type.rstrip("RHIMS")))
    mesh = read_inp(path, length_unit="m")
    assert list(mesh.cells) == [kind]
    note = next(note for note in mesh.notes if element_type in note)
    assert note.startswith(f"1 {element_type} cells are") or note.startswith(f"1 {element_type} cells have")
    assert note.endswith(f", as {kind}") and said in note


def test_plain_cells_need_no_note(tmp_path: Path) -> None:
    assert read_inp(deck(tmp_path / "one.inp", "C3D20", nodes_of("C3D20")), length_unit="m").notes == ()


@pytest.mark.parametrize("element_type", ["C3D27", "C3D5", "C3D13", "DC3D8", "AC3D20", "SC8R", "C3D8P", "C3D8X"])
def test_other_solid_elements_are_refused(tmp_path: Path, element_type: str) -> None:
    path = tmp_path / "other.inp"
    path.write_text(f"*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE={element_type}\n1, 1, 1, 1, 1\n")
    with pytest.raises(InputError, match=f"other.inp, line 3: solid elements of type {element_type} are not supported"):
        read_inp(path, length_unit="m")


@pytest.mark.parametrize("element_type", ["S4R", "B31", "SPRINGA", "MASS", "CPE4", "CAX8R", "T3D2", "CONN3D2", "R3D4"])
def test_shells_beams_and_springs_are_no_cells(element_type: str) -> None:
    assert kind_of(element_type) is None
