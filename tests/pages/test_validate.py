"""The verification page: complete, made of its figures, and cheap cases of it run again."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from studies.page import make
from studies.validate.case import CASES, Case, Outcome, Row, outcome
from studies.validate.known import KNOWN_MISSES, NOT_COMPARED
from studies.validate.page import FIGURES, PAGE, lines, page, unexpected
from warpffrf.model.errors import InputError

DOCS = Path(__file__).parents[2] / "docs"
FIGURES_OF_PAGE = json.loads((DOCS / FIGURES).read_text(encoding="utf-8"))
STORED = {one["name"]: Outcome.read(one) for one in FIGURES_OF_PAGE["cases"]}
AGAIN = 0.05  # of the tolerance: another machine rounds otherwise
CHEAP = (
    "patch_test", "hht_integrator", "whirl_threshold", "kalker_law", "ball_bearing_209", "angular_contact_218",
    "cardan_shaft", "bolted_joint", "hertz_line",
)  # fmt: skip


@pytest.mark.parametrize("name", CHEAP)
def test_a_cheap_case_gives_what_the_page_says(name: str) -> None:
    found = outcome(CASES[name])
    assert found.rows and not found.failed
    for row, stored in zip(found.rows, STORED[name].rows, strict=True):
        assert row.quantity == stored.quantity
        assert abs(row.difference - stored.difference) <= AGAIN * row.tolerance, row


def test_the_page_is_made_of_its_figures() -> None:
    assert (DOCS / PAGE).read_text(encoding="utf-8") == page(FIGURES_OF_PAGE)


def test_every_registered_case_has_rows_on_the_page() -> None:
    """In the order of the registry, under its title and source, and each quantity of a case is distinguished from the
    others."""
    assert list(STORED) == list(CASES)
    text = (DOCS / PAGE).read_text(encoding="utf-8")
    for name, case in CASES.items():
        stored = STORED[name]
        assert (stored.room, stored.title, stored.source) == (case.room, case.title, case.source)
        assert case.title and case.source and f"`{name}`" in text
        assert stored.rows and not stored.failed and stored.seconds >= 0.0
        assert len({row.quantity for row in stored.rows}) == len(stored.rows), name
    assert all(row[0] in text and len(row) == 3 for row in NOT_COMPARED)
    assert (
        text.count("\n| ")
        == sum(len(one.rows) for one in STORED.values())
        + len({case.room for case in CASES.values()})
        + len(NOT_COMPARED)
        + 2 * 2
    )


def test_what_misses_is_known_with_its_reason() -> None:
    assert unexpected(STORED.values()) == []
    text = (DOCS / PAGE).read_text(encoding="utf-8")
    assert f"**{len(KNOWN_MISSES)} miss**" in text and all(reason in text for reason in KNOWN_MISSES.values())


def test_a_row_within_its_tolerance_and_one_that_is_not() -> None:
    assert Row("force", 1.01, 1.0, 0.02).reached and not Row("force", 1.03, 1.0, 0.02).reached
    assert Row("off by", 1e-3, 0.0, 1e-3, "m", 1.0).reached and not Row("force", float("nan"), 1.0, 0.02).reached
    assert Row("off by", 2.0, 0.0, 0.1, "N", 100.0).difference == 0.02


def test_a_case_that_breaks_down_misses_and_the_others_are_run(capsys: pytest.CaptureFixture[str]) -> None:
    def breaks() -> list[Row]:
        raise InputError("no such mesh")

    found = outcome(Case("broken", "Contact", "A case", "a book", breaks))
    assert found.missed == ["InputError: no such mesh"] and lines(found)[0][5] == "InputError: no such mesh"
    known = [f"{name}: {quantity} misses no more" for name, quantity in sorted(KNOWN_MISSES)]
    assert unexpected([found]) == ["broken: InputError: no such mesh misses", *known]


def test_a_single_case_is_printed_and_nothing_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert make("validate", tmp_path, ["hht_integrator"]) == [] and list(tmp_path.iterdir()) == []
    shown = capsys.readouterr().out
    assert "`hht_integrator`" in shown and shown.count("at infinity |") == 3
    with pytest.raises(InputError, match="'hht_integrators'"):
        make("validate", tmp_path, ["hht_integrators"])
    with pytest.raises(InputError, match="no quick version"):
        make("validate", tmp_path, quick=True)
