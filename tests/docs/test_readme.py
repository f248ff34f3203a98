"""The README: its examples run as they stand, its commands are understood, and its links and pictures exist."""

from __future__ import annotations

import os
import re
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import warpffrf as wf
from printed import commands, python_blocks
from references.finite_elements.pressed_block import Block, pressed
from warpffrf.cli import app

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *(ROOT / "docs" / f"{name}.md" for name in ("install", "examples", "running", "features"))]
README = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)  # the front page and what it leads to
HALF_WIDTH_TOLERANCE = 0.04  # four elements a half-width


LONGEST = 26  # lines of an example that one still reads at a glance
# Largest von Mises stress under the pad over the largest pressure: 0.558 of an infinite line at Poisson's ratio 0.3
# (Johnson 1985, 4.2), more between free sides and ends, 2 mm or four half-widths from the middle.
SHORT_LINE_CONTACT = 0.663  # finite elements, quadratic: 0.6626 to 0.6645 on cells of 0.1 mm, 0.6635 of 0.07 mm
FINITE_ELEMENTS = 0.004  # relative, what the growth of the cells changes
FINER_CELLS = 0.012  # cells half as large: 0.668 by nodes and 0.661 by patches
STRESS_TOLERANCE = 0.05  # cells of 0.2 mm, below the first layer 0.9 mm high: 0.635
LOAD = 3.924e3  # N, what the spring's preload leaves


def blocks() -> list[str]:
    """The examples that are tested here; those of other rooms are in the files next to this."""
    return [c for c in python_blocks(README) if not any(word in c for word in ("friction=", "wf.Film("))]


def run_example(number: int, folder: Path, changed: tuple[str, str] = ("", "")) -> str:
    """What the example prints that stands as the given one in the README, one text in it `changed`."""
    code = blocks()[number].replace(*changed)
    path = os.pathsep.join([str(ROOT), str(ROOT / "kernels")])
    environment = {**os.environ, "PYTHONPATH": path, "OPENBLAS_NUM_THREADS": "1"}
    script = folder / "example.py"
    script.write_text(code, encoding="utf-8")
    done = subprocess.run([sys.executable, script], cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_examples_are_short() -> None:
    assert len(blocks()) == 4
    assert all(len([line for line in code.splitlines() if line]) <= LONGEST for code in blocks())


def test_the_two_rollers_run(tmp_path: Path) -> None:
    said = run_example(0, tmp_path)
    assert said.startswith("status            completed"), said
    quoted = quoted_after(0)
    assert len(quoted) > 10 and [line for line in quoted if not said_in(line, said)] == []
    width, hertz = (float(x) for x in said.strip().splitlines()[-1].split())
    assert abs(width / hertz - 1.0) < HALF_WIDTH_TOLERANCE
    assert {"rollers.h5", "rollers.rrd"} <= {p.name for p in tmp_path.iterdir()}


@pytest.mark.slow
def test_the_deck_of_ones_own_runs(tmp_path: Path) -> None:
    wf.examples.copy("machine", tmp_path)
    said = run_example(1, tmp_path)
    assert "steel, E 2.1e+11 Pa" in said and "foot: average" in said and "contact grid  pad" in said, said
    peak, stress = (float(x) for x in said.strip().splitlines()[-1].split())
    assert abs(stress / peak / SHORT_LINE_CONTACT - 1.0) < STRESS_TOLERANCE
    assert {"shoe.png", "mode_7.rrd"} <= {p.name for p in tmp_path.iterdir()}


@pytest.mark.slow
@pytest.mark.parametrize("contact_fixed", [False, True])
def test_the_stress_under_the_pad_is_that_of_finer_cells(tmp_path: Path, contact_fixed: bool) -> None:
    """Cells half as large, by nodes and by patches."""
    wf.examples.copy("machine", tmp_path)
    make = runpy.run_path(str(tmp_path / "make_machine.py"))
    (tmp_path / "machine.inp").write_text(make["deck"]((40, 40, 16)), encoding="utf-8")
    width = "expected_half_width=0.5e-3"
    said = run_example(1, tmp_path, (width, f"{width}, contact_fixed={contact_fixed}"))
    peak, stress = (float(x) for x in said.strip().splitlines()[-1].split())
    assert abs(stress / peak / SHORT_LINE_CONTACT - 1.0) < FINER_CELLS


@pytest.mark.slow
def test_the_stress_under_the_pad_is_that_of_finite_elements(tmp_path: Path) -> None:
    wf.examples.copy("machine", tmp_path)
    made = runpy.run_path(str(tmp_path / "make_machine.py"))
    materials = wf.mesh.read(tmp_path / "machine.inp", length_unit="mm", part="shoe-1").materials
    radius, half, length, height = (1e-3 * made[name] for name in ("RADIUS", "HALF", "WIDTH", "HEIGHT"))
    depth = height * made["HARDENED"] ** 2
    hardened, core = materials["hardened"], materials["core"]
    assert isinstance(hardened, wf.Material) and isinstance(core, wf.Material)
    block = Block(radius, half, length, height, depth, (hardened, core))
    found = pressed(block, LOAD, 1e-4, 7e-4, 5e-5 * np.arange(21))
    assert found.stress.max() / found.peak == pytest.approx(SHORT_LINE_CONTACT, rel=FINITE_ELEMENTS)


NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")
QUOTED = 0.03  # of a number: the report rounds to two digits
SMALL = 1e-6  # an energy residual over the energy of the run, which the tolerance of the iteration makes


def said_in(quoted: str, said: str) -> bool:
    """Whether a line of `said` is the quoted one, numbers alike; smaller ones than `SMALL` are those of round-off."""
    words, numbers = NUMBER.sub("#", quoted).split(), [float(x) for x in NUMBER.findall(quoted)]
    for line in said.splitlines():
        found = [float(x) for x in NUMBER.findall(line)]
        if NUMBER.sub("#", line).split() == words and np.allclose(found, numbers, rtol=QUOTED, atol=SMALL):
            return True
    return False


def quoted_after(number: int) -> list[str]:
    """The lines of output that the README shows after an example, up to the next heading."""
    text = README.split(blocks()[number])[1].split("```")[1].split("\n## ")[0]
    lines = [line.strip() for line in text.splitlines() if line.startswith("    ") and line.strip()]
    return [line for line in lines if line != "..." and not line.startswith("warpffrf ")]


@pytest.mark.parametrize(("number", "lines"), [(2, 6), (3, 10)])
def test_what_the_readme_quotes_is_what_the_example_prints(number: int, lines: int, tmp_path: Path) -> None:
    quoted = quoted_after(number)
    assert len(quoted) == lines
    said = run_example(number, tmp_path)
    assert [line for line in quoted if not said_in(line, said)] == [], said
    assert number != 3 or all((tmp_path / name).stat().st_size > 0 for name in ("modes.png", "shapes.png"))


def test_commands_have_the_options_that_the_readme_gives_them() -> None:
    found = [command.words for command in commands(README)]
    assert {words[1] for words in found} == {
        "demo", "example", "run", "modes", "campbell", "info", "reduce", "plot", "compare", "spectrum", "picture",
        "view", "report",
    }  # fmt: skip
    for words in found:
        names = words[1:3] if words[1] in ("demo", "example") else words[1:2]
        known = CliRunner().invoke(app, [*names, "--help"], env={"COLUMNS": "200"}).output
        for option in (word for word in words if word.startswith("-")):
            assert re.search(rf"(?<!\S){option}\b", known), f"{' '.join(words)}: no option {option}"


def test_extras_of_the_readme_exist() -> None:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    extras = set(re.findall(r"^(\w+) = \[", text.split("[project.optional-dependencies]")[1].split("\n[")[0], re.M))
    table = README.split("## Extras")[1].split("\n## ")[0]
    said = {name for line in table.splitlines() if line.startswith("| `") for name in re.findall(r"`(\w+)`", line[:25])}
    assert said == extras - {"dev"}


def test_names_of_the_readme_exist() -> None:
    for name in re.findall(r"wf\.([A-Za-z_]\w*)", README):
        assert hasattr(wf, name), f"wf.{name}"
    for name in re.findall(r"`(?:mesh\.)?((?:select|to_py)\w*)", README):
        assert hasattr(wf.mesh.Mesh, name), f"mesh.{name}"


def test_links_and_pictures_exist() -> None:
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
    for page in pages:
        for target in re.findall(r"\]\(([^)#]+)", page.read_text(encoding="utf-8")):
            if "://" not in target and "made/" not in target:  # what the site makes, its build checks
                assert (page.parent / target).exists(), f"{page.name} points to {target}, which does not exist"
