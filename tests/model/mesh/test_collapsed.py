"""Cells with repeated nodes, and cells whose det J is not positive at a node though it is where they are integrated."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTet

from warpffrf.model import mesh as wfmesh
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import Mesh
from warpffrf.model.mesh.checks import inside_points
from warpffrf.model.mesh.elements import cell_kind
from warpffrf.model.mesh.files.raw_mesh import left_over
from warpffrf.offline.fe import STIFFNESS_DEGREE


def collapsed(kind: str, pairs: list[tuple[int, int]]) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of the reference cell with the second corner of each pair put on the first one, middle nodes with them."""
    cell = cell_kind(kind)
    corners = np.arange(cell.corner_count)
    for a, b in pairs:
        corners[corners == corners[b]] = corners[a]
    linear = cell_kind({"hex20": "hex8", "wedge15": "wedge6"}.get(kind, kind))
    x = linear.shape(cell.nodes)[0] @ linear.nodes[corners]
    nodes = np.array([next(i for i in range(len(x)) if np.allclose(x[i], p)) for p in x])
    return x, nodes


CASES = [
    ("hex8", [(2, 3), (6, 7)], "wedge6"),
    ("hex8", [(0, 1), (4, 5)], "wedge6"),
    ("hex8", [(0, 4), (1, 5)], "wedge6"),
    ("hex8", [(2, 3), (4, 5), (4, 6), (4, 7)], "tet4"),
    ("hex20", [(2, 3), (6, 7)], "wedge15"),
    ("hex20", [(2, 3), (4, 5), (4, 6), (4, 7)], "tet10"),
    ("wedge6", [(3, 4), (3, 5)], "tet4"),
    ("wedge15", [(3, 4), (3, 5)], "tet10"),
]


@pytest.mark.parametrize(("kind", "pairs", "expected"), CASES)
def test_what_is_left_has_the_volume_of_the_collapsed_cell(
    kind: str, pairs: list[tuple[int, int]], expected: str
) -> None:
    """The volume by quadrature of the collapsed cell itself, whose det J is positive inside."""
    x, nodes = collapsed(kind, pairs)
    found = left_over(kind, nodes)
    assert found is not None and found[0] == expected
    cell = cell_kind(kind)
    exact = float(cell.jacobians(x[nodes][None], cell.quadrature_points)[0] @ cell.quadrature_weights)
    used, row = np.unique(found[1], return_inverse=True)
    mesh = Mesh(x[used], {expected: row.reshape(1, -1)}).check()
    assert mesh.volume() == pytest.approx(exact, rel=1e-13) and exact > 0.1


def deck(path: Path, nodes: list[int], more: str = "") -> Path:
    x = cell_kind("hex8").nodes
    lines = "".join(f"{i},{a},{b},{c}\n" for i, (a, b, c) in enumerate(x.tolist(), start=1))
    path.write_text(f"*NODE\n{lines}*ELEMENT,TYPE=C3D8,ELSET=E\n7,{','.join(map(str, nodes))}\n{more}")
    return path


def test_faces_of_a_collapsed_hexahedron(tmp_path: Path) -> None:
    """S2 of the deck is the triangle above; S5, whose corners 3 and 4 are one, is gone."""
    file = deck(tmp_path / "m.inp", [1, 2, 3, 3, 5, 6, 7, 7], "*SURFACE,NAME=TOP\nE,S2\n*SURFACE,NAME=SIDE\nE,S3\n")
    mesh = wfmesh.read(file, length_unit="m")
    assert set(mesh.cells) == {"wedge6"} and mesh.sets == {"TOP": 1, "SIDE": 1}
    assert np.all(mesh.points[mesh.facets("TOP").node_set][:, 2] == 1.0)
    assert np.all(mesh.points[mesh.facets("SIDE").node_set][:, 1] == -1.0)
    assert mesh.notes[0] == "1 hex8 cells with repeated nodes are read as wedges or tetrahedra"
    with pytest.raises(InputError, match="surface 'GONE': the cells of 'E' have no face S5"):
        wfmesh.read(deck(file, [1, 2, 3, 3, 5, 6, 7, 7], "*SURFACE,NAME=GONE\nE,S5\n"), length_unit="m")


def test_a_pyramid_is_refused_by_its_number(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="element 7 .hex8. has repeated nodes"):
        wfmesh.read(deck(tmp_path / "m.inp", [1, 2, 3, 4, 5, 5, 5, 5]), length_unit="m")
    with pytest.raises(InputError, match="1 hex8 cell.s. have repeated nodes, the first is number 0"):
        Mesh(cell_kind("hex8").nodes, {"hex8": np.array([[0, 1, 2, 3, 4, 4, 4, 4]])}).check()


def test_points_of_tetrahedra_are_those_of_their_stiffness() -> None:
    points = get_quadrature(RefTet, STIFFNESS_DEGREE["tet10"])[0].T
    own = inside_points("tet10")
    assert len(own) == len(points) == 11
    for x in points:
        assert np.abs(own - x).max(axis=1).min() < 1e-12


def test_the_patch_of_macneal_and_harder_is_read(tmp_path: Path) -> None:
    """A hexahedron between the inner cell and a face of the cube: det J is -0.0016 at a corner."""
    places = "0.249,0.342,0.192 0.826,0.288,0.288 0.677,0.305,0.683 0.320,0.186,0.643 0,0,0 1,0,0 1,0,1 0,0,1".split()
    nodes = "".join(f"{i},{x}\n" for i, x in enumerate(places, start=1))
    (tmp_path / "m.inp").write_text(f"*NODE\n{nodes}*ELEMENT,TYPE=C3D8\n4,1,2,3,4,5,6,7,8\n")
    mesh = wfmesh.read(tmp_path / "m.inp", length_unit="m")
    assert mesh.cell_count == 1 and "det J <= 0 at a node, the first is element 4" in mesh.notes[-1]


def test_a_curved_tetrahedron_is_read_and_an_inverted_one_is_not(tmp_path: Path) -> None:
    """One middle node moved along its edge beyond a quarter: det J is negative at that end alone."""
    x = cell_kind("tet10").nodes.copy()
    x[4] = [0.2, 0.0, 0.0]
    mesh = Mesh(x, {"tet10": np.arange(10)[None]})
    cell = cell_kind("tet10")
    assert cell.jacobians(x[None], cell.nodes).min() < 0.0 < cell.jacobians(x[None], inside_points("tet10")).min()
    mesh.check()
    with pytest.raises(InputError, match="1 inverted tet10"):
        Mesh(x * [1.0, 1.0, -1.0], {"tet10": np.arange(10)[None]}).check()
