"""Pages for newcomers: the blocks of docs/how_do_i.md run as they stand, docs/words.md explains words that are said."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from warpffrf.output.report.report import TOLD, WHERE_THERE

ROOT = Path(__file__).resolve().parents[2]
HOW = (ROOT / "docs" / "how_do_i.md").read_text(encoding="utf-8")
INSTALL = (ROOT / "docs" / "install.md").read_text(encoding="utf-8")
WORDS = (ROOT / "docs" / "words.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"```py\n(.*?)```", re.DOTALL)
WIDEST = 92  # columns
LONGEST = 24  # lines of a block that one still reads at a glance


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Names after all blocks."""
    folder = tmp_path_factory.mktemp("pages")
    names: dict[str, Any] = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setenv("WARPFFRF_CACHE", str(folder / "cache"))
        for number, block in enumerate(BLOCK.findall(HOW)):
            exec(compile(block, f"how_do_i.md, block {number}", "exec"), names)
    return names


@pytest.mark.slow
def test_blocks_run_and_do_what_they_say(ran: dict[str, Any]) -> None:
    """The half-width is that of Hertz at the load, the force rises from a tenth of it to all of it, less the spring."""
    result, finer = ran["result"], ran["finer"]
    assert result.status == finer.status == "completed"
    force, gave = result.contact("pair").force_magnitude, result.joint("guide").coordinate
    wanted = np.array([0.1, 1.0]) * ran["load"] + 1e6 * gave[[0, -1]]
    assert np.allclose(force[[0, -1]], wanted, rtol=2e-2)  # it still moves a little at the end
    found = result.contact("pair").hertz(-1)
    assert found.half_width == pytest.approx(ran["half_width"] * np.sqrt(found.line_load * ran["width"] / ran["load"]))
    assert len(ran["diagram"].critical_speeds()) == 1 and "negative damping" in ran["diagram"].notes[-1]
    turns = [body.rotation for body in ran["tilted"].bodies]
    assert np.allclose(turns, turns[0], atol=1e-12)
    assert ran["again"].time[-1] == result.time[-1] == pytest.approx(ran["longer"].time[0] - 1e-4)  # its first step
    table, wide = ran["frame"]["contact_force_z[pair]"], ran["data"]["contact_force"]
    assert np.array_equal(table, wide.sel(pair="pair", axis="z")) and np.allclose(-table, force)
    assert all(len(block.splitlines()) <= LONGEST for block in BLOCK.findall(HOW))


@pytest.mark.slow
def test_blocks_with_machines_of_their_own(ran: dict[str, Any]) -> None:
    """A sled under a measured sine, the mass of a body of matrices, a bolt as a bar in a stiffer block, a run-up, a
    spall."""
    force, mass, rate = 500.0, 5.0, 20 * np.pi  # N, kg, rad/s; over a whole period, from rest
    assert ran["moved"].body("sled").position[-1, 0] == pytest.approx(force / (mass * rate) * 0.1, rel=2e-3)
    assert ran["rod"].mass == pytest.approx(7850 * 0.02**2 * 0.2, rel=1e-9)
    bar = 20e3 * 0.04 / (210e9 * 6e-3**2)  # m, shank of 40 mm by 6 mm; the block gives way too
    assert bar < -ran["bolted_gap"] < 1.5 * bar
    critical = ran["diagram"].critical_speeds()[0].speed
    at = ran["disc"].angular_velocity[ran["orbit"].argmax(), 0]
    assert ran["orbit"].max() > 5e-4 and critical < at < 1.5 * critical  # five eccentricities, late as run-ups are
    passing = ran["support"].defect_frequencies(188.2, angle=0.0).bpfo
    assert ran["impacts"].peaks(1)[0][0] == pytest.approx(passing, rel=5e-3)


def test_every_question_is_answered() -> None:
    """Those of first users, and the topics of the manual."""
    asked = {
        "Units",
        "Mesh size",
        "CAD",
        "Matrices",
        "cage",
        "quaternion",
        "Load softly",
        "CSV",
        "Preload",
        "Unbalance",
    }
    asked |= {"Damping, rotating or not", "Step", "halves its steps", "How long", "Restart", "GPU", "clusters"}
    asked |= {"two runs compared", "pandas", "xarray", "Pictures and films", "ParaView"}
    headings = re.findall(r"^### (.*)$", HOW, re.M)
    assert [question for question in asked if not any(question in heading for heading in headings)] == []


def test_words_of_reports_are_explained() -> None:
    """Those in which reports count, and those that were asked for."""
    said = {"active nodes", "traces", "window", "capacity", "attachment modes", "retained_columns", "grid defect"}
    said |= {"creepage"}
    said |= {TOLD["retained_columns"], *(WHERE_THERE[f"{kind}_steps"] for kind in ("coarse", "rejected", "impulsive"))}
    assert all(re.search(rf"^\| [^|]*{re.escape(word)}", WORDS, re.M) for word in said), said
    rows = re.findall(r"^\| ([^|]+) \| (.+) \|$", WORDS, re.M)
    assert len(rows) > 50 and all(len(meaning.split()) >= 4 for word, meaning in rows if word not in ("word",))


def test_the_readme_leads_there() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert "(docs/words.md)" in readme and "(docs/how_do_i.md)" in readme and len(readme.encode()) <= 10_000


def test_code_fits_the_width_of_a_page() -> None:
    """In a window of 1,280 pixels no block of a tutorial or of a page with recipes needs to be scrolled."""
    docs = ROOT / "docs"
    recipes = (ROOT / "README.md", docs / "how_do_i.md", docs / "examples.md", docs / "sweeps.md")
    for page in (*recipes, *(docs / "tutorials").glob("*.md")):
        blocks = re.findall(r"^```(?:py|python|{code-cell} python)\n(.*?)^```", page.read_text("utf-8"), re.M | re.S)
        for block in blocks:
            assert [line for line in block.splitlines() if len(line) > WIDEST] == [], page.name


def test_links_lead_somewhere() -> None:
    for page in (HOW, WORDS, INSTALL):
        for target in re.findall(r"\]\(([^)#]+)", page):
            assert (ROOT / "docs" / target).exists(), target
