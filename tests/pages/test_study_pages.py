"""Pages of studies: each has a script with the same text, the harness makes it, and no page is without a script."""

from __future__ import annotations

import ast
import re
from importlib.util import find_spec
from pathlib import Path

import pytest

from studies.__main__ import main
from studies.page import MODULES, listed, made, make
from warpffrf.model.errors import InputError

DOCS = Path(__file__).parents[2] / "docs"
PARTS = {  # modules of pages that are written by several
    "rolling_patches": [
        "studies.rolling.rolling_steady",
        "studies.rolling.rolling_bodies",
        "studies.rolling.rolling_changes",
    ]
}
WRITERS = {"page", "_page", "section", "figures_section", "engine_table"}  # functions that return text of a page
SHORT = 25  # characters; shorter texts are units and words between figures
SINGLE = [name for name in MODULES if name not in ("speed_error", "stability", "validate")]


def texts(module: str) -> list[str]:
    """Paragraphs that a module writes, between the figures in them."""
    spec = find_spec(module)
    assert spec is not None and spec.origin is not None
    tree = ast.parse(Path(spec.origin).read_text(encoding="utf-8"))
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef) and node.name in WRITERS:
            strings = [part for part in ast.walk(node) if isinstance(part, ast.JoinedStr)]
            found += [part.value for text in strings for part in text.values if isinstance(part, ast.Constant)]
    for node in tree.body:
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            found.append(node.value.value)
    paragraphs = [" ".join(part.split()) for text in found for part in re.split(r"\n\n|\n#", str(text))]
    return [part for part in paragraphs if len(part) > SHORT]


@pytest.mark.parametrize("name", SINGLE)
def test_the_text_of_a_page_is_that_of_its_script(name: str) -> None:
    page = (DOCS / f"studies/{name}.md").read_text(encoding="utf-8")
    words = " ".join(page.split())
    written = [text for module in [MODULES[name], *PARTS.get(name, [])] for text in texts(module)]
    assert written and [text for text in written if text not in words] == []
    heading, rest = page.split("\n", 1)
    command = f"\nMade by `python -m studies {name}`; do not edit.\n"
    assert (
        heading.startswith("# ")
        and rest.startswith(command)
        and made(heading + "\n" + rest[len(command) :], name) == page
    )


def test_every_page_has_its_study() -> None:
    """And the page of contents leads to each of them, by its heading."""
    pages = [path for path in sorted((DOCS / "studies").glob("*.md")) if path.name != "README.md"]
    assert [path.stem for path in pages] == sorted(SINGLE)
    contents = (DOCS / "studies/README.md").read_text(encoding="utf-8")
    linked = re.findall(r"^- \[(.*)\]\((.*)\): \w", contents, re.M)
    assert sorted(linked, key=lambda one: one[1]) == [
        (path.read_text(encoding="utf-8").split("\n", 1)[0].removeprefix("# "), path.name) for path in pages
    ]
    for path in [DOCS / "speed_error.md", *(DOCS / "speed_error").glob("*.md")]:
        assert "Made by `python -m studies speed_error`; do not edit." in path.read_text(encoding="utf-8")
    page = (DOCS / "stability/stability.md").read_text(encoding="utf-8")
    assert "Made by `python -m studies stability`; do not edit." in page


def test_a_page_and_its_picture_are_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from studies.bodies import bases

    monkeypatch.setattr(bases, "compute", lambda: 7)
    monkeypatch.setattr(bases, "page", lambda figures: f"# Heading\n\nText {figures}.\n")
    monkeypatch.setattr(bases, "picture", lambda figures, path: path.write_text(str(figures)))
    page, picture = make("bases", tmp_path)
    assert page == tmp_path / "studies/bases.md" and picture == tmp_path / "studies/bases.png"
    assert page.read_text() == "# Heading\n\nMade by `python -m studies bases`; do not edit.\n\nText 7.\n"
    assert picture.read_text() == "7"


def test_the_list_has_a_line_for_each_study(capsys: pytest.CaptureFixture[str]) -> None:
    main(["--list"])
    assert capsys.readouterr().out.strip() == listed()
    lines = listed().splitlines()
    assert [line.split()[0] for line in lines] == list(MODULES) and all(line.endswith(".") for line in lines)


@pytest.mark.parametrize(
    ("name", "cases", "quick", "words"),
    [
        ("base", [], False, "study 'base' does not exist; did you mean 'bases'"),
        ("bases", ["arm"], False, "study 'bases' has no named cases"),
        ("bases", [], True, "study 'bases' has no quick version"),
        ("accuracy", ["pendulums"], False, "machine"),
        ("speed_error", ["crank"], False, "case"),
    ],
)
def test_what_a_study_does_not_have_is_refused(name, cases, quick, words, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        make(name, tmp_path, cases, quick=quick)
    assert list(tmp_path.iterdir()) == []
