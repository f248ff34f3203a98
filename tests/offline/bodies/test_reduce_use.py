"""What `reduce` says to a user: arguments of a wrong kind, sets that do not go together, and what it did otherwise
than asked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from offline_bodies import STEEL, reduced

from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline import reduce
from warpffrf.offline.bases.modes import vibration_modes
from warpffrf.offline.elastic import ElasticModel

ALUMINIUM = Material(70e9, 0.33, 2700.0)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"interfaces": ["bore"]}, "interfaces must be {facet set"),
        ({"interfaces": "bore"}, "interfaces must be {facet set"),
        ({"contact": "rim"}, "contact must be {facet set"),
        ({"contact": {"rim": Cylinder}}, r"is no surface shape; use surfaces.Cylinder\(\)"),
        ({"modes": True}, "modes is a number"),
    ],
)
def test_arguments_of_a_wrong_kind_are_named(small_roller, settings, message):
    with pytest.raises(InputError, match=message):
        reduced(small_roller, **settings)


@pytest.mark.parametrize("general", [False, True])
@pytest.mark.parametrize("spacing", [1e-9, 1e-300])
def test_a_spacing_in_a_wrong_unit_is_refused_before_anything_is_made(small_roller, general, spacing):
    """A function for each such spacing would be 1e9 of them at least."""
    with pytest.raises(InputError, match="finer than the surface mesh .* functions on .* nodes"):
        reduced(small_roller, general=general, spacing=spacing)


@pytest.mark.parametrize("general", [False, True])
def test_contact_on_rigid_nodes_is_refused_with_the_cure(small_roller, general):
    with pytest.raises(InputError, match="nodes are on the rigid interface 'ends'.*'average'"):
        reduced(small_roller, general=general, interfaces={"ends": "rigid"})
    assert not any("interface" in text for text in reduced(small_roller).report["warnings"])


def test_free_interface_on_the_contact_surface_is_warned_of(small_roller):
    part = small_roller.select("part", "ends", lambda c: (c[:, 1] > 0.0) & (c[:, 2] > 0.02))
    body = reduced(part, interfaces={"part": "free"})
    assert any("on the free interface 'part'" in text for text in body.report["warnings"])


def test_points_moved_onto_the_mesh_are_noted(small_roller):
    on = small_roller.points[small_roller.facets("rim").node_set[0]]
    edges = small_roller.facets("rim").centers(small_roller.points)[:1]
    outside = edges * np.array([1.0 + 1e-4, 1.0, 1.0 + 1e-4])
    body = reduced(small_roller, stress={"on": on[None], "outside": outside})
    found = [text for text in body.report["notes"] if "stress" in text]
    assert len(found) == 1 and found[0].startswith("stress 'outside': 1 of 1 points lie outside the mesh")


def test_what_the_cyclic_path_does_not_use_is_noted(small_roller):
    body = reduced(small_roller, solver="superlu", memory_limit=1e9)
    assert body.report["path"] == "cyclic"
    assert [text.split()[0] for text in body.report["notes"] if "was not used" in text] == ["solver", "memory_limit"]
    general = reduced(small_roller, general=True, solver="superlu", memory_limit=1e9)
    assert not any("was not used" in text for text in general.report["notes"])


def test_a_spacing_that_could_not_be_kept_is_noted(small_roller):
    sector = 2.0 * np.pi * 0.05 / 18
    assert not reduced(small_roller, spacing=sector).report["notes"]
    body = reduced(small_roller, spacing=1.9 * sector)  # two sectors are too wide: one it is
    assert any(f" spacing={1.9 * sector:g}:" in text for text in body.report["notes"])


def test_a_contact_surface_of_two_materials_is_noted(small_roller):
    x = np.concatenate([small_roller.points[nodes].mean(axis=1) for nodes in small_roller.cells.values()])
    halves = {"left": np.flatnonzero(x[:, 0] < 0.0), "right": np.flatnonzero(x[:, 0] >= 0.0)}
    mesh = replace(small_roller, cell_sets=halves)
    body = reduce(
        mesh,
        {"left": STEEL, "right": ALUMINIUM},
        interfaces={"bore": "rigid"},
        contact={"rim": Cylinder()},
        cache=False,
        progress=False,
    )
    assert any(text.startswith("contact 'rim': 50 % of the facets") for text in body.report["notes"])


def test_a_body_prints_as_one_line(small_roller):
    body = reduced(small_roller, modes=2)
    assert len(repr(body)) < 200 and "interfaces='bore'" in repr(body)


def test_lanczos_keeps_its_basis_orthonormal_over_a_wide_spectrum():
    """Frequencies over six decades, triple ones among them: round-off is of the largest eigenvalue of the flexibility,
    and an unrepaired basis would return copies of the lowest modes."""
    omega = np.repeat(np.geomspace(1.0, 1e6, 100), 3)
    rng = np.random.default_rng(1)
    M = np.diag(rng.uniform(0.5, 2.0, 300))
    X = np.linalg.qr(rng.standard_normal((300, 300)))[0] / np.sqrt(np.diag(M))[:, None]
    model = ElasticModel(
        M @ X @ np.diag(omega**2) @ X.T @ M, M, np.zeros((300, 0)), lambda f: X @ ((X.T @ f) / (omega**2)[:, None])
    )
    found, Phi = vibration_modes(model, count=60)
    assert found[:60] == pytest.approx(omega[:60], rel=1e-9)
    assert np.abs(Phi.T @ M @ Phi - np.eye(len(found))).max() < 1e-12
