"""`Matched` as users give it, and cells of a reduced body as plain arrays."""

from __future__ import annotations

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.model.small_sliding import MatchedSurface
from warpffrf.model.surfaces import Matched


def test_the_name_of_the_surface_is_its_facet_set() -> None:
    graded = Matched(growth=0.5, fine=("head", "nut")).called("top")
    assert graded.sets == ("top",) and graded.describe()["fine"] == ["head", "nut"]
    named = wf.surfaces.Matched("b", 5e-3, first="a")
    assert named.called("own") is named
    assert named.describe() == {"sets": ["a", "b"], "size": 5e-3, "growth": None, "by": "facets"}


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Matched("a", first="a"), "'a' cannot face itself"),
        (lambda: Matched(first=3), "by name, got 3"),  # pyright: ignore[reportArgumentType]
        (lambda: Matched(first="a", by="cells"), "by 'cells' does not exist; known: 'facets', 'nodes'"),
        (lambda: Matched(first="a", size=0.0), "size must be greater than zero"),
        (lambda: Matched(first="a", growth=-1.0), "growth must be greater than zero"),
        (
            lambda: Matched(first="a", fine=("head",)),
            "cells are fine at 'head' if they grow away from there; give growth",
        ),
        (lambda: Matched(first="a", growth=0.5, fine=3), "names of facet sets, got 3"),  # pyright: ignore[reportArgumentType]
        (lambda: Matched(first="a", by="nodes", size=1.0), "size gathers facets; leave it out for cells by nodes"),
    ],
)
def test_what_is_refused(make, says) -> None:
    with pytest.raises(InputError, match=says):
        make()


def test_arrays_and_facts_make_it_again() -> None:
    lap = MatchedSurface(
        "lap", True, np.zeros((2, 3)), np.tile(np.eye(3), (2, 1, 1)), np.ones(2), np.full(2, 1e-3), np.zeros((4, 6)),
        np.zeros((3, 3, 3)), np.array([0, 0, 1]), (0.5, 1.0), (1e-3, 1e-3), (1.0, 1.0), "nodes",
    )  # fmt: skip
    again = MatchedSurface.restore("lap", lap.arrays(), lap.facts())
    assert vars(again) == {**vars(lap)} and (again.cells, again.unknowns) == (2, 6)
