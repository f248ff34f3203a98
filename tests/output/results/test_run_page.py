"""The page of a run: its figures are those of the report, it is well-formed and stands by itself."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from synthetic_run import make_history

import warpffrf as wf
from page_reader import Page
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online.history.history import BudgetLine
from warpffrf.output.page import html
from warpffrf.output.page.run_page import run_page
from warpffrf.output.plots.figure import drawable
from warpffrf.output.report.report import report_of
from warpffrf.output.result import Result

STRANGE = "<b>&\"'"


@pytest.fixture(scope="module")
def swing() -> Result:
    """Pendulums on springs, of which four are alike, with their error budget, for a few steps."""
    scene = wf.Scene(gravity=(0, 0, -9.81))
    for n, name in enumerate(["bob 1", "bob 2", "bob 3", "bob 4", STRANGE]):
        bob = scene.add_rigid_body(1.0 + n, (0.01, 0.01, 0.01), name=name, position=(0.1, n, 0))
        pin = scene.add(wf.joints.Revolute(scene.ground, bob.at((-0.1, 0, 0)), axis=(0, 1, 0), name=f"pin of {name}"))
        scene.add(wf.forces.TorsionalSpringDamper(pin, 1.0, name=f"spring of {name}"))
    result = wf.simulate(scene, 0.01, step=1e-3, start="initial", progress=False)
    result.error_budget()
    return result


def test_each_figure_of_the_report_is_on_the_page(swing: Result) -> None:
    page, report = Page(run_page(swing, "Run: swing")), report_of(swing)
    values = [row[1] for row in page.rows if len(row) > 1]
    for entry in (*report.contacts, *report.items):
        assert entry.head in page.text
        assert all(figure.text in values for figure in entry.figures)
    for figure in (*report.run[2:], *report.energy):
        assert [figure.label, figure.text] in page.rows
    assert all(note in page.text for note in report.notes)
    assert report.run[0].text in page.text and "4 joints 'pin of bob 1' to 'pin of bob 4'" in page.text


def test_errors_stand_next_to_the_figures_and_sources_with_their_cures(history: Any) -> None:
    history.budget = [
        BudgetLine("FE mesh", "force of contact 'lower-upper'", 0.03, "a rule", "a finer mesh"),
        BudgetLine("time step", "force of contact 'lower-upper'", 0.04, "run again", "a smaller step"),
        BudgetLine("time step", "motion of body 'lower'", 0.02, "run again", "a smaller step"),
        BudgetLine("not estimated", "peak pressure of contact 'lower-upper'", float("nan"), "requires another grid"),
        BudgetLine("time step", "moment of contact 'lower-upper'", 0.01, "run again"),
    ]
    result = Result(history)
    page = Page(run_page(result, "Run"))
    force = f"{result.contact('lower-upper').force_magnitude[-1]:.6g} N"
    assert ["force", force, "5 % (time step)"] in page.rows  # 3 and 4 % are independent
    assert ["moment", "not listed", "1 % (time step)"] in page.rows
    assert next(row for row in page.rows if row[0] == "peak pressure")[2] == "not estimated: requires another grid"
    assert ["time step", "4 % of the force of contact 'lower-upper' (run again)", "a smaller step"] in page.rows
    assert ["body 'lower'", "motion 2 % (time step)"] in page.rows
    assert "Largest estimated error: time step, 4 %; cure: a smaller step" in page.text


def test_plots_have_descriptions(result: Result) -> None:
    page = Page(run_page(result, "Run"))
    assert [label for label in page.pictures if label.startswith("Picture of the bodies lower, upper")]
    for kind in drawable(result):
        assert any(label.startswith(f"Plot '{kind}': ") for label in page.pictures), kind
    assert page.tags.count("figcaption") == len(page.pictures)


def test_maps_of_further_contacts_are_those_with_the_largest_forces(body: ReducedBody) -> None:
    history = make_history(body, name="pair 0")
    view = history.scene
    for n in range(1, 8):
        other = make_history(body, name=f"pair {n}")
        other.contacts[f"pair {n}"].force *= 1.0 + n % 4
        history.contacts |= other.contacts
        view.pairs.update(other.scene.pairs)
    maps = [label for label in Page(run_page(Result(history), "Run")).pictures if label.startswith("Plot 'patch'")]
    assert len(maps) == 1 + 4  # the first, and pairs 3, 7, 2, 6


def test_names_are_texts(swing: Result) -> None:
    text = run_page(swing, f"Run: {STRANGE}")
    page = Page(text)
    assert "<b>&" not in text and f"Run: {STRANGE}" in page.text and f"spring of {STRANGE}" in page.text


def test_a_run_without_rows_and_a_failed_one_have_pages(history: Any) -> None:
    history.status, history.message = "not_converged", "halve the step & try <again>"
    page = Page(run_page(Result(history), "Run"))
    assert "Status: not_converged: halve the step & try <again>" in page.text
    assert "requires the process of the run" in page.text


def test_the_page_is_written_as_other_files_are(swing: Result, tmp_path: Path) -> None:
    written = swing.page(tmp_path / "new" / "swing.html", progress=False)
    text = written.read_text(encoding="utf-8")
    assert "Run: swing" in Page(text).text and len(text) < 2_000_000
    with pytest.raises(wf.InputError, match="exists"):
        swing.page(written, progress=False)
    assert swing.page(written, overwrite=True, progress=False).read_text(encoding="utf-8") == text
    for path, why in (
        (tmp_path / "swing.pdf", r"must end in \.html or \.htm"),
        (tmp_path, "is a folder"),
        (tmp_path / "a\0.html", "NUL"),
        (3, "must be the name of a file"),
    ):
        with pytest.raises(wf.InputError, match=why):
            swing.page(path, progress=False)  # pyright: ignore[reportArgumentType]
    foreign = tmp_path / "foreign.html"
    foreign.write_text("<p>mine</p>")
    with pytest.raises(wf.InputError, match="not written by warpffrf"):
        swing.page(foreign, overwrite=True, progress=False)


def test_versions_are_those_of_the_run(history: Any, tmp_path: Path) -> None:
    history.versions = {"warpffrf": "0.0.7", "numpy": "1.2.3"}
    Result(history).save(tmp_path / "run.h5")
    page = Page(run_page(Result.load(tmp_path / "run.h5"), "Run"))
    assert ["numpy", "1.2.3"] in page.rows and ["warpffrf", "0.0.7"] in page.rows
    assert ["content hash of the scene", "hash of this scene"] in page.rows


def test_pictures_take_the_colours_of_the_page() -> None:
    from matplotlib.figure import Figure

    figure = Figure()
    ax = figure.add_subplot()
    ax.plot([0, 1], color="#d1495b")
    ax.pcolormesh([[0.0, 1.0], [2.0, 3.0]])
    text = html.picture(figure, "a <map>")
    assert "var(--red)" in text and "var(--paper)" in text and "#ffffff" not in text and "#000000" not in text
    assert text.count("<image") == 1
    ax.set_title("another")
    assert len(Page(html.document("both", text, html.picture(figure, "more"))).pictures) == 2  # names do not collide
