"""The study of joints on a coarse pair of sheets: spaces known to be exact are, and the page has the figures."""

from __future__ import annotations

import numpy as np
import pytest

from studies.small_sliding import joint_bases, joint_engine
from studies.small_sliding import joint_spaces as study

LOAD = {"partial slip": 60.0}


@pytest.fixture(scope="module")
def joint():
    return study.two_sheets((16, 1, 1))


@pytest.fixture(scope="module")
def reference(joint):
    return study.of_cells(joint, np.arange(16), "all cells")


def test_coordinates_that_hold_every_response_are_exact(joint, reference):
    free = joint.lap.model.free
    Q = np.concatenate([joint.lap.responses[free], joint.still[free]], axis=1)
    space = study.of_modes(joint, Q, "every response", 50)
    assert np.abs(space.flexibility - reference.flexibility).max() < 1e-8 * np.abs(reference.flexibility).max()
    path = study.load_path(60.0)
    entry = study.measure(space, path, reference.follow(path))
    assert entry is not None
    # of 1e-11 of the energy that was dropped as dependent
    assert max(entry.pressure, entry.traction, abs(entry.loss), abs(entry.amplitude)) < 1e-4


def test_groups_cover_the_joint(joint):
    group = study.graded(joint, 0.5)
    x = joint.cells.points[:, 0]
    ordered = group[np.argsort(x)]
    assert np.all(np.diff(ordered) >= 0) and set(group) == set(range(group.max() + 1))
    assert np.bincount(group)[0] == 1 and np.bincount(group).max() > 1
    halves = study.of_cells(joint, np.argsort(np.argsort(x)) // 2, "halves")
    assert halves.cells.count == 8 and halves.cells.area.sum() == pytest.approx(0.002)


@pytest.mark.slow
def test_laps_of_the_engine_are_the_flexibility_of_their_cells(joint, reference):
    """In proportion: bolts that keep their direction make 1e-2 of the loads of it, which are a thousandth."""
    references = {"partial slip": (60.0, reference.follow(study.load_path(60.0)))}
    both = joint_engine.compared(joint, joint_engine.sheets((16, 1, 1)), references)
    assert [one.engine.space.unknowns for one in both[:2]] == [48, 6]
    for one in both:
        assert one.study is not None
        for value in ("pressure", "traction", "slip", "loss", "amplitude"):
            assert getattr(one.engine, value) == pytest.approx(getattr(one.study, value), abs=3e-5)


@pytest.mark.slow
def test_page_has_the_figures(joint):
    found = study.spaces(joint)
    results = joint_bases.compared(joint, found, LOAD)
    entry = study.measure(found[0], study.load_path(60.0), results[0].reference)
    assert entry is not None
    both = [joint_engine.Both("partial slip", entry, entry)]
    text = joint_bases.page((joint, found, results, both))
    exact, statics, *_ = results[0].entries
    assert exact is not None and exact.pressure == 0.0 and exact.loss == 0.0
    assert statics is not None and statics.pressure > 0.01 and f"{statics.pressure:.1%}" in text
    assert len(text.splitlines()) > 30 and "## Partial slip" in text
    assert {s.name.split(" ")[0] for s in found} == {"all", "statics", "+", "cells", "graded"}
