"""The study of bases on a coarse body: its errors are what they should be for spaces known to be exact or poor."""

from __future__ import annotations

import numpy as np
import pytest

from studies.bodies.bases import Entry, arm, by_size, full_body, measure, page
from warpffrf.offline import bases
from warpffrf.offline.products import Limits


@pytest.fixture(scope="module")
def body():
    return full_body(arm((2, 1, 8)))


def test_arm_is_a_sound_mesh():
    mesh = arm((2, 1, 8))
    mesh.check()
    assert {name: len(mesh.facets(name)) for name in ("low", "high")} == {"low": 2, "high": 2}


def test_all_modes_have_no_error(body):
    every = measure(body, "all", bases.FreeFree(), Limits(body.model.size - 6, None))
    few = measure(body, "few", bases.FreeFree(), Limits(2, None))
    assert every.error < 1e-9 < 1e-3 < few.error
    assert every.frequency_error < 1e-9 and few.frequency_error > 1e-3  # two modes and 12 attachment modes
    assert np.all(np.diff(body.hertz) > 0.0) and len(body.natural) > 2


def test_errors_fall_with_size_and_the_page_shows_them(body):
    rows = by_size(body, (18, 24, 36))
    for name in ("free-free", "Craig-Bampton", "POD"):
        errors = [entry.error for row in rows for entry in row if entry.name == name]
        assert errors[2] < errors[1] < errors[0]
    assert {entry.name for entry in rows[1]} > {"Krylov, points", "Krylov, moments"}
    text = page((body, rows, [(1.5, [Entry("free-free", 20, 1e-3, 1e-9, 0.1)])]))
    assert f"{rows[1][0].error:.1e}" in text and "20: 1.0e-03" in text
