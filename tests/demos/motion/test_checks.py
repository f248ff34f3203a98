"""The checks of the demos' tests, and the registry: every demo has a command, a script that stands alone and a page."""

from __future__ import annotations

import ast
import importlib
from pathlib import Path

import pytest
from checks import Check, missed

from warpffrf import cli
from warpffrf.cli.info import names

ROOT = Path(__file__).resolve().parents[3]
SHORT = 200  # lines of a demo


def test_a_check_passes_within_its_tolerance_only() -> None:
    assert Check("a", 1.01, 1.0, "exact", 0.02).passed
    assert not Check("a", 1.03, 1.0, "exact", 0.02).passed
    assert Check("a", 0.01, 0.0, "balance", 0.02, scale=1.0).passed
    assert not Check("a", float("nan"), 1.0, "exact", 1e9).passed
    assert Check("a", -2.2, -2.0, "exact", 0.2).error == pytest.approx(0.1)


def test_a_line_for_each_check_that_failed() -> None:
    found = missed([Check("force", 1500.0, 1000.0, "statics", 0.1, "kN", 1e-3), Check("b", 1.0, 1.0, "exact", 0.1)])
    assert found == ["force: 1.5 kN, statics: 1, error +5.0e-01, tolerance 0.1"]


@pytest.mark.parametrize("module", sorted(path.stem for path in names().values()))
def test_every_demo_is_whole(module: str) -> None:
    demo = importlib.import_module(f"demos.{module}")
    assert callable(demo.build) and callable(demo.main) and demo.__doc__
    text = (ROOT / "demos" / f"{module}.py").read_text(encoding="utf-8")
    assert text.count("\n") <= SHORT and text.endswith('if __name__ == "__main__":\n    main()\n')
    said = demo.main.__doc__ or ""
    assert f"{module}.h5, .rrd" in said or f"{module}.h5 and .rrd" in said
    assert module.replace("_", "-") in (ROOT / "docs" / "demos.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("module", sorted(path.stem for path in names().values()))
def test_every_demo_stands_alone(module: str) -> None:
    """It imports what a user has who has installed the package, and nothing of the checkout."""
    tree = ast.parse((ROOT / "demos" / f"{module}.py").read_text(encoding="utf-8"))
    roots = {
        name.split(".")[0]
        for node in ast.walk(tree)
        if isinstance(node, ast.Import | ast.ImportFrom)
        for name in ([node.module or ""] if isinstance(node, ast.ImportFrom) else [alias.name for alias in node.names])
    }
    standard = {"__future__", "collections", "dataclasses", "functools", "math", "pathlib", "typing"}
    assert roots - standard <= {"warpffrf", "numpy", "scipy", "matplotlib"}


def test_a_folder_that_cannot_be_made_is_refused_before_the_run(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    (tmp_path / "file").write_text("")
    assert cli.main(["demo", "two-rollers", "--out", str(tmp_path / "file" / "out")]) == 1
    assert "Not a directory" in capsys.readouterr().err
