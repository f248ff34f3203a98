"""Nodes of faces that lie on each other or across a gap, known by triangles alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from references.small_sliding.sheets import graded_stack, one_body
from warpffrf.model.mesh import Mesh
from warpffrf.model.surfaces import Matched
from warpffrf.offline.small_sliding.cells import make_cells
from warpffrf.output.geometry.skin_nodes import SkinNodes

LINES = (np.array([0.0, 6.0, 11.0, 18.0]) * 1e-3, np.array([0.0, 5.0, 9.0]) * 1e-3, [0.0, 2e-4])  # thin sheets
THICK = 2e-4  # m


def skin_of(mesh: Mesh) -> tuple[SkinNodes, np.ndarray]:
    """The outer nodes, and their numbers in the mesh."""
    outer = mesh.outer_facets()
    nodes = outer.node_set
    corners = np.concatenate(list(outer.corners.values()))
    triangles = np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])
    return SkinNodes(mesh.points[nodes], np.searchsorted(nodes, triangles)), nodes


def found(weights: Any, nodes: np.ndarray) -> np.ndarray:
    return nodes[np.flatnonzero(np.diff(weights.indptr))]


@pytest.mark.parametrize("bend", [0.0, 5.0])  # 1/m: facets stand off their arc by up to 30 um
@pytest.mark.parametrize("gap", [0.0, 3e-5])
def test_three_thin_sheets_in_one_body(gap: float, bend: float) -> None:
    """Facets are thirty times as long as sheets are thick; bent ones are a share of a tube around y."""
    sheets = graded_stack(LINES, THICK, 3, order=1)
    for k, sheet in enumerate(sheets):
        points = sheet.points + [0.0, 0.0, k * gap]
        if bend:
            r = 1.0 / bend + points[:, 2]
            points = np.stack([r * np.sin(bend * points[:, 0]), points[:, 1], r * np.cos(bend * points[:, 0])], axis=1)
        object.__setattr__(sheet, "points", points)
    mesh = one_body(sheets)
    skin, nodes = skin_of(mesh)
    for k in range(2):
        names = f"sheet{k}_z_max", f"sheet{k + 1}_z_min"
        cells = make_cells(mesh, "lap", Matched(names[1], first=names[0]))
        own = skin.on(cells.triangles, cells.cell, cells.count)
        np.testing.assert_array_equal(found(own, nodes), mesh.facets(names[0]).node_set)
        across = skin.across(cells.triangles, cells.cell, cells.gap)
        np.testing.assert_array_equal(found(across, nodes), mesh.facets(names[1]).node_set)
        for weights in (own, across):
            np.testing.assert_allclose(weights @ np.ones(cells.count), np.diff(weights.indptr) > 0, atol=1e-12)
