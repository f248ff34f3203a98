"""The quick rows of the acceptance of small-sliding contacts, on meshes as coarse as their targets allow."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from studies.small_sliding.cases import bolt_rows, leaf_rows, micro_slip_rows, press_fit_rows, press_rows
from studies.small_sliding.motion import flight_rows
from studies.small_sliding.rows import Row


@pytest.mark.parametrize(
    "rows",
    [
        lambda: leaf_rows((12, 1), 4), bolt_rows, lambda: press_fit_rows(24, 4), press_rows, lambda: flight_rows(100),
        lambda: micro_slip_rows(0.5, 1.1, 1.5, points=3),
    ],
    ids=["leaves", "bolt", "press fit", "press", "flight", "bar"],
)  # fmt: skip
def test_targets_are_reached(rows: Callable[[], list[Row]]) -> None:
    found = rows()
    assert found and not [row.line() for row in found if not row.reached]
