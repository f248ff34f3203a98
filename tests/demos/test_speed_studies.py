"""The page of studies of speed against error: what it holds, and that the machines of its studies are the demos'."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from warpffrf.demos import slider_crank, speed_studies, two_rollers


def test_the_page_holds_a_row_for_each_run_and_its_pictures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(speed_studies, "CRANK_RUN", 0.01)
    page = speed_studies.write_page(tmp_path, ["slider_crank"], quick=True, progress=False).read_text()
    rows = re.findall(r"^\| (?:0.0004|0.0002) .* completed \|$", page, flags=re.MULTILINE)
    assert len(rows) == 3 * 2 * 2  # integrators, inertia levels, steps
    pictures = re.findall(r"\]\((\S+\.png)\)", page)
    assert len(pictures) == 2 and all((tmp_path / name).is_file() for name in pictures)
    assert "Made with --quick" in page and "U = " in page


def test_scenes_around_given_bodies_are_those_of_the_demos() -> None:
    rod = slider_crank.rod_body(slider_crank.QUICK, progress=False)
    built = slider_crank.build(slider_crank.QUICK, progress=False)
    assert slider_crank.machine(rod).content_hash() == built.content_hash()
    size = two_rollers.Size(120, layers=4, axial=1)
    body = two_rollers.roller_body(size, progress=False)
    again = two_rollers.build(size, progress=False)
    assert two_rollers.machine(body).content_hash() == again.content_hash()
    assert two_rollers.machine(body, load_step_at=0.01).content_hash() != again.content_hash()
