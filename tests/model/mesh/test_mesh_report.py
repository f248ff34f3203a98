"""Mesh reports: mass and inertia against closed forms, quality of known cells, warnings of unit slips."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

from warpffrf.model import mesh as wfmesh
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh.elements import CELL_KINDS, cell_kind
from warpffrf.model.mesh.facets import outer_faces

STEEL = Material(210e9, 0.3, 7850.0)
ALU = Material(70e9, 0.33, 2700.0)


def one_cell(kind: str, shape: np.ndarray | None = None) -> wfmesh.Mesh:
    """The reference cell, mapped by the affine `shape` (3, 3)."""
    nodes = cell_kind(kind).nodes
    points = nodes if shape is None else nodes @ shape.T
    return wfmesh.Mesh(points, {kind: np.arange(len(nodes))[None]}, name=kind)


def moments(kind: str) -> tuple[float, np.ndarray, np.ndarray]:
    """Volume, first and second moments of the reference cell by their closed forms."""
    if kind.startswith("hex"):
        return 8.0, np.zeros(3), np.eye(3) * 8.0 / 3.0
    if kind.startswith("tet"):  # int x^2 = 2/5!, int x y = 1/5!
        return 1.0 / 6.0, np.full(3, 1.0 / 24.0), (np.eye(3) + np.ones((3, 3))) / 120.0
    second = np.zeros((3, 3))  # triangle times [-1, 1]: int x^2 = 2 * 2/4!, int x y = 2 * 1/4!, int z^2 = 1/2 * 2/3
    second[:2, :2] = (np.eye(2) + np.ones((2, 2))) * 2.0 / 24.0
    second[2, 2] = 1.0 / 3.0
    return 1.0, np.array([1.0 / 3.0, 1.0 / 3.0, 0.0]), second


@pytest.mark.parametrize("kind", CELL_KINDS)
def test_mass_center_and_inertia_of_every_kind(kind: str) -> None:
    A = np.array([[0.5, 0.1, 0.0], [-0.1, 0.4, 0.2], [0.05, 0.0, 0.6]])
    shift = np.array([3.0, -2.0, 1.0])
    mesh = one_cell(kind, A)
    mesh = replace(mesh, points=mesh.points + shift)
    V, first, second = moments(kind)
    det = np.linalg.det(A)
    mass = STEEL.density * V * det
    center = A @ first / V
    about = STEEL.density * det * (A @ second @ A.T) - mass * np.outer(center, center)
    report = mesh.report(STEEL)
    assert report.mass == pytest.approx(mass, rel=1e-12)
    assert report.center is not None and report.inertia is not None
    np.testing.assert_allclose(report.center, center + shift, rtol=1e-12)
    np.testing.assert_allclose(report.inertia, np.trace(about) * np.eye(3) - about, atol=1e-11 * mass)
    assert report.volume == pytest.approx(V * det, rel=1e-12) and mesh.report().mass is None


def test_hollow_cylinder_converges_to_its_closed_form() -> None:
    R, r, w = 0.05, 0.015, 0.02
    mesh = wfmesh.roller(R, r, w, sectors=48, layers=2, axial=1)
    report = mesh.report(STEEL)
    mass = STEEL.density * np.pi * (R**2 - r**2) * w
    assert report.mass == pytest.approx(mass, rel=1e-5) and report.inertia is not None
    J = mass * np.array([(3 * (R**2 + r**2) + w**2) / 12, (R**2 + r**2) / 2, (3 * (R**2 + r**2) + w**2) / 12])
    np.testing.assert_allclose(report.inertia, np.diag(J), rtol=1e-5, atol=1e-9 * J.max())


def test_materials_by_cell_set_and_of_the_file() -> None:
    mesh = wfmesh.roller(0.05, 0.015, 0.02, sectors=12, layers=2, axial=2)
    mesh = replace(mesh, cell_sets={"a": np.arange(0, 20), "b": np.arange(20, mesh.cell_count)})
    both = mesh.report({"a": STEEL, "b": ALU}).mass
    part = mesh.report(STEEL).mass, mesh.report(ALU).mass
    share = 20 / mesh.cell_count  # whole sectors of 4 cells
    assert both is not None and part[0] is not None and part[1] is not None
    assert both == pytest.approx(share * part[0] + (1 - share) * part[1], rel=1e-12)
    assert replace(mesh, materials={"a": STEEL, "b": ALU}).report().mass == pytest.approx(both, rel=1e-15)
    assert replace(mesh, materials={"a": STEEL}).report().mass is None  # the file's materials leave cells out
    with pytest.raises(InputError, match="28 of 48 cells"):
        mesh.report({"a": STEEL})
    with pytest.raises(InputError, match="cell set 'c'.*'a', 'b'"):
        mesh.report({"c": STEEL})


def test_body_of_matrices() -> None:
    """Point masses with a consistent coupling between two of them."""
    points = np.array([[0.1, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.3], [0.2, 0.2, 0.2]])
    lumped = np.array([[2.0, 0.5, 0, 0], [0.5, 1.0, 0, 0], [0, 0, 3.0, 0], [0, 0, 0, 1.0]])
    M = sp.csr_matrix(np.kron(lumped, np.eye(3)))
    mesh = wfmesh.Mesh(points, {}, matrices=wfmesh.Matrices(sp.identity(12, format="csr"), M))
    report = mesh.report()
    m = lumped.sum()
    c = lumped.sum(axis=1) @ points / m
    d = points - c
    second = d.T @ lumped @ d
    assert report.mass == pytest.approx(m) and report.cells == {} and "matrices" in str(report)
    assert report.center is not None and report.inertia is not None
    np.testing.assert_allclose(report.center, c, rtol=1e-13)
    np.testing.assert_allclose(report.inertia, np.trace(second) * np.eye(3) - second, rtol=1e-12, atol=1e-15)
    heavy = replace(mesh, matrices=wfmesh.Matrices(M, M * 1e9))
    assert any("are inconsistent" in w for w in heavy.report().warnings)


def test_quality_of_known_cells() -> None:
    triangle = np.array([[1.0, 0.5, 0.0], [0.0, np.sqrt(0.75), 0.0], [0.0, 0.0, 1.0]])
    corner = np.array([[1.0, 0.5, 0.5], [0.0, np.sqrt(0.75), np.sqrt(1 / 12)], [0.0, 0.0, np.sqrt(2 / 3)]])
    for kind in CELL_KINDS:
        regular = {"hex": np.eye(3), "wedge": triangle, "tet": corner}[cell_kind(kind).domain]
        if kind.startswith("wedge"):
            regular = regular @ np.diag([1.0, 1.0, 0.5])
        report = one_cell(kind, regular).report()
        assert report.scaled_jacobian == pytest.approx(1.0, rel=1e-12)
        assert report.aspect_ratio == pytest.approx(1.0, rel=1e-12) and report.edges is not None
        assert report.edges[0] == pytest.approx(report.edges[1], rel=1e-12)
    sheared = one_cell("hex8", np.array([[1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]))
    assert sheared.report().scaled_jacobian == pytest.approx(np.sqrt(0.5), rel=1e-12)
    flat = one_cell("hex20", np.diag([0.1, 0.1, 2e-5])).report()
    assert flat.aspect_ratio == pytest.approx(5000.0) and any("lock" in w for w in flat.warnings)
    sliver = one_cell("tet4", np.diag([1.0, 1.0, 0.01]))
    sliver = replace(sliver, points=sliver.points + np.outer([0, 0, 0, 1], [0.4, 0.4, 0]))
    assert any("scaled Jacobian" in w for w in sliver.report().warnings)


def test_parts_are_counted() -> None:
    mesh = one_cell("hex8", 0.1 * np.eye(3))
    two = wfmesh.Mesh(np.concatenate([mesh.points, mesh.points + 1.0]), {"hex8": np.arange(16).reshape(2, 8)})
    assert two.report().parts == 2 and "2 disconnected parts" in str(two.report())


@pytest.mark.parametrize(
    ("material", "words"),
    [
        (Material(210e3, 0.3, 7850.0), ["speed of sound"]),  # MPa
        (Material(210e3, 0.3, 7.85e-9), ["speed of sound", "no solid has a density"]),  # N, mm, t
        (Material(210e9, 0.3, 7.85), ["speed of sound"]),  # g/cm3: 7.85 kg/m3 is a foam's
        (Material(210.0, 0.3, 7850.0), ["speed of sound"]),  # GPa
        (STEEL, []),
        (Material(2e6, 0.49, 100.0), []),  # foam rubber
        (Material(1.1e12, 0.07, 3500.0), []),  # diamond
    ],
)
def test_unit_slips_of_materials(material: Material, words: list[str]) -> None:
    warnings = wfmesh.roller(0.05, 0.015, 0.02, sectors=12, layers=1, axial=1).report(material).warnings
    assert bool(warnings) == bool(words) and all(any(word in w for w in warnings) for word in words)


def test_lines_of_a_report() -> None:
    mesh = wfmesh.roller(0.05, 0.015, 0.02, sectors=12, layers=2, axial=2)
    mesh = replace(mesh, cell_sets={"half": np.arange(24)}, notes=("2 points are left out",))
    text = str(mesh.report(STEEL))
    for part in ("half (24 cells)", "mass", "inertia", "scaled Jacobian", "note: 2 points", "12 sectors"):
        assert part in text


def test_pyvista_grid_and_back(tmp_path) -> None:
    mesh = wfmesh.roller(0.05, 0.015, 0.02, sectors=12, layers=2, axial=2)
    mesh = replace(mesh, cell_sets={"half": np.arange(24), "rim": np.arange(5)})
    grid = mesh.to_pyvista()
    assert grid.n_cells == mesh.cell_count + sum(mesh.sets.values()) and grid.n_points == len(mesh.points)
    assert int(grid.cell_data["rim"].sum()) == mesh.sets["rim"] + 5
    path = tmp_path / "mesh.vtu"
    grid.save(path)
    again = wfmesh.read(path, length_unit="m")
    assert again.sets == mesh.sets and {k: len(v) for k, v in again.cell_sets.items()} == {"half": 24, "rim": 5}
    np.testing.assert_array_equal(again.cells["hex27"], mesh.cells["hex27"])


@pytest.mark.parametrize("kind", CELL_KINDS)
def test_vtk_agrees_about_every_kind(kind: str, tmp_path) -> None:
    mesh = one_cell(kind, 0.1 * np.eye(3))
    mesh = replace(mesh, facet_sets={"skin": outer_faces(mesh.cells)})
    grid = mesh.to_pyvista()
    sizes = grid.compute_cell_sizes()
    assert float(sizes["Volume"][0]) == pytest.approx(mesh.volume(), rel=1e-6)
    middle = mesh.points[: cell_kind(kind).corner_count].mean(axis=0)
    for face in grid.get_cell(0).faces:  # VTK's own faces are outward in our node order, those of wedges too
        x = face.points[:3]
        assert np.cross(x[1] - x[0], x[2] - x[0]) @ (x.mean(axis=0) - middle) > 0.0
    for suffix in (".vtu", ".vtk"):
        grid.save(tmp_path / f"cell{suffix}", binary=suffix == ".vtu")
        again = wfmesh.read(tmp_path / f"cell{suffix}", length_unit="m")
        assert again.volume() == pytest.approx(mesh.volume(), rel=1e-12) and again.sets == mesh.sets


def test_pyvista_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(InputError, match=r"pip install warpffrf\[vtk\]"):
        one_cell("hex8").to_pyvista()


def test_products_of_inertia_of_round_off_are_printed_as_zero() -> None:
    mesh = wfmesh.roller(0.05, 0.015, 0.02, sectors=12, layers=2, axial=2, order=1)
    line = next(line for line in str(mesh.report(STEEL)).splitlines() if "inertia" in line)
    assert ", 0, 0, 0 kg m2" in line
