"""The study of flexible bearings: its rigid cases are the published ones, and cases are looked up by name."""

from __future__ import annotations

from pathlib import Path

import pytest

from studies.bodies.flexible_bearings import CASES, HEAD, page, row
from studies.page import make
from warpffrf.model.errors import InputError


def test_rigid_cases_are_the_published_ones(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert make("flexible_bearings", tmp_path, ["p10"]) == []  # a part of the page is printed, not written
    assert "P10 | rigid | 1,965 | 1,379" in capsys.readouterr().out
    found = row(CASES["p9"])
    assert len(found) == len(HEAD)
    assert float(found[2].replace(",", "")) == pytest.approx(1679.0, rel=1e-2)
    assert float(found[5]) == pytest.approx(41.5, abs=0.05)
    assert "| P9 | rigid |" in page([found])


def test_a_case_that_does_not_exist_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no case 'p11'; choose from p7, p7-balls"):
        make("flexible_bearings", tmp_path, ["p11"])
