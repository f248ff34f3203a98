"""`LapCells` as users give it, and cells of a reduced body as plain arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.model.laps import LapCells, LapSurface
from warpffrf.model.laps.lap_surface import lap_cells


def test_what_users_may_give() -> None:
    given: dict[str, Any] = {
        "lap": ("top", "bottom"),
        "list": ["a", "b"],
        "foot": "foot",
        "own": wf.LapCells("a", "b", size=5e-3),
    }
    given["table"] = {"first": "a", "by": "nodes"}
    given["graded"] = {"first": "a", "growth": 0.5, "fine": ["head", "nut"]}
    found = lap_cells(given)
    assert found == {
        "lap": LapCells("top", "bottom"),
        "list": LapCells("a", "b"),
        "foot": LapCells("foot"),
        "own": LapCells("a", "b", 5e-3),
        "table": LapCells("a", by="nodes"),
        "graded": LapCells("a", growth=0.5, fine=("head", "nut")),
    }
    assert found["graded"].describe()["fine"] == ["head", "nut"]
    assert lap_cells(None) == {} and found["foot"].sets == ("foot",)
    assert found["own"].describe() == {"sets": ["a", "b"], "size": 5e-3, "growth": None, "by": "facets"}


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: LapCells("a", "a"), "'a' cannot face itself"),
        (lambda: LapCells(3), "by name, got 3"),  # pyright: ignore[reportArgumentType]
        (lambda: LapCells("a", by="cells"), "by 'cells' does not exist; known: 'facets', 'nodes'"),
        (lambda: LapCells("a", size=0.0), "size must be greater than zero"),
        (lambda: LapCells("a", growth=-1.0), "growth must be greater than zero"),
        (lambda: LapCells("a", fine=("head",)), "cells are fine at 'head' if they grow away from there; give growth"),
        (lambda: LapCells("a", growth=0.5, fine=3), "names of facet sets, got 3"),  # pyright: ignore[reportArgumentType]
        (lambda: LapCells("a", by="nodes", size=1.0), "size gathers facets; leave it out for cells by nodes"),
        (lambda: lap_cells(["a"]), "laps must be"),  # pyright: ignore[reportArgumentType]
        (lambda: lap_cells({"lap": 3}), "got 3 for 'lap'"),
        (
            lambda: lap_cells({"lap": {"first": "a", "sizes": 1.0}}),
            "'sizes' does not exist; did you mean 'size'\\? known: 'first', 'second'",
        ),
        (lambda: lap_cells({"lap": {"second": "a"}}), "'lap' needs first"),
        (lambda: lap_cells({1: "a"}), "laps must be"),  # pyright: ignore[reportArgumentType]
    ],
)
def test_what_is_refused(make, says) -> None:
    with pytest.raises(InputError, match=says):
        make()


def test_arrays_and_facts_make_it_again() -> None:
    lap = LapSurface(
        "lap", True, np.zeros((2, 3)), np.tile(np.eye(3), (2, 1, 1)), np.ones(2), np.full(2, 1e-3), np.zeros((4, 6)),
        np.zeros((3, 3, 3)), np.array([0, 0, 1]), (0.5, 1.0), (1e-3, 1e-3), (1.0, 1.0), "nodes",
    )  # fmt: skip
    again = LapSurface.restore("lap", lap.arrays(), lap.facts())
    assert vars(again) == {**vars(lap)} and (again.cells, again.unknowns) == (2, 6)
