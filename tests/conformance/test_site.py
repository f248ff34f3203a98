"""Pages of the documentation site that are made from the package."""

from __future__ import annotations

from pathlib import Path

import public_names
from site_pages.api import place, write_commands, write_names, write_quantities
from site_pages.docstrings import converted

DEMOS = Path(__file__).parents[2] / "demos"
PICTURES = Path(__file__).parents[2] / "docs"


def test_every_public_name_has_a_page(tmp_path: Path) -> None:
    write_names(tmp_path)
    pages = {path.stem for path in tmp_path.glob("*.rst")}
    named = {".".join(place(one)).removeprefix("warpffrf.") for one in public_names.everything() if one.owner is None}
    assert pages == named and len(named) > 200
    scene = (tmp_path / "Scene.rst").read_text(encoding="utf-8")
    for one in public_names.everything():
        if one.owner is not None and one.label.startswith("wf.Scene."):
            assert one.name in scene, one.label


def test_every_command_and_quantity_is_listed(tmp_path: Path) -> None:
    write_commands(tmp_path / "commands.md")
    write_quantities(tmp_path / "quantities.md")
    commands = (tmp_path / "commands.md").read_text(encoding="utf-8")
    for command in ("run", "modes", "reduce", "picture", "study speed-error", "example copy"):
        assert f"`warpffrf {command}`" in commands
    quantities = (tmp_path / "quantities.md").read_text(encoding="utf-8")
    assert "| `contact_force` | N | time, owner, axis |" in quantities and "| `time` | s | time |" in quantities


def test_every_demo_has_a_picture() -> None:
    for script in DEMOS.glob("[a-z]*.py"):
        assert (PICTURES / f"{script.stem}.png").is_file(), script.name


def test_parameters_become_a_definition_list() -> None:
    text = "Run it.\n\nstep [s]: how long, see `simulate`. results, record: files *.h5;\nwritten whole."
    assert converted(text.splitlines(), {"step", "results", "record"}) == [
        "Run it.", "", "step [s]", "    how long, see `simulate`.", "",
        "results, record", "    files \\*.h5; written whole.", "",
    ]  # fmt: skip


def test_words_that_are_no_parameters_stay_prose() -> None:
    assert converted(["note: step is one."], {"step"}) == ["note: step is one.", ""]
    assert converted(["every `n`th step"], set()) == ["every `n`\\ th step", ""]


def test_formulas_are_literal_and_code_is_code() -> None:
    assert converted(["With `a b`:", "", "    x_* = |y|"], set()) == [
        "With ``a b``:",
        "",
        "::",
        "",
        "        x_* = |y|",
        "",
    ]
