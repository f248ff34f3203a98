"""Cells too deep for the contact grid: what is measured, and when the user hears of it."""

from __future__ import annotations

import logging
from dataclasses import replace

import numpy as np
import pytest
from offline_bodies import reduced

from warpffrf import examples
from warpffrf.model import mesh as meshes
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline.contact.contact_choice import DEEPEST, layer_depth, node_spacing

R, R_I = 0.05, 0.015


def rim_shape(mesh):
    return Cylinder().fitted(mesh.points[mesh.facets("rim").node_set])


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("growth", [1.0, 1.7])
def test_depth_of_a_roller_is_its_rim_layer(order, growth):
    mesh = roller(R, R_I, 0.02, sectors=12, layers=3, axial=2, grading=growth, order=order)
    layer = (R - R_I) / sum(growth**i for i in range(3))
    # linear cells: nodes on the circle below; quadratic cells have a layer of nodes in their middle
    assert layer_depth(mesh, "rim", rim_shape(mesh)) == pytest.approx(layer / order, rel=1e-9)


@pytest.mark.parametrize("layers", [2, 40])
def test_spacing_of_nodes_is_the_wider_of_depth_and_columns(layers):
    mesh = roller(R, R_I, 0.02, sectors=36, layers=layers, axial=2, grading=1.0, order=1)
    body = reduced(mesh, modes=0)
    around = body.contact_surfaces["rim"].grid.pitch * R
    found = body.provenance["contact_node_spacings"]["rim"]
    assert found == pytest.approx(max((R - R_I) / layers, around), rel=1e-9)
    assert (found > around) == (layers == 2)


def test_spacing_of_tetrahedra_is_not_given():
    mesh = meshes.read(examples.path("roller") / "roller.msh", length_unit="mm")
    grid = SurfaceGrid(np.array([1.0, 0.0, 0.0]), 0.0, 0.1, 60, True, np.array([-0.01, 0.01]), 60)
    assert node_spacing(mesh, "rim", rim_shape(mesh), grid) is None


def test_depth_of_tetrahedra_is_at_most_their_edge():
    mesh = meshes.read(examples.path("roller") / "roller.msh", length_unit="mm")
    x = mesh.points[mesh.single[1][:, :4]]
    longest = max(np.linalg.norm(x[:, i] - x[:, j], axis=1).max() for i in range(4) for j in range(i))
    depth = layer_depth(mesh, "rim", rim_shape(mesh))
    assert 0.1 * longest < depth <= 0.5 * longest  # half: ten-node cells


@pytest.mark.parametrize("general", [False, True])
@pytest.mark.parametrize("order", [1, 2])
def test_deep_cells_are_reported_and_logged(order, general, caplog):
    deep = roller(R, R_I, 0.02, sectors=60 // order, layers=1, axial=1, order=order)
    with caplog.at_level(logging.WARNING, logger="warpffrf"):
        body = reduced(deep, general=general, modes=0)
    (text,) = body.report["warnings"]
    spacing = 2.0 * np.pi * R / 60
    figures = body.report["contact"]["rim"]
    assert figures["layer_depth_in_spacings"] == pytest.approx(0.035 / order / spacing, rel=1e-6)
    assert "contact 'rim'" in text and "too narrow" in text and "spacing >=" in text
    assert text in caplog.text and text in body.info()


def test_cells_as_deep_as_wide_are_fine():
    mesh = roller(R, R_I, 0.02, sectors=60, layers=4, axial=2, order=1)  # graded by itself
    body = reduced(mesh, modes=0)
    assert body.report["contact"]["rim"]["layer_depth_in_spacings"] == pytest.approx(1.0, rel=1e-6)
    assert not body.report["warnings"]


def test_the_named_spacing_cures_it():
    mesh = roller(R, R_I, 0.04, sectors=60, layers=2, axial=2, grading=1.0, order=1)
    (text,) = reduced(mesh, modes=0).report["warnings"]
    named = float(text.split("spacing >= ")[1].split(" m")[0])
    assert named == pytest.approx(0.0175 / DEEPEST, rel=1e-2)
    # the grid takes whole multiples of the sectors' arc, at most the given spacing: the next one up
    arc = 2.0 * np.pi * R / 60
    cured = reduced(mesh, modes=0, spacing=np.ceil(named / arc) * arc * (1.0 + 1e-9))
    assert not cured.report["warnings"]


def test_the_warning_survives_the_cache(tmp_path, monkeypatch, caplog):
    monkeypatch.setenv("WARPFFRF_CACHE", str(tmp_path))
    mesh = replace(roller(R, R_I, 0.02, sectors=60, layers=2, axial=1, grading=1.0, order=1), name="deep")
    first = reduced(mesh, modes=0, cache=True)
    with caplog.at_level(logging.WARNING, logger="warpffrf"):
        second = reduced(mesh, modes=0, cache=True)
    assert second.report["cached"] and second.report["warnings"] == first.report["warnings"]
    assert first.report["warnings"][0] in caplog.text
