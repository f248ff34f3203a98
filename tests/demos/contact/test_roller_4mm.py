"""The mesh file that comes with the package: a roller in quadratic tetrahedra."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from warpffrf.model import mesh as wfmesh
from warpffrf.model.mesh.elements import cell_kind

FOLDER = Path(__file__).resolve().parents[3] / "demos" / "data"
MOST_BYTES = 1_000_000  # the file is part of every wheel
ON_CIRCLE = 1e-12  # of the radius: coordinates are stored as doubles
VOLUME = 1e-5  # relative: parabolas over 0.42 rad at the bore, an error of order 0.42^4/480, on 1/10 of the area


def generator() -> Any:
    """The script that made the file, for the dimensions it used (gmsh itself is imported only by its main)."""
    spec = importlib.util.spec_from_file_location("make_roller_4mm", FOLDER / "make_roller_4mm.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def mesh() -> wfmesh.Mesh:
    return wfmesh.read(FOLDER / "roller_4mm.msh", length_unit="mm")


def test_cells_are_sound(mesh: wfmesh.Mesh) -> None:
    assert (FOLDER / "roller_4mm.msh").stat().st_size < MOST_BYTES
    assert mesh.check().single[0] == "tet10" and mesh.cyclic is None
    cell = cell_kind("tet10")
    assert cell.jacobians(mesh.points[mesh.single[1]], cell.nodes).min() > 0.0  # at mid nodes of curved cells too
    report = mesh.report()
    assert report.warnings == () and report.scaled_jacobian is not None and report.scaled_jacobian > 0.15


def test_nodes_lie_on_the_true_circles(mesh: wfmesh.Mesh) -> None:
    """Those in the middle of edges as well, which a straight-sided mesh would have 0.04 mm inside the rim."""
    made = generator()
    for name, radius in (("rim", made.OUTER_RADIUS), ("bore", made.BORE_RADIUS)):
        x = 1e3 * mesh.points[mesh.facets(name).node_set]
        assert np.abs(np.hypot(x[:, 0], x[:, 2]) / radius - 1.0).max() < ON_CIRCLE
    ends = 1e3 * mesh.points[mesh.facets("ends").node_set]
    np.testing.assert_allclose(np.abs(ends[:, 1]), 0.5 * made.WIDTH, rtol=ON_CIRCLE)


def test_volume_and_sets(mesh: wfmesh.Mesh) -> None:
    made = generator()
    exact = np.pi * (made.OUTER_RADIUS**2 - made.BORE_RADIUS**2) * made.WIDTH * 1e-9
    assert mesh.volume() == pytest.approx(exact, rel=VOLUME)
    assert set(mesh.sets) == {"rim", "bore", "ends"}
    assert sum(mesh.sets.values()) == len(mesh.outer_facets())


def test_cells_are_of_the_size_in_the_name(mesh: wfmesh.Mesh) -> None:
    """Mean edge at the rim, which Gmsh keeps to a few percent."""
    corners = mesh.points[mesh.facets("rim").single[1][:, :3]]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    assert edges.mean() == pytest.approx(1e-3 * generator().RIM_SIZE, rel=0.05)
