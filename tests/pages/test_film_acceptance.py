"""The cheapest rows of docs/studies/film_acceptance.md, on coarser grids: what a grid leaves falls with its
square."""

from __future__ import annotations

from pathlib import Path

import pytest

from studies.films import film_acceptance as study

OF_ROWS = 1.0 / 64.0  # of the parabola along a short bearing, of nodes eight cells from end to end
FINITE = 0.013  # what L/D 0.05 is not 0, at an eccentricity of 0.8 with 64 columns
HALF = 5.0  # times the target, with half of the columns: errors go with the square of these


def test_short_bearings_are_ocvirks_but_for_the_rows() -> None:
    rows = study.short_rows((64, 9))
    assert [row.target for row in rows] == [0.02, 0.02]
    for row in rows:
        assert -OF_ROWS - FINITE < row.error < -OF_ROWS + 0.002, row


def test_the_middle_of_a_long_bearing_is_sommerfelds() -> None:
    half, most = study.long_rows((64, 9))
    assert abs(half.error) < half.target and abs(most.error) < HALF * most.target


@pytest.mark.slow
def test_a_plate_is_squeezed_as_the_double_series_has_it() -> None:
    (row,) = study.squeeze_rows((16,))
    assert row.error == pytest.approx(-0.0058, abs=3e-4)  # what the law has on this grid: docs/studies/oil_film.md


@pytest.mark.slow
def test_a_slider_is_compared_with_its_closed_form() -> None:
    (row,) = study.slider_rows(32)
    assert abs(row.error) < HALF * row.target


def test_the_page_says_what_is_missed() -> None:
    reached = study.Row("case", "8 cells", "force", -0.001, 0.002)
    missed = study.Row("case", "8 cells", "place", 0.5, 0.25, "half a cell")
    assert reached.cells() == ["case", "8 cells", "force", "-0.1 %", "0.2 %", ""]
    assert missed.cells() == ["case", "8 cells", "place", "half a cell", "25 %", "missed"]
    page = (Path(__file__).parents[2] / "docs/studies/film_acceptance.md").read_text(encoding="utf-8")
    assert page.count("\n| ") == 2 + 21 and page.startswith(
        "# Oil films of the engine compared with closed forms\n\nMade by"
    )
