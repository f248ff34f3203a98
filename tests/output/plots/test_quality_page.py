"""The quality page: what its plots show, and that every kind of body gets one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from synthetic_run import COLUMNS, PITCH, ROWS, R

from warpffrf.cli.describe import describe_file
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.data import DisplaySurface
from warpffrf.output.plots.modes import MAX_TRIANGLES, eye_axes, mode_skin
from warpffrf.output.plots.quality_page import decay, frequencies, node_response, quality_figure


@pytest.fixture
def axes():
    from matplotlib.figure import Figure

    return Figure().add_subplot()


def without_modes(body: ReducedBody) -> ReducedBody:
    surface = body.contact_surfaces["rim"]
    bare = replace(surface, mode_normal=np.zeros((COLUMNS * ROWS, 0)))
    skin = replace(body.surface, modes=np.zeros((0, len(body.surface.points), 3)))
    return replace(body, frequencies=np.zeros(0), contact_surfaces={"rim": bare}, surface=skin)


def test_node_response_is_a_column_of_the_compliance(body: ReducedBody) -> None:
    surface = body.contact_surfaces["rim"]
    columns = np.arange(20)
    D = surface.compliance(columns).reshape(20, ROWS, 20, ROWS)
    assert node_response(surface, 7, 1)[columns] == pytest.approx(D[:, :, 7, 1])


def test_decay_is_drawn_against_the_arc(body: ReducedBody, axes) -> None:
    decay(axes, body)
    line = next(line for line in axes.lines if line.get_label() == "around, local modes")
    x, y = line.get_data()
    assert x[0] == pytest.approx(R * PITCH * 1e3) and x[-1] == pytest.approx(np.pi * R * 1e3)
    assert y[0] == pytest.approx(1e-9 * np.exp(-1.0 / 36.0))  # the dimple of the synthetic body, one column away


def test_frequencies_show_what_is_covered_and_asked(body: ReducedBody, axes) -> None:
    quality = {"frequencies": {"vibration_modes": 1, "covered": 6e3, "max_frequency": 6e3}}
    frequencies(axes, replace(body, report={"quality": quality}))
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert "max_frequency 6 kHz" in labels and "vibration modes" in labels and "attachment modes" in labels
    shaded = next(p for p in axes.patches if "covered" in p.get_label())
    assert shaded.get_extents().transformed(axes.transData.inverted()).x1 == pytest.approx(6.0)


def test_every_kind_of_body_has_a_page(body: ReducedBody, tmp_path: Path) -> None:
    nothing = DisplaySurface(np.zeros((0, 3)), np.zeros((0, 3), dtype=int), np.zeros((2, 0, 3)))
    kinds = {
        "whole": body,
        "no_modes": without_modes(body),
        "no_contact": replace(body, contact_surfaces={}),
        "no_skin": replace(body, surface=nothing),
    }
    for name, one in kinds.items():
        path = one.quality_page(tmp_path / f"{name}.png")
        header = path.read_bytes()[:24]
        assert header[1:4] == b"PNG"
        assert (int.from_bytes(header[16:20], "big"), int.from_bytes(header[20:24], "big")) == (1600, 1200)


def test_gallery_names_modes_as_those_of_a_free_body(body: ReducedBody) -> None:
    titles = [ax.get_title() for ax in quality_figure(body).axes]
    assert "7: 5 kHz" in titles and "8: 8 kHz" in titles


def test_large_skins_are_thinned_for_pictures(body: ReducedBody) -> None:
    copies = MAX_TRIANGLES // len(body.surface.triangles) + 1
    n = len(body.surface.points)
    points = np.concatenate([body.surface.points + [0.0, 0.1 * i, 0.0] for i in range(copies)])
    triangles = np.concatenate([body.surface.triangles + i * n for i in range(copies)])
    large = replace(body, surface=DisplaySurface(points, triangles, np.zeros((0, len(points), 3))))
    assert len(mode_skin(large).triangles) <= MAX_TRIANGLES < len(triangles)
    assert len(mode_skin(body).triangles) == len(body.surface.triangles)


@pytest.mark.parametrize("extents", [(1.0, 0.1, 0.1), (1.0, 0.2, 1.0), (0.1, 1.0, 3.0), (1.0, 1.0, 0.1)])
def test_the_view_is_right_handed_and_shows_the_broad_side(extents) -> None:
    corners = np.array(np.meshgrid(*[(0.0, e) for e in extents])).reshape(3, -1).T
    axes = eye_axes(corners)
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert np.abs(axes[2])[np.argmin(extents)] >= np.abs(axes[2])[np.argmax(extents)]


def test_info_writes_the_page_and_refuses_it_for_other_files(body: ReducedBody, tmp_path: Path) -> None:
    file = body.save(tmp_path / "body.h5")
    page = tmp_path / "page.png"
    text = describe_file(file, length_unit=None, density=1.0, page=page)
    assert page.is_file() and f"quality page written to {page}" in text
    mesh = tmp_path / "mesh.msh"
    mesh.write_text("")
    with pytest.raises(InputError, match="neither a reduced body nor a sweep"):
        describe_file(mesh, length_unit="m", density=1.0, page=page)
    with pytest.raises(InputError, match="quality page"):
        body.quality_page(tmp_path / "page.nonsense")


def test_info_lists_each_contact_material_once(body: ReducedBody) -> None:
    material = {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7850.0, "name": "steel"}
    other = {**material, "name": "bronze", "youngs_modulus": 1e11}
    materials = {"rim": material, "bore": other, "side": material, "back": None}
    told = replace(body, provenance={"contact_materials": materials})
    lines = [line for line in told.info().splitlines() if line.startswith("  material")]
    assert len(lines) == 3 and "at rim, side: steel, E 2e+11 Pa" in lines[0] and "at bore: bronze" in lines[1]
