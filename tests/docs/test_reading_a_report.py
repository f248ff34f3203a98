"""docs/reading_a_report.md explains every status, every counter and every source of error that a report can print."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from warpffrf import Status
from warpffrf.output.budget import contacts, figures, time_step
from warpffrf.output.report import report

PAGE = (Path(__file__).parents[2] / "docs" / "reading_a_report.md").read_text(encoding="utf-8")
FIRST_CELLS = {
    word for row in re.findall(r"^\| (.*?) \|", PAGE, re.MULTILINE) for word in re.findall(r"`([^`]+)`", row)
}
SOURCES = (
    time_step.SOURCE, contacts.SOURCE, contacts.GRID, contacts.GAPS, contacts.ADVANCE, contacts.POINTS, contacts.MESH,
    contacts.FILM_GRID, contacts.PROFILES, contacts.INERTIA, contacts.STIFFENING, contacts.LOCAL, contacts.TOLERANCE,
    figures.UNKNOWN,
)  # fmt: skip


@pytest.mark.parametrize("word", [*map(str, Status), *report.TOLD.values(), *report.WHERE_THERE.values(), *SOURCES])
def test_it_is_explained(word: str) -> None:
    assert word in FIRST_CELLS


def test_labels_of_figures_are_explained() -> None:
    """Labels as the report's own code writes them."""
    labels = set(re.findall(r'Figure\(\s*"([^"]+)"', Path(report.__file__).read_text(encoding="utf-8")))
    assert {"force", "half-width", "Hertz", "creepage", "loss"} <= labels
    assert not [label for label in labels if label not in PAGE]
