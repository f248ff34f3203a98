"""What a run says of contacts that are not to be trusted."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.online.contact_notes import energy_notes
from warpffrf.study.rollers import guided_pair, roller_body


@pytest.fixture(scope="module")
def coarse() -> wf.ReducedBody:
    return roller_body(60, layers=2, axial=2, grading=1.6, modes=0, cache=False)


def notes_of(scene: wf.Scene, **options) -> str:
    result = wf.simulate(scene, 1e-4, step=1e-4, progress=False, **options)
    return "\n".join(result.history.notes)


def test_a_patch_of_two_columns_is_named(coarse) -> None:
    assert "columns of the grid wide" in notes_of(guided_pair(coarse, coarse, load=2e3), start="equilibrium")


def test_hats_over_the_end_of_a_narrower_surface_are_named(coarse) -> None:
    """Three rows of hats over 20 mm against a roller of 11 mm: the middle hats hang over its ends."""
    narrow = roller_body(60, layers=2, axial=2, grading=1.6, width=0.011, modes=0, cache=False)
    assert "reach over the end" in notes_of(guided_pair(coarse, narrow, load=2e4), start="equilibrium")
    assert "reach over the end" not in notes_of(guided_pair(narrow, coarse, load=2e4), start="equilibrium")


def test_an_overlap_at_the_start_is_named(coarse) -> None:
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    a = scene.add_body(coarse, name="a")
    b = scene.add_body(coarse, name="b", position=(0.0, 0.0, 0.1 - 2e-5))
    scene.add(wf.Contact(a["rim"], b["rim"]))
    said = notes_of(scene)
    assert "overlap of 2e-05 m" in said and "close_gap" in said


def test_energy_from_nowhere_is_named() -> None:
    rows = {name: np.zeros(4) for name in ("kinetic", "strain", "contact", "numerical", "contact_grid")}
    rows["kinetic"] += 1.0
    assert energy_notes(rows) == []
    rows["numerical"] = np.array([0.0, -0.02, 0.0, 0.0])  # falls, then rises by two per cent
    assert "gained 0.02 J" in energy_notes(rows)[0]
    rows["numerical"] = np.array([0.0, -0.02, -0.04, -0.5])
    assert energy_notes(rows) == []


def test_a_common_width_between_the_sampling_points_is_refused(coarse) -> None:
    """Two rollers that face each other over 1 mm, rows 10 mm apart: they would fall through each other."""
    scene = wf.Scene()
    a = scene.add_body(coarse, name="a")
    b = scene.add_body(coarse, name="b", position=(0.0, 0.019, 0.1))
    scene.add(wf.Contact(a["rim"], b["rim"]))
    with pytest.raises(InputError, match="finer rows"):
        wf.simulate(scene, 1e-4, step=1e-4, progress=False)
