"""Pages of studies of speed against error: what they hold, that each study runs, and on which machines."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from demos import slider_crank, two_rollers
from studies.speed_error_pages import STUDIES
from studies.speed_error_pages import slider_crank as crank_study
from studies.speed_error_pages.page import write_index, write_study

CRANK_RUN = 0.004  # s
ORDER = 1.9  # 2.00 to 2.03 measured


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of one study, made quickly."""
    with pytest.MonkeyPatch.context() as context:
        context.setattr(crank_study, "RUN", CRANK_RUN)
        return write_study(STUDIES["slider_crank"], tmp_path_factory.mktemp("pages"), quick=True, progress=False)


@pytest.mark.slow
def test_a_page_holds_a_row_for_each_run_and_its_pictures(page: Path) -> None:
    text = page.read_text()
    runs = text[text.index("All runs") :]
    assert len(re.findall(r"^\| \S.* (?:0.0004|0.0002) \|", runs, flags=re.MULTILINE)) == 3 * 2 * 2
    pictures = re.findall(r"\]\((\S+\.png)\)", text)
    assert len(pictures) == 2 and all((page.parent / name).is_file() for name in pictures)
    assert "Made with --quick" in text and "U = " in text


@pytest.mark.slow
def test_the_index_keeps_studies_that_were_not_made_again(page: Path, tmp_path: Path) -> None:
    shutil.copytree(page.parent.parent, tmp_path, dirs_exist_ok=True)
    folder = tmp_path / "speed_error"
    known = {"setting": "grid=patch", "wall": "3.25"}
    facts = {"quick": False, "seconds": 77, "settings": 16, "wanted": {"1.0%": known, "0.1%": known}}
    (folder / "two_rollers.json").write_text(json.dumps(facts))
    lines = write_index(STUDIES, tmp_path).read_text().splitlines()
    (kept,) = (line for line in lines if "two_rollers.md" in line)
    (made,) = (line for line in lines if "slider_crank.md" in line)
    assert "| 16 | grid=patch | 3.25 |" in kept and kept.endswith("| 77 |")
    assert "(quick)" in made and "integrator=" in made
    assert lines.index(kept) < lines.index(made)


@pytest.mark.slow
def test_each_treatment_of_local_modes_is_of_second_order_under_a_smooth_load() -> None:
    found = STUDIES["local_treatments"].make(True, progress=False)
    assert {row.status for row in found.rows} == {"completed"}
    orders = {(order.group, order.measure): order.orders for order in found.orders()}
    assert len(orders) == 3 * 3  # treatments, measures with histories
    assert min(p.min() for p in orders.values()) > ORDER


@pytest.mark.slow
@pytest.mark.parametrize("name", ["colliding_bars", "bearing", "rolling_friction"])
def test_a_study_runs_all_its_settings(name: str) -> None:
    found = STUDIES[name].make(True, progress=False)
    assert {row.status for row in found.rows} == {"completed"}
    assert all(0.0 < row.errors["force"] < 1.5 for row in found.rows)  # two unlike rectangles differ by at most 1.4
    assert found.reference["apart"]["force"] < np.median([row.errors["force"] for row in found.rows])


def test_scenes_around_given_bodies_are_those_of_the_demos() -> None:
    rod = slider_crank.rod_body(slider_crank.QUICK, progress=False)
    built = slider_crank.build(slider_crank.QUICK, progress=False)
    assert slider_crank.machine(rod).content_hash() == built.content_hash()
    size = two_rollers.Size(120, layers=4, axial=1)
    body = two_rollers.roller_body(size, progress=False)
    again = two_rollers.build(size, progress=False)
    assert two_rollers.machine(body, load_step_at=two_rollers.LOAD_STEP_AT).content_hash() == again.content_hash()
    assert two_rollers.machine(body, load_step_at=0.01).content_hash() != again.content_hash()
