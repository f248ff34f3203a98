"""The page's example with friction: it runs as it stands, transmits what statics says, and prints what is quoted."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import warpffrf as wf
from printed import python_blocks

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = (ROOT / "docs" / "examples.md").read_text(encoding="utf-8")
LONGEST = 30  # lines of an example that one still reads at a glance
TORQUE, RADIUS, CARRIED, GRAVITY = 100.0, 0.05, 2000.0, 9.81  # N m, m, kg, m/s2: as in the example
# the rail pushes at the deformed radius, 14 um of 50 mm inside, and the wheel still settles after the torque's rise
TRANSMITTED = 1e-3
QUOTED = 0.1  # of a quoted number: a cell at the edge of the patch, of eight, may change sides on another machine
QUOTED_LINES = ("traction", "creep forces", "creepage", "T-gamma", "friction power", "cells per step")
NUMBER = r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"


@pytest.fixture(scope="module")
def code() -> str:
    found = [
        code
        for code in python_blocks(EXAMPLES)
        if "friction=" in code and "Contact(" in code and "sliding=" not in code
    ]
    assert len(found) == 1
    return found[0]


@pytest.fixture(scope="module")
def said(code: str, tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("friction")
    path = os.pathsep.join([str(ROOT), str(ROOT / "kernels")])
    environment = {**os.environ, "PYTHONPATH": path, "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
    script = folder / "example.py"
    script.write_text(code, encoding="utf-8")
    done = subprocess.run([sys.executable, script], cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (folder / "wheel.rrd").stat().st_size > 0
    return done.stdout


def line_of(text: str, label: str) -> str:
    return next(line for line in text.splitlines() if line.strip().startswith(label))


def first_number(text: str, label: str) -> float:
    found = re.search(NUMBER, line_of(text, label).split(label)[1])
    assert found is not None
    return float(found.group())


def wheel() -> tuple[float, float]:
    """Mass [kg] and moment of inertia about the axle [kg m2] of the hollow cylinder of the example."""
    outer, inner, width, density = 0.05, 0.015, 0.02, 7850.0
    mass = density * 3.141592653589793 * (outer**2 - inner**2) * width
    return mass, 0.5 * mass * (outer**2 + inner**2)


def test_the_example_is_short(code: str) -> None:
    assert len([line for line in code.splitlines() if line]) <= LONGEST
    for name in re.findall(r"wf\.([A-Za-z_]\w*)", code):
        assert hasattr(wf, name)


@pytest.mark.slow
def test_the_rail_pushes_with_what_statics_says(said: str) -> None:
    assert said.startswith("status            completed"), said
    mass, inertia = wheel()
    acceleration = TORQUE / RADIUS / (CARRIED + mass + inertia / RADIUS**2)
    force = (CARRIED + mass) * acceleration
    assert first_number(said, "traction") == pytest.approx(force, rel=TRANSMITTED)
    load = (CARRIED + mass) * GRAVITY
    share = float(re.findall(NUMBER, line_of(said, "traction"))[-1])
    assert share == pytest.approx(force / load, rel=2.0 * TRANSMITTED)
    assert first_number(said, "creepage") > 0.0  # the driven wheel runs ahead


def test_the_quoted_lines_are_those_of_the_report(said: str) -> None:
    quoted = EXAMPLES.split("```py\n")[1].split("```")[1].split("\n## ")[0]
    for label in QUOTED_LINES:
        assert first_number(quoted, label) == pytest.approx(first_number(said, label), rel=QUOTED)
    assert "warning" not in said
